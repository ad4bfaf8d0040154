//! TIME: stamps, clocks and their offsets.

pub mod clock_domain;
pub mod epoch_offset;
mod gaps;
mod known_offsets;
pub mod stamp_monotonic;
mod streams;
mod together;

pub(crate) use together::tell_once;
