//! A lidar packet taken apart: its header and its columns.
//!
//! Source: ouster-sdk, `ouster_core/src/parsing.cpp`; Ouster's firmware user manual, chapter on lidar data packets.

use super::profiles::{
    FOOTER, HEADLESS, Heads, LEGACY, MEASUREMENT_ID, PROFILES, Profile, SAFETY, STANDARD, STATUS, TIMESTAMP,
};
use super::{Metadata, OusterError};

/// The type of a lidar packet.
const LIDAR: u16 = 1;
/// The most bytes that a UDP datagram can have.
const MOST_BYTES: usize = 65535;

/// How a sensor's lidar packets are laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// The layout of a pixel.
    pub profile: &'static Profile,
    /// Columns of a packet.
    pub columns: usize,
    /// Pixels of a column.
    pub rows: usize,
    heads: &'static Heads,
}

/// What the header of a packet says; all but the frame id is 0 in the profile "LEGACY".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// 1 lidar, 2 IMU, 3 zones.
    pub packet_type: u16,
    /// The number of the turn; it starts again behind 65535, or 2³² − 1 in a header of functional safety.
    pub frame_id: u32,
    /// The sensor's serial number.
    pub serial: u64,
}

/// One column of a packet: what all beams measured at one angle of the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column<'p> {
    /// Nanoseconds by the sensor's clock.
    pub timestamp_ns: u64,
    /// Its number within the turn.
    pub measurement_id: u16,
    /// Status as sent, 16 bits; 32 in the profile "LEGACY".
    pub status: u32,
    /// The pixels, from the highest beam down.
    pub pixels: &'p [u8],
}

impl Column<'_> {
    /// Whether the column was measured.
    pub fn valid(&self) -> bool {
        self.status & 1 == 1
    }
}

/// The header of packets as the metadata states it.
pub(super) fn heads(metadata: &Metadata) -> &'static Heads {
    match (metadata.lidar_profile.as_str(), metadata.safety_header) {
        (LEGACY, _) => &HEADLESS,
        (_, true) => &SAFETY,
        (_, false) => &STANDARD,
    }
}

impl Heads {
    /// The header of a packet; None where the packet ends within it.
    pub(super) fn read(&self, bytes: &[u8]) -> Option<Header> {
        Some(Header {
            packet_type: u16::try_from(self.packet_type.of(bytes)?).ok()?,
            frame_id: u32::try_from(self.frame_id.of(bytes)?).ok()?,
            serial: self.serial.of(bytes)?,
        })
    }

    /// The header of a packet that is to be of this type and of the metadata's sensor.
    pub(super) fn check(
        &self,
        metadata: &Metadata,
        expected: u16,
        bytes: &[u8],
    ) -> Result<Option<Header>, OusterError> {
        let Some(header) = self.read(bytes) else {
            return Ok(None);
        };
        if self.packet_type.count > 0 && header.packet_type != expected {
            return Err(OusterError::Type {
                found: header.packet_type,
                expected,
            });
        }
        if header.serial != 0 && metadata.serial != 0 && header.serial != metadata.serial {
            return Err(OusterError::Serial {
                packet: header.serial,
                metadata: metadata.serial,
            });
        }
        Ok(Some(header))
    }
}

impl Layout {
    /// The layout of the lidar packets of a sensor.
    ///
    /// # Errors
    /// Where the profile is not known, or a packet of it would not fit into a UDP datagram.
    pub fn of(metadata: &Metadata) -> Result<Self, OusterError> {
        let profile = PROFILES
            .iter()
            .find(|profile| profile.name == metadata.lidar_profile)
            .ok_or_else(|| OusterError::Profile {
                name: metadata.lidar_profile.clone(),
            })?;
        let layout = Self {
            profile,
            columns: usize::from(metadata.columns_per_packet),
            rows: usize::from(metadata.pixels_per_column),
            heads: heads(metadata),
        };
        if layout.packet_bytes() > MOST_BYTES {
            return Err(OusterError::Range {
                key: "columns_per_packet",
                found: layout.columns as u64,
                least: 1,
                most: (MOST_BYTES / layout.column_bytes()) as u64,
            });
        }
        Ok(layout)
    }

    fn column_bytes(&self) -> usize {
        self.heads.column_bytes + self.rows * self.profile.pixel_bytes + self.heads.footer_bytes
    }

    /// The bytes of each lidar packet.
    pub fn packet_bytes(&self) -> usize {
        2 * self.heads.packet_bytes + self.columns * self.column_bytes()
    }

    /// The header and the columns of a packet; invalid columns are among them. The number of the sensor's last start is not
    /// compared with that of the metadata, as a new start alone changes nothing in the layout.
    ///
    /// # Errors
    /// Where the packet has another size than the layout, is of another type, or is of another sensor.
    pub fn read<'p>(
        &self,
        metadata: &Metadata,
        bytes: &'p [u8],
    ) -> Result<(Header, impl Iterator<Item = Column<'p>>), OusterError> {
        let expected = self.packet_bytes();
        let length = OusterError::Length {
            bytes: bytes.len(),
            profile: self.profile.name,
            columns: self.columns,
            expected,
        };
        if bytes.len() != expected {
            return Err(length);
        }
        let header = self
            .heads
            .check(metadata, LIDAR, bytes)?
            .ok_or_else(|| length.clone())?;
        let columns = bytes
            .get(self.heads.packet_bytes..)
            .ok_or(length)?
            .chunks_exact(self.column_bytes());
        let (heads, rows) = (self.heads, self.rows * self.profile.pixel_bytes);
        Ok((
            header,
            columns
                .take(self.columns)
                .filter_map(move |bytes| column(heads, rows, bytes)),
        ))
    }
}

fn column<'p>(heads: &Heads, rows: usize, bytes: &'p [u8]) -> Option<Column<'p>> {
    let (head, rest) = bytes.split_at_checked(heads.column_bytes)?;
    let (pixels, footer) = rest.split_at_checked(rows)?;
    let status = if heads.footer_bytes > 0 {
        FOOTER.of(footer)?
    } else {
        STATUS.of(head)?
    };
    Some(Column {
        timestamp_ns: TIMESTAMP.of(head)?,
        measurement_id: u16::try_from(MEASUREMENT_ID.of(head)?).ok()?,
        status: u32::try_from(status).ok()?,
        pixels,
    })
}
