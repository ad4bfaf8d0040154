//! Recordings as readable YAML.
//!
//! ```yaml
//! start_s: 1700000000          # recorder's clock at the start, Unix seconds (the default)
//! duration_s: 10               # ticks run from 0 up to, not including, this (the default)
//! topics:
//!   - topic: /tf_static        # static topics are written once, at `at_s`, unless they have a rate
//!     transforms:
//!       - {parent: base_link, child: lidar, xyz: [0.3, 0, 1.2], rpy_deg: [0, 0, 90]}
//!       - {parent: base_link, child: imu, quaternion: [0, 0, 0, 1]}          # x y z w, as published; .nan allowed
//!   - topic: /tf               # one message a tick, with every transform that is active then
//!     rate_hz: 50
//!     transforms:
//!       - {parent: odom, child: base_link, velocity: [1, 0, 0], yaw_rate_deg_s: 5, until_s: 5}
//!   - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}  # level, at rest, gravity +9.81 along z
//!   - {topic: /odom, type: nav_msgs/msg/Odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
//!   - {topic: /robot_description, text: "<robot name='r'/>"}
//!   - {topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, frame_id: lidar}
//! ```
//!
//! Any type name works: unknown ones get a definition that begins with a header. A topic may be listed several times
//! (a static transform that changes: the same topic again with a later `at_s`; two writers: each with its `writer`).
//!
//! **Motion**, of TF transforms and of topics of type Odometry, PoseStamped and PoseWithCovarianceStamped: `xyz`,
//! `rpy_deg` or `quaternion` (as published) at the start, `velocity: [vx, vy, vz]` in the body's axes (m/s),
//! `yaw_rate_deg_s`; `jumps: [{at_s: 3, by: [1, 0, 0], yaw_deg: 20}]` (the rest of the drive is shifted in the parent's
//! axes and turned about the place reached), `wobble_m`, `wobble_hz` (a sinusoid along the parent's x),
//! `alternate: {by: [0.1, 0, 0], yaw_deg: 0}` (every second message is displaced), `noise_m` (seeded, normal).
//!
//! **Numbers**, as published, `.nan` and `.inf` allowed; what is left out is zero, the identity, or as said:
//! - nav_msgs/msg/Odometry: `twist: {linear: [..], angular: [..]}` (by default what the motion has),
//!   `pose_covariance: [36]`, `twist_covariance: [36]`
//! - geometry_msgs/msg/PoseWithCovarianceStamped: `covariance: [36]`; TwistStamped, TwistWithCovarianceStamped: `twist`,
//!   `covariance: [36]`
//! - sensor_msgs/msg/Imu: `orientation: [x, y, z, w]`, `orientation_covariance: [9]`, `angular_velocity: [3]`,
//!   `angular_velocity_covariance: [9]`, `linear_acceleration: [3]` (gravity +9.81 along z), `acceleration_covariance: [9]`
//! - sensor_msgs/msg/NavSatFix: `latitude`, `longitude` (48, 11), `altitude` (500), `status` (0), `covariance: [9]`,
//!   `east_velocity`, `north_velocity` (m/s), `nan_from_s` (from then on the position is NaN)
//! - sensor_msgs/msg/CameraInfo and Image: `camera: {size: [w, h], k: [fx, fy, cx, cy] or all nine, d: [..], model: plumb_bob,
//!   r: [9], p: [fx, fy, cx, cy, Tx] or all twelve (that of K), binning: [x, y], roi: [left, top, w, h], encoding: rgb8}`; without
//!   it zeros
//! - nav_msgs/msg/OccupancyGrid and grid_map_msgs/msg/GridMap: `grid: {resolution, size: [w, h], origin: [x, y, z], orientation: [x, y, z, w],
//!   data: cells that follow}`
//!
//! **A drive** with exact truth, realistic noise and, where wanted, convention errors (`drive/`): topics and transforms
//! with `from_drive` are its sensors, and all of them fit together.
//!
//! ```yaml
//! duration_s: 60
//! drive: {vehicle: car, motion: turning, seed: 1, imu: mems, gnss: rtk}
//! topics:
//!   - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu_link, errors: [ned_frd]}
//!   - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, xyz: [0, 0, 1.5]}
//!   - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
//!   - topic: /tf
//!     rate_hz: 20
//!     transforms:
//!       - {parent: odom, child: base_link, from_drive: odometry}
//!       - {parent: map, child: odom, from_drive: map_odom}
//!   - {topic: /tf_static, transforms: [{parent: earth, child: map, from_drive: earth}]}
//! ```
//!
//! `drive`, all of it optional: `vehicle: car | walker | drone | robot`, `motion: turning | straight | still | circles |
//! out_and_back`, `seed`, `place: {latitude, longitude, altitude}` (48, 11, 500: the origin of ENU), `undulation_m` (46),
//! `yaw_deg` (at the start), `tilt_deg` (deviation of the ground's roll and pitch), `imu: tactical | mems | perfect`,
//! `gnss: rtk | single | perfect` (perfect makes poses exact, too), `odometry: real | perfect`.
//!
//! `from_drive` of a topic, which then needs no `type`: `imu`, `ouster_imu` (packets), `ins` (an Imu with an empty header within
//! vn_driver/msg/Vectornav), `fix`, `gps_fix` (gps_msgs/msg/GPSFix), `custom_gps` (gps_driver/msg/Customgps: latitude,
//! longitude, altitude), `gnss_velocity` (TwistStamped; ENU), `heading` (QuaternionStamped), `nmea` (nmea_msgs/msg/Sentence;
//! `sentences: [GGA, RMC, HDT]` are sent at every tick, 5 ms apart), `odometry`, `pose` (PoseStamped, in the map = ENU). A `type` may
//! name the variant WithCovariance of TwistStamped and PoseStamped, and be any name for `ins` and `custom_gps`.
//! `lidar` with `lidar: {..}` (see `clouds.rs`); `radar` with `radar: {driver: scan | smartmicro | ti_mmwave | nebula | delphi |
//! nuscenes, sides_deg: 60, reflectors: 4 (in 25 m x 25 m), movers: 4, reversed, compensated, mirrored}`; `laser` with `laser: {rays:
//! 361, sides_deg: 135, period_s: 0.1, time_scale, increment_scale, backward}` (sensor_msgs/msg/LaserScan).
//! `from_drive` of a transform: `odometry` (odom from base), `pose` (map from base), `map_odom` (map from odom), `earth`
//! (earth from map). GNSS topics of one `frame_id` are of one receiver and share its noise.
//!
//! Beside it: `xyz`, `rpy_deg` or `quaternion` (where the sensor sits in the base; not of odometry), `late_s` (what a
//! message shows is older than its stamp; with `stamp_offset_s: -0.2` beside `late_s: 0.2` the stamp is right and the
//! message late), `orientation_lag_s` (of an Imu's orientation beyond that; the grade's by default), `noise` (multiplies
//! all noise; 0 is exact), `covariance_scale` (multiplies covariances alone), `datum: {latitude, longitude, altitude}` (another origin of the map, of `pose` and `earth`),
//! `world_from_enu: {xyz, rpy_deg}` (a map that is not ENU), and `errors`, applied in their order:
//! - orientations (imu, ins, heading, pose, odometry): `ned_frd` (all of it), `ned_orientation` (the quaternion alone),
//!   `ned_world`, `conjugate`, `wxyz`, `compass_yaw`, `zero_north`, `y_forward`, `backward`, `inverted` and `yaw_90` (a
//!   mount that TF does not know), `euler_xyz`, `left_handed`
//! - imu, ins: `frd` (gyro and accelerometer beside a correct quaternion), `deg_s`, `gyro_negated`, `g`, `cm_s2`, `gravity_sign`,
//!   `gravity_removed`, `no_orientation`
//! - pose, odometry: `inverse`; `x_negated`, `y_negated`, `z_negated`, `swap_xy` (positions alone); pose: `utm_grid` (from the
//!   origin's easting and northing), `utm`, `ecef`, `lat_lon_degrees`, `altitude_as_z`
//! - odometry: `twist_in_world`, `twist_reversed`, `twist_y_negated`, `twist_z_negated`, `twist_swapped`, `twist_yaw_negated`,
//!   `twist_covariance_in_world`
//! - fix, gps_fix, custom_gps: `swapped`, `msl`, `radians`, `e7`, `float32`; gnss_velocity: `ned_frd`, `swap_xy`,
//!   `twist_in_body`, `twist_reversed`
//! - covariances: `covariance_std`; imu, pose, odometry: `covariance_degrees`; pose, odometry, fix:
//!   `covariance_centimetres`; pose, odometry: `covariance_millimetres`, `covariance_rotation_first`, `covariance_not_rotated` (left in the body's axes); pose: `covariance_of_enu` (left in
//!   ENU, the pose being in `world_from_enu`); imu, fix: `covariance_up_first`
//! - earth: `transposed`, `ned_rows`, `spherical_latitude`, `active_rotations`, `lat_lon_swapped`
//!
//! `from_drive: lidar` (a cloud; of what drives around the vehicle it sees) needs `lidar: {..}`, all of it optional: `driver: plain | velodyne_packets |
//! ouster_packets | ouster | velodyne | hesai | robosense | livox | livox_points | nebula | unknown` (the layout of points and times), `beams`,
//! `columns`, `table: even | vlp16 | pandar40 | os1` (elevations, and how beams look aside), `solid_state: true`, `surroundings: street |
//! apron | slope | warehouse | garage`, `lost` (share of the rays), `window_deg: [from, to]`, `destaggered`, `filtered` (not
//! organised); errors: `turned_deg`, `mirrored`, `swapped`, `z_negated`, `offset: [x, y, z]`, `times: driver | missing | constant |
//! reversed`, `time_scale`, `clock_s`, `epoch_single`.
//!
//! **Stamps**: `stamp_offset_s` (header stamp minus log time), `stamp_s` (constant), `stamp_scale` (multiplies),
//! `stamp_start_s` (replaces the clock's origin), `stamp_drift_ppm` (of the time since the start), `stamp_jitter_s`
//! (seeded, even in ± that), `stamp_repeat: n` (each stamp serves n messages). `from_s`, `until_s`: the active window of
//! a topic, or of a transform.
//!
//! **Channels**: `durability: volatile` or `qos: {durability: volatile}` (a text is taken as the whole
//! `offered_qos_profiles`), `latched: true`, `writer: /node` (a channel of its own, with `callerid`), `schema`,
//! `big_endian`.
//!
//! **File**: `compression: none | lz4 | zstd`, `chunk_size_bytes`, `checksums: false` (of chunks), `metadata: {name: {key: value}}` (metadata records).

