//! What is wrong with a declaration.

use crate::verdict::Measured;

/// What is wrong, with its word, what to do, and its number.
pub(crate) struct Fault {
    pub(crate) message: String,
    pub(crate) relation: &'static str,
    pub(crate) help: &'static str,
    pub(crate) measured: Measured,
    pub(crate) is_error: bool,
}

impl Fault {
    pub(crate) fn new(relation: &'static str, message: String, help: &'static str, measured: Measured) -> Self {
        Self {
            message,
            relation,
            help,
            measured,
            is_error: false,
        }
    }

    pub(crate) fn error(self) -> Self {
        Self { is_error: true, ..self }
    }
}
