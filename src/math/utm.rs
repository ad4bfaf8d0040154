//! The universal transverse Mercator grid, and its effect on directions and lengths.
//!
//! Owns the projection from geodetic places, meridian convergence and point scale. Must not know whether a map uses it.
//! Radians, metres, WGS 84. Source: Krueger 1912, series in the third flattening to the sixth order, as in Karney,
//! Transverse Mercator with an accuracy of a few nanometers, J. Geodesy 85, 2011, equations 7 to 35; zones as in NGA
//! TM 8358.2.

use std::f64::consts::PI;

use super::circular::wrapped;
use super::geodesy::{ECCENTRICITY_SQUARED, FLATTENING, Geodetic, SEMI_MAJOR_M};

/// The scale on a zone's central meridian.
pub const CENTRAL_SCALE: f64 = 0.9996;

/// A place on the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Utm {
    /// The zone, 1..=60.
    pub zone: u8,
    /// Whether the northing counts from the equator; if not, it counts from 10 000 km south of it.
    pub is_north: bool,
    /// Metres; 500 km on the central meridian.
    pub easting_m: f64,
    /// Metres.
    pub northing_m: f64,
    /// The bearing of the grid's north, clockwise from true north, radians. Seen on the grid, a true direction is rotated
    /// counter-clockwise by it: a rotation fitted from east-north coordinates to the grid has this angle.
    pub convergence_rad: f64,
    /// Metres on the grid per metre on the ellipsoid.
    pub scale: f64,
}

/// The zone of a place, with the exceptions of Norway and Svalbard. `None` beyond 84 degrees north or 80 south.
pub fn zone(place: &Geodetic) -> Option<u8> {
    let lat = place.latitude_rad.to_degrees();
    // A small tolerance: 6 degrees in radians and back is not always 6.
    let lon = wrapped(place.longitude_rad).to_degrees() + 1e-9;
    if !((-80.0..=84.0).contains(&lat) && lon.is_finite()) {
        return None;
    }
    let lon = if lon >= 180.0 { lon - 360.0 } else { lon };
    let regular = ((lon + 180.0) / 6.0).floor().clamp(0.0, 59.0) + 1.0;
    let zone = match (lat, lon) {
        (56.0..64.0, 3.0..12.0) => 32.0,
        (72.0.., 0.0..9.0) => 31.0,
        (72.0.., 9.0..21.0) => 33.0,
        (72.0.., 21.0..33.0) => 35.0,
        (72.0.., 33.0..42.0) => 37.0,
        _ => regular,
    };
    // Between 1 and 60.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    Some(zone as u8)
}

/// The grid coordinates of a place in its own zone, or in the requested one. Heights have no effect.
///
/// Right to nanometres within 30 degrees of longitude of the zone's central meridian, and `None` beyond; `None` for no
/// such zone, and without a zone where the place is in none.
pub fn utm(place: &Geodetic, in_zone: Option<u8>) -> Option<Utm> {
    let number = in_zone.or_else(|| zone(place))?;
    if !(1..=60).contains(&number) {
        return None;
    }
    let meridian_rad = (f64::from(number) * 6.0 - 183.0).to_radians();
    let lambda = wrapped(place.longitude_rad - meridian_rad);
    if !(lambda.abs() <= PI / 6.0 && place.latitude_rad.is_finite()) {
        return None;
    }
    let (x, y, convergence_rad, scale) = transverse_mercator(place.latitude_rad, lambda);
    let is_north = place.latitude_rad >= 0.0;
    Some(Utm {
        zone: number,
        is_north,
        easting_m: 500_000.0 + CENTRAL_SCALE * x,
        northing_m: if is_north { 0.0 } else { 1e7 } + CENTRAL_SCALE * y,
        convergence_rad,
        scale: CENTRAL_SCALE * scale,
    })
}

/// (x, y, convergence, scale) with scale 1 on the central meridian, `lambda` radians east of which the place is.
fn transverse_mercator(latitude_rad: f64, lambda: f64) -> (f64, f64, f64, f64) {
    let e = ECCENTRICITY_SQUARED.sqrt();
    let (sin_lat, cos_lat) = latitude_rad.sin_cos();
    let (sin_lon, cos_lon) = lambda.sin_cos();
    // Karney equations 7 to 9: the tangent of the conformal latitude.
    let tau = sin_lat / cos_lat;
    let sigma = (e * (e * sin_lat).atanh()).sinh();
    let tau_c = tau * sigma.hypot(1.0) - sigma * tau.hypot(1.0);
    // 10: spherical transverse Mercator.
    let radius = tau_c.hypot(cos_lon);
    let (xi0, eta0) = (tau_c.atan2(cos_lon), (sin_lon / radius).asinh());
    // 11, 23, 25: the series and its derivatives.
    let (mut xi, mut eta, mut p, mut q) = (xi0, eta0, 1.0, 0.0);
    let n = FLATTENING / (2.0 - FLATTENING);
    for (j, alpha) in (1..).zip(coefficients(n)) {
        let order = 2.0 * f64::from(j);
        let (sin, cos) = (order * xi0).sin_cos();
        let (sinh, cosh) = ((order * eta0).sinh(), (order * eta0).cosh());
        xi += alpha * sin * cosh;
        eta += alpha * cos * sinh;
        p += order * alpha * cos * cosh;
        q += order * alpha * sin * sinh;
    }
    // 14: the radius of the sphere with the meridian's length.
    let n2 = n * n;
    let rectifying_m = SEMI_MAJOR_M / (1.0 + n) * (1.0 + n2 / 4.0 + n2 * n2 / 64.0 + n2 * n2 * n2 / 256.0);
    let convergence = (tau_c / tau_c.hypot(1.0) * sin_lon).atan2(cos_lon) + q.atan2(p);
    let spherical = (1.0 - ECCENTRICITY_SQUARED * sin_lat * sin_lat).sqrt() * tau.hypot(1.0) / radius;
    let scale = spherical * rectifying_m / SEMI_MAJOR_M * p.hypot(q);
    (rectifying_m * eta, rectifying_m * xi, convergence, scale)
}

/// Karney equation 35: alpha 1 to 6 in powers of the third flattening.
fn coefficients(n: f64) -> [f64; 6] {
    let series = |terms: &[f64], first: i32| {
        let powers = (first..).zip(terms);
        powers.map(|(power, term)| term * n.powi(power)).sum::<f64>()
    };
    [
        series(
            &[
                1.0 / 2.0,
                -2.0 / 3.0,
                5.0 / 16.0,
                41.0 / 180.0,
                -127.0 / 288.0,
                7891.0 / 37800.0,
            ],
            1,
        ),
        series(
            &[
                13.0 / 48.0,
                -3.0 / 5.0,
                557.0 / 1440.0,
                281.0 / 630.0,
                -1_983_433.0 / 1_935_360.0,
            ],
            2,
        ),
        series(
            &[61.0 / 240.0, -103.0 / 140.0, 15061.0 / 26880.0, 167_603.0 / 181_440.0],
            3,
        ),
        series(&[49561.0 / 161_280.0, -179.0 / 168.0, 6_601_661.0 / 7_257_600.0], 4),
        series(&[34729.0 / 80640.0, -3_418_889.0 / 1_995_840.0], 5),
        series(&[212_378_941.0 / 319_334_400.0], 6),
    ]
}
