//! Packets of Hesai built here, and the points and times that the user manuals' arithmetic gives by hand.

use super::date::seconds_of;
use super::{Maker, Packet, PacketError, Return, Scan, decode};

/// How a test builds the packet of a model.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    header: &'static [u8],
    mark: bool,
    channels: usize,
    channel_bytes: usize,
    blocks: usize,
    /// Bytes between the body and the tail, and places in the tail of mode, date and clock, and the tail's length.
    gap: usize,
    tail: [usize; 4],
    unit: f64,
}

const XT32: Kind = Kind {
    name: "PandarXT32",
    header: &[0xEE, 0xFF, 6, 1, 0, 0, 32, 8, 1, 4, 2, 1],
    mark: false,
    channels: 32,
    channel_bytes: 4,
    blocks: 8,
    gap: 0,
    tail: [10, 13, 19, 28],
    unit: 0.004,
};
const XT16: Kind = Kind {
    name: "PandarXT16",
    header: &[0xEE, 0xFF, 6, 1, 0, 0, 16, 8, 1, 4, 2, 1],
    channels: 16,
    ..XT32
};
const XT32M: Kind = Kind {
    name: "PandarXT32M",
    header: &[0xEE, 0xFF, 6, 1, 0, 0, 32, 6, 1, 5, 3, 1],
    blocks: 6,
    unit: 0.005,
    ..XT32
};
const PANDAR40P: Kind = Kind {
    name: "Pandar40P",
    header: &[],
    mark: true,
    channels: 40,
    channel_bytes: 3,
    blocks: 10,
    tail: [14, 16, 10, 22],
    ..XT32
};
const PANDAR64: Kind = Kind {
    name: "Pandar64",
    header: &[0xEE, 0xFF, 64, 6, 0, 4, 0, 0],
    mark: false,
    channels: 64,
    blocks: 6,
    ..PANDAR40P
};
const QT64: Kind = Kind {
    name: "PandarQT64",
    header: &[0xEE, 0xFF, 3, 1, 0, 0, 64, 4, 1, 4, 2, 1],
    channels: 64,
    blocks: 4,
    tail: [16, 18, 12, 28],
    ..XT32
};
const QT128: Kind = Kind {
    name: "PandarQT128",
    header: &[0xEE, 0xFF, 3, 2, 3, 0, 128, 2, 1, 4, 2, 0x1D],
    channels: 128,
    blocks: 2,
    gap: 21,
    tail: [12, 15, 21, 34],
    ..XT32
};
const OT128: Kind = Kind {
    name: "Pandar128E4X",
    header: &[0xEE, 0xFF, 1, 4, 128, 0, 128, 2, 1, 4, 2, 0x05],
    channel_bytes: 3,
    ..QT128
};
/// With confidence and ambient light, without functional safety.
const OT128_MORE: Kind = Kind {
    header: &[0xEE, 0xFF, 1, 4, 130, 0, 128, 2, 1, 4, 2, 0x51],
    channel_bytes: 5,
    gap: 4,
    ..OT128
};

impl Kind {
    fn block_bytes(self) -> usize {
        2 + 2 * usize::from(self.mark) + self.channels * self.channel_bytes
    }

    fn tail_at(self) -> usize {
        self.header.len() + self.blocks * self.block_bytes() + self.gap
    }

    /// A packet of 2020-06-25 12:02:09.000100 without returns, at azimuth 30.00°.
    fn packet(self, mode: u8) -> Vec<u8> {
        let mut bytes = self.header.to_vec();
        for _ in 0..self.blocks {
            bytes.extend([0xFF, 0xEE].iter().take(2 * usize::from(self.mark)));
            bytes.extend(3000_u16.to_le_bytes());
            bytes.resize(bytes.len() + self.channels * self.channel_bytes, 0);
        }
        let [mode_at, date_at, clock_at, length] = self.tail;
        bytes.resize(self.tail_at() + length, 0);
        put(&mut bytes, self.tail_at() + mode_at, &[mode]);
        put(&mut bytes, self.tail_at() + date_at, &[120, 6, 25, 12, 2, 9]);
        put(&mut bytes, self.tail_at() + clock_at, &100_u32.to_le_bytes());
        bytes
    }

    /// Sets the distance (as sent) of a channel (from 1, as the manual counts); the reflectivity is 77.
    fn hit(self, bytes: &mut [u8], block: usize, channel: usize, sent: u16) {
        let first = self.header.len() + 2 + 2 * usize::from(self.mark);
        let [low, high] = sent.to_le_bytes();
        put(
            bytes,
            first + block * self.block_bytes() + (channel - 1) * self.channel_bytes,
            &[low, high, 77],
        );
    }

