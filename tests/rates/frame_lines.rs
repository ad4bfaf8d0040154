//! Lines of the rules that judge frames: bases and maps (AXES13, AXES14), orders and constants of orientations (QUAT02,
//! QUAT04), corrections (TREE16), and what names tell of a sensor (SENSOR05, SENSOR06, SENSOR09).

use crate::drives::Kind;
use crate::faults::Fault;
use crate::frame_worlds::MADE;
use crate::lines::groups;
use crate::support::drive::description::Vehicle;
use crate::table::{ALL, AnswerKey, Table};

/// A rule, its subject, and the worlds that it is asked of.
type RuleFaults = (&'static str, &'static str, &'static [Fault]);

const SHOWS: &[RuleFaults] = &[
    (
        "AXES13",
        "axes of `base_link`",
        &[
            Fault::Healthy,
            Fault::FrameWorld("TF alone"),
            Fault::FrameWorld("TF alone, base FRD"),
            Fault::FrameWorld("pose of base FRD"),
            Fault::FrameWorld("pose of base RFU"),
            Fault::FrameWorld("base FRD"),
            Fault::FrameWorld("base RFU"),
            Fault::FrameWorld("base LBU"),
            Fault::FrameWorld("base backward"),
        ],
    ),
    (
        "AXES14",
        "z of `odom`, by gravity",
        &[Fault::Healthy, Fault::FrameWorld("odom NED")],
    ),
    (
        "AXES14",
        "z of `map`, by gravity",
        &[
            Fault::FrameWorld("map"),
            Fault::FrameWorld("map optical"),
            Fault::FrameWorld("map y up"),
            Fault::FrameWorld("map z down"),
            Fault::FrameWorld("map tilted 20 deg"),
            Fault::FrameWorld("map tilted 50 deg"),
        ],
    ),
    (
        "AXES14",
        "z of `odom`, by altitude",
        &[Fault::FrameWorld("odom z negated")],
    ),
    ("AXES14", "z of `map`, by altitude", &[Fault::FrameWorld("map")]),
    (
        "QUAT02",
        "order of the orientation of topic `/odom`",
        &[Fault::Healthy, Fault::FrameWorld("odom wxyz")],
    ),
    (
        "QUAT02",
        "order of the orientation of topic `/imu`",
        &[Fault::Imu("wxyz")],
    ),
    (
        "QUAT02",
        "order of the orientation of TF",
        &[Fault::FrameWorld("TF alone"), Fault::FrameWorld("TF wxyz")],
    ),
    (
        "QUAT02",
        "order of the orientation of topic `/pose`",
        &[Fault::FrameWorld("poses"), Fault::FrameWorld("poses wxyz")],
    ),
    (
        "QUAT04",
        "orientation of topic `/imu`",
        &[
            Fault::Healthy,
            Fault::FrameWorld("pose of base FRD"),
            Fault::Imu("upside down"),
        ],
    ),
    (
        "QUAT04",
        "topic `/vio/odom`",
        &[
            Fault::FrameWorld("wheels, VIO"),
            Fault::FrameWorld("VIO of FRD"),
            Fault::FrameWorld("VIO of RDF"),
        ],
    ),
    (
        "QUAT04",
        "topic `/slam/pose`",
        &[
            Fault::FrameWorld("two maps"),
            Fault::FrameWorld("two maps, x 90 deg"),
            Fault::FrameWorld("two maps, z down"),
        ],
    ),
    (
        "TREE16",
        "correction of `odom`",
        &[
            Fault::FrameWorld("correction moves"),
            Fault::FrameWorld("stand-in, no drift"),
            Fault::FrameWorld("no drift, AMCL"),
            Fault::FrameWorld("stand-in"),
            Fault::FrameWorld("stand-in, AMCL"),
        ],
    ),
    (
        "SENSOR05",
        "frame of topic `/livox/imu`",
        &[Fault::FrameWorld("lidar"), Fault::FrameWorld("lidar's frame")],
    ),
    (
        "SENSOR06",
        "axes of",
        &[
            Fault::FrameWorld("NovAtel"),
            Fault::FrameWorld("Xsens"),
            Fault::FrameWorld("VectorNav"),
            Fault::FrameWorld("MAVROS"),
            Fault::FrameWorld("VectorNav NED/FRD"),
            Fault::FrameWorld("VectorNav NED quat."),
        ],
    ),
    (
        "SENSOR06",
        "zero of the yaw of",
        &[
            Fault::FrameWorld("NovAtel"),
            Fault::FrameWorld("Xsens"),
            Fault::FrameWorld("VectorNav"),
            Fault::FrameWorld("NovAtel zero north"),
            Fault::FrameWorld("NovAtel RFU"),
            Fault::FrameWorld("Xsens NWU"),
            Fault::FrameWorld("VectorNav RFU"),
        ],
    ),
    (
        "SENSOR09",
        "topic",
        &[
            Fault::FrameWorld("CARLA"),
            Fault::FrameWorld("CARLA left-handed"),
            Fault::FrameWorld("Unity, no fixes"),
            Fault::FrameWorld("Unity left-handed"),
        ],
    ),
];

/// Every line; and of each world what all rules say together.
pub fn lines(table: &mut Table) {
    for (group, kinds, pooled) in groups() {
        let mut ask = |rule, subject, fault: Fault, pooled| {
            for kind in kinds.iter().filter(|kind| shows(**kind, fault)) {
                let asked = AnswerKey {
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
            ask(ALL, "", Fault::FrameWorld(made.name), true);
        }
    }
}

/// What a line is called whose rule looks at what is healthy, or at a world, in two ways.
fn called(subject: &str, fault: Fault) -> Option<&'static str> {
    match (subject, fault) {
        ("zero of the yaw of", Fault::FrameWorld("NovAtel")) => Some("NovAtel, zero"),
        ("zero of the yaw of", Fault::FrameWorld("Xsens")) => Some("Xsens, zero"),
        ("zero of the yaw of", Fault::FrameWorld("VectorNav")) => Some("VectorNav, zero"),
        ("z of `map`, by altitude", _) => Some("map, by altitude"),
        ("orientation of topic `/imu`", Fault::Healthy) => Some("odometry, IMU"),
        _ => None,
    }
}

/// Whether a fault shows: who stays on the ground has no heights whose sign could be wrong.
fn shows(kind: Kind, fault: Fault) -> bool {
    fault != Fault::FrameWorld("odom z negated") || kind.vehicle == Vehicle::Drone
}
