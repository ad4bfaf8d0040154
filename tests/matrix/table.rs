//! The table of errors.

use nalgebra::{Rotation3, Vector3};

use crate::errors::{Change, Error, GRAVITY, Needs};
use crate::support::drive::covariance::rotate6;
use crate::support::drive::errors::{Error as Known, Oriented, frd_from_flu, ned_from_enu, rotation, slots, turn};
use crate::support::drive::rows::ImuRow;

/// How high the geoid is taken to lie above the ellipsoid, metres.
const UNDULATION_M: f64 = 30.0;

macro_rules! error {
    ($name:literal, $change:expr, $words:expr, $texts:expr, $seen_by:expr) => {
        Error {
            name: $name,
            change: $change,
            words: &$words,
            texts: &$texts,
            seen_by: &$seen_by,
        }
    };
}

macro_rules! imu {
    ($name:literal, $needs:ident, [$($known:ident),*], $words:expr, $texts:expr, $seen_by:expr) => {
        error!($name, Change::Imu(Needs::$needs, |row| { $(row.apply(Known::$known, GRAVITY);)* }), $words, $texts, $seen_by)
    };
}

macro_rules! poses {
    ($name:literal, $needs:ident, [$($known:ident),*], $words:expr, $texts:expr, $seen_by:expr) => {
        error!($name, Change::Poses(Needs::$needs, |row| { $(row.apply(Known::$known);)* }), $words, $texts, $seen_by)
    };
}

/// What a finding on a sensor says of the track that it is held against.
const MIRRORED: &str = "the track that it is held against is a mirror image";

