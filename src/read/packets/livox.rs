//! Livox's packets of points, little-endian: of the first generation (Mid-40, Mid-70, Horizon, Tele-15, Avia) and of the second (Mid-360, HAP).
//!
//! x forward, y left, z up, as the driver publishes it without an extrinsic. Sources: github.com/Livox-SDK/Livox-SDK at 9306596 `livox_def.h`,
//! Livox-SDK2 at 08f523c `livox_lidar_def.h`; livox_ros_driver `lds.h`, `lds.cpp` and livox_ros_driver2 `pub_handler.cpp` (points, times).
//! The packets do not say which model sent them. Points of the first generation have the time of their packet, which lasts 1 ms at most.

use super::bytes::{u8_at, u16_at, u32_at, u64_at};
use super::date::seconds_of;
use super::turn::Direction;
use super::{Decode, Packet, PacketError, Return};

/// The sensor's clock: set by PTP, or by GNSS; others count from when it was switched on.
const PTP: u8 = 1;
const GNSS: [u8; 2] = [2, 3];

/// How points are laid out.
#[derive(Clone, Copy, Debug)]
enum Layout {
    /// Samples of the inertial sensor.
    Imu,
    /// Three coordinates of four bytes, millimetres.
    Millimetres,
    /// Three coordinates of two bytes, centimetres.
    Centimetres,
    /// A distance in millimetres, and angles in hundredths of a degree: from the zenith, and around it.
    Angles,
    /// The angles once, and a distance for each return.
    SharedAngles,
}

/// What a packet holds: layout, returns of a shot, bytes of a shot.
type Shots = (Layout, usize, usize);

/// By the number of the first generation, with the shots of a packet.
const FIRST: [(Shots, usize); 9] = [
    ((Layout::Millimetres, 1, 13), 100),
    ((Layout::Angles, 1, 9), 100),
    ((Layout::Millimetres, 1, 14), 96),
    ((Layout::Angles, 1, 10), 96),
    ((Layout::Millimetres, 2, 28), 48),
    ((Layout::SharedAngles, 2, 16), 48),
    ((Layout::Imu, 0, 24), 1),
    ((Layout::Millimetres, 3, 42), 30),
    ((Layout::SharedAngles, 3, 22), 30),
];
const FIRST_HEADER: usize = 18;
const FIRST_VERSION: u8 = 5;
const SECOND_HEADER: usize = 36;

/// A packet taken apart.
struct Parsed<'p> {
    name: &'static str,
    shots: Shots,
    body: &'p [u8],
    /// From one shot to the next, nanoseconds.
    step_ns: i64,
    /// By the sensor's clock.
    time_ns: i64,
    /// Whether that is the time since 1970.
    is_set: bool,
}

/// Whether a packet has points of a Livox: all its lengths are consistent. Packets of its IMU have none.
pub(super) fn is_livox(bytes: &[u8]) -> bool {
    time_ns(bytes).is_some()
}

/// The time of a packet of points, nanoseconds by the sensor's clock.
pub(super) fn time_ns(bytes: &[u8]) -> Option<i64> {
    let parsed = parse(bytes).ok()?;
    (parsed.shots.1 > 0).then_some(parsed.time_ns)
}

fn parse(bytes: &[u8]) -> Result<Parsed<'_>, PacketError> {
    let not = PacketError::NotData { bytes: bytes.len() };
    match u8_at(bytes, 0) {
        Some(FIRST_VERSION) => first(bytes).ok_or(not),
        Some(0) => second(bytes).ok_or(not),
        _ => Err(not),
    }
}

fn first(bytes: &[u8]) -> Option<Parsed<'_>> {
    let (kind, layout) = (u8_at(bytes, 8)?, u8_at(bytes, 9)?);
    let (shots, count) = *FIRST.get(usize::from(layout))?;
    let body = bytes.get(FIRST_HEADER..)?;
    (body.len() == shots.2 * count && kind <= 5).then_some(())?;
    Some(Parsed {
        name: "first generation",
        shots,
        body,
        step_ns: 0,
        time_ns: clock(kind, bytes, 10)?,
        is_set: kind == PTP || GNSS.contains(&kind),
    })
}

fn second(bytes: &[u8]) -> Option<Parsed<'_>> {
    let shots = match u8_at(bytes, 10)? {
        0 => (Layout::Imu, 0, 24),
        1 => (Layout::Millimetres, 1, 14),
        2 => (Layout::Centimetres, 1, 8),
        3 => (Layout::Angles, 1, 10),
        0x11 => (Layout::Millimetres, 2, 28),
        _ => return None,
    };
    let (count, kind) = (usize::from(u16_at(bytes, 5)?), u8_at(bytes, 11)?);
    let body = bytes.get(SECOND_HEADER..)?;
    let is_whole = usize::from(u16_at(bytes, 1)?) == bytes.len() && body.len() == shots.2 * count;
    (is_whole && count > 0 && kind <= 5).then_some(())?;
    // Tenths of a microsecond for all of the packet.
    let lasts_ns = 100 * i64::from(u16_at(bytes, 3)?);
    Some(Parsed {
        name: "second generation",
        shots,
        body,
        step_ns: lasts_ns / i64::try_from(count).ok()?,
        time_ns: i64::try_from(u64_at(bytes, 28)?).ok()?,
        is_set: kind == PTP || GNSS.contains(&kind),
    })
}

