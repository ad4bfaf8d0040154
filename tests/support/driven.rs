//! Topics and transforms of a recipe that are sensors of its drive: which they are, and the messages their rows become.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use serde::Deserialize;

use super::clouds::{Driver, Lidar};
use super::contents::{pose_fields, twist_fields};
use super::drive::errors::rotation;
use super::drive::lidar::Ray;
use super::drive::nmea::compass;
use super::drive::radar::Echo;
use super::drive::rows::{FixRow, ImuRow, OdometryRow, PoseRow, VelocityRow};
use super::drive::scene::Surroundings;
use super::drive::{Drive, Stream};
use super::encode::{Body, Field, Header};
use super::motion::PublishedPose;
use super::packets_ouster;
use super::radars::{Laser, Radar};
use super::topic::{Topic, Transform, Twist};

/// A sensor or an edge of a drive.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum DriveSource {
    /// `sensor_msgs/msg/Imu`.
    Imu,
    /// `ouster_sensor_msgs/msg/PacketMsg`: packets of an Ouster's IMU.
    OusterImu,
    /// `vn_driver/msg/Vectornav`: the Imu within, with an empty header of its own.
    Ins,
    /// `sensor_msgs/msg/NavSatFix`.
    Fix,
    /// `gps_msgs/msg/GPSFix`.
    GpsFix,
    /// `gps_driver/msg/Customgps`: numbers in fields of their own.
    CustomGps,
    /// `geometry_msgs/msg/TwistStamped`, or `TwistWithCovarianceStamped`.
    GnssVelocity,
    /// `geometry_msgs/msg/QuaternionStamped`.
    Heading,
    /// `nmea_msgs/msg/Sentence`.
    Nmea,
    /// `nav_msgs/msg/Odometry`; as an edge, `odom_from_base`.
    Odometry,
    /// `geometry_msgs/msg/PoseStamped`, or `PoseWithCovarianceStamped`; as an edge, `map_from_base`.
    Pose,
    /// A cloud, as the topic's `lidar` says.
    Lidar,
    /// Detections, as the topic's `radar` says.
    Radar,
    /// `sensor_msgs/msg/LaserScan`, as the topic's `laser` says.
    Laser,
    /// The edge `map_from_odom`.
    MapOdom,
    /// The edge `earth_from_map`.
    Earth,
}

/// A frame against another one.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Offset {
    /// Metres.
    #[serde(default)]
    pub xyz: [f64; 3],
    /// Roll, pitch, yaw about fixed axes, degrees.
    #[serde(default)]
    pub rpy_deg: [f64; 3],
}

/// What the drive says on a topic, and on each of its transforms: a row for each tick.
#[derive(Debug)]
pub struct DriveRows {
    pub(super) rows: Option<Rows>,
    pub(super) edges: Vec<Option<Vec<PoseRow>>>,
}

/// The rows of a topic.
#[derive(Debug)]
pub enum Rows {
    Imu(Vec<ImuRow>),
    Fix(Vec<FixRow>, Vec<VelocityRow>),
    Velocity(Vec<VelocityRow>),
    Pose(Vec<PoseRow>),
    Odometry(Vec<OdometryRow>),
    Sentences(Vec<Vec<String>>),
    Scans(Vec<Vec<Ray>>),
    Echoes(Vec<Vec<Echo>>),
    Ranges(Vec<Vec<f64>>),
}

impl DriveSource {
    pub(super) fn message_type(self) -> &'static str {
        match self {
            Self::Imu => "sensor_msgs/msg/Imu",
            Self::OusterImu => "ouster_sensor_msgs/msg/PacketMsg",
            Self::Ins => "vn_driver/msg/Vectornav",
            Self::Fix => "sensor_msgs/msg/NavSatFix",
            Self::GpsFix => "gps_msgs/msg/GPSFix",
            Self::CustomGps => "gps_driver/msg/Customgps",
            Self::GnssVelocity => "geometry_msgs/msg/TwistStamped",
            Self::Heading => "geometry_msgs/msg/QuaternionStamped",
            Self::Nmea => "nmea_msgs/msg/Sentence",
            Self::Odometry => "nav_msgs/msg/Odometry",
            Self::Pose => "geometry_msgs/msg/PoseStamped",
            Self::Lidar => "sensor_msgs/msg/PointCloud2",
            Self::Radar => "radar_msgs/msg/RadarScan",
            Self::Laser => "sensor_msgs/msg/LaserScan",
            Self::MapOdom | Self::Earth => panic!("{self:?} is an edge of TF, not a topic"),
        }
    }

    /// The type whose definition a topic has: types of drivers may have any name.
    pub(super) fn layout(self, message_type: &str) -> &str {
        match self {
            Self::Ins | Self::CustomGps => self.message_type(),
            _ => message_type,
        }
    }
}

