//! Packets of Velodyne built here, and the points that the user manuals' arithmetic gives by hand.

use super::velodyne::sweep;
use super::velodyne_models::model_of;
use super::{Maker, Packet, PacketError, Return, Scan, decode};

/// One strong and steady sensor: azimuths 90.00°, 90.40°, ... and no returns.
fn packet(id: u8, mode: u8) -> Vec<u8> {
    let banks = if id == 0xA1 { 4 } else { 1 };
    let echoes = if mode == 0x39 { 2 } else { 1 };
    let mut bytes = Vec::new();
    for block in 0..12_u16 {
        bytes.extend(
            [0xEEFF_u16, 0xDDFF, 0xCCFF, 0xBBFF]
                .get(usize::from(block / echoes % banks))
                .map_or([0; 2], |m| m.to_le_bytes()),
        );
        bytes.extend((9000 + 40 * (block / (echoes * banks))).to_le_bytes());
        bytes.extend([0; 96]);
    }
    bytes.extend(1_000_000_u32.to_le_bytes());
    bytes.extend([mode, id]);
    bytes
}

fn put(bytes: &mut [u8], at: usize, values: &[u8]) {
    for (byte, value) in bytes.iter_mut().skip(at).zip(values) {
        *byte = *value;
    }
}

/// Sets the distance (as sent) of a unit; the intensity is 77.
fn hit(bytes: &mut [u8], block: usize, unit: usize, sent: u16) {
    let [low, high] = sent.to_le_bytes();
    put(bytes, 100 * block + 4 + 3 * unit, &[low, high, 77]);
}

fn scan(bytes: &[u8]) -> Result<Scan, PacketError> {
    decode(Maker::Velodyne, [Packet { received_ns: 0, bytes }].into_iter())
}

fn only(bytes: &[u8]) -> Return {
    let scan = scan(bytes).unwrap_or_else(|error| unreachable!("{error}"));
    assert_eq!(scan.returns.len(), 1, "{scan:?}");
    scan.returns.first().copied().unwrap_or_else(|| unreachable!())
}

/// Whether a return is at a distance, azimuth (clockwise from +x) and elevation, within a tenth of a millimetre.
fn at(r: Return, distance: f64, azimuth: f64, elevation: f64) -> bool {
    let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
    let by_hand = [distance * cos_e * cos_a, -distance * cos_e * sin_a, distance * sin_e];
    by_hand
        .iter()
        .zip([r.x, r.y, r.z])
        .all(|(hand, ours)| (hand - f64::from(ours)).abs() < 1e-4)
}

#[test]
fn vlp16_first_and_second_firing() {
    let mut bytes = packet(0x22, 0x37);
    hit(&mut bytes, 0, 1, 5000);
    let r = only(&bytes);
    // Laser 1 looks up by 1°; 2.304 of 110.592 us later it has turned by 0.0083° of 0.40°.
    assert!(at(r, 10.0, 90.01, 1.0), "{r:?}");
    assert_eq!((r.intensity, r.ring, r.offset_ns), (77.0, 8, 2304));

    let mut bytes = packet(0x22, 0x38);
    hit(&mut bytes, 3, 16 + 15, 2500);
    let r = only(&bytes);
    // Block 3 begins at 91.20°; (55.296 + 15 * 2.304) / 110.592 of 0.40° is 0.325°.
    assert!(at(r, 5.0, 91.53, 15.0), "{r:?}");
    assert_eq!((r.ring, r.offset_ns), (15, 3 * 110_592 + 55_296 + 15 * 2304));
}

#[test]
fn vlp16_dual_return_drops_the_repeated_one() {
    let mut bytes = packet(0x22, 0x39);
    hit(&mut bytes, 2, 0, 5000);
    hit(&mut bytes, 3, 0, 5000);
    let r = only(&bytes);
    assert!(at(r, 10.0, 90.40, -15.0), "{r:?}");
    assert_eq!((r.ring, r.offset_ns), (0, 110_592));
    hit(&mut bytes, 3, 0, 4000);
    let returns = scan(&bytes).map(|scan| scan.returns).unwrap_or_default();
    assert_eq!(returns.len(), 2);
    // Both returns are of one shot.
    assert!(returns.iter().all(|r| r.offset_ns == 110_592));
}

