//! Markdown for comments on pull requests and job summaries: the verdict, a table of findings, and the rest collapsed.

use std::fmt::Write;

use crate::fitness::Condition;
use crate::run::{FailOn, Run, VerdictWord};
use crate::source::Confidence;
use crate::verdict::{Finding, Outcome};

use super::fitness::{state, title};
use super::place::Locator;
use super::terminal::{measured_words, plain_ending, reasons};
use super::text::{one_line, plural};

/// Maximum number of findings: comments are limited in size.
const MAX_FINDINGS: usize = 100;
/// Maximum number of recordings.
const MAX_RECORDINGS: usize = 200;

pub(super) fn render(run: &Run, fail_on: FailOn) -> String {
    let locator = Locator::new(&run.sources);
    let mut out = String::new();
    let _ = writeln!(out, "## {} frames-lint\n", sign(run.summary(fail_on).verdict));
    for line in plain_ending(run, fail_on).lines() {
        let _ = writeln!(out, "{}  ", escaped(line));
    }
    recordings(run, &mut out);
    table(run, &locator, &mut out);
    unmet(run, &mut out);
    fitness(run, &mut out);
    let waived: Vec<&Finding> = run.verdict.waived().collect();
    if !waived.is_empty() {
        let _ = writeln!(
            out,
            "\n<details><summary>Waived: {}</summary>\n",
            plural(waived.len(), "finding")
        );
        for finding in waived {
            let words = finding
                .waived
                .as_ref()
                .map(crate::verdict::Acceptance::words)
                .unwrap_or_default();
            let _ = writeln!(
                out,
                "- **{}** {}: {}",
                finding.rule,
                escaped(&finding.message),
                escaped(&words)
            );
        }
        out.push_str("\n</details>\n");
    }
    not_evaluated(run, &mut out);
    out
}

fn sign(verdict: VerdictWord) -> &'static str {
    match verdict {
        VerdictWord::Clean => ":white_check_mark:",
        VerdictWord::Findings => ":x:",
        VerdictWord::Incomplete => ":warning:",
    }
}

/// The verdict of each recording, if there are several.
fn recordings(run: &Run, out: &mut String) {
    if run.recordings.is_empty() {
        return;
    }
    out.push_str(
        "\n| | recording | errors | warnings | passed | not evaluated | because |\n|---|---|--:|--:|--:|--:|---|\n",
    );
    for recording in run.recordings.iter().take(MAX_RECORDINGS) {
        let summary = &recording.summary;
        let _ = writeln!(
            out,
            "| {} {} | {} | {} | {} | {} | {} | {} |",
            sign(summary.verdict),
            summary.verdict.word(),
            code(&recording.label),
            summary.errors,
            summary.warnings,
            summary.passed,
            summary.not_evaluated,
            escaped(recording.because.as_deref().unwrap_or_default())
        );
    }
    if run.recordings.len() > MAX_RECORDINGS {
        let more = plural(run.recordings.len() - MAX_RECORDINGS, "more recording");
        let _ = writeln!(out, "\n... and {more}");
    }
}

fn table(run: &Run, locator: &Locator, out: &mut String) {
    let count = run.verdict.open().count();
    if count == 0 {
        return;
    }
    out.push_str("\n| | rule | where | what |\n|---|---|---|---|\n");
    for finding in run.verdict.open().take(MAX_FINDINGS) {
        let place = finding.places.first().map(|label| locator.short(&label.place));
        let likely = match finding.confidence {
            Confidence::Likely => " (likely)",
            Confidence::Certain | Confidence::Hint => "",
        };
        let mut what = escaped(&finding.message);
        if let Some(measured) = finding.measured.first() {
            let _ = write!(what, "<br>measured: {}", escaped(&measured_words(measured)));
        }
        if !finding.detail.is_empty() {
            let _ = write!(what, "<br>{}", escaped(&finding.detail));
        }
        if !finding.help.is_empty() {
            let _ = write!(what, "<br>help: {}", escaped(&finding.help));
        }
        let _ = writeln!(
            out,
            "| {}{likely} | {} {} | {} | {what} |",
            finding.word(),
            finding.rule,
            finding.name,
            code(&place.unwrap_or_default())
        );
    }
    if count > MAX_FINDINGS {
        let _ = writeln!(out, "\n... and {}", plural(count - MAX_FINDINGS, "more finding"));
    }
}

