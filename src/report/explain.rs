//! A rule's page for the terminal: front matter as words, limits as a table, prose wrapped, code indented.
//!
//! Works on the text of a page and the catalogue of mistakes; does not know which rules exist.

use std::fmt::Write;

use crate::faults::{Fault, catalogue};
use crate::page::{self, Page};
use crate::tables::views;

use super::Style;
use super::style::Ink;
use super::text::wrap;

/// The page as text.
pub fn render(page: &Page, style: Style) -> String {
    let mut out = String::new();
    head(page, style, &mut out);
    let mut limits_due = true;
    for section in page::sections(page.body) {
        let _ = writeln!(out, "\n{}", style.paint(Ink::Strong, section.title));
        prose(section.text, style, &mut out);
        if section.title == "How it decides" {
            limits_due = false;
            limits(page, style, &mut out);
        }
    }
    if limits_due {
        limits(page, style, &mut out);
    }
    if let Some(sight) = sight(page.view) {
        let _ = writeln!(out, "\n{}", style.paint(Ink::Strong, "In the viewer"));
        paragraph(&sight, style, &mut out);
    }
    let mistakes = mistakes(page.code);
    if !mistakes.is_empty() {
        let _ = writeln!(out, "\n{}", style.paint(Ink::Strong, MISTAKES));
        for mistake in mistakes {
            item(&mistake, style, &mut out);
        }
    }
    if !page.references.is_empty() {
        let _ = writeln!(out, "\n{}", style.paint(Ink::Strong, "References"));
        for reference in page.references {
            item(reference, style, &mut out);
        }
    }
    let _ = writeln!(out, "\nOnline: {}", page::url(page.code));
    out
}

/// The title of the known mistakes on a rule's page.
pub const MISTAKES: &str = "Known mistakes that it should show";

/// More mistakes of one rule are named, and not described.
const MAX_DESCRIBED: usize = 12;

/// The known mistakes that a rule should show, in lines; `frames-lint assure` tries them on given data.
pub fn mistakes(code: &str) -> Vec<String> {
    let of_rule = |fault: &&Fault| fault.seen_by.has(code);
    let faults: Vec<&Fault> = catalogue().filter(of_rule).collect();
    if faults.len() > MAX_DESCRIBED {
        let names: Vec<String> = faults.iter().map(|fault| format!("`{}`", fault.name)).collect();
        return vec![format!(
            "{} (`frames-lint assure --list` describes them)",
            names.join(", ")
        )];
    }
    let described = faults
        .iter()
        .map(|fault| format!("`{}`: {}", fault.name, fault.sentence));
    described.collect()
}

/// The part of the views that shows what a rule judges.
pub fn sight(view: &str) -> Option<String> {
    let view = views::of(view)?;
    Some(match view.words() {
        Some(entity) => format!(
            "`frames-lint view PATH... -o views.rrd`, entity `{entity}`: {}.",
            view.what
        ),
        None => format!("Not shown in views: {}.", view.what),
    })
}

fn head(page: &Page, style: Style, out: &mut String) {
    let title = format!("{} {}", page.code, page.name);
    let _ = writeln!(out, "{}", style.paint(Ink::Strong, &title));
    paragraph(page.summary, style, out);
    out.push('\n');
    for (name, value) in page.facts() {
        let label = format!("  {name:<11} ");
        let _ = writeln!(
            out,
            "{}",
            wrap(value, Some(style.prose_width()), &label, "              ")
        );
    }
}

/// The limits with unit and reason, columns aligned.
fn limits(page: &Page, style: Style, out: &mut String) {
    if page.limits.is_empty() {
        return;
    }
    let rows: Vec<(&str, String, &str)> = page
        .limits
        .iter()
        .map(|limit| (limit.name, limit.words(), limit.reason))
        .collect();
    let width = |cell: fn(&(&str, String, &str)) -> usize| rows.iter().map(cell).max().unwrap_or(0);
    let (names, values) = (
        width(|row| row.0.chars().count()).max(5),
        width(|row| row.1.chars().count()).max(5),
    );
    let _ = writeln!(out, "\n{}", style.paint(Ink::Strong, "Limits"));
    let heading = format!("  {:<names$}  {:<values$}  reason", "limit", "value");
    let _ = writeln!(out, "{}", style.paint(Ink::Faint, &heading));
    for (name, value, reason) in &rows {
        let label = format!("  {name:<names$}  {value:<values$}  ");
        // After a very long name the reason goes on the next line.
        let indent = if label.chars().count() + 30 > style.prose_width() {
            let _ = writeln!(out, "{}", label.trim_end());
            "      ".to_owned()
        } else {
            " ".repeat(label.chars().count())
        };
        let first = if indent.len() == 6 { indent.clone() } else { label };
        let _ = writeln!(out, "{}", wrap(reason, Some(style.prose_width()), &first, &indent));
    }
}

