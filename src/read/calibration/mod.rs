//! The reader of YAML and JSON files that may hold transforms.
//!
//! Owns the two entry points and the messages about how a file could be read. `repair`, `events` and `document` turn text into nodes,
//! `names` and `numbers` recognise, `shapes` knows spellings, `beams`, `origins`, `ouster`, `parameters` and `references` find what they are named after, `walk` and `generic` make claims, `dialect` knows formats,
//! `leftovers` finds what was not read.

mod beams;
mod cameras;
mod delays;
mod dialect;
pub(crate) mod document;
pub(crate) mod events;
mod frames;
mod generic;
mod leftovers;
mod names;
mod numbers;
mod origins;
pub mod ouster;
mod parameters;
pub(crate) mod plain;
mod projections;
mod references;
pub(crate) mod repair;
mod shapes;
mod walk;

#[cfg(test)]
mod tests;

use std::path::Path;

use crate::source::{LineIndex, Place, ReadStatus, Source, SourceValue, Span};
use crate::tables::{Dialect, Rows};
use crate::world::Facts;

use super::input::ending;
use super::launch;
use document::{Documents, Fault};
use leftovers::Leftover;
use repair::OffsetMap;

/// The dialects that a file may be of.
pub type Dialects = Rows<Dialect>;

/// Largest file that is read.
const MAX_BYTES: usize = 64 * 1024 * 1024;
/// Widths of a tab that are tried, likeliest first.
const TABS: [usize; 4] = [1, 4, 8, 2];

/// Reads a YAML file (`source.text`): transforms, frames and declared chains. Sets status, detail and problems.
pub fn read_yaml(source: &mut Source, dialects: &Dialects) -> Facts {
    read(source, dialects, |text, base| {
        let (body, wide) = repair::without_wide_commas(&repair::without_directives(text));
        let strict = events::build(&body, &OffsetMap::starting_at(base));
        if strict.fault.is_none() {
            return (strict, wide);
        }
        let widths = if repair::has_leading_tabs(&body) {
            TABS.as_slice()
        } else {
            &TABS[..1]
        };
        let mut best = strict;
        for tab in widths {
            let (corrected, map, notes) = repair::lenient(&body, base, *tab);
            let documents = events::build(&corrected, &map);
            let reach = |documents: &Documents| documents.fault.as_ref().map_or(usize::MAX, |fault| fault.at);
            if documents.fault.is_none() {
                return (documents, notes);
            }
            if reach(&documents) > reach(&best) {
                best = documents;
            }
        }
        (best, Vec::new())
    })
}

/// Reads a JSON file (`source.text`), with `//` and `/* */` comments. Sets status, detail and problems.
pub fn read_json(source: &mut Source, dialects: &Dialects) -> Facts {
    read(source, dialects, |text, base| {
        let body = repair::without_json_comments(text);
        (events::build(&body, &OffsetMap::starting_at(base)), Vec::new())
    })
}

/// Reads a calibration in plain text (`source.text`), by the ending of its name and its first lines. Sets status, detail and problems.
pub fn read_plain(source: &mut Source, dialects: &Dialects) -> Facts {
    let path = Path::new(&source.path);
    let form = plain::form(&ending(path), &source.text);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut facts = read(source, dialects, |text, base| {
        let Some(form) = form else {
            return (Documents::default(), Vec::new());
        };
        // A byte order mark moves the places.
        let mut documents = plain::build(form, text, &stem);
        if base > 0 {
            documents.shift(base);
        }
        (documents, Vec::new())
    });
    if form == Some(plain::Form::States) {
        let line = source.text.lines().next().map_or(0, str::len);
        let says = "OpenVINS itself writes JPL quaternions from the global frame to the IMU (q_GtoI), whose numbers are the Hamilton quaternion from the IMU to the global frame (q_ItoG); a converter may have written the Hamilton quaternion from the global frame to the IMU";
        facts
            .jpl
            .push(SourceValue::new(says.to_owned(), Place::text(source.id, 0..line)));
    }
    if form.is_some_and(plain::Form::is_over_time) && source.problems.is_empty() {
        source.detail = Some("poses over time (a trajectory), no mounting transforms".to_owned());
    }
    facts
}

