//! Mountings of sensors, found by the names of frames: a heuristic, good for hints only.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Point3};

use crate::analysis::names;
use crate::analysis::names::{has_word, has_word_of};
use crate::source::{Place, SourceId};
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

/// Words for frames of a sensor or its housing: their children may coincide with them.
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

/// Words for frames that exist by convention and are not mounted.
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

/// Words for where, or on what, something is mounted, which name no device.
const PLACES: &[&str] = &[
    "front", "rear", "back", "left", "right", "top", "upper", "lower", "roof", "center", "middle", "side", "base",
    "robot", "car", "vehicle", "ego", "body", "chassis", "arm", "head", "torso", "tool", "wrist",
];

/// A sensor mounted on something that is not a sensor.
#[derive(Debug)]
pub(crate) struct Mounting {
    /// The frame that it is mounted on.
    pub parent: FrameId,
    /// The sensor's frame.
    pub sensor: FrameId,
    /// The sensor's pose in the parent.
    pub parent_from_sensor: Isometry3<f64>,
    /// Whether it has no `<origin>`.
    pub is_unstated: bool,
    /// Where.
    pub place: Place,
}

impl Mounting {
    /// Whether the pose is the identity, to the last bit that a file spells.
    pub(crate) fn is_identity(&self) -> bool {
        self.parent_from_sensor.translation.vector.norm() <= 1e-12 && self.parent_from_sensor.rotation.angle() <= 1e-9
    }
}

/// Mountings by what copies share: source, parent, kind of sensor and pose. Of each the first, and the first of another sensor: several frames
/// may be called after one (`camera_link` and `camera_color_frame`).
#[derive(Default)]
pub(crate) struct Copies<'a>(BTreeMap<CopyKey<'a>, Vec<(Vec<String>, &'a Mounting)>>);

/// The pose by where two points of the sensor lie in the parent, um.
type CopyKey<'a> = (SourceId, &'a FrameId, usize, [[u64; 3]; 2]);

impl<'a> Copies<'a> {
    /// The first earlier mounting of another sensor of the same kind and source with exactly this pose on the same parent. Remembers this one.
    pub(crate) fn copied(&mut self, mounting: &'a Mounting) -> Option<&'a Mounting> {
        let kind = kind(&mounting.sensor)?;
        let points = [[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]].map(|point| {
            let [x, y, z] = (mounting.parent_from_sensor * Point3::from(point)).coords.into();
            // Adding zero turns -0 into 0.
            [x, y, z].map(|metres: f64| ((metres * 1e6).round() + 0.0).to_bits())
        });
        let key = (mounting.place.source, &mounting.parent, kind, points);
        let tokens = mounting.sensor.tokens().into_iter();
        let name: Vec<String> = tokens.filter(|token| !PARTS.contains(&token.as_str())).collect();
        let alike = self.0.entry(key).or_default();
        let original = alike.iter().find(|(other, _)| *other != name);
        let original = original.map(|(_, other)| *other);
        if alike.is_empty() || (alike.len() == 1 && original.is_some()) {
            alike.push((name, mounting));
        }
        original
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
