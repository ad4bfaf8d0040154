//! Protobuf messages, encoded by `prost`.

use prost::Message;
use prost_types::{DescriptorProto, FileDescriptorProto, Timestamp};

use super::*;
use crate::read::messages::content::{Body, Fix};
use crate::read::messages::header::Header;
use crate::read::messages::tf::Transform;

fn header(stamp_ns: i64, frame_id: &str) -> Header<'_> {
    let frame_id = frame_id.into();
    Header { stamp_ns, frame_id }
}

fn mounted() -> Transform<'static> {
    Transform {
        stamp_ns: 1_700_000_000_000_000_250,
        parent: "base_link".into(),
        child: "lidar".into(),
        translation: [0.3, 0.0, 1.2],
        rotation: [0.0, 0.0, 0.6, 0.8],
    }
}

#[test]
fn transforms_are_read_with_every_number() {
    let one = mount().encode_to_vec();
    let content = reader("foxglove.FrameTransform");
    let content = content.decode(&one).unwrap();
    assert_eq!(
        (content.header, content.body),
        (None, Body::Transforms(vec![mounted()]))
    );

    let other = FrameTransform {
        child: "imu".to_owned(),
        ..mount()
    };
    let transforms = vec![mount(), other];
    let several = FrameTransforms { transforms }.encode_to_vec();
    let content = reader("foxglove.FrameTransforms");
    let Body::Transforms(read) = content.decode(&several).unwrap().body else {
        panic!("transforms");
    };
    assert_eq!(read[0], mounted());
    let imu = Transform {
        child: "imu".into(),
        ..mounted()
    };
    assert_eq!(read[1..], [imu]);
}

#[test]
fn what_a_message_leaves_out_has_its_default() {
    // The format has no word for "not set": this is what every decoder gives.
    let bare = FrameTransform {
        parent: "a".to_owned(),
        ..FrameTransform::default()
    };
    let bytes = bare.encode_to_vec();
    let reader = reader("foxglove.FrameTransform");
    let expected = Transform {
        stamp_ns: 0,
        parent: "a".into(),
        child: "".into(),
        translation: [0.0; 3],
        rotation: [0.0; 4],
    };
    assert_eq!(reader.decode(&bytes).unwrap().body, Body::Transforms(vec![expected]));
}

#[test]
fn a_cloud_has_a_header_and_a_log_has_none() {
    let cloud = Stamped {
        timestamp: at(5, 7),
        frame_id: "lidar".to_owned(),
        data: vec![0xff; 100_000],
    };
    let bytes = cloud.encode_to_vec();
    let content = reader("foxglove.PointCloud");
    let content = content.decode(&bytes).unwrap();
    assert_eq!(
        (content.header, content.body),
        (Some(header(5_000_000_007, "lidar")), Body::Nothing)
    );
    assert_eq!(reader("foxglove.Log").decode(&bytes).unwrap().header, None);
}

#[derive(Clone, PartialEq, Message)]
struct LocationFix {
    #[prost(double, tag = "1")]
    latitude: f64,
    #[prost(double, tag = "2")]
    longitude: f64,
    #[prost(double, tag = "3")]
    altitude: f64,
    #[prost(double, repeated, packed = "true", tag = "4")]
    packed: Vec<f64>,
    #[prost(message, tag = "6")]
    timestamp: Option<Timestamp>,
    #[prost(string, tag = "7")]
    frame_id: String,
}

#[derive(Clone, PartialEq, Message)]
struct UnpackedArray {
    #[prost(double, repeated, packed = "false", tag = "4")]
    one_by_one: Vec<f64>,
}