fn unmet(run: &Run, out: &mut String) {
    if run.unmet.is_empty() {
        return;
    }
    out.push_str("\n### Requirements not met\n\n");
    for unmet in &run.unmet {
        let mut words = escaped(&unmet.reason());
        match (&unmet.waived, &unmet.record) {
            (Some(waived), _) => {
                let _ = write!(words, "  \n  waived: {}", escaped(&waived.words()));
            }
            (None, Some(record)) => {
                let _ = write!(words, "  \n  needed: {}", escaped(record));
            }
            (None, None) => {}
        }
        let _ = writeln!(out, "- **{}** {}: {words}", unmet.rule, unmet.name);
    }
}

/// What is asked, what was measured, why, and what to record.
fn words(condition: &Condition) -> String {
    let mut words = condition.asks.clone();
    for measured in &condition.measured {
        let _ = write!(words, "; {}", measured_words(measured));
    }
    if let Some(reason) = &condition.reason {
        let _ = write!(words, "; {reason}");
    }
    if let Some(record) = &condition.record {
        let _ = write!(words, "; record or add: {record}");
    }
    words
}

fn fitness(run: &Run, out: &mut String) {
    for one in &run.fitness {
        let _ = writeln!(
            out,
            "\n### {}\n\n| condition | | measured |\n|---|---|---|",
            escaped(&title(one))
        );
        for condition in &one.conditions {
            let name = escaped(condition.name);
            let _ = writeln!(
                out,
                "| {name} | {} | {} |",
                state(condition),
                escaped(&words(condition))
            );
        }
    }
}

fn not_evaluated(run: &Run, out: &mut String) {
    let count = run.verdict.count(Outcome::NotEvaluated);
    if count == 0 {
        return;
    }
    let _ = writeln!(
        out,
        "\n<details><summary>Not evaluated: {}</summary>\n",
        plural(count, "check")
    );
    for (reason, (rules, _)) in reasons(run) {
        let rules: Vec<&str> = rules.into_iter().collect();
        let _ = writeln!(out, "- {}: {}", escaped(reason), rules.join(", "));
    }
    out.push_str("\n</details>\n");
}

/// A text inside a line: markup and pipes are escaped.
pub(super) fn escaped(text: &str) -> String {
    let text = single_ticks(&one_line(text));
    // In code spans only the pipe is special; an unpaired backtick opens none.
    let mut ticks = text.matches('`').count() / 2 * 2;
    let mut is_code = false;
    let mut escaped = String::with_capacity(text.len());
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '`' if ticks > 0 => {
                ticks -= 1;
                is_code = !is_code;
                escaped.push(c);
            }
            _ if is_code && c != '|' => escaped.push(c),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            // An empty comment prevents mentions, references and links.
            '@' => escaped.push_str("@<!-- -->"),
            '#' => escaped.push_str("\\#<!-- -->"),
            ':' if chars.peek() == Some(&'/') => escaped.push_str(":<!-- -->"),
            '.' if escaped.ends_with("www") => escaped.push_str("<!-- -->."),
            '|' | '*' | '_' | '[' | ']' | '\\' | '~' | '`' => {
                escaped.push('\\');
                escaped.push(c);
            }
            _ => escaped.push(c),
        }
    }
    escaped
}

/// The text with runs of backticks replaced by one: a run of two opens another kind of code span, and a name may contain it.
fn single_ticks(text: &str) -> String {
    let mut was_tick = false;
    let single = |c: char| {
        let is_again = c == '`' && was_tick;
        was_tick = c == '`';
        if is_again { '\'' } else { c }
    };
    text.chars().map(single).collect()
}

pub(super) fn code(text: &str) -> String {
    let text = one_line(text).replace('|', "\\|");
    let longest = text.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    if longest == 0 {
        return format!("`{text}`");
    }
    // A span opened by more backticks than occur together in it.
    let fence = "`".repeat(longest + 1);
    format!("{fence} {text} {fence}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backticks_in_names_open_no_markup() {
        // A run of three would be another kind of code span, and the text after it markup.
        assert_eq!(escaped("```<img src=x>`"), "`''<img src=x>`");
        assert_eq!(escaped("frame `a`<b>` of `c`"), "frame `a`&lt;b&gt;` of `c\\`");
        assert_eq!(code("a`|b"), "`` a`\\|b ``");
        // Two backticks in one name leave the text between them outside of code.
        assert_eq!(
            escaped("`x`@team #1 http://a www.b`y`"),
            "`x`@<!-- -->team \\#<!-- -->1 http:<!-- -->//a www<!-- -->.b`y`"
        );
    }
}
