//! The Earth of drives: the WGS 84 ellipsoid, its tangent planes, its gravity, and the UTM grid. Formulas of textbooks,
//! written here because the code under test has its own.

use nalgebra::{Matrix3, Rotation3, Vector3};
use serde::Deserialize;

const A: f64 = 6_378_137.0;
const F: f64 = 1.0 / 298.257_223_563;
const E2: f64 = F * (2.0 - F);

/// A place on the Earth.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Degrees.
    pub latitude: f64,
    /// Degrees.
    pub longitude: f64,
    /// Metres above the ellipsoid.
    #[serde(default)]
    pub altitude: f64,
}

impl Place {
    /// Position in the Earth's frame, metres.
    pub fn ecef(self) -> Vector3<f64> {
        let (sin_lat, cos_lat) = self.latitude.to_radians().sin_cos();
        let (sin_lon, cos_lon) = self.longitude.to_radians().sin_cos();
        let n = A / (1.0 - E2 * sin_lat * sin_lat).sqrt();
        let across = (n + self.altitude) * cos_lat;
        let up = (n * (1.0 - E2) + self.altitude) * sin_lat;
        Vector3::new(across * cos_lon, across * sin_lon, up)
    }

    /// The place of a position in the Earth's frame, by iteration: good to a nanometre near the ground.
    pub fn of_ecef(p: Vector3<f64>) -> Self {
        let across = p.x.hypot(p.y);
        let mut latitude = p.z.atan2(across * (1.0 - E2));
        for _ in 0..8 {
            let sin = latitude.sin();
            let n = A / (1.0 - E2 * sin * sin).sqrt();
            latitude = (p.z + E2 * n * sin).atan2(across);
        }
        let (sin, cos) = latitude.sin_cos();
        Self {
            latitude: latitude.to_degrees(),
            longitude: p.y.atan2(p.x).to_degrees(),
            altitude: across * cos + p.z * sin - A * (1.0 - E2 * sin * sin).sqrt(),
        }
    }

    /// `earth_from_enu`: the columns are east, north and up.
    pub fn earth_from_enu(self) -> Rotation3<f64> {
        let (sin_lat, cos_lat) = self.latitude.to_radians().sin_cos();
        let (sin_lon, cos_lon) = self.longitude.to_radians().sin_cos();
        Rotation3::from_matrix_unchecked(Matrix3::new(
            -sin_lon,
            -sin_lat * cos_lon,
            cos_lat * cos_lon,
            cos_lon,
            -sin_lat * sin_lon,
            cos_lat * sin_lon,
            0.0,
            cos_lat,
            sin_lat,
        ))
    }

    /// The place of a position in the tangent plane of `self`.
    pub fn of_enu(self, enu: Vector3<f64>) -> Self {
        Self::of_ecef(self.ecef() + self.earth_from_enu() * enu)
    }

    /// A place in the tangent plane of `self`.
    pub fn enu(self, place: Self) -> Vector3<f64> {
        self.earth_from_enu().inverse() * (place.ecef() - self.ecef())
    }

    /// Normal gravity, m/s² (Somigliana, and the free-air gradient).
    pub fn gravity(self) -> f64 {
        let sin2 = self.latitude.to_radians().sin().powi(2);
        9.780_325_335_9 * (1.0 + 0.001_931_852_652_41 * sin2) / (1.0 - E2 * sin2).sqrt() - 3.086e-6 * self.altitude
    }

    /// The middle meridian of its UTM zone, degrees.
    pub fn utm_meridian(self) -> f64 {
        (self.longitude / 6.0).floor() * 6.0 + 3.0
    }

    /// Easting and northing in the UTM grid of a middle meridian, metres (transverse Mercator by Krüger's series to the
    /// fourth order: below a tenth of a millimetre within a zone).
    pub fn utm(self, meridian: f64) -> (f64, f64) {
        let n = F / (2.0 - F);
        let radius = A / (1.0 + n) * (1.0 + n.powi(2) / 4.0 + n.powi(4) / 64.0);
        let alpha = [
            n / 2.0 - 2.0 / 3.0 * n.powi(2) + 5.0 / 16.0 * n.powi(3) + 41.0 / 180.0 * n.powi(4),
            13.0 / 48.0 * n.powi(2) - 3.0 / 5.0 * n.powi(3) + 557.0 / 1440.0 * n.powi(4),
            61.0 / 240.0 * n.powi(3) - 103.0 / 140.0 * n.powi(4),
            49_561.0 / 161_280.0 * n.powi(4),
        ];
        let (sin_lat, aside) = (
            self.latitude.to_radians().sin(),
            (self.longitude - meridian).to_radians(),
        );
        let e = E2.sqrt();
        // The tangent of the conformal latitude.
        let t = (sin_lat.atanh() - e * (e * sin_lat).atanh()).sinh();
        let (xi, eta) = (t.atan2(aside.cos()), (aside.sin() / (1.0 + t * t).sqrt()).atanh());
        let (mut north, mut east) = (xi, eta);
        for (k, a) in (1..).zip(alpha) {
            let k = 2.0 * f64::from(k);
            north += a * (k * xi).sin() * (k * eta).cosh();
            east += a * (k * xi).cos() * (k * eta).sinh();
        }
        let false_north = if self.latitude < 0.0 { 1e7 } else { 0.0 };
        (
            500_000.0 + 0.9996 * radius * east,
            false_north + 0.9996 * radius * north,
        )
    }
}
