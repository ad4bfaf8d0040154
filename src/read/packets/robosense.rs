//! RoboSense's data packets (MSOP) and the packets with the angles of a sensor's beams (DIFOP), big-endian.
//!
//! Points are where github.com/RoboSense-LiDAR/rs_driver (at 4eeadac) has them: x forward, y left, from the lens, azimuths clockwise and
//! interpolated to the firing. Other than there, the turn of a packet's last firing is that of the first, and returns of any distance count.

use super::bytes::{u8_at, u16_be};
use super::robosense_models::{Model, Told, clock, is_solid, model_of};
use super::turn::{Direction, TURN, turn};
use super::{Decode, Packet, PacketError, Return, Unit, robosense_solid};

pub(super) use super::robosense_models::{is_info, is_robosense};

/// Hundredths of a degree that no sensor turns from one block to the next: so far the azimuth jumps where a part of the turn is left out.
const FASTEST: u16 = 100;
/// The return mode of an info packet, and the byte of a Bpearl's that says that it turns the other way.
const MODE_AT: usize = 300;
const REVERSED_AT: usize = 337;

/// Remembers the model, the first packet's time, and the beams of the sensor.
pub(super) struct Decoder<'u> {
    unit: &'u Unit,
    first: Option<(&'static str, i64)>,
    beams: Vec<Beam>,
}

struct Beam {
    elevation: Direction,
    /// Hundredths of a degree, to be added to the azimuth.
    azimuth: i32,
    ring: u16,
}

impl<'u> Decoder<'u> {
    pub(super) fn new(unit: &'u Unit) -> Self {
        Self {
            unit,
            first: None,
            beams: Vec::new(),
        }
    }

    /// From the first packet to this one, nanoseconds.
    fn after(&mut self, name: &'static str, time_ns: i64) -> Result<i64, PacketError> {
        let &mut (before, start_ns) = self.first.get_or_insert((name, time_ns));
        if before == name {
            Ok(time_ns.saturating_sub(start_ns))
        } else {
            Err(PacketError::Mixed { model: name, before })
        }
    }
}

impl Decode for Decoder<'_> {
    fn packet(&mut self, packet: &Packet<'_>, returns: &mut Vec<Return>) -> Result<(), PacketError> {
        let bytes = packet.bytes;
        if is_solid(bytes) {
            let time_ns = robosense_solid::time_ns(bytes)?;
            let after_ns = self.after(robosense_solid::NAME, time_ns)?;
            robosense_solid::push_returns(bytes, after_ns, returns);
            return Ok(());
        }
        let model = model_of(bytes)?;
        let shots = shots(model, bytes, self.unit.info())?;
        let time_ns = time_ns(model, bytes)?;
        if self.beams.is_empty() {
            self.beams = beams(model, self.unit.info())?;
        }
        let after_ns = self.after(model.name, time_ns)?;
        let reversed = model.name.starts_with("RS-Bpearl")
            && self
                .unit
                .info()
                .and_then(|info| u8_at(info, REVERSED_AT))
                .is_some_and(|byte| byte > 0);
        for shot in &shots {
            push(model, &self.beams, shot, after_ns, reversed, returns);
        }
        Ok(())
    }

    fn identity(&self) -> Option<(&'static str, Option<i64>)> {
        self.first.map(|(name, start_ns)| (name, Some(start_ns)))
    }
}

/// A block of a packet.
struct Shot<'p> {
    azimuth: u16,
    units: &'p [u8],
    /// The units of the block before, where both are returns of the same firing.
    before: Option<&'p [u8]>,
    /// Two returns of each firing are beside each other in the block.
    paired: bool,
    /// Hundredths of a degree until the next firing.
    step: u16,
    /// After the packet's time.
    offset_ns: i64,
}

