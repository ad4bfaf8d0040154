//! frames-lint.