#[test]
fn fixes_are_read_with_covariances_packed_or_not() {
    let covariance = [1.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 4.0];
    let fix = LocationFix {
        latitude: 48.1,
        longitude: 11.5,
        altitude: 520.0,
        packed: covariance.to_vec(),
        timestamp: at(5, 0),
        frame_id: "gps".to_owned(),
    };
    let expected = Fix {
        status: 0,
        latitude: 48.1,
        longitude: 11.5,
        altitude: 520.0,
        covariance,
        velocity: None,
    };
    let reader = reader("foxglove.LocationFix");
    let bytes = fix.encode_to_vec();
    let content = reader.decode(&bytes).unwrap();
    assert_eq!(content.header, Some(header(5_000_000_000, "gps")));
    assert_eq!(content.body, Body::Fix(expected.clone()));

    let mut bytes = LocationFix {
        packed: Vec::new(),
        ..fix.clone()
    }
    .encode_to_vec();
    let Body::Fix(unknown) = reader.decode(&bytes).unwrap().body else {
        panic!("a fix");
    };
    assert_eq!(unknown.covariance, [0.0; 9]);
    let one_by_one = covariance.to_vec();
    UnpackedArray { one_by_one }.encode(&mut bytes).unwrap();
    assert_eq!(reader.decode(&bytes).unwrap().body, Body::Fix(expected));

    for count in [8, 10, 1000] {
        let packed = vec![1.0; count];
        let bytes = LocationFix { packed, ..fix.clone() }.encode_to_vec();
        let error = reader.decode(&bytes).unwrap_err();
        assert_eq!(error.0, "`position_covariance` does not have 9 numbers");
    }
}

#[derive(Clone, PartialEq, Message)]
struct Pose {
    #[prost(message, tag = "1")]
    position: Option<Numbers>,
    #[prost(message, tag = "2")]
    orientation: Option<Numbers>,
}

#[derive(Clone, PartialEq, Message)]
struct Odometry {
    #[prost(message, tag = "1")]
    timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    frame_id: String,
    #[prost(string, tag = "3")]
    body_frame_id: String,
    #[prost(message, tag = "4")]
    pose: Option<Pose>,
    #[prost(message, tag = "5")]
    linear: Option<Numbers>,
    #[prost(message, tag = "6")]
    angular: Option<Numbers>,
}

#[test]
fn odometry_is_read_as_that_of_ros() {
    let message = Odometry {
        timestamp: at(5, 0),
        frame_id: "odom".to_owned(),
        body_frame_id: "base_link".to_owned(),
        pose: Some(Pose {
            position: numbers(1.0, 2.0, 3.0, 0.0),
            orientation: numbers(0.0, 0.0, 0.6, 0.8),
        }),
        linear: numbers(4.0, 5.0, 6.0, 0.0),
        angular: numbers(7.0, 8.0, 9.0, 0.0),
    };
    let bytes = message.encode_to_vec();
    let reader = reader("foxglove.Odometry");
    let content = reader.decode(&bytes).unwrap();
    assert_eq!(content.header, Some(header(5_000_000_000, "odom")));
    let Body::Odometry(odometry) = content.body else {
        panic!("odometry");
    };
    assert_eq!(odometry.child, "base_link");
    assert_eq!(odometry.position, [1.0, 2.0, 3.0]);
    assert_eq!(odometry.orientation, [0.0, 0.0, 0.6, 0.8]);
    assert_eq!((odometry.linear, odometry.angular), ([4.0, 5.0, 6.0], [7.0, 8.0, 9.0]));
    assert_eq!(odometry.pose_covariance, [0.0; 36]);
}

#[derive(Clone, PartialEq, Message)]
struct SceneUpdate {
    #[prost(message, repeated, tag = "2")]
    entities: Vec<Stamped>,
}

#[test]
fn a_scene_tells_the_frames_of_all_its_entities() {
    let entity = |seconds, frame: &str| Stamped {
        timestamp: at(seconds, 0),
        frame_id: frame.to_owned(),
        data: Vec::new(),
    };
    let entities = vec![
        entity(5, "map"),
        entity(6, "odom"),
        entity(7, "map"),
        entity(8, "base_link"),
        entity(9, "odom"),
    ];
    let bytes = SceneUpdate { entities }.encode_to_vec();
    let reader = reader("foxglove.SceneUpdate");
    let content = reader.decode(&bytes).unwrap();
    assert_eq!(content.header, Some(header(5_000_000_000, "map")));
    assert_eq!(content.body, Body::Frames(vec!["base_link".into(), "odom".into()]));
    let none = reader.decode(&[]).unwrap();
    assert_eq!((none.header, none.body), (None, Body::Nothing));
}

#[derive(Clone, PartialEq, Message)]
struct Clock {
    #[prost(sint64, tag = "9")]
    sec: i64,
    #[prost(fixed32, tag = "8")]
    nsec: u32,
}

#[derive(Clone, PartialEq, Message)]
struct Head {
    #[prost(string, tag = "200")]
    frame_id: String,
    #[prost(message, tag = "3")]
    stamp: Option<Clock>,
}

