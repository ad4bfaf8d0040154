//! The JSON document of a run: frozen apart from the types inside, described by `schema/frames-lint-1.json`.
//!
//! Every key is always present, `null` without a value. Numbers that JSON does not support (NaN, infinite) are `null`. Lines and
//! columns are one-based, ends are exclusive, columns count characters. Changing a key's meaning or removing a key needs a new
//! schema name.

mod fitness;
#[cfg(test)]
mod tests;

use std::io::Write;
use std::sync::Arc;

use serde::Serialize;

use crate::run::{FailOn, Recording, Run, Summary, UnmetRequirement};
use crate::source::{Problem, Source, SourceValue};
use crate::verdict::waiver::Day;
use crate::verdict::{Acceptance, Explainer, Finding, Fix, Label, Measured, PlaceRole, Row, Safety};

use crate::visible::{text, write_json};

use super::assured::AssuranceRows;
use super::place::{Locator, Spot};
pub(super) use fitness::FitnessRow;

/// Name of the document's schema.
pub const SCHEMA: &str = "frames-lint/1";

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    made: Producer,
    inputs: Rows<'a, Arc<Source>, Input<'a>>,
    outcomes: Outcomes<'a>,
    findings: Rows<'a, Finding, FindingRow<'a>>,
    explained: Rows<'a, Finding, FindingRow<'a>>,
    required: Vec<UnmetRow<'a>>,
    assurance: Option<AssuranceRows<'a>>,
    fitness: Vec<FitnessRow<'a>>,
    recordings: Vec<RecordingRow<'a>>,
    summary: Counts,
}

/// The tool and the schema of the document.
#[derive(Serialize)]
pub(super) struct Producer {
    schema: &'static str,
    tool: Tool,
}

impl Producer {
    pub(super) fn new(schema: &'static str) -> Self {
        Self {
            schema,
            tool: Tool {
                name: env!("CARGO_PKG_NAME"),
                version: env!("CARGO_PKG_VERSION"),
            },
        }
    }
}

/// Items that are converted one by one while they are written: a hostile file may have a hundred thousand findings.
struct Rows<'a, T, R> {
    items: &'a [T],
    locator: &'a Locator<'a>,
    row: fn(&'a T, &Locator) -> R,
}

impl<T, R: Serialize> Serialize for Rows<'_, T, R> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.items.iter().map(|item| (self.row)(item, self.locator)))
    }
}

/// The outcomes that are listed, one by one as well.
struct Outcomes<'a>(&'a Run);

impl Serialize for Outcomes<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.listed(&self.0.verdict.rows).map(outcome))
    }
}

#[derive(Serialize)]
struct Tool {
    name: &'static str,
    version: &'static str,
}

#[derive(Serialize)]
pub(super) struct Input<'a> {
    path: &'a str,
    kind: &'static str,
    status: &'static str,
    detail: Option<&'a str>,
    taken: Option<&'a str>,
    not_understood: Vec<CommentRow<'a>>,
    notes: &'a [String],
    examined: Share,
    problems: Vec<InputProblem<'a>>,
}

#[derive(Serialize)]
struct Share {
    bytes: u64,
    bytes_total: u64,
    messages: Option<u64>,
    messages_total: Option<u64>,
    time_s: Option<f64>,
    time_total_s: Option<f64>,
    windows: Option<u64>,
}

#[derive(Serialize)]
struct CommentRow<'a> {
    part: &'a str,
    line: Option<usize>,
    column: Option<usize>,
}

#[derive(Serialize)]
struct InputProblem<'a> {
    message: &'a str,
    help: Option<&'a str>,
    #[serde(flatten)]
    at: PlaceKeys,
}

#[derive(Serialize)]
pub(super) struct OutcomeRow<'a> {
    rule: &'a str,
    name: &'a str,
    subject: &'a str,
    outcome: &'static str,
    reason: Option<&'a str>,
    measured: Vec<Number<'a>>,
}

#[derive(Serialize)]
pub(super) struct FindingRow<'a> {
    rule: &'a str,
    name: &'a str,
    subject: &'a str,
    severity: &'static str,
    confidence: &'static str,
    message: &'a str,
    detail: &'a str,
    help: &'a str,
    relation: Option<&'a str>,
    places: Vec<PlaceRow>,
    measured: Vec<Number<'a>>,
    fix: Option<FixRow<'a>>,
    waived: Option<WaivedRow<'a>>,
    explained_by: Option<&'a Explainer>,
}

#[derive(Serialize)]
struct WaivedRow<'a> {
    reason: &'a str,
    by: Option<&'a str>,
    until: Option<&'a str>,
    origin: &'a str,
}