/// The blocks of a packet with their turn and time. A second return has the azimuth of the first; only for sensors with two
/// firings in a block the info packet says whether these are returns of one.
fn shots<'p>(model: &Model, bytes: &'p [u8], info: Option<&[u8]>) -> Result<Vec<Shot<'p>>, PacketError> {
    let mut blocks = Vec::with_capacity(model.blocks);
    let body = bytes.get(model.header_bytes..).unwrap_or_default();
    for (i, block) in body.chunks_exact(model.block_bytes()).take(model.blocks).enumerate() {
        if !block.starts_with(model.mark) {
            return Err(PacketError::Mark {
                model: model.name,
                block: i + 1,
            });
        }
        let sent = u16_be(block, 2).unwrap_or(TURN);
        if sent >= TURN {
            return Err(PacketError::Azimuth {
                model: model.name,
                block: i + 1,
                sent,
            });
        }
        blocks.push((sent, block.get(4..).unwrap_or_default()));
    }
    let pairs = || blocks.iter().zip(blocks.iter().skip(1));
    let turns = pairs().map(|(this, next)| turned(this.0, next.0));
    let usual = turns.into_iter().find(|turn| (1..=FASTEST).contains(turn)).unwrap_or(0);
    let paired = model.lasers < model.channels && info.is_some_and(|info| u8_at(info, MODE_AT) == Some(0));
    let cycles = if paired { 1 } else { model.channels / model.lasers };
    let cycle_ns = i64::from(model.cycle_ns) * i64::try_from(cycles).unwrap_or(1);
    let mut shots: Vec<Shot<'p>> = Vec::with_capacity(blocks.len());
    for &(azimuth, units) in &blocks {
        let last = shots.last().map(|last| (last.azimuth, last.units, last.offset_ns));
        let (mut before, mut offset_ns) = (None, 0);
        if let Some((from, others, since_ns)) = last {
            let turn = turned(from, azimuth);
            offset_ns = match turn {
                0 => since_ns,
                1..=FASTEST => since_ns + cycle_ns,
                // A part of the turn was left out.
                _ => since_ns + cycle_ns * i64::from(turn) / i64::from(usual.max(1)),
            };
            before = (turn == 0 && !paired).then_some(others);
        }
        shots.push(Shot {
            azimuth,
            units,
            before,
            paired,
            step: usual,
            offset_ns,
        });
    }
    let next: Vec<u16> = (0..blocks.len()).map(|i| step_after(&blocks, i)).collect();
    for (shot, step) in shots.iter_mut().zip(next) {
        if (1..=FASTEST).contains(&step) {
            shot.step = step;
        }
    }
    Ok(shots)
}

/// Hundredths of a degree from a block to the next firing, or zero after the last.
fn step_after(blocks: &[(u16, &[u8])], i: usize) -> u16 {
    let from = blocks.get(i).map_or(0, |block| block.0);
    let next = blocks.iter().skip(i + 1).map(|block| block.0).find(|to| *to != from);
    next.map_or(0, |to| turned(from, to))
}

/// Hundredths of a degree from one azimuth to the next.
fn turned(from: u16, to: u16) -> u16 {
    if to < from { to + (TURN - from) } else { to - from }
}

/// Nanoseconds since 1970 by the sensor's clock.
fn time_ns(model: &Model, bytes: &[u8]) -> Result<i64, PacketError> {
    clock(model.clock, bytes, model.clock_at).ok_or(PacketError::Time { model: model.name })
}

/// The azimuth of the first block of a sensor that turns, hundredths of a degree; `None` where this is no such packet.
pub(super) fn azimuth(bytes: &[u8]) -> Option<u16> {
    let model = model_of(bytes).ok().filter(|_| !is_info(bytes))?;
    u16_be(bytes, model.header_bytes + 2).filter(|azimuth| *azimuth < TURN)
}

