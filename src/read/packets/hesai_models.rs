//! The models of Hesai: layout, angles and times of each, by its user manual.

use std::sync::OnceLock;

use super::PacketError;
use super::bytes::{u8_at, u16_at};
use super::turn::Direction;
use crate::tables::beams::hesai::{
    OT128_ANGLES, OT128_FAR_TIMES, PANDAR40P_ANGLES, PANDAR40P_TIMES, PANDAR64_ANGLES, PANDAR64_TIMES, QT64_ANGLES,
    QT64_TIMES, QT128_ANGLES, QT128_LOOP1, QT128_LOOP2, XT16_ANGLES, XT32_ANGLES, XT32M_ANGLES,
};

/// Layout, angles and times of one model. Times are nanoseconds.
pub(super) struct Model {
    pub(super) name: &'static str,
    pub(super) header_bytes: usize,
    /// Where the header has the unit of distance, millimetres.
    pub(super) unit_at: usize,
    pub(super) blocks: usize,
    /// Where in the block the azimuth is: after the mark 0xEEFF, if there is one.
    pub(super) azimuth_at: usize,
    /// Whether byte 11 of the header has flags, among them 0x04 for functional safety.
    pub(super) flags: bool,
    /// Bytes of a channel (distance in two, reflectivity, more by the flags); None where the flags say that the channels
    /// are not in their usual order.
    pub(super) channel_bytes: fn(u8) -> Option<usize>,
    pub(super) tail: Tail,
    /// The least distance as sent that is a return.
    pub(super) least: u16,
    /// (elevation, azimuth offset), degrees, by channel.
    pub(super) angles: &'static [(f32, f32)],
    /// What the tail says of the firing order.
    pub(super) order: fn(&[u8]) -> u32,
    /// From the packet's time to a shot, by its number, the number of shots and the firing order.
    pub(super) shot_ns: fn(usize, usize, u32) -> i64,
    /// The column of firing times that holds for a shot, by its number and the firing order.
    pub(super) column: fn(usize, u32) -> usize,
    /// Firing time after the shot, by column and channel.
    fire_ns: fn(usize, usize) -> i64,
    /// Place among the models.
    number: usize,
}

/// The beams of each model by column, once they are needed.
static BEAMS: [[OnceLock<Vec<Beam>>; 5]; 8] = [const { [const { OnceLock::new() }; 5] }; 8];

/// Where the tail has the return mode, the date (six bytes) and the microseconds of the second (four bytes).
pub(super) struct Tail {
    pub(super) mode: usize,
    pub(super) date: usize,
    pub(super) clock: usize,
}

/// A channel's direction and time.
pub(super) struct Beam {
    pub(super) elevation: Direction,
    pub(super) azimuth: Direction,
    pub(super) fire_ns: i64,
}

impl Model {
    /// The channels with the firing times of a column.
    pub(super) fn beams(&self, column: usize) -> &'static [Beam] {
        let Some(beams) = BEAMS.get(self.number).and_then(|columns| columns.get(column)) else {
            return &[];
        };
        beams.get_or_init(|| {
            let beam = |(channel, &(elevation, azimuth)): (usize, &(f32, f32))| Beam {
                elevation: Direction::of(f64::from(elevation)),
                azimuth: Direction::of(f64::from(azimuth)),
                fire_ns: (self.fire_ns)(column, channel),
            };
            self.angles.iter().enumerate().map(beam).collect()
        })
    }
}

/// The model of a packet, by its first bytes: 0xFFEE and the length (Pandar40P), else 0xEEFF and either the numbers of
/// channels and blocks (Pandar64) or the version of the protocol and those numbers.
pub(super) fn model_of(bytes: &[u8]) -> Result<&'static Model, PacketError> {
    let length = bytes.len();
    let (Some(mark), Some(versions)) = (u16_at(bytes, 0), bytes.get(2..8)) else {
        return Err(PacketError::NotData { bytes: length });
    };
    match (mark, versions) {
        (0xEEFF, _) if length == 1262 || length == 1266 => Ok(&PANDAR40P),
        (0xEEFF, _) => Err(PacketError::Length {
            bytes: length,
            of: PANDAR40P.name,
        }),
        (0xFFEE, &[64, 6, ..]) => Ok(&PANDAR64),
        (0xFFEE, &[3, 1, _, _, 64, 4]) => Ok(&QT64),
        (0xFFEE, &[3, 2, _, _, 128, 2]) => Ok(&QT128),
        (0xFFEE, &[6, 1, _, _, 16, 8]) => Ok(&XT16),
        (0xFFEE, &[6, 1, _, _, 32, 8]) => Ok(&XT32),
        (0xFFEE, &[6, 1, _, _, 32, 6]) => Ok(&XT32M),
        // The fifth byte of a packet of the Pandar128 is lower, of the JT128 higher.
        (0xFFEE, &[1, 4, 128..=136, _, 128, 2]) => Ok(&OT128),
        (0xFFEE, &[major, minor, ..]) => Err(PacketError::Model {
            bytes: length,
            id: u16::from_be_bytes([major, minor]),
        }),
        _ => Err(PacketError::NotData { bytes: length }),
    }
}

/// A number of a table or of shots as a time.
fn ns(number: usize) -> i64 {
    i64::try_from(number).unwrap_or_default()
}

fn entry(table: &[i32], channel: usize) -> i64 {
    table.get(channel).copied().map_or(0, i64::from)
}

const fn tail(mode: usize, date: usize, clock: usize) -> Tail {
    Tail { mode, date, clock }
}

static PANDAR40P: Model = BASE;

