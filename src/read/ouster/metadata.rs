//! The sensor's metadata: what it says of the packets and of the geometry of the beams.
//!
//! All generations are read: flat keys (firmware 1 and 2), sections (from firmware 2.1's HTTP interface on, and as
//! ouster-sdk writes them), and files reduced to the beams and the mode. Defaults are those of ouster-sdk's
//! `ouster_core/src/metadata.cpp`, `data_format.cpp` and `sensor_info.cpp`.

use serde_json::Value;

use super::OusterError;

/// The most columns of a turn that are accepted; sensors have up to 4096.
const MOST_COLUMNS: u16 = 16384;
/// The most rows that are accepted; sensors have up to 128.
const MOST_ROWS: u16 = 512;

/// A rigid transform, rows one after the other, translation in millimetres.
pub type Matrix = [f64; 16];

/// The section on packets, which flat metadata calls "data_format".
const FORMAT: &str = "lidar_data_format";
const LIDAR_TO_SENSOR: Matrix = [-1., 0., 0., 0., 0., -1., 0., 0., 0., 0., 1., 36.18, 0., 0., 0., 1.];
pub(crate) const IDENTITY: Matrix = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];

/// Distance from the lidar's origin to that of the beams by the start of the product line, millimetres; the last is for
/// the first generation.
const ORIGIN_MM: [(&str, f64); 4] = [("OS-0-", 27.67), ("OS-1-", 15.806), ("OS-2-", 13.762), ("", 12.163)];

/// What a sensor's metadata says.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// The model: "OS-1-128"; empty where not stated.
    pub product_line: String,
    /// The serial number; 0 where not stated.
    pub serial: u64,
    /// Columns of a whole turn.
    pub columns_per_frame: u16,
    /// Columns of a lidar packet.
    pub columns_per_packet: u16,
    /// Pixels of a column, which are the beams.
    pub pixels_per_column: u16,
    /// Columns by which each row of an image is to be moved so that it shows what the eye sees.
    pub pixel_shift_by_row: Vec<i32>,
    /// Azimuth of each row's beam, degrees, clockwise seen from above; of sensors without rotation, of each pixel, row by
    /// row, counterclockwise.
    pub azimuth_deg: Vec<f64>,
    /// Altitude of each beam, degrees, upwards; in the order of the azimuths.
    pub altitude_deg: Vec<f64>,
    /// Distance from the lidar's origin to that of the beams, millimetres.
    pub origin_mm: f64,
    /// The beams' origin in the lidar frame at encoder angle 0.
    pub beam_to_lidar: Matrix,
    /// The lidar frame in the sensor frame.
    pub lidar_to_sensor: Matrix,
    /// The layout of lidar packets: "RNG19_RFL8_SIG16_NIR16".
    pub lidar_profile: String,
    /// The layout of IMU packets: "LEGACY".
    pub imu_profile: String,
    /// Whether packets have the header of functional safety.
    pub safety_header: bool,
    /// Measurements of an IMU packet; 0 for "LEGACY", which has one.
    pub imu_measurements_per_packet: u16,
    /// The UDP port of lidar packets.
    pub lidar_port: Option<u16>,
    /// The UDP port of IMU packets.
    pub imu_port: Option<u16>,
}

/// The metadata's values, wherever its generation keeps them.
struct Keys(Value);

impl Keys {
    /// The value of a key in its section, or else in the section's older name, or else at the top.
    fn get(&self, section: &str, key: &str) -> Option<&Value> {
        let older = if section == FORMAT { "data_format" } else { section };
        let inside = |name: &str| self.0.get(name)?.get(key);
        inside(section)
            .or_else(|| inside(older))
            .or_else(|| self.0.get(key))
            .filter(|v| !v.is_null())
    }

    fn text(&self, section: &str, key: &str) -> String {
        self.get(section, key)
            .and_then(Value::as_str)
            .unwrap_or_default()
            .to_owned()
    }

    /// A whole number within its limits; None where it is absent or no whole number.
    fn small(&self, section: &str, key: &'static str, least: u16, most: u16) -> Result<Option<u16>, OusterError> {
        self.get(section, key)
            .and_then(whole)
            .map(|found| bounded(key, found, least, most))
            .transpose()
    }

