//! What is known of one sensor besides the packets of a scan: a packet or a file that tells the angles of its beams, or its metadata.

use std::sync::Arc;

use super::at128::Correction;
use super::{PacketError, robosense};
use crate::read::ouster::Metadata;

/// One sensor, as far as it is described.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unit {
    /// The last packet or text that describes the sensor (RoboSense: DIFOP; Ouster: metadata), empty where none was seen.
    info: Vec<u8>,
    /// What that text says.
    metadata: Option<Result<Metadata, PacketError>>,
    /// The file of corrections (Hesai's AT128).
    correction: Option<Arc<Correction>>,
}

impl Unit {
    /// Keeps a packet or text that describes the sensor; the others change nothing.
    pub fn take(&mut self, packet: &[u8]) {
        if !describes_sensor(packet) || self.info == packet {
            return;
        }
        packet.clone_into(&mut self.info);
        let text = std::str::from_utf8(packet).ok().filter(|text| text.starts_with('{'));
        self.metadata =
            text.map(|text| Metadata::parse(text).map_err(|error| PacketError::Other(format!("metadata: {error}"))));
    }

    /// The packet that describes the sensor.
    pub(super) fn info(&self) -> Option<&[u8]> {
        (!self.info.is_empty()).then_some(&self.info)
    }

    /// The sensor that has these corrections.
    #[must_use]
    pub fn corrected(correction: Arc<Correction>) -> Self {
        Self {
            correction: Some(correction),
            ..Self::default()
        }
    }

    /// Its corrections.
    pub(super) fn correction(&self) -> Option<&Correction> {
        self.correction.as_deref()
    }

    /// The metadata of an Ouster.
    pub(super) fn metadata(&self) -> Result<&Metadata, PacketError> {
        let metadata = self.metadata.as_ref().ok_or(PacketError::NoMetadata)?;
        metadata.as_ref().map_err(Clone::clone)
    }
}

/// Whether a packet has no points, but describes its sensor for the decoding of others; a text is in the place of a packet.
pub fn describes_sensor(packet: &[u8]) -> bool {
    robosense::is_info(packet) || packet.starts_with(b"{")
}
