//! Packets of RoboSense built here, and the points and times that the arithmetic of its driver gives by hand.

use super::{Maker, Packet, PacketError, Return, Scan, Unit, boundary, decode_with};

/// How a test builds the packet of a model.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    start: &'static [u8],
    /// Bytes 30 to 32: the numbers of the model.
    model: [u8; 3],
    header: usize,
    /// The time at its place: 2020-06-25 12:02:09.000100.
    clock: (usize, &'static [u8]),
    blocks: usize,
    mark: &'static [u8],
    channels: usize,
    /// Hundredths of a degree between blocks.
    turn: u16,
}

const DATE: &[u8] = &[20, 6, 25, 12, 2, 9, 0, 0, 0, 100];
const SECONDS: &[u8] = &[0, 0, 0x5E, 0xF4, 0x92, 0x41, 0, 0, 0, 100];
const TIME_NS: i64 = 1_593_086_529_000_100_000;
const RS16: Kind = Kind {
    name: "RS-LiDAR-16",
    start: &[0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0],
    model: [1, 0, 0],
    header: 42,
    clock: (20, DATE),
    blocks: 12,
    mark: &[0xFF, 0xEE],
    channels: 32,
    turn: 40,
};
const RS32: Kind = Kind {
    name: "RS-LiDAR-32",
    model: [2, 0, 0],
    turn: 20,
    ..RS16
};
const BPEARL: Kind = Kind {
    name: "RS-Bpearl",
    model: [3, 0, 0],
    ..RS32
};
const BPEARL_4: Kind = Kind {
    name: "RS-Bpearl v4",
    model: [0, 3, 4],
    clock: (20, SECONDS),
    ..RS32
};
const HELIOS: Kind = Kind {
    name: "RS-Helios",
    start: &[0x55, 0xAA, 0x05, 0x5A],
    model: [0, 6, 1],
    ..BPEARL_4
};
const HELIOS_16P: Kind = Kind {
    name: "RS-Helios-16P",
    model: [0, 6, 3],
    turn: 40,
    ..HELIOS
};
const RUBY: Kind = Kind {
    name: "RS-Ruby",
    model: [0, 0, 0],
    header: 80,
    clock: (10, SECONDS),
    blocks: 3,
    mark: &[0xFE, 0x01],
    channels: 128,
    ..HELIOS
};
const LITE: Kind = Kind {
    name: "RS-Ruby Lite",
    blocks: 4,
    channels: 80,
    ..RUBY
};
const RUBY_PLUS: Kind = Kind {
    name: "RS-Ruby Plus",
    model: [0, 5, 1],
    ..RUBY
};
const RUBY_PLUS_80V: Kind = Kind {
    name: "RS-Ruby Plus 80V",
    model: [0, 5, 3],
    ..LITE
};
const ALL: [Kind; 10] = [
    RS16,
    RS32,
    BPEARL,
    BPEARL_4,
    HELIOS,
    HELIOS_16P,
    RUBY,
    LITE,
    RUBY_PLUS,
    RUBY_PLUS_80V,
];

impl Kind {
    fn block_at(self, block: usize) -> usize {
        self.header + block * (4 + 3 * self.channels)
    }

    /// A packet without returns that begins at azimuth 90.00°.
    fn packet(self) -> Vec<u8> {
        let mut bytes = vec![0; 1248];
        put(&mut bytes, 0, self.start);
        put(&mut bytes, 30, &self.model);
        put(&mut bytes, self.clock.0, self.clock.1);
        for (block, azimuth) in (0..self.blocks).zip((9000..).step_by(usize::from(self.turn))) {
            put(&mut bytes, self.block_at(block), self.mark);
            self.turn_to(&mut bytes, block, azimuth);
        }
        bytes
    }

    fn turn_to(self, bytes: &mut [u8], block: usize, azimuth: u16) {
        put(bytes, self.block_at(block) + 2, &azimuth.to_be_bytes());
    }

