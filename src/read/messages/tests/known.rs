//! The standard types, on both wires.

use super::{FORMS, Form, KnownMessage, Piece, STAMP_NS, decoder, floats, header, places, row, schema, sensing, with};
use crate::read::messages::content::{Body, Content, Fix, Imu, Odometry, Pose, Twist};
use crate::read::messages::definition::Schema;
use crate::read::messages::route::Route;
use crate::read::messages::tf::Transform;
use crate::read::messages::{Wire, definition};

fn transform(parent: &str, child: &str) -> Vec<Piece> {
    let mut pieces = vec![header(parent), Piece::Text(child.to_owned())];
    pieces.extend(floats(0, 7));
    pieces
}

fn read_transform(parent: &'static str, child: &'static str) -> Transform<'static> {
    Transform {
        stamp_ns: STAMP_NS,
        parent: parent.into(),
        child: child.into(),
        translation: row(0),
        rotation: row(3),
    }
}

/// Every type.
pub(super) fn all() -> Vec<KnownMessage> {
    let mut all = transforms_and_texts();
    all.extend(measurements());
    all.extend(places::all());
    all.extend(sensing::all());
    all
}

fn transforms_and_texts() -> Vec<KnownMessage> {
    let mut tf = vec![Piece::Len(2)];
    tf.extend(transform("map", "odom"));
    tf.extend(transform("odom", "base_link"));
    let tf_body = Body::Transforms(vec![read_transform("map", "odom"), read_transform("odom", "base_link")]);
    let text = Piece::Text("<robot/>".to_owned());
    vec![
        ("/tf", "tf2_msgs/TFMessage", tf.clone(), tf_body.clone()),
        ("/tf", "tf/tfMessage", tf, tf_body),
        (
            "/vicon/drone",
            "geometry_msgs/TransformStamped",
            transform("map", "drone"),
            Body::Transforms(vec![read_transform("map", "drone")]),
        ),
        (
            "/ns/robot_description",
            "std_msgs/String",
            vec![text],
            Body::Description("<robot/>".into()),
        ),
        (
            "/clock",
            "rosgraph_msgs/Clock",
            vec![Piece::Time(7, 8)],
            Body::Clock(STAMP_NS),
        ),
    ]
}

fn measurements() -> Vec<KnownMessage> {
    let mut odometry = vec![header("map"), Piece::Text("base".to_owned())];
    odometry.extend(floats(0, 7 + 36 + 6 + 36));
    let mut fix = vec![header("map"), Piece::Bits(1, 0xff), Piece::Bits(2, 3)];
    fix.extend(floats(0, 12));
    fix.push(Piece::Bits(1, 2));
    let pose = |covariance| Pose {
        position: row(0),
        orientation: row(3),
        covariance,
    };
    let twist = |covariance| Twist {
        linear: row(0),
        angular: row(3),
        covariance,
    };
    vec![
        (
            "/odom",
            "nav_msgs/Odometry",
            odometry,
            Body::Odometry(Box::new(Odometry {
                child: "base".into(),
                position: row(0),
                orientation: row(3),
                pose_covariance: row(7),
                linear: row(43),
                angular: row(46),
                twist_covariance: row(49),
            })),
        ),
        (
            "/imu",
            "sensor_msgs/Imu",
            with(header("map"), 37),
            Body::Imu(Box::new(Imu {
                orientation: row(0),
                orientation_covariance: row(4),
                angular_velocity: row(13),
                angular_velocity_covariance: row(16),
                linear_acceleration: row(25),
                linear_acceleration_covariance: row(28),
            })),
        ),
        (
            "/fix",
            "sensor_msgs/NavSatFix",
            fix,
            Body::Fix(Fix {
                status: -1,
                latitude: 0.5,
                longitude: 1.5,
                altitude: 2.5,
                covariance: row(3),
                velocity: None,
            }),
        ),
        (
            "/pose",
            "geometry_msgs/PoseStamped",
            with(header("map"), 7),
            Body::Pose(Box::new(pose(None))),
        ),
        (
            "/pose",
            "geometry_msgs/PoseWithCovarianceStamped",
            with(header("map"), 43),
            Body::Pose(Box::new(pose(Some(row(7))))),
        ),
        (
            "/twist",
            "geometry_msgs/TwistStamped",
            with(header("map"), 6),
            Body::Twist(Box::new(twist(None))),
        ),
        (
            "/twist",
            "geometry_msgs/TwistWithCovarianceStamped",
            with(header("map"), 42),
            Body::Twist(Box::new(twist(Some(row(6))))),
        ),
    ]
}

