//! The content of messages that concerns frames.
//!
//! Owns the bytes of single messages. Must not know recordings, nor keep anything.

pub(in crate::read) mod assembled;
mod bodies;
pub mod cloud;
pub mod content;
mod cursor;
pub mod decoder;
pub mod decoders;
pub mod definition;
pub mod format;
pub mod foxglove;
mod guess;
pub mod header;
mod nmea;
pub mod packets;
pub mod radar;
mod route;
mod sensing;
mod standard;
#[cfg(test)]
mod tests;
pub mod tf;
mod walk;
mod words;

use std::fmt;

pub use cursor::{Cursor, Wire};

/// Longest frame name that is read, bytes. Real ones have some ten or twenty; longer ones come from wrong bytes.
pub const MAX_NAME: usize = 256;

/// Why the bytes of a message cannot be decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodeError(pub String);

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for DecodeError {}
