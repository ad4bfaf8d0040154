//! Mistakes in how sensors are mounted.
//!
//! The mounting of a sensor is the transform that ties it to the base. What publishes it reads the robot's description: the mistake is
//! in every recording and every joint that state the same transform, and not in calibration files, which state it anew.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

use crate::math::relation::Relation;
use crate::world::bag::TopicEvidence;
use crate::world::content::ContentEvidence;
use crate::world::graph::{Edge, EdgeOrigin, FrameGraph};
use crate::world::{Claim, ClaimKind, FrameId, World};

use super::{Change, Fault, Subject, SubjectPlace, restate};

/// What makes the wrong mounting of the right one.
#[derive(Clone, Copy)]
pub(super) enum Mounting {
    /// A relation.
    Related(Relation),
    /// The base is the ground under the sensor.
    HeightLost,
    /// Turned where it is about an axis of the base, degrees.
    Turned(Axis, f64),
    /// Moved along an axis of the base, metres.
    Moved(Axis, f64),
}

/// An axis of the base.
#[derive(Clone, Copy)]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    fn direction(self) -> Unit<Vector3<f64>> {
        match self {
            Self::X => Vector3::x_axis(),
            Self::Y => Vector3::y_axis(),
            Self::Z => Vector3::z_axis(),
        }
    }
}

impl Mounting {
    fn held(self, truth: &Isometry3<f64>) -> Option<Isometry3<f64>> {
        match self {
            Self::Related(relation) => relation.apply(truth),
            Self::HeightLost => {
                let mut held = *truth;
                held.translation.z = 0.0;
                Some(held)
            }
            Self::Turned(axis, deg) => {
                let turn = UnitQuaternion::from_axis_angle(&axis.direction(), deg.to_radians());
                Some(Isometry3::from_parts(truth.translation, turn * truth.rotation))
            }
            Self::Moved(axis, metres) => Some(Translation3::from(axis.direction().into_inner() * metres) * truth),
        }
    }

    /// Whether it leaves the position of the sensor as it is.
    fn is_turn(self, truth: &Isometry3<f64>) -> bool {
        let held = self.held(truth).map(|held| held.translation.vector);
        held.is_some_and(|held| (held - truth.translation.vector).norm() <= 1e-6)
    }
}

impl Change for Mounting {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let mut subjects = Vec::new();
        let mounted = match self {
            Self::Related(_) | Self::HeightLost => mounted(world, with_data(world)),
            // A calibration file shows sizes without data, too.
            Self::Turned(..) | Self::Moved(..) => mounted(world, with_data(world).chain(calibrated(world))),
        };
        for mounted in mounted {
            let Some(truth) = pose_at(world, &mounted.at) else {
                continue;
            };
            // A receiver measures a place, and no direction.
            if mounted.has_axes || !self.is_turn(&truth) {
                subjects.push(mounted.subject());
            }
        }
        subjects
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        remount(world, &subject.at, |truth| self.held(truth))
    }

    fn same_as(&self, world: &World, subject: &Subject) -> Vec<&'static str> {
        let truth = pose_at(world, &subject.at);
        let both = truth.and_then(|truth| Some((truth, self.held(&truth)?)));
        both.map_or_else(Vec::new, |(truth, held)| restate::relations_between(&truth, &held))
    }
}

/// The edge of the frame graph that a place states.
fn edge_at<'w>(world: &'w World, at: &SubjectPlace) -> Option<&'w Edge> {
    world.graph().edges.iter().find(|edge| place_of(edge) == *at)
}

/// The place of the statement that an edge comes from.
pub(super) fn place_of(edge: &Edge) -> SubjectPlace {
    match edge.origin {
        EdgeOrigin::Joint(claim) | EdgeOrigin::Published(claim) => SubjectPlace::Claim(claim),
        EdgeOrigin::Tf(bag, edge) => SubjectPlace::Edge { bag, edge },
    }
}

/// The transform that an edge at a place states.
pub(super) fn pose_at(world: &World, at: &SubjectPlace) -> Option<Isometry3<f64>> {
    edge_at(world, at)?.pose
}

