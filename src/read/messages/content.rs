//! The content of a message that matters to frames, in any encoding.

use std::borrow::Cow;
use std::sync::Arc;

use super::cloud::Cloud;
use super::header::Header;
use super::packets::RawScan;
use super::radar::Radar;
use super::tf::Transform;
use crate::read::packets::Packet;

/// Most coefficients of a distortion that are read; OpenCV's largest model has 14.
pub const MAX_DISTORTION: u32 = 64;

/// Bound on the poses that are kept of a path: of a longer one every second, third, ... one, the first always.
pub const MAX_PATH: u32 = 10_000;

/// A message, read as far as frames are concerned.
#[derive(Clone, Debug, PartialEq)]
pub struct Content<'m> {
    /// Its header, where the type has one.
    pub header: Option<Header<'m>>,
    /// Its content beyond the header.
    pub body: Body<'m>,
    /// Parts of a type that is not a standard one, with the content of a standard type.
    pub members: Vec<Member<'m>>,
}

impl<'m> Content<'m> {
    /// A message without members.
    pub fn new(header: Option<Header<'m>>, body: Body<'m>) -> Self {
        Self {
            header,
            body,
            members: Vec::new(),
        }
    }
}

/// A part of a message with the content of a standard type.
#[derive(Clone, Debug, PartialEq)]
pub struct Member<'m> {
    /// The field that contains it (`imu`, `sensors.imu`), or the fields it is made of (`lat, lon, alt`).
    pub field: Arc<str>,
    /// Its own header; an empty stamp or frame is taken from the message's.
    pub header: Option<Header<'m>>,
    /// Its content.
    pub body: Body<'m>,
    /// Whether it was recognised by the names of plain fields only, not by a type.
    pub guessed: bool,
}