    /// Sets the distance (as sent) of a channel (from 0); the intensity is 77.
    fn hit(self, bytes: &mut [u8], block: usize, channel: usize, sent: u16) {
        let [high, low] = sent.to_be_bytes();
        put(bytes, self.block_at(block) + 4 + 3 * channel, &[high, low, 77]);
    }
}

fn put(bytes: &mut [u8], at: usize, values: &[u8]) {
    for (byte, value) in bytes.iter_mut().skip(at).zip(values) {
        *byte = *value;
    }
}

/// A packet that tells elevations of 10°, 9°, ... and azimuths of -1° (RS-LiDAR-32: a tenth of both), with a return mode.
fn told(azimuths_at: usize, lasers: usize, mode: u8) -> Unit {
    let mut bytes = vec![0; 1248];
    put(&mut bytes, 0, &[0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55]);
    put(&mut bytes, 300, &[mode]);
    for laser in 0..lasers {
        let hundredths = 1000 - 100 * i16::try_from(laser % 90).unwrap_or_default();
        let [high, low] = hundredths.unsigned_abs().to_be_bytes();
        put(&mut bytes, 468 + 3 * laser, &[u8::from(hundredths < 0), high, low]);
        put(&mut bytes, azimuths_at + 3 * laser, &[1, 0, 100]);
    }
    let mut unit = Unit::default();
    unit.take(&bytes);
    unit
}

fn scan(bytes: &[u8], unit: &Unit) -> Result<Scan, PacketError> {
    decode_with(Maker::RoboSense, [Packet { received_ns: 0, bytes }].into_iter(), unit)
}

fn only(bytes: &[u8], unit: &Unit) -> Return {
    let scan = scan(bytes, unit).unwrap_or_else(|error| unreachable!("{error}"));
    assert_eq!((scan.returns.len(), scan.start_ns), (1, Some(TIME_NS)), "{scan:?}");
    scan.returns.first().copied().unwrap_or_else(|| unreachable!())
}

/// Whether a return is at a distance, azimuth (clockwise from +x) and elevation from a lens that looks to another azimuth,
/// within a tenth of a millimetre.
fn at(r: Return, distance: f64, azimuth: f64, elevation: f64, lens: [f64; 3]) -> bool {
    let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
    let [forward, up, lens_azimuth] = lens;
    let (sin_l, cos_l) = lens_azimuth.to_radians().sin_cos();
    let x = distance * cos_e * cos_a + forward * cos_l;
    let y = -distance * cos_e * sin_a - forward * sin_l;
    let by_hand = [x, y, distance * sin_e + up];
    let mut pairs = by_hand.iter().zip([r.x, r.y, r.z]);
    pairs.all(|(hand, ours)| (hand - f64::from(ours)).abs() < 1e-4)
}

#[test]
fn the_model_is_told_by_the_header_and_the_blocks() {
    for kind in ALL {
        let unit = told(if kind.header == 80 { 852 } else { 564 }, kind.channels.min(128), 1);
        let model = scan(&kind.packet(), &unit).map(|scan| scan.model);
        // The info packet of an RS-LiDAR-16 has its angles elsewhere: those of the model hold.
        assert_eq!(model, Ok(kind.name.into()));
        assert_eq!(Maker::of(&kind.packet()), Some(Maker::RoboSense));
    }
}

