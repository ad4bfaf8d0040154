//! AUTH: where transforms come from, and who may state them.

pub mod adhoc_static_transform;
pub mod calibration_artifact_id;
pub mod calibration_missing_default;
pub mod convention_undeclared;
pub mod multiple_authorities;
mod revision;
