//! Captures of a network, written as tcpdump and dumpcap write them.
//!
//! Sources: draft-ietf-opsawg-pcap, draft-ietf-opsawg-pcapng; RFC 791 and 8200 (IP and fragments), RFC 768 (UDP), IEEE 802.1Q.

use std::net::Ipv4Addr;

/// Largest part of a datagram in a fragment, bytes.
const FRAGMENT: usize = 800;

/// How packets begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    Ethernet,
    /// Ethernet with a tag of a VLAN.
    Vlan,
    Cooked,
    Cooked2,
    Raw,
    Loopback,
}

/// How datagrams travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ip {
    V4,
    V6,
    /// IPv4, in fragments.
    Fragments,
    /// IPv6, in fragments.
    Fragments6,
}

/// The file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Pcap {
        big: bool,
        nanoseconds: bool,
    },
    /// With the code of its unit of time.
    PcapNg {
        big: bool,
        unit: u8,
    },
}

pub const PCAP: Form = Form::Pcap {
    big: false,
    nanoseconds: true,
};

/// A datagram.
#[derive(Clone, Debug)]
pub struct Datagram {
    pub at_ns: i64,
    pub from: [u8; 4],
    pub port: u16,
    pub data: Vec<u8>,
}

/// Writes a capture.
pub struct Capture {
    form: Form,
    link: Link,
    ip: Ip,
    pub bytes: Vec<u8>,
    /// Where the records of packets begin.
    pub starts: Vec<usize>,
}

impl Capture {
    pub fn new(form: Form, link: Link, ip: Ip) -> Self {
        let mut capture = Self {
            form,
            link,
            ip,
            bytes: Vec::new(),
            starts: Vec::new(),
        };
        let code: u16 = match link {
            Link::Ethernet | Link::Vlan => 1,
            Link::Cooked => 113,
            Link::Cooked2 => 276,
            Link::Raw => 101,
            Link::Loopback => 0,
        };
        match form {
            Form::Pcap { nanoseconds, .. } => {
                capture.u32(if nanoseconds { 0xa1b2_3c4d } else { 0xa1b2_c3d4 });
                capture.u16(2);
                capture.u16(4);
                for number in [0, 0, 262_144, u32::from(code)] {
                    capture.u32(number);
                }
            }
            Form::PcapNg { unit, .. } => {
                for number in [0x0a0d_0d0a, 28, 0x1a2b_3c4d] {
                    capture.u32(number);
                }
                capture.u16(1);
                capture.u16(0);
                for number in [u32::MAX, u32::MAX, 28, 1, 32] {
                    capture.u32(number);
                }
                capture.u16(code);
                capture.u16(0);
                capture.u32(0);
                capture.u16(9);
                capture.u16(1);
                capture.bytes.extend([unit, 0, 0, 0]);
                capture.u32(0);
                capture.u32(32);
            }
        }
        capture
    }

    /// A whole file.
    pub fn of(form: Form, link: Link, ip: Ip, datagrams: &[Datagram]) -> Self {
        let mut capture = Self::new(form, link, ip);
        for datagram in datagrams {
            capture.datagram(datagram);
        }
        capture
    }

    fn is_big(&self) -> bool {
        match self.form {
            Form::Pcap { big, .. } | Form::PcapNg { big, .. } => big,
        }
    }

    fn u32(&mut self, number: u32) {
        let bytes = if self.is_big() {
            number.to_be_bytes()
        } else {
            number.to_le_bytes()
        };
        self.bytes.extend(bytes);
    }

    fn u16(&mut self, number: u16) {
        let bytes = if self.is_big() {
            number.to_be_bytes()
        } else {
            number.to_le_bytes()
        };
        self.bytes.extend(bytes);
    }

    pub fn datagram(&mut self, datagram: &Datagram) {
        let Datagram {
            from, port, ref data, ..
        } = *datagram;
        let mut udp = Vec::new();
        for number in [port, port, u16::try_from(8 + data.len()).unwrap(), 0] {
            udp.extend(number.to_be_bytes());
        }
        udp.extend(data);
        let id = u16::try_from(self.starts.len() % 65_536).unwrap();
        let parts: Vec<&[u8]> = match self.ip {
            Ip::V4 | Ip::V6 => vec![&udp],
            Ip::Fragments | Ip::Fragments6 => udp.chunks(FRAGMENT).collect(),
        };
        let count = parts.len();
        let packets: Vec<Vec<u8>> = parts
            .iter()
            .enumerate()
            .map(|(number, part)| {
                let (offset, more) = (u16::try_from(number * FRAGMENT).unwrap(), number + 1 < count);
                match self.ip {
                    Ip::V4 | Ip::Fragments => v4(from, part, (id, offset, more)),
                    Ip::V6 => v6(from, part, None),
                    Ip::Fragments6 => v6(from, part, Some((id, offset, more))),
                }
            })
            .collect();
        // The last fragment overtakes the others.
        for packet in packets.iter().rev() {
            let framed = self.framed(packet);
            self.packet(datagram.at_ns, &framed);
        }
    }

