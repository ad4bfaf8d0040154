//! frames-lint.

pub mod math;