#[test]
fn vlp32c_fires_in_pairs() {
    let mut bytes = packet(0x28, 0x37);
    hit(&mut bytes, 1, 3, 2500);
    let r = only(&bytes);
    // Elevation -15.639°, azimuth offset 1.4°; the driver turns by 3 * 2.304 / 55.296 of 0.40°: 0.05°.
    assert!(at(r, 10.0, 90.40 + 0.05 - 1.4, -15.639), "{r:?}");
    assert_eq!((r.ring, r.offset_ns), (1, 55_296 + 2304));
}

#[test]
fn hdl32e_fires_one_by_one() {
    let mut bytes = packet(0x21, 0x37);
    hit(&mut bytes, 2, 31, 5000);
    let r = only(&bytes);
    // 31 * 1.152 / 46.08 of 0.40° is 0.31°.
    assert!(at(r, 10.0, 90.80 + 0.31, 10.67), "{r:?}");
    assert_eq!((r.ring, r.offset_ns), (31, 2 * 46_080 + 31 * 1152));
}

#[test]
fn vls128_banks_and_lead() {
    let mut bytes = packet(0xA1, 0x37);
    hit(&mut bytes, 5, 9, 2500);
    let r = only(&bytes);
    // Block 5 is the second 32 lasers of the second firing: laser 41, elevation 9.7°, azimuth offset -4.548°, group 5.
    assert!(at(r, 10.0, 90.40 + 4.55, 9.7), "{r:?}");
    assert_eq!((r.ring, r.offset_ns), (125, 53_300 + 5 * 2665 - 8700));

    // With two returns a packet has one firing: blocks 6 and 7 are the last 32 lasers, after the pause; the rest is unused.
    let mut bytes = packet(0xA1, 0x39);
    hit(&mut bytes, 7, 31, 2500);
    hit(&mut bytes, 8, 0, 2500);
    let r = only(&bytes);
    assert!(at(r, 10.0, 90.0 - 6.35, 0.43), "{r:?}");
    assert_eq!(r.offset_ns, 16 * 2665 - 8700);
}

fn sweep_of(id: u8, rotations: &[u16; 12], b: usize, echoes: usize, like_driver: bool) -> Option<(u16, u16)> {
    Some(sweep(rotations, b, model_of(id)?, echoes, like_driver))
}

#[test]
fn sweep_by_driver_and_by_manual() {
    let single = [0, 40, 80, 120, 160, 200, 240, 280, 320, 360, 400, 440];
    assert_eq!(sweep_of(0x22, &single, 5, 1, true), Some((200, 40)));
    assert_eq!(sweep_of(0x22, &single, 11, 1, true), Some((440, 0)));
    assert_eq!(sweep_of(0x22, &single, 11, 1, false), Some((440, 40)));
    let dual = [35_960, 35_960, 0, 0, 40, 40, 80, 80, 120, 120, 160, 160];
    assert_eq!(sweep_of(0x22, &dual, 0, 2, true), Some((35_960, 40)));
    assert_eq!(sweep_of(0x22, &dual, 1, 2, true), Some((0, 0)));
    assert_eq!(sweep_of(0x22, &dual, 11, 2, true), Some((160, 0)));
    assert_eq!(sweep_of(0x22, &dual, 1, 2, false), Some((35_960, 40)));
    // A part of the turn is left out.
    let gap = [
        9055, 9075, 9095, 27_017, 27_037, 27_057, 27_077, 27_097, 27_117, 27_137, 27_157, 27_177,
    ];
    assert_eq!(sweep_of(0x28, &gap, 2, 1, true), Some((9095, 0)));
    let banks = [0, 0, 0, 0, 20, 20, 20, 20, 40, 40, 40, 40];
    assert_eq!(sweep_of(0xA1, &banks, 1, 1, true), Some((0, 0)));
    assert_eq!(sweep_of(0xA1, &banks, 3, 1, true), Some((0, 20)));
    assert_eq!(sweep_of(0xA1, &banks, 1, 1, false), Some((0, 20)));
    assert_eq!(sweep_of(0xA1, &banks, 9, 1, false), Some((40, 20)));
    assert_eq!(sweep_of(0xA1, &banks, 7, 2, false), Some((20, 0)));
}

/// The time of a scan whose packet says `clock_us` within the hour and was received at `received_ns`.
fn start(clock_us: u32, received_ns: i64) -> Option<i64> {
    let mut bytes = packet(0x22, 0x37);
    put(&mut bytes, 1200, &clock_us.to_le_bytes());
    decode(
        Maker::Velodyne,
        [Packet {
            received_ns,
            bytes: &bytes,
        }]
        .into_iter(),
    )
    .ok()?
    .start_ns
}