/// The beams of a sensor: of its info packet, else those of the model.
#[expect(
    clippy::cast_possible_truncation,
    reason = "hundredths of a degree, below 656 degrees"
)]
fn beams(model: &Model, info: Option<&[u8]>) -> Result<Vec<Beam>, PacketError> {
    let told = info.and_then(|info| (0..model.lasers).map(|laser| angles(model.told, info, laser)).collect());
    // A sensor that was not calibrated tells the same angle for all.
    let told = told.filter(|told: &Vec<(f64, f64)>| {
        told.iter()
            .any(|of| told.first().is_some_and(|first| (first.0 - of.0).abs() > 0.0))
    });
    let nominal = || {
        let elevation = model.nominal?;
        Some((0..model.lasers).map(|laser| (elevation(laser), 0.0)).collect())
    };
    let angles: Vec<(f64, f64)> = told.or_else(nominal).ok_or(PacketError::Untold {
        model: model.name,
        place: "a packet (DIFOP) that the recording does not have",
    })?;
    let ring = |of: f64| angles.iter().filter(|other| other.0 < of).count();
    let beam = |&(elevation, azimuth): &(f64, f64)| Beam {
        elevation: Direction::of(elevation),
        azimuth: (azimuth * 100.0).round() as i32,
        ring: u16::try_from(ring(elevation)).unwrap_or_default(),
    };
    Ok(angles.iter().map(beam).collect())
}

/// Elevation and azimuth of a laser in an info packet, degrees; None where the packet does not have them.
fn angles(told: Told, info: &[u8], laser: usize) -> Option<(f64, f64)> {
    match told {
        Told::Halves { at } => {
            let [high, middle, low] = *info.get(at + 3 * laser..)?.first_chunk::<3>()?;
            // All bytes are set where nothing was written.
            let sent = u32::from_be_bytes([0, high, middle, low]);
            let degrees = f64::from(sent) * 1e-4;
            (sent > 0 && degrees < 90.0).then_some((if laser < 8 { -degrees } else { degrees }, 0.0))
        }
        Told::Signed { at, azimuths_at, unit } => {
            let angle = |at: usize| {
                let sign = u8_at(info, at + 3 * laser)?;
                let degrees = f64::from(u16_be(info, at + 3 * laser + 1)?) * unit;
                let degrees = if sign == 0 { degrees } else { -degrees };
                (sign != 0xFF && (-90.0..180.0).contains(&degrees)).then_some(degrees)
            };
            Some((angle(at)?, angle(azimuths_at)?))
        }
    }
}

fn push(model: &Model, beams: &[Beam], shot: &Shot<'_>, after_ns: i64, reversed: bool, returns: &mut Vec<Return>) {
    let table = turn();
    let direction = |hundredths: i32| {
        let sent = if reversed { -hundredths } else { hundredths }.rem_euclid(i32::from(TURN));
        let index = usize::try_from(sent).unwrap_or_default();
        table.get(index).copied().unwrap_or(Direction { sin: 0.0, cos: 1.0 })
    };
    let cycles = if shot.paired { 1 } else { model.channels / model.lasers };
    let cycle_ns = i64::from(model.cycle_ns) * i64::try_from(cycles).unwrap_or(1);
    let [lens, lens_up] = model.lens;
    for (channel, unit) in shot.units.chunks_exact(3).enumerate() {
        let Some(sent @ 1..) = u16_be(unit, 0) else { continue };
        let laser = channel % model.lasers;
        let before = if shot.paired && channel >= model.lasers {
            u16_be(shot.units, 3 * laser)
        } else {
            shot.before.and_then(|units| u16_be(units, 3 * channel))
        };
        let Some(beam) = beams.get(laser).filter(|_| before != Some(sent)) else {
            continue;
        };
        let fire_ns = i64::from(model.fire_ns(if shot.paired { laser } else { channel }));
        let turned = i64::from(shot.step) * fire_ns / cycle_ns;
        let azimuth = i32::from(shot.azimuth) + i32::try_from(turned).unwrap_or_default();
        let (lens_at, at) = (direction(azimuth), direction(azimuth + beam.azimuth));
        let distance = f32::from(sent) * model.unit;
        let flat = distance * beam.elevation.cos;
        returns.push(Return {
            x: flat * at.cos + lens * lens_at.cos,
            y: -flat * at.sin - lens * lens_at.sin,
            z: distance * beam.elevation.sin + lens_up,
            intensity: u8_at(unit, 2).map_or(0.0, f32::from),
            ring: beam.ring,
            offset_ns: after_ns.saturating_add(shot.offset_ns).saturating_add(fire_ns),
        });
    }
}
