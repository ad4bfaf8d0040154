//! The ellipsoid, the grid and the geoid against published numbers. Only compiled for tests.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;
use proptest::prelude::*;

use super::geodesy::{ECCENTRICITY_SQUARED, Geodetic, SEMI_MINOR_M, tangent_departure_m};
use super::geoid::undulation_m;
use super::rotation::{det, orthogonality_error};
use super::utm::{Utm, utm, zone};

fn at(latitude_deg: f64, longitude_deg: f64) -> Geodetic {
    Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0).unwrap()
}

#[test]
fn the_ellipsoid_is_that_of_the_defining_report() {
    // NIMA TR8350.2, table 3.3: derived geometric constants.
    assert!((SEMI_MINOR_M - 6_356_752.314_2).abs() < 1e-4);
    assert!((ECCENTRICITY_SQUARED - 6.694_379_990_14e-3).abs() < 1e-14);
    // The polar radius of curvature, in the same table.
    assert!((at(90.0, 0.0).meridian_radius_m() - 6_399_593.625_8).abs() < 1e-4);
    assert!((at(90.0, 0.0).prime_vertical_radius_m() - 6_399_593.625_8).abs() < 1e-4);
    // A degree at 30 degrees: 110.852 km of latitude and 96.486 km of longitude (NGA length of a degree calculator).
    let place = at(30.0, 0.0);
    assert!((place.meridian_radius_m() * PI / 180.0 - 110_852.0).abs() < 1.0);
    let parallel = place.prime_vertical_radius_m() * place.latitude_rad.cos();
    assert!((parallel * PI / 180.0 - 96_486.0).abs() < 1.0);
}

#[test]
fn the_examples_of_cart_convert_are_met() {
    // GeographicLib, CartConvert(1): echo 33.3 44.4 6000 | CartConvert; the same with -l 33 44 20.
    let place = Geodetic::from_degrees(33.3, 44.4, 6000.0).unwrap();
    assert!((place.to_ecef() - Vector3::new(3_816_209.60, 3_737_108.55, 3_485_109.57)).norm() < 0.01);
    let origin = Geodetic::from_degrees(33.0, 44.0, 20.0).unwrap();
    let enu = origin.enu_of(&place);
    assert!((enu - Vector3::new(37_288.97, 33_374.29, 5_783.64)).norm() < 0.01);
    let back = origin.at_enu(&enu).unwrap();
    assert!((back.to_ecef() - place.to_ecef()).norm() < 1e-6);
}

#[test]
fn east_north_and_up_point_where_they_should() {
    // Where Greenwich meets the equator east is y, north is z, up is x.
    let r = at(0.0, 0.0).enu_from_ecef();
    assert_eq!(r * Vector3::y(), Vector3::x());
    assert_eq!(r * Vector3::z(), Vector3::y());
    assert_eq!(r * Vector3::x(), Vector3::z());
    // The axis turns by pi/2 + longitude about z, then by pi/2 - latitude about the new x.
    let place = at(47.4, 8.5);
    let about_z = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2 + place.longitude_rad);
    let about_x = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2 - place.latitude_rad);
    assert!(((about_z * about_x).inverse().matrix() - place.enu_from_ecef().matrix()).norm() < 1e-15);
}

#[test]
fn poles_and_nonsense_have_an_answer() {
    let pole = Geodetic::from_ecef(&Vector3::new(0.0, 0.0, -SEMI_MINOR_M - 10.0)).unwrap();
    assert!((pole.latitude_rad + FRAC_PI_2).abs() < 1e-15 && (pole.height_m - 10.0).abs() < 1e-8);
    assert_eq!(Geodetic::from_ecef(&Vector3::zeros()), None);
    assert_eq!(Geodetic::from_ecef(&Vector3::new(f64::NAN, 7e6, 0.0)), None);
    assert_eq!(Geodetic::from_degrees(90.1, 0.0, 0.0), None);
    assert_eq!(Geodetic::from_degrees(f64::NAN, 0.0, 0.0), None);
    assert_eq!(Geodetic::from_degrees(0.0, 0.0, f64::INFINITY), None);
}

