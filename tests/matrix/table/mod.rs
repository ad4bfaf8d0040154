//! The tables of errors that are staged, by what they are staged beside.

macro_rules! error {
    ($name:literal, $change:expr, $words:expr, $texts:expr, $seen_by:expr) => {{
        static CHANGE: Change = $change;
        let fault = Fault {
            family: CHANGE.family(),
            name: $name,
            sentence: $name,
            change: &CHANGE,
            relations: &$words,
            texts: &$texts,
            seen_by: &$seen_by,
            record: "",
        };
        (fault, &CHANGE)
    }};
}

mod cameras;
mod lidars;
mod staged;

use frames_lint::faults::Fault;

use crate::errors::Change;

/// An error like those of the catalogue, with what it changes.
pub type StagedFault = (Fault, &'static Change);

/// Every one.
pub static STAGED: [&[StagedFault]; 3] = [staged::ERRORS, lidars::ERRORS, cameras::ERRORS];
