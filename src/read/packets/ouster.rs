//! Ouster's packets, and scans stored in its OSF files, decoded by the metadata of the sensor.
//!
//! Frame: the sensor's, as Ouster's tools and the driver of ROS 1 publish by default: x away from the connector, y left, z up, from the
//! bottom of the sensor. Owns how packets without metadata are recognised. Source: Ouster, Firmware User Manual, sensor data.

use super::bytes::{u16_at, u64_at};
use super::{Packet, PacketError, Return, Scan, Unit};
use crate::read::ouster::{self, Axes, osf};

/// What precedes a scan of an OSF file in the place of a packet.
pub const STORED: &[u8] = b"OSF scan";
/// Bytes of the packet header since firmware 2.0, and of the footer.
const HEADER: usize = 32;

/// Decodes the packets of one turn, or a stored scan.
pub(super) fn decode<'p>(packets: impl Iterator<Item = Packet<'p>>, unit: &Unit) -> Result<Scan, PacketError> {
    let metadata = unit.metadata()?;
    let mut packets = packets.peekable();
    let stored = packets.peek().and_then(|packet| {
        let bytes = packet.bytes.strip_prefix(STORED)?;
        Some(osf::stored(bytes, packet.received_ns, metadata, Axes::Sensor))
    });
    let scan = if let Some(stored) = stored {
        stored.map_err(|error| PacketError::Other(error.to_string()))?
    } else {
        let size = ouster::Layout::of(metadata).map_or(usize::MAX, |layout| layout.packet_bytes());
        // The driver of ROS 1 publishes its buffers, which have a byte more.
        let packets = packets.map(|packet| {
            let whole = packet.bytes.get(..size).filter(|_| packet.bytes.len() == size + 1);
            (packet.received_ns, whole.unwrap_or(packet.bytes))
        });
        ouster::decode(metadata, packets, Axes::Sensor).map_err(|error| PacketError::Other(error.to_string()))?
    };
    let returns = scan.returns.into_iter().map(|point| Return {
        x: point.x,
        y: point.y,
        z: point.z,
        intensity: point.intensity,
        ring: point.ring,
        offset_ns: point.offset_ns,
    });
    Ok(Scan {
        model: scan.model.into(),
        start_ns: scan.start_ns,
        returns: returns.collect(),
        refused: scan.refused,
        reason: scan.reason.map(|reason| PacketError::Other(reason.to_string())),
    })
}

/// What all packets of a turn have in common and those of the next have not; `None` where these are no columns.
pub(super) fn turn(bytes: &[u8]) -> Option<u64> {
    match header(bytes)? {
        // The number of the turn stands in each column.
        0 => u16_at(bytes, 10).map(u64::from),
        // Type, number of the turn, and number of the sensor's last start, in an order that depends on the model.
        _ => u64_at(bytes, 0),
    }
}

/// Whether a packet is one of Ouster.
pub(super) fn is_ouster(bytes: &[u8]) -> bool {
    header(bytes).is_some() || bytes.starts_with(STORED)
}

/// Bytes before the columns of a packet; `None` where these are no 16 columns of the same length whose numbers follow each other.
fn header(bytes: &[u8]) -> Option<usize> {
    let has_header = bytes.first() == Some(&1);
    let forms = [(0, true), (HEADER, has_header)];
    let fits = |header: usize| {
        // The buffers of the driver of ROS 1 have a byte more.
        let column = bytes.len().checked_sub(2 * header)? / 16;
        let is_whole = (bytes.len() - 2 * header) % 16 <= 1;
        // A column has a time of eight bytes, its number, and at least sixteen pixels.
        let number = |index: usize| u16_at(bytes, header + column * index + 8);
        let follows = |index: usize| {
            let (this, next) = (number(index), number(index + 1));
            this.zip(next)
                .is_some_and(|(this, next)| next == this.wrapping_add(1) && next < 4096)
        };
        (is_whole && column >= 64 && (0..15).all(follows)).then_some(header)
    };
    let mut possible = forms.into_iter().filter(|(_, may_be)| *may_be);
    possible.find_map(|(header, _)| fits(header))
}