#[test]
fn every_standard_type_is_read_whole_under_each_spelling() {
    for (topic, name, pieces, body) in all() {
        let has_header = matches!(pieces.first(), Some(Piece::Header(..)));
        for form in FORMS {
            let message = form.write(&pieces);
            let long = name.replace('/', "/msg/");
            for spelling in [name, &long] {
                let decoder = decoder(topic, spelling, form, "");
                assert_eq!((decoder.unread(), decoder.note()), (None, None), "{spelling} {form:?}");
                let Content { header, body: read, .. } = decoder.decode(&message).unwrap();
                assert_eq!(read, body, "{spelling} {form:?}");
                let header = header.map(|header| (header.stamp_ns, header.frame_id.into_owned()));
                let expected = has_header.then(|| (STAMP_NS, "map".to_owned()));
                assert_eq!(header, expected, "{spelling} {form:?}");
                // One byte less is an error at any position of the reader; others end in a byte that is not read.
                if !matches!(read, Body::Fix(_) | Body::Image(_) | Body::Cloud(_)) {
                    assert!(
                        decoder.decode(&message[..message.len() - 1]).is_err(),
                        "{spelling} {form:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_walk_by_definition_finds_what_the_readers_find() {
    for (topic, name, pieces, _) in all() {
        let Some(route) = Route::of(Schema::published(name).unwrap(), Wire::Cdr).unwrap() else {
            continue;
        };
        // The standard packages are described as ROS 2 has them, without the sequence number of ROS 1.
        for form in [Form::Little, Form::Big] {
            let message = form.write(&pieces);
            let walked = route.read(Wire::Cdr.open(&message).unwrap()).unwrap();
            let read = decoder(topic, name, form, "").decode(&message).unwrap();
            assert_eq!(walked.header, read.header, "{name}");
            let child = match &read.body {
                Body::Odometry(odometry) => Body::ChildFrame(odometry.child.clone()),
                Body::Transforms(transforms) => Body::ChildFrame(transforms[0].child.clone()),
                _ => Body::Nothing,
            };
            assert_eq!(walked.body, child, "{name}");
        }
    }
}

#[test]
fn every_standard_type_is_as_long_as_its_definition_says() {
    for (_, name, pieces, _) in all() {
        for form in FORMS {
            let own = format!("{name}[1] one\nstd_msgs/Header behind\n");
            let mut whole = pieces.clone();
            whole.push(header("behind"));
            let message = form.write(&whole);
            let walked = decoder("/t", "acme/Top", form, &schema(form, &own)).decode(&message);
            assert_eq!(walked.unwrap().header.unwrap().frame_id, "behind", "{name} {form:?}");
        }
    }
}

#[test]
fn a_definition_that_says_otherwise_is_believed() {
    let plain = "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
        geometry_msgs/TwistWithCovariance twist\n";
    let quaternion_first = "float64 odometer\nstd_msgs/Header header\nstring child_frame_id\n";
    for form in FORMS {
        let published = decoder("/odom", "nav_msgs/Odometry", form, &schema(form, plain));
        assert_eq!(published.note(), None, "{form:?}");

        let changed = decoder("/odom", "nav_msgs/Odometry", form, &schema(form, quaternion_first));
        let note = "its definition of nav_msgs/Odometry differs from the published one: only headers are read";
        assert_eq!((changed.unread(), changed.note()), (None, Some(note)), "{form:?}");
        let message = form.write(&[Piece::Float(1.0), header("map"), Piece::Text("base".to_owned())]);
        let content = changed.decode(&message).unwrap();
        assert_eq!(content.header.unwrap().frame_id, "map", "{form:?}");
        assert_eq!(content.body, Body::ChildFrame("base".into()), "{form:?}");
    }
    let tf = decoder(
        "/tf",
        "tf2_msgs/msg/TFMessage",
        Form::Little,
        "uint8 kind\ngeometry_msgs/TransformStamped[] t\n",
    );
    assert_eq!(
        tf.unread(),
        Some("its definition of tf2_msgs/TFMessage differs from the published one")
    );
    assert!(!tf.lacks_definition());
}

#[test]
fn version_2_of_cdr_is_read_with_its_sizes() {
    let text = |out: &mut Vec<u8>, text: &str| {
        out.resize(out.len().next_multiple_of(4), 0);
        out.extend(u32::try_from(text.len() + 1).unwrap().to_le_bytes());
        out.extend(text.as_bytes());
        out.push(0);
    };
    let mut message = vec![0, 7, 0, 0];
    // Size of the sequence, its length, one transform: numbers of eight bytes are at multiples of four.
    for number in [0_u32, 1, 7, 8] {
        message.extend(number.to_le_bytes());
    }
    text(&mut message, "map");
    text(&mut message, "odom!");
    message.resize(message.len().next_multiple_of(4), 0);
    assert_eq!((message.len() - 4) % 8, 4, "a case where the two versions differ");
    for value in row::<7>(0) {
        message.extend(value.to_le_bytes());
    }
    let content = decoder("/tf", "tf2_msgs/msg/TFMessage", Form::Little, "").decode(&message);
    assert_eq!(
        content.unwrap().body,
        Body::Transforms(vec![read_transform("map", "odom!")])
    );
}

#[test]
fn other_encodings_and_nameless_types_are_said() {
    let of = |message_type: &str, message_encoding: &str| {
        let format = super::Format {
            topic: "/t",
            message_type,
            message_encoding,
            schema: b"",
            schema_encoding: "",
        };
        let decoder = super::Decoder::of(&format, &definition::Definitions::builtin());
        (decoder.unread().map(str::to_owned), decoder.lacks_definition())
    };
    assert_eq!(of("a/A", ""), (Some("unnamed messages are not read".to_owned()), false));
    let missing = "the recording holds no definition of a/A".to_owned();
    assert_eq!(of("a/A", "cdr"), (Some(missing), true));
    assert_eq!(of("sensor_msgs/msg/LaserScan", "cdr"), (None, false));
}