/// The time of a packet of the first generation: nanoseconds, or by GNSS the date to the hour and the microseconds since.
fn clock(kind: u8, bytes: &[u8], at: usize) -> Option<i64> {
    if kind != GNSS[1] {
        return i64::try_from(u64_at(bytes, at)?).ok();
    }
    let [year, month, day, hour] = *bytes.get(at..)?.first_chunk::<4>()?;
    let seconds = seconds_of([year.checked_add(100)?, month, day, hour, 0, 0])?;
    seconds
        .checked_mul(1_000_000_000)?
        .checked_add(1000 * i64::from(u32_at(bytes, at + 4)?))
}

/// Remembers the generation and the first packet's time by the sensor and in truth.
#[derive(Default)]
pub(super) struct Decoder {
    first: Option<(&'static str, i64, Option<i64>)>,
}

impl Decode for Decoder {
    fn packet(&mut self, packet: &Packet<'_>, returns: &mut Vec<Return>) -> Result<(), PacketError> {
        let parsed = parse(packet.bytes)?;
        let (layout, echoes, bytes) = parsed.shots;
        if echoes == 0 {
            return Ok(());
        }
        let received_ns = (packet.received_ns > 0).then_some(packet.received_ns);
        let real_ns = if parsed.is_set {
            Some(parsed.time_ns)
        } else {
            received_ns
        };
        let &mut (before, start_ns, _) = self.first.get_or_insert((parsed.name, parsed.time_ns, real_ns));
        if before != parsed.name {
            return Err(PacketError::Mixed {
                model: parsed.name,
                before,
            });
        }
        let mut at_ns = parsed.time_ns.saturating_sub(start_ns);
        for shot in parsed.body.chunks_exact(bytes) {
            let from = returns.len();
            for number in 0..echoes {
                let Some(([x, y, z], intensity)) = point(layout, shot, number, bytes / echoes) else {
                    continue;
                };
                let bits = |place: [f32; 3]| place.map(f32::to_bits);
                let mut known = returns.iter().skip(from).map(|other| bits([other.x, other.y, other.z]));
                // Nothing was received, or the same return is sent again.
                let is_known = known.any(|known| known == bits([x, y, z]));
                if [x, y, z].iter().any(|axis| axis.abs() > 0.0) && !is_known {
                    returns.push(Return {
                        x,
                        y,
                        z,
                        intensity: f32::from(intensity),
                        ring: 0,
                        offset_ns: at_ns,
                    });
                }
            }
            at_ns = at_ns.saturating_add(parsed.step_ns);
        }
        Ok(())
    }

    fn identity(&self) -> Option<(&'static str, Option<i64>)> {
        self.first.map(|(name, _, real_ns)| (name, real_ns))
    }
}

/// A return of a shot, metres, and its reflectivity.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_wrap,
    reason = "sent with a sign; millimetres in f32"
)]
fn point(layout: Layout, shot: &[u8], number: usize, bytes: usize) -> Option<([f32; 3], u8)> {
    let one = shot.get(number * bytes..)?;
    match layout {
        Layout::Imu => None,
        Layout::Millimetres => {
            let axis = |at: usize| Some(u32_at(one, at)? as i32 as f32 / 1000.0);
            Some(([axis(0)?, axis(4)?, axis(8)?], u8_at(one, 12)?))
        }
        Layout::Centimetres => {
            let axis = |at: usize| Some(f32::from(u16_at(one, at)? as i16) / 100.0);
            Some(([axis(0)?, axis(2)?, axis(4)?], u8_at(one, 6)?))
        }
        Layout::Angles => Some(polar(u32_at(one, 0)?, u16_at(one, 4)?, u16_at(one, 6)?, u8_at(one, 8)?)),
        Layout::SharedAngles => {
            let one = shot.get(4 + 6 * number..)?;
            Some(polar(
                u32_at(one, 0)?,
                u16_at(shot, 0)?,
                u16_at(shot, 2)?,
                u8_at(one, 4)?,
            ))
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "millimetres in f32")]
fn polar(millimetres: u32, zenith: u16, around: u16, reflectivity: u8) -> ([f32; 3], u8) {
    let (zenith, around) = (
        Direction::of(f64::from(zenith) / 100.0),
        Direction::of(f64::from(around) / 100.0),
    );
    let distance = millimetres as f32 / 1000.0;
    let flat = distance * zenith.sin;
    (
        [flat * around.cos, flat * around.sin, distance * zenith.cos],
        reflectivity,
    )
}
