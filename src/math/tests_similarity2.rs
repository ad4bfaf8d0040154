//! Similarities of the plane against Umeyama's own formulas. Only compiled for tests.
#![allow(clippy::unwrap_used, clippy::float_cmp)]
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use nalgebra::{Matrix2, Vector2};

use super::circular::difference;
use super::similarity2::{Sense, Similarity2, deviations, fit_similarities, path_length, spread};
use super::tests_support::Rng;

fn v(x: f64, y: f64) -> Vector2<f64> {
    Vector2::new(x, y)
}

/// Umeyama 1991 word for word, by singular values: (R, c, t) of equations 40 to 42, and the mean squared error.
fn umeyama(source: &[Vector2<f64>], target: &[Vector2<f64>], sense: Sense) -> (Matrix2<f64>, f64, Vector2<f64>, f64) {
    let n = source.len() as f64;
    let (ma, mb) = (
        source.iter().sum::<Vector2<f64>>() / n,
        target.iter().sum::<Vector2<f64>>() / n,
    );
    let sigma: Matrix2<f64> = source
        .iter()
        .zip(target)
        .map(|(a, b)| (b - mb) * (a - ma).transpose() / n)
        .sum();
    let var_a: f64 = source.iter().map(|a| (a - ma).norm_squared() / n).sum();
    let var_b: f64 = target.iter().map(|b| (b - mb).norm_squared() / n).sum();
    let svd = sigma.svd(true, true);
    let (u, vt) = (svd.u.unwrap(), svd.v_t.unwrap());
    let wanted = if sense == Sense::Proper { 1.0 } else { -1.0 };
    let s = Matrix2::from_diagonal(&v(1.0, wanted * (u * vt).determinant().signum()));
    let trace = (Matrix2::from_diagonal(&svd.singular_values) * s).trace();
    let r = u * s * vt;
    let c = trace / var_a;
    (r, c, mb - c * r * ma, var_b - trace * trace / var_a)
}

