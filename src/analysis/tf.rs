//! The use of a message's header frame, and the contents of a recording's TF: shared by the rules of the tree.
//!
//! Must not judge.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::{names, names::Standard};
use crate::source::MessageRef;
use crate::world::bag::{HeaderFrame, TfEdge, TopicEvidence, is_static_topic};
use crate::world::{BagEvidence, FrameId, World, qos, robot::Joint};

/// What the `frame_id` of a message type is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum HeaderUse {
    /// Nobody looks it up: diagnostics, joint states, commands.
    Ignored,
    /// It may be looked up.
    Possible,
    /// Spatial data: consumers look it up.
    Spatial,
    /// Data of a sensor mounted on the platform.
    Sensor,
}

const SENSOR_TYPES: &[&str] = &[
    "Imu",
    "PointCloud",
    "PointCloud2",
    "LaserScan",
    "MultiEchoLaserScan",
    "LaserEcho",
    "Image",
    "CompressedImage",
    "CameraInfo",
    "NavSatFix",
    "MagneticField",
    "Range",
    "DisparityImage",
    "VelodyneScan",
    "PandarScan",
    "NebulaPackets",
    "VelodynePacket",
    "PandarPacket",
    "NebulaPacket",
    "UdpPacket",
    "PacketMsg",
    "RadarScan",
    "CustomMsg",
    // Foxglove's.
    "RawImage",
    "CompressedVideo",
    "CompressedPointCloud",
    "CameraCalibration",
];

const SPATIAL_TYPES: &[&str] = &[
    "Odometry",
    "Path",
    "OccupancyGrid",
    "GridCells",
    "PoseStamped",
    "PoseWithCovarianceStamped",
    "PoseArray",
    "PointStamped",
    "PolygonStamped",
    "Vector3Stamped",
    "QuaternionStamped",
    "Marker",
    "RadarTracks",
    "Detection2DArray",
    "Detection3DArray",
    "Detection3D",
    // Foxglove's. A fix is useful without a frame, and often has none.
    "LocationFix",
    "LocationFixes",
    "PoseInFrame",
    "PosesInFrame",
    "Point3InFrame",
    "Grid",
    "VoxelGrid",
    "SceneUpdate",
];

const IGNORED_PACKAGES: &[&str] = &[
    "diagnostic_msgs",
    "rosgraph_msgs",
    "rcl_interfaces",
    "actionlib_msgs",
    "action_msgs",
    "control_msgs",
    "trajectory_msgs",
    "ackermann_msgs",
    "mavros_msgs",
    "nmea_msgs",
    "std_msgs",
    "can_msgs",
    "bond",
    "gps_common",
    "theora_image_transport",
];

const IGNORED_TYPES: &[&str] = &[
    "JointState",
    "MultiDOFJointState",
    "Joy",
    "TimeReference",
    "BatteryState",
    "Temperature",
    "FluidPressure",
    "RelativeHumidity",
    "Illuminance",
    "TwistStamped",
    "TwistWithCovarianceStamped",
    "AccelStamped",
    "AccelWithCovarianceStamped",
    "WrenchStamped",
    "TFMessage",
    "tfMessage",
];

/// What the header frame of a message type (`sensor_msgs/msg/Imu`, `sensor_msgs/Imu`, `foxglove.LaserScan`) is for.
pub(crate) fn header_use(message_type: &str) -> HeaderUse {
    let package = message_type.split(['/', '.']).next().unwrap_or_default();
    let name = message_type.rsplit(['/', '.']).next().unwrap_or_default();
    if IGNORED_PACKAGES.contains(&package) || IGNORED_TYPES.contains(&name) {
        HeaderUse::Ignored
    } else if SENSOR_TYPES.contains(&name) {
        HeaderUse::Sensor
    } else if SPATIAL_TYPES.contains(&name) {
        HeaderUse::Spatial
    } else {
        HeaderUse::Possible
    }
}

/// Whether the static topics were read completely.
pub(crate) fn latched_is_read(bag: &BagEvidence) -> bool {
    let mut latched = bag.topics.values().filter(|topic| is_static_topic(&topic.topic));
    bag.share.whole || latched.all(|topic| topic.total.is_some_and(|total| total <= topic.count))
}

