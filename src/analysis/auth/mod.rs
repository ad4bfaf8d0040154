//! Revisions of calibrations.

pub(crate) mod revision;
