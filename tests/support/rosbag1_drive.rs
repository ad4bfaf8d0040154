//! The ROS 1 bag that most tests read or damage.

use super::heard::TopicMessage;
use super::rosbag1::{BagFile, Compression, Connection, Layout, Rosbag1};

/// 300 messages on three connections, two of them of one topic. Bytes and times follow from the message's number.
pub fn drive(layout: Layout) -> (BagFile, Vec<TopicMessage>) {
    let mut bag = Rosbag1::new(layout);
    let imu = bag.connection(&Connection {
        topic: "/imu",
        message_type: "sensor_msgs/Imu",
        callerid: Some("/imu_driver"),
        ..Connection::default()
    });
    let map = bag.connection(&Connection {
        topic: "map",
        message_type: "tf/tfMessage",
        definition: "",
        latching: true,
        ..Connection::default()
    });
    let other = bag.connection(&Connection {
        topic: "/imu",
        message_type: "acme_msgs/Imu",
        ..Connection::default()
    });
    let mut written = Vec::new();
    for tick in 0..300 {
        let (number, topic) = match tick % 10 {
            0 => (map, "map"),
            1 => (other, "/imu"),
            _ => (imu, "/imu"),
        };
        let log_ns = 1_500_000_000_000_000_000 + tick * 10_000_000 + 7;
        let data: Vec<u8> = (0..40 + tick % 50)
            .map(|byte| u8::try_from(byte * tick % 251).unwrap())
            .collect();
        bag.message(number, log_ns, &data);
        written.push((topic.to_owned(), log_ns, data));
    }
    (bag.finish(), written)
}

/// Every compression, in small chunks and in one.
pub fn layouts() -> Vec<Layout> {
    let sized = |chunk_bytes| {
        Compression::ALL.map(|compression| Layout {
            compression,
            chunk_bytes,
            ..Layout::default()
        })
    };
    [sized(4000), sized(1 << 20)].concat()
}
