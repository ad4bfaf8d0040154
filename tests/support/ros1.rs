//! Drives of ROS 2 as ROS 1 bags.

use super::rosbag1::{BagFile, Connection, Layout, Rosbag1};
use super::rosbag2::Drive;

/// The drive: messages in ROS 1's serialization, names of types without `msg`.
pub fn bag_of(drive: &Drive, layout: Layout) -> BagFile {
    let mut bag = Rosbag1::new(layout);
    let connections: Vec<(u32, &str)> = drive
        .topics
        .iter()
        .map(|topic| {
            let message_type = match topic.message_type.as_str() {
                "tf2_msgs/msg/TFMessage" => "tf2_msgs/TFMessage".to_owned(),
                other => other.replace("/msg/", "/"),
            };
            let connection = bag.connection(&Connection {
                topic: &topic.name,
                message_type: &message_type,
                definition: "",
                callerid: Some("/player"),
                latching: topic.name == "/tf_static",
            });
            (connection, fields(&topic.message_type))
        })
        .collect();
    for message in &drive.messages {
        let (connection, fields) = connections[message.topic];
        bag.message(connection, message.log_ns, &ros1_of(&message.data, fields));
    }
    bag.finish()
}

/// The fields of a type: `h` header, `s` string, `d` float64, `f` float32, `b` byte, `w` two bytes; `36d` 36 of
/// them, `[...]` a sequence.
fn fields(message_type: &str) -> &'static str {
    match message_type {
        "tf2_msgs/msg/TFMessage" => "[hs7d]",
        "nav_msgs/msg/Odometry" => "hs7d36d6d36d",
        "sensor_msgs/msg/Imu" => "h4d9d3d9d3d9d",
        "sensor_msgs/msg/NavSatFix" => "hbw3d9db",
        "sensor_msgs/msg/LaserScan" => "h7f[f][f]",
        "velodyne_msgs/msg/VelodyneScan" => "h[2f1206b]",
        "ouster_ros/msg/PacketMsg" => "[b]",
        "std_msgs/msg/String" => "s",
        "sensor_msgs/msg/Temperature" => "h2d",
        other => panic!("{other} cannot be written as ROS 1"),
    }
}

/// A message in CDR, little-endian, as ROS 1 serializes it: no alignment, no zero behind strings, a number in each header.
fn ros1_of(cdr: &[u8], fields: &str) -> Vec<u8> {
    let mut message = Message {
        cdr: &cdr[4..],
        at: 0,
        out: Vec::new(),
    };
    message.all(fields);
    // Behind the fields there may be padding.
    let rest = &message.cdr[message.at..];
    assert!(
        rest.iter().all(|byte| *byte == 0),
        "{fields} leaves bytes of the message"
    );
    message.out
}

struct Message<'a> {
    cdr: &'a [u8],
    at: usize,
    out: Vec<u8>,
}

impl Message<'_> {
    fn all(&mut self, fields: &str) {
        let mut rest = fields;
        while let Some(first) = rest.chars().next() {
            if first == '[' {
                let end = rest.find(']').unwrap();
                for _ in 0..self.count() {
                    self.all(&rest[1..end]);
                }
                rest = &rest[end + 1..];
                continue;
            }
            let digits = rest.find(|letter: char| !letter.is_ascii_digit()).unwrap();
            let times = rest[..digits].parse().unwrap_or(1);
            for _ in 0..times {
                self.one(rest.as_bytes()[digits]);
            }
            rest = &rest[digits + 1..];
        }
    }

    fn one(&mut self, field: u8) {
        match field {
            b'h' => {
                self.out.extend([0; 4]);
                self.number(4);
                self.number(4);
                self.one(b's');
            }
            b's' => {
                let length = self.aligned(4);
                let length = u32::from_le_bytes(self.cdr[length..length + 4].try_into().unwrap()) - 1;
                self.out.extend(length.to_le_bytes());
                let text = self.at..self.at + length as usize;
                self.out.extend(&self.cdr[text.clone()]);
                self.at = text.end + 1;
            }
            b'd' => self.number(8),
            b'f' => self.number(4),
            b'w' => self.number(2),
            b'b' => self.number(1),
            other => panic!("no field is written {}", char::from(other)),
        }
    }

    /// The count of a sequence, copied.
    fn count(&mut self) -> u32 {
        let from = self.out.len();
        self.number(4);
        u32::from_le_bytes(self.out[from..].try_into().unwrap())
    }

    fn number(&mut self, size: usize) {
        let from = self.aligned(size);
        self.out.extend(&self.cdr[from..from + size]);
    }

    /// Where a number of this size begins; the next byte is behind it.
    fn aligned(&mut self, size: usize) -> usize {
        let from = self.at.next_multiple_of(size);
        self.at = from + size;
        from
    }
}
