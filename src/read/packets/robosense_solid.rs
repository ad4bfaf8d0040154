//! The data packet of the RS-LiDAR-M1, which does not turn: 25 blocks of five points, each with its distance and angles.
//!
//! Source: github.com/RoboSense-LiDAR/rs_driver at 4eeadac, `decoder_RSM1.hpp`.

use super::bytes::{u8_at, u16_be};
use super::robosense_models::{Clock, SOLID_BYTES, clock, is_solid};
use super::turn::Direction;
use super::{PacketError, Return};

pub(super) const NAME: &str = "RS-LiDAR-M1";
const HEADER_BYTES: usize = 32;
const BLOCKS: usize = 25;
const POINT_BYTES: usize = 9;
/// A block: its time after the packet's, microseconds, the number of the return, and a point for each of the five lasers.
const BLOCK_BYTES: usize = 2 + 5 * POINT_BYTES;
/// What is sent for an angle of zero.
const ZERO: i32 = 32_768;
/// Metres of one unit of distance.
const UNIT: f32 = 0.005;

/// The number of a packet in its scan; `None` where it is of another model.
pub(super) fn number(bytes: &[u8]) -> Option<u16> {
    u16_be(bytes, 4).filter(|_| is_solid(bytes))
}

/// Nanoseconds since 1970 by the sensor's clock; all that can be wrong with the packet is checked.
pub(super) fn time_ns(bytes: &[u8]) -> Result<i64, PacketError> {
    if bytes.len() != SOLID_BYTES {
        return Err(PacketError::Length {
            bytes: bytes.len(),
            of: NAME,
        });
    }
    clock(Clock::Seconds, bytes, 10).ok_or(PacketError::Time { model: NAME })
}

/// Appends the points of a packet that begins so many nanoseconds after the first.
pub(super) fn push_returns(bytes: &[u8], after_ns: i64, returns: &mut Vec<Return>) {
    let body = bytes.get(HEADER_BYTES..).unwrap_or_default();
    for block in body.chunks_exact(BLOCK_BYTES).take(BLOCKS) {
        let block_ns = u8_at(block, 0).map_or(0, |micros| 1000 * i64::from(micros));
        let points = block.get(2..).unwrap_or_default().chunks_exact(POINT_BYTES);
        for (ring, point) in (0..).zip(points) {
            let (Some(sent @ 1..), Some(pitch), Some(yaw)) = (u16_be(point, 0), u16_be(point, 2), u16_be(point, 4))
            else {
                continue;
            };
            let angle = |sent: u16| Direction::of(f64::from(i32::from(sent) - ZERO) / 100.0);
            let (pitch, yaw) = (angle(pitch), angle(yaw));
            let distance = f32::from(sent) * UNIT;
            returns.push(Return {
                x: distance * pitch.cos * yaw.cos,
                y: distance * pitch.cos * yaw.sin,
                z: distance * pitch.sin,
                intensity: u8_at(point, 6).map_or(0.0, f32::from),
                ring,
                offset_ns: after_ns.saturating_add(block_ns),
            });
        }
    }
}