type Corrections = Vec<(usize, &'static str)>;

fn read(source: &mut Source, dialects: &Dialects, parse: impl Fn(&str, usize) -> (Documents, Corrections)) -> Facts {
    let text = std::mem::take(&mut source.text);
    let facts = read_text(source, &text, dialects, parse);
    source.text = text;
    facts
}

fn read_text(
    source: &mut Source,
    text: &str,
    dialects: &Dialects,
    parse: impl Fn(&str, usize) -> (Documents, Corrections),
) -> Facts {
    source.examined.bytes_total = source.examined.bytes_total.max(text.len() as u64);
    if let Some(why) = refused(text) {
        source.problem(ReadStatus::Unreadable, Place::whole(source.id), why);
        return Facts::default();
    }
    let bom = if text.starts_with('\u{feff}') {
        '\u{feff}'.len_utf8()
    } else {
        0
    };
    let body = text.get(bom..).unwrap_or_default();
    if body.trim().is_empty() {
        source.detail = Some("empty file: no transforms found".to_owned());
        return Facts::default();
    }
    let (documents, corrected) = parse(body, bom);
    let dialect = dialect::recognise(&documents.roots, dialects);
    let mut walk = walk::Walk::new(source.id, text, dialect.as_deref());
    for root in &documents.roots {
        generic::read(root, &mut walk);
    }
    let (mut facts, mut problems) = walk.finish();
    for root in &documents.roots {
        facts.references.extend(references::collect(root, source.id));
        facts.origins.extend(origins::collect(root, source.id));
        facts.ousters.extend(ouster::collect(root, source.id));
        facts.beams.extend(beams::collect(root, source.id));
        facts.projections.extend(projections::collect(root, source.id));
        facts.frames.extend(parameters::collect(root, source.id));
        facts.delays.extend(delays::collect(root, source.id));
        let (cameras, faults) = cameras::collect(root, source.id, text);
        facts.cameras.extend(cameras);
        problems.extend(faults);
        facts.channels.extend(generic::channels(root));
        let launched = launch::collect_yaml(root, text, source.id);
        facts.claims.extend(launched.claims);
        facts.frames.extend(launched.frames);
        facts.publishers.extend(launched.publishers);
        facts.localizations.extend(launched.localizations);
        facts.drives.extend(launch::collect_drives(root, source.id));
    }
    let reached = documents.fault.as_ref().map_or(text.len(), |fault| fault.at);
    source.examined.bytes = reached as u64;
    report(source, text, &documents, &facts);
    let said: Vec<Span> = problems.iter().map(|(span, _)| *span).collect();
    for (span, message) in problems {
        source.problem(ReadStatus::Partial, Place::text(source.id, span), message);
    }
    not_understood(
        source,
        &leftovers::collect(&documents.roots, text, &facts.claims, &said),
        &facts,
    );
    describe(source, text, &documents, &corrected, &facts, dialect.as_deref());
    facts
}

/// Reports what looks like transforms but was not read. A file that contains nothing else counts as not read.
fn not_understood(source: &mut Source, leftovers: &[Leftover], facts: &Facts) {
    let place = |span: Span| Place::text(source.id, span);
    let whole = leftovers.iter().find(|leftover| leftover.is_whole);
    let problem = whole.filter(|_| facts.words().is_none()).map(|first| {
        let message = format!(
            "contains transforms in an unknown form and was not read; the first is `{}`",
            first.label
        );
        (place(first.span), message)
    });
    let placed = |leftover: &Leftover| SourceValue::new(leftover.label.clone(), place(leftover.span));
    source.not_understood = leftovers.iter().map(placed).collect();
    if let Some((place, message)) = problem {
        let help = "write each transform as a matrix, or as `translation` and `rotation`, under a key that names both frames (`base_link_from_lidar`)";
        source.problem_with_help(ReadStatus::Partial, place, message, Some(help.to_owned()));
    }
}

/// Why a text is not read at all.
fn refused(text: &str) -> Option<String> {
    if text.len() > MAX_BYTES {
        let megabytes = text.len() / (1024 * 1024);
        return Some(format!("the file has {megabytes} MB; at most 64 MB are read"));
    }
    let nul = text.find('\0')?;
    Some(format!(
        "the file contains binary data, not text: a NUL character at byte {nul}"
    ))
}

/// Records the fault that ended reading, or the templates in place of values.
fn report(source: &mut Source, text: &str, documents: &Documents, facts: &Facts) {
    let some = documents
        .roots
        .iter()
        .any(|root| !root.pairs().is_empty() || root.items().is_some());
    let status = if some || !facts.claims.is_empty() {
        ReadStatus::Partial
    } else {
        ReadStatus::Unreadable
    };
    let template = template(text).or(documents.templates.first().map(|span| span.start));
    if let Some(at) = template.filter(|_| documents.fault.is_some() || !documents.templates.is_empty()) {
        source.problem_with_help(
            status,
            Place::text(source.id, at..at + 2),
            "the file is a template: its values are filled in by another program",
            Some("check the file that is generated from it".to_owned()),
        );
    } else if let Some(Fault { at, message }) = &documents.fault {
        let end = text
            .get(*at..)
            .and_then(|rest| rest.chars().next())
            .map_or(*at, |c| at + c.len_utf8());
        source.problem(status, Place::text(source.id, *at..end), message.clone());
    }
}

/// The first mark of a template engine (`{{ x }}`, `{% if %}`).
fn template(text: &str) -> Option<usize> {
    let pairs = [("{{", "}}"), ("{%", "%}")];
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let code = line.split('#').next().unwrap_or_default();
        for (open, close) in pairs {
            if let Some(at) = code
                .find(open)
                .filter(|at| code.get(*at..).is_some_and(|rest| rest.contains(close)))
            {
                return Some(start + at);
            }
        }
        start += line.len();
    }
    None
}

