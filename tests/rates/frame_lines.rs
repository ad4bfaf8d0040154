//! Lines of the rules that judge frames: bases and maps (AXES13, AXES14), orders and constants of orientations (QUAT02,
//! QUAT04), corrections (TREE16), and what names tell of a sensor (SENSOR05, SENSOR06, SENSOR09).

use crate::drives::Kind;
use crate::faults::Fault;
use crate::frame_worlds::MADE;
use crate::lines::groups;
use crate::support::drive::description::Vehicle;
use crate::table::{ALL, Asked, Table};

/// A rule, its subject, and the worlds that it is asked of.
type Shows = (&'static str, &'static str, &'static [Fault]);

const SHOWS: &[Shows] = &[
    (
        "AXES13",
        "axes of `base_link`",
        &[
            Fault::Healthy,
            Fault::Made("TF alone"),
            Fault::Made("TF alone, base FRD"),
            Fault::Made("pose of base FRD"),
            Fault::Made("pose of base RFU"),
            Fault::Made("base FRD"),
            Fault::Made("base RFU"),
            Fault::Made("base LBU"),
            Fault::Made("base backward"),
        ],
    ),
    (
        "AXES14",
        "z of `odom`, by gravity",
        &[Fault::Healthy, Fault::Made("odom NED")],
    ),
    (
        "AXES14",
        "z of `map`, by gravity",
        &[
            Fault::Made("map"),
            Fault::Made("map optical"),
            Fault::Made("map y up"),
            Fault::Made("map z down"),
            Fault::Made("map tilted 20 deg"),
            Fault::Made("map tilted 50 deg"),
        ],
    ),
    ("AXES14", "z of `odom`, by altitude", &[Fault::Made("odom z negated")]),
    ("AXES14", "z of `map`, by altitude", &[Fault::Made("map")]),
    (
        "QUAT02",
        "order of the orientation of topic `/odom`",
        &[Fault::Healthy, Fault::Made("odom wxyz")],
    ),
    (
        "QUAT02",
        "order of the orientation of topic `/imu`",
        &[Fault::Imu("wxyz")],
    ),
    (
        "QUAT02",
        "order of the orientation of TF",
        &[Fault::Made("TF alone"), Fault::Made("TF wxyz")],
    ),
    (
        "QUAT02",
        "order of the orientation of topic `/pose`",
        &[Fault::Made("poses"), Fault::Made("poses wxyz")],
    ),
    (
        "QUAT04",
        "orientation of topic `/imu`",
        &[
            Fault::Healthy,
            Fault::Made("pose of base FRD"),
            Fault::Imu("upside down"),
        ],
    ),
    (
        "QUAT04",
        "topic `/vio/odom`",
        &[
            Fault::Made("wheels, VIO"),
            Fault::Made("VIO of FRD"),
            Fault::Made("VIO of RDF"),
        ],
    ),
    (
        "QUAT04",
        "topic `/slam/pose`",
        &[
            Fault::Made("two maps"),
            Fault::Made("two maps, x 90 deg"),
            Fault::Made("two maps, z down"),
        ],
    ),
    (
        "TREE16",
        "correction of `odom`",
        &[
            Fault::Made("correction moves"),
            Fault::Made("stand-in, no drift"),
            Fault::Made("no drift, AMCL"),
            Fault::Made("stand-in"),
            Fault::Made("stand-in, AMCL"),
        ],
    ),
    (
        "SENSOR05",
        "frame of topic `/livox/imu`",
        &[Fault::Made("lidar"), Fault::Made("lidar's frame")],
    ),
    (
        "SENSOR06",
        "axes of",
        &[
            Fault::Made("NovAtel"),
            Fault::Made("Xsens"),
            Fault::Made("VectorNav"),
            Fault::Made("MAVROS"),
            Fault::Made("VectorNav NED/FRD"),
            Fault::Made("VectorNav NED quat."),
        ],
    ),
    (
        "SENSOR06",
        "zero of the yaw of",
        &[
            Fault::Made("NovAtel"),
            Fault::Made("Xsens"),
            Fault::Made("VectorNav"),
            Fault::Made("NovAtel zero north"),
            Fault::Made("NovAtel RFU"),
            Fault::Made("Xsens NWU"),
            Fault::Made("VectorNav RFU"),
        ],
    ),
    (
        "SENSOR09",
        "topic",
        &[
            Fault::Made("CARLA"),
            Fault::Made("CARLA left-handed"),
            Fault::Made("Unity, no fixes"),
            Fault::Made("Unity left-handed"),
        ],
    ),
];

/// Every line; and of each world what all rules say together.
pub fn lines(table: &mut Table) {
    for (group, kinds, pooled) in groups() {
        let mut ask = |rule, subject, fault: Fault, pooled| {
            for kind in kinds.iter().filter(|kind| shows(**kind, fault)) {
                let asked = Asked {
                    group,
                    rule,
                    subject,
                    fault,
                    called: called(subject, fault),
                    pooled,
                    reference: None,
                };
                table.ask(*kind, &asked);
            }
        };
        for (rule, subject, faults) in SHOWS {
            faults.iter().for_each(|fault| ask(rule, subject, *fault, pooled));
        }
        for made in MADE {
            ask(ALL, "", Fault::Made(made.name), true);
        }
    }
}

/// What a line is called whose rule looks at what is healthy, or at a world, in two ways.
fn called(subject: &str, fault: Fault) -> Option<&'static str> {
    match (subject, fault) {
        ("zero of the yaw of", Fault::Made("NovAtel")) => Some("NovAtel, zero"),
        ("zero of the yaw of", Fault::Made("Xsens")) => Some("Xsens, zero"),
        ("zero of the yaw of", Fault::Made("VectorNav")) => Some("VectorNav, zero"),
        ("z of `map`, by altitude", _) => Some("map, by altitude"),
        ("orientation of topic `/imu`", Fault::Healthy) => Some("odometry, IMU"),
        _ => None,
    }
}

/// Whether a fault shows: who stays on the ground has no heights whose sign could be wrong.
fn shows(kind: Kind, fault: Fault) -> bool {
    fault != Fault::Made("odom z negated") || kind.vehicle == Vehicle::Drone
}