impl From<Offset> for Isometry3<f64> {
    fn from(offset: Offset) -> Self {
        let [roll, pitch, yaw] = offset.rpy_deg.map(f64::to_radians);
        Self::from_parts(
            Translation3::from(offset.xyz),
            UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        )
    }
}

impl Topic {
    /// What the recipe's drive says at the ticks.
    pub(super) fn driven(&self, drive: Option<&Drive>, ticks: &[f64], start_s: f64) -> DriveRows {
        let the_drive = || drive.unwrap_or_else(|| panic!("`{}` is of a drive; the recipe has none", self.name));
        let rows = self.from_drive.map(|kind| {
            let (drive, stream) = (the_drive(), self.stream(ticks));
            match kind {
                DriveSource::Imu | DriveSource::OusterImu | DriveSource::Ins => Rows::Imu(drive.imu_rows(&stream)),
                DriveSource::Fix | DriveSource::GpsFix | DriveSource::CustomGps => {
                    let velocity = Stream {
                        errors: Vec::new(),
                        ..stream.clone()
                    };
                    Rows::Fix(drive.fix_rows(&stream), drive.velocity_rows(&velocity))
                }
                DriveSource::GnssVelocity => Rows::Velocity(drive.velocity_rows(&stream)),
                DriveSource::Heading => Rows::Pose(drive.heading_rows(&stream)),
                DriveSource::Nmea => Rows::Sentences(drive.sentences(&stream, &self.sentences, start_s)),
                DriveSource::Odometry => Rows::Odometry(drive.odometry_rows(&stream)),
                DriveSource::Pose => Rows::Pose(drive.pose_rows(&stream)),
                DriveSource::Lidar => {
                    let lidar = self.lidar();
                    let (scanner, scene) = (lidar.scanner(), drive.scene(lidar.surroundings));
                    let starts = ticks.iter().map(|tick| tick - stream.late_s - lidar.before_stamp_s());
                    let scan = |start_s| drive.scan(&scene, &scanner, &stream.base_from_sensor, start_s);
                    Rows::Scans(starts.map(scan).collect())
                }
                DriveSource::Radar => {
                    let (antenna, mount) = (self.radar().antenna(), &stream.base_from_sensor);
                    let scan = |tick: &f64| drive.echoes(&antenna, mount, tick - stream.late_s, stream.noise);
                    Rows::Echoes(ticks.iter().map(scan).collect())
                }
                DriveSource::Laser => {
                    let fan = self.laser().fan();
                    let scene = drive.scene(Surroundings::Street);
                    let scan = |tick: &f64| drive.fan(&scene, &fan, &stream.base_from_sensor, tick - stream.late_s);
                    Rows::Ranges(ticks.iter().map(scan).collect())
                }
                DriveSource::MapOdom | DriveSource::Earth => panic!("{kind:?} is an edge of TF, not a topic"),
            }
        });
        let edge = |transform: &Transform| {
            let kind = transform.from_drive?;
            Some(transform.rows(kind, the_drive(), ticks))
        };
        DriveRows {
            rows,
            edges: self.transforms.iter().map(edge).collect(),
        }
    }

    fn lidar(&self) -> &Lidar {
        let lidar = self.lidar.as_ref();
        lidar.unwrap_or_else(|| panic!("`{}` is a lidar, and does not say which", self.name))
    }

    pub(super) fn radar(&self) -> &Radar {
        let radar = self.radar.as_ref();
        radar.unwrap_or_else(|| panic!("`{}` is a radar, and does not say which", self.name))
    }