/// What most models have in common, and the Pandar40P.
const BASE: Model = Model {
    name: "Pandar40P",
    header_bytes: 0,
    unit_at: 0,
    blocks: 10,
    azimuth_at: 2,
    flags: false,
    channel_bytes: |_| Some(3),
    tail: tail(14, 16, 10),
    least: 1,
    angles: &PANDAR40P_ANGLES,
    order: |_| 0,
    shot_ns: |shot, shots, _| -28_580 - 55_560 * ns(shots - 1 - shot),
    column: |_, _| 0,
    fire_ns: |_, channel| entry(&PANDAR40P_TIMES, channel),
    number: 0,
};

static PANDAR64: Model = Model {
    name: "Pandar64",
    header_bytes: 8,
    unit_at: 5,
    blocks: 6,
    azimuth_at: 0,
    angles: &PANDAR64_ANGLES,
    shot_ns: |shot, shots, _| -42_580 - 55_560 * ns(shots - 1 - shot),
    fire_ns: |_, channel| entry(&PANDAR64_TIMES, channel),
    number: 1,
    ..BASE
};

static QT64: Model = Model {
    name: "PandarQT64",
    blocks: 4,
    tail: tail(16, 18, 12),
    angles: &QT64_ANGLES,
    shot_ns: |shot, _, _| 25_710 + 500_000 * ns(shot) / 3,
    fire_ns: |_, channel| entry(&QT64_TIMES, channel),
    number: 2,
    ..XT
};

/// The channels fire in two orders by turns; the tail says which one is first.
static QT128: Model = Model {
    name: "PandarQT128",
    blocks: 2,
    flags: true,
    channel_bytes: |flags| (flags & 0x40 == 0).then_some(3 + usize::from(flags >> 4 & 1)),
    tail: tail(12, 15, 21),
    angles: &QT128_ANGLES,
    order: |tail| u8_at(tail, 5).map_or(0, u32::from),
    shot_ns: |shot, _, _| 9000 + 111_110 * ns(shot),
    column: |shot, order| (shot + usize::from(order % 2 == 0)) % 2,
    fire_ns: |column, channel| entry(if column == 0 { &QT128_LOOP1 } else { &QT128_LOOP2 }, channel),
    number: 3,
    ..XT
};

static XT16: Model = Model {
    name: "PandarXT16",
    angles: &XT16_ANGLES,
    fire_ns: |_, channel| 368 + 3024 * ns(channel),
    number: 4,
    ..XT
};

static XT32: Model = XT;

/// What the models with a header of twelve bytes have in common, and the PandarXT32.
const XT: Model = Model {
    name: "PandarXT32",
    header_bytes: 12,
    unit_at: 9,
    blocks: 8,
    azimuth_at: 0,
    channel_bytes: |_| Some(4),
    tail: tail(10, 13, 19),
    angles: &XT32_ANGLES,
    shot_ns: |shot, shots, _| 5632 - 50_000 * ns(shots - 1 - shot),
    fire_ns: |_, channel| 368 + 1512 * ns(channel),
    number: 5,
    ..BASE
};

/// The upper and the lower half of the channels fire at once.
static XT32M: Model = Model {
    name: "PandarXT32M",
    blocks: 6,
    angles: &XT32M_ANGLES,
    fire_ns: |_, channel| 368 + 2888 * ns(channel % 16),
    number: 6,
    ..XT
};

/// Also named OT128. Distances 0 to 3 are codes of what was not received.
static OT128: Model = Model {
    name: "Pandar128E4X",
    blocks: 2,
    flags: true,
    // Confidence, weight and ambient light, where there are any.
    channel_bytes: |flags| (flags & 0x70).count_ones().try_into().ok().map(|more: usize| 3 + more),
    tail: tail(12, 15, 21),
    least: 4,
    angles: &OT128_ANGLES,
    order: |tail| u32::from(u8_at(tail, 11).unwrap_or_default()) << 16 | u32::from(u16_at(tail, 9).unwrap_or_default()),
    shot_ns: |shot, shots, order| -27_778 * ns(shots - 1 - shot) * if order >> 16 == 0 { 1 } else { 2 },
    column: ot128_column,
    fire_ns: ot128_fire_ns,
    number: 7,
    ..XT
};

/// The columns of the OT128's firing times: high resolution with the azimuth states 0, 1 or 3, 2; standard resolution with
/// the azimuth states 0, 1. The tail has the state in two bits by block, the first block's highest.
fn ot128_column(shot: usize, order: u32) -> usize {
    let state = order >> (14 - 2 * shot.min(7)) & 3;
    match (order >> 16, state) {
        (0, 0) => 0,
        (0, 2) => 2,
        (0, _) => 1,
        (_, 0) => 3,
        _ => 4,
    }
}

/// The OT128's firing times, which the manual tabulates by state: outside the channels 25 to 88 they follow a pattern of
/// eight channels, of which two pairs fire half a shot after the others (at high resolution: in the other azimuth states).
/// In the second half of a turn's states the late channels fire 2.144 us later.
fn ot128_fire_ns(column: usize, channel: usize) -> i64 {
    let far = channel.checked_sub(24).and_then(|far| OT128_FAR_TIMES.get(far));
    let (time, second_half) = match far {
        Some(time) => (i64::from(*time), false),
        None => (6289 * (3 - ns(channel / 4 % 2 + channel % 2 * 2)), channel % 4 < 2),
    };
    let late = if matches!(column, 2 | 4) && !second_half && time > 11_000 {
        2144
    } else {
        0
    };
    let half = if column > 2 && second_half { 27_778 } else { 0 };
    time + late + half
}
