//! Hesai's data packets: a header (none on the Pandar40P), blocks of an azimuth and a distance and reflectivity by channel,
//! and a tail with the return mode and the time. Source: the user manuals, chapter 3 (data structure), appendices on the
//! channel distribution and on the absolute time of points.

use super::bytes::{u8_at, u16_at, u32_at};
use super::date::seconds_of;
use super::hesai_models::{Beam, Model, model_of};
use super::turn::{TURN, turn};
use super::{Decode, Packet, PacketError, Return, Unit, at128};

/// Remembers the model and the first packet's time.
pub(super) struct Decoder<'u> {
    unit: &'u Unit,
    first: Option<(&'static str, i64)>,
}

impl<'u> Decoder<'u> {
    pub(super) fn new(unit: &'u Unit) -> Self {
        Self { unit, first: None }
    }

    /// From the first packet to this one, nanoseconds.
    fn after(&mut self, model: &'static str, time_ns: i64) -> Result<i64, PacketError> {
        let &mut (before, start_ns) = self.first.get_or_insert((model, time_ns));
        if before == model {
            Ok(time_ns.saturating_sub(start_ns))
        } else {
            Err(PacketError::Mixed { model, before })
        }
    }
}

impl Decode for Decoder<'_> {
    fn packet(&mut self, packet: &Packet<'_>, returns: &mut Vec<Return>) -> Result<(), PacketError> {
        if at128::is_at128(packet.bytes) {
            let parsed = at128::parse(packet.bytes)?;
            let correction = self.unit.correction().ok_or(PacketError::Untold {
                model: at128::NAME,
                place: "a correction file (.dat) that is not at hand",
            })?;
            let after_ns = self.after(at128::NAME, parsed.time_ns)?;
            at128::push_returns(&parsed, correction, after_ns, returns);
            return Ok(());
        }
        let parsed = parse(packet.bytes)?;
        let after_ns = self.after(parsed.model.name, parsed.time_ns)?;
        push_returns(&parsed, after_ns, returns);
        Ok(())
    }

    fn identity(&self) -> Option<(&'static str, Option<i64>)> {
        self.first.map(|(model, start_ns)| (model, Some(start_ns)))
    }
}

/// A packet taken apart; all that can be wrong with it has been checked.
struct Parsed<'p> {
    model: &'static Model,
    /// Returns of one shot, in blocks after each other.
    echoes: usize,
    /// Metres of one unit of distance.
    unit: f32,
    body: &'p [u8],
    /// Bytes of a block, and of a channel in it.
    sizes: (usize, usize),
    /// What the tail says of the firing order.
    order: u32,
    /// Nanoseconds since 1970 by the sensor's clock.
    time_ns: i64,
}

fn parse(bytes: &[u8]) -> Result<Parsed<'_>, PacketError> {
    let model = model_of(bytes)?;
    let short = PacketError::Length {
        bytes: bytes.len(),
        of: model.name,
    };
    let flags = if model.flags {
        u8_at(bytes, 11).unwrap_or_default()
    } else {
        0
    };
    let channel = (model.channel_bytes)(flags).ok_or(PacketError::Configured { model: model.name })?;
    let block = model.azimuth_at + 2 + channel * model.angles.len();
    let body_bytes = block * model.blocks;
    // With flags: a checksum of four bytes, and 17 bytes on functional safety where the flags say so.
    let after_body = if model.flags {
        4 + 17 * usize::from(flags >> 2 & 1)
    } else {
        0
    };
    let body = bytes.get(model.header_bytes..model.header_bytes + body_bytes);
    let tail = bytes.get(model.header_bytes + body_bytes + after_body..);
    let (Some(body), Some(tail)) = (body, tail) else {
        return Err(short);
    };
    let date = tail.get(model.tail.date..).and_then(|date| date.first_chunk());
    let (Some(mode), Some(date), Some(clock_us)) = (u8_at(tail, model.tail.mode), date, u32_at(tail, model.tail.clock))
    else {
        return Err(short);
    };
    let echoes = match mode {
        0x33 | 0x34 | 0x37 | 0x38 => 1,
        0x39..=0x3C | 0x3E => 2,
        0x3D => 3,
        _ => 0,
    };
    if echoes == 0 || model.blocks % echoes != 0 {
        return Err(PacketError::Mode {
            model: model.name,
            id: mode,
        });
    }
    let time_ns = seconds_of(*date)
        .filter(|_| clock_us <= 1_000_000)
        .and_then(|seconds| seconds.checked_mul(1_000_000_000));
    let time_ns = time_ns
        .ok_or(PacketError::Time { model: model.name })?
        .saturating_add(1000 * i64::from(clock_us));
    for (i, block) in body.chunks_exact(block).enumerate() {
        let sent = u16_at(block, model.azimuth_at).unwrap_or(TURN);
        if model.azimuth_at > 0 && u16_at(block, 0) != Some(0xEEFF) {
            return Err(PacketError::Mark {
                model: model.name,
                block: i + 1,
            });
        }
        if sent >= TURN {
            return Err(PacketError::Azimuth {
                model: model.name,
                block: i + 1,
                sent,
            });
        }
    }
    let millimetres = if model.header_bytes == 0 {
        Some(4)
    } else {
        u8_at(bytes, model.unit_at)
    };
    Ok(Parsed {
        model,
        echoes,
        unit: f32::from(millimetres.unwrap_or(4)) / 1000.0,
        body,
        sizes: (block, channel),
        order: (model.order)(tail),
        time_ns,
    })
}

