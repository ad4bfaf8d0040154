//! Mistakes of poses, of their twists and covariances, and of the correction of odometry.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::super::covariances::{deviations, rescale6, rotation_first};
use super::super::origins::CorrectionChange;
use super::super::places::{PlaceChange, PlacedPose};
use super::super::poses::{KnownPoseMistake, PoseChange, PoseMessage, PoseNeed};
use super::super::turns::{Oriented, compass_yaw, conjugate, diagonal, ned_frd, ned_world, quarters, wxyz, xy_swap};
use super::{CONSTANT, MIRRORED, POSITION, WITH_FIXES, WITH_TWIST};
use crate::faults::Fault;
use crate::math::constants::flu_frd;

/// To record for whatever shows in the frame of the base.
const WITH_SENSOR: &str =
    "odometry or a localization with a child frame, and an IMU with its transform, on a drive with turns";
/// To record for whatever shows in a covariance.
const WITH_COVARIANCE: &str = "the poses with the covariances that their node computes, on a drive with turns";
/// To record for a correction.
const WITH_CORRECTION: &str =
    "`map` -> `odom` on /tf, satellite fixes or a map beside it, on a drive of some hundred metres";
/// How far the origin of a plane is to the south, degrees: 15 km.
const FAR_DEG: f64 = 0.135;

/// A mistake, by its name, sentence, need, change, relations, texts, rules that should see it, and what to record.
macro_rules! pose {
    ($name:literal, $sentence:literal, $needs:ident, $change:expr, $($named:tt)*) => {
        fault!(
            Pose,
            $name,
            $sentence,
            PoseChange {
                needs: PoseNeed::$needs,
                change: $change,
                known: KNOWN,
            },
            $($named)*
        )
    };
}

/// Relations of mistakes, and what these do.
const KNOWN: &[KnownPoseMistake] = &[
    ("mirrored", x_negated),
    ("mirrored", y_negated),
    ("mirrored", xy_swapped),
    ("mirrored", |message| message.mirror()),
    ("z-down", ned_world),
    ("ned", ned_world),
    ("wxyz", wxyz),
    ("inverse", conjugate),
    ("inverse", PoseMessage::invert),
    ("compass-yaw", compass_yaw),
    ("frd", |message| message.change_body(&flu_frd())),
    ("rfu", |message| message.change_body(&quarters(-1.0))),
    ("header-frame", PoseMessage::linear_in_parent),
    ("negated", |message| message.change_linear(&-Matrix3::identity())),
    ("y-negated", |message| message.change_linear(&diagonal(1.0, -1.0, 1.0))),
    ("xy-swapped", |message| message.change_linear(&xy_swap())),
];

