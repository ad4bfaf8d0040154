//! Radars and planar scanners of recipes: what drivers make of detections and ranges.
//!
//! Sources of the layouts: radar_msgs (RadarScan); smartmicro_ros2_radars (x, y, z, radial_speed, power, RCS, Noise); ti_mmwave_rospkg
//! (RadarScan, one message a point); continental_msgs of Nebula (ContinentalSrr520DetectionList); delphi_esr_msgs (EsrTrack: degrees,
//! clockwise); nuscenes2bag (vx, vy).

use serde::Deserialize;

use super::drive::planar::Fan;
use super::drive::radar::{Antenna, Echo};
use super::encode::{Body, Field, Header};

/// A radar of a recipe's drive.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Radar {
    #[serde(default)]
    pub driver: RadarDriver,
    #[serde(default = "sixty")]
    pub sides_deg: f64,
    #[serde(default = "four")]
    pub reflectors: u32,
    #[serde(default = "four")]
    pub movers: u32,
    /// Rates have the sign of approaching.
    #[serde(default)]
    pub reversed: bool,
    /// The platform's motion is taken out of the rates.
    #[serde(default)]
    pub compensated: bool,
    /// Azimuths count clockwise.
    #[serde(default)]
    pub mirrored: bool,
}

/// Whose driver it is.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum RadarDriver {
    /// `radar_msgs/msg/RadarScan`.
    #[default]
    Scan,
    Smartmicro,
    TiMmwave,
    Nebula,
    Delphi,
    Nuscenes,
}

fn sixty() -> f64 {
    60.0
}

fn four() -> u32 {
    4
}

impl Radar {
    /// The sensor.
    pub fn antenna(&self) -> Antenna {
        Antenna {
            sides_deg: self.sides_deg,
            up_deg: 12.0,
            reach_m: 70.0,
            lost: 0.25,
            reflectors: self.reflectors,
            movers: self.movers,
        }
    }

    /// The type of its messages.
    pub fn message_type(&self) -> &'static str {
        match self.driver {
            RadarDriver::Scan => "radar_msgs/msg/RadarScan",
            RadarDriver::Smartmicro | RadarDriver::Nuscenes => "sensor_msgs/msg/PointCloud2",
            RadarDriver::TiMmwave => "ti_mmwave_rospkg/msg/RadarScan",
            RadarDriver::Nebula => "continental_msgs/msg/ContinentalSrr520DetectionList",
            RadarDriver::Delphi => "delphi_esr_msgs/msg/EsrTrack",
        }
    }

    /// The messages of a scan.
    pub fn bodies<'a>(&self, echoes: &[Echo], header: Header<'a>) -> Vec<Body<'a>> {
        let columns: Vec<[f64; 4]> = echoes.iter().map(|echo| self.columns(echo)).collect();
        let polar = |[x, y, z, _]: &[f64; 4]| {
            let flat = x.hypot(*y);
            [flat.hypot(*z), y.atan2(*x), z.atan2(flat)]
        };
        let f32 = |value: f64| Field::F32(value as f32);
        let list = match self.driver {
            RadarDriver::Scan => {
                let mut fields = vec![Field::Count(columns.len())];
                for one in &columns {
                    fields.extend(polar(one).map(f32));
                    fields.extend([f32(one[3]), f32(10.0)]);
                }
                fields
            }
            RadarDriver::Nebula => {
                let mut fields = vec![Field::U32(0), Field::U8(0), Field::U8(0), Field::U8(0), Field::U32(0)];
                fields.extend([f32(50.0), f32(70.0), Field::Count(columns.len())]);
                for one in &columns {
                    let [range, azimuth, _] = polar(one);
                    fields.extend([range, azimuth, one[3], 3.0].map(f32));
                    fields.extend((0..6).map(Field::U8));
                    fields.push(f32(20.0));
                }
                fields
            }
            RadarDriver::Smartmicro => cloud(
                &["x", "y", "z", "radial_speed", "power", "RCS", "Noise"],
                columns
                    .iter()
                    .map(|[x, y, z, rate]| vec![*x, *y, *z, *rate, 90.0, 4.0, 30.0]),
            ),
            RadarDriver::Nuscenes => cloud(
                &["x", "y", "z", "rcs", "vx", "vy", "vx_comp", "vy_comp"],
                columns
                    .iter()
                    .map(|[x, y, z, rate]| vec![*x, *y, *z, 5.0, *rate, 0.0, 0.0, 0.0]),
            ),
            RadarDriver::TiMmwave => {
                let one = |(id, one): (u16, &[f64; 4])| {
                    let [range, azimuth, _] = polar(one);
                    let mut fields = vec![Field::U16(id)];
                    fields.extend([one[0], one[1], one[2], range, one[3]].map(f32));
                    fields.push(Field::U16(3));
                    fields.extend([azimuth.to_degrees(), 12.0].map(f32));
                    Body::Fields(header, fields)
                };
                return (0..).zip(&columns).map(one).collect();
            }
            RadarDriver::Delphi => {
                let one = |(id, one): (u8, &[f64; 4])| {
                    let [range, azimuth, _] = polar(one);
                    let fields = vec![
                        Field::Text("510"),
                        Field::U8(id),
                        f32(0.0),
                        Field::U8(0),
                        Field::U8(0),
                        Field::U8(3),
                        f32(-azimuth.to_degrees()),
                        f32(range),
                        Field::U8(0),
                        Field::U8(0),
                        f32(1.0),
                        f32(0.0),
                        Field::U8(1),
                        f32(one[3]),
                    ];
                    Body::Fields(header, fields)
                };
                return (1..=64).zip(&columns).map(one).collect();
            }
        };
        vec![Body::Fields(header, list)]
    }

    /// x, y, z and the rate as the driver tells them.
    fn columns(&self, echo: &Echo) -> [f64; 4] {
        let rate = if self.compensated {
            echo.rate - echo.still_rate
        } else {
            echo.rate
        };
        let sign = |is_other: bool| if is_other { -1.0 } else { 1.0 };
        let [x, y, z] = echo.place.into();
        [x, sign(self.mirrored) * y, z, sign(self.reversed) * rate]
    }
}