#[test]
fn umeyamas_own_example_has_his_answer() {
    // Section III of the paper: a triangle and its mirror image, where a plain SVD would answer with a reflection.
    let source = [v(0.0, 0.0), v(1.0, 0.0), v(0.0, 2.0)];
    let target = [v(0.0, 0.0), v(-1.0, 0.0), v(0.0, 2.0)];
    let fits = fit_similarities(&source, &target).unwrap();
    let r = fits.proper.linear();
    assert!((r - Matrix2::new(0.832, 0.555, -0.555, 0.832)).norm() < 1e-3);
    assert!((fits.proper.scale - 0.721).abs() < 1e-3);
    assert!((fits.proper.translation_m - v(-0.8, 0.4)).norm() < 1e-3);
    // (10/9) * (1 - c^2), with c^2 = 13/25.
    assert!((fits.proper.sse_m2 / 3.0 - 8.0 / 15.0).abs() < 1e-12);
    assert!(fits.improper.rms_m < 1e-7 && (fits.improper.axis_rad().unwrap().abs() - FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn both_fits_are_umeyamas() {
    let mut rng = Rng::new(11);
    for _ in 0..200 {
        let cloud =
            |rng: &mut Rng| -> Vec<Vector2<f64>> { (0..8).map(|_| v(rng.normal(), rng.normal()) * 9.0).collect() };
        let (source, target) = (cloud(&mut rng), cloud(&mut rng));
        let fits = fit_similarities(&source, &target).unwrap();
        for fit in [fits.proper, fits.improper] {
            let (r, c, t, mse) = umeyama(&source, &target, fit.sense);
            assert!((fit.linear() - r).norm() < 1e-9 && (fit.scale - c).abs() < 1e-9);
            assert!((fit.translation_m - t).norm() < 1e-9 && (fit.rms_m.powi(2) - mse).abs() < 1e-9);
        }
    }
}

#[test]
fn a_known_map_is_found_at_the_coordinates_of_a_grid() {
    let mut rng = Rng::new(12);
    for sense in [Sense::Proper, Sense::Improper] {
        let truth = Similarity2 {
            sense,
            angle_rad: 2.5,
            scale: 0.9996,
            translation_m: v(444_140.0, 3_684_706.0),
            sse_m2: 0.0,
            rms_m: 0.0,
        };
        let source: Vec<_> = (0..100)
            .map(|_| v(rng.range(-90.0, 90.0), rng.range(-9.0, 9.0)))
            .collect();
        let target: Vec<_> = source.iter().map(|p| truth.apply(p)).collect();
        let fits = fit_similarities(&source, &target).unwrap();
        let found = if sense == Sense::Proper {
            fits.proper
        } else {
            fits.improper
        };
        assert!(difference(found.angle_rad, 2.5).abs() < 1e-9 && (found.scale - 0.9996).abs() < 1e-9);
        assert!((found.translation_m - truth.translation_m).norm() < 1e-6 && found.rms_m < 1e-4);
        assert_eq!(fits.log_ratio() > 0.0, sense == Sense::Improper);
    }
}

#[test]
fn the_axis_of_the_mirror_names_the_slip() {
    let source = [v(0.0, 0.0), v(3.0, 0.0), v(3.0, 1.0), v(7.0, 2.0)];
    let axis = |map: fn(&Vector2<f64>) -> Vector2<f64>| {
        let target: Vec<_> = source.iter().map(map).collect();
        fit_similarities(&source, &target).unwrap().improper.axis_rad().unwrap()
    };
    assert!((axis(|p| v(p.y, p.x)) - FRAC_PI_4).abs() < 1e-12);
    assert!(axis(|p| v(p.x, -p.y)).abs() < 1e-12);
    assert!((axis(|p| v(-p.x, p.y)).abs() - FRAC_PI_2).abs() < 1e-12);
    let fits = fit_similarities(&source, &source).unwrap();
    assert_eq!(fits.proper.axis_rad(), None);
}

#[test]
fn a_straight_track_cannot_tell_a_turn_from_a_mirror() {
    let source: Vec<_> = (0..50).map(|i| v(f64::from(i), 0.0)).collect();
    let target: Vec<_> = (0..50).map(|i| v(0.3 * f64::from(i), 0.4 * f64::from(i % 7))).collect();
    let fits = fit_similarities(&source, &target).unwrap();
    assert!(fits.log_ratio().abs() < 1e-9);
    assert!(spread(&source).unwrap().minor_sd_m < 1e-9);
}

#[test]
fn what_cannot_be_fitted_has_no_fit() {
    let line = [v(0.0, 0.0), v(1.0, 0.0), v(2.0, 0.0)];
    assert!(fit_similarities(&line, &[]).is_none() && fit_similarities(&[], &[]).is_none());
    assert!(fit_similarities(&[v(1.0, 1.0); 3], &line).is_none());
    assert!(fit_similarities(&line, &[v(0.0, f64::NAN); 3]).is_none());
    // A target that stands still: everything maps onto it.
    let fits = fit_similarities(&line, &[v(1.0, 1.0); 3]).unwrap();
    assert!(fits.proper.scale == 0.0 && fits.proper.sse_m2 == 0.0 && fits.log_ratio() == 0.0);
}

#[test]
fn the_spread_of_an_ellipse_is_its_half_axes_over_root_two() {
    let turn = Similarity2 {
        sense: Sense::Proper,
        angle_rad: 0.6,
        scale: 1.0,
        translation_m: v(5e5, 5e6),
        sse_m2: 0.0,
        rms_m: 0.0,
    };
    let points: Vec<_> = (0..1000)
        .map(|i| 2.0 * PI * f64::from(i) / 1000.0)
        .map(|a| turn.apply(&v(4.0 * a.cos(), 1.5 * a.sin())))
        .collect();
    let s = spread(&points).unwrap();
    assert!((s.major_sd_m - 4.0 / 2f64.sqrt()).abs() < 1e-6 && (s.minor_sd_m - 1.5 / 2f64.sqrt()).abs() < 1e-6);
    assert!((s.major_axis_rad - 0.6).abs() < 1e-6);
    assert!((path_length(&[v(0.0, 0.0), v(3.0, 4.0), v(3.0, 3.0)]) - 6.0).abs() < 1e-12);
    assert!(spread(&[]).is_none() && path_length(&[]) == 0.0);
}

#[test]
fn the_jackknife_finds_the_deviation_of_white_noise_and_of_drift() {
    // With noise of sigma in each coordinate the turn and the relative scale have sigma / sqrt(sum |a - mean|^2).
    let source: Vec<_> = (0..800)
        .map(|i| f64::from(i) * 0.02)
        .map(|t| v(100.0 * t.cos(), 60.0 * t.sin()))
        .collect();
    let mean = source.iter().sum::<Vector2<f64>>() / 800.0;
    let squares: f64 = source.iter().map(|a| (a - mean).norm_squared()).sum();
    let mut rng = Rng::new(7);
    let mut noisy = |sigma: f64| -> Vec<Vector2<f64>> {
        let noise = |a: &Vector2<f64>| a + sigma * v(rng.normal(), rng.normal());
        source.iter().map(noise).collect()
    };
    let (mut angle, mut scale) = (0.0, 0.0);
    for _ in 0..50 {
        let (a, s) = deviations(&source, &noisy(0.3), 8).unwrap();
        angle += a * a / 50.0;
        scale += s * s / 50.0;
    }
    let expected = 0.3 / squares.sqrt();
    assert!((angle.sqrt() / expected - 1.0).abs() < 0.2, "{angle} {expected}");
    assert!((scale.sqrt() / expected - 1.0).abs() < 0.2, "{scale} {expected}");
    // A second half that is turned by a hundredth of a radian: the blocks do not agree.
    let turned = |(i, a): (usize, &Vector2<f64>)| {
        if i < 400 {
            *a
        } else {
            v(a.x - 0.01 * a.y, a.y + 0.01 * a.x)
        }
    };
    let drifting: Vec<_> = source.iter().enumerate().map(turned).collect();
    assert!(deviations(&source, &drifting, 8).unwrap().0 > 1e-3);
    assert!(deviations(&source, &source, 2).is_none() && deviations(&source[..9], &source[..9], 8).is_none());
}
