//! The magnetic declination: the angle from true north to magnetic north.
//!
//! Owns one number of a place, from the crate `world_magnetic_model` (coefficients in the program, no file). Source: NOAA and BGS, The US/UK World
//! Magnetic Model for 2025-2030.

use uom::si::angle::degree;
use uom::si::f32::{Angle, Length};
use uom::si::length::meter;
use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::Date;
use world_magnetic_model::uom;

/// The declination at a place at sea level at the beginning of a year from 2020 on, degrees: positive where magnetic north is east of true north.
/// It moves by up to about 0.2 degrees a year. `None` for places that are no places, and near the magnetic poles, where it means nothing.
pub fn declination_deg(latitude_deg: f64, longitude_deg: f64, year: i32) -> Option<f64> {
    if !(latitude_deg.abs() <= 85.0 && longitude_deg.abs() <= 180.0) {
        return None;
    }
    let date = Date::from_ordinal_date(year, 1).ok()?;
    #[allow(clippy::cast_possible_truncation)] // the model itself counts so
    let angle = |value: f64| Angle::new::<degree>(value as f32);
    let field = GeomagneticField::new(
        Length::new::<meter>(0.0),
        angle(latitude_deg),
        angle(longitude_deg),
        date,
    )
    .ok()?;
    let declination = f64::from(field.declination().get::<degree>());
    declination.is_finite().then_some(declination)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test values that come with the model: WMM2025, 2025.0, height 0.
    #[test]
    fn the_published_test_values_come_out() {
        for (latitude, longitude, expected) in [(80.0, 0.0, 1.28), (0.0, 120.0, -0.16), (-80.0, -120.0, 68.78)] {
            let declination = declination_deg(latitude, longitude, 2025).unwrap();
            assert!(
                (declination - expected).abs() < 0.03,
                "{latitude} {longitude}: {declination}"
            );
        }
    }

    #[test]
    fn what_is_no_place_has_none() {
        assert_eq!(declination_deg(91.0, 0.0, 2025), None);
        assert_eq!(declination_deg(0.0, f64::NAN, 2025), None);
        assert_eq!(declination_deg(0.0, 0.0, 1900), None);
    }
}
