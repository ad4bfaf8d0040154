//! The JSON document of a run, one line for each of its parts: `{"type": "finding", ...}`. The keys are those of
//! `schema/frames-lint-1.json`; the last line is the summary. Each of several recordings is written when it has been judged: its outcomes
//! and findings, then a line with its verdict.

use serde::Serialize;

use crate::run::{FailOn, Run, RunUpdate};
use crate::visible::json_line;

use super::assured::AssuranceRows;
use super::json;
use super::place::Locator;

/// A part of the document with its type.
#[derive(Serialize)]
struct Line<T> {
    r#type: &'static str,
    #[serde(flatten)]
    part: T,
}

fn line<T: Serialize>(kind: &'static str, part: T, out: &mut String) -> Result<(), serde_json::Error> {
    out.push_str(&json_line(&Line { r#type: kind, part })?);
    Ok(())
}

/// The first line.
pub fn start() -> Result<String, serde_json::Error> {
    let mut out = String::new();
    line("run", json::Producer::new(json::SCHEMA), &mut out)?;
    Ok(out)
}

/// Bytes of lines that are passed on together.
const TOGETHER: usize = 1 << 20;

/// Writes what was added to a run; `take` receives one block of lines after the other.
pub fn grown(run: &Run, grown: &RunUpdate, take: &mut dyn FnMut(&str)) -> Result<(), serde_json::Error> {
    let mut out = String::new();
    let mut hand_on = |out: &mut String, least: usize| {
        if out.len() > least {
            take(out);
            out.clear();
        }
    };
    let locator = Locator::new(&run.sources);
    for source in grown.sources.iter().filter_map(|number| run.sources.get(*number)) {
        line("input", json::input(source, &locator), &mut out)?;
        hand_on(&mut out, TOGETHER);
    }
    for row in run.listed(run.verdict.rows.get(grown.rows.clone()).unwrap_or_default()) {
        line("outcome", json::outcome(row), &mut out)?;
        hand_on(&mut out, TOGETHER);
    }
    for finding in run.verdict.findings.get(grown.findings.clone()).unwrap_or_default() {
        line("finding", json::finding_row(finding, &locator), &mut out)?;
        hand_on(&mut out, TOGETHER);
    }
    if let Some(recording) = grown.recording.and_then(|number| run.recordings.get(number)) {
        line("recording", json::recording(recording), &mut out)?;
    }
    hand_on(&mut out, 0);
    Ok(())
}

/// Writes what is known when everything has been judged.
pub fn end(run: &Run, fail_on: FailOn) -> Result<String, serde_json::Error> {
    let mut out = String::new();
    for unmet in &run.unmet {
        line("required", json::unmet(unmet), &mut out)?;
    }
    if let Some(assurance) = &run.assurance {
        line("assurance", AssuranceRows::of(assurance), &mut out)?;
    }
    for fitness in &run.fitness {
        line("fitness", json::FitnessRow::of(fitness), &mut out)?;
    }
    line("summary", json::counts(&run.summary(fail_on)), &mut out)?;
    Ok(out)
}

/// All lines of a completed run.
pub(super) fn render(run: &Run, fail_on: FailOn) -> Result<String, serde_json::Error> {
    let mut out = start()?;
    grown(run, &RunUpdate::all(run), &mut |lines| out.push_str(lines))?;
    for recording in &run.recordings {
        line("recording", json::recording(recording), &mut out)?;
    }
    Ok(out + &end(run, fail_on)?)
}
