//! Mistakes of cameras and their optical frames.

use super::Fault;

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[];