/// A cloud of points of four-byte numbers.
fn cloud<'a>(names: &[&str], points: impl Iterator<Item = Vec<f64>>) -> Vec<Field<'a>> {
    let points: Vec<Vec<f64>> = points.collect();
    let (step, width) = (
        4 * u32::try_from(names.len()).unwrap(),
        u32::try_from(points.len()).unwrap(),
    );
    let mut fields = vec![Field::U32(1), Field::U32(width), Field::Count(names.len())];
    for (place, name) in (0..).zip(names) {
        fields.extend([
            Field::Owned((*name).to_owned()),
            Field::U32(4 * place),
            Field::U8(7),
            Field::U32(1),
        ]);
    }
    let data = points
        .iter()
        .flatten()
        .flat_map(|value| (*value as f32).to_le_bytes())
        .collect();
    fields.extend([
        Field::U8(0),
        Field::U32(step),
        Field::U32(step * width),
        Field::Bytes(data),
        Field::U8(1),
    ]);
    fields
}

/// A planar scanner of a recipe's drive.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Laser {
    #[serde(default = "rays")]
    pub rays: u32,
    #[serde(default = "sides")]
    pub sides_deg: f64,
    #[serde(default = "tenth")]
    pub period_s: f64,
    /// Multiplies `time_increment` and `scan_time`.
    #[serde(default = "one")]
    pub time_scale: f64,
    /// Multiplies `angle_increment` alone.
    #[serde(default = "one")]
    pub increment_scale: f64,
    /// The last ray is told first, with angles that grow as before.
    #[serde(default)]
    pub backward: bool,
}

fn rays() -> u32 {
    361
}

fn sides() -> f64 {
    135.0
}

fn tenth() -> f64 {
    0.1
}

fn one() -> f64 {
    1.0
}

impl Laser {
    /// The sensor.
    pub fn fan(&self) -> Fan {
        Fan {
            rays: self.rays,
            sides_deg: self.sides_deg,
            period_s: self.period_s,
            reach_m: 40.0,
            noise_m: 0.01,
        }
    }

    /// The fields of a `sensor_msgs/msg/LaserScan` behind its header.
    pub fn fields<'a>(&self, ranges: &[f64]) -> Vec<Field<'a>> {
        let fan = self.fan();
        let [first, step] = fan.angles();
        let head = [
            first,
            -first,
            step * self.increment_scale,
            fan.ray_s() * self.time_scale,
            fan.period_s * self.time_scale,
            0.1,
            fan.reach_m,
        ];
        let mut fields: Vec<Field<'a>> = head.iter().map(|value| Field::F32(*value as f32)).collect();
        let mut columns: Vec<f64> = ranges.to_vec();
        if self.backward {
            columns.reverse();
        }
        fields.push(Field::Count(columns.len()));
        fields.extend(columns.iter().map(|range| Field::F32(*range as f32)));
        fields.push(Field::Empty(1));
        fields
    }
}