/// The one-line summary of a source: what was found, what was repaired, which keys are repeated.
fn describe(
    source: &mut Source,
    text: &str,
    documents: &Documents,
    corrected: &Corrections,
    facts: &Facts,
    dialect: Option<&Dialect>,
) {
    let mut notes: Vec<String> = dialect.map(|dialect| dialect.says.clone()).into_iter().collect();
    if !facts.ousters.is_empty() && facts.claims.is_empty() {
        notes.push("Ouster metadata, no transforms".to_owned());
    } else if let Some(beams) = facts.beams.first().filter(|_| facts.claims.is_empty()) {
        notes.push(format!("angles of the beams of a {}, no transforms", beams.maker));
    } else if !facts.origins.is_empty() && facts.claims.is_empty() {
        notes.push("an origin on the Earth, no transforms".to_owned());
    } else if !facts.projections.is_empty() && facts.claims.is_empty() {
        notes.push("a projection, no transforms".to_owned());
    } else if !facts.channels.is_empty() && facts.claims.is_empty() {
        notes.push("names of sensors, no transforms".to_owned());
    } else if facts.claims.is_empty() && documents.roots.iter().any(generic::has_track) {
        notes.push("poses over time (a trajectory), no mounting transforms".to_owned());
    } else if facts.claims.is_empty() && facts.chains.is_empty() {
        notes.push("no transforms found".to_owned());
    }
    if let Some((line, what)) = corrected.first() {
        let more = match corrected.len() - 1 {
            0 => String::new(),
            1 => " (and 1 more line)".to_owned(),
            n => format!(" (and {n} more lines)"),
        };
        notes.push(format!("not strict YAML: line {line}: {what}{more}"));
    }
    if let Some((key, span)) = documents.repeated.first() {
        let line = LineIndex::new(text).locate(text, span.start).line;
        let more = match documents.repeated.len() - 1 {
            0 => String::new(),
            n => format!(" (and {n} more)"),
        };
        notes.push(format!("the key `{key}` is repeated in line {line}{more}"));
    }
    if source.detail.is_none() && !notes.is_empty() {
        source.detail = Some(notes.join("; "));
    }
}
