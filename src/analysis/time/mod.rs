//! Stamps, clocks and their offsets.

pub(crate) mod header;
pub(crate) mod known_offsets;
pub(crate) mod lateness;
pub(crate) mod naming;
pub(crate) mod offsets;
pub(crate) mod reference;
pub(crate) mod simulated;
pub(crate) mod streams;
pub(crate) mod sweep;
pub(crate) mod trend;
pub(crate) mod turning;
pub(crate) mod units;
