//! The worlds that a lidar sees, healthy and with one fault each.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::cloud_worlds::{CloudWorld, Scenery, Sensor};
use crate::support::clouds::Times;
use crate::support::driven_world::Recording;

const GROUND: (&str, &str) = ("AXES09", "ground of");
const LEVEL: (&str, &str) = ("AXES09", "level of");
pub const UP: (&str, &str) = ("AXES10", "up of");
pub const HAND: (&str, &str) = ("AXES11", "handedness of");
const FORWARD: (&str, &str) = ("AXES12", "forward of");
const TIMES: (&str, &str) = ("TIME05", "times of");
const UNIT: (&str, &str) = ("TIME06", "unit of");
const SWEEP: (&str, &str) = ("TIME07", "sweep of");
const HEADER: (&str, &str) = ("TIME08", "header against");
pub const OUSTER: (&str, &str) = ("SENSOR01", "frame of");
const METADATA: (&str, &str) = ("SENSOR02", "");
const SINGLE: (&str, &str) = ("PREC01", "coordinates of");
pub const DIRECTION: (&str, &str) = ("CROSS04", "direction of");
const PLACE: (&str, &str) = ("CROSS05", "place of");

/// A world without a fault.
const HEALTHY: CloudWorld = CloudWorld {
    name: "",
    is_healthy: true,
    around: Scenery::Outdoors,
    sensor: Sensor::Any,
    yaw_deg: |seed| [0.0, 30.0, 90.0][(seed % 3) as usize],
    cloud: |_, _| {},
    axes: |_| Isometry3::identity(),
    stated: |mount| mount,
    frames: None,
    more: |recording| recording,
    has_imu: true,
    hints_alone: false,
    names: (&[], &[]),
    is_long: false,
    asked: &[],
};

/// One with a fault.
const WRONG: CloudWorld = CloudWorld {
    is_healthy: false,
    ..HEALTHY
};

/// One whose fault takes motion to be seen.
const MOVING: CloudWorld = CloudWorld { is_long: true, ..WRONG };

const OF_OUSTER: CloudWorld = CloudWorld {
    sensor: Sensor::Ouster,
    asked: &[OUSTER],
    ..HEALTHY
};

const OTHER_FRAME: CloudWorld = CloudWorld {
    is_healthy: false,
    names: (&["z180"], &[]),
    cloud: |lidar, _| lidar.turned_deg = 180.0,
    ..OF_OUSTER
};

/// What indoors, without gravity, may only be hinted at.
const INDOORS: CloudWorld = CloudWorld {
    has_imu: false,
    hints_alone: true,
    asked: &[UP],
    ..HEALTHY
};

/// What AXES12 says where the yaw alone shows.
const INVERSE: &str = "or it is inverted";

/// What TIME07 says of clouds that sweep the other way round.
const SWEEPS: &str = "The cloud is mirrored, its z axis points down";

