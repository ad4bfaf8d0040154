//! Mistakes in names of frames and in the tree that they form.

use super::Fault;

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[];