/// The azimuth of the first block, hundredths of a degree; `None` where this is no data packet.
pub(super) fn azimuth(bytes: &[u8]) -> Option<u16> {
    let model = model_of(bytes).ok()?;
    u16_at(bytes, model.header_bytes + model.azimuth_at).filter(|azimuth| *azimuth < TURN)
}

fn push_returns(packet: &Parsed<'_>, offset_ns: i64, returns: &mut Vec<Return>) {
    let (block_bytes, _) = packet.sizes;
    let model = packet.model;
    for (shot, blocks) in packet.body.chunks_exact(block_bytes * packet.echoes).enumerate() {
        let shots = model.blocks / packet.echoes;
        let shot_ns = offset_ns + (model.shot_ns)(shot, shots, packet.order);
        let beams = model.beams((model.column)(shot, packet.order));
        for (echo, block) in blocks.chunks_exact(block_bytes).enumerate() {
            let later = blocks.get(block_bytes * (echo + 1)..).unwrap_or_default();
            push_block(
                packet,
                block,
                Later {
                    blocks: later,
                    block_bytes,
                },
                (shot_ns, beams),
                returns,
            );
        }
    }
}

/// The blocks of the same shot after one of them.
#[derive(Clone, Copy)]
struct Later<'p> {
    blocks: &'p [u8],
    block_bytes: usize,
}

impl Later<'_> {
    /// Whether one of them repeats a distance and reflectivity.
    fn repeat(&self, at: usize, unit: &[u8]) -> bool {
        self.blocks
            .chunks_exact(self.block_bytes)
            .any(|block| block.get(at..at + 3) == Some(unit))
    }
}

fn push_block(
    packet: &Parsed<'_>,
    block: &[u8],
    later: Later<'_>,
    (shot_ns, beams): (i64, &[Beam]),
    returns: &mut Vec<Return>,
) {
    let model = packet.model;
    let rotation = u16_at(block, model.azimuth_at).unwrap_or_default();
    let Some(rotation) = turn().get(usize::from(rotation)) else {
        return;
    };
    let begin = model.azimuth_at + 2;
    let channels = block.get(begin..).unwrap_or_default().chunks_exact(packet.sizes.1);
    for (((ring, at), channel), beam) in (0..).zip((begin..).step_by(packet.sizes.1)).zip(channels).zip(beams) {
        let &[low, high, reflectivity, ..] = channel else {
            continue;
        };
        let sent = u16::from_le_bytes([low, high]);
        if sent < model.least || later.repeat(at, &[low, high, reflectivity]) {
            continue;
        }
        let distance = f32::from(sent) * packet.unit;
        let azimuth = rotation.plus(beam.azimuth);
        let level = distance * beam.elevation.cos;
        returns.push(Return {
            x: level * azimuth.sin,
            y: level * azimuth.cos,
            z: distance * beam.elevation.sin,
            intensity: f32::from(reflectivity),
            ring,
            offset_ns: shot_ns + beam.fire_ns,
        });
    }
}
