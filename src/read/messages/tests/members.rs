//! Standard types inside types that are not.

use std::fmt::Write;

use super::{FORMS, Form, Piece, RULE, STAMP_NS, decoder, floats, header, schema};
use crate::read::messages::content::{Body, Content, Imu, Member};

fn empty() -> Piece {
    Piece::Header(0, 0, String::new())
}

/// Header, magnetic field and text behind the inertial measurements, as the `Vectornav` of a driver.
const VECTORNAV: &str =
    "std_msgs/Header header\nsensor_msgs/Imu imu\nsensor_msgs/MagneticField mag_field\nstring read\n";

fn vectornav(outer: Piece, inner: Piece) -> Vec<Piece> {
    let mut pieces = vec![outer, inner];
    pieces.extend(floats(0, 37));
    pieces.push(empty());
    pieces.extend(floats(0, 12));
    pieces.push(Piece::Text("$VNYMR".to_owned()));
    pieces
}

/// The fields of the members with their stamps and frames.
fn heads(content: &Content<'_>) -> Vec<(String, Option<(i64, String)>)> {
    let head = |member: &Member<'_>| {
        let header = member.header.as_ref();
        let header = header.map(|header| (header.stamp_ns, header.frame_id.to_string()));
        (member.field.to_string(), header)
    };
    content.members.iter().map(head).collect()
}

fn fields(own: &str, form: Form, pieces: &[Piece]) -> Vec<String> {
    let decoder = decoder("/t", "acme/Top", form, &schema(form, own));
    let message = form.write(pieces);
    let content = decoder.decode(&message).unwrap();
    heads(&content).into_iter().map(|(field, _)| field).collect()
}

#[test]
fn a_driver_that_fills_in_one_of_two_headers_is_understood() {
    for form in FORMS {
        let decoder = decoder("/imu", "vn_driver/msg/Vectornav", form, &schema(form, VECTORNAV));
        assert_eq!((decoder.unread(), decoder.note()), (None, None));
        let head = |outer, inner| {
            let message = form.write(&vectornav(outer, inner));
            let content = decoder.decode(&message).unwrap();
            assert_eq!(content.body, Body::Nothing);
            let [member] = content.members.as_slice() else {
                panic!("{:?}", content.members);
            };
            let Body::Imu(imu) = &member.body else {
                panic!("{:?}", member.body);
            };
            let Imu {
                orientation,
                linear_acceleration,
                ..
            } = imu.as_ref();
            assert_eq!(
                (orientation[3].to_bits(), linear_acceleration[0].to_bits()),
                (3.5_f64.to_bits(), 25.5_f64.to_bits())
            );
            assert!(!member.guessed);
            heads(&content)
        };
        let expected = |stamp_ns, frame: &str| vec![("imu".to_owned(), Some((stamp_ns, frame.to_owned())))];
        let one = || Piece::Header(1, 0, "one".to_owned());
        assert_eq!(head(header("imu1_frame"), empty()), expected(STAMP_NS, "imu1_frame"));
        assert_eq!(head(header("imu1_frame"), one()), expected(1_000_000_000, "one"));
        assert_eq!(head(empty(), one()), expected(1_000_000_000, "one"));
        assert_eq!(head(empty(), empty()), expected(0, ""));
        let only_frame = Piece::Header(0, 0, "one".to_owned());
        assert_eq!(head(header("imu1_frame"), only_frame), expected(STAMP_NS, "one"));
    }
}

#[test]
fn members_are_found_in_front_of_the_header_and_without_one() {
    for form in FORMS {
        let own = "uint8 kind\ngeometry_msgs/QuaternionStamped q\nstd_msgs/Header h\nstring child_frame_id\n";
        let mut pieces = vec![Piece::Bits(1, 1), empty()];
        pieces.extend(floats(0, 4));
        pieces.extend([header("late"), Piece::Text("child".to_owned())]);
        let late = decoder("/t", "acme/Top", form, &schema(form, own));
        let message = form.write(&pieces);
        let content = late.decode(&message).unwrap();
        assert_eq!(heads(&content), [("q".to_owned(), Some((STAMP_NS, "late".to_owned())))]);
        assert_eq!(content.body, Body::ChildFrame("child".into()));

        let alone = decoder(
            "/t",
            "acme/Top",
            form,
            &schema(form, "geometry_msgs/QuaternionStamped q\n"),
        );
        let mut pieces = vec![header("own")];
        pieces.extend(floats(0, 4));
        let message = form.write(&pieces);
        let content = alone.decode(&message).unwrap();
        assert_eq!(content.header, None);
        assert_eq!(heads(&content), [("q".to_owned(), Some((STAMP_NS, "own".to_owned())))]);
        assert_eq!(content.members[0].body, Body::Orientation([0.5, 1.5, 2.5, 3.5]));
    }
}