/// Changes a transform of the tree wherever joints and static transforms state the same. False where nothing changes.
pub(super) fn remount(
    world: &mut World,
    at: &SubjectPlace,
    change: impl Fn(&Isometry3<f64>) -> Option<Isometry3<f64>>,
) -> bool {
    let Some(edge) = edge_at(world, at) else { return false };
    let Some(truth) = edge.pose else { return false };
    // What a description states with few digits is published with few digits, too; a calibration may have replaced it.
    let is_it = |other: &&Edge| {
        let is_near = |pose: Isometry3<f64>| {
            (pose.translation.vector - truth.translation.vector).norm() < 1e-3
                && pose.rotation.angle_to(&truth.rotation) < 1e-3
        };
        (&other.parent, &other.child) == (&edge.parent, &edge.child)
            && other.is_rigid
            && other.pose.is_some_and(is_near)
    };
    let stated: Vec<EdgeOrigin> = world
        .graph()
        .edges_to(&edge.child)
        .filter(is_it)
        .map(|edge| edge.origin)
        .collect();
    let Some(held) = change(&truth).filter(|held| !restate::is_same(&truth, held)) else {
        return false;
    };
    for origin in stated {
        match origin {
            EdgeOrigin::Joint(claim) | EdgeOrigin::Published(claim) => restate::restate_claim(world, claim, &held),
            EdgeOrigin::Tf(bag, edge) => {
                let edge = world.bags.get_mut(bag).and_then(|bag| bag.tf.get_mut(edge));
                if let Some(edge) = edge {
                    restate::restate_edge(edge, &held);
                }
            }
        }
    }
    world.forget();
    true
}

/// A mounting with the sensors that it carries.
struct Mounted {
    at: SubjectPlace,
    parent: FrameId,
    child: FrameId,
    /// The frames between it and the data.
    frames: BTreeSet<FrameId>,
    topics: BTreeSet<String>,
    /// Whether one of the sensors measures directions.
    has_axes: bool,
}

impl Mounted {
    fn subject(&self) -> Subject {
        let quoted = |name: &str| format!("`{name}`");
        let frames = self.frames.iter().map(FrameId::as_str);
        Subject {
            name: format!("mounting `{}` from `{}`", self.parent, self.child),
            words: frames
                .chain(self.topics.iter().map(String::as_str))
                .map(quoted)
                .collect(),
            at: self.at.clone(),
        }
    }
}

/// A frame of a sensor, with the recording and the topic of its data, and whether it has directions.
type SensorFrame = (FrameId, usize, Option<String>, bool);

/// The frames of sensors with data.
fn with_data(world: &World) -> impl Iterator<Item = SensorFrame> {
    let bags = world.bags.iter().enumerate();
    let topics = bags.flat_map(|(bag, evidence)| evidence.topics.values().map(move |topic| (bag, topic)));
    topics
        .filter(|(_, topic)| is_of_a_sensor(topic))
        .flat_map(|(bag, topic)| {
            let has_axes = topic.content.fixes.is_none();
            let frames = topic.header_frames.keys().map(FrameId::canonical);
            frames.map(move |frame| (frame, bag, Some(topic.topic.clone()), has_axes))
        })
}

/// The frames that calibration files state a transform of.
fn calibrated(world: &World) -> impl Iterator<Item = SensorFrame> {
    let is_of_file = |claim: &&Claim| matches!(claim.kind, ClaimKind::File { .. }) && claim.is_rigid();
    let claims = world.claims.iter().filter(is_of_file);
    claims.flat_map(|claim| {
        let frames = claim.frames.iter().flat_map(|(target, source)| [target, source]);
        frames.map(|frame| (frame.canonical(), 0, None, claim.has_rotation))
    })
}

/// The mountings of these sensors: of each the rigid transform that is nearest to the base.
fn mounted(world: &World, sensors: impl Iterator<Item = SensorFrame>) -> Vec<Mounted> {
    let graph = world.graph();
    let bodies = bodies(world);
    let mut all: BTreeMap<(FrameId, FrameId), Mounted> = BTreeMap::new();
    for (frame, bag, topic, has_axes) in sensors {
        let Some((edge, frames)) = mounting(graph, &frame, &bodies, bag) else {
            continue;
        };
        let key = (edge.parent.clone(), edge.child.clone());
        let mounted = all.entry(key).or_insert_with(|| Mounted {
            at: place_of(edge),
            parent: edge.parent.clone(),
            child: edge.child.clone(),
            frames: BTreeSet::new(),
            topics: BTreeSet::new(),
            has_axes: false,
        });
        mounted.frames.extend(frames);
        mounted.topics.extend(topic);
        mounted.has_axes |= has_axes;
    }
    all.into_values().collect()
}

/// Whether a topic has the data of a sensor that is mounted somewhere.
pub(super) fn is_of_a_sensor(topic: &TopicEvidence) -> bool {
    let ContentEvidence {
        fixes,
        imu,
        calibrations,
        images,
        clouds,
        lasers,
        radar,
        ..
    } = &*topic.content;
    fixes.is_some()
        || imu.is_some()
        || calibrations.is_some()
        || images.is_some()
        || clouds.is_some()
        || lasers.is_some()
        || radar.is_some()
}

