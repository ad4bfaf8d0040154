//! What several rules share: edits of files, the description of a difference, rows for many subjects.
//!
//! Knows worlds, estimates and findings. Must not judge.

pub(crate) mod contract;
pub(crate) mod declared;
pub(crate) mod diagnosis;
pub(crate) mod fault;
pub(crate) mod literal;
pub(crate) mod packets;
pub(crate) mod places;
pub(crate) mod restate;
pub(crate) mod scale;
pub(crate) mod stated;
pub(crate) mod subject;
pub(crate) mod tally;
pub(crate) mod together;
pub(crate) mod usable;
pub(crate) mod waiver;
