//! Errors of what no recording at hand says by itself: it is first staged, rightly, beside the evidence, then wrong.

use frames_lint::faults::Fault;

use super::StagedFault;
use crate::errors::Change;
use crate::stages::{self, CARLA, CLOUD, CORRECTION, EARTH, HEADING, XSENS};
use crate::support::drive::errors::Error as Known;

macro_rules! earth {
    ($name:literal, $known:ident, $word:literal) => {
        error!(
            $name,
            Change::Staged(&EARTH, |world, stream| stages::add_earth(
                world,
                stream,
                Some(Known::$known)
            )),
            [$word],
            [],
            ["GEO02"]
        )
    };
}

pub static ERRORS: &[StagedFault] = &[
    earth!("earth>map transposed", Transposed, "transposed"),
    earth!("earth>map in NED", NedRows, "ned-enu"),
    earth!("earth>map of a sphere", SphericalLatitude, "spherical-latitude"),
    earth!("earth>map active", ActiveRotations, "active-rotations"),
    earth!("earth>map lat/lon", LatLonSwapped, "lat-lon-swapped"),
    error!(
        "origin 20 km away",
        Change::Staged(&EARTH, |world, stream| stages::move_earth(world, stream, 0.135)),
        ["far-from-origin"],
        [],
        ["GEO05"]
    ),
    error!(
        "datum 10 m off",
        Change::Staged(&EARTH, |world, _| stages::change_datum(world, "fix-origin-moved")),
        ["origin-changed"],
        ["put the origin"],
        ["GEO07"]
    ),
    error!(
        "datum lat/lon",
        Change::Staged(&EARTH, |world, _| stages::change_datum(world, "fix-origin-swapped")),
        ["origin-changed", "lat-lon-swapped"],
        ["put the origin"],
        ["GEO07"]
    ),
    error!(
        "in the cloud's frame",
        Change::Staged(&CLOUD, stages::share_frame),
        [],
        ["the frame of the cloud on"],
        ["SENSOR05"]
    ),
    error!(
        "zero north, of an Xsens",
        Change::Staged(&XSENS, |world, stream| stages::put_known(
            world,
            stream,
            "imu-zero-north"
        )),
        ["driver-setting"],
        [],
        ["SENSOR06 zero"]
    ),
    error!(
        "heading is a compass's",
        Change::Staged(&HEADING, stages::compass_heading),
        ["compass-yaw", "clockwise-yaw"],
        [],
        ["SENSOR08"]
    ),
    error!(
        "left-handed, of CARLA",
        Change::Staged(&CARLA, |world, stream| stages::put_known(
            world,
            stream,
            "pose-left-handed"
        )),
        ["left-handed"],
        [],
        ["SENSOR09"]
    ),
    error!(
        "map>odom missing",
        Change::Staged(&CORRECTION, |world, stream| stages::put_known(
            world,
            stream,
            "pose-correction-missing"
        )),
        [],
        ["no transform connects it to"],
        ["TREE16"]
    ),
    error!(
        "map>odom held",
        Change::Staged(&CORRECTION, |world, stream| stages::put_known(
            world,
            stream,
            "pose-correction-held"
        )),
        [],
        ["but the odometry drifts by"],
        ["TREE16"]
    ),
    error!(
        "map expressed in odom",
        Change::Staged(&CORRECTION, stages::map_in_odom),
        [],
        ["is named a map, but expressed in"],
        ["TREE16"]
    ),
];
