//! JSON messages as they are found.

use super::*;
use crate::read::messages::content::Body;
use crate::read::messages::tf::Transform;

const STAMP_NS: i64 = 1_700_000_000_000_000_250;

fn transform(message: &str) -> Result<Transform<'_>, DecodeError> {
    match json("foxglove.FrameTransform", message)?.body {
        Body::Transforms(mut transforms) => Ok(transforms.remove(0)),
        body => panic!("{body:?}"),
    }
}

/// A transform with these parts.
fn written(timestamp: &str, rotation: &str) -> String {
    format!(
        r#"{{"timestamp":{timestamp},"parent_frame_id":"base_link","child_frame_id":"lidar",
        "translation":{{"x":0.3,"y":0,"z":1.2}},"rotation":{rotation}}}"#
    )
}

const LEVEL: &str = r#"{"x":0,"y":0,"z":0.6,"w":0.8}"#;

#[test]
fn transforms_are_read_whatever_the_time_is_spelled_like() {
    for timestamp in [
        r#"{"sec":1700000000,"nsec":250}"#,
        r#"{"seconds":"1700000000","nanos":250}"#,
        r#"{"sec":1700000000.0,"nanosec":250}"#,
        r#""2023-11-14T22:13:20.00000025Z""#,
    ] {
        let message = written(timestamp, LEVEL);
        let expected = Transform {
            stamp_ns: STAMP_NS,
            parent: "base_link".into(),
            child: "lidar".into(),
            translation: [0.3, 0.0, 1.2],
            rotation: [0.0, 0.0, 0.6, 0.8],
        };
        assert_eq!(transform(&message), Ok(expected), "{timestamp}");
    }
}

#[test]
fn numbers_that_are_not_finite_reach_the_rules() {
    let message = written(
        r#"{"sec":1,"nsec":0}"#,
        r#"{"x":null,"y":"NaN","z":"-Infinity","w":"0.5"}"#,
    );
    let [x, y, z, w] = transform(&message).unwrap().rotation;
    assert!(x.is_nan() && y.is_nan());
    assert_eq!((z, w), (f64::NEG_INFINITY, 0.5));
}

#[test]
fn names_are_borrowed_and_escapes_undone() {
    let message = r#"{"timestamp":{"sec":1,"nsec":0},"frame_id":"l\u00eddar\n"}"#;
    let header = json("foxglove.PointCloud", message).unwrap().header.unwrap();
    assert_eq!(header.frame_id, "lídar\n");
    let plain = r#"{"frame_id":"lidar","data":"AAAA","timestamp":{"sec":1,"nsec":0}}"#;
    let header = json("foxglove.PointCloud", plain).unwrap().header.unwrap();
    assert!(matches!(header.frame_id, std::borrow::Cow::Borrowed("lidar")));
}

#[test]
fn ros_messages_in_json_are_understood() {
    let message = r#"{"transforms":[{"header":{"stamp":{"sec":1,"nanosec":5},"frame_id":"odom"},
        "child_frame_id":"base_link",
        "transform":{"translation":{"x":1,"y":2,"z":3},"rotation":{"x":0,"y":0,"z":0,"w":1}}}]}"#;
    for message_type in ["tf2_msgs/msg/TFMessage", "tf2_msgs/TFMessage", "ros.tf2_msgs.TFMessage"] {
        let expected = Transform {
            stamp_ns: 1_000_000_005,
            parent: "odom".into(),
            child: "base_link".into(),
            translation: [1.0, 2.0, 3.0],
            rotation: [0.0, 0.0, 0.0, 1.0],
        };
        let read = json(message_type, message).unwrap();
        assert_eq!(read.body, Body::Transforms(vec![expected]), "{message_type}");
    }
    let image = r#"{"header":{"seq":1,"stamp":{"secs":1,"nsecs":5},"frame_id":"camera"},"data":"AA"}"#;
    let header = json("sensor_msgs/Image", image).unwrap().header.unwrap();
    assert_eq!((header.stamp_ns, header.frame_id.as_ref()), (1_000_000_005, "camera"));
}

#[test]
fn a_message_of_somebody_elses_is_never_wrong_for_lacking_a_header() {
    for message in [
        "{}",
        "[1,2]",
        "7",
        "null",
        r#""text""#,
        r#"{"timestamp":12.5,"frame_id":"a"}"#,
        r#"{"timestamp":{"sec":1,"nsec":0},"frame_id":7}"#,
        r#"{"timestamp":{"sec":1,"nsec":0}}"#,
        r#"{"header":[1],"pose":3}"#,
        r#"{"header":{"stamp":"yesterday","frame_id":"a"}}"#,
    ] {
        for message_type in ["", "MouseEvent", "acme.TFMessage", "acme.foxglove.Grid"] {
            let read = json(message_type, message).unwrap();
            assert_eq!((read.header, read.body), (None, Body::Nothing), "{message}");
        }
    }
}

