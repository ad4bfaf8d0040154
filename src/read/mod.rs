//! Reading: files become facts with a place.
//!
//! Owns the formats. Must not judge, nor know rules or reports.

pub mod bag;
pub mod calibration;
pub mod messages;
