//! Clouds of recipes: what drivers of lidars make of the rays of a scan.
//!
//! Sources of the layouts: ouster-ros (os_point.h), velodyne_driver (point_types.h), HesaiLidar_ROS_2.0 and rs_driver (PointXYZIRT),
//! livox_ros_driver2 (lddc.h: PointXYZRTLT; CustomMsg.msg), nebula (point_types.hpp: PointXYZIRCAEDT).

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Vector3};
use serde::Deserialize;

use super::drive::lidar::{Beams, Ray, Scanner};
use super::drive::scene::Surroundings;
use super::encode::{Body, Field};
use super::packets::{PACKET_NS, SEQUENCES, Scan, Shot};
use super::packets_ouster;

/// A lidar of a recipe's drive.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(clippy::struct_excessive_bools)] // switches of a recipe
pub struct Lidar {
    #[serde(default)]
    pub driver: Driver,
    #[serde(default = "thirty_two")]
    pub beams: u32,
    #[serde(default = "columns")]
    pub columns: u32,
    /// The table of its beams.
    #[serde(default)]
    pub table: Beams,
    /// It does not spin.
    #[serde(default)]
    pub solid_state: bool,
    #[serde(default)]
    pub surroundings: Surroundings,
    /// The cloud is expressed in axes that are turned so about z against x forward: 180 for Ouster's Lidar frame.
    #[serde(default)]
    pub turned_deg: f64,
    /// y is told with the other sign.
    #[serde(default)]
    pub mirrored: bool,
    /// z is told with the other sign.
    #[serde(default)]
    pub z_negated: bool,
    /// x and y are expressed in each other's place.
    #[serde(default)]
    pub swapped: bool,
    /// The cloud is expressed in the axes of a camera: x right, y down, z forward.
    #[serde(default)]
    pub optical: bool,
    /// Multiplies the coordinates: 1000 for millimetres.
    #[serde(default = "one")]
    pub scale: f64,
    /// The axes that the cloud is expressed in, from those that the driver has: `told_from_driver`.
    #[serde(skip)]
    pub stated: Isometry3<f64>,
    /// Every point as far off, metres: a map's coordinates.
    #[serde(default)]
    pub offset: [f64; 3],
    #[serde(default)]
    pub times: Times,
    /// Multiplies the times of points.
    #[serde(default = "one")]
    pub time_scale: f64,
    /// The points' clock is so much later than that of the header, seconds, where it counts from 1970.
    #[serde(default)]
    pub clock_s: f64,
    /// Times of a Velodyne are seconds since 1970, in its float32.
    #[serde(default)]
    pub epoch_single: bool,
    /// Share of the rays that are lost.
    pub lost: Option<f64>,
    /// Only what lies between these angles, counter-clockwise from x forward, degrees. Times of an Ouster count from its first
    /// column.
    pub window_deg: Option<[f64; 2]>,
    /// Points of an organised cloud without its rows, and without what has no return.
    #[serde(default)]
    pub filtered: bool,
    /// Rows are shifted so that columns are of one direction; else of one time.
    #[serde(default)]
    pub destaggered: bool,
    /// The serial number in packets of an Ouster.
    #[serde(default = "serial")]
    pub serial: u64,
}

/// Time of a scan, seconds.
const PERIOD_S: f64 = 0.1;

/// Whose driver it is.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Driver {
    /// x, y, z and intensity, in no order.
    #[default]
    Plain,
    Ouster,
    /// `ouster_sensor_msgs/msg/PacketMsg`: the packets of an Ouster, one in a message.
    OusterPackets,
    Velodyne,
    /// `velodyne_msgs/msg/VelodyneScan`: the packets of a VLP-16, of as many firing sequences as its sixteen beams have columns, or a multiple.
    VelodynePackets,
    Hesai,
    Robosense,
    /// `livox_ros_driver2/msg/CustomMsg`.
    Livox,
    /// Its `PointCloud2`, with nanoseconds in a float64.
    LivoxPoints,
    Nebula,
    /// A lidar that no table knows, with the time of each point in seconds.
    Unknown,
}

/// What the times of the points are.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Times {
    /// As the driver has them.
    #[default]
    Driver,
    /// No field of times.
    Missing,
    /// All alike.
    Constant,
    /// The last is told first.
    Reversed,
}

fn thirty_two() -> u32 {
    32
}

fn columns() -> u32 {
    512
}

fn serial() -> u64 {
    packets_ouster::SERIAL
}

fn one() -> f64 {
    1.0
}

