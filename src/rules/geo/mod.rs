//! GEO: positions on the earth.

mod fixes;
pub mod navsatfix_sanity;