/// A section: paragraphs and lists wrapped, tables as they are, fenced blocks indented.
fn prose(text: &str, style: Style, out: &mut String) {
    let mut running = String::new();
    let mut in_block = false;
    for line in text.lines() {
        if let Some(info) = line.strip_prefix("```") {
            flush(&mut running, style, out);
            in_block = !in_block;
            if in_block {
                block_title(info.trim(), style, out);
            } else {
                out.push('\n');
            }
        } else if in_block {
            let _ = writeln!(out, "{}", format!("      {line}").trim_end());
        } else if let Some(title) = line.strip_prefix("### ") {
            flush(&mut running, style, out);
            let _ = writeln!(out, "  {}", style.paint(Ink::Strong, title));
        } else if line.trim().is_empty() {
            flush(&mut running, style, out);
        } else if line.starts_with('|') {
            flush(&mut running, style, out);
            let _ = writeln!(out, "  {line}");
        } else {
            if is_item(line) {
                flush(&mut running, style, out);
            }
            if !running.is_empty() {
                running.push(' ');
            }
            running.push_str(line.trim());
        }
    }
    flush(&mut running, style, out);
    let kept = out.trim_end().len();
    out.truncate(kept);
    out.push('\n');
}

/// The title of a fenced block: a file, or the expected result for the files above it.
fn block_title(info: &str, style: Style, out: &mut String) {
    let (language, name) = info.split_once(' ').unwrap_or((info, ""));
    let title = match (language, name) {
        ("expect", _) => "expected result",
        (_, "") => return,
        (_, name) => name,
    };
    let _ = writeln!(out, "    {}", style.paint(Ink::Faint, &format!("{title}:")));
}

fn is_item(line: &str) -> bool {
    let line = line.trim_start();
    let numbered = line
        .split_once(". ")
        .is_some_and(|(number, _)| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()));
    line.starts_with("- ") || line.starts_with("* ") || numbered
}

fn flush(running: &mut String, style: Style, out: &mut String) {
    let text = std::mem::take(running);
    if text.is_empty() {
        return;
    }
    match text.strip_prefix("- ").or_else(|| text.strip_prefix("* ")) {
        Some(text) => item(text, style, out),
        None => paragraph(&text, style, out),
    }
}

fn paragraph(text: &str, style: Style, out: &mut String) {
    let _ = writeln!(out, "{}", wrap(text, Some(style.prose_width()), "  ", "  "));
}

fn item(text: &str, style: Style, out: &mut String) {
    let _ = writeln!(out, "{}", wrap(text, Some(style.prose_width()), "  - ", "    "));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::{Limit, Number, Status};
    use crate::rules::pages;

    #[test]
    fn the_page_of_a_rule_reads_well() {
        let text = render(&pages::TREE01, Style::PLAIN);
        assert!(
            text.starts_with("TREE01 orphan-subtree\n  frames that no chain"),
            "{text}"
        );
        for part in [
            "\n  severity    error\n",
            "\nWhat it checks\n  All frames of the URDF and of TF belong to one tree.\n",
            "    robot.urdf:\n      <robot name=\"cart\">\n        <link name=\"base_link\"/>\n",
            "    expected result:\n      error certain robot.urdf:9\n",
            "\nReferences\n  - REP-105",
        ] {
            assert!(text.contains(part), "no {part:?} in\n{text}");
        }
        assert!(!text.contains("```"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    }

    #[test]
    fn limits_are_a_table_and_lists_stay_lists() {
        let page = Page {
            code: "NONE01",
            status: Status::Trial,
            limits: &[
                Limit {
                    name: "angle_deg",
                    value: Number::Real(1.5),
                    unit: "deg",
                    reason: "why not",
                },
                Limit {
                    name: "count",
                    value: Number::Whole(2),
                    unit: "count",
                    reason: "two",
                },
            ],
            references: &[],
            view: "none",
            body: "\n## How it decides\n\nFirst:\n\n- one\n  more\n- two\n1. three\n\n| a | b |\n|---|---|\n\n### case\n\ntext\n",
            ..pages::TREE01
        };
        let text = render(&page, Style::PLAIN);
        let body = text.split_once("How it decides\n").unwrap().1;
        assert_eq!(
            body,
            "  First:\n  - one more\n  - two\n  1. three\n  | a | b |\n  |---|---|\n  case\n  text\n\nLimits\n  \
             limit      value    reason\n  angle_deg  1.5 deg  why not\n  count      2        two\n\nOnline: \
             https://frames-lint.github.io/frames-lint/rules/none01.html\n"
        );
        assert!(text.contains("trial: findings"));
    }
}
