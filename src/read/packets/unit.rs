//! What is known of one sensor besides the packets of a scan: a packet that tells the angles of its beams.

use super::robosense;

/// One sensor, as far as its own packets describe it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Unit {
    /// The last packet that describes the sensor (RoboSense: DIFOP), empty where none was seen.
    info: Vec<u8>,
}

impl Unit {
    /// Keeps a packet that describes the sensor; the others change nothing.
    pub fn take(&mut self, packet: &[u8]) {
        if robosense::is_info(packet) && self.info != packet {
            packet.clone_into(&mut self.info);
        }
    }

    /// The packet that describes the sensor.
    pub(super) fn info(&self) -> Option<&[u8]> {
        (!self.info.is_empty()).then_some(&self.info)
    }
}
