//! GEO: positions on the earth.

pub mod altitude_datum;
mod fixes;
mod heights;
pub mod navsatfix_sanity;