#[test]
fn the_earth_falls_below_a_tangent_plane_by_the_square_of_the_distance() {
    // GEO05 and AXES09: 5 cm at 798 m, 7.8 cm at 1 km, 0.71 m at 3 km, 196 m at 50 km.
    for (distance, fall, digits) in [
        (798.0, 0.05, 1e-3),
        (1e3, 0.078, 1e-3),
        (3e3, 0.71, 1e-2),
        (5e4, 196.0, 1.0),
    ] {
        assert!((tangent_departure_m(distance, 6_371_000.0) - fall).abs() < digits);
    }
    // And as the ellipsoid does: the up coordinate of a place 20 km to the north.
    let origin = at(48.0, 11.0);
    let north = at(48.0 + (20_000.0 / origin.meridian_radius_m()).to_degrees(), 11.0);
    assert!((origin.enu_of(&north).z + tangent_departure_m(20_000.0, origin.meridian_radius_m())).abs() < 0.01);
}

#[test]
fn grid_coordinates_are_those_of_published_examples() {
    // Chris Veness, geodesy, test/utm-mgrs-tests.js (checked there against GeographicLib's GeoConvert).
    for (lat, lon, wanted_zone, easting, northing, digits) in [
        (0.0, 0.0, 31, 166_021.443_081, 0.0, 1e-6),
        (1.0, 1.0, 31, 277_438.263_521, 110_597.972_524, 1e-6),
        (-1.0, -1.0, 30, 722_561.736_479, 9_889_402.027_476, 1e-6),
        (48.8583, 2.2945, 31, 448_251.898, 5_411_943.794, 1e-3),
        (-33.857, 151.215, 56, 334_873.199, 6_252_266.092, 1e-3),
        (38.8977, -77.0365, 18, 323_394.296, 4_307_395.634, 1e-3),
        (60.39135, 5.3249, 32, 297_508.410, 6_700_645.296, 1e-3),
    ] {
        let found = utm(&at(lat, lon), None).unwrap();
        assert_eq!((found.zone, found.is_north), (wanted_zone, lat >= 0.0));
        assert!(
            (found.easting_m - easting).abs() < digits && (found.northing_m - northing).abs() < digits,
            "{found:?}"
        );
    }
    // The same, for Bergen: convergence in degrees, scale.
    let bergen = utm(&at(60.39135, 5.3249), None).unwrap();
    assert!((bergen.convergence_rad.to_degrees() + 3.196_281_440).abs() < 1e-9);
    assert!((bergen.scale - 1.000_102_473_211).abs() < 1e-12);
    // PROJ, test/gie/builtins.gie, utm: ellipsoid GRS80, whose flattening differs in the ninth digit; zone 30, so 5
    // degrees from its meridian.
    for (lat, easting, northing) in [
        (1.0, 1_057_002.405_5, 110_955.141_2),
        (-1.0, 1_057_002.405_5, 1e7 - 110_955.141_2),
    ] {
        let found = utm(&at(lat, 2.0), Some(30)).unwrap();
        assert!((found.easting_m - easting).abs() < 1e-3 && (found.northing_m - northing).abs() < 1e-3);
    }
}

#[test]
fn zones_have_their_exceptions() {
    for (lat, lon, wanted) in [
        (0.0, -180.0, 1),
        (0.0, 179.9, 60),
        (0.0, 180.0, 1),
        (45.0, 5.99, 31),
        (45.0, 6.0, 32),
        (60.0, 3.0, 32), // south-western Norway
        (60.0, 2.99, 31),
        (64.0, 5.0, 31),
        (78.0, 8.9, 31), // Svalbard
        (78.0, 9.0, 33),
        (78.0, 20.9, 33),
        (78.0, 21.0, 35),
        (78.0, 33.0, 37),
        (78.0, 42.0, 38),
    ] {
        assert_eq!(zone(&at(lat, lon)), Some(wanted), "{lat} {lon}");
    }
    assert_eq!(zone(&at(84.1, 0.0)), None);
    assert_eq!(zone(&at(-80.1, 0.0)), None);
    assert_eq!(utm(&at(0.0, 0.0), Some(61)), None);
    assert_eq!(utm(&at(0.0, 100.0), Some(31)), None);
}

