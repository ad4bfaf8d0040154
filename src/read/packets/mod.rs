//! Raw packets of lidars decoded into returns, by the layouts and angles of the vendors' user manuals and drivers.
//!
//! Frame: x forward, y left, z up for Velodyne (the driver turns the sensor's axes, y forward and x right), RoboSense and
//! Livox. Hesai's driver keeps the sensor's own axes: azimuth 0 is +y, azimuth 90° is +x. Azimuths run clockwise seen from
//! above.

use std::borrow::Cow;

mod at128;
mod boundary;
mod bytes;
mod date;
mod error;
mod hesai;
mod hesai_models;
mod livox;
mod ouster;
mod robosense;
mod robosense_models;
mod robosense_solid;
mod robosense_tables;
mod turn;
mod unit;
mod velodyne;
mod velodyne_models;

#[cfg(test)]
mod at128_tests;
#[cfg(test)]
mod hesai_tests;
#[cfg(test)]
mod livox_tests;
#[cfg(test)]
mod robosense_tests;
#[cfg(test)]
mod velodyne_tests;

pub use at128::Correction;
pub use boundary::{Boundary, boundary};
pub use error::PacketError;
pub use ouster::STORED;
pub use unit::{Unit, describes_sensor};

/// Whose packets these are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Maker {
    /// Velodyne: VLP-16, VLP-32C, HDL-32E, VLS-128.
    Velodyne,
    /// Hesai: Pandar40P, Pandar64, `PandarQT64`, `PandarQT128`, `PandarXT16`, `PandarXT32`, `PandarXT32M`, `Pandar128E4X`,
    /// `PandarAT128`.
    Hesai,
    /// `RoboSense`: RS-LiDAR-16, RS-LiDAR-32, RS-Bpearl, RS-Helios, RS-Ruby, RS-LiDAR-M1.
    RoboSense,
    /// Livox: what they have in common, for their packets do not name the model.
    Livox,
    /// Ouster: OS0, OS1, OS2, OSDome; the packets hold no angles, which are in the metadata of the sensor.
    Ouster,
}

impl Maker {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velodyne => "Velodyne",
            Self::Hesai => "Hesai",
            Self::RoboSense => "RoboSense",
            Self::Livox => "Livox",
            Self::Ouster => "Ouster",
        }
    }

    /// Whose packet this is, by its first bytes and its length.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(&[0xEE, 0xFF]) {
            Some(Self::Hesai)
        } else if bytes.starts_with(&[0xFF, 0xEE]) {
            Some(if bytes.len() == velodyne::PACKET_BYTES {
                Self::Velodyne
            } else {
                Self::Hesai
            })
        } else if robosense::is_robosense(bytes) {
            Some(Self::RoboSense)
        } else if livox::is_livox(bytes) {
            Some(Self::Livox)
        } else {
            ouster::is_ouster(bytes).then_some(Self::Ouster)
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
    /// Forward. Hesai: towards azimuth 90° (right of the sensor's zero direction).
    pub x: f32,
    /// Left. Hesai: towards azimuth 0.
    pub y: f32,
    /// Up.
    pub z: f32,
    /// 0..255, as sent.
    pub intensity: f32,
    /// Velodyne, `RoboSense`: row from the lowest beam up (M1: place in the block). Hesai: channel from 0 in the order of the
    /// packet (from the highest beam down, but from the lowest up on the QT sensors). Livox: zero.
    pub ring: u16,
    /// After [`Scan::start_ns`], nanoseconds (may be negative).
    pub offset_ns: i64,
}

/// What the packets of one message say.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// "VLP-16", "Pandar40P", ...
    pub model: Cow<'static, str>,
    /// Time of the first decoded packet, nanoseconds since 1970. Hesai, `RoboSense`: by the sensor's own clock and date, also
    /// where that clock was never set. Livox: by the sensor's clock where it is synchronised, else as Velodyne. Velodyne: by the sensor's clock within the hour where it agrees with the host's clock, else by
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
    decode_with(maker, packets, &Unit::default())
}

/// The same with what is known of the sensor from other packets.
///
/// # Errors
/// Where no packet could be decoded: why the first could not.
pub fn decode_with<'p>(
    maker: Maker,
    packets: impl Iterator<Item = Packet<'p>>,
    unit: &Unit,
) -> Result<Scan, PacketError> {
    // What describes the sensor was taken in.
    let packets = packets.filter(|packet| !describes_sensor(packet.bytes));
    match maker {
        Maker::Velodyne => collect(packets, velodyne::Decoder::default()),
        Maker::Hesai => collect(packets, hesai::Decoder::new(unit)),
        Maker::RoboSense => collect(packets, robosense::Decoder::new(unit)),
        Maker::Livox => collect(packets, livox::Decoder::default()),
        Maker::Ouster => ouster::decode(packets, unit),
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
            model: Cow::Borrowed(model),
            start_ns,
            returns,
            refused,
            reason,
        }),
        None => Err(reason.unwrap_or(PacketError::Empty)),
    }
}
