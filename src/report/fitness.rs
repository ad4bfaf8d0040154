//! Whether recordings are fit for calibrations, as rows of JSON and as words: for every report.

use std::fmt::Write;

use serde::Serialize;

use crate::fitness::{Condition, ConditionState, Fitness, FitnessWord};
use crate::run::Run;

use super::json::{Number, number};
use super::style::{Ink, Style};
use super::terminal::measured_words;
use super::text::{one_line, wrap};

/// The verdict in one line: what it is fit for.
pub(super) fn title(fitness: &Fitness) -> String {
    let platform = match fitness.platform.as_str() {
        "" => String::new(),
        platform => format!("{platform}: "),
    };
    format!(
        "{platform}{} for {} calibration ({})",
        sentence(fitness.verdict()),
        fitness.calibration.word(),
        fitness.subject
    )
}

fn sentence(verdict: FitnessWord) -> &'static str {
    match verdict {
        FitnessWord::Fit => "Fit",
        FitnessWord::NotFit => "Not fit",
        FitnessWord::Unknown => "Cannot be told whether it is fit",
    }
}

/// What became of a condition, in a word or two.
pub(super) fn state(condition: &Condition) -> String {
    if condition.is_needed {
        condition.state.word().to_owned()
    } else {
        format!("{} (not needed)", condition.state.word())
    }
}

/// What is asked, what was measured, why, and what to record.
pub(super) fn words(condition: &Condition) -> String {
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

/// The conditions of every calibration that was asked for.
pub(super) fn section(run: &Run, style: Style, out: &mut String) {
    for one in &run.fitness {
        let ink = match one.verdict() {
            FitnessWord::Fit => Ink::Good,
            FitnessWord::NotFit => Ink::Error,
            FitnessWord::Unknown => Ink::Warning,
        };
        let _ = writeln!(
            out,
            "{}",
            style.paint(ink, &wrap(&one_line(&title(one)), style.width, "", "  "))
        );
        for condition in &one.conditions {
            let mut line = |text: &str, first: &str, rest: &str| {
                let _ = writeln!(out, "{}", wrap(&one_line(text), style.width, first, rest));
            };
            line(
                &format!("{}: {}: {}", state(condition), condition.name, condition.asks),
                "  ",
                "      ",
            );
            let measured: Vec<String> = condition.measured.iter().map(measured_words).collect();
            if !measured.is_empty() {
                line(&measured.join("; "), "      ", "        ");
            }
            if let Some(reason) = &condition.reason {
                line(&format!("why: {reason}"), "      ", "        ");
            }
            if let Some(record) = condition
                .record
                .as_ref()
                .filter(|_| condition.state != ConditionState::Met)
            {
                line(&format!("record or add: {record}"), "      ", "        ");
            }
        }
        out.push('\n');
    }
}

/// The fitness of a recording for one calibration.
#[derive(Serialize)]
pub(super) struct FitnessRow<'a> {
    calibration: &'static str,
    platform: &'a str,
    subject: &'a str,
    verdict: &'static str,
    conditions: Vec<ConditionRow<'a>>,
}

impl<'a> FitnessRow<'a> {
    pub(super) fn of(fitness: &'a Fitness) -> Self {
        Self {
            calibration: fitness.calibration.word(),
            platform: &fitness.platform,
            subject: &fitness.subject,
            verdict: fitness.verdict().word(),
            conditions: fitness.conditions.iter().map(ConditionRow::of).collect(),
        }
    }
}

#[derive(Serialize)]
struct ConditionRow<'a> {
    name: &'static str,
    asks: &'a str,
    state: &'static str,
    needed: bool,
    reason: Option<&'a str>,
    record: Option<&'a str>,
    measured: Vec<Number<'a>>,
}

impl<'a> ConditionRow<'a> {
    fn of(condition: &'a Condition) -> Self {
        Self {
            name: condition.name,
            asks: &condition.asks,
            state: condition.state.word(),
            needed: condition.is_needed,
            reason: condition.reason.as_deref(),
            record: condition.record.as_deref(),
            measured: condition.measured.iter().map(number).collect(),
        }
    }
}
