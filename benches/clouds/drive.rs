//! A drive with a lidar of 128 beams and 2048 columns at 10 Hz, an IMU at 100 Hz and odometry at 20 Hz, in a yard with walls.
//!
//! The points have the layout of ouster-ros (48 bytes) and are measured during the motion, in steps of a millimetre, so that they
//! compress like real ones.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use fastrand::Rng;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};

use crate::encode::{Body, Endian, Field, Header, Transform};
use crate::schemas;

const BEAMS: u32 = 128;
const COLUMNS: u32 = 2048;
const POINT_BYTES: usize = 48;
/// Bytes of the points of one cloud.
pub(crate) const CLOUD_BYTES: usize = BEAMS as usize * COLUMNS as usize * POINT_BYTES;
/// Names, offsets and types of the fields of a point.
const FIELDS: [(&str, u32, u8); 9] = [
    ("x", 0, 7),
    ("y", 4, 7),
    ("z", 8, 7),
    ("intensity", 16, 7),
    ("t", 20, 6),
    ("reflectivity", 24, 4),
    ("ring", 26, 4),
    ("ambient", 28, 4),
    ("range", 32, 6),
];
const START_NS: i64 = 1_700_000_000_000_000_000;
/// The path is a circle of this radius, driven at this speed to the left.
const RADIUS_M: f64 = 15.0;
const SPEED_M_S: f64 = 5.0;
/// Half the sides of the yard, and the sensor over the ground, metres.
const YARD_M: [f64; 2] = [40.0, 25.0];
const HEIGHT_M: f64 = 1.8;

fn yaw(t_s: f64) -> f64 {
    t_s * SPEED_M_S / RADIUS_M
}

fn place(t_s: f64) -> [f64; 2] {
    [RADIUS_M * yaw(t_s).sin(), -RADIUS_M * yaw(t_s).cos()]
}

/// The points of a scan that begins at a time.
fn points(start_s: f64, random: &mut Rng) -> Vec<u8> {
    let mut bytes = vec![0; CLOUD_BYTES];
    for column in 0..COLUMNS {
        let after_s = 0.1 * f64::from(column) / f64::from(COLUMNS);
        let azimuth = TAU / 2.0 - TAU * f64::from(column) / f64::from(COLUMNS);
        let (at, turned) = (place(start_s + after_s), yaw(start_s + after_s) + azimuth);
        let wall = [turned.cos(), turned.sin()]
            .iter()
            .zip(YARD_M)
            .zip(at)
            .map(|((along, side), at)| (side * along.signum() - at) / along)
            .fold(f64::INFINITY, f64::min);
        for beam in 0..BEAMS {
            let elevation = (22.5 - 45.0 * f64::from(beam) / f64::from(BEAMS - 1)).to_radians();
            let to_wall = wall / elevation.cos();
            let to_ground = if elevation < 0.0 {
                -HEIGHT_M / elevation.sin()
            } else {
                f64::INFINITY
            };
            // The walls are five metres high.
            let is_over = to_wall * elevation.sin() > 5.0 - HEIGHT_M;
            let range = if is_over { f64::INFINITY } else { to_wall.min(to_ground) };
            let point = &mut bytes[(beam as usize * COLUMNS as usize + column as usize) * POINT_BYTES..][..POINT_BYTES];
            let mut put = |offset: usize, value: [u8; 4]| point[offset..offset + 4].copy_from_slice(&value);
            put(20, ((after_s * 1e9) as u32).to_le_bytes());
            put(24, (5 | (beam << 16)).to_le_bytes());
            if range.is_infinite() {
                continue;
            }
            let millimetres = (range * 1000.0).round() + f64::from(random.i32(-10..=10));
            let range = millimetres / 1000.0;
            let flat = range * elevation.cos();
            for (slot, value) in [flat * azimuth.cos(), flat * azimuth.sin(), range * elevation.sin()]
                .into_iter()
                .enumerate()
            {
                put(4 * slot, ((value * 1000.0).round() as f32 / 1000.0).to_le_bytes());
            }
            put(16, f32::from(random.u8(..64)).to_le_bytes());
            put(32, (millimetres as u32).to_le_bytes());
        }
    }
    bytes
}

