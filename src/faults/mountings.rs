//! Mistakes in how sensors are mounted, as static transforms publish it.

use super::Fault;

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[];