use std::collections::BTreeMap;

use serde::Deserialize;

use super::drive::{Description, Drive};
use super::raw::{self, Layout};
use super::rosbag2;
use super::topic::{Topic, active, nanoseconds};

/// A drive of 1 + 300 + 600 messages.
pub const DRIVE: &str = "
duration_s: 6
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: imu}]}
  - topic: /tf
    rate_hz: 50
    transforms: [{parent: odom, child: base_link, velocity: [1, 0, 0], yaw_rate_deg_s: 5}]
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}
";
/// Messages in it.
pub const MESSAGES: u64 = 901;

/// A recording.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Log clock at the start, Unix seconds.
    #[serde(default = "default_start")]
    pub start_s: f64,
    /// Length, seconds.
    #[serde(default = "default_duration")]
    pub duration_s: f64,
    /// Compression of chunks.
    #[serde(default)]
    pub compression: Compression,
    /// Uncompressed size at which a chunk is closed; 64 KiB by default.
    pub chunk_size_bytes: Option<u64>,
    pub checksums: Option<bool>,
    /// Metadata records: key and value pairs by name.
    #[serde(default)]
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// The drive that topics with `from_drive` are of; its length is the recipe's.
    pub drive: Option<Description>,
    /// Topics, written in the order of log time, then in this order.
    pub topics: Vec<Topic>,
}

