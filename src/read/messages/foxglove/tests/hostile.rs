//! Bytes that lie: no panic, no recursion, errors with their place.

use proptest::prelude::*;
use prost::Message;
use prost_types::FileDescriptorProto;

use super::*;

const TYPES: [&str; 8] = [
    "foxglove.FrameTransforms",
    "foxglove.FrameTransform",
    "foxglove.LocationFix",
    "foxglove.LocationFixes",
    "foxglove.PoseInFrame",
    "foxglove.Odometry",
    "foxglove.SceneUpdate",
    "foxglove.PointCloud",
];

fn error(message_type: &str, bytes: &[u8]) -> String {
    reader(message_type).decode(bytes).unwrap_err().0
}

#[test]
fn wrong_bytes_are_refused_with_their_place() {
    let cloud = "foxglove.PointCloud";
    assert_eq!(
        error(cloud, &[0x12, 5, b'm', b'a', b'p']),
        "5 bytes at byte 2 run past the end of the message of 5"
    );
    assert_eq!(
        error(cloud, &[0x0a, 2, 0x12, 9, 0x12, 1, b'a']),
        "9 bytes at byte 4 run past the end of their field at byte 4"
    );
    assert_eq!(
        error(cloud, &[0x12, 2, b'm', 0xc3]),
        "`frame_id` at byte 2 is not UTF-8"
    );
    assert_eq!(error(cloud, &[0x0e]), "the wire type 6 at byte 0 is unknown");
    assert_eq!(error(cloud, &[0]), "0 at byte 0 is not the tag of a field");
    assert_eq!(
        error(cloud, &[0x10, 1, 0x4c]),
        "a group ends at byte 2 that never began"
    );
    assert_eq!(
        error(cloud, &[0x10, 1, 0x4b, 0x10, 1]),
        "the group at byte 2 does not end"
    );
    let endless = [&[0x18][..], &[0xff; 12]].concat();
    assert_eq!(error(cloud, &endless), "the varint at byte 1 does not end");
    let long = Stamped {
        frame_id: "x".repeat(300),
        ..Stamped::default()
    };
    assert_eq!(
        error(cloud, &long.encode_to_vec()),
        "the frame name `frame_id` has 300 bytes"
    );
    let far = Stamped {
        timestamp: at(i64::MAX, 0),
        ..Stamped::default()
    };
    assert_eq!(error(cloud, &far.encode_to_vec()), "`timestamp` is out of range");
    let length = [&[0x12][..], &[0xff; 9], &[1]].concat();
    assert!(error(cloud, &length).starts_with("18446744073709551615 bytes at byte 11"));
}

#[test]
fn a_message_cut_anywhere_gives_an_error_or_what_stands_before() {
    let transforms = vec![mount(), mount()];
    let bytes = FrameTransforms { transforms }.encode_to_vec();
    let first = bytes.len() / 2;
    let reader = reader("foxglove.FrameTransforms");
    for end in 0..bytes.len() {
        let read = reader.decode(&bytes[..end]);
        assert_eq!(read.is_ok(), end == 0 || end == first, "cut at {end}");
    }
}

#[test]
fn deep_groups_and_many_elements_are_bounded() {
    let reader_of_clouds = reader("foxglove.PointCloud");
    let deep = vec![0x4b; 1_000_000];
    assert!(reader_of_clouds.decode(&deep).is_err());
    // Twenty thousand empty transforms are read, one more is refused.
    let transforms = reader("foxglove.FrameTransforms");
    let empty = [0x0a, 0].repeat(20_000);
    assert!(transforms.decode(&empty).is_ok());
    let more = [0x0a, 0].repeat(1_000_000);
    let error = transforms.decode(&more).unwrap_err();
    assert_eq!(error.0, "`transforms` has more than 20000 elements");
}

#[test]
fn descriptors_that_do_not_serve_are_refused() {
    let name = "foxglove.Grid";
    let refused = |schema: &[u8]| reader_of(name, schema).unwrap_err();
    assert_eq!(refused(&[]), "the recording holds no descriptor of `foxglove.Grid`");
    assert!(refused(b"syntax = \"proto3\";").contains("cannot be decoded"));
    assert!(refused(&vec![0x0a; 3 << 20]).contains("has 3145728 bytes; at most 2097152 are read"));
    assert!(refused(&descriptor(FileDescriptorProto::default())).contains("does not contain that type"));
    let format = Format {
        topic: "/t",
        message_type: name,
        message_encoding: "protobuf",
        schema: b"x",
        schema_encoding: "proto",
    };
    let why = Reader::of(&format).unwrap().unwrap_err();
    assert_eq!(why, "definitions of protobuf messages in `proto` are not read");
}

#[test]
fn a_type_that_holds_itself_is_read_as_deep_as_is_wanted() {
    let fields: [(&str, i32, &str); 3] = [
        ("header", 1, ".acme.Loop"),
        ("stamp", 2, ".acme.Loop"),
        ("sec", 3, "int64"),
    ];
    let schema = descriptor(file("acme", vec![declared("Loop", &fields)]));
    let reader = reader_of("acme.Loop", &schema).unwrap();
    let mut bytes = Vec::new();
    for _ in 0..2000 {
        let mut outer = vec![0x0a];
        prost::encoding::encode_varint(bytes.len() as u64, &mut outer);
        outer.extend(bytes);
        bytes = outer;
    }
    assert_eq!(reader.decode(&bytes).unwrap().header, None);
}

#[test]
fn json_nested_without_end_is_refused_or_passed_over() {
    let deep = format!("{{\"x\":{}1{}}}", "[".repeat(100_000), "]".repeat(100_000));
    assert_eq!(json("acme.Thing", &deep).unwrap().header, None);
    let deep = format!("{}1{}", "{\"header\":".repeat(100_000), "}".repeat(100_000));
    assert_eq!(json("acme.Thing", &deep).unwrap().header, None);
    let deep = format!("{{\"transforms\":{}{}}}", "[".repeat(100_000), "]".repeat(100_000));
    let error = json("foxglove.FrameTransforms", &deep).unwrap_err();
    assert_eq!(error.0, "an element of `transforms` is something else, not an object");
    let many = format!("{{\"transforms\":[{}{{}}]}}", "{},".repeat(1_000_000));
    let error = json("foxglove.FrameTransforms", &many).unwrap_err();
    assert!(
        error
            .0
            .contains("`transforms` has more than 20000 elements at line 1 column"),
        "{error}"
    );
}

proptest! {
    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        for message_type in TYPES {
            let _ = reader(message_type).decode(&bytes);
        }
        let _ = reader_of("foxglove.Pose", &bytes);
        let _ = json("foxglove.FrameTransforms", &String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn a_sound_message_with_one_byte_changed_is_survived(at in 0_usize..100, byte in any::<u8>()) {
        let mut bytes = FrameTransforms { transforms: vec![mount(), mount()] }.encode_to_vec();
        if let Some(changed) = bytes.get_mut(at) {
            *changed = byte;
        }
        let _ = reader("foxglove.FrameTransforms").decode(&bytes);
    }
}
