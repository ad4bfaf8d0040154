//! Any bytes as the metadata of an Ouster, and as packets of one that is known: no panic, finite points, and not more of them than the bytes hold.
use frames_lint::read::ouster::{Axes, KnownSensors, Layout, Metadata, Origin, decode, imu};

const METADATA: &str = include_str!("../../fixtures/ouster/tiny.json");
const PROFILES: [&str; 6] = [
    "RNG19_RFL8_SIG16_NIR16_DUAL",
    "RNG19_RFL8_SIG16_NIR16",
    "RNG15_RFL8_NIR8",
    "RNG19_RFL8_SIG16_NIR16_RGB16_DUAL",
    "FUSA_RNG15_RFL8_NIR8_DUAL",
    "LEGACY",
];

/// Runs the target: a text that begins with a brace is metadata. Else the first byte chooses the layout of packets, the next two are the length of
/// every packet, and the rest are the packets.
pub fn run(bytes: &[u8]) {
    if bytes.starts_with(b"{") {
        return text(bytes);
    }
    let Some((choice, bytes)) = bytes.split_first() else {
        return;
    };
    let Some((length, bytes)) = bytes.split_first_chunk() else {
        return;
    };
    let length = usize::from(u16::from_le_bytes(*length)).max(1);
    let mut metadata = Metadata::parse(METADATA).expect("metadata");
    let profile = usize::from(*choice) % PROFILES.len();
    PROFILES[profile].clone_into(&mut metadata.lidar_profile);
    metadata.safety_header = PROFILES[profile].starts_with("FUSA");
    if choice & 0x80 != 0 {
        "LEGACY".clone_into(&mut metadata.imu_profile);
    }
    let mut known = KnownSensors::default();
    known.add("tiny.json", METADATA, false);
    let origin = Origin {
        port: Some(7502),
        names: ["tiny.pcap", "/udp/127.0.0.1:7502"],
    };
    for packet in bytes.chunks(length) {
        let measured = imu(&metadata, packet).unwrap_or_default();
        // A measurement has 36 bytes at least.
        assert!(measured.len() <= packet.len() / 36);
        assert!(known.of_lidar(packet, &origin).is_none_or(|text| text == METADATA));
        let _ = known.of_imu(packet, &origin);
    }
    for axes in [Axes::Sensor, Axes::Lidar] {
        let packets = bytes.chunks(length).map(|packet| (0, packet));
        let count = packets.len();
        let Ok(scan) = decode(&metadata, packets, axes) else {
            continue;
        };
        // A return has four bytes at least.
        assert!(scan.returns.len() <= bytes.len() / 4);
        assert!(scan.refused < count && (scan.refused > 0) == scan.reason.is_some());
        let mut values = scan.returns.iter().flat_map(|point| [point.x, point.y, point.z]);
        assert!(values.all(f32::is_finite));
    }
}

/// Metadata, and a packet of its length that is filled with the text.
fn text(bytes: &[u8]) {
    let Some(metadata) = std::str::from_utf8(bytes)
        .ok()
        .and_then(|text| Metadata::parse(text).ok())
    else {
        return;
    };
    let Ok(layout) = Layout::of(&metadata) else {
        return;
    };
    let packet: Vec<u8> = bytes.iter().copied().cycle().take(layout.packet_bytes()).collect();
    if let Ok(scan) = decode(&metadata, [(0, packet.as_slice())].into_iter(), Axes::Sensor) {
        assert!(scan.returns.len() <= 2 * layout.columns * layout.rows);
    }
}
