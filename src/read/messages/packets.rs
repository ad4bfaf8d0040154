//! Messages with the packets of a lidar, a scan each, and the clouds that they hold.
//!
//! Owns the layouts of the messages, and that of the decoded cloud, which is that of velodyne_pointcloud: its times count from the stamp of the
//! header. What is in a packet is read by [`crate::read::packets`]. Sources: velodyne_msgs (VelodyneScan), pandar_msgs (PandarScan),
//! nebula_msgs (NebulaPackets), robosense_msgs (RobosenseScan), rslidar_msgs (rslidarScan); the order is the same in ROS 1 and ROS 2.
//! The same packets may come one by one (VelodynePacket, PandarPacket, NebulaPacket, and UdpPacket of udp_msgs): [`crate::read::scans`] makes
//! scans of them.

use std::borrow::Cow;

use super::cloud::{Cloud, Field};
use super::{Cursor, DecodeError};
use crate::read::packets::{Maker, Packet, Scan, Unit, decode_with, describes_sensor};

/// Bytes of `VelodynePacket.data`.
const VELODYNE: usize = 1206;
/// Bytes of `PandarPacket.data`, of which the first `size` are the packet.
const PANDAR: usize = 1500;
/// Bytes of `RobosensePacket.data` and `rslidarPacket.data`.
const ROBOSENSE: usize = 1248;
/// The encoding of messages that were made here, in CDR, of data that mostly state no frame: `sensor_msgs/Imu`, `nmea_msgs/Sentence`, and of
/// channels of any other type scans with the fields of `nebula_msgs/NebulaPackets`.
pub const ASSEMBLED: &str = "assembled";
/// How far the clock of a sensor may be from the header's stamp for the points to be timed by it, nanoseconds: clocks without
/// synchronisation count from 1970, or from when they were switched on.
const NEAR_NS: u64 = 1_000_000_000;
/// Bytes of a decoded point.
const POINT_STEP: u32 = 22;
/// The fields of a decoded point: name, offset and type, as velodyne_pointcloud has them (point_types.h: PointXYZIRT).
const FIELDS: [(&str, u32, u8); 6] = [
    ("x", 0, 7),
    ("y", 4, 7),
    ("z", 8, 7),
    ("intensity", 12, 7),
    ("ring", 16, 4),
    ("time", 18, 7),
];

/// How a message holds packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// `velodyne_msgs/VelodyneScan`.
    Velodyne,
    /// `pandar_msgs/PandarScan`.
    Pandar,
    /// `robosense_msgs/RobosenseScan`, `rslidar_msgs/rslidarScan`.
    RoboSense,
    /// `nebula_msgs/NebulaPackets`, of any maker.
    Nebula,
    /// Assembled of single packets, see [`ASSEMBLED`].
    Assembled,
}

/// The packets of one message, not decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawScan<'m> {
    carrier: Carrier,
    packets: Vec<Packet<'m>>,
}

/// A cloud that was decoded from packets.
#[derive(Clone, Debug, PartialEq)]
pub struct DecodedCloud {
    /// The maker of the sensor: `Velodyne`.
    pub maker: &'static str,
    /// Its model, as the packets or the metadata state it: `VLP-16`.
    pub model: Cow<'static, str>,
    /// x, y and z in metres, in the axes of the sensor's ROS driver; the time in seconds after the header's stamp.
    pub cloud: Cloud<'static>,
    /// Packets of the message that were not decoded.
    pub refused: usize,
    /// Why the first of them was not.
    pub reason: Option<String>,
}

/// Reads the rest of a message with packets after its header.
pub(super) fn scan<'m>(carrier: Carrier, cursor: &mut Cursor<'m>) -> Result<RawScan<'m>, DecodeError> {
    let count = cursor.sequence()?;
    let mut packets = Vec::new();
    for _ in 0..count {
        packets.push(packet(carrier, cursor)?);
    }
    Ok(RawScan { carrier, packets })
}

/// Reads one packet.
pub(super) fn packet<'m>(carrier: Carrier, cursor: &mut Cursor<'m>) -> Result<Packet<'m>, DecodeError> {
    let received_ns = cursor.time()?;
    let bytes = match carrier {
        Carrier::Velodyne => cursor.take(VELODYNE)?,
        Carrier::RoboSense => cursor.take(ROBOSENSE)?,
        Carrier::Nebula | Carrier::Assembled => cursor.bytes()?,
        Carrier::Pandar => {
            let data = cursor.take(PANDAR)?;
            let size = cursor.u32()?;
            let bytes = usize::try_from(size).ok().and_then(|size| data.get(..size));
            bytes.ok_or_else(|| DecodeError(format!("a packet of {size} bytes in a field of {PANDAR}")))?
        }
    };
    Ok(Packet { received_ns, bytes })
}