/// A number in a point.
#[derive(Clone, Copy, Debug)]
enum Number {
    U8(u8),
    U16(u16),
    U32(u32),
    F32(f32),
    F64(f64),
}

impl Number {
    fn datatype(self) -> u8 {
        match self {
            Self::U8(_) => 2,
            Self::U16(_) => 4,
            Self::U32(_) => 6,
            Self::F32(_) => 7,
            Self::F64(_) => 8,
        }
    }

    fn write(self, bytes: &mut Vec<u8>) {
        match self {
            Self::U8(value) => bytes.extend(value.to_le_bytes()),
            Self::U16(value) => bytes.extend(value.to_le_bytes()),
            Self::U32(value) => bytes.extend(value.to_le_bytes()),
            Self::F32(value) => bytes.extend(value.to_le_bytes()),
            Self::F64(value) => bytes.extend(value.to_le_bytes()),
        }
    }
}

/// Points as they are written: their bytes, and the layout of the first.
#[derive(Debug, Default)]
struct Points {
    bytes: Vec<u8>,
    /// Names, types and offsets.
    layout: Vec<(&'static str, u8, usize)>,
    is_stated: bool,
}

impl Points {
    fn put(&mut self, name: &'static str, number: Number) {
        if !self.is_stated {
            self.layout.push((name, number.datatype(), self.bytes.len()));
        }
        number.write(&mut self.bytes);
    }
}

/// A ray as the cloud tells it: ring, column, time after the scan's beginning, and where it ended.
type CloudRay = (u32, u32, f64, Option<Vector3<f64>>);

impl Default for Lidar {
    fn default() -> Self {
        serde_yaml::from_str("{}").unwrap()
    }
}

impl Lidar {
    /// The sensor.
    pub fn scanner(&self) -> Scanner {
        let scanner = if self.solid_state {
            Scanner::solid_state()
        } else {
            Scanner::of(self.table, self.beams, self.columns)
        };
        Scanner {
            lost: self.lost.unwrap_or(scanner.lost),
            ..scanner
        }
    }

    /// What multiplies times that are expressed in a unit a thousand times as large, or as small where the field holds no fractions.
    pub fn other_unit(&self) -> f64 {
        match self.driver {
            Driver::Ouster | Driver::Nebula | Driver::Livox | Driver::LivoxPoints => 1e-3,
            _ => 1e3,
        }
    }

    /// By how much a scan begins before the stamp of its message, seconds.
    pub fn before_stamp_s(&self) -> f64 {
        match self.driver {
            Driver::Velodyne | Driver::VelodynePackets => PERIOD_S,
            _ => 0.0,
        }
    }

    /// The type of its messages.
    pub fn message_type(&self) -> &'static str {
        match self.driver {
            Driver::Livox => "livox_ros_driver2/msg/CustomMsg",
            Driver::VelodynePackets => "velodyne_msgs/msg/VelodyneScan",
            Driver::OusterPackets => "ouster_sensor_msgs/msg/PacketMsg",
            _ => "sensor_msgs/msg/PointCloud2",
        }
    }

    /// The fields of a message behind its header.
    pub fn fields<'a>(&self, rays: &[Ray], stamp_ns: i64) -> Vec<Field<'a>> {
        let scanner = self.scanner();
        let returns: Vec<CloudRay> = rays
            .iter()
            .map(|ray| (ray.ring, ray.column, ray.after_s, self.place(ray)))
            .collect();
        if self.driver == Driver::Livox {
            return self.custom(&returns, stamp_ns);
        }
        if self.driver == Driver::VelodynePackets {
            return self.packets(&returns, stamp_ns);
        }
        let is_organised =
            matches!(self.driver, Driver::Ouster | Driver::Robosense) && !self.solid_state && !self.filtered;
        // A scan that is cut to a window begins with the window.
        let first_s = match (self.driver, self.window_deg) {
            (Driver::Ouster, Some(_)) => rays
                .iter()
                .find(|ray| self.is_in_window(ray))
                .map_or(0.0, |ray| ray.after_s),
            _ => 0.0,
        };
        let mut points = Points::default();
        let mut count = 0;
        let mut push = |ray: &CloudRay, points: &mut Points| {
            self.point(ray, stamp_ns, first_s, points);
            points.is_stated = true;
            count += 1;
        };
        if is_organised {
            for ring in 0..scanner.beams() {
                let mut row: Vec<&CloudRay> = returns.iter().filter(|ray| ray.0 == ring).collect();
                if self.destaggered {
                    row.rotate_right(scanner.pixel_shift(ring));
                }
                for ray in row {
                    push(ray, &mut points);
                }
            }
        } else {
            let returned = returns.iter().filter(|ray| ray.3.is_some());
            returned.for_each(|ray| push(ray, &mut points));
        }
        if count == 0 {
            self.point(&(0, 0, 0.0, None), stamp_ns, 0.0, &mut points);
        }
        let point_step = points.bytes.len() / count.max(1);
        if count == 0 {
            points.bytes.clear();
        }
        let point_step = u32::try_from(point_step).unwrap();
        let (height, width) = if is_organised {
            (scanner.beams(), scanner.columns)
        } else {
            (1, u32::try_from(count).unwrap())
        };
        let mut fields = vec![Field::U32(height), Field::U32(width), Field::Count(points.layout.len())];
        for (name, datatype, offset) in &points.layout {
            fields.push(Field::Owned((*name).to_owned()));
            fields.push(Field::U32(u32::try_from(*offset).unwrap()));
            fields.push(Field::U8(*datatype));
            fields.push(Field::U32(1));
        }
        fields.extend([
            Field::U8(0),
            Field::U32(point_step),
            Field::U32(point_step * width),
            Field::Bytes(points.bytes),
            Field::U8(u8::from(!is_organised)),
        ]);
        fields
    }

