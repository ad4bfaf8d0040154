//! Plain fields with unmistakable names.

use super::{FORMS, Form, Piece, RULE, decoder, floats, header, schema};
use crate::read::messages::content::{Body, Fix, Imu};

/// What is guessed from a definition behind a header: the fields of each member.
fn guessed(own: &str) -> Vec<String> {
    let own = format!("std_msgs/Header header\n{own}");
    let decoder = decoder("/t", "acme/Top", Form::Little, &own);
    assert_eq!(decoder.unread(), None, "{own}");
    let message = Form::Little.write(&[header("a")]);
    let message = message.into_iter().chain([0; 1000]).collect::<Vec<u8>>();
    let content = decoder.decode(&message).unwrap();
    assert!(content.members.iter().all(|member| member.guessed), "{own}");
    content.members.iter().map(|member| member.field.to_string()).collect()
}

#[test]
fn a_driver_of_plain_numbers_is_read_as_a_guess() {
    let own = "std_msgs/Header header\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\nfloat64 utm_easting\n\
        uint8 zone\nstring letter\n";
    for form in FORMS {
        let mut pieces = vec![header("GPS1_Frame")];
        pieces.extend(floats(42, 4));
        let message = form.write(&pieces);
        let decoder = decoder("/gps", "gps_driver/Customgps", form, &schema(form, own));
        let content = decoder.decode(&message).unwrap();
        let [member] = content.members.as_slice() else {
            panic!("{:?}", content.members);
        };
        assert_eq!(
            (&*member.field, member.guessed),
            ("latitude, longitude, altitude", true)
        );
        assert_eq!(member.header, content.header);
        let fix = Fix {
            status: 0,
            latitude: 42.5,
            longitude: 43.5,
            altitude: 44.5,
            covariance: [0.0; 9],
            velocity: None,
        };
        assert_eq!(member.body, Body::Fix(fix));
        // The first three numbers are wanted, and no more.
        assert!(decoder.decode(&message[..message.len() - 8]).is_ok());
        assert!(decoder.decode(&message[..message.len() - 9]).is_err());
    }
}

#[test]
fn other_orders_and_forms_of_numbers_are_read() {
    let own = "int32 lonE7\nuint8 kind\nint32 lat_1e7\nfloat32 alt\nfloat32[] ranges\n";
    let decoder = decoder("/t", "acme/Top", Form::Little, own);
    let pieces = [
        Piece::Bits(4, u64::from((-115_000_000_i32).cast_unsigned())),
        Piece::Bits(1, 9),
        Piece::Bits(4, 481_000_000),
        Piece::Bits(4, u64::from(500.5_f32.to_bits())),
    ];
    let message = Form::Little.write(&pieces);
    let content = decoder.decode(&message).unwrap();
    let Body::Fix(fix) = &content.members[0].body else {
        panic!("{content:?}");
    };
    assert!((fix.latitude - 48.1).abs() < 1e-9 && (fix.longitude + 11.5).abs() < 1e-9);
    assert_eq!(fix.altitude.to_bits(), 500.5_f64.to_bits());
    assert_eq!(
        (&*content.members[0].field, &content.members[0].header),
        ("lat_1e7, lonE7, alt", &None)
    );
}

#[test]
fn only_whole_words_that_leave_no_doubt_count() {
    let one = |own: &str, field: &str| assert_eq!(guessed(own), [field], "{own}");
    one("float64 Lat\nfloat32 LNG\n", "Lat, LNG");
    one(
        "float64 latitude_deg\nfloat64 longitude_deg\nfloat32 altitude_m\n",
        "latitude_deg, longitude_deg, altitude_m",
    );
    one("float64 lat\nfloat64 long\nint32 alt\n", "lat, long");
    one("float64 lat\nfloat64 lon\nfloat64 alt\nfloat64 altitude\n", "lat, lon");
    one(
        "float64 lat\nfloat64 lat_std\nfloat64 lon\nfloat64 lon_std\n",
        "lat, lon",
    );
    one(
        &format!("Sub at\n{RULE}\nMSG: acme/Sub\nfloat64 lat\nfloat64 lon\n"),
        "at.lat, at.lon",
    );
    for own in [
        "float64 plateau\nfloat64 longest\n",
        "float64 flat\nfloat64 lon\n",
        "float64 lat\n",
        "float64 latitude_rad\nfloat64 longitude_rad\n",
        "float64 lat\nfloat64 latitude\nfloat64 lon\n",
        "int32 lat\nint32 lon\n",
        "uint32 lat_e7\nuint32 lon_e7\n",
        "float64 lat_e7\nfloat64 lon_e7\n",
        "float64[] lat\nfloat64[] lon\n",
        "float64[2] lat\nfloat64[2] lon\n",
        "string lat\nstring lon\n",
        // As NMEA 0183 writes them, degrees and minutes in one number.
        "float64 lat\nstring lat_dir\nfloat64 lon\nstring lon_dir\n",
        // The way to the second one is not known.
        "float64 lat\nwstring name\nfloat64 lon\n",
    ] {
        assert_eq!(guessed(own), [""; 0], "{own}");
    }
    let deep = format!("Sub s\n{RULE}\nMSG: acme/Sub\nDeep d\n{RULE}\nMSG: acme/Deep\nfloat64 lat\nfloat64 lon\n");
    assert_eq!(guessed(&deep), [""; 0]);
}

#[test]
fn inertial_measurements_are_known_by_three_members() {
    let own = "geometry_msgs/Vector3 linear_acceleration\nfloat32 temperature\ngeometry_msgs/Quaternion orientation\n\
        float64[9] orientation_covariance\ngeometry_msgs/Vector3 angularVelocity\n";
    let mut pieces: Vec<Piece> = floats(0, 3).collect();
    pieces.push(Piece::Bits(4, 0));
    pieces.extend(floats(3, 16));
    for form in FORMS {
        let message = form.write(&pieces);
        let decoder = decoder("/t", "acme/Top", form, &schema(form, own));
        let content = decoder.decode(&message).unwrap();
        let row = |from: f64| std::array::from_fn(|index| from + index as f64);
        let [member] = content.members.as_slice() else {
            panic!("{:?}", content.members);
        };
        let imu = Imu {
            orientation: [3.5, 4.5, 5.5, 6.5],
            orientation_covariance: row(7.5),
            angular_velocity: [16.5, 17.5, 18.5],
            angular_velocity_covariance: [0.0; 9],
            linear_acceleration: [0.5, 1.5, 2.5],
            linear_acceleration_covariance: [0.0; 9],
        };
        assert_eq!((&member.body, member.guessed), (&Body::Imu(Box::new(imu)), true));
        let named = "orientation, orientation_covariance, angularVelocity, linear_acceleration";
        assert_eq!(&*member.field, named);
    }
    let vector = "geometry_msgs/Vector3 angular_velocity\ngeometry_msgs/Vector3 linear_acceleration\n";
    for orientation in [
        "geometry_msgs/Vector3 orientation",
        "geometry_msgs/Quaternion attitude",
        "",
    ] {
        assert_eq!(guessed(&format!("{vector}{orientation}\n")), [""; 0]);
    }
    let other =
        format!("{vector}geometry_msgs/Quaternion orientation\n{RULE}\nMSG: geometry_msgs/Quaternion\nfloat64 w\n");
    assert_eq!(guessed(&other), [""; 0]);
}
