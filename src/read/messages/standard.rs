//! The standard types whose content is read: which they are, and what they contain.
//!
//! Owns their names. Must not know definitions: whether a type is laid out as published is decided elsewhere.

use std::borrow::Cow;

use super::content::{Body, Content, Member};
use super::header::Header;
use super::packets::{self, Carrier};
use super::{Cursor, DecodeError, bodies, cloud, nmea, radar, sensing, tf};
use crate::read::packets::Packet;

/// A standard type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standard {
    Tf,
    Transform,
    Odometry,
    Imu,
    Fix,
    GpsFix,
    GeoPoint,
    GeoPose,
    Pose {
        covariance: bool,
    },
    Path,
    Twist {
        covariance: bool,
    },
    Orientation,
    Vector,
    CameraInfo,
    /// A map or a cost map.
    OccupancyGrid,
    /// A map of layers.
    GridMap,
    Image,
    Cloud,
    LivoxCloud,
    /// Packets of a lidar.
    Packets(Carrier),
    /// One of them.
    Packet(Carrier),
    /// A datagram, which may be one of them.
    UdpPacket,
    /// A packet of an Ouster, without anything else.
    OusterPacket,
    LaserScan,
    MultiEchoLaserScan,
    RadarScan,
    RadarTracks,
    Nmea,
    NmeaText,
    Description,
    Metadata,
    Clock,
}

/// What a topic's name shows about the texts on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum TopicWord {
    /// They are robot descriptions.
    Description,
    /// They may be the metadata of a sensor.
    Metadata,
    /// They are sentences of NMEA 0183.
    Nmea,
}

impl TopicWord {
    /// By the last part of the topic.
    pub(super) fn of(topic: &str) -> Option<Self> {
        let last = topic.rsplit('/').next().unwrap_or(topic);
        let begins = |word: &str| {
            last.get(..word.len())
                .is_some_and(|begin| begin.eq_ignore_ascii_case(word))
        };
        match last {
            "robot_description" => Some(Self::Description),
            "metadata" => Some(Self::Metadata),
            _ if last.ends_with("_metadata") => Some(Self::Metadata),
            _ if begins("nmea") => Some(Self::Nmea),
            _ => None,
        }
    }
}

impl Standard {
    /// The type `name` (`package/Type`), if its content is read on such a topic.
    pub(super) fn of(name: &str, topic: Option<TopicWord>) -> Option<Self> {
        Some(match name {
            "tf2_msgs/TFMessage" | "tf/tfMessage" => Self::Tf,
            "geometry_msgs/TransformStamped" => Self::Transform,
            "geometry_msgs/Vector3Stamped" => Self::Vector,
            "geographic_msgs/GeoPointStamped" => Self::GeoPoint,
            "geographic_msgs/GeoPoseStamped" => Self::GeoPose,
            "livox_ros_driver2/CustomMsg" | "livox_ros_driver/CustomMsg" => Self::LivoxCloud,
            "velodyne_msgs/VelodyneScan" => Self::Packets(Carrier::Velodyne),
            "pandar_msgs/PandarScan" => Self::Packets(Carrier::Pandar),
            "robosense_msgs/RobosenseScan" | "rslidar_msgs/rslidarScan" => Self::Packets(Carrier::RoboSense),
            "nebula_msgs/NebulaPackets" => Self::Packets(Carrier::Nebula),
            "velodyne_msgs/VelodynePacket" => Self::Packet(Carrier::Velodyne),
            "pandar_msgs/PandarPacket" => Self::Packet(Carrier::Pandar),
            "nebula_msgs/NebulaPacket" => Self::Packet(Carrier::Nebula),
            "udp_msgs/UdpPacket" => Self::UdpPacket,
            "ouster_ros/PacketMsg" | "ouster_msgs/PacketMsg" | "ouster_sensor_msgs/PacketMsg" => Self::OusterPacket,
            "nav_msgs/OccupancyGrid" => Self::OccupancyGrid,
            "grid_map_msgs/GridMap" => Self::GridMap,
            "nav_msgs/Path" => Self::Path,
            "nmea_msgs/Sentence" => Self::Nmea,
            "rosgraph_msgs/Clock" => Self::Clock,
            "std_msgs/String" => match topic? {
                TopicWord::Description => Self::Description,
                TopicWord::Metadata => Self::Metadata,
                TopicWord::Nmea => Self::NmeaText,
            },
            _ => return Self::of_member(name),
        })
    }