#[test]
fn rs16_fires_twice_in_a_block() {
    let mut bytes = RS16.packet();
    RS16.hit(&mut bytes, 0, 1, 2000);
    let r = only(&bytes, &Unit::default());
    // Laser 1 looks down by 13°; 2.8 of 111 us later it has turned by 0.01° of 0.40°.
    assert!(at(r, 10.0, 90.01, -13.0, [0.03825, 0.0, 90.01]), "{r:?}");
    assert_eq!((r.intensity, r.ring, r.offset_ns), (77.0, 1, 2800));
    let mut bytes = RS16.packet();
    RS16.hit(&mut bytes, 2, 16 + 8, 2000);
    let r = only(&bytes, &Unit::default());
    // Laser 8 looks up by 15°; (55.5 + 22.4) of 111 us is 0.28° of 0.40°.
    assert!(at(r, 10.0, 90.8 + 0.28, 15.0, [0.03825, 0.0, 91.08]), "{r:?}");
    assert_eq!((r.ring, r.offset_ns), (15, 2 * 111_000 + 55_500 + 22_400));
}

#[test]
fn rs16_with_two_returns_fires_once_in_a_block() {
    let mut unit = vec![0; 1248];
    put(&mut unit, 0, &[0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55]);
    for laser in 0..16 {
        // 15.12°, 14.12°, ...: ten-thousandths of a degree, of which the first eight look down.
        let [_, a, b, c] = (151_200_u32 - 10_000 * laser).to_be_bytes();
        put(
            &mut unit,
            1165 + 3 * usize::try_from(laser).unwrap_or_default(),
            &[a, b, c],
        );
    }
    let mut told = Unit::default();
    told.take(&unit);
    let mut bytes = RS16.packet();
    RS16.hit(&mut bytes, 1, 3, 2000);
    RS16.hit(&mut bytes, 1, 16 + 3, 2000);
    let r = only(&bytes, &told);
    // 8.4 of 55.5 us is 0.06° of 0.40°.
    assert!(at(r, 10.0, 90.46, -12.12, [0.03825, 0.0, 90.46]), "{r:?}");
    assert_eq!(r.offset_ns, 55_500 + 8400);
    RS16.hit(&mut bytes, 1, 16 + 3, 2400);
    let returns = scan(&bytes, &told).map(|scan| scan.returns).unwrap_or_default();
    assert!(
        returns.len() == 2 && returns.iter().all(|r| r.offset_ns == 55_500 + 8400),
        "{returns:?}"
    );
}

#[test]
fn rs32_has_the_angles_of_its_info_packet() {
    let mut bytes = RS32.packet();
    RS32.hit(&mut bytes, 2, 17, 2000);
    // Thousandths of a degree: laser 17 at -0.7°, azimuth -0.1°; 4.32 of 55.52 us is 0.01° of 0.20°.
    let r = only(&bytes, &told(564, 32, 1));
    assert!(at(r, 10.0, 90.41 - 0.1, -0.7, [0.03997, 0.0, 90.41]), "{r:?}");
    assert_eq!((r.ring, r.offset_ns), (14, 2 * 55_520 + 4320));
    let untold = scan(&bytes, &Unit::default());
    assert_eq!(
        untold.clone().map_err(|error| error.to_string()).err().as_deref(),
        Some("a packet of a RS-LiDAR-32 whose angles are in a packet (DIFOP) that the recording does not have")
    );
    let all_alike = told(564, 0, 1);
    assert_eq!(scan(&bytes, &all_alike), untold);
}

#[test]
fn bpearl_looks_up_from_above_its_axis() {
    let mut bytes = BPEARL.packet();
    BPEARL.hit(&mut bytes, 11, 8, 2000);
    let r = only(&bytes, &Unit::default());
    // 89.5° - 8 * 2.8125°; the last firing of a packet turns as far as the others: 25.68 of 55.52 us is 0.09° of 0.20°.
    assert!(at(r, 10.0, 92.29, 67.0, [0.01473, 0.09427, 92.29]), "{r:?}");
    assert_eq!((r.ring, r.offset_ns), (23, 11 * 55_520 + 25_680));
    let mut bytes = BPEARL_4.packet();
    BPEARL_4.hit(&mut bytes, 0, 31, 4000);
    let r = only(&bytes, &told(564, 32, 1));
    // 51.708 of 55.56 us is 0.18° of 0.20°.
    assert!(at(r, 10.0, 90.18 - 1.0, -21.0, [0.01619, 0.09571, 90.18]), "{r:?}");
    // Turned the other way.
    let mut backwards = vec![0; 1248];
    put(&mut backwards, 0, &[0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55]);
    put(&mut backwards, 337, &[1]);
    let mut unit = Unit::default();
    unit.take(&backwards);
    let r = only(&bytes, &unit);
    assert!(
        at(r, 10.0, -90.18, 89.5 - 31.0 * 2.8125, [0.01619, 0.09571, -90.18]),
        "{r:?}"
    );
}