/// Mistakes of each message by itself.
pub(super) static FAULTS: &[Fault] = &[
    pose!(
        "pose-xy-swapped",
        "The position's x and y are swapped.",
        Anything,
        xy_swapped,
        ["mirrored"],
        [MIRRORED, POSITION],
        ["AXES07", "AXES08 velocity"],
        WITH_FIXES
    ),
    pose!(
        "pose-x-negated",
        "The position's x has the opposite sign.",
        Anything,
        x_negated,
        ["mirrored"],
        [MIRRORED, POSITION, "moves backwards"],
        ["AXES07", "AXES08 velocity"],
        WITH_FIXES
    ),
    pose!(
        "pose-y-negated",
        "The position's y has the opposite sign.",
        Anything,
        y_negated,
        ["mirrored"],
        [MIRRORED, POSITION],
        ["AXES07", "AXES08 velocity"],
        WITH_FIXES
    ),
    pose!(
        "pose-z-negated",
        "The position's z has the opposite sign.",
        Anything,
        |message| message.change_position(&diagonal(1.0, 1.0, -1.0)),
        ["z-down"],
        ["z falls when the altitude rises"],
        ["AXES14", "AXES13"],
        "satellite fixes with altitudes beside the poses, on a drive uphill and downhill"
    ),
    pose!(
        "pose-wxyz",
        "The quaternion is in the order w, x, y, z where x, y, z, w is meant.",
        Orientation,
        wxyz,
        ["wxyz"],
        ["w, x, y, z", "w x y z"],
        ["QUAT02", "AXES08 velocity", "AXES13"],
        WITH_TWIST
    ),
    pose!(
        "pose-orientation-inverse",
        "The orientation is inverted: child_from_parent, or a JPL quaternion read as Hamilton's.",
        Orientation,
        conjugate,
        ["inverse"],
        ["inverse", "inverted"],
        ["AXES08", "AXES13"],
        WITH_TWIST
    ),
    pose!(
        "pose-inverse",
        "The pose is that of the parent in the child where that of the child in the parent is meant.",
        Orientation,
        PoseMessage::invert,
        ["inverse"],
        ["inverse", "inverted"],
        ["AXES08", "AXES13", "AXES07"],
        WITH_TWIST
    ),
    pose!(
        "pose-compass-yaw",
        "The yaw is a compass heading, clockwise from north.",
        Orientation,
        compass_yaw,
        ["compass-yaw", "clockwise-yaw", "inverse"],
        ["grows clockwise", "increases clockwise"],
        ["SENSOR08", "AXES08 turning", "AXES13"],
        WITH_TWIST
    ),
    pose!(
        "pose-ned-frd",
        "The poses are in north, east, down of a body forward, right, down.",
        Anything,
        ned_frd,
        ["z-down", "ned", "mirrored"],
        ["north, east, down", "has z down", "may have z down", MIRRORED, POSITION],
        ["AXES07", "AXES14"],
        WITH_FIXES
    ),
    pose!(
        "pose-z-down",
        "The frame of the poses is north, east, down; the body is as it should be.",
        Anything,
        ned_world,
        ["z-down", "ned", "mirrored"],
        ["north, east, down", "has z down", "may have z down", MIRRORED, POSITION],
        ["AXES07", "AXES14"],
        WITH_SENSOR
    ),
    pose!(
        "pose-left-handed",
        "Poses and twists are in left-handed axes, y to the right.",
        Anything,
        |message| message.mirror(),
        ["mirrored", "left-handed"],
        [MIRRORED, POSITION],
        ["AXES07", "SENSOR09"],
        WITH_FIXES
    ),
    pose!(
        "pose-base-frd",
        "The base is forward, right, down where forward, left, up is meant.",
        Base,
        |message| message.change_body(&flu_frd()),
        ["frd", "flu-frd"],
        ["forward, right, down", CONSTANT],
        ["AXES13", "QUAT04"],
        WITH_SENSOR
    ),
    pose!(
        "pose-base-y-forward",
        "The base is right, forward, up where forward, left, up is meant.",
        Base,
        |message| message.change_body(&quarters(-1.0)),
        ["rfu"],
        ["right, forward, up", CONSTANT],
        ["AXES13", "QUAT04"],
        WITH_SENSOR
    ),
    pose!(
        "pose-base-backward",
        "The base's x axis points to the rear.",
        Base,
        |message| message.change_body(&quarters(2.0)),
        ["bru"],
        ["backward", CONSTANT],
        ["AXES13", "QUAT04"],
        WITH_SENSOR
    ),
    pose!(
        "pose-body-on-the-left",
        "The rotation of the body is multiplied on the left of the orientation where right is meant.",
        Base,
        |message| message.turn(|stated| UnitQuaternion::from(flu_frd()) * stated),
        ["x180", "frd", "z-down", "flu-frd"],
        ["stands on the", "is upside down in", "-z points up"],
        ["QUAT04", "AXES13", "AXES08 velocity"],
        WITH_SENSOR
    ),
    pose!(
        "pose-world-on-the-right",
        "The rotation of the world is multiplied on the right of the orientation where left is meant.",
        Base,
        |message| message.turn(|stated| {
            stated * UnitQuaternion::from(Rotation3::from_axis_angle(&Vector3::z_axis(), -FRAC_PI_2))
        }),
        ["rfu"],
        ["stands on the", "for example the yaw by 90 deg"],
        ["QUAT04", "AXES08 velocity", "AXES13"],
        WITH_SENSOR
    ),
    pose!(
        "pose-twist-in-world",
        "The velocity is in the axes of the header's frame where those of the child frame are meant.",
        Twist,
        PoseMessage::linear_in_parent,
        ["header-frame"],
        [],
        ["AXES08 velocity"],
        WITH_TWIST
    ),
    pose!(
        "pose-twist-reversed",
        "The velocity has the opposite sign.",
        Twist,
        |message| message.change_linear(&-Matrix3::identity()),
        ["negated"],
        [],
        ["AXES08 velocity"],
        WITH_TWIST
    ),
    pose!(
        "pose-twist-y-negated",
        "The velocity's y is to the right where the left is meant.",
        Aside,
        |message| message.change_linear(&diagonal(1.0, -1.0, 1.0)),
        ["y-negated"],
        [],
        ["AXES08 velocity"],
        "odometry with its twist, of a platform that also moves to the side"
    ),
    pose!(
        "pose-twist-xy-swapped",
        "The velocity's x and y are swapped.",
        Twist,
        |message| message.change_linear(&xy_swap()),
        ["xy-swapped"],
        [],
        ["AXES08 velocity"],
        WITH_TWIST
    ),
    pose!(
        "pose-yaw-rate-negated",
        "The yaw rate has the opposite sign.",
        Twist,
        |message| message.change_angular(&diagonal(1.0, 1.0, -1.0)),
        [],
        ["yaw rate has the opposite sign"],
        ["AXES08 turning"],
        WITH_TWIST
    ),
    pose!(
        "pose-yaw-rate-degrees",
        "The angular velocity is in deg/s where rad/s is meant.",
        Twist,
        |message| message.change_angular(&(Matrix3::identity() * 1.0_f64.to_degrees())),
        [],
        ["yaw rate is in deg/s"],
        ["AXES08 turning"],
        WITH_TWIST
    ),
    pose!(
        "pose-covariance-degrees",
        "Covariances have rotations in deg2 where rad2 is meant.",
        Covariance,
        |message| each_covariance(message, |covariance| rescale6(covariance, 1.0, 1.0_f64.to_degrees())),
        ["degrees"],
        [],
        ["COV05"],
        WITH_COVARIANCE
    ),
    pose!(
        "pose-covariance-centimetres",
        "Covariances have positions in cm2 where m2 is meant.",
        Covariance,
        |message| each_covariance(message, |covariance| rescale6(covariance, 100.0, 1.0)),
        ["centimetres"],
        [],
        ["COV05 units"],
        WITH_COVARIANCE
    ),
    pose!(
        "pose-covariance-deviations",
        "Covariances hold standard deviations where variances are meant.",
        Covariance,
        |message| each_covariance(message, |covariance| deviations(covariance)),
        ["deviations"],
        [],
        ["COV05 units"],
        WITH_COVARIANCE
    ),
    pose!(
        "pose-covariance-rotation-first",
        "Covariances have rotations before positions.",
        Covariance,
        |message| each_covariance(message, rotation_first),
        ["rotation-first"],
        [],
        ["COV02", "COV05 units"],
        WITH_COVARIANCE
    ),
    pose!(
        "pose-covariance-in-body",
        "The covariance of the pose is in the axes of the body where those of the header's frame are meant.",
        Covariance,
        PoseMessage::covariance_in_child,
        ["not-rotated"],
        [],
        ["COV04"],
        WITH_COVARIANCE
    ),
    pose!(
        "pose-twist-covariance-in-world",
        "The covariance of the twist is in the axes of the header's frame where those of the child frame are meant.",
        TwistCovariance,
        PoseMessage::twist_covariance_in_parent,
        ["in-world"],
        [],
        ["COV04"],
        WITH_COVARIANCE
    ),
];

