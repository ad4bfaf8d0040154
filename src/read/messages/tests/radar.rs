//! Detections of radars and scans of planes, in standard types and in drivers' own; and what lying bytes make of them.

use std::time::{Duration, Instant};

use super::{FORMS, Form, Piece, RULE, decoder, header, schema};
use crate::read::messages::content::{Body, Content, LaserScan};
use crate::read::messages::radar::{Echo, Form as Stands, MAX_ECHOES, Radar, Speed, Speeds};

fn single(value: f32) -> Piece {
    Piece::Bits(4, u64::from(value.to_bits()))
}

fn byte(value: u8) -> Piece {
    Piece::Bits(1, u64::from(value))
}

fn returns(echoes: &[[f32; 5]]) -> Vec<Piece> {
    let mut pieces = vec![header("radar"), Piece::Len(u32::try_from(echoes.len()).unwrap())];
    pieces.extend(echoes.iter().flatten().map(|value| single(*value)));
    pieces
}

fn radar(content: Content<'_>) -> (bool, Radar) {
    let mut said = content.members.into_iter().map(|member| (member.guessed, member.body));
    let (guessed, body) = said.next().unwrap_or((false, content.body));
    match body {
        Body::Radar(radar) => (guessed, *radar),
        other => panic!("{other:?}"),
    }
}

fn assert_near(echo: &Echo, place: [f64; 3], speed: f64) {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-5;
    assert!(echo.place.iter().zip(&place).all(near), "{echo:?} {place:?}");
    assert!(
        matches!(echo.speed, Speed::Radial(seen) if (seen - speed).abs() < 1e-5),
        "{echo:?}"
    );
}

#[test]
fn returns_of_a_scan_have_places_counter_clockwise_and_up() {
    let sixth = std::f32::consts::FRAC_PI_6;
    for form in FORMS {
        let decoder = decoder("/radar", "radar_msgs/msg/RadarScan", form, "");
        let message = form.write(&returns(&[
            [10.0, 0.0, 0.0, -5.0, 3.0],
            [2.0, sixth, 0.0, 1.0, 3.0],
            [2.0, 0.0, sixth, 2.0, 3.0],
        ]));
        let (guessed, radar) = radar(decoder.decode(&message).unwrap());
        assert_eq!(
            (guessed, radar.form, radar.speeds, radar.total),
            (false, Stands::Scan, Speeds::Radial, 3)
        );
        let half = 3_f64.sqrt();
        assert_near(&radar.echoes[0], [10.0, 0.0, 0.0], -5.0);
        assert_near(&radar.echoes[1], [half, 1.0, 0.0], 1.0);
        assert_near(&radar.echoes[2], [half, 0.0, 1.0], 2.0);
        assert!(decoder.decode(&message[..message.len() - 1]).is_err());
    }
}

#[test]
fn a_list_of_a_driver_is_read_by_its_definition_and_is_a_guess() {
    let own = format!(
        "std_msgs/Header header\nuint8 state\nacme/Detection[] detections\n{RULE}\nMSG: acme/Detection\nbool invalid\nfloat32 \
         azimuth_angle\nuint8[] bins\nfloat64 range\nfloat32 range_rate\nfloat32 range_rate_std\nstring note\n"
    );
    for form in FORMS {
        let decoder = decoder("/d", "acme/msg/List", form, &schema(form, &own));
        let mut pieces = vec![header("radar"), byte(9), Piece::Len(2)];
        for (range, rate) in [(4.0, -1.5), (6.0, 2.5)] {
            pieces.extend([byte(0), single(0.0), Piece::Len(3), byte(1), byte(2), byte(3)]);
            pieces.extend([
                Piece::Float(range),
                single(rate),
                single(0.1),
                Piece::Text("x".to_owned()),
            ]);
        }
        let message = form.write(&pieces);
        let content = decoder.decode(&message).unwrap();
        assert_eq!(&*content.members[0].field, "detections");
        assert_eq!(content.members[0].header.as_ref().unwrap().frame_id, "radar");
        let (guessed, radar) = radar(content);
        assert_eq!((guessed, &*radar.field, radar.total), (true, "range_rate", 2));
        assert_near(&radar.echoes[0], [4.0, 0.0, 0.0], -1.5);
        assert_near(&radar.echoes[1], [6.0, 0.0, 0.0], 2.5);
    }
}

