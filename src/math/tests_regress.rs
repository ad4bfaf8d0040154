//! Slopes against the certified values of NIST. Only compiled for tests.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use super::regress::{LineForm, bound_that_reaches_one, fit, fit_huber, median_slope};
use super::tests_support::Rng;

/// NIST StRD, Norris: linear regression, 36 observations, certified values.
const NORRIS: [(f64, f64); 36] = [
    (0.2, 0.1),
    (337.4, 338.8),
    (118.2, 118.1),
    (884.6, 888.0),
    (10.1, 9.2),
    (226.5, 228.1),
    (666.3, 668.5),
    (996.3, 998.5),
    (448.6, 449.1),
    (777.0, 778.9),
    (558.2, 559.2),
    (0.4, 0.3),
    (0.6, 0.1),
    (775.5, 778.1),
    (666.9, 668.8),
    (338.0, 339.3),
    (447.5, 448.9),
    (11.6, 10.8),
    (556.0, 557.7),
    (228.1, 228.3),
    (995.8, 998.0),
    (887.6, 888.8),
    (120.2, 119.6),
    (0.3, 0.3),
    (0.3, 0.6),
    (556.8, 557.6),
    (339.1, 339.3),
    (887.2, 888.0),
    (999.0, 998.5),
    (779.0, 778.9),
    (11.1, 10.2),
    (118.3, 117.6),
    (229.2, 228.9),
    (669.1, 668.4),
    (448.9, 449.2),
    (0.5, 0.2),
];

#[test]
fn the_certified_values_of_nist_are_met() {
    let line = fit(&NORRIS, LineForm::Anywhere, 36.0).unwrap();
    assert!((line.slope - 1.002_116_818_020_45).abs() < 1e-12);
    assert!((line.intercept + 0.262_323_073_774_029).abs() < 1e-10);
    assert!((line.standard_error.unwrap() - 0.429_796_848_199_937e-3).abs() < 1e-12);
    assert!((line.residual_sd * (36.0f64 / 34.0).sqrt() - 0.884_796_396_144_373).abs() < 1e-10);
    assert!((line.t.unwrap() - 2331.606).abs() < 1e-2);
    // NIST StRD, NoInt1: x = 60..70, y = 130..140, no intercept.
    let noint1: Vec<_> = (0..11).map(|i| (f64::from(60 + i), f64::from(130 + i))).collect();
    let line = fit(&noint1, LineForm::Origin, 11.0).unwrap();
    assert!((line.slope - 2.074_380_165_289_26).abs() < 1e-12 && line.intercept == 0.0);
    assert!((line.standard_error.unwrap() - 0.165_289_256_198_347e-1).abs() < 1e-12);
}

#[test]
fn fewer_independent_pairs_widen_the_error() {
    let whole = fit(&NORRIS, LineForm::Anywhere, 36.0).unwrap().standard_error.unwrap();
    let fewer = fit(&NORRIS, LineForm::Anywhere, 10.5).unwrap().standard_error.unwrap();
    assert!((fewer / whole - 2.0).abs() < 1e-12);
    let too_few = fit(&NORRIS, LineForm::Anywhere, 2.0).unwrap();
    assert_eq!((too_few.standard_error, too_few.t), (None, None));
}

#[test]
fn outliers_move_the_robust_line_little() {
    let mut rng = Rng::new(51);
    for through in [LineForm::Origin, LineForm::Anywhere] {
        let offset = if through == LineForm::Origin { 0.0 } else { 5.0 };
        let pairs: Vec<_> = (0..300)
            .map(|i| {
                let x = rng.range(-3.0, 3.0);
                let wild = if i % 10 < 2 { rng.range(0.0, 60.0) } else { 0.0 };
                (x, offset - 1.2 * x + 0.1 * rng.normal() + wild)
            })
            .collect();
        let robust = fit_huber(&pairs, through, 300.0).unwrap();
        let plain = fit(&pairs, through, 300.0).unwrap();
        assert!((robust.slope + 1.2).abs() < 0.03, "{}", robust.slope);
        assert!((plain.slope + 1.2).abs() > 2.0 * (robust.slope + 1.2).abs());
        assert!(robust.lightened >= 60 && robust.lightened < 130 && robust.residual_sd < 0.25);
        if through == LineForm::Anywhere {
            assert!((median_slope(&pairs).unwrap() + 1.2).abs() < 0.3);
        }
    }
}

#[test]
fn the_errors_that_are_told_are_those_that_are_seen() {
    let mut rng = Rng::new(52);
    let (mut seen, mut stated) = ([0.0; 2], [0.0; 2]);
    for _ in 0..400 {
        let pairs: Vec<_> = (0..60).map(|_| rng.normal()).map(|x| (x, 0.9 * x)).collect();
        let pairs: Vec<_> = pairs.into_iter().map(|(x, y)| (x, y + 0.5 * rng.normal())).collect();
        let lines = [
            fit(&pairs, LineForm::Anywhere, 60.0),
            fit_huber(&pairs, LineForm::Anywhere, 60.0),
        ];
        for (i, line) in lines.into_iter().enumerate() {
            let line = line.unwrap();
            *seen.get_mut(i).unwrap() += (line.slope - 0.9).powi(2);
            *stated.get_mut(i).unwrap() += line.standard_error.unwrap().powi(2);
        }
    }
    for (seen, stated) in seen.iter().zip(stated) {
        assert!((seen / stated - 1.0).abs() < 0.25, "{seen} {stated}");
    }
}

#[test]
fn what_has_no_slope_has_none() {
    for fit in [fit, fit_huber] {
        assert_eq!(fit(&[], LineForm::Origin, 9.0), None);
        assert_eq!(fit(&[(0.0, 1.0), (0.0, 2.0)], LineForm::Origin, 9.0), None);
        assert_eq!(fit(&[(2.0, 1.0), (2.0, 2.0)], LineForm::Anywhere, 9.0), None);
        assert_eq!(fit(&[(2.0, 1.0), (f64::NAN, 2.0)], LineForm::Anywhere, 9.0), None);
        // A perfect line has no error, and no t.
        let line = fit(&[(1.0, 2.0), (2.0, 4.0), (3.0, 6.0)], LineForm::Origin, 3.0).unwrap();
        assert_eq!((line.slope, line.standard_error, line.t), (2.0, Some(0.0), None));
    }
    assert_eq!(median_slope(&[(1.0, 1.0), (1.0, 2.0)]), None);
    assert_eq!(median_slope(&[(1.0, 1.0), (3.0, 2.0)]), Some(0.5));
}

#[test]
fn noise_of_x_is_told_from_another_scale() {
    let mut rng = Rng::new(53);
    // x is measured with noise of the same deviation as itself: the slope is half of what it is, and the correlation 1 / sqrt(2).
    for (scale, expected) in [(1.0, Some(1.0)), (0.6, None), (2.4, None)] {
        let pairs: Vec<_> = (0..20_000)
            .map(|_| (rng.normal(), rng.normal()))
            .map(|(truth, noise)| (truth + noise, scale * truth))
            .collect();
        let slope = fit(&pairs, LineForm::Anywhere, 20_000.0).unwrap().slope;
        assert!((slope - 0.5 * scale).abs() < 0.02, "{slope}");
        let bound = bound_that_reaches_one(slope, 0.5f64.sqrt(), 0.05);
        match expected {
            Some(truth) => assert!((bound.unwrap() - truth).abs() < 0.04, "{bound:?}"),
            None => assert_eq!(bound, None, "{scale}"),
        }
    }
    assert_eq!(bound_that_reaches_one(-0.9, 0.9, 0.05), None);
}
