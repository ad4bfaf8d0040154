//! What both layouts of captures consist of: records, most of them with a packet.

/// Bound on a packet, bytes: the largest that libpcap captures.
pub(super) const MAX_PACKET: u32 = 1 << 18;

/// Why there is no record.
#[derive(Debug)]
pub(super) enum Fault {
    /// The file ends inside of it.
    Ended(String),
    Wrong(String),
}

/// A record of pcap, or a block of pcapng.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    /// Where the next one begins.
    pub(super) next: u64,
    /// The packet in it.
    pub(super) packet: Option<CapturedPacket>,
}

/// A packet in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct CapturedPacket {
    /// Nanoseconds since 1970.
    pub(super) time_ns: i64,
    /// How it begins.
    pub(super) link: u32,
    pub(super) from: u64,
    pub(super) len: usize,
}
