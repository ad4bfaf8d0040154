//! Mistakes of point clouds.

use super::Fault;

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[];
