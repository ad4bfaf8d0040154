//! The models of RoboSense: how to tell them apart, where their packets have what, and their angles where all sensors of a model share them.
//!
//! Sources: github.com/RoboSense-LiDAR/rs_driver at 4eeadac, one `decoder_*.hpp` for each; the numbers of the models are those of the user
//! manuals (tables of the MSOP header: RS-Helios-1610 6.2.1, RS-Helios-16P 6.2.1, RS-Ruby Plus 5.2.1).

use super::PacketError;
use super::bytes::{u8_at, u16_be, u32_be};
use super::date::seconds_of;
use super::robosense_tables::{BPEARL, RS32, RUBY_LITE, RUBY_PLUS, RUBY_PLUS_80, RUBY_PLUS_80V};

/// How a data packet starts: the first generation (RS-LiDAR-16 and -32, Bpearl), the second (Ruby, Helios), and those that do not turn (M1).
const FIRST: [u8; 8] = [0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0];
const SECOND: [u8; 4] = [0x55, 0xAA, 0x05, 0x5A];
const SOLID: [u8; 4] = [0x55, 0xAA, 0x5A, 0xA5];
/// How a packet that describes the sensor starts.
const INFO: [u8; 8] = [0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55];
/// Bytes of every packet of the sensors that turn, and of a data packet of an M1.
pub(super) const BYTES: usize = 1248;
pub(super) const SOLID_BYTES: usize = 1210;
/// Bytes of an info packet of the sensors that do not turn.
const SOLID_INFO_BYTES: usize = 256;

/// What kind of clock is in the header.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Clock {
    /// Year since 2000, month, day, hour, minute, second, and two bytes each of milliseconds and microseconds.
    Date,
    /// Six bytes of seconds since 1970, four of microseconds.
    Seconds,
}

/// When the channels of a block fire, nanoseconds.
#[derive(Clone, Copy)]
pub(super) enum Fire {
    /// One after another.
    Every(u32),
    /// Four of each half of the lasers at once, one group after another.
    Fours(u32),
    /// By a table.
    At(&'static [u16]),
}

/// Where the info packet has the angles: of the elevations and azimuths, and one unit of them in degrees.
#[derive(Clone, Copy)]
pub(super) enum Told {
    /// Elevations of three bytes without sign, of which the first half point down.
    Halves { at: usize },
    /// A sign and two bytes each.
    Signed { at: usize, azimuths_at: usize, unit: f64 },
}

pub(super) struct Model {
    pub(super) name: &'static str,
    pub(super) header_bytes: usize,
    pub(super) clock: Clock,
    pub(super) clock_at: usize,
    pub(super) blocks: usize,
    /// The first bytes of a block: two, or one before the number of the return.
    pub(super) mark: &'static [u8],
    /// Distances in a block; fewer lasers fire several times.
    pub(super) channels: usize,
    pub(super) lasers: usize,
    /// Metres of one unit of distance.
    pub(super) unit: f32,
    /// From the axis of rotation to the lens along the beam's azimuth, and up, metres.
    pub(super) lens: [f32; 2],
    /// From one firing of all lasers to the next, nanoseconds.
    pub(super) cycle_ns: u32,
    pub(super) fire: Fire,
    pub(super) told: Told,
    /// Elevations in degrees by laser, where those of a single sensor are near them.
    pub(super) nominal: Option<fn(usize) -> f64>,
}

impl Model {
    /// When a channel of a block fires.
    pub(super) fn fire_ns(&self, channel: usize) -> u32 {
        match self.fire {
            Fire::Every(step) => {
                let (cycle, laser) = (channel / self.lasers, channel % self.lasers);
                u32::try_from(cycle).unwrap_or(0) * self.cycle_ns + u32::try_from(laser).unwrap_or(0) * step
            }
            Fire::Fours(step) => u32::try_from(channel % (self.lasers / 2) / 4).unwrap_or(0) * step,
            Fire::At(table) => table.get(channel).copied().map_or(0, u32::from),
        }
    }

