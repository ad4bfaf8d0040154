//! Packets of an Ouster and its metadata, from where its rays ended.
//!
//! Source: Ouster, Firmware User Manual, chapters on lidar and IMU data packets and on the sensor's metadata: a packet of the profile
//! RNG19_RFL8_SIG16_NIR16 has a header of 32 bytes, 16 columns (a header of 12 bytes, then 12 bytes for each beam) and a footer of 32 bytes.

use nalgebra::Vector3;
use serde_json::json;

use super::drive::lidar::Scanner;

/// The serial number of a sensor that has no other.
pub const SERIAL: u64 = 122_300_000_001;
/// Columns of a packet.
pub const COLUMNS: usize = 16;
/// Bytes of the header of a packet, and of its footer.
const HEADER: usize = 32;
/// Bytes of a pixel, and of the header of a column.
const PIXEL: usize = 12;
/// Number of the sensor's last start.
const INIT_ID: u32 = 390_076;
const GRAVITY: f64 = 9.80665;

/// What the sensor publishes of itself.
pub fn metadata(scanner: &Scanner, serial: u64) -> String {
    let (beams, columns) = (scanner.elevations_deg.len(), scanner.columns);
    let aside_deg: Vec<f64> = (0..scanner.beams()).map(|ring| scanner.aside_deg(ring)).collect();
    let at = |x: f64, y: f64, z: f64, turn: f64| [turn, 0., 0., x, 0., turn, 0., y, 0., 0., 1., z, 0., 0., 0., 1.];
    let metadata = json!({
        "sensor_info": {
            "prod_line": format!("OS-1-{beams}"), "prod_sn": serial.to_string(), "image_rev": "ousteros-image-prod-aries-v3.1.0",
            "build_rev": "v3.1.0", "initialization_id": INIT_ID, "status": "RUNNING",
        },
        "beam_intrinsics": {
            "beam_altitude_angles": scanner.elevations_deg, "beam_azimuth_angles": aside_deg,
            "beam_to_lidar_transform": at(0.0, 0.0, 0.0, 1.0),
        },
        "lidar_intrinsics": {"lidar_to_sensor_transform": at(0.0, 0.0, 36.18, -1.0)},
        "imu_intrinsics": {"imu_to_sensor_transform": at(6.253, -11.775, 7.645, 1.0)},
        "lidar_data_format": {
            "columns_per_frame": columns, "columns_per_packet": COLUMNS, "pixels_per_column": beams, "column_window": [0, columns - 1],
            "pixel_shift_by_row": vec![0; beams], "udp_profile_lidar": "RNG19_RFL8_SIG16_NIR16", "udp_profile_imu": "LEGACY", "fps": 10,
        },
        "config_params": {"lidar_mode": format!("{columns}x10"), "udp_port_lidar": 7502, "udp_port_imu": 7503},
    });
    metadata.to_string()
}

/// The packets of one turn: of each the bytes. `places` has beams and where their rays ended: x away from the connector, y left, z up from the
/// lidar's origin, metres. `backwards`: the clock of the sensor runs backwards.
pub fn packets(
    scanner: &Scanner,
    serial: u64,
    start_ns: i64,
    backwards: bool,
    places: &[(u32, Vector3<f64>)],
) -> Vec<Vec<u8>> {
    let (beams, columns) = (scanner.elevations_deg.len(), scanner.columns as usize);
    let column_bytes = PIXEL + PIXEL * beams;
    let start_ns = u64::try_from(start_ns).unwrap();
    let turn = (start_ns / 100_000_000) as u16;
    let period_ns = (scanner.period_s * 1e9) as u64;
    let mut packets: Vec<Vec<u8>> = (0..columns / COLUMNS)
        .map(|packet| {
            let mut bytes = [1_u16, turn].map(u16::to_le_bytes).concat();
            bytes.extend(&INIT_ID.to_le_bytes()[..3]);
            bytes.extend(&serial.to_le_bytes()[..5]);
            bytes.resize(HEADER, 0);
            for column in packet * COLUMNS..(packet + 1) * COLUMNS {
                let number = if backwards { columns - 1 - column } else { column };
                bytes.extend((start_ns + period_ns * number as u64 / columns as u64).to_le_bytes());
                // Its status is that it is valid.
                bytes.extend([column as u16, 1].map(u16::to_le_bytes).concat());
                bytes.resize(bytes.len() + PIXEL * beams, 0);
            }
            bytes.resize(bytes.len() + HEADER, 0);
            bytes
        })
        .collect();
    for (ring, place) in places {
        // Clockwise from the connector, at the back.
        let turned_deg = 180.0 - place.y.atan2(place.x).to_degrees() - scanner.aside_deg(*ring);
        let column = (turned_deg / 360.0 * columns as f64).round() as usize % columns;
        let range_mm = (place.norm() * 1000.0).round() as u32;
        let at = HEADER + column % COLUMNS * column_bytes + PIXEL + *ring as usize * PIXEL;
        let pixel = &mut packets[column / COLUMNS][at..at + PIXEL];
        pixel[..4].copy_from_slice(&range_mm.to_le_bytes());
        // Reflectivity, signal and near infrared.
        pixel[4..].copy_from_slice(&[5, 0, 100, 0, 1, 0, 0, 0]);
    }
    packets
}

/// A packet of the IMU in the layout LEGACY: three times, acceleration in g, angular rates in degrees a second.
pub fn imu(at_ns: i64, acceleration: [f64; 3], rates: [f64; 3]) -> Vec<u8> {
    let numbers = acceleration
        .map(|value| value / GRAVITY)
        .into_iter()
        .chain(rates.map(f64::to_degrees));
    let times = [at_ns; 3].map(i64::to_le_bytes).concat();
    times
        .into_iter()
        .chain(numbers.flat_map(|value| (value as f32).to_le_bytes()))
        .collect()
}
