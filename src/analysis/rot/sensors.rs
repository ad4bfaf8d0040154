//! Mountings of sensors, told by the names of frames: a heuristic, good for hints only.

use nalgebra::Isometry3;

use crate::analysis::names;
use crate::analysis::names::{has_word, has_word_of};
use crate::source::Place;
use crate::world::{Claim, ClaimKind, FrameId, World};

/// Words for kinds of sensor; the lists of one row name one kind.
const KINDS: &[&[&[&str]]] = &[
    &[names::LIDARS, names::LIDAR_MAKERS, &["scan", "os"]],
    &[names::CAMERAS, &["fisheye"]],
    &[&["imu", "ins"]],
    &[names::GNSS, &["antenna"]],
    &[&["radar"]],
    &[&["sonar", "ultrasonic"]],
];

/// Words for frames that belong to a sensor or to its housing: what hangs on them may well coincide with them.
const HOUSINGS: &[&str] = &[
    "stereo",
    "kinect2",
    "oak",
    "oakd",
    "xtion",
    "astra",
    "d435",
    "d455",
    "t265",
    "kinect",
    "realsense",
    "zed",
    "depth",
    "mount",
    "sensor",
    "optical",
    "bracket",
    "plate",
    "adapter",
];

/// Words for frames that are drawn by a convention, not mounted.
const VIRTUAL: &[&str] = &["optical", "footprint", "virtual", "dummy", "joint"];

/// Words for parts and data of one sensor.
const PARTS: &[&str] = &[
    "link",
    "frame",
    "base",
    "sensor",
    "device",
    "color",
    "colour",
    "rgb",
    "depth",
    "infra",
    "infra1",
    "infra2",
    "ir",
    "accelerometer",
    "accel",
    "gyrometer",
    "gyroscope",
    "gyro",
    "magnetometer",
    "mag",
];

/// Words that say where something is mounted, or on what, and so name no device.
const PLACES: &[&str] = &[
    "front", "rear", "back", "left", "right", "top", "upper", "lower", "roof", "center", "middle", "side", "base",
    "robot", "car", "vehicle", "ego", "body", "chassis", "arm", "head", "torso", "tool", "wrist",
];

/// A sensor on something that is no sensor.
#[derive(Debug)]
pub(crate) struct Mounting {
    /// What it is mounted on.
    pub parent: FrameId,
    /// The sensor's frame.
    pub sensor: FrameId,
    /// The sensor's pose in the parent.
    pub parent_from_sensor: Isometry3<f64>,
    /// Whether nothing was written at all.
    pub is_unstated: bool,
    /// Where.
    pub place: Place,
}

impl Mounting {
    /// Whether the pose is the identity, to the last bit that a file spells.
    pub(crate) fn is_identity(&self) -> bool {
        self.parent_from_sensor.translation.vector.norm() <= 1e-12 && self.parent_from_sensor.rotation.angle() <= 1e-9
    }

    /// Whether the two frames are called after one sensor: `camera_link` and `camera_color_frame`.
    fn is_same_sensor(&self, other: &Self) -> bool {
        let name = |frame: &FrameId| -> Vec<String> {
            let tokens = frame.tokens().into_iter();
            tokens.filter(|token| !PARTS.contains(&token.as_str())).collect()
        };
        name(&self.sensor) == name(&other.sensor)
    }

    /// Whether another sensor of the same kind and source has exactly this pose on the same parent.
    pub(crate) fn is_copy_of(&self, other: &Self) -> bool {
        let difference = self.parent_from_sensor.inv_mul(&other.parent_from_sensor);
        self.place.source == other.place.source
            && self.parent == other.parent
            && !self.is_same_sensor(other)
            && kind(&self.sensor) == kind(&other.sensor)
            && difference.translation.vector.norm() <= 1e-12
            && difference.rotation.angle() <= 1e-9
    }
}

/// The rigid mountings of named sensors in URDF, files and static TF.
pub(crate) fn mountings(world: &World) -> Vec<Mounting> {
    let mut all = Vec::new();
    for claim in world.claims.iter().filter(|claim| claim.is_rigid()) {
        let (Some((parent, sensor)), Some(pose)) = (&claim.frames, &claim.pose) else {
            continue;
        };
        let is_whole = claim.has_rotation && claim.has_translation;
        // A camera against an IMU is a pair of sensors, and what a calibration file is for.
        let is_joint = matches!(claim.kind, ClaimKind::Joint { .. });
        if is_whole && is_mounting(parent, sensor, is_joint) && !is_by_design(claim, parent, sensor) {
            all.push(Mounting {
                parent: parent.clone(),
                sensor: sensor.clone(),
                parent_from_sensor: pose.isometry(),
                is_unstated: matches!(claim.kind, ClaimKind::Joint { has_origin: false, .. }),
                place: claim.place.clone(),
            });
        }
    }
    for bag in &world.bags {
        for edge in bag.tf.iter().filter(|edge| edge.is_static) {
            if let Some(sample) = edge.first().filter(|_| is_mounting(&edge.parent, &edge.child, true)) {
                all.push(Mounting {
                    parent: edge.parent.clone(),
                    sensor: edge.child.clone(),
                    parent_from_sensor: sample.pose.isometry(),
                    is_unstated: false,
                    place: Place::message(bag.source, sample.at.clone()),
                });
            }
        }
    }
    all
}

fn is_mounting(parent: &FrameId, sensor: &FrameId, in_tree: bool) -> bool {
    let Some(sensor_kind) = kind(sensor) else { return false };
    let parent_is_other = match kind(parent) {
        None => true,
        Some(parent_kind) => !in_tree && parent_kind != sensor_kind,
    };
    parent_is_other && !has_word(parent, HOUSINGS) && !has_word(sensor, VIRTUAL) && !is_of_one_device(parent, sensor)
}

/// Whether a program's own conventions put a sensor exactly there: its body is its IMU, or a simulator's sensors share a place.
fn is_by_design(claim: &Claim, body: &FrameId, sensor: &FrameId) -> bool {
    let ClaimKind::File { dialect, roles: true } = &claim.kind else {
        return false;
    };
    dialect == "carla" || (body.as_str(), sensor.as_str()) == ("body", "imu")
}

/// Whether both names begin with the name of one device: `oakd_link` and `oakd_rgb_camera_frame`.
fn is_of_one_device(parent: &FrameId, sensor: &FrameId) -> bool {
    let (parent, sensor) = (parent.tokens(), sensor.tokens());
    let device = parent.first().filter(|token| !PLACES.contains(&token.as_str()));
    device.is_some() && device == sensor.first()
}

/// The kind of sensor that a frame is named after.
fn kind(frame: &FrameId) -> Option<usize> {
    KINDS.iter().position(|words| has_word_of(frame, words))
}