    /// The type `name`, if its content is read inside a type that is not standard, too. All of these begin with a header.
    pub(super) fn of_member(name: &str) -> Option<Self> {
        Some(match name {
            "nav_msgs/Odometry" => Self::Odometry,
            "sensor_msgs/Imu" => Self::Imu,
            "sensor_msgs/NavSatFix" => Self::Fix,
            "gps_msgs/GPSFix" | "gps_common/GPSFix" => Self::GpsFix,
            "geometry_msgs/PoseStamped" => Self::Pose { covariance: false },
            "geometry_msgs/PoseWithCovarianceStamped" => Self::Pose { covariance: true },
            "geometry_msgs/TwistStamped" => Self::Twist { covariance: false },
            "geometry_msgs/TwistWithCovarianceStamped" => Self::Twist { covariance: true },
            "geometry_msgs/QuaternionStamped" => Self::Orientation,
            "sensor_msgs/CameraInfo" => Self::CameraInfo,
            "sensor_msgs/Image" => Self::Image,
            "sensor_msgs/PointCloud2" => Self::Cloud,
            "sensor_msgs/LaserScan" => Self::LaserScan,
            "sensor_msgs/MultiEchoLaserScan" => Self::MultiEchoLaserScan,
            "radar_msgs/RadarScan" => Self::RadarScan,
            "radar_msgs/RadarTracks" => Self::RadarTracks,
            _ => return None,
        })
    }

    /// Reads a whole message.
    pub(super) fn read(self, mut cursor: Cursor<'_>) -> Result<Content<'_>, DecodeError> {
        let body = match self {
            Self::Tf => Body::Transforms(tf::transforms(cursor)?.collect::<Result<_, _>>()?),
            Self::Description => Body::Description(Cow::Borrowed(cursor.str()?)),
            Self::Metadata => Body::Metadata(Cow::Borrowed(cursor.str()?)),
            Self::NmeaText => nmea::body(&mut cursor)?,
            Self::Clock => Body::Clock(cursor.time()?),
            Self::Packet(carrier) => Body::Packet(packets::packet(carrier, &mut cursor)?),
            Self::OusterPacket => Body::Packet(Packet {
                received_ns: 0,
                bytes: cursor.bytes()?,
            }),
            Self::UdpPacket => {
                let header = Header::read(&mut cursor)?;
                let packet = packets::udp_packet(header.stamp_ns, &mut cursor)?;
                return Ok(Content::new(Some(header), Body::Packet(packet)));
            }
            Self::Transform => {
                let transform = tf::read(&mut cursor)?;
                let header = Header {
                    stamp_ns: transform.stamp_ns,
                    frame_id: transform.parent.clone(),
                };
                return Ok(Content::new(Some(header), Body::Transforms(vec![transform])));
            }
            _ => {
                let header = Header::read(&mut cursor)?;
                let body = self.body(&mut cursor)?;
                let mut content = Content::new(Some(header), body);
                if self == Self::GeoPose {
                    content.members.push(Member {
                        field: "pose.orientation".into(),
                        header: content.header.clone(),
                        body: Body::Orientation(cursor.f64s()?),
                        guessed: false,
                    });
                }
                return Ok(content);
            }
        };
        Ok(Content::new(None, body))
    }

    /// Reads what follows the header, for the types that begin with one.
    pub(super) fn body<'m>(self, cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
        match self {
            Self::Odometry => bodies::odometry(cursor),
            Self::Imu => bodies::imu(cursor),
            Self::Fix => bodies::fix(cursor),
            Self::GpsFix => bodies::gps_fix(cursor),
            Self::GeoPoint | Self::GeoPose => bodies::geo_point(cursor),
            Self::Pose { covariance } => bodies::pose(cursor, covariance),
            Self::Path => bodies::path(cursor),
            Self::Twist { covariance } => bodies::twist(cursor, covariance),
            Self::Orientation => Ok(Body::Orientation(cursor.f64s()?)),
            Self::Vector => Ok(Body::Vector(cursor.f64s()?)),
            Self::Nmea => nmea::body(cursor),
            Self::CameraInfo => sensing::camera_info(cursor),
            Self::Image => sensing::image(cursor),
            Self::OccupancyGrid => sensing::occupancy_grid(cursor),
            Self::GridMap => sensing::grid_map(cursor),
            Self::Cloud => cloud::point_cloud(cursor).map(Box::new).map(Body::Cloud),
            Self::LivoxCloud => cloud::livox(cursor).map(Box::new).map(Body::Cloud),
            Self::Packets(carrier) => packets::scan(carrier, cursor).map(Box::new).map(Body::Packets),
            Self::LaserScan => sensing::laser_scan(cursor),
            Self::MultiEchoLaserScan => sensing::multi_echo_scan(cursor),
            Self::RadarScan => radar::scan(cursor).map(Box::new).map(Body::Radar),
            Self::RadarTracks => radar::tracks(cursor).map(Box::new).map(Body::Radar),
            Self::Tf
            | Self::Transform
            | Self::NmeaText
            | Self::Description
            | Self::Metadata
            | Self::Clock
            | Self::Packet(_)
            | Self::UdpPacket
            | Self::OusterPacket => Ok(Body::Nothing),
        }
    }
}