    pub(super) fn block_bytes(&self) -> usize {
        4 + 3 * self.channels
    }
}

/// Whether a packet describes the sensor.
pub(super) fn is_info(bytes: &[u8]) -> bool {
    bytes.starts_with(&INFO) && [BYTES, SOLID_INFO_BYTES].contains(&bytes.len())
}

/// Whether a packet has points of a sensor that does not turn.
pub(super) fn is_solid(bytes: &[u8]) -> bool {
    bytes.starts_with(&SOLID)
}

/// Whether a packet is one of RoboSense.
pub(super) fn is_robosense(bytes: &[u8]) -> bool {
    is_info(bytes) || is_solid(bytes) || bytes.starts_with(&SECOND) || bytes.starts_with(&FIRST)
}

/// The model of a packet of a sensor that turns.
pub(super) fn model_of(bytes: &[u8]) -> Result<&'static Model, PacketError> {
    let first = bytes.starts_with(&FIRST);
    if !first && !bytes.starts_with(&SECOND) {
        return Err(PacketError::NotData { bytes: bytes.len() });
    }
    if bytes.len() != BYTES {
        return Err(PacketError::Length {
            bytes: bytes.len(),
            of: "a RoboSense data packet (1248 bytes)",
        });
    }
    let at = |at: usize| u8_at(bytes, at).unwrap_or_default();
    let [old, series, model] = [at(30), at(31), at(32)];
    let begins = |at: usize, mark: &[u8]| bytes.get(at..).is_some_and(|rest| rest.starts_with(mark));
    let found = if first {
        match (old, series, model) {
            (_, 3, 4) => Some(&BPEARL_4),
            (1, ..) | (0, 1, _) => Some(&RS_16),
            (2, ..) | (0, 2, _) => Some(&RS_32),
            (3, ..) | (0, 3, _) => Some(&BPEARL_3),
            _ => None,
        }
    } else if begins(HELIOS.header_bytes, HELIOS.mark) {
        match (series, model) {
            (6, 3) => Some(&HELIOS_16P),
            (6, _) => Some(&HELIOS),
            _ => None,
        }
    } else {
        let two = |model: &'static Model| begins(model.header_bytes + model.block_bytes(), model.mark).then_some(model);
        match (series, model) {
            (5, 1) => Some(&RUBY_PLUS_128),
            (5, 2) => Some(&RUBY_80),
            (5, 3) => Some(&RUBY_80V),
            (5, _) => None,
            // The first Ruby names no model: the place of the second block tells it.
            _ => two(&RUBY).or_else(|| two(&LITE)),
        }
    };
    found.ok_or(PacketError::Model {
        bytes: bytes.len(),
        id: u16::from_be_bytes([series.max(old), model]),
    })
}

const RS_16: Model = Model {
    name: "RS-LiDAR-16",
    header_bytes: 42,
    clock: Clock::Date,
    clock_at: 20,
    blocks: 12,
    mark: &[0xFF, 0xEE],
    channels: 32,
    lasers: 16,
    unit: 0.005,
    lens: [0.038_25, 0.0],
    cycle_ns: 55_500,
    fire: Fire::Every(2800),
    told: Told::Halves { at: 1165 },
    // User manual, table of channels and vertical angles.
    nominal: Some(|laser| {
        let step = 2.0 * small(laser % 8) - 15.0;
        if laser < 8 { step } else { -step }
    }),
};

const RS_32: Model = Model {
    name: "RS-LiDAR-32",
    lasers: 32,
    lens: [0.039_97, 0.0],
    cycle_ns: 55_520,
    fire: Fire::At(&RS32),
    told: Told::Signed {
        at: 468,
        azimuths_at: 564,
        unit: 0.001,
    },
    // The manual has two orders of channels, and which one a sensor has is not in its data packets.
    nominal: None,
    ..RS_16
};