    /// The one return of a packet with one hit of 2500 units, and whether it is where the angles say.
    fn point(self, mode: u8, block: usize, channel: usize, angles: (f64, f64)) -> Return {
        let mut bytes = self.packet(mode);
        self.hit(&mut bytes, block, channel, 2500);
        let scan = scan(&bytes).unwrap_or_else(|error| unreachable!("{error}"));
        assert_eq!((&*scan.model, scan.returns.len()), (self.name, 1));
        assert_eq!(scan.start_ns, Some(1_593_086_529_000_100_000));
        let r = scan.returns.first().copied().unwrap_or_else(|| unreachable!());
        let (elevation, azimuth) = (angles.0.to_radians(), (30.0 + angles.1).to_radians());
        let level = 2500.0 * self.unit * elevation.cos();
        let by_hand = [
            level * azimuth.sin(),
            level * azimuth.cos(),
            2500.0 * self.unit * elevation.sin(),
        ];
        let near = by_hand
            .iter()
            .zip([r.x, r.y, r.z])
            .all(|(hand, ours)| (hand - f64::from(ours)).abs() < 1e-4);
        assert!(near, "{}: {by_hand:?} by hand, {r:?}", self.name);
        assert_eq!((r.intensity, usize::from(r.ring)), (77.0, channel - 1));
        r
    }
}

fn put(bytes: &mut [u8], at: usize, values: &[u8]) {
    for (byte, value) in bytes.iter_mut().skip(at).zip(values) {
        *byte = *value;
    }
}

fn scan(bytes: &[u8]) -> Result<Scan, PacketError> {
    decode(Maker::Hesai, [Packet { received_ns: 1, bytes }].into_iter())
}

#[test]
fn points_and_times_by_hand() {
    // Block 3 of 10: six more single shots, three more dual ones, follow before the packet's time.
    let t = |r: Return| r.offset_ns;
    assert_eq!(
        t(PANDAR40P.point(0x37, 3, 40, (-24.985, -1.042))),
        -28_580 - 6 * 55_560 - 3620
    );
    assert_eq!(
        t(PANDAR40P.point(0x39, 3, 8, (1.263, -5.208))),
        -28_580 - 3 * 55_560 - 54_670
    );
    assert_eq!(t(PANDAR64.point(0x38, 5, 1, (14.9, -1.042))), -42_580 - 23_180);
    assert_eq!(
        t(PANDAR64.point(0x39, 1, 9, (1.54, 5.208))),
        -42_580 - 2 * 55_560 - 7532
    );
    // 25.71 + 166.67 + 10 + 119.60 us
    assert_eq!(t(QT64.point(0x3B, 2, 56, (36.064, -5.974))), 25_710 + 166_666 + 129_600);
    assert_eq!(
        t(XT16.point(0x37, 0, 16, (-15.0, 0.0))),
        5632 - 7 * 50_000 + 368 + 15 * 3024
    );
    assert_eq!(t(XT32.point(0x39, 7, 2, (13.9524, 0.0765))), 5632 + 368 + 1512);
    // Channel 18 fires with channel 2.
    assert_eq!(
        t(XT32M.point(0x3D, 1, 18, (-2.605, -0.049))),
        5632 - 50_000 + 368 + 2888
    );
    assert_eq!(t(XT32M.point(0x37, 0, 1, (19.407, 0.094))), 5632 - 5 * 50_000 + 368);
}

#[test]
fn qt128_takes_turns() {
    // The mode flag is even: loop 2 comes first, loop 1 in the second shot.
    assert_eq!(QT128.point(0x37, 0, 1, (-52.6268, 10.1083)).offset_ns, 9000 + 2312);
    assert_eq!(
        QT128.point(0x37, 1, 99, (20.9259, -6.3230)).offset_ns,
        9000 + 111_110 + 600
    );
    // Both blocks of a dual return are one shot.
    assert_eq!(QT128.point(0x39, 1, 65, (7.9098, 5.9491)).offset_ns, 9000 + 600);
}

#[test]
fn ot128_by_state() {
    let time = |running: u8, states: u16, block: usize, channel: usize| {
        let mut bytes = OT128.packet(0x37);
        put(&mut bytes, OT128.tail_at() + 9, &states.to_le_bytes());
        put(&mut bytes, OT128.tail_at() + 11, &[running]);
        OT128.hit(&mut bytes, block, channel, 2500);
        scan(&bytes)
            .ok()
            .and_then(|scan| scan.returns.first().map(|r| r.offset_ns))
    };
    OT128.point(0x37, 1, 1, (15.139, 0.157));
    OT128_MORE.point(0x39, 1, 26, (1.967, 1.374));
    // High resolution, states 0, 1, 2 and 3 of the second block.
    assert_eq!(time(0, 0, 1, 3), Some(18_867));
    assert_eq!(time(0, 0x1000, 1, 2), Some(6289));
    assert_eq!(time(0, 0x2000, 1, 15), Some(12_578 + 2144));
    assert_eq!(time(0, 0x2000, 1, 26), Some(16_549 + 2144));
    assert_eq!(time(0, 0x3000, 1, 88), Some(22_838));
    assert_eq!(time(0, 0x3000, 0, 88), Some(22_838 - 27_778));
    // Standard resolution: shots are twice as far apart.
    assert_eq!(time(2, 0, 1, 1), Some(18_867 + 27_778));
    assert_eq!(time(2, 0x1000, 1, 11), Some(21_011));
    assert_eq!(time(2, 0, 0, 128), Some(-2 * 27_778));
    // Distances 1 to 3 are codes.
    let mut bytes = OT128.packet(0x37);
    OT128.hit(&mut bytes, 0, 1, 3);
    assert_eq!(scan(&bytes).map(|scan| scan.returns.len()), Ok(0));
}