#[derive(Clone, PartialEq, Message)]
struct Scan {
    #[prost(bytes = "vec", tag = "1")]
    junk: Vec<u8>,
    #[prost(message, tag = "2")]
    header: Option<Head>,
    #[prost(int32, tag = "7")]
    frame_id: i32,
}

#[test]
fn the_descriptor_decides_not_the_published_numbers() {
    let time = declared("Clock", &[("sec", 9, "sint64"), ("nsec", 8, "fixed32")]);
    let outer = DescriptorProto {
        nested_type: vec![
            time,
            declared(
                "Head",
                &[("frame_id", 200, "string"), ("stamp", 3, ".acme.robot.Scan.Clock")],
            ),
        ],
        ..declared(
            "Scan",
            &[
                ("junk", 1, "bytes"),
                ("header", 2, "acme.robot.Scan.Head"),
                ("frame_id", 7, "int32"),
            ],
        )
    };
    let schema = descriptor(file("acme.robot", vec![outer]));
    let reader = reader_of("acme.robot.Scan", &schema).unwrap();
    let scan = Scan {
        junk: vec![8; 33],
        header: Some(Head {
            frame_id: "laser".to_owned(),
            stamp: Some(Clock { sec: -3, nsec: 4 }),
        }),
        frame_id: 6,
    };
    let bytes = scan.encode_to_vec();
    assert_eq!(
        reader.decode(&bytes).unwrap().header,
        Some(header(4 - 3_000_000_000, "laser"))
    );
}

#[test]
fn a_type_that_only_looks_like_ours_is_not_guessed_at() {
    // A time that is a plain number has an unknown unit; a frame that is a number is no frame.
    for fields in [
        [("timestamp", 1, "int64"), ("frame_id", 2, "string")],
        [("timestamp", 1, ".google.protobuf.Timestamp"), ("frame_id", 2, "int32")],
        [("timestamp", 1, ".google.protobuf.Timestamp"), ("frame", 2, "string")],
        [
            ("timestamp", 1, ".google.protobuf.Timestamp[]"),
            ("frame_id", 2, "string"),
        ],
        [("timestamp", 1, ".google.protobuf.Missing"), ("frame_id", 2, "string")],
    ] {
        let schema = descriptor(file("acme", vec![declared("Thing", &fields)]));
        let reader = reader_of("acme.Thing", &schema).unwrap();
        let bytes = Stamped::default().encode_to_vec();
        let content = reader.decode(&bytes).unwrap();
        assert_eq!((content.header, content.body), (None, Body::Nothing), "{fields:?}");
    }
}

#[test]
fn messages_in_pieces_and_groups_between_are_understood() {
    let stamp = |seconds, nanos| {
        let timestamp = at(seconds, nanos);
        Stamped {
            timestamp,
            ..Stamped::default()
        }
        .encode_to_vec()
    };
    let frame = |name: &str| {
        let frame_id = name.to_owned();
        Stamped {
            frame_id,
            ..Stamped::default()
        }
        .encode_to_vec()
    };
    // Field 9 as a group that holds another one and a string.
    let group = vec![0x4b, 0x53, 0x54, 0x12, 2, 0x4c, 0x4c, 0x4c];
    let bytes = [stamp(5, 0), frame("first"), group, stamp(0, 7), frame("last")].concat();
    let reader = reader("foxglove.PointCloud");
    let content = reader.decode(&bytes).unwrap();
    assert_eq!(content.header, Some(header(5_000_000_007, "last")));
}

#[test]
fn a_type_without_a_package_and_a_leading_dot_are_found() {
    let schema = descriptor(file(
        "",
        vec![declared("FrameTransform", &[("timestamp", 1, "foxglove.Nothing")])],
    ));
    assert!(reader_of("FrameTransform", &schema).is_ok());
    assert!(reader_of("foxglove.FrameTransform", &schema).is_ok());
    assert!(reader_of(".foxglove.FrameTransform", &schema).is_ok());
    for missing in [
        "",
        "foxglove",
        "foxglove.",
        "foxglove.Frame",
        "foxglove.FrameTransform.X",
        "oxglove.Pose",
    ] {
        let why = reader_of(missing, &schema).unwrap_err();
        assert!(why.ends_with("does not contain that type"), "{missing}: {why}");
    }
    assert!(reader_of("x", &descriptor(FileDescriptorProto::default())).is_err());
}