#[test]
fn second_returns_share_the_azimuth() {
    let mut bytes = HELIOS.packet();
    for (block, azimuth) in (0..12).zip([0, 0, 20, 20, 40, 40, 60, 60, 80, 80, 100, 100]) {
        HELIOS.turn_to(
            &mut bytes,
            block,
            35_960_u16 + azimuth - if azimuth >= 40 { 36_000 } else { 0 },
        );
    }
    HELIOS.hit(&mut bytes, 4, 2, 4000);
    HELIOS.hit(&mut bytes, 5, 2, 4000);
    let r = only(&bytes, &told(564, 32, 0));
    // 3.46 of 55.56 us is 0.01° of 0.20°.
    assert!(at(r, 10.0, 0.01 - 1.0, 8.0, [0.03498, 0.0, 0.01]), "{r:?}");
    assert_eq!(r.offset_ns, 2 * 55_560 + 3460);
    // A Ruby has three blocks: the first return of the next firing is alone.
    let mut bytes = RUBY.packet();
    RUBY.turn_to(&mut bytes, 1, 9000);
    RUBY.hit(&mut bytes, 2, 70, 2000);
    let r = only(&bytes, &told(852, 128, 3));
    // 3.236 of 55.55 us is 0.01° of 0.20°; the azimuth of the third block is 90.40° here: the next firing is 0.40° on.
    assert!(at(r, 10.0, 90.42 - 1.0, -60.0, [0.03615, 0.0, 90.42]), "{r:?}");
    assert_eq!(r.offset_ns, 55_550 + 3236);
}

#[test]
fn a_part_of_the_turn_that_is_left_out_takes_its_time() {
    let mut bytes = HELIOS.packet();
    for (block, azimuth) in (2..12).zip((27_020..).step_by(20)) {
        HELIOS.turn_to(&mut bytes, block, azimuth);
    }
    HELIOS.hit(&mut bytes, 1, 31, 4000);
    HELIOS.hit(&mut bytes, 2, 0, 4000);
    let returns = scan(&bytes, &told(564, 32, 4))
        .map(|scan| scan.returns)
        .unwrap_or_default();
    // From 90.20° to 270.20° in steps of 0.20°: 900 firings.
    let offsets: Vec<i64> = returns.iter().map(|r| r.offset_ns).collect();
    assert_eq!(offsets, [55_560 + 53_630, 901 * 55_560]);
    // Before it, the sensor turns as fast as elsewhere: 53.63 of 55.56 us is 0.19° of 0.20°.
    let first = returns.first().copied().unwrap_or_else(|| unreachable!());
    assert!(at(first, 10.0, 90.39 - 1.0, -21.0, [0.03498, 0.0, 90.39]), "{first:?}");
}

/// A packet of an M1 at the time of the others, its number, and a point in block 3.
fn solid(number: u16) -> Vec<u8> {
    let mut bytes = vec![0; 1210];
    put(&mut bytes, 0, &[0x55, 0xAA, 0x5A, 0xA5]);
    put(&mut bytes, 4, &number.to_be_bytes());
    put(&mut bytes, 10, SECONDS);
    // 2 ms / 10 after the packet; laser 4 at 10 m, 5.00° down and 30.00° to the left.
    let block = 32 + 3 * 47;
    put(&mut bytes, block, &[200, 1]);
    let point = [2000_u16, 32_768 - 500, 32_768 + 3000].map(u16::to_be_bytes).concat();
    put(&mut bytes, block + 2 + 4 * 9, &point);
    put(&mut bytes, block + 2 + 4 * 9 + 6, &[77]);
    bytes
}