    fn laser(&self) -> &Laser {
        let laser = self.laser.as_ref();
        laser.unwrap_or_else(|| panic!("`{}` is a planar scanner, and does not say which", self.name))
    }

    fn stream(&self, ticks: &[f64]) -> Stream {
        let mut mount = Isometry3::from(Offset {
            xyz: self.motion.xyz,
            rpy_deg: self.motion.rpy_deg,
        });
        if let Some(slots) = self.motion.quaternion {
            mount.rotation = rotation(slots);
        }
        // What is measured in one GNSS frame comes from one receiver.
        let name = match self.from_drive {
            Some(
                DriveSource::Imu
                | DriveSource::OusterImu
                | DriveSource::Ins
                | DriveSource::Odometry
                | DriveSource::Pose,
            ) => self.name.clone(),
            _ => format!("receiver {}", self.frame_id),
        };
        Stream {
            late_s: self.late_s,
            orientation_lag_s: self.orientation_lag_s,
            base_from_sensor: mount,
            datum: self.datum,
            world_from_enu: self.world_from_enu.map_or_else(Isometry3::identity, Isometry3::from),
            noise: self.noise,
            covariance_scale: self.covariance_scale,
            errors: self.errors.clone(),
            ..Stream::new(&name, ticks.to_vec())
        }
    }
}

impl Transform {
    fn rows(&self, kind: DriveSource, drive: &Drive, ticks: &[f64]) -> Vec<PoseRow> {
        let stream = Stream {
            late_s: self.late_s,
            base_from_sensor: Offset {
                xyz: self.motion.xyz,
                rpy_deg: self.motion.rpy_deg,
            }
            .into(),
            datum: self.datum,
            world_from_enu: self.world_from_enu.map_or_else(Isometry3::identity, Isometry3::from),
            noise: self.noise,
            errors: self.errors.clone(),
            ..Stream::new(&self.child, ticks.to_vec())
        };
        match kind {
            DriveSource::Odometry => drive.odometry_rows(&stream).into_iter().map(|row| row.pose).collect(),
            DriveSource::Pose => drive.pose_rows(&stream),
            DriveSource::MapOdom => drive.map_odom_rows(&stream),
            DriveSource::Earth => drive.earth_rows(&stream),
            _ => panic!("{kind:?} is a topic, not an edge of TF"),
        }
    }
}

impl Rows {
    /// The messages of a tick.
    pub(super) fn bodies<'a>(
        &'a self,
        topic: &'a Topic,
        message_type: &str,
        number: usize,
        header: Header<'a>,
    ) -> Vec<Body<'a>> {
        let with_covariance = message_type.contains("WithCovariance");
        let fields = match self {
            Self::Imu(rows) if topic.from_drive == Some(DriveSource::OusterImu) => {
                let row = &rows[number];
                let packet = packets_ouster::imu(header.stamp_ns, row.acceleration, row.gyro);
                return vec![Body::Packet(packet)];
            }
            Self::Imu(rows) if topic.from_drive == Some(DriveSource::Ins) => ins_fields(&rows[number]),
            Self::Imu(rows) => imu_fields(&rows[number]),
            Self::Fix(rows, velocities) => match topic.from_drive {
                Some(DriveSource::GpsFix) => gps_fix_fields(header, &rows[number], &velocities[number]),
                Some(DriveSource::CustomGps) => custom_gps_fields(&rows[number]),
                _ => fix_fields(&rows[number]),
            },
            Self::Velocity(rows) => {
                let row = &rows[number];
                let twist = twist_fields(Twist {
                    linear: row.linear,
                    angular: [0.0; 3],
                });
                let mut fields = Vec::from(twist);
                fields.extend(with_covariance.then(|| Field::F64s(row.covariance.into())));
                fields
            }
            Self::Pose(rows) => {
                let row = &rows[number];
                let [position, orientation] = pose_fields(row.published());
                if topic.from_drive == Some(DriveSource::Heading) {
                    vec![orientation]
                } else {
                    let covariance = with_covariance.then(|| Field::F64s(row.covariance.into()));
                    [position, orientation].into_iter().chain(covariance).collect()
                }
            }
            Self::Odometry(rows) => {
                let row = &rows[number];
                let mut fields = vec![Field::Text(&topic.child_frame_id)];
                fields.extend(pose_fields(row.pose.published()));
                fields.push(Field::F64s(row.pose.covariance.into()));
                fields.extend(twist_fields(Twist {
                    linear: row.linear,
                    angular: row.angular,
                }));
                fields.push(Field::F64s(row.twist_covariance.into()));
                fields
            }
            Self::Scans(scans) if topic.lidar().driver == Driver::OusterPackets => {
                return topic.lidar().single_packets(&scans[number], header.stamp_ns);
            }
            Self::Scans(scans) => topic.lidar().fields(&scans[number], header.stamp_ns),
            Self::Ranges(scans) => topic.laser().fields(&scans[number]),
            Self::Echoes(scans) => return topic.radar().bodies(&scans[number], header),
            Self::Sentences(rows) => {
                let body = |(k, text): (usize, &'a String)| {
                    let stamp_ns = header.stamp_ns + sentence_ns(k);
                    Body::Fields(Header { stamp_ns, ..header }, vec![Field::Text(text)])
                };
                return rows[number].iter().enumerate().map(body).collect();
            }
        };
        vec![Body::Fields(header, fields)]
    }
}

