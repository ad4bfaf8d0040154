//! Packets of Livox built here, and the points and times that the arithmetic of its drivers gives by hand.

use super::{Maker, Packet, PacketError, Return, Scan, boundary, decode};

/// 2023-11-14 22:13:20.
const TIME_NS: u64 = 1_700_000_000_000_000_000;

/// A packet of the second generation with the shots given, 100 µs long, synchronised by PTP.
fn second(layout: u8, shots: &[Vec<u8>], clock: u8, time_ns: u64) -> Vec<u8> {
    let body = shots.concat();
    let mut bytes = vec![0];
    bytes.extend(u16::try_from(36 + body.len()).unwrap_or_default().to_le_bytes());
    bytes.extend(1000_u16.to_le_bytes());
    bytes.extend(u16::try_from(shots.len()).unwrap_or_default().to_le_bytes());
    bytes.extend([7, 0, 0, layout, clock]);
    bytes.extend([0; 16]);
    bytes.extend(time_ns.to_le_bytes());
    bytes.extend(body);
    bytes
}

/// A packet of the first generation with one shot and nothing after it.
fn first(layout: u8, shots: usize, shot: &[u8], clock: u8, time: [u8; 8]) -> Vec<u8> {
    let mut bytes = vec![5, 0, 1, 0, 0, 0, 0, 0, clock, layout];
    bytes.extend(time);
    bytes.extend(shot);
    bytes.resize(18 + shots * shot.len(), 0);
    bytes
}

fn millimetres(place: [i32; 3], rest: &[u8]) -> Vec<u8> {
    [place.map(i32::to_le_bytes).concat(), rest.to_vec()].concat()
}

fn polar(depth: u32, zenith: u16, around: u16, rest: &[u8]) -> Vec<u8> {
    [
        &depth.to_le_bytes()[..],
        &zenith.to_le_bytes(),
        &around.to_le_bytes(),
        rest,
    ]
    .concat()
}

fn scan(packets: &[Vec<u8>], received_ns: i64) -> Result<Scan, PacketError> {
    decode(Maker::Livox, packets.iter().map(|bytes| Packet { received_ns, bytes }))
}

/// Place, intensity and time of each return.
fn returns(packets: &[Vec<u8>]) -> Vec<([f32; 3], f32, i64)> {
    let scan = scan(packets, 0).unwrap_or_else(|error| unreachable!("{error}"));
    let one = |r: &Return| ([r.x, r.y, r.z], r.intensity, r.offset_ns);
    scan.returns.iter().map(one).collect()
}

fn near(r: Option<&([f32; 3], f32, i64)>, place: [f64; 3]) -> bool {
    r.is_some_and(|r| r.0.iter().zip(place).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-4))
}

#[test]
fn the_second_generation_has_points_in_three_layouts() {
    let mid = second(
        1,
        &[millimetres([1000, -2500, 30], &[77, 0]), millimetres([0; 3], &[1, 0])],
        1,
        TIME_NS,
    );
    assert_eq!(Maker::of(&mid), Some(Maker::Livox));
    let more = second(
        1,
        &[millimetres([0, 0, 1], &[1, 0]), millimetres([5, 0, 0], &[2, 0])],
        1,
        TIME_NS + 400_000,
    );
    let found = returns(&[mid.clone(), more]);
    assert!(near(found.first(), [1.0, -2.5, 0.03]), "{found:?}");
    let rest: Vec<(f32, i64)> = found.iter().map(|r| (r.1, r.2)).collect();
    // Two shots in 100 µs; where nothing was received there is no return.
    assert_eq!(rest, [(77.0, 0), (1.0, 400_000), (2.0, 450_000)]);

    let low = [100_i16, -250, 3].map(i16::to_le_bytes).concat();
    let found = returns(&[second(2, &[[low, vec![77, 0]].concat()], 1, TIME_NS)]);
    assert!(near(found.first(), [1.0, -2.5, 0.03]), "{found:?}");

    // 10 m, 5° above the horizon and 30° to the left.
    let found = returns(&[second(3, &[polar(10_000, 8500, 3000, &[77, 0])], 1, TIME_NS)]);
    let ((sin, cos), (up, flat)) = (30_f64.to_radians().sin_cos(), 5_f64.to_radians().sin_cos());
    let place = [10.0 * flat * cos, 10.0 * flat * sin, 10.0 * up];
    assert!(near(found.first(), place), "{found:?}");

    let two = [millimetres([1000, 0, 0], &[1, 0]), millimetres([2000, 0, 0], &[2, 0])].concat();
    assert_eq!(returns(&[second(0x11, &[two], 1, TIME_NS)]).len(), 2);
    assert_eq!(
        scan(&[mid], 5).map(|scan| scan.start_ns),
        Ok(i64::try_from(TIME_NS).ok())
    );
}

