//! The tables of errors that are staged, by what they are staged beside.

macro_rules! error {
    ($name:literal, $change:expr, $words:expr, $texts:expr, $seen_by:expr) => {
        StagedError {
            name: $name,
            change: $change,
            words: &$words,
            texts: &$texts,
            seen_by: &$seen_by,
        }
    };
}

mod cameras;
mod lidars;
mod staged;

use crate::errors::StagedError;

/// Every one.
pub static STAGED: [&[StagedError]; 3] = [staged::ERRORS, lidars::ERRORS, cameras::ERRORS];
