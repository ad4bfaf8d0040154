//! Errors of a lidar that is staged beside a recording's poses.

use frames_lint::faults::Fault;
use nalgebra::{Isometry3, Vector3};

use super::StagedFault;
use crate::errors::Change;
use crate::lidars::{LIDAR, LidarSetup, RIGHT, optical, set_lidar, turn};
use crate::support::clouds::Times;

macro_rules! lidar {
    ($name:literal, $setup:expr, $words:expr, $texts:expr, $seen_by:expr) => {
        error!(
            $name,
            Change::Staged(&LIDAR, |world, stream| set_lidar(
                world,
                stream,
                &LidarSetup { ..$setup }
            )),
            $words,
            $texts,
            $seen_by
        )
    };
}

macro_rules! other_frame {
    ($name:literal, $more:expr) => {
        lidar!(
            $name,
            LidarSetup {
                cloud: |lidar| {
                    lidar.turned_deg = 180.0;
                    let more: fn(&mut crate::support::clouds::Lidar) = $more;
                    more(lidar);
                },
                ..RIGHT
            },
            // AXES12 sees the half turn by the way, where it sees one.
            ["z180"],
            [],
            ["SENSOR01"]
        )
    };
}

pub static ERRORS: &[StagedFault] = &[
    lidar!(
        "cloud z down",
        LidarSetup {
            axes: |_| turn(Vector3::x(), 180.0),
            ..RIGHT
        },
        ["x180"],
        [],
        ["AXES10", "TIME07"]
    ),
    lidar!(
        "cloud z forward",
        LidarSetup {
            axes: |_| optical(),
            ..RIGHT
        },
        ["optical"],
        [],
        ["AXES10"]
    ),
    lidar!(
        "mount z down",
        LidarSetup {
            mount: |mount| mount * turn(Vector3::x(), 180.0),
            ..RIGHT
        },
        ["mount"],
        [],
        ["AXES10"]
    ),
    lidar!(
        "mount z forward",
        LidarSetup {
            mount: |mount| mount * optical().inverse(),
            ..RIGHT
        },
        ["mount"],
        [],
        ["AXES10"]
    ),
    lidar!(
        "lidar yaw 90",
        LidarSetup {
            mount: |mount| mount * turn(Vector3::z(), 90.0),
            ..RIGHT
        },
        ["z90", "z-90"],
        [],
        ["AXES12"]
    ),
    lidar!(
        "lidar yaw 180",
        LidarSetup {
            mount: |mount| mount * turn(Vector3::z(), 180.0),
            ..RIGHT
        },
        ["z180", "z180-extra", "z180-missing"],
        [],
        ["AXES12"]
    ),
    lidar!(
        "lidar mount inverse",
        LidarSetup {
            mount: |mount| mount.inverse(),
            ..RIGHT
        },
        ["inverse", "z-sign"],
        ["it is inverted: its inverse"],
        ["CROSS04"]
    ),
    lidar!(
        "cloud mirrored",
        LidarSetup {
            cloud: |lidar| lidar.mirrored = true,
            ..RIGHT
        },
        ["mirrored"],
        [],
        ["AXES11", "TIME07"]
    ),
    other_frame!("Ouster frame", |_| {}),
    other_frame!("Ouster destaggered", |lidar| lidar.destaggered = true),
    other_frame!("Ouster 60 % lost", |lidar| lidar.lost = Some(0.6)),
    other_frame!("Ouster window", |lidar| lidar.window_deg = Some([-60.0, 60.0])),
    lidar!(
        "os_lidar as os_sensor",
        LidarSetup {
            half_turn: 0.0,
            ..RIGHT
        },
        ["identity"],
        [],
        ["SENSOR02"]
    ),
    lidar!(
        "no point times",
        LidarSetup {
            cloud: |lidar| lidar.times = Times::Missing,
            ..RIGHT
        },
        ["missing"],
        [],
        ["TIME05"]
    ),
    lidar!(
        "one point time",
        LidarSetup {
            cloud: |lidar| lidar.times = Times::Constant,
            ..RIGHT
        },
        ["constant"],
        [],
        ["TIME05"]
    ),
    lidar!(
        "point times in us",
        LidarSetup {
            cloud: |lidar| lidar.time_scale = 1e-3,
            ..RIGHT
        },
        ["unit"],
        [],
        ["TIME06"]
    ),
    lidar!(
        "point times reversed",
        LidarSetup {
            cloud: |lidar| lidar.times = Times::Reversed,
            ..RIGHT
        },
        ["times-reversed"],
        [],
        ["TIME07"]
    ),
    lidar!(
        "cloud in UTM",
        LidarSetup {
            axes: |_| Isometry3::translation(448_262.0, 5_411_932.0, 120.0),
            ..RIGHT
        },
        ["float32"],
        ["code in float32 loses digits"],
        ["PREC01"]
    ),
];
