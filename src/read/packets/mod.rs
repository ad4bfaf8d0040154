//! Packets of lidars, as they come over the network: points in the axes of the sensor's ROS driver.

use std::fmt;

/// Whose packets these are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Maker {
    /// Velodyne.
    Velodyne,
    /// Hesai.
    Hesai,
}

/// One packet as it was received.
#[derive(Clone, Copy, Debug)]
pub struct Packet<'p> {
    /// When the host received it, nanoseconds since 1970 (0 where unknown).
    pub received_ns: i64,
    /// The payload of the UDP datagram (1206 bytes for a VLP-16).
    pub bytes: &'p [u8],
}

/// One return, in the axes in which the sensor's ROS driver publishes its clouds, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Metres.
    pub x: f32,
    /// Metres.
    pub y: f32,
    /// Metres, up.
    pub z: f32,
    /// 0 to 255, as sent.
    pub intensity: f32,
    /// The beam, as the driver counts them.
    pub ring: u16,
    /// After `Scan::start_ns`, nanoseconds.
    pub offset_ns: i64,
}

/// What the packets of one message say.
#[derive(Clone, Debug)]
pub struct Scan {
    /// `VLP-16`, `Pandar40P`.
    pub model: &'static str,
    /// Nanoseconds since 1970, where known.
    pub start_ns: Option<i64>,
    /// The points.
    pub returns: Vec<Return>,
    /// Packets that could not be decoded.
    pub refused: usize,
    /// Why the first of them could not.
    pub reason: Option<PacketError>,
}

/// Why a packet is not decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PacketError {
    /// Stub.
    Unknown,
}

impl fmt::Display for PacketError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("unknown")
    }
}

/// Decodes the packets of one message.
pub fn decode<'p>(_maker: Maker, _packets: impl Iterator<Item = Packet<'p>>) -> Result<Scan, PacketError> {
    Err(PacketError::Unknown)
}
