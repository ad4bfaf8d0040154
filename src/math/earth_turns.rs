//! Errors in the rotation between the Earth's frame and a local east-north-up frame.
//!
//! Owns the wrong `earth_from_enu` of each error at a place, and which errors a rotation matches. Must not know frame
//! names, nor how large a difference matters. Radians; rotations are dimensionless.
//! Source of the correct rotation: [`Geodetic::enu_from_ecef`], its rows east, north, up.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::constants;
use super::geodesy::Geodetic;

/// An error in `earth_from_enu`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EarthTurn {
    /// No rotation at all: the local axes are those of the Earth.
    Lost,
    /// `enu_from_earth` in place of `earth_from_enu`.
    Transposed,
    /// North, east, down in place of east, north, up.
    Ned,
    /// The same, transposed.
    NedTransposed,
    /// `R1(pi/2 - latitude) R3(pi/2 + longitude)`, which is correct for axes, applied to vectors.
    Active,
    /// The same, transposed.
    ActiveTransposed,
    /// The geocentric latitude in place of the geodetic one: up to 0.19 degrees less.
    SphericalLatitude,
    /// Latitude and longitude exchanged.
    Swapped,
    /// The longitude with the opposite sign.
    LongitudeNegated,
    /// Degrees given to functions of radians.
    Degrees,
    /// `R3(longitude) R2(-latitude)`: its axes are up, east, north.
    UpEastNorth,
}

impl EarthTurn {
    /// Every error, the simplest first.
    pub const ALL: [Self; 11] = [
        Self::Lost,
        Self::Transposed,
        Self::Ned,
        Self::NedTransposed,
        Self::Active,
        Self::ActiveTransposed,
        Self::SphericalLatitude,
        Self::Swapped,
        Self::LongitudeNegated,
        Self::Degrees,
        Self::UpEastNorth,
    ];

    /// The stable word of it, as used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Lost => "rotation-lost",
            Self::Transposed => "transposed",
            Self::Ned => "ned-enu",
            Self::NedTransposed => "ned-transposed",
            Self::Active => "active-rotations",
            Self::ActiveTransposed => "active-rotations-transposed",
            Self::SphericalLatitude => "spherical-latitude",
            Self::Swapped => "lat-lon-swapped",
            Self::LongitudeNegated => "longitude-negated",
            Self::Degrees => "degrees",
            Self::UpEastNorth => "up-east-north",
        }
    }

    /// The error, in a few words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Lost => "rotation is the identity (ECEF axes)",
            Self::Transposed => "the matrix is transposed (ENU from ECEF)",
            Self::Ned => "the axes are north, east, down",
            Self::NedTransposed => "the matrix is transposed (NED from ECEF)",
            Self::Active => "axis rotations are applied to vectors",
            Self::ActiveTransposed => "axis rotations are applied to vectors, and transposed",
            Self::SphericalLatitude => "the latitude is geocentric, not geodetic",
            Self::Swapped => "latitude and longitude are swapped",
            Self::LongitudeNegated => "the longitude has the wrong sign",
            Self::Degrees => "degrees are used as radians",
            Self::UpEastNorth => "the axes are up, east, north",
        }
    }

    /// The wrong `earth_from_enu` of the error at a place.
    pub fn at(self, place: &Geodetic) -> Rotation3<f64> {
        let (latitude, longitude) = (place.latitude_rad, place.longitude_rad);
        let right = |latitude_rad, longitude_rad| {
            let other = Geodetic {
                latitude_rad,
                longitude_rad,
                ..*place
            };
            other.enu_from_ecef().inverse()
        };
        let earth_from_enu = right(latitude, longitude);
        match self {
            Self::Lost => Rotation3::identity(),
            Self::Transposed => earth_from_enu.inverse(),
            Self::Ned => earth_from_enu * constants::ned_enu(),
            Self::NedTransposed => (earth_from_enu * constants::ned_enu()).inverse(),
            Self::Active => active(latitude, longitude).inverse(),
            Self::ActiveTransposed => active(latitude, longitude),
            Self::SphericalLatitude => {
                let ecef = place.to_ecef();
                right(ecef.z.atan2(ecef.x.hypot(ecef.y)), longitude)
            }
            Self::Swapped => right(longitude, latitude),
            Self::LongitudeNegated => right(latitude, -longitude),
            Self::Degrees => right(latitude.to_degrees(), longitude.to_degrees()),
            Self::UpEastNorth => {
                let axes = Matrix3::from_columns(&[Vector3::z(), Vector3::x(), Vector3::y()]);
                earth_from_enu * Rotation3::from_matrix_unchecked(axes)
            }
        }
    }
}

/// The angle of a rotation, by the chord from the identity: the arc cosine of a trace that rounding takes above 3 is NaN.
fn angle(rotation: &Rotation3<f64>) -> f64 {
    let chord = (rotation.matrix() - Matrix3::identity()).norm() / 8.0_f64.sqrt();
    2.0 * chord.min(1.0).asin()
}

/// The product of the textbooks' angles as rotations of vectors.
fn active(latitude: f64, longitude: f64) -> Rotation3<f64> {
    let about_x = Rotation3::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2 - latitude);
    about_x * Rotation3::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2 + longitude)
}

/// A rotation compared with the correct one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationError {
    /// The angle between its z axis and up, 0..=pi.
    pub tilt_rad: f64,
    /// The angle of its x axis from east towards north, as seen from above; of use where the tilt is small.
    pub yaw_rad: f64,
}

/// The attitude of an `earth_from_map` in east, north, up at a place.
pub fn beside(place: &Geodetic, earth_from_map: &Rotation3<f64>) -> RotationError {
    let enu_from_map = place.enu_from_ecef() * earth_from_map;
    let (x, z) = (enu_from_map * Vector3::x(), enu_from_map * Vector3::z());
    RotationError {
        tilt_rad: z.x.hypot(z.y).atan2(z.z),
        yaw_rad: x.y.atan2(x.x),
    }
}

/// The errors that an `earth_from_map` shows to within an angle, radians. Errors that are the same at this place are all
/// given. Where none matches as a whole, those whose z axis matches: the map may be rotated about up as well.
pub fn shown(place: &Geodetic, earth_from_map: &Rotation3<f64>, within_rad: f64) -> Vec<EarthTurn> {
    let meets = |of: fn(&Rotation3<f64>) -> f64| {
        let errors = EarthTurn::ALL.into_iter();
        let met = errors.filter(move |error| of(&(error.at(place).inverse() * earth_from_map)) <= within_rad);
        met.collect::<Vec<_>>()
    };
    let whole = meets(angle);
    if !whole.is_empty() {
        return whole;
    }
    let mut turned = meets(|difference| {
        let z = difference * Vector3::z();
        z.x.hypot(z.y).atan2(z.z)
    });
    // For the others the z axis decides nothing: it is that of other frames.
    turned.retain(|error| matches!(error, EarthTurn::SphericalLatitude | EarthTurn::Ned));
    turned
}