    fn numbers(&self, section: &str, key: &str) -> Option<Vec<f64>> {
        flat(self.get(section, key)?)
    }

    fn angles(&self, key: &'static str) -> Result<Vec<f64>, OusterError> {
        self.numbers("beam_intrinsics", key).ok_or(OusterError::Missing { key })
    }

    fn matrix(&self, section: &str, key: &str) -> Option<Matrix> {
        self.numbers(section, key)?.try_into().ok()
    }
}

fn bounded(key: &'static str, found: u64, least: u16, most: u16) -> Result<u16, OusterError> {
    let range = OusterError::Range {
        key,
        found,
        least: least.into(),
        most: most.into(),
    };
    u16::try_from(found)
        .ok()
        .filter(|n| (least..=most).contains(n))
        .ok_or(range)
}

fn whole(value: &Value) -> Option<u64> {
    value.as_u64().or_else(|| value.as_str()?.parse().ok())
}

/// The numbers of a list, or of a list of lists, one list after the other; None where anything else is in it.
fn flat(value: &Value) -> Option<Vec<f64>> {
    let list = value.as_array()?;
    let one = |v: &Value| v.as_f64().filter(|x| x.is_finite());
    if list.iter().any(Value::is_array) {
        let rows: Option<Vec<_>> = list
            .iter()
            .map(|row| row.as_array()?.iter().map(one).collect())
            .collect();
        return Some(rows?.into_iter().flat_map(|row: Vec<f64>| row).collect());
    }
    list.iter().map(one).collect()
}

/// Columns and turns a second out of "1024x10".
fn mode(text: &str) -> Option<(u64, u16)> {
    let (columns, fps) = text.split_once('x')?;
    Some((columns.parse().ok()?, fps.parse().ok()?))
}

/// The beams that the product line states: 128 of "OS-1-128".
fn beams(product_line: &str) -> Option<u64> {
    product_line
        .split('-')
        .skip(2)
        .find_map(|part| part.parse().ok())
        .filter(|n| *n > 0)
}

impl Metadata {
    /// Reads the metadata out of the JSON text that the sensor or ouster-sdk gives.
    ///
    /// # Errors
    /// Where the text is no JSON object, lacks the beams' angles or the columns of a turn, or states numbers that no
    /// sensor has. A packet profile that is not known is an error of [`super::Layout::of`], not of this.
    pub fn parse(json: &str) -> Result<Self, OusterError> {
        let root = serde_json::from_str(json)
            .map_err(|e| OusterError::Json {
                line: e.line(),
                column: e.column(),
            })
            .and_then(|v: Value| {
                if v.is_object() {
                    Ok(v)
                } else {
                    Err(OusterError::Json { line: 1, column: 1 })
                }
            })?;
        let keys = Keys(root);
        let (format, config, info, beam) = (FORMAT, "config_params", "sensor_info", "beam_intrinsics");
        let profile = |key| {
            keys.get(format, key)
                .and_then(Value::as_str)
                .unwrap_or("LEGACY")
                .to_owned()
        };
        let product_line = keys.text(info, "prod_line");
        let mode = mode(&keys.text(config, "lidar_mode"));
        let columns_per_frame = columns(&keys, mode)?;
        let (azimuth_deg, altitude_deg) = (
            keys.angles("beam_azimuth_angles")?,
            keys.angles("beam_altitude_angles")?,
        );
        let pixels_per_column = rows(&keys, &product_line, altitude_deg.len())?;
        for (key, angles) in [
            ("beam_azimuth_angles", &azimuth_deg),
            ("beam_altitude_angles", &altitude_deg),
        ] {
            let (found, least) = (angles.len(), usize::from(pixels_per_column));
            let most = least * usize::from(columns_per_frame);
            if (found != least && found != most) || found != azimuth_deg.len() {
                return Err(OusterError::Range {
                    key,
                    found: found as u64,
                    least: least as u64,
                    most: most as u64,
                });
            }
        }
        let origin_mm = keys
            .get(beam, "lidar_origin_to_beam_origin_mm")
            .and_then(Value::as_f64)
            .or_else(|| {
                ORIGIN_MM
                    .iter()
                    .find(|(line, _)| product_line.starts_with(line))
                    .map(|(_, mm)| *mm)
            })
            .unwrap_or_default();
        let lidar_profile = profile("udp_profile_lidar");
        Ok(Self {
            serial: keys.get(info, "prod_sn").and_then(whole).unwrap_or_default(),
            columns_per_packet: keys.small(format, "columns_per_packet", 1, 512)?.unwrap_or(16),
            pixel_shift_by_row: shifts(&keys, pixels_per_column.into(), mode),
            beam_to_lidar: keys
                .matrix(beam, "beam_to_lidar_transform")
                .unwrap_or_else(|| shifted(origin_mm)),
            lidar_to_sensor: keys
                .matrix("lidar_intrinsics", "lidar_to_sensor_transform")
                .unwrap_or(LIDAR_TO_SENSOR),
            imu_profile: profile("udp_profile_imu"),
            imu_measurements_per_packet: keys
                .small("imu_data_format", "imu_measurements_per_packet", 0, 1024)?
                .unwrap_or_default(),
            lidar_port: keys.small(config, "udp_port_lidar", 0, u16::MAX)?,
            imu_port: keys.small(config, "udp_port_imu", 0, u16::MAX)?,
            safety_header: match keys.text(format, "header_type").as_str() {
                "" => lidar_profile == "FUSA_RNG15_RFL8_NIR8_DUAL",
                text => text == "FUSA",
            },
            product_line,
            columns_per_frame,
            pixels_per_column,
            azimuth_deg,
            altitude_deg,
            origin_mm,
            lidar_profile,
        })
    }