#[test]
fn time_within_the_hour() {
    let hour = 3_600_000_000_000_i64 * 464_000;
    assert_eq!(start(5_000_000, hour + 5_000_900_123), Some(hour + 5_000_000_000));
    // Sent before the hour and received after it.
    assert_eq!(start(3_599_999_000, hour + 100_000), Some(hour - 1_000_000));
    // A clock that was never set, and a host's time that is not known.
    assert_eq!(
        start(140_554_572, hour + 1_671_737_763_166),
        Some(hour + 1_671_737_763_166)
    );
    assert_eq!(start(5_000_000, 0), None);
}

#[test]
fn offsets_go_on_over_the_hour() {
    let (mut before, mut after) = (packet(0x22, 0x37), packet(0x22, 0x37));
    put(&mut before, 1200, &3_599_999_500_u32.to_le_bytes());
    put(&mut after, 1200, &827_u32.to_le_bytes());
    hit(&mut after, 0, 0, 100);
    let packets = [&before, &after].map(|bytes| Packet { received_ns: 0, bytes });
    let offsets =
        decode(Maker::Velodyne, packets.into_iter()).map(|scan| scan.returns.iter().map(|r| r.offset_ns).sum());
    assert_eq!(offsets, Ok(1_327_000));
}

#[test]
fn refuses_with_a_plain_sentence() {
    let refusal = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = packet(0x22, 0x37);
        change(&mut bytes);
        scan(&bytes).map_or_else(|error| error.to_string(), |scan| scan.model.into_owned())
    };
    assert_eq!(refusal(&|_| ()), "VLP-16");
    assert_eq!(
        refusal(&|b| put(b, 1205, &[0x33])),
        "a packet of 1206 bytes with the unknown model 0x33"
    );
    assert_eq!(
        refusal(&|b| put(b, 1204, &[0x40])),
        "a packet of a VLP-16 with the unknown return mode 0x40"
    );
    assert_eq!(
        refusal(&|b| put(b, 0, &[0])),
        "a packet of 1206 bytes that does not start as a data packet does"
    );
    assert_eq!(
        refusal(&|b| put(b, 301, &[0])),
        "a packet of a VLP-16 whose block 4 lacks its mark"
    );
    assert_eq!(
        refusal(&|b| put(b, 102, &[0xA1, 0x8C])),
        "a packet of a VLP-16 whose block 2 has an azimuth of 360.01 degrees"
    );
    assert_eq!(
        refusal(&|b| put(b, 1203, &[0xFF])),
        "a packet of a VLP-16 whose time is no time"
    );
    assert_eq!(
        refusal(&|b| b.truncate(1200)),
        "a packet of 1200 bytes, which is not the length of a Velodyne data packet (1206 bytes)"
    );
    assert_eq!(decode(Maker::Velodyne, std::iter::empty()), Err(PacketError::Empty));
}

#[test]
fn counts_what_it_refuses() {
    let (good, other, none) = (packet(0x22, 0x37), packet(0x28, 0x37), Vec::new());
    let packets = [&none, &good, &other, &good].map(|bytes| Packet { received_ns: 0, bytes });
    let scan = decode(Maker::Velodyne, packets.into_iter()).unwrap_or_else(|error| unreachable!("{error}"));
    assert_eq!((&*scan.model, scan.refused), ("VLP-16", 2));
    assert_eq!(
        scan.reason.map(|r| r.to_string().starts_with("a packet of 0 bytes")),
        Some(true)
    );
    let mixed = PacketError::Mixed {
        model: "VLP-32C",
        before: "VLP-16",
    };
    assert_eq!(mixed.to_string(), "a packet of a VLP-32C among those of a VLP-16");
}

#[test]
fn no_bytes_make_it_panic() {
    let mut state = 1_u32;
    for (id, mode) in [(0x22, 0x39), (0x28, 0x37), (0x21, 0x38), (0xA1, 0x39)] {
        for length in 0..=1210 {
            let mut bytes = packet(id, mode);
            bytes.resize(length, 0xFF);
            let _ = scan(&bytes);
            for _ in 0..4 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let [a, b, c, value] = state.to_be_bytes();
                put(&mut bytes, usize::from(u16::from_be_bytes([a, b]) % 1210), &[value, c]);
            }
            let _ = scan(&bytes);
        }
    }
}
