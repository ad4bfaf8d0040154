//! Fits of drifting tracks against arcs, whose drift is known in closed form. Only compiled for tests.
#![allow(clippy::unwrap_used)]

use nalgebra::Vector2;

use super::drifting::fit_drifting;
use super::similarity2::{fit_similarities, spread};
use super::tests_support::Rng;

/// Points of a way of constant speed and turn, ten a second.
fn arc(rate_rad_s: f64, speed_m_s: f64, lasts_s: u32) -> (Vec<f64>, Vec<Vector2<f64>>) {
    let times: Vec<f64> = (0..=10 * lasts_s).map(|i| f64::from(i) / 10.0).collect();
    let radius = speed_m_s / rate_rad_s;
    let place = |t_s: &f64| {
        let angle = rate_rad_s * t_s;
        Vector2::new(radius * angle.sin(), radius * (1.0 - angle.cos()))
    };
    let places = times.iter().map(place).collect();
    (times, places)
}

#[test]
fn an_arc_is_a_straight_that_drifts() {
    for rate in [0.001, -0.003, 0.0035] {
        let (times, drifted) = arc(rate, 5.0, 150);
        let straight: Vec<_> = times.iter().map(|t| Vector2::new(0.6 * t, -4.0 * t)).collect();
        let without = fit_similarities(&drifted, &straight).unwrap().proper;
        // The residual of a small drift is a parabola: the distance times the angle over the root of 720.
        assert!((without.rms_m / (straight[1500].norm() * rate.abs() * 150.0 / 720f64.sqrt()) - 1.0).abs() < 0.05);
        let fits = fit_drifting(&times, &drifted, &straight, 0.004).unwrap();
        assert!(
            fits.proper.rms_m < 0.002 * without.rms_m,
            "{rate} {}",
            fits.proper.rms_m
        );
        assert!(
            fits.improper.rms_m < 0.002 * without.rms_m,
            "{rate} {}",
            fits.improper.rms_m
        );
        // No more than half of it is taken off where no more is allowed.
        let half = fit_drifting(&times, &drifted, &straight, rate.abs() / 2.0).unwrap();
        assert!((half.proper.rms_m / without.rms_m - 0.5).abs() < 0.05);
    }
}

#[test]
fn a_mirror_is_told_in_spite_of_the_drift() {
    let mut rng = Rng::new(61);
    for _ in 0..20 {
        let bends: Vec<f64> = (0..4).map(|_| rng.normal()).collect();
        let drift = rng.range(-0.003, 0.003);
        let (mut truth, mut odometry) = (vec![Vector2::zeros()], vec![Vector2::zeros()]);
        let times: Vec<f64> = (0..=1000).map(|i| f64::from(i) / 10.0).collect();
        for t in &times[1..] {
            let heading: f64 = bends
                .iter()
                .enumerate()
                .map(|(i, b)| b * (0.05 * (i + 1) as f64 * t).sin() * 0.3)
                .sum();
            let step = |heading: f64| Vector2::new(heading.cos(), heading.sin()) * 0.4;
            truth.push(truth[truth.len() - 1] + step(heading));
            odometry.push(odometry[odometry.len() - 1] + step(heading + drift * (t - 0.05)));
        }
        let mirrored: Vec<_> = odometry.iter().map(|p| Vector2::new(p.y, p.x)).collect();
        let wide = spread(&truth).unwrap().minor_sd_m;
        for (track, is_mirrored) in [(&odometry, false), (&mirrored, true)] {
            let fits = fit_drifting(&times, track, &truth, 0.0035).unwrap();
            let (right, other) = if is_mirrored {
                (fits.improper, fits.proper)
            } else {
                (fits.proper, fits.improper)
            };
            assert!(
                right.rms_m < 0.02 && other.rms_m > 0.1 * wide,
                "{} {} {wide}",
                right.rms_m,
                other.rms_m
            );
        }
    }
}

#[test]
fn what_cannot_be_fitted_has_no_fit() {
    let (times, places) = arc(0.01, 1.0, 3);
    assert_eq!(fit_drifting(&times[1..], &places, &places, 0.1), None);
    assert_eq!(fit_drifting(&times, &places, &places[1..], 0.1), None);
    assert_eq!(fit_drifting(&[], &[], &[], 0.1), None);
    let still = vec![Vector2::new(1.0, 1.0); places.len()];
    assert_eq!(fit_drifting(&times, &still, &places, 0.1), None);
}