/// The frames of a recording's own TF, canonical.
pub(crate) fn frames(bag: &BagEvidence) -> BTreeSet<FrameId> {
    bag.tf
        .iter()
        .flat_map(|edge| [edge.parent.canonical(), edge.child.canonical()])
        .collect()
}

/// A frame, and the frames above it in a recording's TF, by its edges of [`by_child`].
pub(crate) fn upward<'t>(
    children: &'t BTreeMap<FrameId, Vec<&TfEdge>>,
    frame: &FrameId,
) -> impl Iterator<Item = FrameId> + 't {
    let above = |at: &FrameId| Some(children.get(at)?.first()?.parent.canonical());
    // A loop ends the walk as well: no tree is deeper than it has frames.
    std::iter::successors(Some(frame.clone()), above).take(children.len() + 1)
}

/// The edges of a recording by child, canonical, in the order of the evidence.
pub(crate) fn by_child(bag: &BagEvidence) -> BTreeMap<FrameId, Vec<&TfEdge>> {
    let mut children: BTreeMap<FrameId, Vec<&TfEdge>> = BTreeMap::new();
    for edge in &bag.tf {
        children.entry(edge.child.canonical()).or_default().push(edge);
    }
    children
}

/// The frames of a recording's sensors: canonical frame, topic, first message. Without empty names, world-like names and topics
/// that cannot be read.
pub(crate) fn sensor_frames(bag: &BagEvidence) -> impl Iterator<Item = (FrameId, &TopicEvidence, &MessageRef)> {
    bag.topics
        .values()
        .filter(|topic| header_use(&topic.message_type) == HeaderUse::Sensor)
        .flat_map(|topic| {
            topic
                .header_frames
                .iter()
                .map(move |(frame, used)| (frame.canonical(), topic, &used.first))
        })
        .filter(|(frame, _, _)| !frame.as_str().is_empty() && !names::is_world(frame))
}

/// Sensor frames of a recording that has TF but no latched transforms, and whose TF contains none of them: the sign of a
/// recording without `/tf_static`. Empty otherwise.
pub(crate) fn without_static(bag: &BagEvidence) -> BTreeMap<FrameId, &MessageRef> {
    if bag.tf.is_empty() || bag.tf.iter().any(|edge| edge.is_static) {
        return BTreeMap::new();
    }
    let known = frames(bag);
    let mut unknown = BTreeMap::new();
    let mounted = sensor_frames(bag).filter(|(frame, _, _)| names::standard(frame).is_none());
    for (frame, _, first) in mounted {
        if known.contains(&frame) {
            return BTreeMap::new();
        }
        unknown.entry(frame).or_insert(first);
    }
    unknown
}

/// One use of a frame in a bag.
pub(crate) struct BagFrameUse<'a> {
    /// The topic.
    pub(crate) topic: &'a TopicEvidence,
    /// What its header frame is for.
    pub(crate) kind: HeaderUse,
    /// The first message with this frame.
    pub(crate) first: &'a MessageRef,
    /// Messages with this frame.
    pub(crate) count: u64,
}

/// Header and odometry child frames by name, canonical; those that nobody looks up are left out.
pub(crate) fn header_frames(bag: &BagEvidence) -> BTreeMap<FrameId, Vec<BagFrameUse<'_>>> {
    let mut uses: BTreeMap<FrameId, Vec<BagFrameUse>> = BTreeMap::new();
    for topic in bag.topics.values() {
        let kind = header_use(&topic.message_type);
        if kind == HeaderUse::Ignored {
            continue;
        }
        // Only sensors and odometry need a frame: an empty one is normal elsewhere, and for a child.
        let needs_one = kind == HeaderUse::Sensor || topic.type_name() == "Odometry";
        let is_named = |frame: &FrameId| !frame.canonical().as_str().is_empty();
        let headers = topic
            .header_frames
            .iter()
            .filter(|(frame, _)| needs_one || is_named(frame));
        let children = topic.child_frames.iter().filter(|(frame, _)| is_named(frame));
        for (frame, HeaderFrame { count, first }) in headers.chain(children) {
            uses.entry(frame.canonical()).or_default().push(BagFrameUse {
                topic,
                kind,
                first,
                count: *count,
            });
        }
    }
    uses
}

