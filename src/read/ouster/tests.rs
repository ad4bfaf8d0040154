//! Tests of metadata, packets and scans: against closed forms, against what ouster-sdk 1.0 made of `fixtures/ouster`
//! (written by `verify/fixtures.py`), and on damaged input.

use std::f64::consts::TAU;
use std::fs;

use super::profiles::PROFILES;
use super::{Axes, Bits, Layout, Metadata, OusterError, Scan, decode, frame_id, imu};

pub(crate) fn fixture(name: &str) -> Vec<u8> {
    fs::read(format!("{}/fixtures/ouster/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

pub(crate) fn tiny() -> Metadata {
    Metadata::parse(&String::from_utf8(fixture("tiny.json")).unwrap()).unwrap()
}

/// Lidar, IMU, lidar, IMU.
fn packets() -> Vec<Vec<u8>> {
    let (mut bytes, mut packets) = (fixture("tiny.packets"), Vec::new());
    while !bytes.is_empty() {
        let length = u32::from_le_bytes(*bytes.first_chunk().unwrap()) as usize;
        packets.push(bytes[4..4 + length].to_vec());
        bytes.drain(..4 + length);
    }
    packets
}

fn lidar(packets: &[Vec<u8>]) -> impl Iterator<Item = (i64, &[u8])> {
    packets.iter().map(|packet| (5, packet.as_slice()))
}

/// Whether a scan is what ouster-sdk made of the fixture, in the axes of the sensor and of the lidar.
pub(crate) fn assert_like_sdk([sensor, lidar]: [&Scan; 2]) {
    let reference = fixture("tiny.points");
    let mut order: Vec<_> = sensor.returns.iter().zip(&lidar.returns).collect();
    order.sort_by_key(|(r, _)| (r.column, r.ring));
    assert_eq!(order.len(), 105);
    for ((sensor_point, lidar_point), record) in order.into_iter().zip(reference.chunks_exact(72)) {
        let column = u16::from_le_bytes(record[4..6].try_into().unwrap());
        let row = u16::from_le_bytes(record[6..8].try_into().unwrap());
        assert_eq!((sensor_point.column, sensor_point.ring), (column, row));
        let float = |i: usize| f64::from_le_bytes(record[12 + 8 * i..20 + 8 * i].try_into().unwrap());
        for (i, ours) in [sensor_point, lidar_point]
            .into_iter()
            .flat_map(|p| [p.x, p.y, p.z])
            .enumerate()
        {
            assert!((f64::from(ours) - float(i)).abs() < 1e-4, "{ours} {}", float(i));
        }
        let intensity = u32::from_le_bytes(record[60..64].try_into().unwrap());
        assert!((f64::from(sensor_point.intensity) - f64::from(intensity)).abs() < 0.5);
        let time = i64::from_le_bytes(record[64..72].try_into().unwrap());
        assert_eq!(sensor.start_ns.unwrap() + sensor_point.offset_ns, time);
    }
}

#[test]
fn packets_as_ouster_sdk_decodes_them() {
    let (metadata, packets) = (tiny(), packets());
    let scans = [Axes::Sensor, Axes::Lidar].map(|axes| decode(&metadata, lidar(&packets), axes).unwrap());
    assert_like_sdk([&scans[0], &scans[1]]);
    let scan = &scans[0];
    assert_eq!(
        (scan.model.as_str(), scan.refused, scan.received_ns),
        ("OS-1-4", 2, Some(5))
    );
    let reason = scan.reason.as_ref().unwrap().to_string();
    assert_eq!(
        reason,
        "a packet of 236 bytes; the profile RNG19_RFL8_SIG16_NIR16_DUAL with 8 columns has 672"
    );
    assert_eq!(
        packets.iter().map(|p| frame_id(&metadata, p)).collect::<Vec<_>>(),
        [Some(1234), None, Some(1234), None]
    );
    let head = Layout::of(&metadata).unwrap().read(&metadata, &packets[0]).unwrap().0;
    assert_eq!((head.packet_type, head.serial), (1, 122_246_000_293));
}

#[test]
fn measurements_of_both_imu_profiles() {
    let mut metadata = tiny();
    let measured = imu(&metadata, &packets()[1]).unwrap();
    assert_eq!(measured.iter().map(|m| m.timestamp_ns % 10).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(imu(&metadata, &packets()[3]).unwrap().len(), 1); // The other one is marked as invalid.
    metadata.imu_profile = "LEGACY".into();
    let mut bytes: Vec<u8> = [1_u64, 2, 3].into_iter().flat_map(u64::to_le_bytes).collect();
    bytes.extend([0., 0., 1., 0., -180., 0_f32].into_iter().flat_map(f32::to_le_bytes));
    let [one] = imu(&metadata, &bytes).unwrap()[..] else {
        panic!("one measurement")
    };
    assert_eq!(one.timestamp_ns, 3);
    assert!((one.acceleration[2] - 9.80665).abs() < 1e-9 && (one.angular_rate[1] + TAU / 2.).abs() < 1e-9);
    let text = imu(&metadata, &bytes[1..]).unwrap_err().to_string();
    assert_eq!(text, "a packet of 47 bytes; the profile LEGACY with 1 columns has 48");
    metadata.imu_profile = "OFF".into();
    assert_eq!(
        imu(&metadata, &bytes).unwrap_err().to_string(),
        "the unknown packet profile OFF"
    );
}

/// Metadata of firmware 1: one beam, four columns, beams from the axis.
const OLD: &str = r#"{"lidar_mode": "1024x10", "beam_altitude_angles": [ALT], "beam_azimuth_angles": [AZ],
    "lidar_origin_to_beam_origin_mm": ORIGIN, "data_format": {"columns_per_frame": 4, "columns_per_packet": 4}}"#;

/// A packet of that sensor with these ranges; column 1 is invalid.
fn old(ranges: [u32; 4]) -> Vec<u8> {
    let mut packet = Vec::new();
    for (m, range) in (0_u16..).zip(ranges) {
        packet.extend((u64::from(m) * 25 + 100).to_le_bytes());
        packet.extend([m.to_le_bytes(), 77_u16.to_le_bytes()].as_flattened());
        packet.extend((u32::from(m) * 22528).to_le_bytes());
        packet.extend((range | 0xF000_0000).to_le_bytes());
        packet.extend([0xFF, 0xFF, 9, 0, 0xFF, 0xFF, 0xFF, 0xFF]);
        packet.extend(if m == 1 { [0; 4] } else { [0xFF; 4] });
    }
    packet
}

#[test]
fn points_by_closed_form() {
    let text = OLD.replace("ALT", "30").replace("AZ", "10").replace("ORIGIN", "20");
    let metadata = Metadata::parse(&text).unwrap();
    let packet = old([1000, 2000, 0, 3000]);
    let scan = decode(&metadata, [(0, packet.as_slice())].into_iter(), Axes::Lidar).unwrap();
    assert_eq!((scan.start_ns, frame_id(&metadata, &packet)), (Some(100), Some(77)));
    assert_eq!(
        scan.returns.iter().map(|r| (r.column, r.offset_ns)).collect::<Vec<_>>(),
        [(0, 0), (3, 75)]
    );
    for point in &scan.returns {
        let (range, angle) = (
            1000. + 2000. * f64::from(point.column / 3),
            -TAU * f64::from(point.column) / 4.,
        );
        let (beam, out) = (angle - 10_f64.to_radians(), (range - 20.) * 30_f64.to_radians().cos());
        let expected = [
            out * beam.cos() + 20. * angle.cos(),
            out * beam.sin() + 20. * angle.sin(),
            (range - 20.) / 2.,
        ];
        for (ours, mm) in [point.x, point.y, point.z].into_iter().zip(expected) {
            assert!((f64::from(ours) - mm / 1000.).abs() < 1e-6, "{point:?} {expected:?}");
        }
        assert!((point.intensity - 9.).abs() < f32::EPSILON);
    }
    let turned = decode(&metadata, [(0, packet.as_slice())].into_iter(), Axes::Sensor).unwrap();
    for (sensor, lidar) in turned.returns.iter().zip(&scan.returns) {
        let sum = (sensor.x + lidar.x).abs() + (sensor.y + lidar.y).abs() + (sensor.z - lidar.z - 0.03618).abs();
        assert!(sum < 1e-5, "{sensor:?} {lidar:?}"); // Half a turn, and 36.18 mm up.
    }
}

#[test]
fn metadata_of_all_generations() {
    let angles = |n: usize| format!("[{}]", vec!["1.5"; n].join(","));
    let reduced = |rows, more: &str| {
        let (a, b) = (angles(rows), angles(rows));
        Metadata::parse(&format!(
            r#"{{"beam_altitude_angles":{a},"beam_azimuth_angles":{b}{more}}}"#
        ))
    };
    let first = reduced(64, r#", "lidar_mode": "2048x10""#).unwrap();
    assert_eq!(
        (
            first.columns_per_frame,
            first.columns_per_packet,
            first.pixels_per_column
        ),
        (2048, 16, 64)
    );
    assert_eq!(first.lidar_profile.as_str(), "LEGACY");
    assert_eq!(first.pixel_shift_by_row[..5], [36, 24, 12, 0, 36]);
    assert!((first.origin_mm - 12.163).abs() < 1e-9 && (first.beam_to_lidar[3] - 12.163).abs() < 1e-9);
    assert_eq!(
        (first.model().as_str(), first.lidar_port),
        ("Ouster with 64 beams", None)
    );
    let flat = reduced(
        32,
        r#", "lidar_mode": "512x20", "prod_line": "OS-0-32-BH02", "prod_sn": "99", "build_rev": "v2.0.0""#,
    );
    let flat = flat.unwrap();
    assert_eq!((flat.serial, flat.pixels_per_column), (99, 32));
    assert!((flat.origin_mm - 27.67).abs() < 1e-9);
    for (text, error) in [
        ("[1]", "metadata that is no JSON object, seen at line 1, column 1"),
        ("{\n x", "metadata that is no JSON object, seen at line 2, column 2"),
        ("{}", "metadata without \"columns_per_frame\""),
        (
            r#"{"lidar_mode":"1024x10"}"#,
            "metadata without \"beam_azimuth_angles\"",
        ),
        (
            r#"{"lidar_mode":"99999x10"}"#,
            "metadata with 99999 for \"columns_per_frame\", which can be 1 to 16384",
        ),
    ] {
        assert_eq!(Metadata::parse(text).unwrap_err().to_string(), error);
    }
    let error = reduced(3, r#", "lidar_mode": "1024x10", "prod_line": "OS-1-64""#).unwrap_err();
    assert_eq!(
        error.to_string(),
        "metadata with 3 for \"beam_azimuth_angles\", which can be 64 to 65536"
    );
}

#[test]
fn sizes_of_packets_as_the_manual_has_them() {
    let mut metadata = tiny();
    metadata.columns_per_packet = 16;
    for (rows, profile, bytes) in [
        (64, "LEGACY", 12608),
        (128, "LEGACY", 24896),
        (128, "RNG19_RFL8_SIG16_NIR16", 24832),
        (128, "RNG19_RFL8_SIG16_NIR16_DUAL", 33024),
        (128, "RNG15_RFL8_NIR8", 8448),
        (64, "FUSA_RNG15_RFL8_NIR8_DUAL", 8448),
    ] {
        (metadata.pixels_per_column, metadata.lidar_profile) = (rows, profile.into());
        assert_eq!(Layout::of(&metadata).unwrap().packet_bytes(), bytes, "{profile}");
    }
    metadata.pixels_per_column = 512;
    metadata.lidar_profile = "FIVE_WORD_PIXEL".into();
    let text = Layout::of(&metadata).unwrap_err().to_string();
    assert_eq!(text, "metadata with 16 for \"columns_per_packet\", which can be 1 to 6");
    metadata.lidar_profile = "RNG20".into();
    assert_eq!(
        Layout::of(&metadata).unwrap_err().to_string(),
        "the unknown packet profile RNG20"
    );
}

#[test]
fn values_of_bits() {
    let bytes = [0x34, 0x12, 0xF0, 0xFF];
    let of = |first, count, dropped| Bits { first, count, dropped }.of(&bytes);
    assert_eq!(
        (of(0, 16, 0), of(4, 8, 3), of(20, 4, 0)),
        (Some(0x1234), Some(0x23 << 3), Some(0xF))
    );
    assert_eq!(
        (of(0, 0, 0), of(24, 8, 0), of(24, 9, 0), of(40, 1, 0)),
        (Some(0), Some(0xFF), None, None)
    );
    for profile in PROFILES {
        let echoes = [Some(profile.first), profile.second];
        for bits in echoes
            .into_iter()
            .flatten()
            .flat_map(|echo| [echo.range, echo.intensity])
        {
            assert!(
                usize::from(bits.first + bits.count) <= 8 * profile.pixel_bytes,
                "{}",
                profile.name
            );
        }
    }
}

#[test]
fn packets_that_are_not_of_this_sensor() {
    let (metadata, mut packets) = (tiny(), packets());
    packets.truncate(1);
    let refusal = |packets: &[Vec<u8>]| decode(&metadata, lidar(packets), Axes::Lidar).unwrap_err();
    packets[0][0] = 2;
    assert_eq!(refusal(&packets).to_string(), "a packet of type 2, not 1");
    packets[0][0] = 1;
    packets[0][7] ^= 1;
    let text = "a packet of the sensor 122246000292; the metadata is of the sensor 122246000293";
    assert_eq!(refusal(&packets).to_string(), text);
    packets[0][7] ^= 1;
    packets[0][32 + 9] = 1;
    assert_eq!(refusal(&packets), OusterError::Column { id: 256, columns: 16 });
    assert_eq!(refusal(&[]).to_string(), "no packets");
}

/// Pseudo-random numbers (Knuth's MMIX).
pub(crate) fn random(state: &mut u64) -> u8 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    state.to_be_bytes()[0]
}

#[test]
fn damaged_input_is_refused_or_read_but_ends() {
    let (metadata, packets, mut state) = (tiny(), packets(), 1);
    let any = |bytes: &[u8]| {
        let scan = decode(&metadata, [(0, bytes)].into_iter(), Axes::Sensor);
        let measured = imu(&metadata, bytes);
        assert!(scan.as_ref().is_ok_and(|scan| scan.returns.len() <= 64) || scan.is_err());
        assert!(measured.as_ref().is_ok_and(|found| found.len() <= 2) || measured.is_err());
        scan.is_ok() || measured.is_ok()
    };
    for packet in &packets {
        assert!(any(packet) && (0..packet.len()).all(|end| !any(&packet[..end])));
        for at in 0..packet.len() {
            let mut bytes = packet.clone();
            bytes[at] ^= random(&mut state) | 1;
            any(&bytes);
        }
        any(&packet.iter().map(|_| random(&mut state)).collect::<Vec<_>>());
    }
    let json = fixture("tiny.json");
    for at in 0..json.len() {
        let _ = String::from_utf8(json[..at].to_vec()).map(|text| Metadata::parse(&text).unwrap_err());
        let mut bytes = json.clone();
        bytes[at] = b"0\"-{[]9e"[usize::from(random(&mut state) % 8)];
        if let Ok(metadata) = Metadata::parse(&String::from_utf8(bytes).unwrap()) {
            let _ = decode(&metadata, lidar(&packets), Axes::Sensor);
        }
    }
}