pub static ERRORS: &[Error] = &[
    imu!(
        "NED/FRD",
        Nothing,
        [NedFrd],
        ["ned-frd"],
        ["all of it is told in NED/FRD"],
        ["AXES01", "AXES03", "AXES05"]
    ),
    imu!(
        "NED orientation",
        Orientation,
        [NedOrientation],
        ["ned-orientation"],
        ["the orientation alone is told in NED/FRD"],
        ["QUAT01", "AXES04"]
    ),
    imu!(
        "NED world",
        Orientation,
        [NedWorld],
        ["ned-world"],
        ["the world of the orientation is north, east, down"],
        ["AXES03", "AXES04"]
    ),
    imu!(
        "conjugate",
        Orientation,
        [Conjugate],
        ["inverse"],
        ["the orientation is the inverse one"],
        ["QUAT01", "AXES04"]
    ),
    imu!(
        "wxyz",
        Orientation,
        [Wxyz],
        ["wxyz"],
        ["stand as w, x, y, z"],
        ["QUAT01"]
    ),
    imu!(
        "wxyz, conjugate",
        Orientation,
        [Conjugate, Wxyz],
        ["wxyz-inverse"],
        ["stand as w, x, y, z, of the inverse"],
        ["QUAT01"]
    ),
    imu!(
        "compass yaw",
        Orientation,
        [CompassYaw],
        ["compass-yaw"],
        ["the yaw is a compass heading"],
        ["QUAT01", "AXES04"]
    ),
    imu!(
        "zero north",
        Orientation,
        [ZeroNorth],
        [],
        ["a yaw that is zero in the north"],
        ["AXES04"]
    ),
    imu!(
        "y forward",
        Nothing,
        [YForward],
        ["turned-mount"],
        ["its y axis points forward", "whose y axis points forward"],
        ["AXES06"]
    ),
    imu!(
        "mounted at 90",
        Nothing,
        [Yaw90],
        ["turned-mount"],
        ["mounted turned about z", "a sensor turned to the left"],
        ["AXES06"]
    ),
    imu!(
        "mounted at 180",
        Nothing,
        [Backward],
        ["turned-mount"],
        ["mounted turned about z", "a sensor mounted backwards"],
        ["AXES06"]
    ),
    imu!(
        "upside down",
        Nothing,
        [Inverted],
        ["upside-down"],
        ["the sensor is mounted upside down"],
        ["AXES01", "AXES05"]
    ),
    error!(
        "on its side",
        Change::Imu(Needs::Nothing, |row| row.change_body(&on_side())),
        ["on-its-side"],
        ["the sensor is mounted on its side"],
        ["AXES01"]
    ),
    imu!(
        "Euler XYZ",
        Orientation,
        [EulerXyz],
        ["rx-ry-rz", "xyz"],
        [
            "follows its gyro about one axis",
            "put together as Rx Ry Rz",
            "Rx(roll) Ry(pitch) Rz(yaw)"
        ],
        ["QUAT03"]
    ),
    imu!(
        "left-handed",
        Nothing,
        [LeftHanded],
        ["mirrored"],
        ["all of it is told in left-handed axes"],
        ["AXES05", "AXES04"]
    ),
    imu!(
        "gyro, accel FRD",
        Nothing,
        [Frd],
        ["sensor-frd"],
        ["gyro and accelerometer are told in FRD"],
        ["QUAT01", "AXES01", "AXES05"]
    ),
    error!(
        "gyro FRD",
        Change::Imu(Needs::Gyro, |row| row.gyro = [row.gyro[0], -row.gyro[1], -row.gyro[2]]),
        ["gyro-frd"],
        ["the gyro alone is told in FRD"],
        ["QUAT01", "AXES05"]
    ),
    imu!(
        "gyro negated",
        Gyro,
        [GyroNegated],
        ["gyro-negated"],
        ["the gyro's rates have the other sign"],
        ["QUAT01", "AXES05"]
    ),
    imu!(
        "gyro deg/s",
        Gyro,
        [DegS],
        [],
        ["the gyro is in deg/s"],
        ["AXES02 angular", "QUAT01"]
    ),
    imu!(
        "accel in g",
        Gravity,
        [G],
        [],
        ["in units of gravity (g)"],
        ["AXES02 acceleration"]
    ),
    imu!(
        "accel cm/s2",
        Gravity,
        [CmS2],
        [],
        ["as in cm/s2"],
        ["AXES02 acceleration"]
    ),
    imu!(
        "accel negated",
        Gravity,
        [GravitySign],
        ["gravity-sign"],
        ["the accelerometer has the other sign"],
        ["AXES01", "AXES03"]
    ),
    error!(
        "gravity removed",
        Change::Imu(Needs::Gravity, gravity_removed),
        [],
        ["where gravity was taken off"],
        ["AXES02 acceleration"]
    ),
    error!(
        "body alone FRD",
        Change::Imu(Needs::Orientation, |row| row.orientation =
            slots(rotation(row.orientation) * frd_from_flu())),
        ["frd-body"],
        ["the body of the orientation alone is"],
        ["QUAT01", "AXES03"]
    ),
    error!(
        "sides changed",
        Change::Imu(Needs::Orientation, |row| row.orientation = slots(
            frd_from_flu() * ned_from_enu() * rotation(row.orientation) * frd_from_flu() * ned_from_enu()
        )),
        ["z90", "z-90", "euler-zxy-yaw-pitch-roll"],
        ["stands on the", "a sensor mounted backwards"],
        ["AXES04"]
    ),
    error!(
        "stamps +0.3 s",
        Change::Stamps(0.3),
        [],
        ["ahead of the log clock", "the motion"],
        ["TIME02", "TIME09"]
    ),
    error!(
        "stamps -0.3 s",
        Change::Stamps(-0.3),
        [],
        ["behind the log clock", "the motion"],
        ["TIME09"]
    ),
    error!(
        "stamps +18 s",
        Change::Stamps(18.0),
        [],
        ["18 ", "ahead of the log clock"],
        ["TIME01", "TIME02"]
    ),
    error!(
        "covariance deg2",
        Change::Imu(Needs::Covariance, |row| row.apply(Known::CovarianceDegrees, GRAVITY)),
        ["degrees"],
        [],
        ["COV05"]
    ),
    poses!(
        "x, y swapped",
        Nothing,
        [SwapXy],
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
        "NED/FRD",
        Nothing,
        [NedFrd],
        ["z-down", "ned", "mirrored"],
        ["north, east, down", "has z down", MIRRORED],
        ["AXES07", "AXES14"]
    ),
    poses!(
        "z down",
        Nothing,
        [NedWorld],
        ["z-down", "ned", "mirrored"],
        ["north, east, down", "has z down", MIRRORED],
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
        Change::Poses(Needs::Child, |row| row.pose.orientation =
            slots(turned() * rotation(row.pose.orientation))),
        ["x180", "frd", "z-down", "flu-frd"],
        ["stands on the", "-z points up"],
        ["QUAT04", "AXES13", "AXES08 velocity"]
    ),
    error!(
        "world turned on the right",
        Change::Poses(Needs::Child, |row| row.pose.orientation =
            slots(rotation(row.pose.orientation) * turn(-std::f64::consts::FRAC_PI_2))),
        ["rfu"],
        ["stands on the", "turned by 90 deg about z against the position"],
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
        Change::Poses(Needs::Twist, |row| row.angular = row.angular.map(f64::to_degrees)),
        [],
        ["is in degrees"],
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
        Change::Poses(Needs::Covariance, |row| {
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
    error!(
        "lat/lon swapped",
        Change::Fixes(|row| row.apply(Known::Swapped, UNDULATION_M)),
        ["mirrored", "swapped"],
        [MIRRORED, "swapped"],
        ["AXES07"]
    ),
    error!(
        "radians",
        Change::Fixes(|row| row.apply(Known::Radians, UNDULATION_M)),
        ["radians"],
        ["radians"],
        ["GEO01", "AXES07"]
    ),
    error!(
        "E7",
        Change::Fixes(|row| row.apply(Known::E7, UNDULATION_M)),
        [],
        ["1e-7", "1e7"],
        ["GEO01"]
    ),
    error!(
        "MSL altitude",
        Change::Fixes(|row| row.apply(Known::Msl, UNDULATION_M)),
        ["msl-as-ellipsoidal"],
        [],
        ["GEO06"]
    ),
];

fn turned() -> Rotation3<f64> {
    frd_from_flu()
}

fn on_side() -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2)
}

/// Takes off gravity where the orientation says that it is; without one along the sensor's z.
fn gravity_removed(row: &mut ImuRow) {
    if Vector3::from([row.orientation[0], row.orientation[1], row.orientation[2]]).norm() + row.orientation[3].abs()
        > 0.5
    {
        row.apply(Known::GravityRemoved, GRAVITY);
    } else {
        row.acceleration[2] -= GRAVITY;
    }
}
