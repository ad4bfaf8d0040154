//! Raw packets of lidars (Velodyne, Hesai) decoded into returns, by the layouts and angles of the vendors' user manuals.
//!
//! Frame: x forward, y left, z up for Velodyne (the driver turns the sensor's axes, y forward and x right). Hesai's driver
//! keeps the sensor's own axes: azimuth 0 is +y, azimuth 90° is +x. Azimuths run clockwise seen from above.

mod boundary;
mod bytes;
mod error;
mod hesai;
mod hesai_models;
mod hesai_tables;
mod sender;
mod turn;
mod velodyne;
mod velodyne_models;
mod velodyne_tables;

#[cfg(test)]
mod hesai_tests;
#[cfg(test)]
mod velodyne_tests;

pub use boundary::{Boundary, boundary};
pub use error::PacketError;
pub use sender::Sender;

/// Whose packets these are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Maker {
    /// Velodyne: VLP-16, VLP-32C, HDL-32E, VLS-128.
    Velodyne,
    /// Hesai: Pandar40P, Pandar64, `PandarQT64`, `PandarQT128`, `PandarXT16`, `PandarXT32`, `PandarXT32M`, `Pandar128E4X`.
    Hesai,
}

impl Maker {
    /// By how a packet begins; `None` where it is of none of them.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        match bytes {
            // Hesai: the start of the header; older models begin with the mark of a block, as Velodyne does.
            [0xee, 0xff, ..] => Some(Self::Hesai),
            [0xff, 0xee, ..] if bytes.len() == velodyne::PACKET_BYTES => Some(Self::Velodyne),
            [0xff, 0xee, ..] => Some(Self::Hesai),
            _ => None,
        }
    }
}

/// One packet as it was received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet<'p> {
    /// When the host received it, nanoseconds since 1970 (0 where unknown).
    pub received_ns: i64,
    /// The payload of the UDP datagram (1206 bytes for a VLP-16).
    pub bytes: &'p [u8],
}

/// One return, in the axes in which the sensor's ROS driver publishes its clouds, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Velodyne: forward. Hesai: towards azimuth 90° (right of the sensor's zero direction).
    pub x: f32,
    /// Velodyne: left. Hesai: towards azimuth 0.
    pub y: f32,
    /// Up.
    pub z: f32,
    /// 0..255, as sent.
    pub intensity: f32,
    /// Velodyne: row from the lowest beam up. Hesai: channel from 0 in the order of the packet (from the highest beam down,
    /// but from the lowest up on the QT sensors).
    pub ring: u16,
    /// After [`Scan::start_ns`], nanoseconds (may be negative).
    pub offset_ns: i64,
}

/// What the packets of one message say.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// "VLP-16", "Pandar40P", ...
    pub model: &'static str,
    /// Time of the first decoded packet, nanoseconds since 1970. Hesai: by the sensor's own clock and date, also where that
    /// clock was never set. Velodyne: by the sensor's clock within the hour where it agrees with the host's clock, else by
    /// the host's `received_ns`; None where that is unknown.
    pub start_ns: Option<i64>,
    /// The returns in the order of the packets.
    pub returns: Vec<Return>,
    /// Packets of the message that could not be decoded.
    pub refused: usize,
    /// Why the first of them could not.
    pub reason: Option<PacketError>,
}

/// Decodes the packets of one message (one scan as `velodyne_msgs/VelodyneScan`, `pandar_msgs/PandarScan` and
/// `nebula_msgs/NebulaPackets` have them). Left out are returns of distance zero (none received) and, of a dual or triple
/// return, those that repeat another one of the same shot.
///
/// # Errors
/// Where no packet could be decoded: why the first could not.
pub fn decode<'p>(maker: Maker, packets: impl Iterator<Item = Packet<'p>>) -> Result<Scan, PacketError> {
    match maker {
        Maker::Velodyne => collect(packets, velodyne::Decoder::default()),
        Maker::Hesai => collect(packets, hesai::Decoder::default()),
    }
}

/// A maker's way from one packet to returns.
trait Decode {
    /// Appends the returns of the packet, or none of them where it is refused.
    fn packet(&mut self, packet: &Packet<'_>, returns: &mut Vec<Return>) -> Result<(), PacketError>;
    /// The model of the packets so far, and the time of the first of them.
    fn identity(&self) -> Option<(&'static str, Option<i64>)>;
}

fn collect<'p>(packets: impl Iterator<Item = Packet<'p>>, mut decoder: impl Decode) -> Result<Scan, PacketError> {
    // Room for the packets of an ordinary scan, 384 returns each, so that the list does not move while it grows.
    let mut returns = Vec::with_capacity(384 * packets.size_hint().0.min(1024));
    let (mut refused, mut reason) = (0, None);
    for packet in packets {
        if let Err(error) = decoder.packet(&packet, &mut returns) {
            refused += 1;
            reason.get_or_insert(error);
        }
    }
    match decoder.identity() {
        Some((model, start_ns)) => Ok(Scan {
            model,
            start_ns,
            returns,
            refused,
            reason,
        }),
        None => Err(reason.unwrap_or(PacketError::Empty)),
    }
}
