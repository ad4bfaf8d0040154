//! Inputs: what was read of them, problems with their places, recordings read in part, skipped files.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::run::Run;
use crate::source::{Coverage, ReadStatus, Source, SourceId, SourceKind, SourcePart};

use super::super::Style;
use super::super::place::Locator;
use super::super::style::Ink;
use super::super::text::{bytes, clean, one_line, plural, wrap};
use super::finding::place_line;
use super::snippet::{Mark, Painter};
use super::{Options, heading};

/// More problems of one input are only counted.
const MAX_PROBLEMS: usize = 10;
/// More kinds of skipped files are only counted.
const MAX_SKIPPED: usize = 12;

/// More platforms are only counted.
const MAX_PLATFORMS: usize = 3;
/// More inputs are only counted, unless all checks are listed.
const MAX_TAKEN: usize = 20;
/// More inputs without content are only counted, unless all checks are listed.
const MAX_SILENT: usize = 3;

/// What was read from each input, in a line, and notes on how it was judged.
pub(super) fn taken(run: &Run, options: &Options, locator: &Locator, out: &mut String) {
    let has_words = |source: &&Source| source.understood().is_some() || !source.notes.is_empty();
    let sources: Vec<&Source> = run.sources.iter().map(AsRef::as_ref).filter(has_words).collect();
    let places = run.verdict.findings.iter().flat_map(|finding| &finding.places);
    let found: BTreeSet<SourceId> = places.map(|label| label.place.source).collect();
    let is_silent = |source: &&Source| {
        is_text(source.kind) && source.status == ReadStatus::Read && !has_words(source) && !found.contains(&source.id)
    };
    let silent: Vec<&Source> = run.sources.iter().map(AsRef::as_ref).filter(is_silent).collect();
    if sources.is_empty() && silent.is_empty() {
        return;
    }
    let shown = if options.verbose { sources.len() } else { MAX_TAKEN };
    heading(options.style, "Read", sources.len(), "input", out);
    for source in sources.iter().take(shown) {
        let what: Vec<String> = source
            .understood()
            .into_iter()
            .chain(source.notes.iter().cloned())
            .collect();
        let line = format!("{}: {}", locator.name(source.id), what.join("; "));
        let _ = writeln!(out, "{}", wrap(&one_line(&line), options.style.width, "  ", "    "));
    }
    if sources.len() > shown {
        let _ = writeln!(
            out,
            "  ... and {} (list with --verbose)",
            plural(sources.len() - shown, "more input")
        );
    }
    if !silent.is_empty() {
        let named = if options.verbose { silent.len() } else { MAX_SILENT };
        let mut names: Vec<String> = silent.iter().take(named).map(|one| locator.name(one.id)).collect();
        if silent.len() > named {
            names.push(format!("{} more", silent.len() - named));
        }
        let line = format!("nothing to check in {}", names.join(", "));
        let _ = writeln!(out, "{}", wrap(&one_line(&line), options.style.width, "  ", "    "));
    }
    out.push('\n');
}

/// Whether files of this kind may contain transforms as text.
fn is_text(kind: SourceKind) -> bool {
    matches!(
        kind,
        SourceKind::Yaml | SourceKind::Json | SourceKind::Text | SourceKind::Launch
    )
}

/// Inputs with problems, each with place and help.
pub(super) fn unread(run: &Run, locator: &Locator, painter: &Painter, style: Style, out: &mut String) {
    let broken: Vec<&Source> = run
        .sources
        .iter()
        .map(AsRef::as_ref)
        .filter(|source| (source.required && source.status != ReadStatus::Read) || has_placed_problem(source))
        .collect();
    if broken.is_empty() {
        return;
    }
    heading(style, "Inputs with problems", broken.len(), "input", out);
    for source in broken {
        let ink = if source.status == ReadStatus::Unreadable {
            Ink::Error
        } else {
            Ink::Warning
        };
        let status = style.paint(ink, source.status.word());
        let name = one_line(&locator.name(source.id));
        let detail = source.detail.as_deref().unwrap_or_default();
        let _ = writeln!(out, "  {status} {name} ({})", source.kind.word());
        let said = source.problems.iter().any(|problem| problem.message == detail);
        if !detail.is_empty() && !said {
            let _ = writeln!(out, "{}", wrap(&clean(detail), style.width, "    ", "    "));
        }
        for problem in source.problems.iter().take(MAX_PROBLEMS) {
            let _ = writeln!(out, "{}", wrap(&clean(&problem.message), style.width, "    ", "    "));
            problem_place(problem, locator, painter, style, out);
            if let Some(help) = &problem.help {
                let _ = writeln!(out, "{}", wrap(&clean(help), style.width, "    help: ", "          "));
            }
        }
        if source.problems.len() > MAX_PROBLEMS {
            let more = plural(source.problems.len() - MAX_PROBLEMS, "more problem");
            let _ = writeln!(out, "    ... and {more}");
        }
    }
    out.push('\n');
}

/// Optional inputs with a problem at a place are shown; optional files in unsupported formats are not.
fn has_placed_problem(source: &Source) -> bool {
    source
        .problems
        .iter()
        .any(|problem| problem.place.at != SourcePart::Whole)
}