/// Mistakes in coordinates of the Earth.
pub(super) static ON_THE_EARTH: &[Fault] = &[
    fault!(
        Pose,
        "pose-utm-grid",
        "The poses are in the UTM grid, from the origin on, where east and north are meant.",
        PlaceChange(PlacedPose::in_local_utm),
        ["utm-grid"],
        [],
        ["GEO04"],
        "satellite fixes beside the poses, on a drive of a kilometre with turns"
    ),
    fault!(
        Pose,
        "pose-utm",
        "The poses are whole eastings and northings of the UTM grid.",
        PlaceChange(PlacedPose::in_utm),
        ["utm"],
        [],
        ["GEO03"],
        WITH_FIXES
    ),
    fault!(
        Pose,
        "pose-ecef",
        "The poses are in Earth-centred coordinates where a local frame is meant.",
        PlaceChange(|pose| Some(pose.in_ecef())),
        ["ecef"],
        [],
        ["GEO03"],
        WITH_FIXES
    ),
    fault!(
        Pose,
        "pose-degrees",
        "The positions are latitude and longitude in degrees where metres are meant.",
        PlaceChange(|pose| Some(pose.in_degrees())),
        ["degrees"],
        [],
        ["GEO03"],
        WITH_FIXES
    ),
    fault!(
        Pose,
        "pose-altitude-as-z",
        "The altitude over that of the origin is taken for z: the Earth is taken for flat in height alone.",
        PlaceChange(|pose| Some(pose.with_altitude())),
        ["altitude-as-z"],
        [],
        ["GEO05"],
        "satellite fixes beside the poses, kilometres away from the origin"
    ),
    fault!(
        Pose,
        "pose-origin-far",
        "The origin of the poses' frame is 15 km away: the ground is not in its tangent plane.",
        PlaceChange(|pose| Some(pose.in_plane_south(FAR_DEG))),
        ["tangent-plane", "far-from-origin"],
        [],
        ["GEO05"],
        WITH_FIXES
    ),
];