#[test]
fn m1_sends_angles_with_each_point() {
    let r = only(&solid(1), &Unit::default());
    assert!(at(r, 10.0, -30.0, -5.0, [0.0; 3]), "{r:?}");
    assert_eq!((r.intensity, r.ring, r.offset_ns), (77.0, 4, 200_000));
    let cut = scan(solid(1).get(..1209).unwrap_or_default(), &Unit::default()).map_err(|error| error.to_string());
    assert_eq!(
        cut.err().as_deref(),
        Some("a packet of 1209 bytes, which is not the length of RS-LiDAR-M1")
    );
}

#[test]
fn scans_end_where_the_azimuth_passes_zero() {
    let mut scans = boundary(Maker::RoboSense);
    let at = |azimuth: u16| {
        let mut bytes = HELIOS.packet();
        HELIOS.turn_to(&mut bytes, 0, azimuth);
        bytes
    };
    let info = [[0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55].as_slice(), &[0; 1240]].concat();
    let packets = [at(35_700), at(35_940), info, at(180), at(420)];
    let begins: Vec<Option<bool>> = packets.iter().map(|bytes| scans.begins(bytes)).collect();
    assert_eq!(begins, [Some(false), Some(false), None, Some(true), Some(false)]);
    let mut scans = boundary(Maker::RoboSense);
    let begins = [629, 630, 1, 2].map(|n| scans.begins(&solid(n)) == Some(true));
    assert_eq!(begins, [false, false, true, false]);
}

#[test]
fn refuses_with_a_plain_sentence() {
    let refusal = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = HELIOS.packet();
        change(&mut bytes);
        scan(&bytes, &told(564, 32, 4)).map_or_else(|error| error.to_string(), |scan| scan.model.into_owned())
    };
    assert_eq!(refusal(&|_| ()), "RS-Helios");
    assert_eq!(
        refusal(&|b| put(b, 31, &[9, 1])),
        "a packet of 1248 bytes with the unknown model 0x901"
    );
    assert_eq!(
        refusal(&|b| put(b, 0, &[0])),
        "a packet of 1248 bytes that does not start as a data packet does"
    );
    assert_eq!(
        refusal(&|b| put(b, 42 + 300, &[0])),
        "a packet of a RS-Helios whose block 4 lacks its mark"
    );
    assert_eq!(
        refusal(&|b| put(b, 44, &[0x8C, 0xA1])),
        "a packet of a RS-Helios whose block 1 has an azimuth of 360.01 degrees"
    );
    assert_eq!(
        refusal(&|b| put(b, 26, &[0xFF])),
        "a packet of a RS-Helios whose time is no time"
    );
    assert_eq!(
        refusal(&|b| b.truncate(1200)),
        "a packet of 1200 bytes, which is not the length of a RoboSense data packet (1248 bytes)"
    );
    assert_eq!(scan(&[], &Unit::default()), Err(PacketError::NotData { bytes: 0 }));
}

#[test]
fn no_bytes_make_it_panic() {
    let mut state = 1_u32;
    for kind in ALL {
        let unit = told(564, 32, 0);
        for length in (0..=1250).step_by(7) {
            let mut bytes = kind.packet();
            bytes.resize(length, 0xFF);
            for _ in 0..8 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let [a, b, c, value] = state.to_be_bytes();
                put(&mut bytes, usize::from(u16::from_be_bytes([a, b]) % 1250), &[value, c]);
                let mut other = unit.clone();
                other.take(&bytes);
                let _ = (scan(&bytes, &unit), scan(&kind.packet(), &other));
            }
        }
    }
}
