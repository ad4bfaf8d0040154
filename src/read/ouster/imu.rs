//! The sensor's own IMU: packets of both layouts decoded into measurements.
//!
//! Frame: the IMU's. Source: ouster-sdk,
//! `ouster_core/src/parsing.cpp` and `packet.cpp`; Ouster's firmware user manual, chapter on IMU data packets.

use super::packet::heads;
use super::profiles::{Bits, LEGACY, STATUS, TIMESTAMP};
use super::{Metadata, OusterError};

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.80665;
/// The type of an IMU packet.
const TYPE: u16 = 2;
const LEGACY_BYTES: usize = 48;
/// Its time and the last NMEA sentence, which precede the measurements of a packet with a header.
const NMEA_BYTES: usize = 100;
const MEASUREMENT_BYTES: usize = 36;

/// One measurement of the IMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imu {
    /// Nanoseconds by the sensor's clock; of "LEGACY", when the gyroscope was read.
    pub timestamp_ns: u64,
    /// m/s²; at rest, upwards.
    pub acceleration: [f64; 3],
    /// rad/s.
    pub angular_rate: [f64; 3],
}

impl Imu {
    /// A measurement as newer layouts have it: acceleration in m/s², then angular rate in rad/s.
    pub(crate) fn new(timestamp_ns: u64, [acceleration, angular_rate]: [[f64; 3]; 2]) -> Self {
        Self {
            timestamp_ns,
            acceleration,
            angular_rate,
        }
    }
}

/// Whether a packet may be of an IMU, by its length or the type that it states; the buffers of the driver of ROS 1 have a byte more.
pub fn may_be_imu(bytes: &[u8]) -> bool {
    (LEGACY_BYTES..=LEGACY_BYTES + 1).contains(&bytes.len()) || (bytes.len() > NMEA_BYTES && bytes.first() == Some(&2))
}

/// The measurements of an IMU packet; those that the sensor marks as invalid are left out.
///
/// # Errors
/// Where the profile is not known, or the packet has not its size, is of another type, or is of another sensor.
pub fn imu(metadata: &Metadata, bytes: &[u8]) -> Result<Vec<Imu>, OusterError> {
    let heads = heads(metadata);
    let measurements = usize::from(metadata.imu_measurements_per_packet);
    let (profile, columns, expected) = match metadata.imu_profile.as_str() {
        LEGACY => (LEGACY, 1, LEGACY_BYTES),
        "ACCEL32_GYRO32_NMEA" => (
            "ACCEL32_GYRO32_NMEA",
            measurements,
            2 * heads.packet_bytes + NMEA_BYTES + measurements * MEASUREMENT_BYTES,
        ),
        name => return Err(OusterError::Profile { name: name.to_owned() }),
    };
    let length = OusterError::Length {
        bytes: bytes.len(),
        profile,
        columns,
        expected,
    };
    if bytes.len() != expected {
        return Err(length);
    }
    if profile == LEGACY {
        let [acceleration_g, angular_rate_deg] = vectors(bytes, 24).ok_or_else(|| length.clone())?;
        return Ok(vec![Imu {
            timestamp_ns: time(bytes, 16).ok_or(length)?,
            acceleration: acceleration_g.map(|x| x * GRAVITY),
            angular_rate: angular_rate_deg.map(f64::to_radians),
        }]);
    }
    heads.check(metadata, TYPE, bytes)?;
    let body = bytes.get(heads.packet_bytes + NMEA_BYTES..).ok_or(length)?;
    Ok(body
        .chunks_exact(MEASUREMENT_BYTES)
        .take(measurements)
        .filter_map(measurement)
        .collect())
}

fn measurement(bytes: &[u8]) -> Option<Imu> {
    if STATUS.of(bytes)? & 1 == 0 {
        return None;
    }
    Some(Imu::new(time(bytes, 0)?, vectors(bytes, 12)?))
}

fn time(bytes: &[u8], at: u16) -> Option<u64> {
    Bits {
        first: at * 8,
        ..TIMESTAMP
    }
    .of(bytes)
}

/// Two vectors of three floats each.
fn vectors(bytes: &[u8], at: usize) -> Option<[[f64; 3]; 2]> {
    let mut floats = bytes.get(at..)?.chunks_exact(4);
    let mut vector = [[0.; 3]; 2];
    for x in vector.as_flattened_mut() {
        *x = f64::from(f32::from_le_bytes(floats.next()?.try_into().ok()?));
    }
    Some(vector)
}