fn cloud<'a>(points: Vec<u8>) -> Vec<Field<'a>> {
    let mut fields = vec![Field::U32(BEAMS), Field::U32(COLUMNS), Field::Count(FIELDS.len())];
    for (name, offset, datatype) in FIELDS {
        fields.extend([
            Field::Text(name),
            Field::U32(offset),
            Field::U8(datatype),
            Field::U32(1),
        ]);
    }
    let step = POINT_BYTES as u32;
    fields.extend([
        Field::U8(0),
        Field::U32(step),
        Field::U32(step * COLUMNS),
        Field::Bytes(points),
        Field::U8(0),
    ]);
    fields
}

fn imu() -> Vec<Field<'static>> {
    let covariance = |variance: f64| [variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance];
    let mut numbers = vec![0.0, 0.0, 0.0, 1.0];
    numbers.extend([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    numbers.extend([0.0, 0.0, SPEED_M_S / RADIUS_M]);
    numbers.extend(covariance(1e-6));
    numbers.extend([0.0, SPEED_M_S * SPEED_M_S / RADIUS_M, 9.806_65]);
    numbers.extend(covariance(1e-3));
    vec![Field::F64s(numbers)]
}

fn odometry(t_s: f64) -> Vec<Field<'static>> {
    let ([x, y], half) = (place(t_s), yaw(t_s) / 2.0);
    let mut numbers = vec![x, y, 0.0, 0.0, 0.0, half.sin(), half.cos()];
    numbers.extend([0.0; 36]);
    numbers.extend([SPEED_M_S, 0.0, 0.0, 0.0, 0.0, SPEED_M_S / RADIUS_M]);
    numbers.extend([0.0; 36]);
    vec![Field::Text("base_link"), Field::F64s(numbers)]
}

/// Writes a drive of this many seconds, each cloud in its own chunk, as recorders do with messages of this size.
pub(crate) fn write(path: &Path, seconds: u32) {
    println!("writing {}", path.display());
    let unfinished = path.with_extension("unfinished");
    let file = BufWriter::new(File::create(&unfinished).expect("the drive can be written"));
    let mut writer = WriteOptions::new()
        .profile("ros2")
        .compression(Some(Compression::Zstd))
        .chunk_size(Some(768 << 10))
        .create(file)
        .expect("a writer");
    let mut channels = BTreeMap::new();
    for (topic, message_type) in [
        ("/tf_static", "tf2_msgs/msg/TFMessage"),
        ("/imu", "sensor_msgs/msg/Imu"),
        ("/odom", "nav_msgs/msg/Odometry"),
        ("/ouster/points", "sensor_msgs/msg/PointCloud2"),
    ] {
        let schema = schemas::definition(message_type);
        let schema = writer
            .add_schema(message_type, "ros2msg", schema.as_bytes())
            .expect("a schema");
        let channel = writer
            .add_channel(schema, topic, "cdr", &BTreeMap::new())
            .expect("a channel");
        channels.insert(topic, channel);
    }
    let mut random = Rng::with_seed(7);
    let mut send = |topic: &str, at_ns: i64, body: &Body| {
        let time = at_ns.unsigned_abs();
        let header = MessageHeader {
            channel_id: channels[topic],
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        let message = body.encode(Endian::Little);
        writer.write_to_known_channel(&header, &message).expect("a message");
    };
    let mount = |child, z| Transform {
        header: Header {
            stamp_ns: START_NS,
            frame_id: "base_link",
        },
        child,
        translation: [0.0, 0.0, z],
        rotation: [0.0, 0.0, 0.0, 1.0],
    };
    let mounts = [mount("imu", 0.3), mount("os_sensor", HEIGHT_M)];
    send("/tf_static", START_NS, &Body::Tf(&mounts));
    for tick in 0..i64::from(seconds) * 100 {
        let (now, t_s) = (START_NS + tick * 10_000_000, tick as f64 / 100.0);
        let header = |frame_id| Header {
            stamp_ns: now,
            frame_id,
        };
        send("/imu", now, &Body::Fields(header("imu"), imu()));
        if tick % 5 == 0 {
            send("/odom", now, &Body::Fields(header("odom"), odometry(t_s)));
        }
        if tick % 10 == 0 {
            let cloud = cloud(points(t_s, &mut random));
            send("/ouster/points", now, &Body::Fields(header("os_sensor"), cloud));
        }
    }
    writer.finish().expect("the drive is written");
    std::fs::rename(&unfinished, path).expect("the drive gets its name");
}
