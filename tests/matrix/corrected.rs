//! Faults that real recordings have by themselves are taken off before others are put in.

use frames_lint::faults::Family;
use frames_lint::faults::motion::{GRAVITY, change_covariances, change_imu};
use frames_lint::world::{Facts, World};
use nalgebra::{UnitQuaternion, Vector3};

use crate::errors::{inject, known};
use crate::streams::Stream;
use crate::support::drive::errors::{rotation, slots};

/// Findings on fixed recordings that are true: words of the recording, the rule, and why.
const TRUE: &[(&str, &str, &str)] = &[
    (
        "novatel",
        "GEO03",
        "the driver publishes eastings and northings in `odom`, which is legal: a note",
    ),
    (
        "openStationaryRTK",
        "TIME02",
        "its stamps do stand 2.3 h behind the recorder's clock, in every message",
    ),
    (
        "robot_localization",
        "TIME09",
        "the Husky's odometry shows each turn 0.1 s before its gyro, in every part of the recording: a note",
    ),
];

/// Why a finding of a rule on a fixed world is true; `None` for one that nobody has judged.
pub fn why_true(world: &World, rule: &str) -> Option<&'static str> {
    let is_it = |known: &&(&str, &str, &str)| world.label.contains(known.0) && known.1 == rule;
    TRUE.iter().find(is_it).map(|known| known.2)
}

/// Makes a world healthy; gives what was done.
pub fn correct(world: &mut World) -> Vec<String> {
    let mut told = Vec::new();
    if world.label.contains("lab5/data/circle") {
        // A VN-100 copied raw: NED of a body in FRD. The same change leads back.
        for stream in inertial(world) {
            inject(known("imu-ned-frd"), world, &stream);
        }
        told.push(format!(
            "{}: the sensor in NED/FRD is expressed in ENU/FLU",
            world.label
        ));
    }
    if world.label.contains("turtlebot3") {
        // A simulator that gives the acceleration without gravity.
        for stream in inertial(world) {
            change_imu(world, &stream, |row| {
                let up = rotation(row.orientation).inverse() * Vector3::z() * GRAVITY;
                row.acceleration = (Vector3::from(row.acceleration) + up).into();
            });
        }
        told.push(format!(
            "{}: the acceleration without gravity gets it back",
            world.label
        ));
    }
    if world.label.contains("robot_localization") {
        // The yaw of one of its sensors is 167 deg from the course, as AXES04 reports: the mount is not said.
        for stream in inertial(world) {
            if world.path(world.bags[stream.bag].source).contains("test1") {
                let back = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -167f64.to_radians());
                change_imu(world, &stream, |row| {
                    row.orientation = slots(back * rotation(row.orientation));
                });
            }
        }
        told.push(format!(
            "{}: the zero of a yaw that is 167 deg off is put right",
            world.label
        ));
    }
    if world.label.contains("novatel") {
        // Its driver states variances of angles in deg2.
        let streams: Vec<Stream> = Stream::all(world).collect();
        for stream in streams {
            stream.change_contents(world, |content| {
                change_covariances::<36>(content, "pose.covariance", |_, values| in_rad2(values));
                change_covariances::<9>(content, "orientation_covariance", |_, values| in_rad2(values));
            });
        }
        told.push(format!(
            "{}: variances of angles in deg2 are expressed in rad2",
            world.label
        ));
    }
    world.absorb(Facts::default());
    told
}

/// The inertial sensors of a world.
fn inertial(world: &World) -> Vec<Stream> {
    Stream::all(world)
        .filter(|stream| stream.family == Family::Imu)
        .collect()
}

/// A covariance in deg2, of angles or of positions and angles, in rad2.
fn in_rad2<const N: usize>(mut values: [f64; N]) -> [f64; N] {
    let size = if N == 36 { 6 } else { 3 };
    for (index, value) in values.iter_mut().enumerate() {
        let is_angle = |axis: usize| size == 3 || axis >= 3;
        let both = [index / size, index % size].into_iter().filter(|axis| is_angle(*axis));
        *value *= 1f64.to_radians().powi(both.count() as i32);
    }
    values
}

/// Why no error is put into a world.
pub fn left_out(world: &World) -> Option<&'static str> {
    let is_made_up = world.label.contains("rosbag2_test");
    is_made_up.then_some(
        "its numbers are made up: orientation and gyro have nothing to do with each other, as QUAT01 reports",
    )
}
