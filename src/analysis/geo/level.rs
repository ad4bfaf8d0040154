//! The attitude of a local frame at its own origin on the Earth.
//!
//! Must not judge.

use nalgebra::{Isometry3, Rotation3, UnitQuaternion};
use serde::Deserialize;

use crate::analysis::geo::earth::EarthPose;
use crate::math::{constants::ned_enu, earth_turns::beside, geodesy::Geodetic};
use crate::source::Place;

/// A pose that can be judged.
pub(crate) struct EarthAttitude<'s> {
    /// Where it is stated.
    pub(crate) place: &'s Place,
    /// Its origin.
    pub(crate) origin: Geodetic,
    /// `earth_from_local` with the axes east, north, up: those of a frame called NED are exchanged.
    pub(crate) rotation: Rotation3<f64>,
    /// `earth_from_local`; inverted where the stated transform is the inverse.
    pub(crate) pose: Isometry3<f64>,
    /// The angle between its z axis and up.
    pub(crate) tilt_deg: f64,
    /// The same angle of the transform as it is written.
    pub(crate) written_tilt_deg: f64,
    /// The angle of its x axis from east towards north.
    pub(crate) yaw_deg: f64,
    /// Whether the stated transform is the inverse.
    pub(crate) is_inverse: bool,
}

/// The pose of a local frame, where its origin is on the Earth.
pub(crate) fn see<'s>(
    stated: &EarthPose,
    place: &'s Place,
    pose: &Isometry3<f64>,
    limits: &Limits,
) -> Option<EarthAttitude<'s>> {
    let attitude = |pose: &Isometry3<f64>| {
        let origin = Geodetic::from_ecef(&pose.translation.vector)?;
        let mut rotation = pose.rotation.to_rotation_matrix();
        if stated.local.has_token("ned") {
            rotation *= ned_enu();
        }
        Some((origin, rotation, beside(&origin, &rotation)))
    };
    let written = attitude(pose);
    let of = |pose: &Isometry3<f64>, is_inverse| {
        let (origin, rotation, seen) = attitude(pose)?;
        (origin.height_m.abs() <= limits.max_height_m).then(|| EarthAttitude {
            place,
            origin,
            rotation,
            pose: *pose,
            tilt_deg: seen.tilt_rad.to_degrees(),
            written_tilt_deg: written
                .as_ref()
                .map_or(f64::NAN, |(.., seen)| seen.tilt_rad.to_degrees()),
            yaw_deg: seen.yaw_rad.to_degrees(),
            is_inverse,
        })
    };
    // Seen from a place on the Earth its centre is straight down: the inverse of a correct transform has its origin at the south
    // pole, to 21 km.
    let t = pose.translation.vector;
    let at_pole = t.z < 0.0 && t.x.hypot(t.y) <= limits.pole_m;
    let inverse = of(&pose.inverse(), true).filter(|seen| at_pole && seen.tilt_deg <= limits.warning_deg);
    inverse.or_else(|| of(pose, false))
}

/// The correct rotation of `earth_from_local`.
pub(crate) fn expected(origin: &Geodetic, is_ned: bool) -> UnitQuaternion<f64> {
    let enu = origin.enu_from_ecef().inverse();
    let rotation = if is_ned { enu * ned_enu() } else { enu };
    UnitQuaternion::from_rotation_matrix(&rotation)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) warning_deg: f64,
    pub(crate) error_deg: f64,
    pub(crate) relation_deg: f64,
    pub(crate) max_height_m: f64,
    pub(crate) pole_m: f64,
}
