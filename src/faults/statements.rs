//! Mistakes of stated transforms: every relation, on every statement.

use super::Fault;

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[];
