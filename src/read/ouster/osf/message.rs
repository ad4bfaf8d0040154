//! A message of a stream of lidar scans, decoded into images and then into returns.
//!
//! Source: ouster-sdk, `ouster_osf/fb/os_sensor/lidar_scan_stream.fbs` and `ouster_osf/src/stream_lidar_frame.cpp`,
//! `fb_common.cpp`.

use super::flat::Table;
use super::image::Image;
use super::{Message, OsfError};
use crate::read::ouster::{Axes, Builder, Imu, Metadata, Scan};

/// The fields that can be decoded, each at its number less 1.
const FIELDS: [&str; 9] = [
    "RANGE",
    "RANGE2",
    "SIGNAL",
    "SIGNAL2",
    "REFLECTIVITY",
    "REFLECTIVITY2",
    "NEAR_IR",
    "FLAGS",
    "FLAGS2",
];
/// Of each return: its range, its intensity, and what stands for that where it is missing.
const RETURNS: [[&str; 3]; 2] = [
    ["RANGE", "SIGNAL", "REFLECTIVITY"],
    ["RANGE2", "SIGNAL2", "REFLECTIVITY2"],
];

/// One turn of a sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LidarScan {
    /// When the host received it, nanoseconds.
    pub time_ns: u64,
    /// When each column was measured, nanoseconds by the sensor's clock; empty where the file lacks it.
    pub timestamps_ns: Vec<u64>,
    /// The status of each column, its lowest bit set where it is valid; empty where the file lacks it.
    pub status: Vec<u32>,
    /// What the sensor's IMU measured during the turn, without what it marks as invalid; empty where the file lacks it.
    pub imu: Vec<Imu>,
    /// Columns and rows of each image.
    pub size: (u16, u16),
    fields: Vec<(&'static str, Vec<u32>)>,
}

impl LidarScan {
    /// Decodes a message of a stream of lidar scans, with the images of these fields ("RANGE", "NEAR_IR", ...) or all that
    /// are known; those that it lacks are left out.
    ///
    /// # Errors
    /// Where the message is damaged, or does not fit the sensor of the metadata.
    pub fn read(message: &Message<'_>, metadata: &Metadata, fields: Option<&[&str]>) -> Result<Self, OsfError> {
        let table = Table::root(message.bytes, None).ok_or(OsfError::Damaged { part: "lidar scan" })?;
        let size = (metadata.columns_per_frame, metadata.pixels_per_column);
        let columns = usize::from(size.0);
        let mut scan = Self {
            time_ns: message.time_ns,
            timestamps_ns: each("timestamps", columns, table.numbers(2, u64::from_le_bytes))?,
            status: each("status", columns, table.numbers(4, u32::from_le_bytes))?,
            imu: imu(table)?,
            size,
            fields: Vec::new(),
        };
        let kinds = table.vector(1, 2).unwrap_or_default().as_chunks::<2>().0;
        for (number, field) in (1..).zip(FIELDS) {
            let wanted = fields.is_none_or(|wanted| wanted.contains(&field));
            let Some(at) = kinds.iter().position(|[kind, _]| wanted && *kind == number) else {
                continue;
            };
            let channel = table
                .tables(0)
                .nth(at)
                .flatten()
                .and_then(|channel| channel.vector(0, 1));
            let image = scan.image(
                field,
                channel.ok_or(OsfError::Damaged { part: "lidar scan" })?,
                metadata,
            )?;
            scan.fields.push((field, image));
        }
        Ok(scan)
    }

    fn image(&self, field: &'static str, bytes: &[u8], metadata: &Metadata) -> Result<Vec<u32>, OsfError> {
        let (mut values, shifted) = Image { field, size: self.size }.decode(bytes)?;
        if shifted {
            let rows = values.chunks_exact_mut(self.size.0.into());
            for (row, shift) in rows.zip(&metadata.pixel_shift_by_row) {
                let by = shift.rem_euclid(self.size.0.into());
                row.rotate_left(usize::try_from(by).unwrap_or_default());
            }
        }
        Ok(values)
    }