#[derive(Serialize)]
pub(super) struct UnmetRow<'a> {
    rule: &'a str,
    name: &'a str,
    subject: Option<&'a str>,
    why: &'a [String],
    record: Option<&'a str>,
    origin: &'a str,
    recordings: &'a [String],
    waived: Option<WaivedRow<'a>>,
}

#[derive(Serialize)]
pub(super) struct RecordingRow<'a> {
    label: &'a str,
    #[serde(flatten)]
    counts: Counts,
    exit_code: u8,
    because: Option<&'a str>,
}

#[derive(Serialize)]
struct PlaceRow {
    role: &'static str,
    #[serde(flatten)]
    at: PlaceKeys,
    note: String,
}

#[derive(Serialize)]
struct PlaceKeys {
    path: String,
    line: Option<usize>,
    column: Option<usize>,
    end_line: Option<usize>,
    end_column: Option<usize>,
    topic: Option<String>,
    index: Option<u64>,
    stamp_ns: Option<i64>,
    field: Option<String>,
}

#[derive(Serialize)]
struct Number<'a> {
    what: &'a str,
    value: Option<f64>,
    unit: &'a str,
    limit: Option<f64>,
    spread: Option<f64>,
    n: Option<u64>,
}

#[derive(Serialize)]
struct FixRow<'a> {
    title: &'a str,
    safety: &'static str,
    edits: Vec<EditRow<'a>>,
}

#[derive(Serialize)]
struct EditRow<'a> {
    path: String,
    line: usize,
    column: usize,
    end_line: usize,
    end_column: usize,
    replacement: &'a str,
}

#[derive(Serialize)]
pub(super) struct Counts {
    errors: usize,
    warnings: usize,
    notes: usize,
    hints: usize,
    applicable: usize,
    judged: usize,
    passed: usize,
    not_evaluated: usize,
    not_applicable: usize,
    waived: usize,
    explained: usize,
    crashed: usize,
    verdict: &'static str,
}

/// The document, indented, with a newline at its end.
pub fn render(run: &Run, fail_on: FailOn) -> Result<String, serde_json::Error> {
    text(|to| write(run, fail_on, to))
}

/// Writes the document part by part: for thousands of platforms it is larger than all their data.
pub fn write(run: &Run, fail_on: FailOn, to: &mut dyn Write) -> Result<(), serde_json::Error> {
    let locator = Locator::new(&run.sources);
    let document = Document {
        made: Producer::new(SCHEMA),
        inputs: Rows {
            items: &run.sources,
            locator: &locator,
            row: input,
        },
        outcomes: Outcomes(run),
        findings: Rows {
            items: &run.verdict.findings,
            locator: &locator,
            row: finding_row,
        },
        explained: Rows {
            items: &run.verdict.explained,
            locator: &locator,
            row: finding_row,
        },
        required: run.unmet.iter().map(unmet).collect(),
        assurance: run.assurance.as_ref().map(AssuranceRows::of),
        fitness: run.fitness.iter().map(FitnessRow::of).collect(),
        recordings: run.recordings.iter().map(recording).collect(),
        summary: counts(&run.summary(fail_on)),
    };
    write_json(&document, to)
}

pub(super) fn counts(summary: &Summary) -> Counts {
    Counts {
        errors: summary.errors,
        warnings: summary.warnings,
        notes: summary.notes,
        hints: summary.hints,
        applicable: summary.applicable,
        judged: summary.judged,
        passed: summary.passed,
        not_evaluated: summary.not_evaluated,
        not_applicable: summary.not_applicable,
        waived: summary.waived,
        explained: summary.explained,
        crashed: summary.crashed,
        verdict: summary.verdict.word(),
    }
}

pub(super) fn recording(recording: &Recording) -> RecordingRow<'_> {
    RecordingRow {
        label: &recording.label,
        counts: counts(&recording.summary),
        exit_code: recording.code,
        because: recording.because.as_deref(),
    }
}

pub(super) fn input<'a>(source: &'a Arc<Source>, locator: &Locator) -> Input<'a> {
    Input {
        path: &source.path,
        kind: source.kind.word(),
        status: source.status.word(),
        detail: source.detail.as_deref(),
        taken: source.taken.as_deref(),
        not_understood: source
            .not_understood
            .iter()
            .map(|placed| part(placed, locator))
            .collect(),
        notes: &source.notes,
        examined: Share {
            bytes: source.examined.bytes,
            bytes_total: source.examined.bytes_total,
            messages: source.examined.messages,
            messages_total: source.examined.messages_total,
            time_s: source.examined.time_ns.map(|ns| ns as f64 / 1e9),
            time_total_s: source.examined.time_total_ns.map(|ns| ns as f64 / 1e9),
            windows: source.examined.windows,
        },
        problems: source.problems.iter().map(|problem| fault(problem, locator)).collect(),
    }
}