/// Mistakes of the correction `map` -> `odom`.
pub(super) static CORRECTIONS: &[Fault] = &[
    fault!(
        Pose,
        "pose-correction-missing",
        "Nobody publishes the correction of the odometry, `map` -> `odom`.",
        CorrectionChange::Missing,
        [],
        ["no transform connects it to"],
        ["TREE16"],
        "what is expressed in `map`: poses, a map or a path"
    ),
    fault!(
        Pose,
        "pose-correction-held",
        "The correction of the odometry, `map` -> `odom`, stays at its first value.",
        CorrectionChange::Held,
        [],
        ["but the odometry drifts by"],
        ["TREE16"],
        WITH_CORRECTION
    ),
    fault!(
        Pose,
        "pose-correction-inverse",
        "The correction of the odometry is published the other way round: `map` in `odom`.",
        CorrectionChange::Inverse,
        ["inverse"],
        ["inverse"],
        ["TREE15", "AXES07"],
        WITH_CORRECTION
    ),
];

fn x_negated(message: &mut PoseMessage) {
    message.change_position(&diagonal(-1.0, 1.0, 1.0));
}

fn y_negated(message: &mut PoseMessage) {
    message.change_position(&diagonal(1.0, -1.0, 1.0));
}

fn xy_swapped(message: &mut PoseMessage) {
    message.change_position(&xy_swap());
}

/// Changes the covariances of pose and twist.
fn each_covariance(message: &mut PoseMessage, change: impl Fn(&mut [f64; 36])) {
    change(&mut message.covariance);
    change(&mut message.twist_covariance);
}
