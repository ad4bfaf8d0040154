//! Errors of `earth_from_enu` against closed forms. Only compiled for tests.
#![allow(clippy::unwrap_used)]

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::earth_turns::{EarthTurn, beside, shown};
use super::geodesy::Geodetic;

fn at(latitude_deg: f64, longitude_deg: f64) -> Geodetic {
    Geodetic::from_degrees(latitude_deg, longitude_deg, 100.0).unwrap()
}

const WITHIN: f64 = 1e-6;

#[test]
fn every_error_is_found_where_it_is_made() {
    let place = at(48.0, 11.0);
    for error in EarthTurn::ALL {
        assert_eq!(shown(&place, &error.at(&place), WITHIN), [error], "{}", error.word());
    }
    let right = place.enu_from_ecef().inverse();
    assert!(shown(&place, &right, WITHIN).is_empty());
}

/// Rounding makes the trace of a zero difference exceed 3 at some places.
#[test]
fn errors_are_found_by_themselves_all_over_the_earth() {
    for (latitude, longitude) in
        (-8..=8).flat_map(|a| (-17..=17).map(move |b| (f64::from(a) * 10.3, f64::from(b) * 10.1)))
    {
        let place = at(latitude, longitude);
        for error in EarthTurn::ALL {
            let rotation = UnitQuaternion::from_rotation_matrix(&error.at(&place)).to_rotation_matrix();
            let found = shown(&place, &rotation, WITHIN);
            assert!(found.contains(&error), "{} at {latitude}, {longitude}", error.word());
        }
    }
}

#[test]
fn rounding_hides_no_error_anywhere() {
    for latitude in (-85..=85).step_by(5) {
        for longitude in (-175..=175).step_by(5) {
            let place = at(f64::from(latitude) + 0.376, f64::from(longitude) + 0.55);
            for error in EarthTurn::ALL {
                let seen = shown(&place, &error.at(&place), WITHIN);
                assert!(seen.contains(&error), "{} at {latitude}, {longitude}", error.word());
            }
        }
    }
}

#[test]
fn matrices_are_those_of_the_textbooks() {
    let place = at(30.0, 60.0);
    let (h, s) = (0.5, 3.0_f64.sqrt() / 2.0);
    // Rows east, north, up at latitude 30, longitude 60.
    let enu_from_earth = Matrix3::new(-s, h, 0.0, -h * h, -h * s, s, s * h, s * s, h);
    let close = |a: &Rotation3<f64>, b: &Matrix3<f64>| (a.matrix() - b).norm() < 1e-15;
    assert!(close(&EarthTurn::Transposed.at(&place), &enu_from_earth));
    // Rows north, east, down.
    let ned_from_earth = Matrix3::new(-h * h, -h * s, s, -s, h, 0.0, -s * h, -s * s, -h);
    assert!(close(&EarthTurn::Ned.at(&place), &ned_from_earth.transpose()));
    assert!(close(&EarthTurn::NedTransposed.at(&place), &ned_from_earth));
    // R3(longitude) R2(-latitude) has the columns up, east, north.
    let about = |axis, angle: f64| Rotation3::from_axis_angle(&axis, angle);
    let product = about(Vector3::z_axis(), place.longitude_rad) * about(Vector3::y_axis(), -place.latitude_rad);
    assert!(close(&EarthTurn::UpEastNorth.at(&place), product.matrix()));
}

#[test]
fn the_latitude_of_a_sphere_tilts_by_the_angle_of_the_vertical() {
    // Torge, Geodesy: the geocentric latitude is smaller by up to 11.5 minutes of arc, at 45 degrees.
    let sphere = |latitude| {
        let place = Geodetic::from_degrees(latitude, 9.0, 0.0).unwrap();
        beside(&place, &EarthTurn::SphericalLatitude.at(&place))
            .tilt_rad
            .to_degrees()
            * 60.0
    };
    assert!((sphere(45.0) - 11.544).abs() < 0.002);
    assert!(sphere(0.0) < 1e-9);
}

proptest! {
    #[test]
    fn a_level_map_is_seen_level_however_it_is_turned(
        latitude in -89.0..89.0_f64, longitude in -180.0..180.0_f64, yaw in -3.1..3.1_f64
    ) {
        let place = at(latitude, longitude);
        let turned = place.enu_from_ecef().inverse() * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
        let seen = beside(&place, &turned);
        prop_assert!(seen.tilt_rad < 1e-9 && (seen.yaw_rad - yaw).abs() < 1e-9);
    }

    #[test]
    fn a_tilt_is_measured_in_any_direction(
        latitude in -89.0..89.0_f64, tilt in 0.0..3.1_f64, towards in -3.1..3.1_f64
    ) {
        let place = at(latitude, 11.0);
        let axis = nalgebra::Unit::new_normalize(Vector3::new(towards.cos(), towards.sin(), 0.0));
        let tilted = place.enu_from_ecef().inverse() * Rotation3::from_axis_angle(&axis, tilt);
        prop_assert!((beside(&place, &tilted).tilt_rad - tilt).abs() < 1e-9);
    }
}
