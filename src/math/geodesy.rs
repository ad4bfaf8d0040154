//! Places on the Earth: the WGS 84 ellipsoid, the Earth-centred frame, local east-north-up.
//!
//! Owns conversions between geodetic and Cartesian coordinates, and the radii of curvature. The map grid is in
//! [`utm`](super::utm), the geoid in [`geoid`](super::geoid). Must not know frame names or messages. Radians, metres;
//! latitude north and longitude east are positive; heights are above the ellipsoid.
//! Source: NIMA TR8350.2, third edition, 2000 (constants); Bowring, Survey Review 23, 1976 (inverse).

use nalgebra::{Matrix3, Rotation3, Vector3};

/// The semi-major axis of WGS 84, metres.
pub const SEMI_MAJOR_M: f64 = 6_378_137.0;

/// The flattening of WGS 84.
pub const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// The semi-minor axis of WGS 84, metres.
pub const SEMI_MINOR_M: f64 = SEMI_MAJOR_M * (1.0 - FLATTENING);

/// The square of the first eccentricity of WGS 84.
pub const ECCENTRICITY_SQUARED: f64 = FLATTENING * (2.0 - FLATTENING);

/// A geodetic place on WGS 84.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    /// The angle of the ellipsoid's normal to the equator, radians, -pi/2..=pi/2: not that of the line to the centre,
    /// which differs by up to 0.19 degrees.
    pub latitude_rad: f64,
    /// Radians east of Greenwich.
    pub longitude_rad: f64,
    /// Metres above the ellipsoid, along its normal.
    pub height_m: f64,
}

impl Geodetic {
    /// From degrees, as messages hold them, and metres. `None` when a number is not finite or the latitude is beyond a
    /// pole. Any longitude is accepted.
    pub fn from_degrees(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Option<Geodetic> {
        let finite = longitude_deg.is_finite() && height_m.is_finite();
        (finite && latitude_deg.abs() <= 90.0).then(|| Geodetic {
            latitude_rad: latitude_deg.to_radians(),
            longitude_rad: longitude_deg.to_radians(),
            height_m,
        })
    }

    /// Earth-centred, Earth-fixed coordinates, metres: x through Greenwich, z through the north pole.
    pub fn to_ecef(&self) -> Vector3<f64> {
        let (sin_lat, cos_lat) = self.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = self.longitude_rad.sin_cos();
        let n = self.prime_vertical_radius_m();
        let r = (n + self.height_m) * cos_lat;
        let z = (n * (1.0 - ECCENTRICITY_SQUARED) + self.height_m) * sin_lat;
        Vector3::new(r * cos_lon, r * sin_lon, z)
    }

    /// The place with these Earth-centred coordinates, metres. To nanometres from 5000 km below to far above the
    /// ellipsoid.
    ///
    /// `None` when a coordinate is not finite or the point is within 1000 km of the centre: no place is there, and the
    /// latitude is not unique everywhere. The longitude is 0 on the axis.
    pub fn from_ecef(ecef_m: &Vector3<f64>) -> Option<Geodetic> {
        let (p, z) = (ecef_m.x.hypot(ecef_m.y), ecef_m.z);
        let r = p.hypot(z);
        if !(r.is_finite() && r >= 1e6) {
            return None;
        }
        let (a, b) = (SEMI_MAJOR_M, SEMI_MINOR_M);
        let second = ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED);
        // Bowring: from the parametric latitude; on the Earth one turn is enough, and a few are at any height.
        let (mut sin_b, mut cos_b) = (z * a).atan2(p * b).sin_cos();
        let mut latitude_rad = 0.0;
        for _ in 0..10 {
            let next = (z + second * b * sin_b.powi(3)).atan2(p - ECCENTRICITY_SQUARED * a * cos_b.powi(3));
            let moved = (next - latitude_rad).abs();
            latitude_rad = next;
            if moved < 1e-15 {
                break;
            }
            (sin_b, cos_b) = (b * next.sin()).atan2(a * next.cos()).sin_cos();
        }
        let (sin_lat, cos_lat) = latitude_rad.sin_cos();
        Some(Geodetic {
            latitude_rad,
            longitude_rad: ecef_m.y.atan2(ecef_m.x),
            // This form has no division by a cosine that vanishes at the poles.
            height_m: p * cos_lat + z * sin_lat - a * (1.0 - ECCENTRICITY_SQUARED * sin_lat * sin_lat).sqrt(),
        })
    }

    /// `enu_from_ecef` at this place: the rows are the directions east, north and up (along the ellipsoid's normal) in
    /// Earth-centred axes. Dimensionless.
    pub fn enu_from_ecef(&self) -> Rotation3<f64> {
        let (sin_lat, cos_lat) = self.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = self.longitude_rad.sin_cos();
        Rotation3::from_matrix_unchecked(Matrix3::new(
            -sin_lon,
            cos_lon,
            0.0,
            -sin_lat * cos_lon,
            -sin_lat * sin_lon,
            cos_lat,
            cos_lat * cos_lon,
            cos_lat * sin_lon,
            sin_lat,
        ))
    }

    /// The east, north, up coordinates (metres) of a place in the tangent plane at this one.
    pub fn enu_of(&self, place: &Geodetic) -> Vector3<f64> {
        self.enu_from_ecef() * (place.to_ecef() - self.to_ecef())
    }

    /// The place with these east, north, up coordinates (metres) in the tangent plane at this one. `None` as for
    /// [`from_ecef`](Self::from_ecef).
    pub fn at_enu(&self, enu_m: &Vector3<f64>) -> Option<Geodetic> {
        Geodetic::from_ecef(&(self.to_ecef() + self.enu_from_ecef().inverse() * enu_m))
    }

    /// N, the radius of curvature from east to west, metres, on the ellipsoid.
    pub fn prime_vertical_radius_m(&self) -> f64 {
        SEMI_MAJOR_M / self.curvature_root()
    }

    /// M, the radius of curvature from south to north, metres, on the ellipsoid.
    pub fn meridian_radius_m(&self) -> f64 {
        SEMI_MAJOR_M * (1.0 - ECCENTRICITY_SQUARED) / self.curvature_root().powi(3)
    }

    /// sqrt(M N), the radius of the sphere that fits best, metres.
    pub fn gaussian_radius_m(&self) -> f64 {
        (self.prime_vertical_radius_m() * self.meridian_radius_m()).sqrt()
    }

    fn curvature_root(&self) -> f64 {
        (1.0 - ECCENTRICITY_SQUARED * self.latitude_rad.sin().powi(2)).sqrt()
    }
}

/// How far the Earth has fallen below a tangent plane at `distance_m` from where it touches, metres: d^2 / 2R, with R a
/// radius of curvature, metres. Right to 2 % up to 1700 km.
pub fn tangent_departure_m(distance_m: f64, radius_m: f64) -> f64 {
    distance_m * distance_m / (2.0 * radius_m)
}