#[test]
fn one_detection_a_message_and_clockwise_degrees() {
    let mmwave = "std_msgs/Header header\nuint16 point_id\nfloat32 x\nfloat32 y\nfloat32 z\nfloat32 range\nfloat32 velocity\nuint16 doppler_bin\n";
    let delphi = "std_msgs/Header header\nstring canmsg\nuint8 id\nfloat32 angle\nfloat32 range\nfloat32 range_rate\n";
    for form in FORMS {
        let of = |message_type, own, pieces: &[Piece]| {
            let decoder = decoder("/t", message_type, form, &schema(form, own));
            let message = form.write(pieces);
            radar(decoder.decode(&message).unwrap())
        };
        let pieces = [
            header("r"),
            Piece::Bits(2, 7),
            single(3.0),
            single(-4.0),
            single(0.5),
            single(5.0),
            single(-2.0),
            Piece::Bits(2, 1),
        ];
        let (guessed, seen) = of("ti_mmwave_rospkg/msg/RadarScan", mmwave, &pieces);
        assert_eq!(
            (guessed, seen.form, seen.speeds),
            (true, Stands::Single(Some(7)), Speeds::Plain)
        );
        assert_near(&seen.echoes[0], [3.0, -4.0, 0.5], -2.0);
        let pieces = [
            header("r"),
            Piece::Text("510".to_owned()),
            byte(64),
            single(90.0),
            single(8.0),
            single(1.0),
        ];
        let (_, seen) = of("delphi_esr_msgs/EsrTrack", delphi, &pieces);
        assert_eq!(seen.form, Stands::Single(Some(64)));
        assert_near(&seen.echoes[0], [0.0, -8.0, 0.0], 1.0);
    }
}

#[test]
fn the_state_of_a_vehicle_is_no_detection() {
    for own in [
        "std_msgs/Header header\nfloat64 x\nfloat64 y\nfloat64 speed\nfloat64 bearing\n",
        "std_msgs/Header header\nfloat64 x\nfloat64 y\nfloat64 vx\nfloat64 vy\n",
        "std_msgs/Header header\nfloat64 range\nfloat64 azimuth\n",
        "float32 x\nfloat32 y\nfloat32 doppler\n",
    ] {
        let decoder = decoder("/t", "acme/State", Form::Little, own);
        let message = Form::Little.write(&[
            header("a"),
            Piece::Float(1.0),
            Piece::Float(1.0),
            Piece::Float(1.0),
            Piece::Float(1.0),
        ]);
        let content = decoder.decode(&message).unwrap();
        assert!(content.members.is_empty(), "{own}: {:?}", content.members);
    }
}

#[test]
fn tracks_have_components() {
    let mut pieces = vec![header("radar"), Piece::Len(1)];
    pieces.extend((0..16).map(byte));
    pieces.extend([20.0, 1.0, 0.0, -9.0, 0.5, 0.0].map(Piece::Float));
    pieces.extend([0.0; 6].map(Piece::Float));
    pieces.push(Piece::Bits(2, 32_001));
    pieces.extend((0..24).map(|_| single(0.0)));
    for form in FORMS {
        let decoder = decoder("/tracks", "radar_msgs/msg/RadarTracks", form, "");
        let message = form.write(&pieces);
        let (_, seen) = radar(decoder.decode(&message).unwrap());
        assert_eq!(seen.form, Stands::Tracks);
        assert_eq!(format!("{:?}", seen.echoes[0].place), "[20.0, 1.0, 0.0]");
        assert_eq!(seen.echoes[0].speed, Speed::Components([-9.0, 0.5, 0.0]));
        assert!(decoder.decode(&message[..message.len() - 1]).is_err());
    }
}

