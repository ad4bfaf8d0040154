//! What integration tests share.
//!
//! Used as `mod support;`. Each test binary uses a part of it, hence the allowances.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::missing_panics_doc
)]

pub mod encode;
pub mod raw;
pub mod recipe;
pub mod schemas;

use std::path::Path;

/// The MCAP that a recipe describes; see [`recipe::Recipe`] for every knob. A recipe that does not parse panics with the
/// reason.
pub fn build(recipe: &str) -> Vec<u8> {
    recipe::Recipe::parse(recipe).to_mcap()
}

/// Writes the MCAP that a recipe describes.
pub fn write(recipe: &str, path: &Path) {
    std::fs::write(path, build(recipe)).expect("the MCAP is written");
}