/// Frames of the platform itself: the bases of REP-105, and those that odometry or TF moves.
fn bodies(world: &World) -> BTreeSet<FrameId> {
    let graph = world.graph();
    let is_base = |frame: &&FrameId| {
        let last = frame.as_str().rsplit('/').next();
        matches!(last, Some("base_link" | "base_footprint"))
    };
    let moved = graph
        .edges
        .iter()
        .filter(|edge| !edge.is_rigid)
        .map(|edge| edge.child.clone());
    let topics = world.bags.iter().flat_map(|bag| bag.topics.values());
    let of_odometry = topics.flat_map(|topic| topic.child_frames.keys().map(FrameId::canonical));
    let named = graph.frames.iter().filter(is_base).cloned();
    named.chain(moved).chain(of_odometry).collect()
}

/// The rigid edge that ties a sensor's frame to a body, and the frames below it; the topmost one where no body is above.
fn mounting<'g>(
    graph: &'g FrameGraph,
    sensor: &FrameId,
    bodies: &BTreeSet<FrameId>,
    bag: usize,
) -> Option<(&'g Edge, BTreeSet<FrameId>)> {
    let mut frames = BTreeSet::new();
    let mut found = None;
    let mut frame = sensor;
    while !bodies.contains(frame) && frames.insert(frame.clone()) {
        // TF of the recording itself, before that of others, and before descriptions.
        let rank = |edge: &&Edge| match edge.origin {
            EdgeOrigin::Tf(of, _) if of == bag => 0,
            EdgeOrigin::Tf(..) => 1,
            EdgeOrigin::Joint(_) | EdgeOrigin::Published(_) => 2,
        };
        let rigid = graph
            .edges_to(frame)
            .filter(|edge| edge.is_rigid && edge.pose.is_some());
        let Some(edge) = rigid.min_by_key(rank) else { break };
        frame = &edge.parent;
        found = Some(edge);
    }
    found.map(|edge| (edge, frames))
}

/// A mistake of a mounting.
macro_rules! mounting {
    ($name:literal, $mounting:expr, $sentence:literal, $($named:tt)*) => {
        fault!(Mounting, $name, $sentence, $mounting, $($named)*)
    };
}

/// The rules that see which side of a sensor is up.
const UP: [&str; 6] = ["AXES10", "AXES01", "AXES09", "AXES11", "CAMERA05", "CROSS02"];
/// The rules that see which way a sensor looks.
const FORWARD: [&str; 6] = ["AXES12", "CROSS05", "AXES06", "AXES15", "CAMERA05", "CROSS02"];
/// The rules that see where a sensor is.
const PLACE: [&str; 5] = ["AXES09", "CROSS05", "GEO08", "ROT07", "CROSS02"];

