//! Lags of closed-form signals.
#![allow(clippy::unwrap_used, clippy::float_cmp, clippy::indexing_slicing)]

use super::{Options, lag};
use std::f64::consts::TAU;

/// Its spectrum: frequencies in Hz with amplitudes.
const LINES: [(f64, f64); 10] = [
    (0.013, 0.8),
    (0.029, 0.9),
    (0.047, 0.7),
    (0.083, 0.9),
    (0.11, 1.0),
    (0.167, 0.8),
    (0.237, 0.8),
    (0.311, 0.7),
    (0.391, 0.9),
    (0.613, 0.5),
];

/// A signal that is smooth, known at every time, and does not repeat within minutes.
fn signal(t_s: f64) -> f64 {
    let line = |(hz, size): &(f64, f64)| size * (TAU * hz * t_s + 70.0 * hz).sin();
    LINES.iter().map(line).sum()
}

/// Its samples at trembling times of about `hz`, in a clock that is `late_s` behind.
fn sampled(hz: f64, seconds: f64, late_s: f64) -> Vec<(f64, f64)> {
    let mut samples = Vec::new();
    let mut t_s = 0.003;
    for i in 0.. {
        if t_s > seconds {
            break;
        }
        samples.push((1.7e9 + t_s + late_s, signal(t_s)));
        t_s += (1.0 + 0.3 * (f64::from(i) * 1.7).sin()) / hz;
    }
    samples
}

#[test]
fn a_known_lag_is_found_between_the_steps_of_the_grid_at_any_pair_of_rates() {
    for (a_hz, b_hz) in [(100.0, 100.0), (100.0, 10.0), (10.0, 100.0), (20.0, 13.0)] {
        for late_s in [0.0, 0.1, -0.237, 1.003, 0.025] {
            let (a, b) = (sampled(a_hz, 60.0, 0.0), sampled(b_hz, 60.0, late_s));
            let found = lag(&[a], &[b], &Options::fine()).unwrap();
            let peak = found.whole;
            assert!(
                (peak.lag_s - late_s).abs() < 2e-3,
                "{a_hz} {b_hz} {late_s}: {}",
                peak.lag_s
            );
            assert!(peak.rho > 0.99 && peak.interior && peak.z > 4.5);
            assert!(found.parts.len() == 3 && found.spread_s().unwrap() < 5e-3);
            assert!(peak.sigma_s.unwrap() < 0.02);
        }
    }
}

#[test]
fn smoothing_moves_no_peak() {
    for smooth_s in [0.05, 0.1, 0.17, 0.4, 1.2] {
        let options = Options {
            smooth_s,
            ..Options::fine()
        };
        let found = lag(&[sampled(50.0, 60.0, 0.0)], &[sampled(10.0, 60.0, 0.31)], &options).unwrap();
        assert!(
            (found.whole.lag_s - 0.31).abs() < 2e-3,
            "{smooth_s}: {}",
            found.whole.lag_s
        );
    }
}

#[test]
fn the_bandwidth_is_that_of_the_signal_and_noise_has_no_part_in_it() {
    // Root mean square of the frequencies, weighted by power.
    let (mut weighted, mut power) = (0.0, 0.0);
    for (hz, size) in LINES {
        weighted += hz * hz * size * size;
        power += size * size;
    }
    let wanted = f64::sqrt(weighted / power);
    let clean = sampled(50.0, 120.0, 0.0);
    let mut rng = crate::math::tests_support::Rng::new(31);
    let noisy: Vec<_> = clean.iter().map(|(t, v)| (*t, v + 2.0 * rng.normal())).collect();
    let found = lag(&[clean], &[noisy], &Options::fine()).unwrap().whole;
    assert!(found.rho < 0.95 && (found.bandwidth_hz.unwrap() / wanted - 1.0).abs() < 0.15);
}