/// Fixed joints of robots with a link in a recording's TF, whose child is in none of its transforms, or has no parent there although TF has
/// the joint's parent; with the child's name. A robot that is described twice is listed twice.
pub(crate) fn unpublished_joints<'a>(world: &'a World, bag: &BagEvidence) -> Vec<(FrameId, &'a Joint)> {
    let (known, mounted) = (frames(bag), by_child(bag));
    let canonical = |name: &str| FrameId::new(name).canonical();
    let mut missing = Vec::new();
    for robot in world.robots.iter().filter(|robot| robot.fragment.is_none()) {
        if robot
            .links
            .iter()
            .any(|link| known.contains(&canonical(&link.name.value)))
        {
            let fixed = robot.joints.iter().filter(|joint| joint.is_fixed());
            let children = fixed.filter_map(|joint| Some((canonical(&joint.child.as_ref()?.value), joint)));
            let has_parent = |joint: &Joint| {
                let parent = joint.parent.as_ref().map(|parent| canonical(&parent.value));
                parent.is_some_and(|parent| known.contains(&parent))
            };
            missing.extend(children.filter(|(child, joint)| {
                let is_open = !known.contains(child) || (!mounted.contains_key(child) && has_parent(joint));
                !child.as_str().is_empty() && is_open
            }));
        }
    }
    missing
}

/// Whether a publisher of the topic offered durability volatile.
pub(crate) fn is_volatile(topic: &TopicEvidence) -> bool {
    topic.offered_qos_profiles.as_deref().is_some_and(qos::is_volatile)
}

/// The standard `odom` frames that a recording's TF moves something in, by name.
pub(crate) fn moving_odoms(bag: &BagEvidence) -> BTreeSet<FrameId> {
    let moving = bag.tf.iter().filter(|edge| !edge.is_static);
    let parents = moving.map(|edge| edge.parent.canonical());
    parents.filter(|frame| is_standard(frame, Standard::Odom)).collect()
}

/// Whether the last part of a name is the one of this frame of REP-105.
pub(crate) fn is_standard(frame: &FrameId, kind: Standard) -> bool {
    names::standard(frame).is_some_and(|(_, of)| of == kind)
}

/// The `map` frames that messages name, while TF moves something in `odom` and does not connect a `map` to it; with their uses.
pub(crate) fn without_correction<'a>(bag: &'a BagEvidence, odom: &FrameId) -> BTreeMap<FrameId, Vec<BagFrameUse<'a>>> {
    let space = |frame: &FrameId| names::standard(frame).map_or("", |(space, _)| space).to_owned();
    let known = frames(bag);
    let corrects =
        |edge: &TfEdge| edge.child.canonical() == *odom && is_standard(&edge.parent.canonical(), Standard::Map);
    if bag.tf.iter().any(corrects) {
        return BTreeMap::new();
    }
    let mut named = header_frames(bag);
    named.retain(|frame, _| {
        let is_near = space(frame).is_empty() || space(frame) == space(odom);
        is_near && is_standard(frame, Standard::Map) && !known.contains(frame)
    });
    named
}

/// A list of names for a message: the first few in backticks, then how many more.
pub(crate) fn listed<'a>(names: impl IntoIterator<Item = &'a FrameId>) -> String {
    const SHOWN: usize = 6;
    let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    let shown = names.iter().take(SHOWN).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn message_types_of_both_generations_are_distinguished() {
        assert_eq!(header_use("sensor_msgs/msg/Imu"), HeaderUse::Sensor);
        assert_eq!(header_use("sensor_msgs/PointCloud2"), HeaderUse::Sensor);
        assert_eq!(header_use("nav_msgs/msg/Odometry"), HeaderUse::Spatial);
        assert_eq!(header_use("sensor_msgs/msg/JointState"), HeaderUse::Ignored);
        assert_eq!(header_use("diagnostic_msgs/msg/DiagnosticArray"), HeaderUse::Ignored);
        assert_eq!(header_use("my_msgs/msg/Tracks"), HeaderUse::Possible);
        assert_eq!(header_use("foxglove.PointCloud"), HeaderUse::Sensor);
        assert_eq!(header_use("foxglove_msgs/msg/RawImage"), HeaderUse::Sensor);
        assert_eq!(header_use("foxglove.PoseInFrame"), HeaderUse::Spatial);
        assert_eq!(header_use("acme.Tracks"), HeaderUse::Possible);
    }
}
