//! Errors of poses and of what is published with them.

use super::MIRRORED;
use crate::errors::{Change, Error, Requirement};
use crate::places::Place;
use crate::support::drive::covariance::rotate6;
use crate::support::drive::errors::{Error as Known, frd_from_flu, rotation, slots, turn};

macro_rules! poses {
    ($name:literal, $needs:ident, [$($known:ident),*], $words:expr, $texts:expr, $seen_by:expr) => {
        error!($name, Change::Poses(Requirement::$needs, |row| { $(row.apply(Known::$known);)* }), $words, $texts, $seen_by)
    };
}

pub static ERRORS: &[Error] = &[
    poses!(
        "x, y swapped",
        Nothing,
        [SwapXy],
        ["mirrored"],
        [MIRRORED],
        ["AXES07", "AXES08 velocity"]
    ),
    poses!(
        "x negated",
        Nothing,
        [XNegated],
        ["mirrored"],
        [MIRRORED],
        ["AXES07", "AXES08 velocity"]
    ),
    poses!(
        "y negated",
        Nothing,
        [YNegated],
        ["mirrored"],
        [MIRRORED],
        ["AXES07", "AXES08 velocity"]
    ),
    poses!(
        "wxyz",
        Child,
        [Wxyz],
        ["wxyz"],
        ["w, x, y, z", "w x y z"],
        ["QUAT02", "AXES08 velocity", "AXES13"]
    ),
    poses!(
        "conjugate",
        Child,
        [Conjugate],
        ["inverse"],
        ["inverse"],
        ["AXES08", "AXES13"]
    ),
    poses!(
        "compass yaw",
        Child,
        [CompassYaw],
        ["compass-yaw", "clockwise-yaw", "inverse"],
        ["grows clockwise", "increase clockwise", "increases clockwise"],
        ["SENSOR08", "AXES08 turning", "AXES13"]
    ),
    poses!(
        "NED/FRD",
        Nothing,
        [NedFrd],
        ["z-down", "ned", "mirrored"],
        ["north, east, down", "has z down", "may have z down", MIRRORED],
        ["AXES07", "AXES14"]
    ),
    poses!(
        "z down",
        Nothing,
        [NedWorld],
        ["z-down", "ned", "mirrored"],
        ["north, east, down", "has z down", "may have z down", MIRRORED],
        ["AXES07", "AXES14"]
    ),
    poses!(
        "left-handed",
        Nothing,
        [LeftHanded],
        ["mirrored"],
        [MIRRORED],
        ["AXES07"]
    ),
    poses!(
        "base FRD",
        Child,
        [Inverted],
        ["frd", "flu-frd"],
        ["forward, right, down"],
        ["AXES13"]
    ),
    poses!(
        "base y forward",
        Child,
        [YForward],
        ["rfu"],
        ["right, forward, up"],
        ["AXES13"]
    ),
    poses!("base backward", Child, [Backward], ["bru"], ["backward"], ["AXES13"]),
    error!(
        "body turned on the left",
        Change::Poses(Requirement::Child, |row| row.pose.orientation =
            slots(frd_from_flu() * rotation(row.pose.orientation))),
        ["x180", "frd", "z-down", "flu-frd"],
        ["stands on the", "is upside down in", "-z points up"],
        ["QUAT04", "AXES13", "AXES08 velocity"]
    ),
    error!(
        "world turned on the right",
        Change::Poses(Requirement::Child, |row| row.pose.orientation =
            slots(rotation(row.pose.orientation) * turn(-std::f64::consts::FRAC_PI_2))),
        ["rfu"],
        ["stands on the", "rotated by 90 deg about z relative to the position"],
        ["QUAT04", "AXES08 velocity", "AXES13"]
    ),
    poses!(
        "twist in world",
        Twist,
        [TwistInWorld],
        ["header-frame"],
        [],
        ["AXES08 velocity"]
    ),
    poses!(
        "twist reversed",
        Twist,
        [TwistReversed],
        ["negated"],
        [],
        ["AXES08 velocity"]
    ),
    poses!(
        "twist y negated",
        Aside,
        [TwistYNegated],
        ["y-negated"],
        [],
        ["AXES08 velocity"]
    ),
    poses!(
        "twist x, y swapped",
        Twist,
        [TwistSwapped],
        ["xy-swapped"],
        [],
        ["AXES08 velocity"]
    ),
    poses!(
        "yaw rate negated",
        Twist,
        [TwistYawNegated],
        [],
        ["has the opposite sign"],
        ["AXES08 turning"]
    ),
    error!(
        "yaw rate deg/s",
        Change::Poses(Requirement::Twist, |row| row.angular = row.angular.map(f64::to_degrees)),
        [],
        ["yaw rate is in deg/s"],
        ["AXES08 turning"]
    ),
    error!(
        "UTM grid",
        Change::Places(|there, origin| {
            let (e, n) = there.utm(origin.utm_meridian());
            let (e0, n0) = origin.utm(origin.utm_meridian());
            [e - e0, n - n0, there.altitude - origin.altitude]
        }),
        ["utm-grid"],
        [],
        ["GEO04"]
    ),
    error!(
        "altitude as z",
        Change::Places(|there, origin| {
            let enu = origin.enu(there);
            [enu.x, enu.y, there.altitude - origin.altitude]
        }),
        ["altitude-as-z"],
        [],
        ["GEO05"]
    ),
    error!(
        "plane 20 km away",
        Change::Places(|there, origin| {
            let away = Place {
                latitude: origin.latitude - 0.18,
                ..*origin
            };
            away.enu(there).into()
        }),
        ["tangent-plane", "far-from-origin"],
        [],
        ["GEO05"]
    ),
    error!(
        "UTM",
        Change::Places(|there, origin| {
            let (e, n) = there.utm(origin.utm_meridian());
            [e, n, there.altitude]
        }),
        ["utm"],
        [],
        ["GEO03"]
    ),
    error!(
        "ECEF",
        Change::Places(|there, _| there.ecef().into()),
        ["ecef"],
        [],
        ["GEO03"]
    ),
    error!(
        "in degrees",
        Change::Places(|there, _| [there.longitude, there.latitude, there.altitude]),
        ["degrees"],
        [],
        ["GEO03"]
    ),
    poses!(
        "covariance deg2",
        Covariance,
        [CovarianceDegrees],
        ["degrees"],
        [],
        ["COV05"]
    ),
    poses!(
        "covariance cm2",
        Covariance,
        [CovarianceCentimetres],
        ["centimetres"],
        [],
        ["COV05 units"]
    ),
    poses!(
        "covariance std",
        Covariance,
        [CovarianceStd],
        ["deviations"],
        [],
        ["COV05 units"]
    ),
    poses!(
        "covariance order",
        Covariance,
        [CovarianceRotationFirst],
        ["rotation-first"],
        [],
        ["COV02"]
    ),
    error!(
        "covariance in body",
        Change::Poses(Requirement::Covariance, |row| {
            let back = rotation(row.pose.orientation).inverse();
            rotate6(
                &mut row.pose.covariance,
                &back.to_rotation_matrix(),
                &back.to_rotation_matrix(),
            );
        }),
        ["not-rotated"],
        [],
        ["COV04"]
    ),
    poses!(
        "twist cov. in world",
        TwistCovariance,
        [TwistCovarianceInWorld],
        ["in-world"],
        [],
        ["COV04"]
    ),
];
