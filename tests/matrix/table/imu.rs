//! Errors of inertial sensors.

use nalgebra::{Rotation3, Vector3};

use crate::errors::{Change, Error, GRAVITY, Requirement};
use crate::support::drive::errors::{Error as Known, OrientedRow, frd_from_flu, ned_from_enu, rotation, slots};
use crate::support::drive::rows::ImuRow;

macro_rules! imu {
    ($name:literal, $needs:ident, [$($known:ident),*], $words:expr, $texts:expr, $seen_by:expr) => {
        error!($name, Change::Imu(Requirement::$needs, |row| { $(row.apply(Known::$known, GRAVITY);)* }), $words, $texts, $seen_by)
    };
}

pub static ERRORS: &[Error] = &[
    imu!(
        "NED/FRD",
        Nothing,
        [NedFrd],
        ["ned-frd"],
        ["all of its data are expressed in NED/FRD"],
        ["AXES01", "AXES03", "AXES05"]
    ),
    imu!(
        "NED orientation",
        Orientation,
        [NedOrientation],
        ["ned-orientation"],
        ["the orientation alone is expressed in NED/FRD"],
        ["QUAT01", "AXES04"]
    ),
    imu!(
        "NED world",
        Orientation,
        [NedWorld],
        ["ned-world"],
        ["the world of the orientation is NED"],
        ["AXES03", "AXES04"]
    ),
    imu!(
        "conjugate",
        Orientation,
        [Conjugate],
        ["inverse"],
        ["the orientation is inverted"],
        ["QUAT01", "AXES04"]
    ),
    imu!(
        "wxyz",
        Orientation,
        [Wxyz],
        ["wxyz"],
        ["in the order w, x, y, z"],
        ["QUAT01"]
    ),
    imu!(
        "wxyz, conjugate",
        Orientation,
        [Conjugate, Wxyz],
        ["wxyz-inverse"],
        ["in the order w, x, y, z, and inverted"],
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
        ["mounted with a yaw", "a sensor rotated to the left"],
        ["AXES06"]
    ),
    imu!(
        "mounted at 180",
        Nothing,
        [Backward],
        ["turned-mount"],
        ["mounted with a yaw", "a sensor mounted backwards"],
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
        Change::Imu(Requirement::Nothing, |row| row.change_body(&on_side())),
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
            "does not follow its gyro about",
            "composed as Rx Ry Rz",
            "Rx(roll) Ry(pitch) Rz(yaw)"
        ],
        ["QUAT03"]
    ),
    imu!(
        "left-handed",
        Nothing,
        [LeftHanded],
        ["mirrored"],
        ["all of its data are expressed in left-handed axes"],
        ["AXES05", "AXES04"]
    ),
    imu!(
        "gyro, accel FRD",
        Nothing,
        [Frd],
        ["sensor-frd"],
        ["gyro and accelerometer are expressed in FRD"],
        ["QUAT01", "AXES01", "AXES05"]
    ),
    error!(
        "gyro FRD",
        Change::Imu(Requirement::Gyro, |row| row.gyro =
            [row.gyro[0], -row.gyro[1], -row.gyro[2]]),
        ["gyro-frd"],
        ["the gyro alone is expressed in FRD"],
        ["QUAT01", "AXES05"]
    ),
    imu!(
        "gyro negated",
        Gyro,
        [GyroNegated],
        ["gyro-negated"],
        ["the angular velocity has the opposite sign"],
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
        ["the unit is g"],
        ["AXES02 acceleration"]
    ),
    imu!(
        "accel cm/s2",
        Gravity,
        [CmS2],
        [],
        ["the unit is cm/s2"],
        ["AXES02 acceleration"]
    ),
    imu!(
        "accel negated",
        Gravity,
        [GravitySign],
        ["gravity-sign"],
        ["the accelerometer has the opposite sign"],
        ["AXES01", "AXES03"]
    ),
    error!(
        "gravity removed",
        Change::Imu(Requirement::Gravity, gravity_removed),
        [],
        ["gravity is removed", "no known unit fits"],
        ["AXES02 acceleration"]
    ),
    error!(
        "body alone FRD",
        Change::Imu(Requirement::Orientation, |row| row.orientation =
            slots(rotation(row.orientation) * frd_from_flu())),
        ["frd-body"],
        ["only the body of the orientation is FRD"],
        ["QUAT01", "AXES03"]
    ),
    error!(
        "sides changed",
        Change::Imu(Requirement::Orientation, |row| row.orientation = slots(
            frd_from_flu() * ned_from_enu() * rotation(row.orientation) * frd_from_flu() * ned_from_enu()
        )),
        ["z90", "z-90", "euler-zxy-yaw-pitch-roll"],
        [
            "stands on the",
            "a sensor mounted backwards",
            "does not follow its gyro about"
        ],
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
        Change::Imu(Requirement::Covariance, |row| row
            .apply(Known::CovarianceDegrees, GRAVITY)),
        ["degrees"],
        [],
        ["COV05"]
    ),
];

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