#[test]
fn leap_seconds_are_found_on_the_wide_range() {
    for late_s in [18.0, -37.0, 0.4] {
        let found = lag(
            &[sampled(10.0, 200.0, 0.0)],
            &[sampled(2.0, 200.0, late_s)],
            &Options::wide(),
        )
        .unwrap();
        assert!((found.whole.lag_s - late_s).abs() < 0.02, "{}", found.whole.lag_s);
        assert!(found.whole.runner_up.unwrap() < found.whole.rho - 0.15 && found.spread_s().unwrap() < 0.05);
    }
    // Beyond the range the peak is no interior one, or is weak.
    let found = lag(
        &[sampled(10.0, 200.0, 0.0)],
        &[sampled(10.0, 200.0, 4.0)],
        &Options::fine(),
    )
    .unwrap();
    assert!(!found.whole.interior || found.whole.rho < 0.8);
}

#[test]
fn a_circle_is_its_own_runner_up_and_a_reversed_sign_is_a_trough() {
    let laps = |late_s: f64, sign: f64| -> Vec<(f64, f64)> {
        let times = (0..2400).map(|i| f64::from(i) * 0.1);
        times.map(|t| (t, sign * (TAU * (t - late_s) / 18.0).sin())).collect()
    };
    let found = lag(&[laps(0.0, 1.0)], &[laps(2.0, 1.0)], &Options::wide())
        .unwrap()
        .whole;
    assert!(found.rho - found.runner_up.unwrap() < 0.01);
    let reversed: Vec<_> = sampled(10.0, 60.0, 0.4).iter().map(|(t, v)| (*t, -v)).collect();
    let found = lag(&[sampled(50.0, 60.0, 0.0)], &[reversed], &Options::fine())
        .unwrap()
        .whole;
    assert!(found.trough.0 < -0.99 && (found.trough.1 - 0.4).abs() < 1e-9);
}

#[test]
fn holes_are_not_drawn_across() {
    // Noon to night: the second half is another hour, and between them nothing is known.
    let (mut a, mut b) = (sampled(20.0, 100.0, 0.0), sampled(10.0, 100.0, 0.2));
    a.retain(|(t, _)| !(1.7e9 + 30.0..1.7e9 + 50.0).contains(t));
    b.retain(|(t, _)| !(1.7e9 + 60.0..1.7e9 + 75.0).contains(t));
    // A line across the holes would be wrong by the size of the signal; a value that is not finite is a hole, too.
    b[40].1 = f64::NAN;
    let found = lag(&[a.clone()], &[b.clone()], &Options::fine()).unwrap().whole;
    assert!((found.lag_s - 0.2).abs() < 2e-3 && found.rho > 0.99);
    assert!(found.pairs > 1180 && found.pairs < 1310, "{}", found.pairs);
    // The same as stretches of their own, in any order.
    let cut = |s: &[(f64, f64)], at: f64| -> Vec<Vec<(f64, f64)>> {
        let (early, late) = s.iter().copied().partition(|(t, _)| *t < 1.7e9 + at);
        vec![late, early]
    };
    let apart = lag(&cut(&a, 40.0), &cut(&b, 70.0), &Options::fine()).unwrap().whole;
    assert!((apart.lag_s - found.lag_s).abs() < 2e-3 && apart.pairs.abs_diff(found.pairs) <= 5);
}

#[test]
fn signals_that_never_meet_or_never_change_have_no_lag() {
    let a = sampled(20.0, 30.0, 0.0);
    let of_1970: Vec<_> = a.iter().map(|(t, v)| (t - 1.7e9, *v)).collect();
    assert_eq!(lag(&[&a], &[&of_1970], &Options::fine()), None);
    let constant: Vec<_> = a.iter().map(|(t, _)| (*t, 9.81)).collect();
    assert_eq!(lag(&[&a], &[&constant], &Options::fine()), None);
    assert_eq!(lag::<Vec<_>, &Vec<_>>(&[], &[&a], &Options::fine()), None);
    assert_eq!(
        lag(&[&a], &[vec![(f64::NAN, 1.0), (1.0, f64::INFINITY)]], &Options::fine()),
        None
    );
    // Two samples far apart fill no memory.
    assert_eq!(lag(&[&a], &[vec![(0.0, 1.0), (1e18, 2.0)]], &Options::fine()), None);
    let options = Options {
        grid_s: 0.0,
        ..Options::fine()
    };
    assert_eq!(lag(&[&a], &[&a], &options), None);
}
