//! `foxglove_msgs` over CDR, encoded by `re_cdr`.

use re_cdr::{CdrWriter, LittleEndian};

use super::*;
use crate::read::messages::content::Body;

fn message(write: impl FnOnce(&mut CdrWriter<'_, LittleEndian, Vec<u8>>)) -> Vec<u8> {
    let mut body = Vec::new();
    write(&mut CdrWriter::new(&mut body));
    [&[0, 1, 0, 0][..], &body].concat()
}

fn transform(out: &mut CdrWriter<'_, LittleEndian, Vec<u8>>, child: &str) {
    out.write_i32(1);
    out.write_u32(5);
    out.write_string("base");
    out.write_string(child);
    for number in [0.3, 0.0, 1.2, 0.0, 0.0, 0.6, 0.8] {
        out.write_f64(number);
    }
}

fn of(message_type: &str, schema: &str) -> Option<Reader> {
    let format = Format {
        topic: "/topic",
        message_type,
        message_encoding: "cdr",
        schema: schema.as_bytes(),
        schema_encoding: "ros2msg",
    };
    Reader::of(&format).map(Result::unwrap)
}

#[test]
fn transforms_of_the_ros_package_are_read() {
    let one = message(|out| transform(out, "lidar"));
    let several = message(|out| {
        out.write_sequence_length(2);
        transform(out, "lidar");
        transform(out, "imu");
    });
    for (message_type, bytes, children) in [
        ("foxglove_msgs/msg/FrameTransform", one, vec!["lidar"]),
        ("foxglove_msgs/msg/FrameTransforms", several, vec!["lidar", "imu"]),
    ] {
        let reader = of(message_type, "").unwrap();
        let Body::Transforms(read) = reader.decode(&bytes).unwrap().body else {
            panic!("transforms");
        };
        assert_eq!(read.iter().map(|one| one.child.as_ref()).collect::<Vec<_>>(), children);
        for one in &read {
            assert_eq!((one.stamp_ns, one.parent.as_ref()), (1_000_000_005, "base"));
            assert_eq!(one.translation, [0.3, 0.0, 1.2]);
            assert_eq!(one.rotation, [0.0, 0.0, 0.6, 0.8]);
        }
        let cut = &bytes[..bytes.len() - 1];
        assert!(reader.decode(cut).unwrap_err().0.contains("run past the end"));
    }
}

#[test]
fn other_types_are_read_by_their_definition() {
    let schema = "# foxglove_msgs/msg/Grid\n\n# Time\nbuiltin_interfaces/Time timestamp\n\n# Frame\nstring frame_id\n\ngeometry_msgs/Pose pose\n";
    let reader = of("foxglove_msgs/msg/Grid", schema).unwrap();
    let bytes = message(|out| {
        out.write_i32(1);
        out.write_u32(5);
        out.write_string("map");
        out.write_f64(3.0);
    });
    let header = reader.decode(&bytes).unwrap().header.unwrap();
    assert_eq!((header.stamp_ns, header.frame_id.as_ref()), (1_000_000_005, "map"));

    assert_eq!(
        of(
            "foxglove_msgs/msg/Log",
            "builtin_interfaces/Time timestamp\nuint8 level\n"
        ),
        None
    );
    assert_eq!(of("foxglove_msgs/msg/LocationFix", "float64 latitude\n"), None);
    assert_eq!(of("foxglove_msgs/msg/Grid", ""), None);
    assert_eq!(of("acme_msgs/msg/Grid", schema), None);
    assert_eq!(of("tf2_msgs/msg/TFMessage", ""), None);
}

#[test]
fn scans_of_planes_are_read_by_the_published_definition_alone() {
    let published = "builtin_interfaces/Time timestamp\nstring frame_id\ngeometry_msgs/Pose pose\nfloat64 start_angle\nfloat64 end_angle\n\
                     float64[] ranges\nfloat64[] intensities\n";
    let bytes = message(|out| {
        out.write_i32(1);
        out.write_u32(5);
        out.write_string("laser");
        for number in [0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 1.0, -1.0, 1.0] {
            out.write_f64(number);
        }
        out.write_sequence_length(3);
        for number in [1.0, 2.0, 3.0] {
            out.write_f64(number);
        }
        out.write_sequence_length(0);
    });
    let reader = of("foxglove_msgs/msg/LaserScan", published).unwrap();
    let content = reader.decode(&bytes).unwrap();
    assert_eq!(content.header.unwrap().frame_id, "laser");
    let Body::LaserScan(scan) = content.body else {
        panic!("no scan");
    };
    assert_eq!((scan.angles, scan.ranges), ([-1.0, 1.0, 1.0], vec![1.0, 2.0, 3.0]));
    assert_eq!(scan.pose.unwrap().position, [0.0, 0.0, 0.3]);
    let other = published.replace("start_angle", "first_angle");
    assert!(of("foxglove_msgs/msg/LaserScan", &other).is_none());
}
