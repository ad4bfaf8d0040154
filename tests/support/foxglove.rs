//! Messages of Foxglove's protobuf schemas, encoded by `prost`, and the descriptors that they are read by.
//!
//! Used by the tests of the reader too: knows nothing of this crate.

// Fields that are messages are optional to `prost`.
#![allow(clippy::unnecessary_wraps)]

use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet, Timestamp};

/// `(name, number, type)`; a type with a dot is a message, one that ends in `[]` is repeated.
pub(crate) type Fields = [(&'static str, i32, &'static str)];

/// A type with these fields.
pub(crate) fn declared(name: &str, fields: &Fields) -> DescriptorProto {
    let field = |(name, number, kind): &(&str, i32, &str)| {
        let plain = kind.trim_end_matches("[]");
        let known = match plain {
            "double" => Type::Double,
            "float" => Type::Float,
            "int64" => Type::Int64,
            "int32" => Type::Int32,
            "sint64" => Type::Sint64,
            "fixed32" => Type::Fixed32,
            "sfixed64" => Type::Sfixed64,
            "string" => Type::String,
            "bytes" => Type::Bytes,
            _ => Type::Message,
        };
        let label = if plain == *kind {
            Label::Optional
        } else {
            Label::Repeated
        };
        FieldDescriptorProto {
            name: Some((*name).to_owned()),
            number: Some(*number),
            r#type: Some(known.into()),
            label: Some(label.into()),
            type_name: (known == Type::Message).then(|| plain.to_owned()),
            ..FieldDescriptorProto::default()
        }
    };
    DescriptorProto {
        name: Some(name.to_owned()),
        field: fields.iter().map(field).collect(),
        ..DescriptorProto::default()
    }
}

/// A file of these types.
pub(crate) fn file(package: &str, types: Vec<DescriptorProto>) -> FileDescriptorProto {
    FileDescriptorProto {
        package: Some(package.to_owned()),
        message_type: types,
        ..FileDescriptorProto::default()
    }
}

/// Foxglove's types that are read, with the numbers of the published `.proto` files, and one more file.
pub(crate) fn descriptor(more: FileDescriptorProto) -> Vec<u8> {
    let header = [
        ("timestamp", 1, ".google.protobuf.Timestamp"),
        ("frame_id", 2, "string"),
    ];
    let with = |fields: &Fields| [&header[..], fields].concat();
    let google = vec![declared("Timestamp", &[("seconds", 1, "int64"), ("nanos", 2, "int32")])];
    let xyz = [("x", 1, "double"), ("y", 2, "double"), ("z", 3, "double")];
    let foxglove = vec![
        declared("Vector3", &xyz),
        declared("Quaternion", &[&xyz[..], &[("w", 4, "double")]].concat()),
        declared(
            "Pose",
            &[
                ("position", 1, ".foxglove.Vector3"),
                ("orientation", 2, ".foxglove.Quaternion"),
            ],
        ),
        declared(
            "FrameTransform",
            &[
                ("timestamp", 1, ".google.protobuf.Timestamp"),
                ("parent_frame_id", 2, "string"),
                ("child_frame_id", 3, "string"),
                ("translation", 4, ".foxglove.Vector3"),
                ("rotation", 5, ".foxglove.Quaternion"),
            ],
        ),
        declared("FrameTransforms", &[("transforms", 1, ".foxglove.FrameTransform[]")]),
        declared(
            "LocationFix",
            &[
                ("timestamp", 6, ".google.protobuf.Timestamp"),
                ("frame_id", 7, "string"),
                ("latitude", 1, "double"),
                ("longitude", 2, "double"),
                ("altitude", 3, "double"),
                ("position_covariance", 4, "double[]"),
            ],
        ),
        declared("LocationFixes", &[("fixes", 1, ".foxglove.LocationFix[]")]),
        declared("PoseInFrame", &with(&[("pose", 3, ".foxglove.Pose")])),
        declared(
            "Odometry",
            &with(&[
                ("body_frame_id", 3, "string"),
                ("pose", 4, ".foxglove.Pose"),
                ("linear_velocity", 5, ".foxglove.Vector3"),
                ("angular_velocity", 6, ".foxglove.Vector3"),
                ("pose_covariance", 7, "double[]"),
                ("velocity_covariance", 8, "double[]"),
            ]),
        ),
        declared("PointCloud", &with(&[("data", 6, "bytes")])),
        declared("SceneEntity", &header),
        declared("SceneUpdate", &[("entities", 2, ".foxglove.SceneEntity[]")]),
        declared(
            "Log",
            &[("timestamp", 1, ".google.protobuf.Timestamp"), ("message", 3, "string")],
        ),
    ];
    let files = vec![file("google.protobuf", google), file("foxglove", foxglove), more];
    FileDescriptorSet { file: files }.encode_to_vec()
}

/// A vector, or a quaternion.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct Numbers {
    #[prost(double, tag = "1")]
    pub(crate) x: f64,
    #[prost(double, tag = "2")]
    pub(crate) y: f64,
    #[prost(double, tag = "3")]
    pub(crate) z: f64,
    #[prost(double, tag = "4")]
    pub(crate) w: f64,
}

/// Numbers as a field.
pub(crate) fn numbers(x: f64, y: f64, z: f64, w: f64) -> Option<Numbers> {
    Some(Numbers { x, y, z, w })
}

/// `foxglove.FrameTransform`.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct FrameTransform {
    #[prost(message, tag = "1")]
    pub(crate) timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub(crate) parent: String,
    #[prost(string, tag = "3")]
    pub(crate) child: String,
    #[prost(message, tag = "4")]
    pub(crate) translation: Option<Numbers>,
    #[prost(message, tag = "5")]
    pub(crate) rotation: Option<Numbers>,
}

/// `foxglove.FrameTransforms`.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct FrameTransforms {
    #[prost(message, repeated, tag = "1")]
    pub(crate) transforms: Vec<FrameTransform>,
}

/// Anything that begins with a time and a frame; `data` stands for all that is not wanted.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct Stamped {
    #[prost(message, tag = "1")]
    pub(crate) timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub(crate) frame_id: String,
    #[prost(bytes = "vec", tag = "6")]
    pub(crate) data: Vec<u8>,
}

/// A time as a field.
pub(crate) fn at(seconds: i64, nanos: i32) -> Option<Timestamp> {
    Some(Timestamp { seconds, nanos })
}
