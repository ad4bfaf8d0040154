//! Any bytes as a ROS 1 bag, read completely and in samples: no panic, bounded memory, and a status that states what was read.
use frames_lint::read::bag::Sampling;
use frames_lint::source::SourceKind;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let part = Sampling {
        windows: 2,
        seconds: 0.1,
        bytes: 100,
        carried: None,
    };
    for sampling in [None, Some(part)] {
        super::recorded(b"#ROSBAG V2.0\n", bytes, SourceKind::Rosbag1, sampling);
    }
}