const GROUND: &str = "flat ground in view (lidars), or a calibration file that states the transform independently of the robot's description (any sensor)";
const HEIGHT: &str = "flat ground in view, and base_footprint on the ground in /tf_static or the URDF (lidars), left and right turns with odometry at changing speed (RTK receivers), or a calibration file that states the transform independently of the robot's description (any sensor)";
const DRIVE: &str = "30 s of driving with turns, with this sensor and odometry (lidars, IMUs, RTK receivers), or a calibration file that states the transform independently of the robot's description (any sensor)";
const SECOND: &str = "a calibration file that states the transform independently of the robot's description";

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[
    mounting!(
        "mounting-inverse",
        Mounting::Related(Relation::Inverse),
        "The mounting of a sensor is inverted: the base in the sensor is published as the sensor in the base.",
        ["inverse", "z-sign"],
        ["it is inverted: its inverse", "or it is inverted"],
        ["CROSS04", "AXES09", "CROSS05", "AXES10", "AXES01", "GEO08", "CROSS02"],
        DRIVE
    ),
    mounting!(
        "mounting-upside-down",
        Mounting::Related(Relation::FluFrd),
        "A sensor is mounted upright, and its transform turns it upside down, or the reverse.",
        ["flu-frd", "x180", "mount", "upside-down", "upright"],
        ["the sensor is mounted upside down"],
        UP,
        GROUND
    ),
    mounting!(
        "mounting-z-forward",
        Mounting::Related(Relation::Optical),
        "The mounting of a sensor gives it the axes of a camera: z forward, x right, y down.",
        ["optical", "optical-inverse", "mount", "on-its-side"],
        ["the sensor is mounted on its side"],
        UP,
        GROUND
    ),
    mounting!(
        "mounting-yaw-90",
        Mounting::Related(Relation::Z90),
        "The mounting of a sensor has a yaw of 90 deg too much.",
        ["z90", "z-90", "turned-mount", "mount-yaw"],
        ["mounted with a yaw", "a sensor rotated to the left"],
        FORWARD,
        DRIVE
    ),
    mounting!(
        "mounting-yaw-minus-90",
        Mounting::Related(Relation::ZMinus90),
        "The mounting of a sensor is missing a yaw of 90 deg.",
        ["z-90", "z90", "turned-mount", "mount-yaw"],
        ["mounted with a yaw", "whose y axis points forward"],
        FORWARD,
        DRIVE
    ),
    mounting!(
        "mounting-yaw-180",
        Mounting::Related(Relation::Z180),
        "The mounting of a sensor has half a turn about z too much, as between the two frames of an Ouster.",
        [
            "z180",
            "z180-extra",
            "z180-missing",
            "z180-twice",
            "turned-mount",
            "mount-yaw"
        ],
        ["mounted with a yaw", "a sensor mounted backwards"],
        [
            "AXES12", "SENSOR03", "CROSS05", "AXES06", "AXES15", "CAMERA05", "CROSS02"
        ],
        DRIVE
    ),
    mounting!(
        "mounting-in-backward-base",
        Mounting::Related(Relation::LeftZ180),
        "A mounting was measured in a base whose x axis points backward: position and axes are turned by half a turn.",
        [
            "left-z180",
            "z180",
            "z180-extra",
            "z180-missing",
            "turned-mount",
            "mount-yaw"
        ],
        ["mounted with a yaw", "a sensor mounted backwards"],
        FORWARD,
        DRIVE
    ),
    mounting!(
        "mounting-roll-yaw",
        Mounting::Related(Relation::Ypr),
        "Roll and yaw of a mounting are exchanged: yaw, pitch, roll are written where roll, pitch, yaw are read.",
        ["ypr"],
        [],
        ["CROSS02", "QUAT03", "AXES10", "AXES01", "AXES12"],
        SECOND
    ),
    mounting!(
        "mounting-translation-negated",
        Mounting::Related(Relation::TranslationNegated),
        "The position of a mounting has the opposite sign.",
        ["translation-negated", "z-sign", "moved"],
        [],
        PLACE,
        HEIGHT
    ),
    mounting!(
        "mounting-translation-lost",
        Mounting::Related(Relation::TranslationLost),
        "The position of a mounting is missing: the sensor sits at the origin of the base.",
        ["translation-lost", "not-applied", "moved"],
        ["is mounted exactly at"],
        PLACE,
        HEIGHT
    ),
    mounting!(
        "mounting-rotation-lost",
        Mounting::Related(Relation::RotationLost),
        "The rotation of a mounting is missing: the sensor has the axes of the base.",
        ["rotation-lost", "yaw", "turned-mount", "mount-yaw"],
        ["mounted with a yaw", "is missing a yaw of"],
        [
            "AXES12", "CROSS05", "AXES10", "AXES01", "AXES06", "CAMERA05", "ROT07", "CROSS02"
        ],
        DRIVE
    ),
    mounting!(
        "mounting-height-lost",
        Mounting::HeightLost,
        "The height of a mounting is missing: z is zero.",
        ["not-applied"],
        ["its transform has no such height"],
        ["AXES09", "CROSS01"],
        HEIGHT
    ),
    mounting!(
        "mounting-millimetres",
        Mounting::Related(Relation::Millimetres),
        "The position of a mounting is written in millimetres.",
        ["millimetres", "metres"],
        ["probably in millimetres"],
        ["ROT06", "CROSS02"],
        SECOND
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_height_is_lost_and_nothing_else() {
        let truth = Isometry3::from_parts(
            Translation3::new(1.0, 2.0, 3.0),
            UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3),
        );
        let held = Mounting::HeightLost.held(&truth).unwrap_or_default();
        assert!(restate::is_same(
            &held,
            &Isometry3::from_parts(Translation3::new(1.0, 2.0, 0.0), truth.rotation)
        ));
        assert!(!Mounting::HeightLost.is_turn(&truth));
        assert!(Mounting::Related(Relation::Z90).is_turn(&truth));
    }

    #[test]
    fn a_sensor_is_turned_where_it_is_and_moved_along_the_axes_of_its_base() {
        let truth = Isometry3::from_parts(
            Translation3::new(1.0, 2.0, 3.0),
            UnitQuaternion::from_euler_angles(0.0, 0.0, 0.5),
        );
        let turned = Mounting::Turned(Axis::Z, 90.0).held(&truth).unwrap_or_default();
        let yaw = 0.5 + std::f64::consts::FRAC_PI_2;
        let expected = Isometry3::from_parts(truth.translation, UnitQuaternion::from_euler_angles(0.0, 0.0, yaw));
        assert!(restate::is_same(&turned, &expected));
        let moved = Mounting::Moved(Axis::Y, -0.25).held(&truth).unwrap_or_default();
        let expected = Isometry3::from_parts(Translation3::new(1.0, 1.75, 3.0), truth.rotation);
        assert!(restate::is_same(&moved, &expected));
    }
}
