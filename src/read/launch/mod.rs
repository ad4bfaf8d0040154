//! The reader of launch files and scripts: the static transforms that they publish, and the settings of localisation nodes.
//!
//! Owns the entry point and the notion of a call. `xml`, `python` and `shell` find calls in their grammar, `command` reads the arguments of one,
//! `traced` keeps the place of every letter through substitutions, `settings` lists the settings that are kept,
//! `drives` finds controllers that publish odometry.

mod command;
mod drives;
mod python;
mod settings;
mod shell;
#[cfg(test)]
mod tests;
mod traced;
mod xml;
mod yaml;

use std::path::Path;

use crate::source::{LineIndex, Place, ReadStatus, Source, SourceId, Span};
use crate::world::launch::PROGRAM;
use crate::world::{Facts, FrameRole, FrameUse};

use super::input::ending;

pub(crate) use drives::collect as collect_drives;
pub(crate) use yaml::collect as collect_yaml;

/// The grammar of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Grammar {
    Xml,
    Python,
    Shell,
}

/// The grammar of a launch file or script by the ending of its name, in lower case, and its first bytes; `None` where it is neither.
fn grammar(ending: &str, head: &str) -> Option<Grammar> {
    let publishes = || head.contains(PROGRAM);
    match ending {
        "launch" | "launch.xml" => Some(Grammar::Xml),
        "xml" if head.contains("<launch") => Some(Grammar::Xml),
        "launch.py" => Some(Grammar::Python),
        "py" if publishes() || head.contains("LaunchDescription") => Some(Grammar::Python),
        "sh" | "bash" | "zsh" if publishes() => Some(Grammar::Shell),
        _ if head.starts_with("#!") && publishes() => {
            let line = head.lines().next().unwrap_or_default();
            if line.contains("python") {
                Some(Grammar::Python)
            } else {
                line.ends_with("sh").then_some(Grammar::Shell)
            }
        }
        _ => None,
    }
}

/// Whether a file is a launch file or a script that publishes transforms.
pub(crate) fn is_launch(ending: &str, head: &str) -> bool {
    grammar(ending, head).is_some()
}

/// Reads a launch file or script (`source.text`). Sets status, detail and problems.
pub fn read(source: &mut Source) -> Facts {
    let text = std::mem::take(&mut source.text);
    let mut found = LaunchFacts::new(source.id);
    match grammar(&ending(Path::new(&source.path)), &text) {
        Some(Grammar::Python) => python::read(&text, &mut found),
        Some(Grammar::Shell) => shell::read(&text, &mut found),
        Some(Grammar::Xml) | None => xml::read(&text, &mut found),
    }
    source.text = text;
    finish(found, source)
}

/// Converts what was found to facts, and the rest to problems and notes of the source.
fn finish(found: LaunchFacts, source: &mut Source) -> Facts {
    let LaunchFacts { facts, faults, off, .. } = found;
    for (span, message) in faults {
        let status = if facts.publishers.is_empty() {
            ReadStatus::Unreadable
        } else {
            ReadStatus::Partial
        };
        source.problem(status, Place::text(source.id, span), message);
    }
    let open = facts.publishers.iter().filter(|call| call.unread.is_some()).count();
    let mut notes = Vec::new();
    if facts.publishers.is_empty() && facts.localizations.is_empty() {
        notes.push("no transforms found".to_owned());
    }
    if open > 0 {
        notes.push(format!(
            "the arguments of {open} static transform(s) cannot be determined here"
        ));
    }
    if !off.is_empty() {
        let lines = LineIndex::new(&source.text);
        let named = off.into_iter().map(|(name, span)| {
            let line = lines.locate(&source.text, span.start).line;
            name.map_or_else(|| format!("line {line}"), |name| format!("`{name}` (line {line})"))
        });
        let named: Vec<String> = named.collect();
        let what = "not judged, under a condition that is false by default";
        source.notes.push(format!("{what}: {}", named.join(", ")));
    }
    if source.detail.is_none() && !notes.is_empty() {
        source.detail = Some(notes.join("; "));
    }
    facts
}

/// One argument of a call and its place.
#[derive(Clone, Debug, PartialEq)]
struct Word {
    text: String,
    span: Span,
    /// Whether a part of it is not known: a substitution that cannot be resolved here.
    is_open: bool,
    /// Whether it comes from a default that a user may override.
    is_default: bool,
}

/// Whether a call is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum CallCondition {
    /// In every case.
    Always,
    /// Under a condition that holds by default.
    ByDefault,
    /// Under a condition that is not known.
    Perhaps,
    /// Not by default.
    Off,
}

/// A call of `static_transform_publisher`.
struct Call {
    name: Option<String>,
    package: Option<String>,
    is_ros2: Option<bool>,
    when: CallCondition,
    words: Vec<Word>,
    /// The whole call.
    span: Span,
}

/// What was found in a file.
struct LaunchFacts {
    source: SourceId,
    facts: Facts,
    faults: Vec<(Span, String)>,
    /// Calls that are not made by default: names and places.
    off: Vec<(Option<String>, Span)>,
}

impl LaunchFacts {
    fn new(source: SourceId) -> Self {
        Self {
            source,
            facts: Facts::default(),
            faults: Vec::new(),
            off: Vec::new(),
        }
    }

    fn call(&mut self, call: &Call) {
        if call.when == CallCondition::Off {
            self.off.push((call.name.clone(), call.span));
            return;
        }
        let ordinal = self.facts.publishers.len() + 1;
        let (publisher, claim) = command::read(call, self.source, ordinal);
        if let Some(claim) = &claim
            && let Some((parent, child)) = &claim.frames
        {
            for (frame, place) in [(parent, &claim.target_place), (child, &claim.source_place)] {
                let known = self
                    .facts
                    .frames
                    .iter_mut()
                    .find(|used| used.frame == *frame && used.role == FrameRole::Calibration);
                match known {
                    Some(used) => used.count += 1,
                    None => self.facts.frames.push(FrameUse {
                        frame: frame.clone(),
                        role: FrameRole::Calibration,
                        place: place.clone().unwrap_or_else(|| claim.place.clone()),
                        count: 1,
                    }),
                }
            }
        }
        self.facts.claims.extend(claim);
        self.facts.publishers.push(publisher);
    }
}