/// Reads the rest of a `udp_msgs/UdpPacket` after its header: who sent it, and the packet, which was received at the header's stamp.
pub(super) fn udp_packet<'m>(received_ns: i64, cursor: &mut Cursor<'m>) -> Result<Packet<'m>, DecodeError> {
    cursor.skip_str()?;
    cursor.u16()?;
    let bytes = cursor.bytes()?;
    Ok(Packet { received_ns, bytes })
}

impl RawScan<'_> {
    /// How many packets it has.
    pub fn packets(&self) -> usize {
        let data = self.packets.iter().filter(|packet| !describes_sensor(packet.bytes));
        data.count()
    }

    /// The maker of the sensor; the error shows how its packets begin.
    fn maker(&self) -> Result<Maker, DecodeError> {
        match self.carrier {
            Carrier::Velodyne => return Ok(Maker::Velodyne),
            Carrier::Pandar => return Ok(Maker::Hesai),
            Carrier::RoboSense => return Ok(Maker::RoboSense),
            Carrier::Nebula | Carrier::Assembled => {}
        }
        let mut data = self.packets.iter().filter(|packet| !describes_sensor(packet.bytes));
        let first = data.next().map_or(&[] as &[u8], |packet| packet.bytes);
        Maker::of(first).ok_or_else(|| {
            let start = first.first_chunk().map_or(0, |start| u16::from_be_bytes(*start));
            DecodeError(format!(
                "a packet of {} bytes that begins with {start:#06x} is of no known maker (Velodyne, Hesai, RoboSense, Livox, Ouster)",
                first.len()
            ))
        })
    }

    /// Keeps what the packets tell of the sensor.
    pub fn describe(&self, unit: &mut Unit) {
        for packet in &self.packets {
            unit.take(packet.bytes);
        }
    }

    /// Decodes the packets; `stamp_ns` is the stamp of the message's header, nanoseconds.
    pub fn decode(&self, stamp_ns: i64) -> Result<DecodedCloud, DecodeError> {
        let mut unit = Unit::default();
        self.describe(&mut unit);
        self.decode_with(stamp_ns, &unit)
    }

    /// The same with what is known of the sensor.
    pub fn decode_with(&self, stamp_ns: i64, unit: &Unit) -> Result<DecodedCloud, DecodeError> {
        let maker = self.maker()?;
        let packets = self.packets.iter().copied();
        let scan = decode_with(maker, packets, unit).map_err(|error| DecodeError(error.to_string()))?;
        Ok(DecodedCloud {
            maker: maker.name(),
            cloud: cloud(&scan, self.start_ns(&scan, stamp_ns)),
            model: scan.model,
            refused: scan.refused,
            reason: scan.reason.map(|reason| reason.to_string()),
        })
    }

    /// From the header's stamp to the start of the scan, nanoseconds: by the host's clock, as drivers do, else by the sensor's; zero where both
    /// are far from the stamp.
    fn start_ns(&self, scan: &Scan, stamp_ns: i64) -> i64 {
        let received = self.packets.first().map(|packet| packet.received_ns);
        let after = |at_ns: i64| at_ns.saturating_sub(stamp_ns);
        let starts = received.into_iter().chain(scan.start_ns).map(after);
        starts
            .into_iter()
            .find(|after| after.unsigned_abs() <= NEAR_NS)
            .unwrap_or(0)
    }
}

/// The cloud of a scan that starts so many nanoseconds after the header's stamp.
#[allow(clippy::cast_possible_truncation)] // a scan lasts a second at most: float32 resolves a tenth of a microsecond
fn cloud(scan: &Scan, start_ns: i64) -> Cloud<'static> {
    let mut data = Vec::with_capacity(scan.returns.len().saturating_mul(POINT_STEP as usize));
    for point in &scan.returns {
        for value in [point.x, point.y, point.z, point.intensity] {
            data.extend(value.to_le_bytes());
        }
        data.extend(point.ring.to_le_bytes());
        let after_s = start_ns.saturating_add(point.offset_ns) as f64 * 1e-9;
        data.extend((after_s as f32).to_le_bytes());
    }
    let width = u32::try_from(scan.returns.len()).unwrap_or(u32::MAX);
    let fields = FIELDS.map(|(name, offset, datatype)| Field {
        name: Cow::Borrowed(name),
        offset,
        datatype,
        count: 1,
    });
    Cloud {
        height: 1,
        width,
        fields: fields.into(),
        is_bigendian: false,
        point_step: POINT_STEP,
        row_step: width.saturating_mul(POINT_STEP),
        data: Cow::Owned(data),
        timebase_ns: None,
    }
}