    /// Whether a ray went to where the sensor is set to look.
    fn is_in_window(&self, ray: &Ray) -> bool {
        self.window_deg.is_none_or(|[from, to]| {
            let place = ray.place;
            place.is_some_and(|place| (from..=to).contains(&place.y.atan2(place.x).to_degrees()))
        })
    }

    /// Where a ray ended as the cloud says, metres.
    fn place(&self, ray: &Ray) -> Option<Vector3<f64>> {
        let place = ray.place.filter(|_| self.is_in_window(ray))?;
        let (sin, cos) = (-self.turned_deg).to_radians().sin_cos();
        let mut told = Vector3::new(cos * place.x - sin * place.y, sin * place.x + cos * place.y, place.z);
        if self.driver == Driver::Hesai {
            // Azimuth 0 lies on y, which the driver leaves so.
            told = Vector3::new(-told.y, told.x, told.z);
        }
        if self.mirrored {
            told.y = -told.y;
        }
        if self.z_negated {
            told.z = -told.z;
        }
        if self.swapped {
            told = Vector3::new(told.y, told.x, told.z);
        }
        if self.optical {
            told = Vector3::new(-told.y, -told.z, told.x);
        }
        told *= self.scale;
        let told = self.stated.rotation * told + self.stated.translation.vector;
        Some(told + Vector3::from(self.offset))
    }

    /// The time of a point after the beginning of the scan as the cloud has it, seconds.
    fn after_s(&self, after_s: f64) -> f64 {
        match self.times {
            Times::Constant => 0.0,
            Times::Reversed => PERIOD_S - after_s,
            _ => after_s,
        }
    }

    /// Writes a point.
    fn point(&self, (ring, column, after_s, place): &CloudRay, stamp_ns: i64, first_s: f64, points: &mut Points) {
        let nothing = match self.driver {
            Driver::Robosense => f64::NAN,
            _ => 0.0,
        };
        let [x, y, z] = place
            .map_or([nothing; 3], Into::into)
            .map(|value| Number::F32(value as f32));
        let range = place.map_or(0.0, |place| place.norm());
        let ring16 = Number::U16(u16::try_from(*ring).unwrap());
        let after_s = self.after_s((*after_s - first_s).max(0.0));
        let scaled_s = after_s * self.time_scale;
        let nanoseconds = Number::U32((scaled_s * 1e9) as u32);
        let absolute_s = (stamp_ns as f64 * 1e-9 + after_s + self.clock_s) * self.time_scale;
        points.put("x", x);
        points.put("y", y);
        points.put("z", z);
        points.put("intensity", Number::F32(10.0));
        let time = match self.driver {
            Driver::Plain | Driver::Livox | Driver::VelodynePackets | Driver::OusterPackets => return,
            Driver::Ouster => ("t", nanoseconds),
            Driver::Velodyne if self.epoch_single => ("time", Number::F32(absolute_s as f32)),
            Driver::Velodyne => ("time", Number::F32((scaled_s - PERIOD_S * self.time_scale) as f32)),
            Driver::Hesai | Driver::Robosense => ("timestamp", Number::F64(absolute_s)),
            Driver::LivoxPoints => (
                "timestamp",
                Number::F64((stamp_ns as f64 + after_s * 1e9) * self.time_scale),
            ),
            Driver::Nebula => ("time_stamp", nanoseconds),
            Driver::Unknown => ("time_offset", Number::F32(scaled_s as f32)),
        };
        let put_time = |points: &mut Points| {
            if self.times != Times::Missing {
                points.put(time.0, time.1);
            }
        };
        match self.driver {
            Driver::Ouster => {
                put_time(points);
                points.put("reflectivity", Number::U16(5));
                points.put("ring", ring16);
                points.put("ambient", Number::U16(1));
                points.put("range", Number::U32((range * 1000.0) as u32));
            }
            Driver::Velodyne | Driver::Hesai | Driver::Robosense => {
                points.put("ring", ring16);
                put_time(points);
            }
            Driver::LivoxPoints => {
                points.put("tag", Number::U8(0));
                points.put("line", Number::U8(u8::try_from(*ring).unwrap()));
                put_time(points);
            }
            Driver::Unknown => put_time(points),
            _ => {
                let azimuth = TAU / 2.0 - TAU * f64::from(*column) / f64::from(self.columns);
                points.put("return_type", Number::U8(0));
                points.put("channel", ring16);
                points.put("azimuth", Number::F32(azimuth as f32));
                points.put("elevation", Number::F32(0.0));
                points.put("distance", Number::F32(range as f32));
                put_time(points);
            }
        }
    }

