//! Standard types with positions and orientations, beyond those of every robot.

use super::{FORMS, Form, KnownMessage, Piece, STAMP_NS, decoder, floats, header, row, with};
use crate::read::messages::content::{Body, Fix, MAX_PATH, Pose};

/// A `GPSFix` behind its header, with this status and these numbers for track, speed and climb.
fn gps_fix(status: i16, [track, speed, climb]: [f64; 3]) -> Vec<Piece> {
    let mut pieces = vec![header("map"), header("inner"), Piece::Bits(2, 3)];
    for prns in [3, 0, 1, 0, 0] {
        pieces.push(Piece::Len(prns));
        pieces.extend((0..prns).map(|_| Piece::Bits(4, 0xffff_ffff)));
        if prns == 3 {
            pieces.push(Piece::Bits(2, 9));
        }
    }
    pieces.push(Piece::Bits(2, u64::from(status.cast_unsigned())));
    pieces.extend([1, 2, 4].map(|source| Piece::Bits(2, source)));
    pieces.extend(floats(0, 3));
    pieces.extend([track, speed, climb].map(Piece::Float));
    pieces.extend(floats(100, 19));
    pieces.extend(floats(3, 9));
    pieces.push(Piece::Bits(1, 2));
    pieces
}

fn read_fix(status: i8, covariance: [f64; 9], velocity: Option<[f64; 3]>) -> Body<'static> {
    Body::Fix(Fix {
        status,
        latitude: 0.5,
        longitude: 1.5,
        altitude: 2.5,
        covariance,
        velocity,
    })
}

/// Every type of this file.
pub(super) fn all() -> Vec<KnownMessage> {
    let northwards = gps_fix(19, [0.0, 2.0, 0.25]);
    let gps_body = read_fix(19, row(3), Some([0.0, 2.0, 0.25]));
    let mut path = vec![header("map"), Piece::Len(2)];
    for from in [0, 7] {
        path.push(header("other"));
        path.extend(floats(from, 7));
    }
    let pose = |position, orientation| Pose {
        position,
        orientation,
        covariance: None,
    };
    let poses = vec![(STAMP_NS, pose(row(0), row(3))), (STAMP_NS, pose(row(7), row(10)))];
    vec![
        ("/gps", "gps_msgs/GPSFix", northwards.clone(), gps_body.clone()),
        ("/gps", "gps_common/GPSFix", northwards, gps_body),
        (
            "/home",
            "geographic_msgs/GeoPointStamped",
            with(header("map"), 3),
            read_fix(0, [0.0; 9], None),
        ),
        (
            "/heading",
            "geometry_msgs/QuaternionStamped",
            with(header("map"), 4),
            Body::Orientation(row(0)),
        ),
        (
            "/gps/velocity",
            "geometry_msgs/Vector3Stamped",
            with(header("map"), 3),
            Body::Vector(row(0)),
        ),
        ("/plan", "nav_msgs/Path", path, Body::Path(poses)),
    ]
}

#[test]
fn the_velocity_of_a_fix_is_read_from_track_speed_and_climb_where_there_is_a_fix() {
    let velocity = |status, motion| {
        let message = Form::Little.write(&gps_fix(status, motion));
        let decoder = decoder("/gps", "gps_msgs/msg/GPSFix", Form::Little, "");
        match decoder.decode(&message).unwrap().body {
            Body::Fix(fix) => (fix.status, fix.velocity),
            other => panic!("{other:?}"),
        }
    };
    let (_, Some([east, north, up])) = velocity(0, [120.0, 4.0, -1.0]) else {
        panic!("no velocity");
    };
    assert!((east - 4.0 * 0.75_f64.sqrt()).abs() < 1e-12 && (north + 2.0).abs() < 1e-12);
    assert!((up + 1.0).abs() < 1e-12);
    assert_eq!(velocity(-1, [120.0, 4.0, -1.0]), (-1, None));
    assert_eq!(velocity(0, [f64::NAN, 0.0, 0.0]), (0, None));
    assert_eq!(velocity(0, [0.0, 1.0, f64::NAN]), (0, None));
    assert_eq!(velocity(0, [0.0, f64::INFINITY, 0.0]), (0, None));
    let status = |status| velocity(status, [0.0; 3]).0;
    assert_eq!([33, 1000, -1000].map(status), [33, i8::MAX, i8::MIN]);
}

#[test]
fn a_place_with_an_orientation_says_both() {
    for form in FORMS {
        let message = form.write(&with(header("map"), 7));
        let decoder = decoder("/pose", "geographic_msgs/GeoPoseStamped", form, "");
        let content = decoder.decode(&message).unwrap();
        assert_eq!(content.body, read_fix(0, [0.0; 9], None));
        let [member] = content.members.as_slice() else {
            panic!("{:?}", content.members);
        };
        assert_eq!((&*member.field, member.guessed), ("pose.orientation", false));
        assert_eq!(
            (&member.header, &member.body),
            (&content.header, &Body::Orientation(row(3)))
        );
        assert!(decoder.decode(&message[..message.len() - 1]).is_err());
    }
}

#[test]
fn of_a_long_path_every_few_poses_are_kept_and_a_lying_count_ends_with_an_error() {
    let count = MAX_PATH * 2 + 1;
    let mut pieces = vec![header("map"), Piece::Len(count)];
    for number in 0..count {
        pieces.push(Piece::Header(number, 0, String::new()));
        pieces.extend(floats(number, 7));
    }
    let mut message = Form::Ros1.write(&pieces);
    let decoder = decoder("/plan", "nav_msgs/Path", Form::Ros1, "");
    let Body::Path(poses) = decoder.decode(&message).unwrap().body else {
        panic!("no path");
    };
    let seconds: Vec<i64> = poses.iter().map(|(stamp_ns, _)| stamp_ns / 1_000_000_000).collect();
    assert_eq!(seconds, (0..i64::from(count)).step_by(3).collect::<Vec<_>>());
    let second = Pose {
        position: row(3),
        orientation: row(6),
        covariance: None,
    };
    assert_eq!(poses[1], (3_000_000_000, second));
    // The count follows the header of the path.
    let at = 4 + 8 + 4 + "map".len();
    message[at..at + 4].copy_from_slice(&[0xff; 4]);
    let error = decoder.decode(&message).unwrap_err().0;
    assert!(
        error.contains(&format!("at byte {} run past the end", message.len())),
        "{error}"
    );
}