#[test]
fn every_type_that_is_read_inside_others_reads_as_it_does_alone() {
    for (_, name, pieces, body) in super::known::all() {
        let is_member = !matches!(body, Body::Transforms(_) | Body::Clock(_) | Body::Description(_))
            && !matches!(body, Body::Path(_) | Body::Vector(_))
            && !name.starts_with("geographic_msgs");
        for form in FORMS {
            let own = format!("string name\n{name} inner\n");
            let decoder = decoder("/t", "acme/Top", form, &schema(form, &own));
            let mut whole = vec![Piece::Text("ab".to_owned())];
            whole.extend(pieces.clone());
            let message = form.write(&whole);
            let content = decoder.decode(&message).unwrap();
            let read: Vec<_> = content.members.iter().map(|member| &member.body).collect();
            assert_eq!(
                read,
                is_member.then_some(&body).into_iter().collect::<Vec<_>>(),
                "{name}"
            );
        }
    }
}

#[test]
fn members_are_found_one_type_deep_and_not_in_lists() {
    let stamped = |frame: &str| std::iter::once(header(frame)).chain(floats(0, 4)).collect::<Vec<_>>();
    let deep = format!(
        "Sub sub\nSub[1] subs\ngeometry_msgs/QuaternionStamped[1] list\n{RULE}\nMSG: acme/Sub\nuint8 kind\n\
        geometry_msgs/QuaternionStamped q\nSubSub deeper\nint8 last\n{RULE}\nMSG: acme/SubSub\n\
        geometry_msgs/QuaternionStamped q\n"
    );
    let mut sub = vec![Piece::Bits(1, 1)];
    sub.extend(stamped("a"));
    sub.extend(stamped("b"));
    sub.push(Piece::Bits(1, 1));
    let mut pieces = sub.clone();
    pieces.push(Piece::Len(1));
    pieces.extend(sub);
    pieces.push(Piece::Len(1));
    pieces.extend(stamped("c"));
    for form in FORMS {
        assert_eq!(fields(&deep.replace("[1]", "[]"), form, &pieces), ["sub.q"]);
    }
}

#[test]
fn types_that_only_carry_a_name_or_are_published_hold_no_members() {
    let imu = |own: &str| format!("sensor_msgs/Imu imu\n{RULE}\nMSG: sensor_msgs/Imu\n{own}\n");
    for own in [
        imu("float64 x\n"),
        imu("std_msgs/Header header\nfloat32 x\n"),
        format!("Imu imu\n{RULE}\nMSG: acme/Imu\nstd_msgs/Header header\nfloat64 x\n"),
        "geometry_msgs/Pose pose\ngeometry_msgs/Twist twist\ngeometry_msgs/Quaternion q\n".to_owned(),
    ] {
        assert_eq!(fields(&own, Form::Little, &[]), [""; 0], "{own}");
    }
    // One field more at the end is another type inside of a message.
    let mut longer = "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n".to_owned();
    longer.push_str("float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n");
    longer.push_str("float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n");
    longer.push_str("float64[9] linear_acceleration_covariance\n");
    let mut pieces = vec![header("a")];
    pieces.extend(floats(0, 37));
    assert_eq!(fields(&imu(&longer), Form::Little, &pieces), ["imu"]);
    assert_eq!(
        fields(&imu(&format!("{longer}int8 more\n")), Form::Little, &pieces),
        [""; 0]
    );
    // What published types mean, their packages say.
    for name in [
        "nav2_msgs/msg/NavigateToPose_Feedback",
        "nmea_msgs/Gpgga",
        "mavros_msgs/HilGPS",
    ] {
        let decoder = decoder("/t", name, Form::Little, "");
        let message = [0, 1, 0, 0].into_iter().chain([0; 500]).collect::<Vec<u8>>();
        assert!(decoder.decode(&message).unwrap().members.is_empty(), "{name}");
    }
}

#[test]
fn messages_cut_short_are_errors_with_the_byte() {
    for form in FORMS {
        let decoder = decoder("/imu", "vn_driver/Vectornav", form, &schema(form, VECTORNAV));
        let whole = form.write(&vectornav(header("imu1_frame"), empty()));
        // Nothing after the member is read.
        let tail = form.write(&vectornav(header("imu1_frame"), empty())[..39]).len();
        assert!(decoder.decode(&whole[..tail]).is_ok());
        for len in 0..tail {
            let error = decoder.decode(&whole[..len]).unwrap_err().0;
            assert!(
                error.contains("run past the end") || error.contains("too few"),
                "{error}"
            );
        }
    }
}

#[test]
fn ever_more_members_are_passed_over_in_the_end() {
    let (mut own, mut pieces) = (String::new(), Vec::new());
    for number in 0..100 {
        writeln!(own, "Sub s{number}").unwrap();
        pieces.push(header("a"));
        pieces.extend(floats(0, 4));
    }
    write!(own, "{RULE}\nMSG: acme/Sub\ngeometry_msgs/QuaternionStamped q\n").unwrap();
    let found = fields(&own, Form::Little, &pieces);
    assert_eq!((found.len(), found.last().map(String::as_str)), (32, Some("s31.q")));
    // A type that would be copied for every field that holds it.
    let mut wide = "std_msgs/Header h\n".to_owned();
    (0..20_000).for_each(|number| writeln!(wide, "Sub s{number}").unwrap());
    write!(wide, "{RULE}\nMSG: acme/Sub\n").unwrap();
    (0..20_000).for_each(|number| writeln!(wide, "int8 a{number}").unwrap());
    wide.push_str("float64 lat\nfloat64 lon\n");
    assert_eq!(fields(&wide, Form::Little, &[header("a")]), [""; 0]);
}