#[test]
fn a_clock_that_was_not_set_counts_from_the_start() {
    let packet = second(1, &[millimetres([1000, 0, 0], &[77, 0])], 0, 5_000_000_000);
    assert_eq!(
        scan(std::slice::from_ref(&packet), 1_700).map(|scan| scan.start_ns),
        Ok(Some(1_700))
    );
    assert_eq!(scan(&[packet], 0).map(|scan| scan.start_ns), Ok(None));
}

#[test]
fn the_first_generation_has_points_in_eight_layouts() {
    let (time, point) = (TIME_NS.to_le_bytes(), [1000, -2500, 30]);
    for (layout, shots, shot, count) in [
        (0, 100, millimetres(point, &[77]), 1),
        (2, 96, millimetres(point, &[77, 0]), 1),
        (
            4,
            48,
            [millimetres(point, &[77, 0]), millimetres([2000, 0, 0], &[1, 0])].concat(),
            2,
        ),
        (
            4,
            48,
            [millimetres(point, &[77, 0]), millimetres(point, &[77, 0])].concat(),
            1,
        ),
        (
            7,
            30,
            [
                millimetres(point, &[77, 0]),
                millimetres([0; 3], &[1, 0]),
                millimetres([9; 3], &[1, 0]),
            ]
            .concat(),
            2,
        ),
    ] {
        let packet = first(layout, shots, &shot, 1, time);
        assert_eq!(Maker::of(&packet), Some(Maker::Livox), "{layout}");
        let found = returns(&[packet]);
        assert!(
            near(found.first(), [1.0, -2.5, 0.03]) && found.len() == count,
            "{layout}: {found:?}"
        );
    }
    let angles = [&9000_u16.to_le_bytes()[..], &27_000_u16.to_le_bytes()].concat();
    let depth = |mm: u32| [&mm.to_le_bytes()[..], &[77, 0]].concat();
    for (layout, shots, shot, count) in [
        (1, 100, polar(4000, 9000, 27_000, &[77]), 1),
        (3, 96, polar(4000, 9000, 27_000, &[77, 0]), 1),
        (5, 48, [angles.clone(), depth(4000), depth(5000)].concat(), 2),
        (8, 30, [angles, depth(4000), depth(5000), depth(0)].concat(), 2),
    ] {
        let found = returns(&[first(layout, shots, &shot, 1, time)]);
        assert!(
            near(found.first(), [0.0, -4.0, 0.0]) && found.len() == count,
            "{layout}: {found:?}"
        );
    }
    // The inertial sensor has none, and is not a packet that could not be decoded.
    let imu = first(6, 1, &[0; 24], 1, time);
    assert_eq!(scan(std::slice::from_ref(&imu), 0), Err(PacketError::Empty));
    let both = scan(&[imu, first(0, 100, &millimetres(point, &[77]), 1, time)], 0);
    assert_eq!(both.map(|scan| (scan.returns.len(), scan.refused)), Ok((1, 0)));
}

#[test]
fn gnss_gives_the_date_to_the_hour() {
    // 2020-06-25 12:00 and 129.0001 s.
    let [a, b, c, d] = 129_000_100_u32.to_le_bytes();
    let packet = first(0, 100, &millimetres([1; 3], &[77]), 3, [20, 6, 25, 12, a, b, c, d]);
    let start = scan(&[packet], 0).map(|scan| scan.start_ns);
    assert_eq!(start, Ok(Some(1_593_086_529_000_100_000)));
}

#[test]
fn scans_last_a_tenth_of_a_second() {
    let mut scans = boundary(Maker::Livox);
    let at = |ms: u64| second(1, &[millimetres([1; 3], &[1, 0])], 1, TIME_NS + 1_000_000 * ms);
    let imu = second(0, &[vec![0; 24]], 1, TIME_NS + 500_000_000);
    let packets = [at(0), at(99), imu, at(100), at(180), at(201), at(40)];
    let begins: Vec<bool> = packets.iter().map(|bytes| scans.begins(bytes) == Some(true)).collect();
    assert_eq!(begins, [false, false, false, true, false, true, true]);
}

#[test]
fn other_bytes_are_of_nobody() {
    let good = second(1, &[millimetres([1; 3], &[1, 0])], 1, TIME_NS);
    for (at, value) in [(0, 1), (1, 0), (5, 2), (10, 4), (11, 9)] {
        let mut bytes = good.clone();
        if let Some(byte) = bytes.get_mut(at) {
            *byte = value;
        }
        assert_eq!(Maker::of(&bytes), None, "byte {at}");
        assert_eq!(scan(&[bytes], 0), Err(PacketError::NotData { bytes: good.len() }));
    }
    let mixed = [good, first(0, 100, &millimetres([1; 3], &[1]), 1, [0; 8])];
    let reason = scan(&mixed, 0)
        .ok()
        .and_then(|scan| scan.reason)
        .map(|reason| reason.to_string());
    assert_eq!(
        reason.as_deref(),
        Some("a packet of a first generation among those of a second generation")
    );
    for length in 0..60 {
        let _ = scan(&[vec![0; length], vec![5; length]], 0);
    }
}
