//! Any bytes as a protobuf message of each supported type, as JSON, and as a descriptor: no panic, bounded work.
use std::sync::LazyLock;

use frames_lint::read::messages::MAX_NAME;
use frames_lint::read::messages::content::{Body, Content};
use frames_lint::read::messages::format::Format;
use frames_lint::read::messages::foxglove::Reader;

const TYPES: [&str; 10] = [
    "foxglove.FrameTransform",
    "foxglove.FrameTransforms",
    "foxglove.LocationFix",
    "foxglove.LocationFixes",
    "foxglove.PoseInFrame",
    "foxglove.Odometry",
    "foxglove.SceneUpdate",
    "foxglove.PointCloud",
    "foxglove.LaserScan",
    "acme.Thing",
];

/// A message: its number, then its bytes with their length.
fn nested(number: u8, bytes: &[u8]) -> Vec<u8> {
    let mut out = vec![number << 3 | 2];
    let mut length = bytes.len();
    while length > 0x7f {
        out.push(0x80 | (length & 0x7f) as u8);
        length >>= 7;
    }
    out.push(length as u8);
    out.extend(bytes);
    out
}

/// `(name, number, google.protobuf.FieldDescriptorProto.Type, name of the type of a message, repeated)`.
type Field = (&'static str, u8, u8, &'static str, bool);

fn declared(name: &str, fields: &[Field]) -> Vec<u8> {
    let mut out = nested(1, name.as_bytes());
    for (name, number, kind, of, repeated) in fields {
        let label = if *repeated { 3 } else { 1 };
        let plain = [3 << 3, *number, 4 << 3, label, 5 << 3, *kind];
        out.extend(nested(
            2,
            &[nested(1, name.as_bytes()), plain.to_vec(), nested(6, of.as_bytes())].concat(),
        ));
    }
    nested(4, &out)
}

const fn double(name: &'static str, number: u8) -> Field {
    (name, number, 1, "", false)
}

const fn text(name: &'static str, number: u8) -> Field {
    (name, number, 9, "", false)
}

const fn message(name: &'static str, number: u8, of: &'static str) -> Field {
    (name, number, 11, of, false)
}

const fn many(name: &'static str, number: u8, of: &'static str) -> Field {
    (name, number, if of.is_empty() { 1 } else { 11 }, of, true)
}

static READERS: LazyLock<Vec<Reader>> = LazyLock::new(|| {
    let time = message("timestamp", 1, ".foxglove.Time");
    let (frame, pose) = (text("frame_id", 2), message("pose", 4, ".foxglove.Pose"));
    let xyzw = [double("x", 1), double("y", 2), double("z", 3), double("w", 4)];
    let (vector, quaternion) = (".foxglove.Vector3", ".foxglove.Quaternion");
    let covariance = many("position_covariance", 4, "");
    let fix = [
        double("latitude", 3),
        double("longitude", 5),
        double("altitude", 6),
        time,
        frame,
        covariance,
    ];
    let types = [
        nested(2, b"foxglove"),
        declared("Time", &[("seconds", 1, 3, "", false), ("nanos", 2, 17, "", false)]),
        declared("Vector3", &xyzw[..3]),
        declared("Quaternion", &xyzw),
        declared(
            "Pose",
            &[message("position", 1, vector), message("orientation", 2, quaternion)],
        ),
        declared(
            "FrameTransform",
            &[
                time,
                text("parent_frame_id", 2),
                text("child_frame_id", 3),
                message("translation", 4, vector),
                message("rotation", 5, quaternion),
            ],
        ),
        declared("FrameTransforms", &[many("transforms", 1, ".foxglove.FrameTransform")]),
        declared("LocationFix", &fix),
        declared("LocationFixes", &[many("fixes", 1, ".foxglove.LocationFix")]),
        declared("PoseInFrame", &[time, frame, pose]),
        declared(
            "Odometry",
            &[
                time,
                frame,
                text("body_frame_id", 3),
                pose,
                message("linear_velocity", 5, vector),
                message("angular_velocity", 6, vector),
                many("pose_covariance", 7, ""),
                many("velocity_covariance", 8, ""),
            ],
        ),
        declared("SceneUpdate", &[many("entities", 2, ".foxglove.PointCloud")]),
        declared("PointCloud", &[time, frame]),
        declared(
            "LaserScan",
            &[
                time,
                frame,
                message("pose", 3, ".foxglove.Pose"),
                double("start_angle", 4),
                double("end_angle", 5),
                many("ranges", 6, ""),
            ],
        ),
    ]
    .concat();
    let other = [
        nested(2, b"acme"),
        declared("Thing", &[message("header", 1, ".foxglove.PointCloud")]),
    ]
    .concat();
    let descriptor = [nested(1, &types), nested(1, &other)].concat();
    let reader = |message_type| reader("protobuf", message_type, &descriptor).expect("the descriptor is sound");
    TYPES.into_iter().map(reader).collect()
});

fn reader(encoding: &str, message_type: &str, schema: &[u8]) -> Result<Reader, String> {
    Reader::of(&Format {
        topic: "/topic",
        message_type,
        message_encoding: encoding,
        schema,
        schema_encoding: encoding,
    })
    .expect("an encoding of ours")
}

fn held(content: &Content<'_>) {
    let mut names: Vec<&str> = Vec::new();
    names.extend(content.header.as_ref().map(|header| header.frame_id.as_ref()));
    match &content.body {
        Body::Transforms(all) => names.extend(all.iter().flat_map(|one| [one.parent.as_ref(), one.child.as_ref()])),
        Body::Frames(all) => names.extend(all.iter().map(AsRef::as_ref)),
        Body::Odometry(odometry) => names.push(&odometry.child),
        _ => {}
    }
    assert!(names.iter().all(|name| name.len() <= MAX_NAME));
}

/// Runs the target.
pub fn run(bytes: &[u8]) {
    for reader in READERS.iter() {
        if let Ok(content) = reader.decode(bytes) {
            held(&content);
        }
    }
    for message_type in TYPES {
        let json = reader("json", message_type, &[]).expect("JSON needs no definition");
        if let Ok(content) = json.decode(bytes) {
            held(&content);
        }
    }
    // The same bytes as a descriptor, and as a message of what it describes.
    if let Ok(reader) = reader("protobuf", "foxglove.FrameTransforms", bytes) {
        let _ = reader.decode(bytes);
    }
}