/// What a step of this many metres from a place does to its grid coordinates, by differences.
fn stepped(place: &Geodetic, enu: Vector3<f64>) -> (f64, f64) {
    let from = utm(place, Some(32)).unwrap();
    let to = utm(&place.at_enu(&enu).unwrap(), Some(32)).unwrap();
    (to.easting_m - from.easting_m, to.northing_m - from.northing_m)
}

proptest! {
    #[test]
    fn ecef_and_back_is_the_same_place(
        lat in -90.0f64..=90.0, lon in -180.0f64..=180.0, height in -5e6f64..5e7,
    ) {
        let place = Geodetic::from_degrees(lat, lon, height).unwrap();
        let back = Geodetic::from_ecef(&place.to_ecef()).unwrap();
        prop_assert!((back.to_ecef() - place.to_ecef()).norm() < 1e-7);
        prop_assert!((back.latitude_rad - place.latitude_rad).abs() < 1e-13);
        prop_assert!((back.height_m - height).abs() < 1e-7);
        let r = place.enu_from_ecef();
        prop_assert!(orthogonality_error(r.matrix()) < 1e-15 && (det(r.matrix()) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn convergence_and_scale_are_what_the_grid_does_to_small_steps(lat in -79.0f64..83.0, lon in 0.0f64..18.0) {
        let place = at(lat, lon);
        let Utm { convergence_rad, scale, .. } = utm(&place, Some(32)).unwrap();
        // Seen on the grid, true directions are turned counter-clockwise by the convergence, and the grid is conformal.
        let (sin, cos) = convergence_rad.sin_cos();
        let (east, north) = (stepped(&place, Vector3::x() * 10.0), stepped(&place, Vector3::y() * 10.0));
        let wanted = [(east, (scale * cos, scale * sin)), (north, (-scale * sin, scale * cos))];
        for (found, wanted) in wanted {
            prop_assert!((found.0 / 10.0 - wanted.0).abs() < 1e-5 && (found.1 / 10.0 - wanted.1).abs() < 1e-5);
        }
        // GEO04: atan(tan(lon - lon0) sin lat), right to a minute of arc in a zone.
        let simple = ((lon - 9.0).to_radians().tan() * lat.to_radians().sin()).atan();
        prop_assert!((convergence_rad - simple).to_degrees().abs() < 1.0 / 60.0);
    }
}

#[test]
fn the_geoid_is_where_the_nga_has_it() {
    // NGA, EGM96 test data of program F477 (INPUT.DAT, OUTF477.DAT): degrees, metres.
    for (lat, lon, wanted) in [
        (38.628_155, 269.779_155, -31.628),
        (-14.621_217, 305.021_114, -2.969),
        (46.874_319, 102.448_729, -43.575),
        (-23.617_446, 133.874_712, 15.871),
        (38.625_473, 359.999_5, 50.066),
        (-0.466_744, 0.0023, 17.329),
    ] {
        let found = undulation_m(&at(lat, lon)).unwrap();
        assert!((found - wanted).abs() < 0.01, "{lat} {lon}: {found}");
    }
    let high = Geodetic {
        height_m: 500.0,
        ..at(38.628_155, -90.220_845)
    };
    assert!((undulation_m(&high).unwrap() + 31.628).abs() < 0.01);
    assert_eq!(
        undulation_m(&Geodetic {
            latitude_rad: f64::NAN,
            longitude_rad: 0.0,
            height_m: 0.0
        }),
        None
    );
    assert!(undulation_m(&at(90.0, 0.0)).unwrap().abs() < 30.0);
}
