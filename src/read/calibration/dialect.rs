//! Dialects: what a known format says beyond its words.
//!
//! A key that only one program writes fixes what the generic reading cannot know: units, the meaning of a list, how far
//! a direction can be trusted. Adding a dialect: one row of [`TABLE`] (or, for a format known by its nesting, one branch
//! in `generic`), with its source, and a test with a few lines of the real format.

use crate::source::Confidence;

/// What a key of a known format means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dialect {
    /// The word in `ClaimKind::File`.
    pub(super) name: &'static str,
    /// Metres of one unit of length.
    pub(super) metres: f64,
    /// Whether angles are degrees.
    pub(super) degrees: bool,
    /// How sure frames and direction are, if the format settles it.
    pub(super) reading: Option<Confidence>,
    /// The list holds one 4x4 for each sensor, and the bottom rows carry flags: only their upper 3x4 are transforms.
    pub(super) packed: bool,
}

/// Plain words, metres, radians.
pub(super) const GENERIC: Dialect = Dialect {
    name: "generic",
    metres: 1.0,
    degrees: false,
    reading: None,
    packed: false,
};

/// Autoware's `parent: {child: {x, y, z, roll, pitch, yaw}}`: the sensor kit's xacro pastes the values into a joint's
/// origin under these names.
pub(super) const AUTOWARE: Dialect = Dialect {
    name: "autoware",
    reading: Some(Confidence::Certain),
    ..GENERIC
};

/// nuScenes and Lyft tables: `rotation: [w, x, y, z]` in records with a `token` (nuscenes-devkit, pyquaternion).
pub(super) const NUSCENES: Dialect = Dialect {
    name: "nuscenes",
    ..GENERIC
};

/// Ouster sensor metadata: millimetres; `lidar_to_sensor` takes lidar coordinates to sensor coordinates (ouster-sdk).
const OUSTER: Dialect = Dialect {
    name: "ouster",
    metres: 1e-3,
    reading: Some(Confidence::Likely),
    ..GENERIC
};

/// Keys of known formats.
const TABLE: &[(&str, Dialect)] = &[
    ("lidar_to_sensor_transform", OUSTER),
    ("imu_to_sensor_transform", OUSTER),
    ("beam_to_lidar_transform", OUSTER),
    // SLICT: "the (4,4) entry of the extrinsics is used to declare whether stamp is at beginning or end of scan".
    (
        "lidar_extr",
        Dialect {
            name: "slict",
            packed: true,
            ..GENERIC
        },
    ),
    // carla-ros-bridge `objects.json`: metres and degrees (carla_spawn_objects).
    (
        "spawn_point",
        Dialect {
            name: "carla",
            degrees: true,
            ..GENERIC
        },
    ),
    // livox_ros_driver2 `*_config.json`: millimetres and degrees (applied as `* PI / 180` and `/ 1000`).
    (
        "extrinsic_parameter",
        Dialect {
            name: "livox",
            metres: 1e-3,
            degrees: true,
            ..GENERIC
        },
    ),
    // OpenCalib (SensorsCalibration): `{rows, cols, data}` under the name of the pair of sensors.
    (
        "sensor_calib",
        Dialect {
            name: "opencalib",
            ..GENERIC
        },
    ),
];

/// The dialect that a key belongs to; [`GENERIC`] for all others.
pub(super) fn of_key(key: &str) -> Dialect {
    TABLE
        .iter()
        .find(|(known, _)| *known == key)
        .map_or(GENERIC, |(_, dialect)| *dialect)
}
