//! AUTH: where transforms come from, and who may state them.

pub mod calibration_missing_default;
