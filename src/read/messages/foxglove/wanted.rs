//! Which fields of which types are wanted.
//!
//! A type that is not known may still carry `timestamp` and `frame_id`, or a `header` in the way of ROS: these are wanted of
//! every message.

/// The names wanted in a message, each with what is wanted inside it. Finite, which bounds how deep a message is read.
#[derive(Debug)]
pub(super) struct FieldSelection(pub(super) &'static [(&'static str, &'static FieldSelection)]);

impl FieldSelection {
    /// What is wanted of a field, with its name in this program.
    pub(super) fn field(&self, name: &str) -> Option<(&'static str, &'static FieldSelection)> {
        self.0.iter().find(|(known, _)| *known == name).copied()
    }

    /// Whether nothing is wanted inside: a number, a text, or a list of these.
    pub(super) fn is_plain(&self) -> bool {
        self.0.is_empty()
    }
}

static PLAIN: FieldSelection = FieldSelection(&[]);
/// Protocol Buffers, Foxglove's JSON, ROS 1, ROS 2.
static TIME: FieldSelection = FieldSelection(&[
    ("seconds", &PLAIN),
    ("nanos", &PLAIN),
    ("sec", &PLAIN),
    ("nsec", &PLAIN),
    ("secs", &PLAIN),
    ("nsecs", &PLAIN),
    ("nanosec", &PLAIN),
]);
static ROS_HEADER: FieldSelection = FieldSelection(&[("stamp", &TIME), ("timestamp", &TIME), ("frame_id", &PLAIN)]);
static VECTOR: FieldSelection = FieldSelection(&[("x", &PLAIN), ("y", &PLAIN), ("z", &PLAIN)]);
static QUATERNION: FieldSelection = FieldSelection(&[("x", &PLAIN), ("y", &PLAIN), ("z", &PLAIN), ("w", &PLAIN)]);
static POSE: FieldSelection = FieldSelection(&[("position", &VECTOR), ("orientation", &QUATERNION)]);
static ROS_TRANSFORM: FieldSelection = FieldSelection(&[("translation", &VECTOR), ("rotation", &QUATERNION)]);

static HEADER: FieldSelection = FieldSelection(&[("timestamp", &TIME), ("frame_id", &PLAIN), ("header", &ROS_HEADER)]);
static TRANSFORM: FieldSelection = FieldSelection(&[
    ("timestamp", &TIME),
    ("parent_frame_id", &PLAIN),
    ("child_frame_id", &PLAIN),
    ("translation", &VECTOR),
    ("rotation", &QUATERNION),
    // As ROS nests the same.
    ("header", &ROS_HEADER),
    ("transform", &ROS_TRANSFORM),
]);
static TRANSFORMS: FieldSelection = FieldSelection(&[("transforms", &TRANSFORM)]);
static FIX: FieldSelection = FieldSelection(&[
    ("timestamp", &TIME),
    ("frame_id", &PLAIN),
    ("latitude", &PLAIN),
    ("longitude", &PLAIN),
    ("altitude", &PLAIN),
    ("position_covariance", &PLAIN),
]);
static FIXES: FieldSelection = FieldSelection(&[("fixes", &FIX)]);
static POSE_IN_FRAME: FieldSelection = FieldSelection(&[("timestamp", &TIME), ("frame_id", &PLAIN), ("pose", &POSE)]);
static ODOMETRY: FieldSelection = FieldSelection(&[
    ("timestamp", &TIME),
    ("frame_id", &PLAIN),
    ("body_frame_id", &PLAIN),
    ("pose", &POSE),
    ("linear_velocity", &VECTOR),
    ("angular_velocity", &VECTOR),
    ("pose_covariance", &PLAIN),
    ("velocity_covariance", &PLAIN),
]);
static LASER_SCAN: FieldSelection = FieldSelection(&[
    ("timestamp", &TIME),
    ("frame_id", &PLAIN),
    ("pose", &POSE),
    ("start_angle", &PLAIN),
    ("end_angle", &PLAIN),
    (RANGES, &PLAIN),
]);
static ENTITY: FieldSelection = FieldSelection(&[("timestamp", &TIME), ("frame_id", &PLAIN)]);
static SCENE: FieldSelection = FieldSelection(&[("entities", &ENTITY)]);

/// The only list of numbers of any length.
pub(super) const RANGES: &str = "ranges";

/// What a type contains about frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `FrameTransform`, `geometry_msgs/TransformStamped`.
    Transform,
    /// `FrameTransforms`, `tf2_msgs/TFMessage`.
    Transforms,
    /// `LocationFix`.
    Fix,
    /// `LocationFixes`.
    Fixes,
    /// `Pose`, which has no frame.
    Pose,
    /// `PoseInFrame`.
    PoseInFrame,
    /// `Odometry`.
    Odometry,
    /// `SceneUpdate`.
    Scene,
    /// `LaserScan`.
    LaserScan,
    /// Another type of Foxglove's: a header, if it has one, spelled as in the schemas.
    Header,
    /// A type of another vendor: a header, if it has fields like one.
    Unknown,
}

impl Kind {
    /// By the name of the type: `foxglove.Grid`, `foxglove_msgs/msg/Grid`.
    pub(super) fn of(message_type: &str) -> Self {
        let within = |package| message_type.split(['.', '/']).any(|part| part == package);
        let name = message_type.rsplit(['.', '/']).next().unwrap_or_default();
        if !message_type.starts_with("foxglove.") && !message_type.starts_with("foxglove_msgs/") {
            // ROS messages in another encoding keep their names after a prefix.
            return match name {
                "TransformStamped" if within("geometry_msgs") => Self::Transform,
                "TFMessage" if within("tf2_msgs") || within("tf") => Self::Transforms,
                _ => Self::Unknown,
            };
        }
        match name {
            "FrameTransform" => Self::Transform,
            "FrameTransforms" => Self::Transforms,
            "LocationFix" => Self::Fix,
            "LocationFixes" => Self::Fixes,
            "Pose" => Self::Pose,
            "PoseInFrame" => Self::PoseInFrame,
            "Odometry" => Self::Odometry,
            "SceneUpdate" => Self::Scene,
            "LaserScan" => Self::LaserScan,
            _ => Self::Header,
        }
    }

    /// The fields that are wanted of it.
    pub(super) fn wanted(self) -> &'static FieldSelection {
        match self {
            Self::Transform => &TRANSFORM,
            Self::Transforms => &TRANSFORMS,
            Self::Fix => &FIX,
            Self::Fixes => &FIXES,
            Self::Pose => &POSE,
            Self::PoseInFrame => &POSE_IN_FRAME,
            Self::Odometry => &ODOMETRY,
            Self::Scene => &SCENE,
            Self::LaserScan => &LASER_SCAN,
            Self::Header | Self::Unknown => &HEADER,
        }
    }
}
