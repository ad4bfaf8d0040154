//! `frames-lint assure`.

use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;

use crate::engine;
use crate::faults::Selection;
use crate::files::Outputs;
use crate::report::{Style, assure as report, terminal};
use crate::run::{EXIT_CLEAN, EXIT_CRASHED, EXIT_INCOMPLETE};
use crate::verdict::{KeptOutcomes, Outcome};

use super::args::{Assure, AssureFormat, Output};
use super::{Answer, Failure, Surroundings, paths_or_here, save};

/// Tries known mistakes on the inputs. 0: tried; 3: nothing could be tried, or an input was not read in full; 70: internal error.
pub(super) fn run(asked: Assure, stdin: &mut dyn Read, surroundings: Surroundings) -> Result<Answer, Failure> {
    let faults = selected(&asked.select)?;
    if asked.list {
        return Ok(Answer {
            out: report::list_text(&faults, surroundings.style),
            ..Answer::default()
        });
    }
    let given = paths_or_here(asked.paths, &asked.evidence, stdin)?;
    let run = engine::check(&engine::Options {
        config: asked.config,
        evidence: asked.evidence,
        assure: Some(faults),
        outputs: Outputs {
            files: asked.output.iter().map(|output| output.file.clone()).collect(),
            force: asked.force,
            ..Outputs::default()
        },
        sights: engine::Retention::None,
        outcomes: KeptOutcomes::Unreported,
        ..asked.reading.options(given, surroundings)
    })?;
    let assurance = run.assurance.clone().unwrap_or_default();
    let style = if asked.output.is_some() {
        Style::PLAIN
    } else {
        surroundings.style
    };
    let output = asked.output.as_ref();
    let format = output.and_then(|output| output.format).or(asked.format);
    let by_file = || output.map_or(AssureFormat::Text, |output| by_extension(&output.file));
    let mut out = match format.unwrap_or_else(by_file) {
        AssureFormat::Text => report::text(&assurance, asked.all, style),
        AssureFormat::Json => report::json(&assurance)?,
        AssureFormat::Markdown => report::markdown(&assurance),
        AssureFormat::Html => report::html(&assurance),
    };
    if let Some(Output { file, .. }) = asked.output {
        save(&file, std::mem::take(&mut out))?;
    }
    let plain = Style {
        color: false,
        ..surroundings.style
    };
    let is_empty = assurance.trials.is_empty() && assurance.smallest.is_empty();
    let is_incomplete = is_empty || run.unread().next().is_some();
    Ok(Answer {
        out,
        err: terminal::render_unread(&run, plain),
        code: match () {
            () if run.verdict.count(Outcome::Crashed) > 0 => EXIT_CRASHED,
            () if is_incomplete => EXIT_INCOMPLETE,
            () => EXIT_CLEAN,
        },
        ..Answer::default()
    })
}

/// The format of a file by its extension.
fn by_extension(file: &Path) -> AssureFormat {
    let extension = file.extension().and_then(OsStr::to_str);
    match extension.map(str::to_lowercase).as_deref() {
        Some("json") => AssureFormat::Json,
        Some("md") => AssureFormat::Markdown,
        Some("html" | "htm") => AssureFormat::Html,
        _ => AssureFormat::Text,
    }
}

/// The mistakes with these names or of these families; all if there are none.
fn selected(select: &[String]) -> Result<Selection, Failure> {
    if let Some(what) = select.iter().find_map(|word| engine::unknown_mistake(word)) {
        return Err(Failure::Usage(what));
    }
    Ok(if select.is_empty() {
        Selection::all()
    } else {
        Selection::of(&select.iter().map(String::as_str).collect::<Vec<_>>())
    })
}