    /// The packets of a scan that ends at the stamp. What is turned over about x or mirrored sweeps the other way: columns are then counted from the
    /// last one, as a sensor only turns clockwise.
    fn packets<'a>(&self, told: &[CloudRay], stamp_ns: i64) -> Vec<Field<'a>> {
        let columns = self.columns as usize;
        let each = (75 * SEQUENCES) / columns;
        let scan = Scan {
            sequences: each * columns / SEQUENCES * SEQUENCES,
            start_ns: stamp_ns - 75 * PACKET_NS,
            backwards: self.times == Times::Reversed,
        };
        let sequence = |column: u32| {
            if self.mirrored == self.swapped {
                column as usize
            } else {
                columns - 1 - column as usize
            }
        };
        let shots = told.iter().filter_map(|(_, column, _, place)| {
            Some(Shot {
                sequence: each * sequence(*column),
                place: (*place)?,
            })
        });
        let packets = scan.packets(&shots.collect::<Vec<_>>());
        let mut fields = vec![Field::Count(packets.len())];
        for (received_ns, bytes) in packets {
            fields.push(Field::U32(u32::try_from(received_ns / 1_000_000_000).unwrap()));
            fields.push(Field::U32(u32::try_from(received_ns % 1_000_000_000).unwrap()));
            fields.push(Field::Array(bytes));
        }
        fields
    }

    /// The packets of an Ouster's turn that begins at the stamp, one in a message.
    pub fn single_packets<'a>(&self, rays: &[Ray], stamp_ns: i64) -> Vec<Body<'a>> {
        let places = rays.iter().filter_map(|ray| Some((ray.ring, self.place(ray)?)));
        let places: Vec<_> = places.collect();
        let backwards = self.times == Times::Reversed;
        let packets = packets_ouster::packets(&self.scanner(), self.serial, stamp_ns, backwards, &places);
        packets.into_iter().map(Body::Packet).collect()
    }

    /// How long after the stamp the `k`-th message of a turn is received, nanoseconds: packets at their end.
    pub fn later_ns(&self, k: usize) -> i64 {
        if self.driver != Driver::OusterPackets {
            return 0;
        }
        let packets = self.columns as usize / packets_ouster::COLUMNS;
        (PERIOD_S * 1e9 * (k + 1) as f64 / packets as f64) as i64
    }

    /// A `CustomMsg`.
    fn custom<'a>(&self, told: &[CloudRay], stamp_ns: i64) -> Vec<Field<'a>> {
        let points: Vec<_> = told.iter().filter_map(|ray| Some((ray, ray.3?))).collect();
        let count = u32::try_from(points.len()).unwrap();
        let mut fields = vec![
            Field::U64(stamp_ns.cast_unsigned()),
            Field::U32(count),
            Field::U8(0),
            Field::U8(0),
            Field::U8(0),
            Field::U8(0),
            Field::Count(points.len()),
        ];
        for ((ring, _, after_s, _), place) in points {
            let nanoseconds = (self.after_s(*after_s) * self.time_scale * 1e9) as u32;
            fields.push(Field::U32(nanoseconds));
            fields.extend([place.x, place.y, place.z].map(|value| Field::F32(value as f32)));
            fields.push(Field::U8(10));
            fields.push(Field::U8(0));
            fields.push(Field::U8(u8::try_from(*ring).unwrap()));
        }
        fields
    }
}
