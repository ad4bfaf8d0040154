//! Hesai's AT128, whose mirrors turn behind fixed lasers: every sensor has its own angles, in a file of corrections.
//!
//! Source: github.com/tier4/nebula at 606ac41: `hesai_common.hpp` (HesaiCorrection), `angle_corrector_correction_based.hpp`,
//! `pandar_at128.hpp`. Only version 1.5 of the file is read; nebula has no working reader of an older one.

use super::bytes::{u8_at, u16_at, u32_at};
use super::date::seconds_of;
use super::turn::Direction;
use super::{PacketError, Return};

pub(super) const NAME: &str = "PandarAT128";
const CHANNELS: usize = 128;
/// How a file and a packet begin.
const FILE: [u8; 5] = [0xEE, 0xFF, 1, 5, 128];
const PACKET: [u8; 4] = [0xEE, 0xFF, 4, 3];
/// Of a file: bytes before the fields of view, and adjustments for each channel, one for two degrees.
const FILE_HEADER: usize = 16;
const ADJUSTMENTS: usize = 180;
/// Of a packet: bytes before the blocks, of a block (azimuth, its finer part, channels), and before the tail.
const HEADER: usize = 12;
const BLOCK: usize = 3 + 4 * CHANNELS;
const BLOCKS: usize = 2;
const CHECKSUM: usize = 4;
/// Parts of a degree that angles count in, and of a turn.
const DEGREE: i64 = 25_600;
const TURN: i64 = 360 * DEGREE;
/// Between firings of a block and its time, and between blocks, nanoseconds.
const LEAD_NS: i64 = -9249;
const BLOCK_NS: i64 = 41_666;

/// The corrections of one sensor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Correction {
    /// The part of a turn that each mirror serves: from, to.
    mirrors: Vec<[i64; 2]>,
    azimuths: Vec<i64>,
    elevations: Vec<i64>,
    /// Hundredths of a degree.
    azimuth_adjustments: Vec<i8>,
    elevation_adjustments: Vec<i8>,
}

impl Correction {
    /// Whether a file begins as one with corrections does.
    pub fn may_be(head: &[u8]) -> bool {
        head.starts_with(&FILE)
    }

    /// The corrections in a file (`.dat`); None where it is none, or not whole.
    pub fn read(file: &[u8]) -> Option<Self> {
        let rest = file.strip_prefix(&FILE)?;
        let mirrors = usize::from(*rest.first()?);
        let unit = i64::from(u8_at(file, FILE_HEADER - 1)?);
        let body = file.get(FILE_HEADER..)?;
        let numbers = |from: usize, count: usize| -> Option<Vec<i64>> {
            let signed = |at: usize| u32_at(body, 4 * at).map(|sent| unit * i64::from(sent.cast_signed()));
            (from..from + count).map(signed).collect()
        };
        let starts = numbers(0, mirrors)?;
        let ends = numbers(mirrors, mirrors)?;
        let angles_at = 2 * mirrors;
        let small_at = 4 * (angles_at + 2 * CHANNELS);
        let adjustments = |number: usize| -> Option<Vec<i8>> {
            let bytes = CHANNELS * ADJUSTMENTS;
            let sent = body.get(small_at + number * bytes..small_at + (number + 1) * bytes)?;
            let times = i8::try_from(unit).ok()?;
            Some(
                sent.iter()
                    .map(|byte| byte.cast_signed().saturating_mul(times))
                    .collect(),
            )
        };
        Some(Self {
            mirrors: starts.into_iter().zip(ends).map(|(start, end)| [start, end]).collect(),
            azimuths: numbers(angles_at, CHANNELS)?,
            elevations: numbers(angles_at + CHANNELS, CHANNELS)?,
            azimuth_adjustments: adjustments(0)?,
            elevation_adjustments: adjustments(1)?,
        })
    }

    /// Azimuth and elevation of a channel where the block has an azimuth; None between the mirrors.
    fn direction(&self, block: i64, channel: usize) -> Option<[i64; 2]> {
        let serves = |[start, end]: &&[i64; 2]| {
            if start <= end {
                (*start..=*end).contains(&block)
            } else {
                block >= *start || block <= *end
            }
        };
        let [start, _] = self.mirrors.iter().find(serves)?;
        let azimuth = 2 * (block - start) - self.azimuths.get(channel)?
            + adjustment(&self.azimuth_adjustments, channel, block) * (DEGREE / 100);
        let elevation =
            self.elevations.get(channel)? + adjustment(&self.elevation_adjustments, channel, block) * (DEGREE / 100);
        Some([azimuth.rem_euclid(TURN), elevation])
    }
}

/// The adjustment at an azimuth, between the two nearest, hundredths of a degree.
#[expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "below 128")]
fn adjustment(table: &[i8], channel: usize, azimuth: i64) -> i64 {
    let step = 2 * DEGREE;
    let Ok(place) = usize::try_from(azimuth / step) else {
        return 0;
    };
    let at = |place: usize| table.get(channel * ADJUSTMENTS + place).copied().map_or(0.0, f64::from);
    let part = (azimuth % step) as f64 / step as f64;
    ((1.0 - part) * at(place) + part * at(place + 1)).round() as i64
}

/// Whether a packet is one of an AT128.
pub(super) fn is_at128(bytes: &[u8]) -> bool {
    bytes.starts_with(&PACKET)
}

