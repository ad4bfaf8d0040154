//! UDP datagrams in packets of a network: Ethernet with VLAN, Linux cooked, raw IP and loopback; IPv4 and IPv6, with their fragments.
//!
//! Owns the types of links that are read and the bound on fragments. Sources: the registry of link types
//! (tcpdump.org/linktypes.html); the headers are read by `etherparse`.

use std::borrow::Cow;
use std::net::IpAddr;

use etherparse::defrag::IpDefragPool;
use etherparse::{EtherType, NetSlice, SlicedPacket, TransportSlice, UdpSlice, ip_number};

/// Fragments after which old ones are dropped. A datagram has 64 KiB at most.
const MAX_FRAGMENTS: usize = 256;
/// How long the fragments of a datagram are waited for, nanoseconds.
const PATIENCE_NS: u64 = 1_000_000_000;

/// A datagram.
pub(super) struct Datagram<'p> {
    pub(super) source: IpAddr,
    pub(super) source_port: u16,
    pub(super) port: u16,
    pub(super) data: Cow<'p, [u8]>,
}

/// What is in a packet.
pub(super) enum Found<'p> {
    Datagram(Datagram<'p>),
    /// A part of a datagram whose other parts are missing so far.
    Fragment,
    /// Another protocol.
    Other,
    /// The packet was cut when it was captured, or is damaged.
    Broken,
}

/// Puts fragments together.
#[derive(Default)]
pub(super) struct Network {
    pool: IpDefragPool<i64>,
    /// Fragments since old ones were dropped.
    fragments: usize,
}

impl Network {
    /// Forgets the fragments: packets were left out.
    pub(super) fn seam(&mut self) {
        *self = Self::default();
    }

    /// The datagram of a packet, or that of which it is the last fragment to come.
    pub(super) fn datagram<'p>(&mut self, link: u32, bytes: &'p [u8], time_ns: i64) -> Found<'p> {
        let packet = match sliced(link, bytes) {
            Some(Ok(packet)) => packet,
            Some(Err(())) => return Found::Broken,
            None => return Found::Other,
        };
        let source = match &packet.net {
            Some(NetSlice::Ipv4(ip)) => IpAddr::from(ip.header().source()),
            Some(NetSlice::Ipv6(ip)) => IpAddr::from(ip.header().source()),
            _ => return Found::Other,
        };
        if packet.is_ip_payload_fragmented() {
            return self.fragment(&packet, source, time_ns);
        }
        match &packet.transport {
            Some(TransportSlice::Udp(udp)) => Found::Datagram(Datagram {
                source,
                source_port: udp.source_port(),
                port: udp.destination_port(),
                data: Cow::Borrowed(udp.payload()),
            }),
            _ => Found::Other,
        }
    }

    fn fragment<'p>(&mut self, packet: &SlicedPacket<'_>, source: IpAddr, time_ns: i64) -> Found<'p> {
        self.fragments += 1;
        if self.fragments > MAX_FRAGMENTS {
            let kept = std::cell::Cell::new(0);
            self.pool.retain(|at_ns| {
                kept.set(kept.get() + 1);
                kept.get() <= MAX_FRAGMENTS && at_ns.abs_diff(time_ns) <= PATIENCE_NS
            });
            self.fragments = 0;
        }
        let whole = match self.pool.process_sliced_packet(packet, time_ns, ()) {
            Ok(Some(whole)) => whole,
            Ok(None) => return Found::Fragment,
            Err(_) => return Found::Broken,
        };
        if whole.ip_number != ip_number::UDP {
            return Found::Other;
        }
        let Ok(udp) = UdpSlice::from_slice(&whole.payload) else {
            return Found::Broken;
        };
        Found::Datagram(Datagram {
            source,
            source_port: udp.source_port(),
            port: udp.destination_port(),
            data: Cow::Owned(udp.payload().to_vec()),
        })
    }
}

/// Whether these bytes are a packet of a network, of any protocol.
pub(super) fn is_packet(link: u32, bytes: &[u8]) -> bool {
    matches!(sliced(link, bytes), Some(Ok(packet)) if packet.net.is_some())
}

/// Whether packets of such a link are read.
pub(super) fn is_known(link: u32) -> bool {
    matches!(link, 0 | 1 | 12 | 14 | 101 | 108 | 113 | 228 | 229 | 276)
}

/// The headers of a packet; `None` where its link is not read.
fn sliced(link: u32, bytes: &[u8]) -> Option<Result<SlicedPacket<'_>, ()>> {
    let sliced = match link {
        1 => SlicedPacket::from_ethernet(bytes),
        // The protocol of the second form of Linux cooked is in its first bytes.
        276 => match (bytes.first_chunk(), bytes.get(20..)) {
            (Some(kind), Some(rest)) => SlicedPacket::from_ether_type(EtherType(u16::from_be_bytes(*kind)), rest),
            _ => return Some(Err(())),
        },
        113 => SlicedPacket::from_linux_sll(bytes),
        12 | 14 | 101 | 228 | 229 => SlicedPacket::from_ip(bytes),
        // The family of addresses comes first, by numbers that differ between systems; the version of IP says the same.
        0 | 108 => match bytes.get(4..) {
            Some(rest) => SlicedPacket::from_ip(rest),
            None => return Some(Err(())),
        },
        _ => return None,
    };
    Some(sliced.map_err(|_| ()))
}
