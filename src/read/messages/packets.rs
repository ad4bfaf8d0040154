//! Messages with the packets of a lidar, a scan each, and the clouds that they hold.
//!
//! Owns the layouts of the messages, and that of the decoded cloud, which is that of velodyne_pointcloud: its times count from the stamp of the
//! header. What is in a packet is read by [`crate::read::packets`]. Sources: velodyne_msgs (VelodyneScan), pandar_msgs (PandarScan),
//! nebula_msgs (NebulaPackets); the order is the same in ROS 1 and ROS 2.

use std::borrow::Cow;

use super::cloud::{Cloud, Field};
use super::{Cursor, DecodeError};
use crate::read::packets::{Maker, Packet, Scan, decode};

/// Bytes of `VelodynePacket.data`.
const VELODYNE: usize = 1206;
/// Bytes of `PandarPacket.data`, of which the first `size` are the packet.
const PANDAR: usize = 1500;
/// First bytes of a packet of Hesai, and of a block of Velodyne or of older models of Hesai.
const HESAI_START: [u8; 2] = [0xee, 0xff];
const BLOCK_START: [u8; 2] = [0xff, 0xee];
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
    /// `nebula_msgs/NebulaPackets`, of any maker.
    Nebula,
}

/// The packets of one message, not decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawScan<'m> {
    carrier: Carrier,
    /// When the host received each, nanoseconds, and its bytes.
    packets: Vec<(i64, &'m [u8])>,
}

/// A cloud that was decoded from packets.
#[derive(Clone, Debug, PartialEq)]
pub struct DecodedCloud {
    /// The maker of the sensor: `Velodyne`.
    pub maker: &'static str,
    /// Its model, as the packets state it: `VLP-16`.
    pub model: &'static str,
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
        let received_ns = cursor.time()?;
        let bytes = match carrier {
            Carrier::Velodyne => cursor.take(VELODYNE)?,
            Carrier::Nebula => cursor.bytes()?,
            Carrier::Pandar => {
                let data = cursor.take(PANDAR)?;
                let size = cursor.u32()?;
                let bytes = usize::try_from(size).ok().and_then(|size| data.get(..size));
                bytes.ok_or_else(|| DecodeError(format!("a packet of {size} bytes in a field of {PANDAR}")))?
            }
        };
        packets.push((received_ns, bytes));
    }
    Ok(RawScan { carrier, packets })
}

impl RawScan<'_> {
    /// How many packets it has.
    pub fn packets(&self) -> usize {
        self.packets.len()
    }

    /// The maker of the sensor; the error shows how its packets begin.
    fn maker(&self) -> Result<Maker, DecodeError> {
        match self.carrier {
            Carrier::Velodyne => return Ok(Maker::Velodyne),
            Carrier::Pandar => return Ok(Maker::Hesai),
            Carrier::Nebula => {}
        }
        let first = self.packets.first().map_or(&[] as &[u8], |(_, bytes)| bytes);
        if first.starts_with(&HESAI_START) {
            return Ok(Maker::Hesai);
        }
        if first.starts_with(&BLOCK_START) {
            let is_velodyne = first.len() == VELODYNE;
            return Ok(if is_velodyne { Maker::Velodyne } else { Maker::Hesai });
        }
        let start = first.first_chunk().map_or(0, |start| u16::from_be_bytes(*start));
        Err(DecodeError(format!(
            "a packet of {} bytes that begins with {start:#06x} is neither of Velodyne nor of Hesai",
            first.len()
        )))
    }

    /// Decodes the packets; `stamp_ns` is the stamp of the message's header, nanoseconds.
    pub fn decode(&self, stamp_ns: i64) -> Result<DecodedCloud, DecodeError> {
        let maker = self.maker()?;
        let packets = self.packets.iter().map(|(received_ns, bytes)| Packet {
            received_ns: *received_ns,
            bytes,
        });
        let scan = decode(maker, packets).map_err(|error| DecodeError(error.to_string()))?;
        Ok(DecodedCloud {
            maker: match maker {
                Maker::Velodyne => "Velodyne",
                Maker::Hesai => "Hesai",
            },
            model: scan.model,
            cloud: cloud(&scan, self.start_ns(&scan, stamp_ns)),
            refused: scan.refused,
            reason: scan.reason.map(|reason| reason.to_string()),
        })
    }

    /// From the header's stamp to the start of the scan, nanoseconds: by the host's clock, as drivers do, else by the sensor's; zero where both
    /// are far from the stamp.
    fn start_ns(&self, scan: &Scan, stamp_ns: i64) -> i64 {
        let received = self.packets.first().map(|(received_ns, _)| *received_ns);
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