/// The place of a packet in its scan, hundredths of a degree: each of three mirrors makes one, from about 23 degrees on. `None` where it is of
/// another model.
pub(super) fn place(bytes: &[u8]) -> Option<u16> {
    let azimuth = u16_at(bytes, HEADER).filter(|_| is_at128(bytes))?;
    u16::try_from((u32::from(azimuth) + 12_000 - 2330) % 12_000).ok()
}

/// A packet taken apart.
pub(super) struct Parsed<'p> {
    body: &'p [u8],
    echoes: usize,
    unit: f32,
    /// Nanoseconds since 1970 by the sensor's clock.
    pub(super) time_ns: i64,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Parsed<'_>, PacketError> {
    let short = PacketError::Length {
        bytes: bytes.len(),
        of: NAME,
    };
    let end = HEADER + BLOCKS * BLOCK;
    let (Some(body), Some(tail)) = (bytes.get(HEADER..end), bytes.get(end + CHECKSUM..)) else {
        return Err(short);
    };
    let date = tail.get(26..).and_then(|date| date.first_chunk());
    let (Some(clock_us), Some(mode), Some(date)) = (u32_at(tail, 20), u8_at(tail, 24), date) else {
        return Err(short);
    };
    let echoes = match mode {
        0x33 | 0x34 | 0x37 | 0x38 => 1,
        0x39..=0x3C => 2,
        id => return Err(PacketError::Mode { model: NAME, id }),
    };
    let seconds = seconds_of(*date).filter(|_| clock_us <= 1_000_000);
    let whole_ns = seconds.and_then(|seconds| seconds.checked_mul(1_000_000_000));
    let whole_ns = whole_ns.ok_or(PacketError::Time { model: NAME })?;
    Ok(Parsed {
        body,
        echoes,
        unit: u8_at(bytes, 9).map_or(0.004, |millimetres| f32::from(millimetres) / 1000.0),
        time_ns: whole_ns.saturating_add(1000 * i64::from(clock_us)),
    })
}

/// Appends the returns of a packet that begins so many nanoseconds after the first.
#[expect(clippy::cast_precision_loss, reason = "parts of a turn, below 2^24")]
pub(super) fn push_returns(packet: &Parsed<'_>, correction: &Correction, after_ns: i64, returns: &mut Vec<Return>) {
    let degrees = |angle: i64| Direction::of(angle as f64 / DEGREE as f64);
    let mut before: &[u8] = &[];
    for (number, block) in (0..).zip(packet.body.chunks_exact(BLOCK)) {
        let (Some(whole), Some(part), Some(units)) = (u16_at(block, 0), u8_at(block, 2), block.get(3..)) else {
            continue;
        };
        let azimuth = i64::from(whole) * 256 + i64::from(part);
        // Two returns of one firing are the two blocks.
        let from_end = if packet.echoes == 1 { 2 - number } else { 1 };
        for (channel, unit) in units.chunks_exact(4).enumerate() {
            let Some(sent @ 1..) = u16_at(unit, 0) else { continue };
            let is_repeated = packet.echoes == 2 && u16_at(before, 4 * channel) == Some(sent);
            let Some([azimuth, elevation]) = correction.direction(azimuth, channel).filter(|_| !is_repeated) else {
                continue;
            };
            let (azimuth, elevation) = (degrees(azimuth), degrees(elevation));
            let distance = f32::from(sent) * packet.unit;
            let fire_ns = FIRE.get(channel).copied().map_or(0, i64::from);
            returns.push(Return {
                x: distance * elevation.cos * azimuth.sin,
                y: distance * elevation.cos * azimuth.cos,
                z: distance * elevation.sin,
                intensity: u8_at(unit, 2).map_or(0.0, f32::from),
                ring: u16::try_from(channel).unwrap_or_default(),
                offset_ns: after_ns.saturating_add(LEAD_NS - BLOCK_NS * from_end + fire_ns),
            });
        }
        before = units;
    }
}

/// Firing times after the start of the block by channel, nanoseconds.
#[rustfmt::skip]
static FIRE: [u16; CHANNELS] = [
    0, 0, 8240, 4112, 4144, 8240, 0, 0, 12_424, 4144, 4112, 8264, 12_376, 12_376, 8264, 12_424, 0, 0, 4112, 8240,
    4144, 0, 0, 4144, 12_424, 8264, 4112, 12_376, 12_376, 12_424, 8264, 848, 2504, 4976, 6616, 6616, 9112, 2504,
    848, 10_768, 13_280, 13_280, 4976, 9112, 14_928, 14_928, 10_768, 2504, 848, 6616, 4976, 9112, 6616, 848, 2504,
    13_280, 10_768, 4976, 13_280, 14_928, 9112, 10_768, 14_928, 13_280, 848, 9112, 13_280, 2504, 4976, 848, 2504,
    14_928, 10_768, 10_768, 14_928, 4976, 6616, 6616, 9112, 848, 13_280, 13_280, 9112, 4976, 2504, 2504, 848,
    10_768, 14_928, 14_928, 10_768, 6616, 4976, 9112, 6616, 4112, 12_424, 0, 4144, 0, 0, 12_424, 0, 8264, 4112,
    4144, 8240, 8240, 8264, 12_376, 12_376, 12_424, 4112, 4144, 0, 0, 0, 0, 0, 12_424, 8264, 8240, 4144, 8264, 8240,
    12_376, 12_376, 8264,
];