#[test]
fn repeated_returns_are_dropped() {
    let count = |mode, sent: [u16; 3]| {
        let mut bytes = XT32M.packet(mode);
        for (block, sent) in sent.into_iter().enumerate() {
            XT32M.hit(&mut bytes, block, 5, sent);
        }
        scan(&bytes).map(|scan| scan.returns.len())
    };
    assert_eq!(count(0x37, [900, 900, 900]), Ok(3));
    assert_eq!(count(0x39, [900, 900, 900]), Ok(2));
    assert_eq!(count(0x3D, [900, 900, 900]), Ok(1));
    assert_eq!(count(0x3D, [900, 901, 900]), Ok(2));
    assert_eq!(count(0x39, [900, 901, 0]), Ok(2));
}

#[test]
fn dates() {
    assert_eq!(seconds_of([17, 9, 6, 16, 19, 46]), Some(1_504_714_786));
    assert_eq!(seconds_of([119, 7, 25, 3, 19, 29]), Some(1_564_024_769));
    assert_eq!(seconds_of([124, 2, 29, 0, 0, 0]), Some(1_709_164_800));
    assert_eq!(seconds_of([0, 0, 0x67, 0x21, 0xE1, 0xFC]), Some(0x6721_E1FC));
    assert_eq!(seconds_of([123, 13, 1, 0, 0, 0]), None);
    assert_eq!(seconds_of([123, 1, 1, 24, 0, 0]), None);
}

#[test]
fn refuses_with_a_plain_sentence() {
    let refusal = |kind: Kind, change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = kind.packet(0x37);
        change(&mut bytes);
        scan(&bytes).map_or_else(|error| error.to_string(), |scan| scan.model.into_owned())
    };
    let version = refusal(XT32, &|b| put(b, 2, &[4, 7]));
    assert_eq!(
        version,
        format!(
            "a packet of {} bytes with the unknown model 0x407",
            XT32.packet(0x37).len()
        )
    );
    // The Pandar128 has the OT128's version.
    assert!(refusal(OT128, &|b| put(b, 4, &[0])).ends_with("unknown model 0x104"));
    assert_eq!(
        refusal(PANDAR40P, &|b| b.truncate(900)),
        "a packet of 900 bytes, which is not the length of Pandar40P"
    );
    assert_eq!(
        refusal(QT64, &|b| b.truncate(900)),
        "a packet of 900 bytes, which is not the length of PandarQT64"
    );
    assert_eq!(
        refusal(PANDAR40P, &|b| put(b, 124, &[0])),
        "a packet of a Pandar40P whose block 2 lacks its mark"
    );
    let azimuth = refusal(XT16, &|b| put(b, 12, &[0xA0, 0x8C]));
    assert_eq!(
        azimuth,
        "a packet of a PandarXT16 whose block 1 has an azimuth of 360.00 degrees"
    );
    let mode = refusal(PANDAR64, &|b| put(b, PANDAR64.tail_at() + 14, &[1]));
    assert_eq!(mode, "a packet of a Pandar64 with the unknown return mode 0x01");
    let time = "a packet of a PandarXT32 whose time is no time";
    assert_eq!(refusal(XT32, &|b| put(b, XT32.tail_at() + 14, &[13])), time);
    assert_eq!(
        refusal(XT32, &|b| put(b, XT32.tail_at() + 13, &[0, 255, 255, 255, 255, 255])),
        time
    );
    let configured = refusal(QT128, &|b| put(b, 11, &[0x5D]));
    assert_eq!(
        configured,
        "a packet of a PandarQT128 whose channels follow a configuration of its own"
    );
    assert!(refusal(XT32, &|b| b.truncate(7)).contains("does not start"));
}

#[test]
fn no_bytes_make_it_panic() {
    let mut state = 1_u32;
    for kind in [PANDAR40P, PANDAR64, QT64, QT128, XT16, XT32, XT32M, OT128] {
        let whole = kind.packet(0x39);
        for length in 0..whole.len() + 8 {
            let mut bytes = whole.clone();
            bytes.resize(length, 0xFF);
            let _ = scan(&bytes);
            for _ in 0..4 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let [a, b, c, value] = state.to_be_bytes();
                put(
                    &mut bytes,
                    usize::from(u16::from_be_bytes([a, b])) % (length + 1),
                    &[value, c],
                );
            }
            let _ = scan(&bytes);
        }
    }
}
