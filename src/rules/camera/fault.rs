//! What is wrong with a declaration: a finding before it has its subject and place. Must not judge.

use crate::source::Place;
use crate::verdict::{Finding, Measured};

/// What is wrong, with its word, what to do, and its number.
pub(super) struct Fault {
    pub(super) message: String,
    pub(super) relation: &'static str,
    pub(super) help: &'static str,
    pub(super) measured: Measured,
    pub(super) is_error: bool,
}

impl Fault {
    pub(super) fn new(relation: &'static str, message: String, help: &'static str, measured: Measured) -> Self {
        Self {
            message,
            relation,
            help,
            measured,
            is_error: false,
        }
    }

    pub(super) fn error(self) -> Self {
        Self { is_error: true, ..self }
    }

    pub(super) fn finding(self, subject: &str, place: Place) -> Finding {
        let finding = if self.is_error {
            Finding::error(subject, self.message, place)
        } else {
            Finding::warning(subject, self.message, place)
        };
        finding.relation(self.relation).help(self.help).measured(self.measured)
    }
}
