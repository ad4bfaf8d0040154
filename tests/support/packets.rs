//! Packets of a VLP-16, from where its rays ended: the formulas of the user manual, solved for what a packet holds.
//!
//! Source: Velodyne, VLP-16 user manual (63-9243), chapter 9: a packet has 12 blocks of a mark, an azimuth in hundredths of a degree and two firing
//! sequences of 16 lasers with distances in 2 mm; then the time of the first firing in microseconds of the hour, and two factory bytes.

use nalgebra::Vector3;

/// From one firing sequence to the next, nanoseconds.
pub const SEQUENCE_NS: i64 = 55_296;
/// Firing sequences of a packet.
pub const SEQUENCES: usize = 24;
/// From one packet to the next, nanoseconds.
pub const PACKET_NS: i64 = 24 * SEQUENCE_NS;
/// Bytes of a packet.
pub const BYTES: usize = 1206;
/// Strongest return, VLP-16.
const FACTORY: [u8; 2] = [0x37, 0x22];
const HOUR_NS: i64 = 3_600_000_000_000;

/// A return.
#[derive(Clone, Copy, Debug)]
pub struct Shot {
    /// The firing sequence of the scan, from 0.
    pub sequence: usize,
    /// Where it ended: x forward, y left, z up, metres.
    pub place: Vector3<f64>,
}

/// A scan as packets.
#[derive(Clone, Debug)]
pub struct Scan {
    /// Firing sequences, a multiple of [`SEQUENCES`].
    pub sequences: usize,
    /// Of the first firing sequence, nanoseconds since 1970.
    pub start_ns: i64,
    /// The clock of the sensor runs backwards from packet to packet.
    pub backwards: bool,
}

impl Scan {
    /// When each packet was received, nanoseconds, and its bytes.
    pub fn packets(&self, shots: &[Shot]) -> Vec<(i64, Vec<u8>)> {
        let count = self.sequences / SEQUENCES;
        let step_deg = 360.0 / self.sequences as f64;
        let zero_deg = shots
            .first()
            .map_or(0.0, |shot| azimuth_deg(&shot.place) - step_deg * shot.sequence as f64);
        let at_ns = |packet: usize| self.start_ns + i64::try_from(packet).unwrap() * PACKET_NS;
        let mut packets: Vec<(i64, Vec<u8>)> = (0..count)
            .map(|packet| {
                let mut bytes = Vec::with_capacity(BYTES);
                for block in 0..12 {
                    let azimuth_deg = zero_deg + step_deg * (packet * SEQUENCES + 2 * block) as f64;
                    let hundredths = (azimuth_deg.rem_euclid(360.0) * 100.0).round() as u16 % 36_000;
                    bytes.extend([0xff, 0xee]);
                    bytes.extend(hundredths.to_le_bytes());
                    bytes.extend([0; 96]);
                }
                let stated_ns = at_ns(if self.backwards { count - 1 - packet } else { packet });
                let microseconds = (stated_ns.rem_euclid(HOUR_NS) / 1000) as u32;
                bytes.extend(microseconds.to_le_bytes());
                bytes.extend(FACTORY);
                (at_ns(packet + 1), bytes)
            })
            .collect();
        for shot in shots {
            let (packet, inside) = (shot.sequence / SEQUENCES, shot.sequence % SEQUENCES);
            let range_m = shot.place.norm();
            let at = inside / 2 * 100 + 4 + (inside % 2) * 48 + laser(shot.place.z / range_m) * 3;
            let distance = (range_m / 0.002).round() as u16;
            packets[packet].1[at..at + 2].copy_from_slice(&distance.to_le_bytes());
            packets[packet].1[at + 2] = 10;
        }
        packets
    }
}

/// Clockwise from above, from y of the sensor, which points forward.
fn azimuth_deg(place: &Vector3<f64>) -> f64 {
    (-place.y).atan2(place.x).to_degrees()
}

/// The laser of an elevation, by its sine: even numbers are below the horizon from 15 degrees down, odd ones above it from 1 degree up.
fn laser(sine: f64) -> usize {
    let row = f64::midpoint(sine.asin().to_degrees(), 15.0);
    assert!((row - row.round()).abs() < 1e-3, "no laser of a VLP-16 is at row {row}");
    let row = row.round() as usize;
    if row < 8 { 2 * row } else { 2 * (row - 8) + 1 }
}
