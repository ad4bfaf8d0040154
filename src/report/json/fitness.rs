//! Whether recordings are fit for calibrations, as rows.

use serde::Serialize;

use crate::fitness::{Condition, Fitness};

use super::{Number, number};

/// The fitness of a recording for one calibration.
#[derive(Serialize)]
pub(in crate::report) struct FitnessRow<'a> {
    calibration: &'static str,
    platform: &'a str,
    subject: &'a str,
    verdict: &'static str,
    conditions: Vec<ConditionRow<'a>>,
}

impl<'a> FitnessRow<'a> {
    pub(in crate::report) fn of(fitness: &'a Fitness) -> Self {
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
