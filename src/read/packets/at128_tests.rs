//! Packets and corrections of an AT128 built here, and the points and times that the arithmetic of nebula gives by hand.

use std::sync::Arc;

use super::{Correction, Maker, Packet, PacketError, Scan, Unit, boundary, decode_with};

/// A file with a unit of 1/12800 degree and one mirror from 30° to 80°; channel 3 is 2.4° off and looks up by 5.1°, and at the azimuth
/// of 41° it is adjusted by 0.20° and -0.05° (halfway between what is stated for 40° and 42°).
fn file() -> Vec<u8> {
    let mut bytes = vec![0xEE, 0xFF, 1, 5, 128, 1, 1];
    bytes.extend([0; 8]);
    bytes.push(2);
    bytes.extend((30 * 12_800_i32).to_le_bytes());
    bytes.extend((80 * 12_800_i32).to_le_bytes());
    for (channel, angle) in [(3, -30_720_i32), (3, 65_280)] {
        for number in 0..128 {
            bytes.extend(if number == channel { angle } else { 0 }.to_le_bytes());
        }
    }
    for values in [[5_i8, 15], [-2, -3]] {
        let mut adjustments = vec![0; 128 * 180];
        for (place, value) in (3 * 180 + 20..).zip(values) {
            if let Some(byte) = adjustments.get_mut(place) {
                *byte = value.cast_unsigned();
            }
        }
        bytes.extend(adjustments);
    }
    bytes.extend([0; 32]);
    bytes
}

/// A packet with a return of 10 m on channel 3 of each block, at azimuths of 41° and 0.1° more, at 2025-01-01 00:00:00.000100.
fn packet(mode: u8) -> Vec<u8> {
    let mut bytes = vec![0xEE, 0xFF, 4, 3, 0, 0, 128, 2, 0, 4, 0, 0];
    for azimuth in [4100_u16, 4110] {
        bytes.extend(azimuth.to_le_bytes());
        bytes.push(0);
        let mut units = vec![0; 512];
        units.splice(12..16, [0xC4, 0x09, 77, 0]);
        bytes.extend(units);
    }
    bytes.extend([0; 4 + 20]);
    bytes.extend(100_u32.to_le_bytes());
    bytes.extend([mode, 0]);
    bytes.extend([0, 0, 0x67, 0x74, 0x85, 0x80]);
    bytes
}

fn scan(bytes: &[u8], unit: &Unit) -> Result<Scan, PacketError> {
    decode_with(Maker::Hesai, [Packet { received_ns: 0, bytes }].into_iter(), unit)
}

fn corrected() -> Unit {
    let correction = Correction::read(&file()).unwrap_or_else(|| unreachable!());
    Unit::corrected(Arc::new(correction))
}

#[test]
fn points_are_corrected_by_the_file() {
    let bytes = packet(0x37);
    assert_eq!(Maker::of(&bytes), Some(Maker::Hesai));
    let scan = scan(&bytes, &corrected()).unwrap_or_else(|error| unreachable!("{error}"));
    assert_eq!(
        (&*scan.model, scan.start_ns),
        ("PandarAT128", Some(1_735_689_600_000_100_000))
    );
    let [first, second] = scan.returns[..] else {
        unreachable!("{scan:?}")
    };
    // Twice the way from the mirror's begin, the channel's 2.4°, and (10 + 30) / 2 hundredths.
    let (azimuth, elevation) = (2.0 * 11.0 + 2.4 + 0.20_f64, 5.1 - 0.05_f64);
    let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
    let by_hand = [10.0 * cos_e * sin_a, 10.0 * cos_e * cos_a, 10.0 * sin_e];
    let ours = [first.x, first.y, first.z].map(f64::from);
    assert!(
        by_hand.iter().zip(ours).all(|(a, b)| (a - b).abs() < 1e-4),
        "{by_hand:?} {ours:?}"
    );
    assert_eq!((first.ring, first.intensity), (3, 77.0));
    let offsets = [first.offset_ns, second.offset_ns];
    assert_eq!(offsets, [-9249 - 2 * 41_666 + 4112, -9249 - 41_666 + 4112]);
}

#[test]
fn the_second_return_is_the_second_block() {
    let mut bytes = packet(0x39);
    let count = |bytes: &[u8]| scan(bytes, &corrected()).map(|scan| scan.returns.len());
    assert_eq!(count(&bytes), Ok(1));
    if let Some(byte) = bytes.get_mut(12 + 515 + 3 + 12) {
        *byte = 0;
    }
    assert_eq!(count(&bytes), Ok(2));
}

#[test]
fn without_the_file_it_is_refused_by_name() {
    let said = scan(&packet(0x37), &Unit::default()).map_err(|error| error.to_string());
    let wanted = "a packet of a PandarAT128 whose angles are in a correction file (.dat) that is not at hand";
    assert_eq!(said.err().as_deref(), Some(wanted));
}

#[test]
fn between_the_mirrors_there_is_no_point() {
    let mut bytes = packet(0x37);
    bytes.splice(12..14, 8100_u16.to_le_bytes());
    assert_eq!(scan(&bytes, &corrected()).map(|scan| scan.returns.len()), Ok(1));
}

#[test]
fn damaged_files_and_packets_are_refused() {
    let whole = file();
    for length in [0, 4, 15, 16, 23, 100, 1060, 30_000, whole.len() - 33] {
        assert_eq!(
            Correction::read(whole.get(..length).unwrap_or_default()),
            None,
            "{length}"
        );
    }
    let (bytes, unit) = (packet(0x37), corrected());
    for length in 0..bytes.len() {
        assert!(scan(bytes.get(..length).unwrap_or_default(), &unit).is_err());
    }
    let mut state = 1_u32;
    for _ in 0..2000 {
        let (mut file, mut bytes) = (whole.clone(), packet(0x39));
        for bytes in [&mut file, &mut bytes] {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let length = bytes.len();
            let place = usize::try_from(state >> 8).unwrap_or_default() % length.min(1100);
            if let (Some(byte), [value, ..]) = (bytes.get_mut(place), state.to_le_bytes()) {
                *byte = value;
            }
        }
        let unit = Correction::read(&file).map_or_else(Unit::default, |read| Unit::corrected(Arc::new(read)));
        let found = scan(&bytes, &unit).map(|scan| scan.returns).unwrap_or_default();
        assert!(found.iter().all(|point| point.x.is_finite() && point.z.is_finite()));
    }
}

#[test]
fn each_mirror_of_an_at128_makes_a_scan() {
    let mut scans = boundary(Maker::Hesai);
    let at = |azimuth: u16| {
        let mut bytes = packet(0x37);
        bytes.splice(12..14, azimuth.to_le_bytes());
        bytes
    };
    let azimuths = [3000, 13_000, 14_400, 26_200, 26_400, 35_990, 100, 2400];
    let begins = azimuths.map(|azimuth| scans.begins(&at(azimuth)) == Some(true));
    assert_eq!(begins, [false, false, true, false, true, false, false, true]);
}
