//! `frames-lint view` and `check --rrd`, in builds with and without the feature `rerun`.

#[cfg(feature = "rerun")]
mod made;
#[cfg(not(feature = "rerun"))]
mod missing;

#[cfg(feature = "rerun")]
pub(super) use made::{is_there, run, save};
#[cfg(not(feature = "rerun"))]
pub(super) use missing::{is_there, run, save};
