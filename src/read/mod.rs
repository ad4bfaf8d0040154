//! Reading: files become facts with a place. Each reader fills its source's status and problems.
//!
//! Owns the formats. Must not judge, nor know rules or reports.

pub mod allowed;
#[cfg(test)]
#[allow(dead_code, unreachable_pub)]
#[path = "../../tests/support/at_hand.rs"]
mod at_hand;
pub mod bag;
pub mod calibration;
pub mod code;
pub mod discover;
pub mod feather;
pub mod input;
pub mod launch;
pub mod messages;
pub mod ouster;
pub mod packets;
pub mod points;
mod recordings;
pub mod scans;
mod syntax;
pub mod text;
pub mod urdf;
pub mod xacro;
pub mod xacro_parts;
