//! The mounting transform that the motions of scans and body determine.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;

use crate::analysis::hand_eye::{HandEye, Pair, in_plane};
use crate::math::planar_hand_eye::{PlanarMount, mounted};
use crate::verdict::NotEvaluated;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) long_deg: f64,
    pub(crate) long_s: f64,
    pub(crate) max_sigma_m: f64,
    pub(crate) min_turned_deg: f64,
    pub(crate) max_yaw_deg: f64,
    pub(crate) max_place_m: f64,
    pub(crate) systematic_m: f64,
    pub(crate) sigmas: f64,
    pub(crate) sure_yaw_deg: f64,
    pub(crate) sure_place_m: f64,
    pub(crate) max_scale: f64,
    pub(crate) max_residual: f64,
    pub(crate) forward_deg: f64,
}

/// The pairs that were matched well.
pub(crate) fn sure<'k>(known: &'k HandEye, limits: &Limits) -> impl Iterator<Item = &'k Pair> {
    let max_sigma_m = limits.max_sigma_m;
    known.pairs.iter().filter(move |pair| pair.sigma_m <= max_sigma_m)
}

/// The same as [`estimated`] with any scale, where the lidar turned enough.
pub(crate) fn solved(known: &HandEye, limits: &Limits) -> Result<PlanarMount, (NotEvaluated, String)> {
    let turns = sure(known, limits).map(|pair| pair.lidar.rotation.angle().to_degrees());
    // The sum of no numbers is -0.
    let turned_deg = turns.fold(0.0, |sum, turn| sum + turn);
    if turned_deg >= limits.min_turned_deg {
        return fitted(known, limits);
    }
    let why = format!(
        "it turned by {turned_deg:.0} deg in {} pairs of scans; {} are needed: only turns determine the position on the body",
        sure(known, limits).count(),
        limits.min_turned_deg
    );
    Err((NotEvaluated::TooLittleEvidence, why))
}

/// The correction of a stated mounting, in the plane of the body: its yaw and its place. Poses and scans have one scale.
pub(crate) fn estimated(known: &HandEye, limits: &Limits) -> Result<PlanarMount, (NotEvaluated, String)> {
    let found = fitted(known, limits)?;
    let why = other_scale(known, &found, limits).map(|why| (NotEvaluated::TooLittleEvidence, why));
    why.map_or(Ok(found), Err)
}

/// Why a mounting cannot be judged: the scales of poses and scans differ.
pub(crate) fn other_scale(known: &HandEye, found: &PlanarMount, limits: &Limits) -> Option<String> {
    ((found.scale - 1.0).abs() > limits.max_scale).then(|| {
        format!(
            "{} moves {:.2} m for each metre of the scans: their scales differ",
            known.poses.0, found.scale
        )
    })
}

/// The same with any scale.
fn fitted(known: &HandEye, limits: &Limits) -> Result<PlanarMount, (NotEvaluated, String)> {
    let turn = Isometry3::from_parts(nalgebra::Translation3::identity(), known.stated.rotation);
    let flat: Vec<_> = sure(known, limits)
        .map(|pair| (in_plane(&pair.body), in_plane(&(turn * pair.lidar * turn.inverse()))))
        .collect();
    let mut found = mounted(&flat).ok_or_else(|| {
        let why = format!(
            "{} pairs of scans do not determine the mounting: record more turns",
            flat.len()
        );
        (NotEvaluated::TooLittleEvidence, why)
    })?;
    // The spread of the groups does not show an error that all matches share.
    let [yaw, x, y] = &mut found.sigma;
    *yaw = yaw.hypot(limits.systematic_m.atan2(found.way_m));
    // Only turns determine the position: one that is as small as the error of a match over its angle is as wrong.
    let turns = flat.iter().map(|(body, _)| body.rotation.angle().abs());
    let (sum, squares) = turns.fold((0.0, 0.0), |(sum, squares), turn| (sum + turn, squares + turn * turn));
    let shared_m = limits.systematic_m * sum / squares.max(f64::EPSILON) / std::f64::consts::SQRT_2;
    (*x, *y) = (x.hypot(shared_m), y.hypot(shared_m));
    found.scale_sigma = found
        .scale_sigma
        .hypot(limits.systematic_m / found.way_m.max(limits.systematic_m));
    Ok(found)
}

/// The mounting with the yaw that the scans show, with their position if the stated one is wrong, and the rest as stated.
pub(crate) fn corrected(known: &HandEye, found: &PlanarMount, moved: bool) -> Isometry3<f64> {
    let stated = known.stated.translation;
    let place = Translation3::new(found.place.x, found.place.y, stated.z);
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), found.yaw_rad);
    Isometry3::from_parts(if moved { place } else { stated }, yaw * known.stated.rotation)
}