    fn framed(&self, packet: &[u8]) -> Vec<u8> {
        let is_v6 = matches!(self.ip, Ip::V6 | Ip::Fragments6);
        let kind: [u8; 2] = if is_v6 { [0x86, 0xdd] } else { [0x08, 0x00] };
        let head: Vec<u8> = match self.link {
            Link::Ethernet => [&[2; 12][..], &kind].concat(),
            Link::Vlan => [&[2; 12][..], &[0x81, 0x00, 0x00, 0x2a], &kind].concat(),
            Link::Cooked => [&[0, 0, 0, 1, 0, 6][..], &[2; 6], &[0, 0], &kind].concat(),
            Link::Cooked2 => [&kind[..], &[0, 0, 0, 0, 0, 3, 0, 1, 0, 6], &[2; 6], &[0, 0]].concat(),
            Link::Raw => Vec::new(),
            Link::Loopback => vec![if is_v6 { 30 } else { 2 }, 0, 0, 0],
        };
        [&head, packet].concat()
    }

    /// A packet of the link.
    pub fn packet(&mut self, at_ns: i64, packet: &[u8]) {
        self.starts.push(self.bytes.len());
        let at = u64::try_from(at_ns).unwrap();
        let len = u32::try_from(packet.len()).unwrap();
        match self.form {
            Form::Pcap { nanoseconds, .. } => {
                self.u32(u32::try_from(at / 1_000_000_000).unwrap());
                let fraction = u32::try_from(at % 1_000_000_000).unwrap();
                self.u32(if nanoseconds { fraction } else { fraction / 1000 });
                self.u32(len);
                self.u32(len);
                self.bytes.extend(packet);
            }
            Form::PcapNg { unit, .. } => {
                let units: u128 = if unit & 0x80 == 0 {
                    10_u128.pow(u32::from(unit))
                } else {
                    1 << (unit & 0x7f)
                };
                let time = u64::try_from(u128::from(at) * units / 1_000_000_000).unwrap();
                let padding = packet.len().next_multiple_of(4) - packet.len();
                let total = u32::try_from(32 + packet.len() + padding).unwrap();
                self.u32(6);
                self.u32(total);
                self.u32(0);
                self.u32(u32::try_from(time >> 32).unwrap());
                self.u32(u32::try_from(time & 0xffff_ffff).unwrap());
                self.u32(len);
                self.u32(len);
                self.bytes.extend(packet);
                self.bytes.extend(vec![0; padding]);
                self.u32(total);
            }
        }
    }
}

fn v4(from: [u8; 4], part: &[u8], (id, offset, more): (u16, u16, bool)) -> Vec<u8> {
    let total = u16::try_from(20 + part.len()).unwrap();
    let place = (offset / 8) | if more { 0x2000 } else { 0 };
    let mut packet = vec![0x45, 0];
    for number in [total, id, place] {
        packet.extend(number.to_be_bytes());
    }
    packet.extend([64, 17, 0, 0]);
    packet.extend(from);
    packet.extend([192, 168, 1, 77]);
    packet.extend(part);
    packet
}

fn v6(from: [u8; 4], part: &[u8], fragment: Option<(u16, u16, bool)>) -> Vec<u8> {
    let extension = if fragment.is_some() { 8 } else { 0 };
    let mut packet = vec![0x60, 0, 0, 0];
    packet.extend(u16::try_from(part.len() + extension).unwrap().to_be_bytes());
    packet.extend([if fragment.is_some() { 44 } else { 17 }, 64]);
    packet.extend(Ipv4Addr::from(from).to_ipv6_mapped().octets());
    packet.extend([1; 16]);
    if let Some((id, offset, more)) = fragment {
        packet.extend([17, 0]);
        packet.extend((offset | u16::from(more)).to_be_bytes());
        packet.extend(u32::from(id).to_be_bytes());
    }
    packet.extend(part);
    packet
}
