//! Faults that real recordings have by themselves are taken off before others are put in.

use frames_lint::world::{Facts, World};
use nalgebra::Vector3;

use crate::errors::{GRAVITY, as_imu_rows, each_covariance};
use crate::streams::Stream;
use crate::support::drive::errors::{Error, rotation};

/// Makes a world healthy; gives what was done.
pub fn mend(world: &mut World) -> Vec<String> {
    let mut told = Vec::new();
    if world.label.contains("lab5/data/circle") {
        // A VN-100 copied raw: NED of a body in FRD. The same change leads back.
        as_imu_rows(world, None, |row| row.apply(Error::NedFrd, GRAVITY));
        told.push(format!("{}: the sensor in NED/FRD is told in ENU/FLU", world.label));
    }
    if world.label.contains("turtlebot3") {
        // A simulator that gives the acceleration without gravity.
        as_imu_rows(world, None, |row| {
            let up = rotation(row.orientation).inverse() * Vector3::z() * GRAVITY;
            row.acceleration = (Vector3::from(row.acceleration) + up).into();
        });
        told.push(format!(
            "{}: the acceleration without gravity gets it back",
            world.label
        ));
    }
    if world.label.contains("novatel") {
        // Its driver states variances of angles in deg2.
        for stream in Stream::all(world) {
            stream.contents(world, |content| {
                for field in ["pose.covariance", "orientation_covariance"] {
                    each_covariance(content, field, |sample| {
                        let to_rad2 = 1f64.to_radians().powi(2);
                        let size = if sample.values.len() == 36 { 6 } else { 3 };
                        for (index, value) in sample.values.iter_mut().enumerate() {
                            let is_angle = |axis: usize| size == 3 || axis >= 3;
                            let both = [index / size, index % size].into_iter().filter(|axis| is_angle(*axis));
                            *value *= to_rad2.sqrt().powi(both.count() as i32);
                        }
                    });
                }
            });
        }
        told.push(format!("{}: variances of angles in deg2 are told in rad2", world.label));
    }
    world.absorb(Facts::default());
    told
}

/// Why no error is put into a world.
pub fn left_out(world: &World) -> Option<&'static str> {
    let is_made_up = world.label.contains("rosbag2_test");
    is_made_up.then_some(
        "its numbers are made up: orientation and gyro have nothing to do with each other, as QUAT01 reports",
    )
}
