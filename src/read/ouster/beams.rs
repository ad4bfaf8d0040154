//! The geometry of the beams: from a pixel and its range to a point.
//!
//! Source: ouster-sdk, `ouster_core/src/xyzlut.cpp`; Ouster's firmware user manual, "Lidar range to XYZ".

use std::f64::consts::TAU;

use super::Metadata;
use super::metadata::IDENTITY;

/// The frame of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The lidar frame: x towards encoder angle 0, which is the connector; origin at the centre of rotation.
    Lidar,
    /// The sensor frame: x away from the connector; origin at the bottom of the sensor.
    Sensor,
}

/// What turns ranges into points.
pub(crate) struct Beams {
    /// The beams' directions at encoder angle 0: one for each row, or for each pixel where nothing rotates.
    directions: Vec<[f64; 3]>,
    /// How far the direction moves on with each row and with each column.
    stride: (usize, usize),
    /// Cosine and sine of the encoder angle of each column.
    encoder: Vec<(f64, f64)>,
    /// Where the beams start: from the axis outwards, and above it, millimetres.
    start: (f64, f64),
    /// What a beam has already run there.
    run: f64,
    /// The lidar frame in the frame of the points.
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Beams {
    pub(crate) fn new(metadata: &Metadata, axes: Axes) -> Self {
        let (rows, columns) = (
            usize::from(metadata.pixels_per_column),
            usize::from(metadata.columns_per_frame),
        );
        let rotates = metadata.azimuth_deg.len() == rows;
        let turned = if rotates { -1. } else { 1. };
        let direction = |(azimuth, altitude): (&f64, &f64)| {
            let ((sin_a, cos_a), (sin, cos)) = (
                (azimuth * turned).to_radians().sin_cos(),
                altitude.to_radians().sin_cos(),
            );
            [cos_a * cos, sin_a * cos, sin]
        };
        let encoder = |column: usize| {
            let (sin, cos) = (TAU - column as f64 * TAU / columns as f64).sin_cos();
            if rotates { (cos, sin) } else { (1., 0.) }
        };
        let [_, _, _, x, _, _, _, _, _, _, _, z, ..] = metadata.beam_to_lidar;
        let [xx, xy, xz, tx, yx, yy, yz, ty, zx, zy, zz, tz, ..] = match axes {
            Axes::Lidar => IDENTITY,
            Axes::Sensor => metadata.lidar_to_sensor,
        };
        Self {
            directions: metadata
                .azimuth_deg
                .iter()
                .zip(&metadata.altitude_deg)
                .map(direction)
                .collect(),
            stride: if rotates { (1, 0) } else { (columns, 1) },
            encoder: (0..columns).map(encoder).collect(),
            start: (x, z),
            run: if z == 0. { x } else { x.hypot(z) },
            rotation: [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]],
            translation: [tx, ty, tz],
        }
    }

    /// The point of a return in metres; None where the sensor has no such pixel.
    pub(crate) fn point(&self, row: usize, column: usize, range_mm: u32) -> Option<[f32; 3]> {
        let [dx, dy, dz] = *self.directions.get(row * self.stride.0 + column * self.stride.1)?;
        let (cos, sin) = *self.encoder.get(column)?;
        let along = f64::from(range_mm) - self.run;
        let lidar = [
            along * (cos * dx - sin * dy) + cos * self.start.0,
            along * (sin * dx + cos * dy) + sin * self.start.0,
            along * dz + self.start.1,
        ];
        let mut point = [0.; 3];
        for ((out, row), shift) in point.iter_mut().zip(&self.rotation).zip(&self.translation) {
            let turned: f64 = row.iter().zip(&lidar).map(|(r, x)| r * x).sum();
            #[expect(clippy::cast_possible_truncation, reason = "f32 is what clouds have")]
            let metres = ((turned + shift) * 1e-3) as f32;
            *out = metres;
        }
        Some(point)
    }
}
