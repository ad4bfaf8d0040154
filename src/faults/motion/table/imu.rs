//! Mistakes of inertial sensors.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::super::covariances::deviations;
use super::super::imu::{GRAVITY, ImuChange, ImuMessage, ImuNeed, KnownImuMistake};
use super::super::turns::{
    Oriented, angles_in_degrees, compass_yaw, conjugate, diagonal, euler_xyz, ned_frd, ned_orientation, ned_world,
    quarters, wxyz, wxyz_conjugate, xy_swap, zero_north,
};
use super::{CONSTANT, WITH_IMU, WITH_MOUNT, WITH_TRACK};
use crate::faults::Fault;
use crate::math::constants::flu_frd;

/// A mistake, by its name, sentence, need, change, relations, texts, rules that should see it, and what to record.
macro_rules! imu {
    ($name:literal, $sentence:literal, $needs:ident, $change:expr, $($named:tt)*) => {
        fault!(
            Imu,
            $name,
            $sentence,
            ImuChange {
                needs: ImuNeed::$needs,
                change: $change,
                known: KNOWN,
            },
            $($named)*
        )
    };
}

/// To record for the axes of a gyro about which a vehicle hardly rotates.
const ROLLING: &str =
    "a minute of motion with roll and pitch (ramps, bumps, or turned by hand), with the IMU's orientation and gyro";

/// Relations of mistakes, and what these do.
const KNOWN: &[KnownImuMistake] = &[
    ("ned-frd", ned_frd),
    ("ned-orientation", ned_orientation),
    ("ned-world", ned_world),
    ("inverse", conjugate),
    ("wxyz", wxyz),
    ("wxyz-inverse", wxyz_conjugate),
    ("compass-yaw", compass_yaw),
    ("upside-down", upside_down),
    ("on-its-side", on_its_side),
    ("turned-mount", |message| message.change_body(&quarters(1.0))),
    ("turned-mount", |message| message.change_body(&quarters(2.0))),
    ("turned-mount", |message| message.change_body(&quarters(-1.0))),
    ("mirrored", |message| message.mirror()),
    ("sensor-frd", sensor_frd),
    ("gyro-frd", |message| message.change_gyro(flu_frd().matrix())),
    ("gyro-negated", |message| message.change_gyro(&-Matrix3::identity())),
    ("gravity-sign", |message| {
        message.change_acceleration(&-Matrix3::identity());
    }),
    ("frd-body", frd_body),
];