fn laser(ranges: &[f32]) -> Vec<Piece> {
    let mut pieces = vec![header("laser")];
    pieces.extend([-1.0, 1.0, 0.5, 0.01, 0.1, 0.2, 30.0].map(single));
    pieces.push(Piece::Len(u32::try_from(ranges.len()).unwrap()));
    pieces.extend(ranges.iter().map(|range| single(*range)));
    pieces.push(Piece::Len(0));
    pieces
}

#[test]
fn a_scan_of_a_plane_is_read_with_what_is_no_range() {
    for form in FORMS {
        let decoder = decoder("/scan", "sensor_msgs/msg/LaserScan", form, "");
        let message = form.write(&laser(&[1.5, f32::INFINITY, f32::NAN, -0.0]));
        let Body::LaserScan(scan) = decoder.decode(&message).unwrap().body else {
            panic!("no scan");
        };
        let LaserScan {
            angles, range, ranges, ..
        } = *scan;
        assert_eq!((angles, ranges.len()), ([-1.0, 1.0, 0.5], 4));
        assert!((range[1] - 30.0).abs() < 1e-6 && ranges[1].is_infinite() && ranges[2].is_nan());
    }
}

#[test]
fn of_several_echoes_of_a_ray_the_first_is_read() {
    for form in FORMS {
        let rays: [&[f32]; 3] = [&[1.5, 7.0], &[], &[2.5]];
        let mut pieces = laser(&[]);
        // The empty lists of ranges and intensities.
        pieces.truncate(pieces.len() - 2);
        pieces.push(Piece::Len(u32::try_from(rays.len()).unwrap()));
        for ray in rays {
            pieces.push(Piece::Len(u32::try_from(ray.len()).unwrap()));
            pieces.extend(ray.iter().map(|range| single(*range)));
        }
        pieces.push(Piece::Len(0));
        let decoder = decoder("/scan", "sensor_msgs/msg/MultiEchoLaserScan", form, "");
        let Body::LaserScan(scan) = decoder.decode(&form.write(&pieces)).unwrap().body else {
            panic!("no scan");
        };
        assert_eq!(format!("{:?}", scan.ranges), "[1.5, NaN, 2.5]");
    }
}

#[test]
fn counts_that_lie_end_with_the_bytes_and_large_scans_are_thinned() {
    let list = format!(
        "std_msgs/Header header\nacme/D[] detections\n{RULE}\nMSG: acme/D\nuint8[0] nothing\nfloat32 range\nfloat32 azimuth\nfloat32 doppler\n"
    );
    for form in FORMS {
        let lying = form.write(&[header("r"), Piece::Len(u32::MAX), single(1.0), single(2.0)]);
        let started = Instant::now();
        for (message_type, own) in [
            ("radar_msgs/RadarScan", String::new()),
            ("radar_msgs/RadarTracks", String::new()),
            ("acme/List", schema(form, &list)),
        ] {
            let error = decoder("/t", message_type, form, &own).decode(&lying).unwrap_err().0;
            assert!(error.contains("run past the end"), "{error}");
        }
        let mut pieces = vec![header("laser")];
        pieces.extend([0.0; 7].map(single));
        pieces.push(Piece::Len(u32::MAX));
        let error = decoder("/t", "sensor_msgs/LaserScan", form, "")
            .decode(&form.write(&pieces))
            .unwrap_err()
            .0;
        assert!(error.contains("run past the end"), "{error}");
        assert!(started.elapsed() < Duration::from_secs(5));
        let many = vec![[5.0, 0.1, 0.0, -1.0, 0.0]; 3 * MAX_ECHOES as usize];
        let message = form.write(&returns(&many));
        let (_, seen) = radar(
            decoder("/t", "radar_msgs/RadarScan", form, "")
                .decode(&message)
                .unwrap(),
        );
        assert_eq!((seen.total, seen.echoes.len()), (3 * MAX_ECHOES, MAX_ECHOES as usize));
    }
}
