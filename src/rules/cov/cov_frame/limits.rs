//! Limits of COV04.

use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_matrices: f64,
    pub(crate) min_stretch: f64,
    pub(crate) min_spread: f64,
    pub(crate) along: f64,
    pub(crate) across: f64,
    pub(crate) min_poses: f64,
    pub(crate) scale: f64,
    pub(crate) round: f64,
    pub(crate) min_turn_deg: f64,
    pub(crate) same_share: f64,
    pub(crate) rigid_share: f64,
}