/// The content of a message beyond its header.
#[derive(Clone, Debug, PartialEq)]
pub enum Body<'m> {
    /// Nothing that is read.
    Nothing,
    /// Nothing but a child frame: the field `child_frame_id` of a type that is read by its definition.
    ChildFrame(Cow<'m, str>),
    /// Transforms. With a header they are a message of one transform, not TF.
    Transforms(Vec<Transform<'m>>),
    /// Pose and twist of a body.
    Odometry(Box<Odometry<'m>>),
    /// Inertial measurements.
    Imu(Box<Imu>),
    /// A satellite fix.
    Fix(Fix),
    /// A sentence of NMEA 0183.
    Nmea(Box<Nmea>),
    /// A pose.
    Pose(Box<Pose>),
    /// Poses with their stamps in nanoseconds, in order; see [`MAX_PATH`].
    Path(Vec<(i64, Pose)>),
    /// An orientation, `[x, y, z, w]`, not normalised: `geometry_msgs/QuaternionStamped`.
    Orientation([f64; 4]),
    /// A vector, `geometry_msgs/Vector3Stamped`: what it measures is not stated, but may be guessed from the topic.
    Vector([f64; 3]),
    /// A velocity with its covariance.
    Twist(Box<Twist>),
    /// The calibration of a camera.
    CameraInfo(Box<CameraInfo<'m>>),
    /// A cloud of points.
    Cloud(Box<Cloud<'m>>),
    /// The packets of a lidar.
    Packets(Box<RawScan<'m>>),
    /// A single packet, which may be of a lidar.
    Packet(Packet<'m>),
    /// An image, without its bytes.
    Image(Image<'m>),
    /// A grid, without its cells.
    Grid(Box<Grid>),
    /// A scan of a plane.
    LaserScan(Box<LaserScan>),
    /// Detections of a radar.
    Radar(Box<Radar>),
    /// The text of a robot description.
    Description(Cow<'m, str>),
    /// A text that may be the metadata of a sensor.
    Metadata(Cow<'m, str>),
    /// Frames that it names beyond its header's (`foxglove.SceneUpdate`).
    Frames(Vec<Cow<'m, str>>),
    /// A time that everyone should use, nanoseconds: `rosgraph_msgs/Clock`.
    Clock(i64),
}

/// `nav_msgs/msg/Odometry`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Odometry<'m> {
    /// `child_frame_id`.
    pub child: Cow<'m, str>,
    /// Metres, in the header's frame.
    pub position: [f64; 3],
    /// `[x, y, z, w]`, not normalised.
    pub orientation: [f64; 4],
    /// Row-major 6x6.
    pub pose_covariance: [f64; 36],
    /// m/s, in the child frame.
    pub linear: [f64; 3],
    /// rad/s, in the child frame.
    pub angular: [f64; 3],
    /// Row-major 6x6.
    pub twist_covariance: [f64; 36],
}

/// `sensor_msgs/msg/Imu`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Imu {
    /// `[x, y, z, w]`, not normalised.
    pub orientation: [f64; 4],
    /// Row-major 3x3.
    pub orientation_covariance: [f64; 9],
    /// rad/s.
    pub angular_velocity: [f64; 3],
    /// Row-major 3x3.
    pub angular_velocity_covariance: [f64; 9],
    /// m/s².
    pub linear_acceleration: [f64; 3],
    /// Row-major 3x3.
    pub linear_acceleration_covariance: [f64; 9],
}

/// `sensor_msgs/msg/NavSatFix`, `gps_msgs/msg/GPSFix`, `geographic_msgs/msg/GeoPointStamped` or `foxglove.LocationFix`,
/// numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    /// `NavSatStatus.status`: -1 no fix, 0 fix, 1 SBAS, 2 GBAS; `GPSStatus.status` also has 18 DGPS, 19 RTK, 20 RTK
    /// float, 33 WAAS. 0 where the type has no such field.
    pub status: i8,
    /// Degrees.
    pub latitude: f64,
    /// Degrees.
    pub longitude: f64,
    /// Metres; NaN where the message has no such field.
    pub altitude: f64,
    /// Row-major 3x3, m², east north up; zeros, which mean that it is unknown, where the type has none.
    pub covariance: [f64; 9],
    /// East, north and up, m/s: from `GPSFix`, where it has a fix and all three are finite.
    pub velocity: Option<[f64; 3]>,
}

/// A sentence of NMEA 0183 with its numbers as sent, units apart; what it leaves empty, or does not contain, is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct Nmea {
    /// Which sentence.
    pub sentence: Sentence,
    /// UTC, seconds of the day.
    pub time_s: Option<f64>,
    /// Latitude and longitude, degrees, north and east positive.
    pub position: Option<[f64; 2]>,
    /// Altitude above mean sea level, metres.
    pub altitude_m: Option<f64>,
    /// Height of mean sea level above the WGS 84 ellipsoid, metres.
    pub geoid_separation_m: Option<f64>,
    /// As GGA counts: 0 no fix, 1 GNSS, 2 differential, 3 precise, 4 RTK, 5 RTK float, 6 dead reckoning, 7 typed in,
    /// 8 simulated. The letters of other sentences are converted to these numbers.
    pub quality: Option<u8>,
    /// Speed over ground, m/s.
    pub speed_m_s: Option<f64>,
    /// Course over ground, degrees clockwise from true north.
    pub course_deg: Option<f64>,
    /// Degrees clockwise from true north.
    pub true_heading_deg: Option<f64>,
    /// Degrees clockwise from magnetic north; of HDG with the deviation of the compass included.
    pub magnetic_heading_deg: Option<f64>,
    /// Direction of magnetic north from true north, degrees, east positive.
    pub variation_deg: Option<f64>,
}

/// The sentences of NMEA 0183 that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sentence {
    /// Fix with altitude.
    Gga,
    /// Fix of several satellite systems.
    Gns,
    /// Recommended minimum: position, speed and course.
    Rmc,
    /// Course and speed.
    Vtg,
    /// True heading.
    Hdt,
    /// Magnetic heading with deviation and variation.
    Hdg,
    /// Magnetic heading.
    Hdm,
}

/// `geometry_msgs/msg/PoseStamped` or `PoseWithCovarianceStamped`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Metres.
    pub position: [f64; 3],
    /// `[x, y, z, w]`, not normalised.
    pub orientation: [f64; 4],
    /// Row-major 6x6, where the type has one.
    pub covariance: Option<[f64; 36]>,
}

/// `geometry_msgs/msg/TwistStamped` or `TwistWithCovarianceStamped`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Twist {
    /// m/s.
    pub linear: [f64; 3],
    /// rad/s.
    pub angular: [f64; 3],
    /// Row-major 6x6, where the type has one.
    pub covariance: Option<[f64; 36]>,
}

/// `sensor_msgs/msg/CameraInfo`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraInfo<'m> {
    /// Pixels, of the calibrated image.
    pub height: u32,
    /// Pixels, of the calibrated image.
    pub width: u32,
    /// `distortion_model`.
    pub model: Cow<'m, str>,
    /// Coefficients of the distortion.
    pub d: Vec<f64>,
    /// Intrinsics of the raw image, row-major 3x3, pixels.
    pub k: [f64; 9],
    /// Rectification, row-major 3x3.
    pub r: [f64; 9],
    /// Projection of the rectified image, row-major 3x4, pixels; its fourth column pixels times metres.
    pub p: [f64; 12],
    /// Pixels that are binned, horizontally and vertically; 0 is 1.
    pub binning: [u32; 2],
    /// The part that the images show.
    pub roi: Roi,
}

/// `sensor_msgs/msg/RegionOfInterest`: pixels of the full image without binning; all zeros is the whole image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Roi {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// Height.
    pub height: u32,
    /// Width.
    pub width: u32,
    /// Whether the image is to be rectified.
    pub do_rectify: bool,
}

/// `nav_msgs/msg/OccupancyGrid` or `grid_map_msgs/msg/GridMap`, without their cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Side of a cell, metres.
    pub resolution_m: f64,
    /// Cells along x and y; of a `GridMap` lengths over the resolution.
    pub cells: [f64; 2],
    /// Of the corner of the first cell, or of a `GridMap`'s centre; metres.
    pub position: [f64; 3],
    /// `[x, y, z, w]`, not normalised.
    pub orientation: [f64; 4],
    /// How many cells follow, if they are one list.
    pub data: Option<u64>,
}