/// Every mistake.
pub(super) static FAULTS: &[Fault] = &[
    imu!(
        "imu-ned-frd",
        "All data of the IMU are in NED/FRD axes where ENU/FLU is meant.",
        Anything,
        ned_frd,
        ["ned-frd"],
        ["all of its data are expressed in NED/FRD"],
        ["AXES01", "AXES03", "AXES05"],
        WITH_MOUNT
    ),
    imu!(
        "imu-ned-orientation",
        "The orientation alone is in NED/FRD axes; gyro and accelerometer are in FLU.",
        Orientation,
        ned_orientation,
        ["ned-orientation"],
        ["the orientation alone is expressed in NED/FRD"],
        ["QUAT01", "AXES04"],
        WITH_IMU
    ),
    imu!(
        "imu-ned-world",
        "The world of the orientation is north, east, down, while its body is FLU.",
        Orientation,
        ned_world,
        ["ned-world"],
        ["the world of the orientation is NED"],
        ["AXES03", "AXES04"],
        WITH_IMU
    ),
    imu!(
        "imu-conjugate",
        "The orientation is inverted: body_from_world, or a JPL quaternion read as Hamilton's.",
        Orientation,
        conjugate,
        ["inverse"],
        ["the orientation is inverted"],
        ["QUAT01", "AXES04"],
        WITH_IMU
    ),
    imu!(
        "imu-wxyz",
        "The quaternion is in the order w, x, y, z where x, y, z, w is meant.",
        Orientation,
        wxyz,
        ["wxyz"],
        ["in the order w, x, y, z"],
        ["QUAT01"],
        WITH_IMU
    ),
    imu!(
        "imu-wxyz-conjugate",
        "The quaternion is in the order w, x, y, z, and inverted.",
        Orientation,
        wxyz_conjugate,
        ["wxyz-inverse"],
        [
            "in the order w, x, y, z, and inverted",
            "the inverse would be as level",
            "read as the inverse"
        ],
        ["QUAT01"],
        WITH_IMU
    ),
    imu!(
        "imu-compass-yaw",
        "The yaw is a compass heading, clockwise from north.",
        Orientation,
        compass_yaw,
        ["compass-yaw"],
        [
            "the yaw is a compass heading",
            "yaw increases clockwise, opposite to the course",
            "does not follow its gyro about z"
        ],
        ["QUAT01", "AXES04"],
        WITH_IMU
    ),
    imu!(
        "imu-zero-north",
        "The yaw is zero in the north where it is meant to be zero in the east.",
        Orientation,
        zero_north,
        ["driver-setting"],
        ["a yaw that is zero in the north", "the yaw is zero in the north"],
        ["AXES04 zero", "SENSOR06 zero"],
        WITH_TRACK
    ),
    imu!(
        "imu-euler-xyz",
        "Roll, pitch and yaw are composed as Rx Ry Rz where Rz Ry Rx is meant.",
        Orientation,
        euler_xyz,
        ["rx-ry-rz", "xyz"],
        [
            "does not follow its gyro about",
            "is composed as",
            "composed as Rx Ry Rz",
            "Rx(roll) Ry(pitch) Rz(yaw)"
        ],
        ["QUAT03"],
        "a minute of turns while rolled or pitched by about 10 deg (on a slope), with the IMU's orientation and gyro"
    ),
    imu!(
        "imu-degrees",
        "The quaternion is made of roll, pitch and yaw in degrees where radians are meant.",
        Orientation,
        angles_in_degrees,
        ["rz-ry-rx-degrees"],
        ["orientation is not the integral of its gyro", "is composed as"],
        ["QUAT01", "QUAT03"],
        WITH_IMU
    ),
    imu!(
        "imu-body-frd",
        "The body of the orientation is FRD; its world, gyro and accelerometer are right.",
        Orientation,
        frd_body,
        ["frd-body"],
        ["only the body of the orientation is FRD"],
        ["QUAT01", "AXES03"],
        WITH_IMU
    ),
    imu!(
        "imu-sides",
        "The orientation was converted with its rotations on the wrong sides.",
        Orientation,
        |message| message.turn(|stated| {
            let [world, body] = [crate::math::constants::ned_enu(), flu_frd()].map(UnitQuaternion::from);
            body * world * stated * body * world
        }),
        ["z90", "z-90", "euler-zxy-yaw-pitch-roll"],
        [
            "stands on the",
            "a sensor mounted backwards",
            "does not follow its gyro about"
        ],
        ["AXES04", "QUAT03"],
        WITH_TRACK
    ),
    imu!(
        "imu-sensor-frd",
        "Gyro and accelerometer are in FRD axes beside a right orientation.",
        Anything,
        sensor_frd,
        ["sensor-frd"],
        ["gyro and accelerometer are expressed in FRD"],
        ["QUAT01", "AXES01", "AXES05"],
        WITH_IMU
    ),
    imu!(
        "imu-gyro-frd",
        "The gyro alone is in FRD axes: y and z have the opposite sign.",
        Anything,
        |message| message.change_gyro(flu_frd().matrix()),
        ["gyro-frd"],
        ["the gyro alone is expressed in FRD"],
        ["QUAT01", "AXES05"],
        WITH_IMU
    ),
    imu!(
        "imu-gyro-negated",
        "The angular velocity has the opposite sign.",
        Anything,
        |message| message.change_gyro(&-Matrix3::identity()),
        ["gyro-negated"],
        ["the angular velocity has the opposite sign"],
        ["QUAT01", "AXES05"],
        WITH_IMU
    ),
    imu!(
        "imu-gyro-x-negated",
        "The gyro's x has the opposite sign.",
        Anything,
        |message| message.change_gyro(&diagonal(-1.0, 1.0, 1.0)),
        [],
        ["does not follow its gyro about x"],
        ["QUAT01"],
        ROLLING
    ),
    imu!(
        "imu-gyro-y-negated",
        "The gyro's y has the opposite sign.",
        Anything,
        |message| message.change_gyro(&diagonal(1.0, -1.0, 1.0)),
        [],
        ["does not follow its gyro about y"],
        ["QUAT01"],
        ROLLING
    ),
    imu!(
        "imu-gyro-z-negated",
        "The gyro's z has the opposite sign.",
        Anything,
        |message| message.change_gyro(&diagonal(1.0, 1.0, -1.0)),
        [],
        [
            "does not follow its gyro about z",
            "yaw rate has the opposite sign to the turns"
        ],
        ["QUAT01", "AXES05"],
        WITH_IMU
    ),
    imu!(
        "imu-gyro-xy-swapped",
        "The gyro's x and y are swapped.",
        Anything,
        |message| message.change_gyro(&xy_swap()),
        [],
        [
            "With the gyro's axes permuted or negated it is",
            "does not follow its gyro about x",
            "does not follow its gyro about y"
        ],
        ["QUAT01"],
        ROLLING
    ),
    imu!(
        "imu-gyro-deg",
        "The gyro is in deg/s where rad/s is meant.",
        Anything,
        |message| message.change_gyro(&(Matrix3::identity() * 1.0_f64.to_degrees())),
        [],
        ["the gyro is in deg/s"],
        ["AXES02 angular", "QUAT01"],
        WITH_IMU
    ),
    imu!(
        "imu-accel-negated",
        "The accelerometer has the opposite sign: it gives gravity, not specific force.",
        Gravity,
        |message| message.change_acceleration(&-Matrix3::identity()),
        ["gravity-sign"],
        ["the accelerometer has the opposite sign"],
        ["AXES01", "AXES03"],
        WITH_MOUNT
    ),
    imu!(
        "imu-accel-x-negated",
        "The accelerometer's x has the opposite sign.",
        Anything,
        |message| message.change_acceleration(&diagonal(-1.0, 1.0, 1.0)),
        ["left-handed-accelerometer"],
        ["acceleration when speeding up is along -x"],
        ["AXES06"],
        WITH_TRACK
    ),
    imu!(
        "imu-accel-y-negated",
        "The accelerometer's y has the opposite sign.",
        Anything,
        |message| message.change_acceleration(&diagonal(1.0, -1.0, 1.0)),
        ["left-handed-accelerometer"],
        ["acceleration in curves to the left is along -y"],
        ["AXES06"],
        WITH_TRACK
    ),
    imu!(
        "imu-accel-z-negated",
        "The accelerometer's z has the opposite sign.",
        Gravity,
        |message| message.change_acceleration(&diagonal(1.0, 1.0, -1.0)),
        ["gravity-sign"],
        ["acceleration points down", "the acceleration points down"],
        ["AXES01", "AXES03"],
        WITH_MOUNT
    ),
    imu!(
        "imu-accel-xy-swapped",
        "The accelerometer's x and y are swapped.",
        Anything,
        |message| message.change_acceleration(&xy_swap()),
        ["left-handed-accelerometer"],
        [
            "acceleration when speeding up is along y",
            "acceleration when speeding up is along -y"
        ],
        ["AXES06"],
        WITH_TRACK
    ),
    imu!(
        "imu-accel-g",
        "The acceleration is in g where m/s2 is meant.",
        Gravity,
        |message| message.change_acceleration(&(Matrix3::identity() / GRAVITY)),
        [],
        ["the unit is g"],
        ["AXES02 acceleration"],
        WITH_IMU
    ),
    imu!(
        "imu-accel-cm",
        "The acceleration is in cm/s2 where m/s2 is meant.",
        Gravity,
        |message| message.change_acceleration(&(Matrix3::identity() * 100.0)),
        [],
        ["the unit is cm/s2"],
        ["AXES02 acceleration"],
        WITH_IMU
    ),
    imu!(
        "imu-gravity-removed",
        "Gravity is taken off the acceleration where specific force is meant.",
        Gravity,
        ImuMessage::remove_gravity,
        [],
        ["gravity is removed", "no known unit fits"],
        ["AXES02 acceleration"],
        WITH_IMU
    ),
    imu!(
        "imu-left-handed",
        "All data of the IMU are in left-handed axes, y to the right.",
        Anything,
        |message| message.mirror(),
        ["mirrored"],
        ["all of its data are expressed in left-handed axes"],
        ["AXES05", "AXES04"],
        WITH_TRACK
    ),
    imu!(
        "imu-mounted-yaw-90",
        "The IMU is mounted turned to the left by 90 deg, and TF does not say so.",
        Anything,
        |message| message.change_body(&quarters(1.0)),
        ["turned-mount"],
        ["mounted with a yaw", "a sensor rotated to the left", CONSTANT],
        ["AXES06", "QUAT04"],
        WITH_TRACK
    ),
    imu!(
        "imu-mounted-backward",
        "The IMU is mounted turned by 180 deg, and TF does not say so.",
        Anything,
        |message| message.change_body(&quarters(2.0)),
        ["turned-mount"],
        ["mounted with a yaw", "a sensor mounted backwards", CONSTANT],
        ["AXES06", "QUAT04"],
        WITH_TRACK
    ),
    imu!(
        "imu-y-forward",
        "The IMU's y axis points forward, and TF does not say so.",
        Anything,
        |message| message.change_body(&quarters(-1.0)),
        ["turned-mount"],
        ["its y axis points forward", "whose y axis points forward", CONSTANT],
        ["AXES06", "QUAT04"],
        WITH_TRACK
    ),
    imu!(
        "imu-upside-down",
        "The IMU is mounted upside down, and TF does not say so.",
        Anything,
        upside_down,
        ["upside-down"],
        ["the sensor is mounted upside down", CONSTANT],
        ["AXES01", "AXES05", "QUAT04"],
        WITH_MOUNT
    ),
    imu!(
        "imu-on-its-side",
        "The IMU is mounted on its side, and TF does not say so.",
        Anything,
        on_its_side,
        ["on-its-side"],
        ["the sensor is mounted on its side", CONSTANT],
        ["AXES01", "QUAT04"],
        WITH_MOUNT
    ),
    imu!(
        "imu-covariance-degrees",
        "Covariances of orientation and gyro are in deg2 where rad2 is meant.",
        Covariance,
        |message| for covariance in [&mut message.orientation_covariance, &mut message.gyro_covariance] {
            *covariance = covariance.map(|value| value * 1.0_f64.to_degrees().powi(2));
        },
        ["degrees"],
        [],
        ["COV05 size"],
        "the IMU's orientation with a covariance that its driver computes"
    ),
    imu!(
        "imu-covariance-deviations",
        "Covariances hold standard deviations where variances are meant.",
        Covariance,
        |message| for covariance in [
            &mut message.orientation_covariance,
            &mut message.gyro_covariance,
            &mut message.acceleration_covariance
        ] {
            deviations(covariance);
        },
        ["deviations"],
        [],
        ["COV05 size"],
        "the IMU's orientation with a covariance that its driver computes"
    ),
];

/// Gyro and accelerometer forward, right, down beside a right quaternion.
fn sensor_frd(message: &mut ImuMessage) {
    message.change_vectors(flu_frd().matrix());
}

/// The body of the orientation alone forward, right, down.
fn frd_body(message: &mut ImuMessage) {
    message.turn(|stated| stated * UnitQuaternion::from(flu_frd()));
}

/// A sensor that is turned by 180 deg about x.
fn upside_down(message: &mut ImuMessage) {
    message.change_body(&flu_frd());
}

/// A sensor that is turned by 90 deg about x.
fn on_its_side(message: &mut ImuMessage) {
    message.change_body(&Rotation3::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2));
}