/// Compression of chunks.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Compression {
    /// None: messages stand in the file as they are.
    None,
    /// LZ4.
    Lz4,
    /// Zstandard.
    #[default]
    Zstd,
}

fn default_start() -> f64 {
    1_700_000_000.0
}

fn default_duration() -> f64 {
    10.0
}

impl rosbag2::Drive {
    /// The drive that a recipe describes.
    pub fn of(recipe: &str) -> Self {
        let bytes = Recipe::parse(recipe).to_mcap();
        let mut drive = Self::default();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            let channel = &message.channel;
            let known = drive.topics.iter().position(|topic| topic.name == channel.topic);
            let topic = known.unwrap_or_else(|| {
                let schema = channel.schema.as_ref().unwrap();
                drive.topics.push(rosbag2::Topic {
                    name: channel.topic.clone(),
                    message_type: schema.name.clone(),
                    schema: String::from_utf8(schema.data.to_vec()).unwrap(),
                    qos: channel
                        .metadata
                        .get("offered_qos_profiles")
                        .cloned()
                        .unwrap_or_default(),
                });
                drive.topics.len() - 1
            });
            drive.messages.push(rosbag2::Message {
                topic,
                log_ns: i64::try_from(message.log_time).unwrap(),
                data: message.data.to_vec(),
            });
        }
        drive
    }
}