const BPEARL_3: Model = Model {
    name: "RS-Bpearl",
    lens: [0.014_73, 0.094_27],
    fire: Fire::At(&BPEARL),
    told: HUNDREDTHS,
    // github.com/RoboSense-LiDAR/ros_rslidar, data/rs_bpearl/angle.csv.
    nominal: Some(|laser| 89.5 - 2.8125 * small(laser)),
    ..RS_32
};

const BPEARL_4: Model = Model {
    name: "RS-Bpearl v4",
    clock: Clock::Seconds,
    unit: 0.0025,
    lens: [0.016_19, 0.095_71],
    cycle_ns: 55_560,
    fire: Fire::Every(1668),
    ..BPEARL_3
};

const HELIOS: Model = Model {
    name: "RS-Helios",
    clock: Clock::Seconds,
    unit: 0.0025,
    lens: [0.034_98, 0.0],
    cycle_ns: 55_560,
    fire: Fire::Every(1730),
    told: HUNDREDTHS,
    ..RS_32
};

const HELIOS_16P: Model = Model {
    name: "RS-Helios-16P",
    lasers: 16,
    ..HELIOS
};

const RUBY: Model = Model {
    name: "RS-Ruby",
    header_bytes: 80,
    clock: Clock::Seconds,
    clock_at: 10,
    blocks: 3,
    mark: &[0xFE],
    channels: 128,
    lasers: 128,
    lens: [0.036_15, 0.0],
    cycle_ns: 55_550,
    fire: Fire::Fours(3236),
    told: Told::Signed {
        at: 468,
        azimuths_at: 852,
        unit: 0.01,
    },
    ..RS_32
};

const LITE: Model = Model {
    name: "RS-Ruby Lite",
    blocks: 4,
    channels: 80,
    lasers: 80,
    cycle_ns: 55_552,
    fire: Fire::At(&RUBY_LITE),
    ..RUBY
};

const RUBY_PLUS_128: Model = Model {
    name: "RS-Ruby Plus",
    lens: [0.028_92, 0.0],
    cycle_ns: 55_560,
    fire: Fire::At(&RUBY_PLUS),
    ..RUBY
};

const RUBY_80: Model = Model {
    name: "RS-Ruby Plus 80",
    lens: [0.028_92, 0.0],
    cycle_ns: 55_560,
    fire: Fire::At(&RUBY_PLUS_80),
    ..LITE
};

const RUBY_80V: Model = Model {
    name: "RS-Ruby Plus 80V",
    fire: Fire::At(&RUBY_PLUS_80V),
    ..RUBY_80
};

const HUNDREDTHS: Told = Told::Signed {
    at: 468,
    azimuths_at: 564,
    unit: 0.01,
};

#[expect(clippy::cast_precision_loss, reason = "numbers of lasers")]
fn small(number: usize) -> f64 {
    number as f64
}

/// The time from a place of a packet, nanoseconds since 1970.
pub(super) fn clock(clock: Clock, bytes: &[u8], at: usize) -> Option<i64> {
    let (seconds, micros) = match clock {
        Clock::Date => {
            let [year, rest @ ..] = *bytes.get(at..)?.first_chunk::<6>()?;
            let [month, day, hour, minute, second] = rest;
            let (millis, micros) = (u16_be(bytes, at + 6)?, u16_be(bytes, at + 8)?);
            // The years of the function count from 1900.
            let date = [year.checked_add(100)?, month, day, hour, minute, second];
            (seconds_of(date)?, 1000 * i64::from(millis) + i64::from(micros))
        }
        Clock::Seconds => {
            let seconds = (i64::from(u16_be(bytes, at)?) << 32) + i64::from(u32_be(bytes, at + 2)?);
            (seconds, i64::from(u32_be(bytes, at + 6)?))
        }
    };
    let whole_ns = seconds.checked_mul(1_000_000_000)?;
    (micros <= 1_000_000).then(|| whole_ns.saturating_add(1000 * micros))
}