/// How much later than the first the `k`-th sentence of a tick is read and stamped, nanoseconds.
pub(super) fn sentence_ns(k: usize) -> i64 {
    5_000_000 * i64::try_from(k).unwrap()
}

impl PoseRow {
    pub(super) fn published(&self) -> PublishedPose {
        PublishedPose {
            position: self.position,
            orientation: self.orientation,
        }
    }
}

fn imu_fields<'a>(row: &ImuRow) -> Vec<Field<'a>> {
    vec![
        Field::F64s(row.orientation.into()),
        Field::F64s(row.orientation_covariance.into()),
        Field::F64s(row.gyro.into()),
        Field::F64s(row.gyro_covariance.into()),
        Field::F64s(row.acceleration.into()),
        Field::F64s(row.acceleration_covariance.into()),
    ]
}

const NO_HEADER: Header<'_> = Header {
    stamp_ns: 0,
    frame_id: "",
};

fn ins_fields<'a>(row: &ImuRow) -> Vec<Field<'a>> {
    let mut fields = vec![Field::Header(NO_HEADER)];
    fields.extend(imu_fields(row));
    // The magnetometer, and the text that it was read from.
    fields.push(Field::Header(NO_HEADER));
    fields.push(Field::F64s(vec![0.0; 3 + 9]));
    fields.push(Field::Text("$VNYMR"));
    fields
}

fn fix_fields<'a>(row: &FixRow) -> Vec<Field<'a>> {
    vec![
        Field::I8(row.status),
        Field::U16(1),
        Field::F64s(vec![row.latitude, row.longitude, row.altitude]),
        Field::F64s(row.covariance.into()),
        Field::U8(2),
    ]
}

fn custom_gps_fields<'a>(row: &FixRow) -> Vec<Field<'a>> {
    vec![Field::F64s(vec![row.latitude, row.longitude, row.altitude])]
}

fn gps_fix_fields<'a>(header: Header<'a>, row: &FixRow, velocity: &VelocityRow) -> Vec<Field<'a>> {
    let [east, north, up] = velocity.linear;
    let mut numbers = vec![row.latitude, row.longitude, row.altitude];
    numbers.extend([compass(north.atan2(east)), east.hypot(north), up]);
    // pitch, roll, dip; time; dilutions; errors.
    numbers.extend([0.0; 3]);
    numbers.push(header.stamp_ns as f64 * 1e-9);
    numbers.extend([0.0; 5 + 10]);
    vec![
        // The status: satellites used, which; visible, which, where; status and sources.
        Field::Header(header),
        Field::U16(14),
        Field::Empty(1),
        Field::U16(20),
        Field::Empty(4),
        Field::I16(i16::from(row.status)),
        Field::U16(1),
        Field::U16(0),
        Field::U16(1),
        Field::F64s(numbers),
        Field::F64s(row.covariance.into()),
        Field::U8(2),
    ]
}
