//! Velodyne's data packet: 12 blocks of 100 bytes (mark, azimuth, 32 times distance and intensity), the microseconds since
//! the hour, the return mode and the model ("factory bytes"). Source: the user manuals of the VLP-16 (63-9243), VLP-32C
//! (63-9325), VLS-128 (63-9483), each chapter 9, and HDL-32E (63-9113), appendix on the data packet.

use super::bytes::{u8_at, u16_at, u32_at};
use super::turn::{Direction, TURN, turn};
use super::velodyne_models::{LIKE_DRIVER, Model, UNITS, model_of};
use super::{Decode, Packet, PacketError, Return};

const BLOCKS: usize = 12;
const BLOCK_BYTES: usize = 100;
pub(super) const PACKET_BYTES: usize = 1206;
const HOUR_US: i64 = 3_600_000_000;
/// Hundredths of a degree that no sensor turns in a cycle (20 turns a second make 0.8°): so far the azimuth jumps where the
/// sensor is set to leave out a part of the turn.
const FASTEST: u16 = 200;
/// The marks of the first, second, third and fourth 32 lasers.
const MARKS: [u16; 4] = [0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF];

#[derive(Clone, Copy, Default)]
struct Block<'p> {
    bank: usize,
    rotation: u16,
    units: &'p [u8],
}

/// A packet taken apart; all that can be wrong with it has been checked.
struct Parsed<'p> {
    model: &'static Model,
    /// Returns of one shot, in blocks after each other.
    echoes: usize,
    blocks: [Block<'p>; BLOCKS],
    /// Microseconds since the hour.
    clock_us: i64,
}

fn parse(bytes: &[u8]) -> Result<Parsed<'_>, PacketError> {
    let length = PacketError::Length {
        bytes: bytes.len(),
        of: "a Velodyne data packet (1206 bytes)",
    };
    let (Some(clock), Some(mode), Some(id)) = (u32_at(bytes, 1200), u8_at(bytes, 1204), u8_at(bytes, 1205)) else {
        return Err(length);
    };
    if bytes.len() != PACKET_BYTES {
        return Err(length);
    }
    if u16_at(bytes, 0) != Some(MARKS[0]) {
        return Err(PacketError::NotData { bytes: bytes.len() });
    }
    let Some(model) = model_of(id) else {
        return Err(PacketError::Model {
            bytes: bytes.len(),
            id: u16::from(id),
        });
    };
    let echoes = match mode {
        0x37 | 0x38 => 1,
        0x39 => 2,
        id => return Err(PacketError::Mode { model: model.name, id }),
    };
    let clock_us = i64::from(clock);
    if clock_us > HOUR_US {
        return Err(PacketError::Time { model: model.name });
    }
    let mut blocks = [Block::default(); BLOCKS];
    for (i, (block, bytes)) in blocks
        .iter_mut()
        .zip(bytes.chunks_exact(BLOCK_BYTES))
        .take(used(model, echoes))
        .enumerate()
    {
        *block = parse_block(model, i + 1, bytes)?;
    }
    Ok(Parsed {
        model,
        echoes,
        blocks,
        clock_us,
    })
}

/// The azimuth of the first block, hundredths of a degree; `None` where this is no data packet.
pub(super) fn azimuth(bytes: &[u8]) -> Option<u16> {
    let is_data = bytes.len() == PACKET_BYTES && u16_at(bytes, 0) == Some(MARKS[0]);
    u16_at(bytes, 2).filter(|azimuth| is_data && *azimuth < TURN)
}

/// Blocks in use: with two returns a packet of the VLS-128 holds but one firing of all lasers.
fn used(model: &Model, echoes: usize) -> usize {
    BLOCKS - BLOCKS % (model.banks * echoes)
}

fn parse_block<'p>(model: &Model, block: usize, bytes: &'p [u8]) -> Result<Block<'p>, PacketError> {
    let lacking = PacketError::Mark {
        model: model.name,
        block,
    };
    let (Some(mark), Some(sent), Some(units)) = (u16_at(bytes, 0), u16_at(bytes, 2), bytes.get(4..)) else {
        return Err(lacking);
    };
    let Some(bank) = MARKS.iter().take(model.banks).position(|of_bank| *of_bank == mark) else {
        return Err(lacking);
    };
    if sent >= TURN {
        return Err(PacketError::Azimuth {
            model: model.name,
            block,
            sent,
        });
    }
    Ok(Block {
        bank,
        rotation: sent,
        units,
    })
}

/// Remembers the model and the first packet's time.
#[derive(Default)]
pub(super) struct Decoder {
    first: Option<First>,
}

struct First {
    model: &'static Model,
    clock_us: i64,
    start_ns: Option<i64>,
}