fn part<'a>(placed: &'a SourceValue<String>, locator: &Locator) -> CommentRow<'a> {
    let PlaceKeys { line, column, .. } = keys(&locator.find(&placed.place));
    CommentRow {
        part: &placed.value,
        line,
        column,
    }
}

fn fault<'a>(problem: &'a Problem, locator: &Locator) -> InputProblem<'a> {
    InputProblem {
        message: &problem.message,
        help: problem.help.as_deref(),
        at: keys(&locator.find(&problem.place)),
    }
}

pub(super) fn outcome(row: &Row) -> OutcomeRow<'_> {
    OutcomeRow {
        rule: &row.rule,
        name: &row.name,
        subject: &row.subject,
        outcome: row.outcome.word(),
        reason: row.reason.as_deref(),
        measured: row.measured.iter().map(number).collect(),
    }
}

pub(super) fn finding_row<'a>(finding: &'a Finding, locator: &Locator) -> FindingRow<'a> {
    FindingRow {
        rule: &finding.rule,
        name: &finding.name,
        subject: &finding.subject,
        severity: finding.severity.word(),
        confidence: finding.confidence.word(),
        message: &finding.message,
        detail: &finding.detail,
        help: &finding.help,
        relation: finding.relation.as_deref(),
        places: finding.places.iter().map(|label| place(label, locator)).collect(),
        measured: finding.measured.iter().map(number).collect(),
        fix: finding.fix.as_ref().and_then(|fix| fix_row(fix, locator)),
        waived: finding.waived.as_ref().map(waived),
        explained_by: finding.explained_by.as_ref(),
    }
}

fn waived(waived: &Acceptance) -> WaivedRow<'_> {
    WaivedRow {
        reason: &waived.reason,
        by: waived.by.as_deref(),
        until: waived.until.as_ref().map(Day::as_str),
        origin: &waived.origin,
    }
}

pub(super) fn unmet(unmet: &UnmetRequirement) -> UnmetRow<'_> {
    UnmetRow {
        rule: &unmet.rule,
        name: &unmet.name,
        subject: unmet.subject.as_deref(),
        why: &unmet.why,
        record: unmet.record.as_deref(),
        origin: &unmet.origin,
        recordings: &unmet.recordings,
        waived: unmet.waived.as_ref().map(waived),
    }
}

fn place(label: &Label, locator: &Locator) -> PlaceRow {
    let spot = locator.find(&label.place);
    let note = match (spot.expanded, spot.start) {
        (true, Some(at)) => {
            let line = format!("line {} of the expansion", at.line);
            if label.note.is_empty() {
                line
            } else {
                format!("{} ({line})", label.note)
            }
        }
        _ => label.note.clone(),
    };
    PlaceRow {
        role: match label.role {
            PlaceRole::Primary => "primary",
            PlaceRole::Related => "related",
        },
        at: keys(&spot),
        note,
    }
}

/// The keys of a place. Lines of an expansion are not lines of the file at `path` and are omitted.
fn keys(spot: &Spot) -> PlaceKeys {
    let start = spot.start.filter(|_| !spot.expanded);
    let end = spot.end.filter(|_| !spot.expanded);
    let message = spot.message.as_ref();
    PlaceKeys {
        path: spot.path.clone(),
        line: start.map(|at| at.line),
        column: start.map(|at| at.column),
        end_line: end.map(|at| at.line),
        end_column: end.map(|at| at.column),
        topic: message.map(|message| message.topic.clone()),
        index: message.map(|message| message.index),
        stamp_ns: message.and_then(|message| message.stamp_ns),
        field: message.and_then(|message| message.field.clone()),
    }
}

fn number(measured: &Measured) -> Number<'_> {
    // Adding zero turns -0 into 0.
    let finite = |value: f64| value.is_finite().then_some(value + 0.0);
    Number {
        what: &measured.what,
        value: finite(measured.value),
        unit: &measured.unit,
        limit: measured.limit.and_then(finite),
        spread: measured.spread.and_then(finite),
        n: measured.n,
    }
}

/// A fix whose edits can all be made in files. A text from a recording or an expansion cannot be edited.
fn fix_row<'a>(fix: &'a Fix, locator: &Locator) -> Option<FixRow<'a>> {
    let edits = fix
        .edits
        .iter()
        .map(|edit| {
            let spot = locator.find(&edit.place);
            if spot.expanded || spot.message.is_some() {
                return None;
            }
            let (start, end) = (spot.start?, spot.end?);
            Some(EditRow {
                path: spot.path,
                line: start.line,
                column: start.column,
                end_line: end.line,
                end_column: end.column,
                replacement: &edit.replacement,
            })
        })
        .collect::<Option<Vec<_>>>()?;
    Some(FixRow {
        title: &fix.title,
        safety: match fix.safety {
            Safety::Safe => "safe",
            Safety::ChangesBehaviour => "changes-behaviour",
        },
        edits,
    })
}
