//! Any bytes as captures of every layout, read completely and in samples: no panic, bounded memory, and a status that states what was read.
use frames_lint::read::bag::Sampling;
use frames_lint::source::SourceKind;

/// The header of a pcap without its magic: version 2.4, Ethernet.
const HEADER: [u8; 20] = [2, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 1, 0, 0, 0];

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let part = Sampling {
        windows: 3,
        seconds: 0.1,
        bytes: 100,
        carried: None,
    };
    let records = [&HEADER[..], bytes].concat();
    for sampling in [None, Some(part)] {
        super::recorded(b"\xd4\xc3\xb2\xa1", &records, SourceKind::Pcap, sampling);
        super::recorded(b"\x0a\x0d\x0d\x0a", bytes, SourceKind::Pcap, sampling);
    }
}
