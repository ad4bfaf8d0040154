//! Messages that are written here, in little-endian CDR: scans assembled of single packets, measurements of IMUs, datagrams and
//! sentences out of captures.
//!
//! Owns their layouts: `nebula_msgs/NebulaPackets`, `udp_msgs/UdpPacket`, `sensor_msgs/Imu`, `nmea_msgs/Sentence`.

use crate::read::ouster::Imu;
use crate::read::packets::Packet;

/// Encapsulation of little-endian CDR.
const HEAD: [u8; 4] = [0, 1, 0, 0];

/// A message being written.
#[derive(Clone, Debug, Default)]
struct Cdr(Vec<u8>);

impl Cdr {
    /// Begins another message with a header.
    fn begin(&mut self, stamp_ns: i64, frame: &str) {
        self.0.clear();
        self.0.extend(HEAD);
        self.time(stamp_ns);
        self.str(frame);
    }

    /// To a multiple of the bytes behind the encapsulation.
    fn align(&mut self, to: usize) {
        let body = self.0.len().saturating_sub(HEAD.len());
        self.0.resize(HEAD.len() + body.next_multiple_of(to), 0);
    }

    fn u32(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    fn time(&mut self, at_ns: i64) {
        let seconds = i32::try_from(at_ns.div_euclid(1_000_000_000)).unwrap_or(i32::MAX);
        self.u32(seconds.cast_unsigned());
        self.u32(u32::try_from(at_ns.rem_euclid(1_000_000_000)).unwrap_or(0));
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.u32(length(bytes.len()));
        self.0.extend(bytes);
    }

    fn str(&mut self, text: &str) {
        self.u32(length(text.len() + 1));
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }
}

fn length(len: usize) -> u32 {
    u32::try_from(len).unwrap_or(u32::MAX)
}

/// A scan while its packets are gathered.
#[derive(Clone, Debug, Default)]
pub(in crate::read) struct AssembledScan {
    cdr: Cdr,
    /// Where the number of packets is.
    count_at: usize,
    packets: u32,
}

impl AssembledScan {
    /// Begins a scan.
    pub(in crate::read) fn begin(&mut self, stamp_ns: i64, frame: &str) {
        self.cdr.begin(stamp_ns, frame);
        self.cdr.align(4);
        self.count_at = self.cdr.0.len();
        self.packets = 0;
        self.cdr.u32(0);
    }

    /// Appends a text that describes the sensor, in the place of a packet.
    pub(in crate::read) fn describe(&mut self, text: &str) {
        let bytes = text.as_bytes();
        self.push(&Packet { received_ns: 0, bytes });
    }

    /// Appends a packet.
    pub(in crate::read) fn push(&mut self, packet: &Packet<'_>) {
        self.cdr.time(packet.received_ns);
        self.cdr.bytes(packet.bytes);
        self.packets += 1;
    }

    /// Whether it has no packets.
    pub(in crate::read) fn is_empty(&self) -> bool {
        self.packets == 0
    }

    /// Its bytes so far.
    pub(in crate::read) fn len(&self) -> usize {
        if self.is_empty() { 0 } else { self.cdr.0.len() }
    }

    /// Forgets the packets.
    pub(in crate::read) fn clear(&mut self) {
        self.packets = 0;
    }

    /// The message; `None` without packets.
    pub(in crate::read) fn message(&mut self) -> Option<&[u8]> {
        let count = self.cdr.0.get_mut(self.count_at..)?.first_chunk_mut()?;
        *count = self.packets.to_le_bytes();
        (self.packets > 0).then_some(self.cdr.0.as_slice())
    }
}

/// Writes single messages, one after the other.
#[derive(Debug, Default)]
pub(in crate::read) struct MadeMessage(Cdr);

impl MadeMessage {
    /// A datagram; a capture states no frame.
    pub(in crate::read) fn datagram(&mut self, at_ns: i64, (address, port): (&str, u16), data: &[u8]) -> &[u8] {
        self.0.begin(at_ns, "");
        self.0.str(address);
        self.0.align(2);
        self.0.0.extend(port.to_le_bytes());
        self.0.bytes(data);
        &self.0.0
    }

    /// A measurement of an IMU without orientation, in m/s² and rad/s.
    pub(in crate::read) fn imu(&mut self, at_ns: i64, frame: &str, imu: &Imu) -> &[u8] {
        self.0.begin(at_ns, frame);
        let unknown = [[-1.0].as_slice(), &[0.0; 8]].concat();
        let orientation = [[0.0, 0.0, 0.0, 1.0].as_slice(), &unknown].concat();
        let covariance = [0.0; 9];
        let parts = [
            orientation.as_slice(),
            &imu.angular_rate,
            &covariance,
            &imu.acceleration,
            &covariance,
        ];
        self.0.align(8);
        for value in parts.into_iter().flatten() {
            self.0.0.extend(value.to_le_bytes());
        }
        &self.0.0
    }

    /// A sentence of NMEA 0183.
    pub(in crate::read) fn sentence(&mut self, at_ns: i64, text: &str) -> &[u8] {
        self.0.begin(at_ns, "");
        self.0.str(text);
        &self.0.0
    }
}
