//! Any bytes as an OSF file of Ouster's sensors: all chunks are read and all scans decoded, without a panic; then the file is collected.
use std::io::Cursor;

use frames_lint::read::bag::Sampling;
use frames_lint::read::ouster::osf::{LidarScan, Osf};
use frames_lint::read::ouster::{Axes, Metadata};
use frames_lint::source::SourceKind;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    if let Ok(mut file) = Osf::new(Cursor::new(bytes)) {
        for chunk in file.index.chunks.clone() {
            let Ok(chunk) = file.read(&chunk) else { continue };
            for message in chunk.messages().flatten() {
                let json = file.sensor(message.stream).map(|sensor| sensor.json.as_str());
                let Some(metadata) = json.and_then(|json| Metadata::parse(json).ok()) else {
                    continue;
                };
                if let Ok(scan) = LidarScan::read(&message, &metadata, None) {
                    let pixels = usize::from(scan.size.0) * usize::from(scan.size.1);
                    assert!(scan.scan(&metadata, Axes::Sensor).returns.len() <= 2 * pixels);
                }
            }
        }
    }
    let part = Sampling {
        windows: 2,
        seconds: 0.1,
        bytes: 100,
        carried: None,
    };
    for sampling in [None, Some(part)] {
        super::recorded(b"", bytes, SourceKind::Osf, sampling);
    }
}