/// Every world. Those with the same rays follow each other.
pub const SEEN: &[CloudWorld] = &[
    CloudWorld {
        name: "clouds",
        is_long: true,
        asked: &[
            GROUND, LEVEL, UP, HAND, FORWARD, TIMES, UNIT, SWEEP, HEADER, SINGLE, DIRECTION, PLACE,
        ],
        ..HEALTHY
    },
    CloudWorld {
        name: "clouds, short",
        asked: &[GROUND, UP, TIMES, UNIT, SWEEP, HEADER, SINGLE],
        ..HEALTHY
    },
    // Transforms alone: the clouds are the same.
    CloudWorld {
        name: "no height",
        names: (&["not-applied"], &[]),
        stated: |mount| on_level(mount, 0.0),
        asked: &[GROUND],
        ..WRONG
    },
    CloudWorld {
        name: "height negated",
        names: (&["z-sign"], &[]),
        stated: |mount| on_level(mount, -mount.translation.z),
        asked: &[GROUND],
        ..WRONG
    },
    CloudWorld {
        name: "height twice",
        names: (&["twice"], &[]),
        stated: |mount| on_level(mount, 2.0 * mount.translation.z),
        asked: &[GROUND],
        ..WRONG
    },
    CloudWorld {
        name: "mounting x180",
        names: (&["mount"], &[]),
        stated: |mount| mount * Isometry3::rotation(Vector3::x() * PI),
        asked: &[UP],
        ..WRONG
    },
    CloudWorld {
        name: "mounting optical",
        names: (&["mount"], &[]),
        stated: |mount| mount * optical().inverse(),
        asked: &[UP],
        ..WRONG
    },
    CloudWorld {
        name: "mounting inverse",
        // Its height is told beneath the ground as well.
        names: (&["inverse", "z-sign"], &[INVERSE]),
        stated: |mount| mount.inverse(),
        asked: &[DIRECTION],
        ..MOVING
    },
    CloudWorld {
        name: "mounting lacks 90 deg",
        names: (&["z90", "z-90"], &[]),
        stated: |mount| mount * Isometry3::rotation(Vector3::z() * FRAC_PI_2),
        asked: &[FORWARD],
        ..MOVING
    },
    CloudWorld {
        name: "mounting lacks 180 deg",
        names: (&["z180", "z180-extra", "z180-missing"], &[]),
        stated: |mount| mount * Isometry3::rotation(Vector3::z() * PI),
        asked: &[FORWARD],
        ..MOVING
    },
    CloudWorld {
        name: "mounting lacks 20 deg",
        names: (&["yaw"], &[]),
        stated: |mount| mount * Isometry3::rotation(Vector3::z() * 0.35),
        asked: &[FORWARD],
        ..MOVING
    },
    CloudWorld {
        name: "mounting 2.5 deg off",
        names: (&["moved", "yaw"], &[]),
        stated: |mount| mount * Isometry3::rotation(Vector3::z() * 0.0436),
        asked: &[PLACE],
        ..MOVING
    },
    CloudWorld {
        name: "mounting 0.5 m off",
        names: (&["moved"], &[]),
        stated: |mount| Isometry3::translation(0.3, -0.4, 0.0) * mount,
        asked: &[PLACE],
        ..MOVING
    },
    // The points.
    CloudWorld {
        name: "expressed in the base",
        // Its yaw was not applied either.
        names: (&["not-applied"], &["is missing a yaw of"]),
        frames: Some(["base_footprint", "lidar_top"]),
        asked: &[GROUND],
        ..WRONG
    },
    CloudWorld {
        name: "extrinsic applied twice",
        names: (&["twice"], &[]),
        axes: |mount| *mount,
        asked: &[GROUND],
        ..WRONG
    },
    CloudWorld {
        name: "expressed in the base, rightly",
        axes: |mount| *mount,
        frames: Some(["base_footprint", "lidar_top"]),
        asked: &[GROUND, UP],
        ..HEALTHY
    },
    CloudWorld {
        name: "z down",
        names: (&["x180"], &[SWEEPS]),
        axes: |_| Isometry3::rotation(Vector3::x() * PI),
        asked: &[UP],
        ..WRONG
    },
    CloudWorld {
        name: "z down, as TF says",
        axes: |_| Isometry3::rotation(Vector3::x() * PI),
        stated: |mount| mount * Isometry3::rotation(Vector3::x() * PI),
        is_long: true,
        asked: &[UP, HAND, FORWARD],
        ..HEALTHY
    },
    CloudWorld {
        name: "z forward",
        names: (&["optical"], &[]),
        axes: |_| optical(),
        asked: &[UP],
        ..WRONG
    },
    CloudWorld {
        name: "y up",
        names: (&["y-up"], &[]),
        axes: |_| Isometry3::rotation(Vector3::x() * -FRAC_PI_2),
        asked: &[UP],
        ..WRONG
    },
    CloudWorld {
        name: "on its side",
        names: (&["on-its-side"], &[]),
        axes: |_| Isometry3::rotation(Vector3::y() * FRAC_PI_2),
        asked: &[UP],
        ..WRONG
    },
    CloudWorld {
        name: "tilted by 6 deg",
        // Under a sensor beside the base the ground is some centimetres off.
        names: (&["tilted"], &["the height of the mounting, or of the base, is wrong"]),
        axes: |_| Isometry3::rotation(Vector3::y() * 0.105),
        asked: &[LEVEL],
        ..MOVING
    },
    CloudWorld {
        name: "y negated",
        names: (&["mirrored"], &[SWEEPS]),
        cloud: |lidar, _| lidar.mirrored = true,
        asked: &[HAND, SWEEP],
        ..MOVING
    },
    CloudWorld {
        name: "x, y swapped",
        names: (&["mirrored"], &[SWEEPS]),
        cloud: |lidar, _| lidar.swapped = true,
        asked: &[HAND, SWEEP],
        ..MOVING
    },
    CloudWorld {
        name: "z negated",
        // A mirror image that stands on its head: without a gyro it is a cloud on its head.
        names: (&["z-negated", "x180"], &[]),
        cloud: |lidar, _| lidar.z_negated = true,
        asked: &[HAND],
        ..MOVING
    },
    // Times.
    CloudWorld {
        name: "no times",
        names: (&["missing"], &[]),
        cloud: |lidar, _| lidar.times = Times::Missing,
        asked: &[TIMES],
        ..WRONG
    },
    CloudWorld {
        name: "one time",
        names: (&["constant"], &[]),
        cloud: |lidar, _| lidar.times = Times::Constant,
        asked: &[TIMES],
        ..WRONG
    },
    CloudWorld {
        name: "times in ms or us",
        names: (&["unit"], &[]),
        // Of nanoseconds microseconds, of seconds milliseconds: what the type of the field can hold.
        cloud: |lidar, _| lidar.time_scale = lidar.other_unit(),
        asked: &[UNIT],
        ..WRONG
    },
    CloudWorld {
        name: "times reversed",
        names: (&["times-reversed"], &["the times of its points run backwards"]),
        cloud: |lidar, _| lidar.times = Times::Reversed,
        asked: &[SWEEP],
        ..WRONG
    },
    CloudWorld {
        name: "float32 UTM",
        names: (&["float32"], &["code in float32 loses digits"]),
        cloud: |lidar, _| lidar.offset = [448_262.0, 5_411_932.0, 120.0],
        asked: &[SINGLE],
        ..WRONG
    },
    // Clocks.
    CloudWorld {
        name: "clocked",
        sensor: Sensor::Clocked,
        asked: &[HEADER, UNIT],
        ..HEALTHY
    },
    CloudWorld {
        name: "another clock",
        sensor: Sensor::Clocked,
        names: (&["elsewhere"], &[]),
        cloud: |lidar, _| lidar.clock_s = 0.7,
        asked: &[HEADER],
        ..WRONG
    },
    // A sensor that does not spin.
    CloudWorld {
        name: "solid state",
        sensor: Sensor::SolidState,
        asked: &[GROUND, UP, TIMES, UNIT, SWEEP, HEADER, SINGLE],
        ..HEALTHY
    },
    CloudWorld {
        name: "solid state, one time",
        sensor: Sensor::SolidState,
        names: (&["constant"], &[]),
        cloud: |lidar, _| lidar.times = Times::Constant,
        asked: &[TIMES],
        ..WRONG
    },
    // Ouster's two frames.
    CloudWorld {
        name: "Sensor frame",
        ..OF_OUSTER
    },
    CloudWorld {
        name: "Sensor frame, destaggered, lost",
        cloud: |lidar, seed| {
            lidar.destaggered = true;
            lidar.lost = Some(lost(seed));
        },
        ..OF_OUSTER
    },
    CloudWorld {
        name: "Sensor frame, window",
        cloud: |lidar, _| lidar.window_deg = Some([-60.0, 60.0]),
        ..OF_OUSTER
    },
    CloudWorld {
        name: "Sensor frame, filtered",
        cloud: |lidar, _| lidar.filtered = true,
        ..OF_OUSTER
    },
    CloudWorld {
        name: "Sensor frame, filtered, window",
        cloud: |lidar, _| {
            lidar.filtered = true;
            lidar.window_deg = Some([-144.0, 108.0]);
        },
        ..OF_OUSTER
    },
    CloudWorld {
        name: "Sensor fr. as os_lidar",
        names: (&["z180"], &[]),
        frames: Some(["os_lidar", "os_lidar"]),
        is_healthy: false,
        ..OF_OUSTER
    },
    CloudWorld {
        name: "Lidar fr. as os_sensor",
        ..OTHER_FRAME
    },
    CloudWorld {
        name: "Lidar fr. as os_sensor, destaggered, lost",
        cloud: |lidar, seed| {
            lidar.turned_deg = 180.0;
            lidar.destaggered = true;
            lidar.lost = Some(lost(seed));
        },
        ..OTHER_FRAME
    },
    CloudWorld {
        name: "Lidar fr. as os_sensor, window",
        cloud: |lidar, _| {
            lidar.turned_deg = 180.0;
            lidar.window_deg = Some([-60.0, 60.0]);
        },
        ..OTHER_FRAME
    },
    CloudWorld {
        name: "Lidar fr. as os_sensor, filtered",
        cloud: |lidar, _| {
            lidar.turned_deg = 180.0;
            lidar.filtered = true;
        },
        ..OTHER_FRAME
    },
    CloudWorld {
        name: "os_lidar in os_sensor",
        more: |recording| ouster(recording, PI),
        frames: Some(["os_sensor", "os_sensor"]),
        asked: &[METADATA, OUSTER],
        ..OF_OUSTER
    },
    CloudWorld {
        name: "os_lidar as os_sensor",
        names: (&["identity"], &[]),
        more: |recording| ouster(recording, 0.0),
        frames: Some(["os_sensor", "os_sensor"]),
        asked: &[METADATA],
        is_healthy: false,
        ..OF_OUSTER
    },
    // Where scans have something to match.
    CloudWorld {
        name: "clouds in a street",
        around: Scenery::Street,
        is_long: true,
        asked: &[DIRECTION, FORWARD, PLACE],
        ..HEALTHY
    },
    CloudWorld {
        name: "mounting inverse in a street",
        around: Scenery::Street,
        names: (&["inverse", "z-sign"], &[INVERSE]),
        stated: |mount| mount.inverse(),
        asked: &[DIRECTION],
        ..MOVING
    },
    // Another mounting.
    CloudWorld {
        name: "clouds, yaw 180 deg",
        yaw_deg: |_| 180.0,
        is_long: true,
        asked: &[DIRECTION, FORWARD, PLACE],
        ..HEALTHY
    },
    CloudWorld {
        name: "mounting inverse, yaw 180 deg",
        yaw_deg: |_| 180.0,
        names: (&["inverse", "z-sign"], &[INVERSE]),
        stated: |mount| mount.inverse(),
        asked: &[DIRECTION],
        ..MOVING
    },
    // Indoors, and no gravity.
    CloudWorld {
        name: "warehouse",
        around: Scenery::Warehouse,
        ..INDOORS
    },
    CloudWorld {
        name: "warehouse, z down",
        around: Scenery::Warehouse,
        is_healthy: false,
        names: (&["x180"], &[SWEEPS]),
        axes: |_| Isometry3::rotation(Vector3::x() * PI),
        ..INDOORS
    },
    CloudWorld {
        name: "warehouse, z forward",
        around: Scenery::Warehouse,
        is_healthy: false,
        names: (&["optical"], &[]),
        axes: |_| optical(),
        ..INDOORS
    },
    CloudWorld {
        name: "garage",
        around: Scenery::Garage,
        ..INDOORS
    },
    CloudWorld {
        name: "garage, z down",
        around: Scenery::Garage,
        is_healthy: false,
        names: (&["x180"], &[SWEEPS]),
        axes: |_| Isometry3::rotation(Vector3::x() * PI),
        ..INDOORS
    },
    CloudWorld {
        name: "garage, z forward",
        around: Scenery::Garage,
        is_healthy: false,
        names: (&["optical"], &[]),
        axes: |_| optical(),
        ..INDOORS
    },
    // Indoors, all beside it.
    CloudWorld {
        name: "clouds in a warehouse",
        around: Scenery::Warehouse,
        is_long: true,
        asked: &[
            GROUND, LEVEL, UP, HAND, FORWARD, TIMES, UNIT, SWEEP, HEADER, SINGLE, DIRECTION, PLACE,
        ],
        ..HEALTHY
    },
    CloudWorld {
        name: "clouds in a garage",
        around: Scenery::Garage,
        is_long: true,
        asked: &[
            GROUND, LEVEL, UP, HAND, FORWARD, TIMES, UNIT, SWEEP, HEADER, SINGLE, DIRECTION, PLACE,
        ],
        ..HEALTHY
    },
];

/// A share of 10 to 90 per cent.
fn lost(seed: u64) -> f64 {
    0.1 + 0.1 * (seed % 9) as f64
}

/// z forward, x right, y down from x forward, y left, z up: `optical_from_flu`.
fn optical() -> Isometry3<f64> {
    let rows = Matrix3::new(0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0);
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rows));
    Isometry3::from_parts(nalgebra::Translation3::identity(), turn)
}

fn on_level(mount: Isometry3<f64>, z: f64) -> Isometry3<f64> {
    let mut mount = mount;
    mount.translation.z = z;
    mount
}

/// `os_sensor_from_os_lidar` of a first OS1, turned so far.
fn ouster(recording: Recording, turn: f64) -> Recording {
    let mut lidar = Isometry3::rotation(Vector3::z() * turn);
    lidar.translation.z = 0.03618;
    recording.transform("os_sensor", "os_lidar", &lidar)
}
