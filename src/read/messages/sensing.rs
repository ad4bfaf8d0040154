//! The standard types of cameras, planar scanners and grids: calibrations, images, scans, grids.
//!
//! Owns the order of their fields. Sources: sensor_msgs (common_interfaces, common_msgs); the order is the same in ROS 1 and
//! ROS 2. The bytes of an image and the cells of a grid are never touched.
//! nav_msgs (OccupancyGrid), grid_map_msgs (GridMap: in ROS 1 the header is that of its GridMapInfo, in ROS 2 its own: the bytes are the same).

use super::content::{Body, CameraInfo, Grid, Image, LaserScan, MAX_DISTORTION, Roi};
use super::{Cursor, DecodeError};

/// Reads the rest of a `sensor_msgs/CameraInfo` after its header.
pub(super) fn camera_info<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let [height, width] = [cursor.u32()?, cursor.u32()?];
    let model = cursor.name()?;
    Ok(Body::CameraInfo(Box::new(CameraInfo {
        height,
        width,
        model: model.into(),
        d: coefficients(cursor)?,
        k: cursor.f64s()?,
        r: cursor.f64s()?,
        p: cursor.f64s()?,
        binning: [cursor.u32()?, cursor.u32()?],
        roi: Roi {
            x: cursor.u32()?,
            y: cursor.u32()?,
            height: cursor.u32()?,
            width: cursor.u32()?,
            do_rectify: cursor.i8()? != 0,
        },
    })))
}

/// Distortion coefficients.
fn coefficients(cursor: &mut Cursor<'_>) -> Result<Vec<f64>, DecodeError> {
    let (start, count) = (cursor.position(), cursor.u32()?);
    if count > MAX_DISTORTION {
        return Err(DecodeError(format!(
            "{count} distortion coefficients at byte {start}; models have at most {MAX_DISTORTION}"
        )));
    }
    (0..count).map(|_| cursor.f64()).collect()
}

/// Reads a `sensor_msgs/Image` after its header, as far as its bytes.
pub(super) fn image<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let [height, width] = [cursor.u32()?, cursor.u32()?];
    Ok(Body::Image(Image {
        height,
        width,
        encoding: cursor.name()?.into(),
    }))
}

/// Reads a `nav_msgs/OccupancyGrid` after its header, as far as the count of its cells.
pub(super) fn occupancy_grid<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    cursor.time()?;
    Ok(Body::Grid(Box::new(Grid {
        resolution_m: f64::from(cursor.f32()?),
        cells: [f64::from(cursor.u32()?), f64::from(cursor.u32()?)],
        position: cursor.f64s()?,
        orientation: cursor.f64s()?,
        data: Some(u64::from(cursor.u32()?)),
    })))
}

/// Reads a `grid_map_msgs/GridMap` after its header, as far as its pose.
pub(super) fn grid_map<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let [resolution_m, along_x_m, along_y_m] = cursor.f64s()?;
    Ok(Body::Grid(Box::new(Grid {
        resolution_m,
        cells: [along_x_m / resolution_m, along_y_m / resolution_m],
        position: cursor.f64s()?,
        orientation: cursor.f64s()?,
        data: None,
    })))
}

/// Reads a `sensor_msgs/LaserScan` after its header, as far as its ranges.
pub(super) fn laser_scan<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    scan(cursor, Cursor::u32, Cursor::f32)
}

/// The same of a `sensor_msgs/MultiEchoLaserScan`: the first echo of each ray, and NaN where there is none.
pub(super) fn multi_echo_scan<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    scan(cursor, Cursor::sequence, |cursor| {
        let echoes = cursor.u32()?;
        let first = if echoes > 0 { cursor.f32()? } else { f32::NAN };
        cursor.skip_numbers(4, echoes.saturating_sub(1) as usize)?;
        Ok(first)
    })
}

fn scan<'m>(
    cursor: &mut Cursor<'m>,
    count: impl Fn(&mut Cursor<'m>) -> Result<u32, DecodeError>,
    range_of: impl Fn(&mut Cursor<'m>) -> Result<f32, DecodeError>,
) -> Result<Body<'m>, DecodeError> {
    let mut of = || cursor.f32().map(f64::from);
    let angles = [of()?, of()?, of()?];
    let [time_increment, scan_time] = [of()?, of()?];
    let range = [of()?, of()?];
    let count = count(cursor)?;
    // No memory is reserved for the number that a message claims.
    let ranges = (0..count).map(|_| range_of(cursor).map(f64::from));
    Ok(Body::LaserScan(Box::new(LaserScan {
        angles,
        time_increment,
        scan_time,
        range,
        ranges: ranges.collect::<Result<_, DecodeError>>()?,
        pose: None,
    })))
}
