//! What nearly every rule writes with: its own form, estimates to read, findings to hand over.

pub(crate) use serde::Deserialize;

pub(crate) use super::{Evidence, Need, NoLimits, Rule, codes};
pub(crate) use crate::analysis::Estimates;
pub(crate) use crate::source::Place;
pub(crate) use crate::verdict::{Finding, Judge, Measured, NotEvaluated, Severity};
