//! A fault of a declaration.

use crate::verdict::Measured;

/// A fault, with its relation, help and measurement.
pub(crate) struct Fault {
    pub(crate) message: String,
    /// Evidence behind the message; may be empty.
    pub(crate) detail: String,
    pub(crate) relation: &'static str,
    pub(crate) help: &'static str,
    pub(crate) measured: Measured,
    pub(crate) is_error: bool,
}

impl Fault {
    pub(crate) fn new(relation: &'static str, message: String, help: &'static str, measured: Measured) -> Self {
        Self {
            message,
            detail: String::new(),
            relation,
            help,
            measured,
            is_error: false,
        }
    }

    pub(crate) fn detail(self, detail: impl Into<String>) -> Self {
        Self {
            detail: detail.into(),
            ..self
        }
    }

    pub(crate) fn error(self) -> Self {
        Self { is_error: true, ..self }
    }
}