impl Decode for Decoder {
    fn packet(&mut self, packet: &Packet<'_>, returns: &mut Vec<Return>) -> Result<(), PacketError> {
        let parsed = parse(packet.bytes)?;
        let Parsed { model, clock_us, .. } = parsed;
        let first = self.first.get_or_insert_with(|| First {
            model,
            clock_us,
            start_ns: (packet.received_ns != 0).then(|| time_of(clock_us, packet.received_ns)),
        });
        if first.model.id != model.id {
            return Err(PacketError::Mixed {
                model: model.name,
                before: first.model.name,
            });
        }
        push_returns(&parsed, 1000 * nearest_hour(clock_us - first.clock_us), returns);
        Ok(())
    }

    fn identity(&self) -> Option<(&'static str, Option<i64>)> {
        self.first.as_ref().map(|first| (first.model.name, first.start_ns))
    }
}

/// A difference of times within the hour as the nearest one, at most half an hour.
fn nearest_hour(difference_us: i64) -> i64 {
    (difference_us + HOUR_US / 2).rem_euclid(HOUR_US) - HOUR_US / 2
}

/// The time of a clock within the hour, nanoseconds since 1970. A clock that differs by more than a second from the host's
/// is taken as never set (it then counts from the start of the sensor): the host's time is returned.
fn time_of(clock_us: i64, received_ns: i64) -> i64 {
    let ahead_us = nearest_hour(clock_us - (received_ns / 1000).rem_euclid(HOUR_US));
    if ahead_us.abs() > 1_000_000 {
        return received_ns;
    }
    (received_ns / 1000).saturating_add(ahead_us).saturating_mul(1000)
}

fn push_returns(packet: &Parsed<'_>, offset_ns: i64, returns: &mut Vec<Return>) {
    let Parsed {
        model,
        echoes,
        ref blocks,
        ..
    } = *packet;
    let table = turn();
    let rotations = blocks.map(|block| block.rotation);
    let mut cycle_ns = offset_ns + i64::from(model.lead_ns);
    for (b, block) in blocks.iter().enumerate().take(used(model, echoes)) {
        if b > 0 && b % (model.banks * echoes) == 0 {
            cycle_ns += i64::from(model.cycle_ns);
        }
        let (begin, step) = sweep(&rotations, b, model, echoes, LIKE_DRIVER);
        let before = if b % echoes == 1 { blocks.get(b - 1) } else { None };
        let slots = model.slots().iter().skip(UNITS * block.bank);
        for (at, (unit, slot)) in (0..).step_by(3).zip(block.units.chunks_exact(3).zip(slots)) {
            let &[low, high, intensity] = unit else { continue };
            let sent = u16::from_le_bytes([low, high]);
            if sent == 0 || before.is_some_and(|before| u16_at(before.units, at) == Some(sent)) {
                continue;
            }
            let distance = f32::from(sent) * model.unit;
            let azimuth = direction(
                table,
                f32::from(begin) + f32::from(step) * slot.part,
                slot.azimuth_offset,
            );
            let level = distance * slot.elevation.cos;
            returns.push(Return {
                x: level * azimuth.cos,
                y: -level * azimuth.sin,
                z: distance * slot.elevation.sin,
                intensity: f32::from(intensity),
                ring: slot.ring,
                offset_ns: cycle_ns + slot.fire_ns,
            });
        }
    }
}

/// Where block `b` begins and how far it turns until the next firing of all lasers, hundredths of a degree.
///
/// The user manuals (chapter 9, precision azimuth): all blocks of one firing begin at their azimuth and turn until the next
/// firing's; the last firing of a packet turns as far as the one before. The ROS driver takes the next block of the packet
/// instead: there is no turn in the last firing, none in the first three quarters of a firing of the VLS-128, and a second
/// return begins where the next firing does.
pub(super) fn sweep(
    rotations: &[u16; BLOCKS],
    b: usize,
    model: &Model,
    echoes: usize,
    like_driver: bool,
) -> (u16, u16) {
    let at = |i: usize| rotations.get(i).copied().unwrap_or_default();
    let turned = |from: u16, to: u16| {
        let angle = if to < from { to + (TURN - from) } else { to - from };
        if angle > FASTEST { 0 } else { angle }
    };
    let (size, count) = (model.banks * echoes, used(model, echoes));
    if like_driver {
        let begin = if b == 0 || echoes == 1 {
            at(b)
        } else {
            at((b + 1).min(count - 1))
        };
        return (
            begin,
            if b + echoes < count {
                turned(begin, at(b + echoes))
            } else {
                0
            },
        );
    }
    let this = b - b % size;
    let step = if this + 2 * size <= count {
        turned(at(this), at(this + size))
    } else if this >= size {
        turned(at(this - size), at(this))
    } else {
        0
    };
    (at(b), step)
}

/// The direction of an azimuth less the laser's offset, to the nearest hundredth of a degree as the driver has it.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "hundredths of a degree, below two turns"
)]
fn direction(table: &[Direction], azimuth: f32, offset: f64) -> Direction {
    let sum = (f64::from(azimuth) - offset) as f32;
    let sum = if sum < 0.0 { sum + f32::from(TURN) } else { sum };
    let index = (sum + 0.5) as usize % usize::from(TURN);
    table.get(index).copied().unwrap_or(Direction { sin: 0.0, cos: 1.0 })
}
