//! What nearly every rule needs: its own form, estimates to read, findings to report.

pub(crate) use serde::Deserialize;

pub(crate) use super::{Need, NoLimits, Rule, SampleSize, codes};
pub(crate) use crate::analysis::Estimates;
pub(crate) use crate::source::Place;
pub(crate) use crate::verdict::{Finding, Judge, Measured, NotEvaluated, Severity};