    /// The model: the product line, or the number of beams where that is not stated.
    pub fn model(&self) -> String {
        if self.product_line.is_empty() {
            format!("Ouster with {} beams", self.pixels_per_column)
        } else {
            self.product_line.clone()
        }
    }
}

/// Columns of a turn: as stated, or by the mode.
fn columns(keys: &Keys, mode: Option<(u64, u16)>) -> Result<u16, OusterError> {
    let key = "columns_per_frame";
    match (keys.small(FORMAT, key, 1, MOST_COLUMNS)?, mode) {
        (Some(columns), _) => Ok(columns),
        (None, Some((found, _))) => bounded(key, found, 1, MOST_COLUMNS),
        (None, None) => Err(OusterError::Missing { key }),
    }
}

/// Pixels of a column: as stated, or by the product line, or as many as there are angles.
fn rows(keys: &Keys, product_line: &str, angles: usize) -> Result<u16, OusterError> {
    let key = "pixels_per_column";
    let stated = keys.small(FORMAT, key, 1, MOST_ROWS)?;
    let found = stated
        .map(u64::from)
        .or_else(|| beams(product_line))
        .unwrap_or(angles as u64);
    bounded(key, found, 1, MOST_ROWS)
}

/// A transform along x.
fn shifted(x_mm: f64) -> Matrix {
    let mut matrix = IDENTITY;
    let [_, _, _, x, ..] = &mut matrix;
    *x = x_mm;
    matrix
}

/// One shift for each row: what is stated, or that of the first generation in this mode, and 0 for rows beyond those.
fn shifts(keys: &Keys, rows: usize, mode: Option<(u64, u16)>) -> Vec<i32> {
    let stated = keys.get(FORMAT, "pixel_shift_by_row").and_then(Value::as_array);
    let stated = stated.and_then(|list| list.iter().map(|v| i32::try_from(v.as_i64()?).ok()).collect());
    let mut shifts: Vec<_> = stated.unwrap_or_else(|| {
        let step = mode
            .and_then(|(columns, _)| i32::try_from(columns.checked_mul(3)? / 512).ok())
            .unwrap_or_default();
        [3, 2, 1, 0]
            .repeat(16)
            .into_iter()
            .map(|n: i32| n.saturating_mul(step))
            .collect()
    });
    shifts.resize(rows, 0);
    shifts
}