impl Recipe {
    /// Reads a recipe; panics with the reason where it cannot be.
    pub fn parse(text: &str) -> Self {
        serde_yaml::from_str(text).unwrap_or_else(|error| panic!("the recipe does not parse: {error}\n{text}"))
    }

    /// The recording as an MCAP.
    pub fn to_mcap(&self) -> Vec<u8> {
        let layout = Layout {
            compression: match self.compression {
                Compression::None => None,
                Compression::Lz4 => Some(mcap::Compression::Lz4),
                Compression::Zstd => Some(mcap::Compression::Zstd),
            },
            chunk_bytes: self.chunk_size_bytes.unwrap_or(64 << 10),
            checksums: self.checksums.unwrap_or(true),
            ..Layout::default()
        };
        let drive = self.drive();
        let mut messages: Vec<(i64, usize, Vec<u8>)> = Vec::new();
        for (index, topic) in self.topics.iter().enumerate() {
            let ticks = self.ticks(topic);
            let driven = topic.driven(drive.as_ref(), &ticks, self.start_s);
            for (number, at_s) in (0..).zip(ticks.iter().copied()) {
                let log_ns = nanoseconds(self.start_s) + nanoseconds(at_s);
                let stamped = number - number % topic.stamp_repeat.max(1);
                let stamped_s = ticks[usize::try_from(stamped).unwrap()];
                let stamp_ns = topic.stamp_ns(nanoseconds(self.start_s), stamped_s, stamped);
                let of_tick = topic.messages(at_s, number, stamp_ns, &driven);
                for (k, message) in of_tick.into_iter().enumerate() {
                    messages.push((log_ns + topic.later_ns(k), index, message));
                }
            }
        }
        messages.sort_by_key(|(log_ns, index, _)| (*log_ns, *index));
        raw::in_memory(layout, |bag| {
            let mut known = BTreeMap::new();
            let mut channels = Vec::new();
            for topic in &self.topics {
                let key = (topic.name.clone(), topic.message_type(), topic.writer.clone());
                let id = *known.entry(key).or_insert_with(|| bag.channel(&topic.raw_channel()));
                channels.push(id);
            }
            for (log_ns, index, message) in &messages {
                bag.message(channels[*index], *log_ns, message);
            }
            for (name, fields) in &self.metadata {
                bag.metadata(name, fields);
            }
        })
    }

    /// The drive that the recipe's topics are of.
    pub fn drive(&self) -> Option<Drive> {
        let duration_s = self.duration_s;
        self.drive.map(|drive| Drive::new(Description { duration_s, ..drive }))
    }

    /// Times of the messages of a topic, seconds after the start.
    fn ticks(&self, topic: &Topic) -> Vec<f64> {
        let Some(rate) = topic.rate_hz else {
            return vec![topic.at_s];
        };
        (0..u32::MAX)
            .map(|tick| f64::from(tick) / rate)
            .take_while(|at_s| *at_s < self.duration_s)
            .filter(|at_s| active(topic.from_s, topic.until_s, *at_s))
            .collect()
    }
}