fn problem_place(
    problem: &crate::source::Problem,
    locator: &Locator,
    painter: &Painter,
    style: Style,
    out: &mut String,
) {
    let snippet = problem.place.span().and_then(|span| {
        let mark = Mark {
            span,
            note: String::new(),
            primary: true,
        };
        painter.snippet(problem.place.source, &[mark])
    });
    match (snippet, &problem.place.at) {
        (Some(snippet), _) => out.push_str(&snippet),
        (None, SourcePart::Whole) => {}
        (None, _) => {
            let _ = writeln!(out, "  {}", place_line(&problem.place, "", locator, style));
        }
    }
}

/// Recordings of which only a part was examined.
pub(super) fn partly_examined(run: &Run, style: Style, out: &mut String) {
    let partly: Vec<&Source> = run
        .sources
        .iter()
        .map(AsRef::as_ref)
        .filter(|source| source.kind.is_bag() && source.status != ReadStatus::Unreadable)
        .filter(|source| source.examined.bytes < source.examined.bytes_total)
        .collect();
    if partly.is_empty() {
        return;
    }
    heading(style, "Read in part", partly.len(), "recording", out);
    for source in partly {
        let mut parts = examined_words(&source.examined);
        if source.examined.windows.is_some() {
            parts.push("read everything with --full".to_owned());
        }
        let _ = writeln!(out, "  {}: {}", one_line(&source.path), parts.join(", "));
    }
    out.push('\n');
}

/// The platforms, if there are several: their files are not compared with each other.
pub(super) fn judged_apart(run: &Run, style: Style, out: &mut String) {
    if run.platforms.len() < 2 || !run.recordings.is_empty() {
        return;
    }
    heading(style, "Judged apart", run.platforms.len(), "platform", out);
    let named: Vec<String> = run
        .platforms
        .iter()
        .take(MAX_PLATFORMS)
        .map(|label| one_line(label))
        .collect();
    let more = match run.platforms.len().saturating_sub(MAX_PLATFORMS) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let words = format!(
        "{}{more}: their files are not compared with each other; files of one robot are compared if they are in one folder",
        named.join(", ")
    );
    let _ = writeln!(out, "{}\n", wrap(&words, style.width, "  ", "  "));
}

/// How much of a source was read: bytes, messages, and time in windows.
pub(in crate::report) fn examined_words(examined: &Coverage) -> Vec<String> {
    let mut parts = vec![share(
        "",
        &bytes(examined.bytes),
        &bytes(examined.bytes_total),
        examined.bytes as f64 / examined.bytes_total.max(1) as f64,
    )];
    match (examined.messages, examined.messages_total) {
        (Some(read), Some(total)) if total >= read => parts.push(share(
            " messages",
            &read.to_string(),
            &total.to_string(),
            read as f64 / total.max(1) as f64,
        )),
        (Some(read), _) => parts.push(plural_u64(read)),
        _ => {}
    }
    if let (Some(windows), Some(read), Some(total)) = (examined.windows, examined.time_ns, examined.time_total_ns) {
        let seconds = |ns: i64| format!("{:.1}", ns as f64 / 1e9);
        let time = share(" s", &seconds(read), &seconds(total), read as f64 / total.max(1) as f64);
        let stretches = if windows == 1 { "window" } else { "windows" };
        parts.push(format!("{time} in {windows} {stretches}"));
    }
    parts
}

/// `3 of 100 messages (3.0 %)`.
fn share(unit: &str, read: &str, total: &str, share: f64) -> String {
    format!("{read} of {total}{unit} ({:.1} %)", share * 100.0)
}

fn plural_u64(count: u64) -> String {
    if count == 1 {
        "1 message".to_owned()
    } else {
        format!("{count} messages")
    }
}

/// Files in folders with unsupported formats, by kind; with `--verbose` all kinds.
pub(super) fn skipped(run: &Run, options: &Options, out: &mut String) {
    let unsupported = run
        .sources
        .iter()
        .map(AsRef::as_ref)
        .filter(|source| !source.required && source.status != ReadStatus::Read && !has_placed_problem(source));
    let mut named: Vec<String> = unsupported.map(|source| one_line(&source.path)).collect();
    let mut kinds: Vec<(&String, &usize)> = run.skipped.iter().collect();
    kinds.sort_by(|a, b| (b.1, a.0).cmp(&(a.1, b.0)));
    named.extend(
        kinds
            .into_iter()
            .map(|(kind, count)| format!("{} {}", count, one_line(kind))),
    );
    if named.is_empty() {
        return;
    }
    let shown = if options.verbose {
        named.len()
    } else {
        named.len().min(MAX_SKIPPED)
    };
    let more = named.len() - shown;
    named.truncate(shown);
    let rest = if more > 0 {
        format!(" and {}", plural(more, "more kind"))
    } else {
        String::new()
    };
    let line = format!("Skipped (format not supported): {}{rest}", named.join(", "));
    let _ = writeln!(out, "{}\n", wrap(&line, options.style.width, "", "  "));
}
