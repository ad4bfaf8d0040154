//! Clouds of recipes: what drivers of lidars make of the rays of a scan.
//!
//! Sources of the layouts: ouster-ros (os_point.h), velodyne_driver (point_types.h), HesaiLidar_ROS_2.0 and rs_driver (PointXYZIRT),
//! livox_ros_driver2 (lddc.h: PointXYZRTLT; CustomMsg.msg), nebula (point_types.hpp: PointXYZIRCAEDT).

use std::f64::consts::TAU;

use nalgebra::Vector3;
use serde::Deserialize;

use super::drive::lidar::{Ray, Scanner};
use super::drive::scene::Surroundings;
use super::encode::Field;

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
    /// It does not spin.
    #[serde(default)]
    pub solid_state: bool,
    #[serde(default)]
    pub surroundings: Surroundings,
    /// The cloud is told in axes that are turned so about z against x forward: 180 for Ouster's Lidar frame.
    #[serde(default)]
    pub turned_deg: f64,
    /// y is told with the other sign.
    #[serde(default)]
    pub mirrored: bool,
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
    /// Only what lies between these angles, counter-clockwise from x forward, degrees.
    pub window_deg: Option<[f64; 2]>,
    /// Rows are shifted so that columns are of one direction; else of one time.
    #[serde(default)]
    pub destaggered: bool,
}

/// Whose driver it is.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Driver {
    /// x, y, z and intensity, in no order.
    #[default]
    Plain,
    Ouster,
    Velodyne,
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
}

fn thirty_two() -> u32 {
    32
}

fn columns() -> u32 {
    512
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

    fn bytes(self) -> Vec<u8> {
        match self {
            Self::U8(value) => value.to_le_bytes().into(),
            Self::U16(value) => value.to_le_bytes().into(),
            Self::U32(value) => value.to_le_bytes().into(),
            Self::F32(value) => value.to_le_bytes().into(),
            Self::F64(value) => value.to_le_bytes().into(),
        }
    }
}

impl Lidar {
    /// The sensor.
    pub fn scanner(&self) -> Scanner {
        let scanner = if self.solid_state {
            Scanner::solid_state()
        } else {
            Scanner::spinning(self.beams, self.columns)
        };
        Scanner {
            lost: self.lost.unwrap_or(scanner.lost),
            ..scanner
        }
    }

    /// By how much a scan begins before the stamp of its message, seconds.
    pub fn before_stamp_s(&self) -> f64 {
        match self.driver {
            Driver::Velodyne => self.scanner().period_s,
            _ => 0.0,
        }
    }

