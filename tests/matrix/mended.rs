//! Faults that real recordings have by themselves are taken off before others are put in.

use frames_lint::world::{Facts, World};
use nalgebra::Vector3;

use crate::errors::{GRAVITY, as_imu_rows};
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
    world.absorb(Facts::default());
    told
}