impl Grid {
    /// Whether two are the same bit by bit.
    pub fn is_same(&self, other: &Self) -> bool {
        let bits = |grid: &Self| {
            let numbers = grid.cells.iter().chain(&grid.position).chain(&grid.orientation);
            let bits: Vec<u64> = numbers.map(|value| value.to_bits()).collect();
            (grid.resolution_m.to_bits(), bits, grid.data)
        };
        bits(self) == bits(other)
    }
}

/// `sensor_msgs/msg/Image`, without its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image<'m> {
    /// Pixels.
    pub height: u32,
    /// Pixels.
    pub width: u32,
    /// `encoding`.
    pub encoding: Cow<'m, str>,
}

/// `sensor_msgs/msg/LaserScan` or `foxglove.LaserScan`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct LaserScan {
    /// Of the first and the last ray, and from one to the next, radians from x towards y.
    pub angles: [f64; 3],
    /// From one ray to the next, seconds; NaN where the type has no such field.
    pub time_increment: f64,
    /// From one scan to the next, seconds; NaN where the type has no such field.
    pub scan_time: f64,
    /// The smallest and the largest valid range, metres; NaN if the type does not have them.
    pub range: [f64; 2],
    /// Metres, ray by ray.
    pub ranges: Vec<f64>,
    /// The pose of the plane in the frame of the message, if the type has it.
    pub pose: Option<Pose>,
}

impl LaserScan {
    /// A scan whose rays are spread evenly from the first angle to the last, without times and limits of ranges.
    pub(super) fn spread(start: f64, end: f64, ranges: Vec<f64>, pose: Option<Pose>) -> Self {
        let steps = ranges.len().saturating_sub(1);
        let increment = if steps == 0 { 0.0 } else { (end - start) / steps as f64 };
        Self {
            angles: [start, end, increment],
            time_increment: f64::NAN,
            scan_time: f64::NAN,
            range: [f64::NAN; 2],
            ranges,
            pose,
        }
    }
}