    /// The type of its messages.
    pub fn message_type(&self) -> &'static str {
        match self.driver {
            Driver::Livox => "livox_ros_driver2/msg/CustomMsg",
            _ => "sensor_msgs/msg/PointCloud2",
        }
    }

    /// The fields of a message behind its header.
    pub fn fields<'a>(&self, rays: &[Ray], stamp_ns: i64) -> Vec<Field<'a>> {
        let scanner = self.scanner();
        let told: Vec<(u32, u32, f64, Option<Vector3<f64>>)> = rays
            .iter()
            .map(|ray| (ray.ring, ray.column, ray.after_s, self.place(ray)))
            .collect();
        if self.driver == Driver::Livox {
            return self.custom(&told, stamp_ns);
        }
        let is_organised = matches!(self.driver, Driver::Ouster | Driver::Robosense) && !self.solid_state;
        let points: Vec<Vec<(&str, Number)>> = if is_organised {
            let mut rows = Vec::new();
            for ring in 0..scanner.beams {
                let mut row: Vec<_> = told.iter().filter(|ray| ray.0 == ring).collect();
                if self.destaggered {
                    let shift = usize::try_from(ring % 4).unwrap() * 3;
                    row.rotate_left(shift);
                }
                rows.extend(row.into_iter().map(|ray| self.point(ray, stamp_ns)));
            }
            rows
        } else {
            let returned = told.iter().filter(|ray| ray.3.is_some());
            returned.map(|ray| self.point(ray, stamp_ns)).collect()
        };
        let layout: Vec<(&str, Number)> = points
            .first()
            .cloned()
            .unwrap_or_else(|| self.point(&(0, 0, 0.0, None), stamp_ns));
        let sizes: Vec<usize> = layout.iter().map(|(_, number)| number.bytes().len()).collect();
        let point_step = u32::try_from(sizes.iter().sum::<usize>()).unwrap();
        let (height, width) = if is_organised {
            (scanner.beams, scanner.columns)
        } else {
            (1, u32::try_from(points.len()).unwrap())
        };
        let mut fields = vec![Field::U32(height), Field::U32(width), Field::Count(layout.len())];
        let mut offset = 0;
        for ((name, number), size) in layout.iter().zip(&sizes) {
            fields.push(Field::Owned((*name).to_owned()));
            fields.push(Field::U32(offset));
            fields.push(Field::U8(number.datatype()));
            fields.push(Field::U32(1));
            offset += u32::try_from(*size).unwrap();
        }
        let data = points.iter().flatten().flat_map(|(_, number)| number.bytes()).collect();
        fields.extend([
            Field::U8(0),
            Field::U32(point_step),
            Field::U32(point_step * width),
            Field::Bytes(data),
            Field::U8(u8::from(!is_organised)),
        ]);
        fields
    }

    /// Where a ray ended as the cloud says, metres.
    fn place(&self, ray: &Ray) -> Option<Vector3<f64>> {
        let place = ray.place?;
        if let Some([from, to]) = self.window_deg {
            let azimuth = place.y.atan2(place.x).to_degrees();
            if !(from..=to).contains(&azimuth) {
                return None;
            }
        }
        let (sin, cos) = (-self.turned_deg).to_radians().sin_cos();
        let mut told = Vector3::new(cos * place.x - sin * place.y, sin * place.x + cos * place.y, place.z);
        if self.driver == Driver::Hesai {
            // Azimuth 0 lies on y, which the driver leaves so.
            told = Vector3::new(-told.y, told.x, told.z);
        }
        if self.mirrored {
            told.y = -told.y;
        }
        Some(told + Vector3::from(self.offset))
    }

    /// The time of a point after the beginning of the scan as the cloud has it, seconds.
    fn after_s(&self, after_s: f64) -> f64 {
        match self.times {
            Times::Constant => 0.0,
            _ => after_s * self.time_scale,
        }
    }

    fn point(
        &self,
        (ring, column, after_s, place): &(u32, u32, f64, Option<Vector3<f64>>),
        stamp_ns: i64,
    ) -> Vec<(&'static str, Number)> {
        let nothing = match self.driver {
            Driver::Robosense => f64::NAN,
            _ => 0.0,
        };
        let [x, y, z] = place.map_or([nothing; 3], Into::into).map(|value| value as f32);
        let range = place.map_or(0.0, |place| place.norm());
        let ring16 = Number::U16(u16::try_from(*ring).unwrap());
        let after_s = self.after_s(*after_s);
        let nanoseconds = Number::U32((after_s * 1e9) as u32);
        let absolute_s = stamp_ns as f64 * 1e-9 + after_s + self.clock_s;
        let mut point = vec![("x", Number::F32(x)), ("y", Number::F32(y)), ("z", Number::F32(z))];
        point.push(("intensity", Number::F32(10.0)));
        let time: (&str, Number) = match self.driver {
            Driver::Plain | Driver::Livox => return point,
            Driver::Ouster => ("t", nanoseconds),
            Driver::Velodyne if self.epoch_single => ("time", Number::F32(absolute_s as f32)),
            Driver::Velodyne => (
                "time",
                Number::F32((after_s - self.scanner().period_s * self.time_scale) as f32),
            ),
            Driver::Hesai | Driver::Robosense => ("timestamp", Number::F64(absolute_s)),
            Driver::LivoxPoints => ("timestamp", Number::F64(stamp_ns as f64 + after_s * 1e9)),
            Driver::Nebula => ("time_stamp", nanoseconds),
            Driver::Unknown => ("time_offset", Number::F32(after_s as f32)),
        };
        let time = (self.times != Times::Missing).then_some(time);
        match self.driver {
            Driver::Ouster => {
                point.extend(time);
                point.push(("reflectivity", Number::U16(5)));
                point.push(("ring", ring16));
                point.push(("ambient", Number::U16(1)));
                point.push(("range", Number::U32((range * 1000.0) as u32)));
            }
            Driver::Velodyne | Driver::Hesai | Driver::Robosense => {
                point.push(("ring", ring16));
                point.extend(time);
            }
            Driver::LivoxPoints => {
                point.push(("tag", Number::U8(0)));
                point.push(("line", Number::U8(u8::try_from(*ring).unwrap())));
                point.extend(time);
            }
            Driver::Unknown => point.extend(time),
            _ => {
                let azimuth = TAU / 2.0 - TAU * f64::from(*column) / f64::from(self.columns);
                point.push(("return_type", Number::U8(0)));
                point.push(("channel", ring16));
                point.push(("azimuth", Number::F32(azimuth as f32)));
                point.push(("elevation", Number::F32(0.0)));
                point.push(("distance", Number::F32(range as f32)));
                point.extend(time);
            }
        }
        point
    }

    /// A `CustomMsg`.
    fn custom<'a>(&self, told: &[(u32, u32, f64, Option<Vector3<f64>>)], stamp_ns: i64) -> Vec<Field<'a>> {
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
            let nanoseconds = (self.after_s(*after_s) * 1e9) as u32;
            fields.push(Field::U32(nanoseconds));
            fields.extend([place.x, place.y, place.z].map(|value| Field::F32(value as f32)));
            fields.push(Field::U8(10));
            fields.push(Field::U8(0));
            fields.push(Field::U8(u8::try_from(*ring).unwrap()));
        }
        fields
    }
}
