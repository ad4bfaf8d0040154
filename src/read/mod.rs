//! Reading: files become facts with a place. Each reader fills its source's status and problems.
//!
//! Owns the formats. Must not judge, nor know rules or reports.

pub mod bag;
pub mod calibration;
pub mod discover;
pub mod messages;
mod recordings;
pub mod text;
pub mod urdf;
pub mod xacro;
pub mod xacro_parts;