    /// The values of a field row by row, from the highest beam down; None where it was not decoded. Columns are measurement
    /// ids, as the sensor sends them.
    pub fn field(&self, name: &str) -> Option<&[u32]> {
        self.fields
            .iter()
            .find(|field| field.0 == name)
            .map(|field| field.1.as_slice())
    }

    /// The returns of the valid columns, as [`crate::read::ouster::decode`] gives those of packets.
    pub fn scan(&self, metadata: &Metadata, axes: Axes) -> Scan {
        let mut build = Builder::new(metadata, axes);
        build.scan.received_ns = i64::try_from(self.time_ns).ok();
        let returns = RETURNS.map(|[range, signal, reflectivity]| {
            Some((
                self.field(range)?,
                self.field(signal).or(self.field(reflectivity)).unwrap_or_default(),
            ))
        });
        for column in 0..self.size.0 {
            let at = usize::from(column);
            if self.status.get(at).is_some_and(|status| status & 1 == 0) {
                continue;
            }
            let offset_ns = build.offset(self.timestamps_ns.get(at).copied().unwrap_or_default());
            for row in 0..self.size.1 {
                let at = usize::from(row) * usize::from(self.size.0) + at;
                let echo = |(range, intensity): (&[u32], &[u32])| {
                    Some((*range.get(at)?, intensity.get(at).copied().unwrap_or_default()))
                };
                let [Some(first), second] = returns.map(|images| images.and_then(echo)) else {
                    continue;
                };
                build.pixel(row, column, offset_ns, first, second);
            }
        }
        build.scan
    }
}

/// The returns of a message of a stream of lidar scans, given its bytes and when the host received it, nanoseconds.
///
/// # Errors
/// See [`LidarScan::read`].
pub fn stored(bytes: &[u8], received_ns: i64, metadata: &Metadata, axes: Axes) -> Result<Scan, OsfError> {
    let message = Message {
        time_ns: u64::try_from(received_ns).unwrap_or_default(),
        sensor_ns: 0,
        stream: 0,
        bytes,
    };
    let fields: Vec<&str> = RETURNS.into_iter().flatten().collect();
    Ok(LidarScan::read(&message, metadata, Some(&fields))?.scan(metadata, axes))
}

/// A list that has one entry for each column, or none at all.
fn each<T>(list: &'static str, columns: usize, entries: Vec<T>) -> Result<Vec<T>, OsfError> {
    if entries.is_empty() || entries.len() == columns {
        return Ok(entries);
    }
    Err(OsfError::Columns {
        list,
        found: entries.len(),
        columns,
    })
}

/// The measurements of the IMU, which are among the fields that have names: lists as they are, vectors as images of three
/// columns whose values are the bits of floats.
fn imu(table: Table<'_>) -> Result<Vec<Imu>, OsfError> {
    let data = |name| {
        table
            .tables(8)
            .flatten()
            .find(|field| field.text(0) == Some(name))?
            .vector(4, 1)
    };
    let names = ["IMU_TIMESTAMP", "IMU_STATUS", "IMU_ACC", "IMU_GYRO"];
    let [Some(times), Some(status), Some(acceleration), Some(gyro)] = names.map(data) else {
        return Ok(Vec::new());
    };
    let (times, status) = (times.as_chunks().0, status.as_chunks().0);
    if times.is_empty() {
        return Ok(Vec::new());
    }
    let size = (
        3,
        u16::try_from(times.len()).map_err(|_| OsfError::Damaged {
            part: "list of IMU measurements",
        })?,
    );
    let vectors = |field, bytes| -> Result<Vec<[f64; 3]>, OsfError> {
        let floats = Image { field, size }.decode(bytes)?.0.into_iter();
        let floats: Vec<_> = floats.map(|bits| f64::from(f32::from_bits(bits))).collect();
        Ok(floats.as_chunks().0.to_vec())
    };
    let vectors = vectors("IMU_ACC", acceleration)?
        .into_iter()
        .zip(vectors("IMU_GYRO", gyro)?);
    let valid = times
        .iter()
        .zip(status)
        .zip(vectors)
        .filter(|((_, status), _)| u16::from_le_bytes(**status) & 1 == 1);
    Ok(valid
        .map(|((time, _), (acceleration, rate))| Imu::new(u64::from_le_bytes(*time), [acceleration, rate]))
        .collect())
}