#[test]
fn messages_of_foxgloves_say_what_is_wrong_with_them() {
    let error = |message_type: &str, message: &str| json(message_type, message).unwrap_err().0;
    let fox = "foxglove.FrameTransform";
    let time = r#"{"sec":1,"nsec":0}"#;
    assert_eq!(error(fox, "{}"), "`child_frame_id` is missing");
    assert_eq!(error(fox, "[]"), "the message is a list, not an object");
    assert_eq!(error(fox, r#"{"child_frame_id":"a"}"#), "`parent_frame_id` is missing");
    assert_eq!(
        error(fox, r#"{"child_frame_id":3}"#),
        "`child_frame_id` is a number, not a text"
    );
    assert_eq!(
        error(fox, &written("17.5", LEVEL)),
        "`timestamp` is a number, not seconds and nanoseconds"
    );
    assert_eq!(
        error(fox, &written(time, "[0,0,0,1]")),
        "`rotation` is a list, not an object"
    );
    assert_eq!(error(fox, &written(time, r#"{"x":0,"y":0,"z":0}"#)), "`w` is missing");
    assert_eq!(
        error(fox, &written(time, r#"{"x":true}"#)),
        "`x` is something else, not a number"
    );
    assert_eq!(error("foxglove.FrameTransforms", "{}"), "`transforms` is missing");
    assert_eq!(
        error("foxglove.PointCloud", r#"{"frame_id":"a","timestamp":true}"#),
        "`timestamp` is something else, not seconds and nanoseconds"
    );
    let broken = error("foxglove.PointCloud", r#"{"frame_id":"a","timestamp""#);
    assert!(broken.starts_with("not valid JSON: EOF while parsing"), "{broken}");
    assert!(broken.ends_with("at line 1 column 27"), "{broken}");
    assert!(error("foxglove.PointCloud", "{} {}").contains("trailing characters at line 1 column 4"));
    // JSON has no NaN of its own.
    assert!(error(fox, &written(time, r#"{"x":NaN}"#)).contains("line 2"));
}

#[test]
fn fixes_and_poses_are_read() {
    let message = r#"{"fixes":[{"timestamp":{"sec":1,"nsec":0},"frame_id":"gps","latitude":48.1,"longitude":11,
        "altitude":520.5,"position_covariance":[1,0,0,0,1,0,0,0,4],"position_covariance_type":2}]}"#;
    let read = json("foxglove.LocationFixes", message).unwrap();
    assert_eq!(read.header.unwrap().frame_id, "gps");
    let Body::Fix(fix) = read.body else { panic!("a fix") };
    assert_eq!((fix.latitude, fix.longitude, fix.altitude), (48.1, 11.0, 520.5));
    assert_eq!(fix.covariance[8], 4.0);
    // The schema of 2022 had neither time nor frame.
    let old = r#"{"latitude":48.1,"longitude":11,"altitude":0}"#;
    assert_eq!(json("foxglove.LocationFix", old).unwrap().header, None);

    let pose = r#"{"timestamp":{"sec":1,"nsec":0},"frame_id":"map",
        "pose":{"position":{"x":1,"y":2,"z":3},"orientation":{"x":0,"y":0,"z":0,"w":1}}}"#;
    let read = json("foxglove.PoseInFrame", pose).unwrap();
    let Body::Pose(pose) = read.body else { panic!("a pose") };
    assert_eq!(
        (pose.position, pose.orientation),
        ([1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0])
    );
}

#[test]
fn scans_of_planes_keep_all_their_ranges() {
    let ranges = (0..500).map(|ray| {
        if ray == 7 {
            "null".to_owned()
        } else {
            format!("{ray}.5")
        }
    });
    let ranges = ranges.collect::<Vec<_>>().join(",");
    let head = r#"{"timestamp":{"sec":1,"nsec":0},"frame_id":"laser","start_angle":-1,"end_angle":1,"ranges":["#;
    let message = format!("{head}{ranges}]}}");
    let Body::LaserScan(scan) = json("foxglove.LaserScan", &message).unwrap().body else {
        panic!("no scan");
    };
    assert_eq!((scan.ranges.len(), scan.ranges[499]), (500, 499.5));
    assert!(scan.ranges[7].is_nan() && scan.time_increment.is_nan() && scan.pose.is_none());
    assert!((scan.angles[2] - 2.0 / 499.0).abs() < 1e-12);
    let without = head.replace(r#","ranges":["#, "}");
    assert!(
        json("foxglove.LaserScan", &without)
            .unwrap_err()
            .0
            .contains("`ranges` is missing")
    );
}
