//! Turns against closed forms: constant and swinging rotation about known axes.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

use std::f64::consts::TAU;

use nalgebra::{UnitQuaternion, Vector3};

use super::{Options, Row, Score, Turns, turns};
use crate::math::axis_maps::AxisMap;
use crate::math::constants::AxisTurn;
use crate::math::readings::Reading;
use crate::math::rotation::from_rpy;

fn slots(q: &UnitQuaternion<f64>) -> [f64; 4] {
    [q.i, q.j, q.k, q.w]
}

/// Rotation about one axis, which needs no integrator: the angle and the rate at a time.
fn about(axis: Vector3<f64>, hz: f64, seconds: f64, motion: impl Fn(f64) -> (f64, f64)) -> Vec<Row> {
    let axis = axis.normalize();
    let rows = (0..=((seconds * hz) as u32)).map(|i| f64::from(i) / hz).map(|t_s| {
        let (angle, rate) = motion(t_s);
        Row {
            t_s: 1.7e9 + t_s,
            slots: slots(&UnitQuaternion::from_scaled_axis(axis * angle)),
            rate_rad_s: (axis * rate).into(),
        }
    });
    rows.collect()
}

/// Swings of 0.5 rad at 0.4 Hz: the orientation late by `late_s`.
fn swinging(axis: Vector3<f64>, late_s: f64) -> Vec<Row> {
    let w = TAU * 0.4;
    about(axis, 100.0, 10.0, |t| {
        (0.5 * (w * (t - late_s)).sin(), 0.5 * w * (w * t).cos())
    })
}

/// A body that swings about all three axes, and whose rates follow from Euler's equations.
fn tumbling() -> Vec<Row> {
    let angles = [(0.3, 0.9), (0.25, 1.3), (0.6, 0.5)];
    let rows = (0..2000).map(|i| f64::from(i) / 100.0).map(|t_s| {
        let [roll, pitch, yaw] = angles.map(|(a, w): (f64, f64)| a * (w * t_s).sin());
        let [dr, dp, dy] = angles.map(|(a, w)| a * w * (w * t_s).cos());
        let ((sr, cr), (sp, cp)) = (roll.sin_cos(), pitch.sin_cos());
        Row {
            t_s,
            slots: slots(&from_rpy(roll, pitch, yaw)),
            rate_rad_s: [dr - dy * sp, dp * cr + dy * sr * cp, dy * cr * cp - dp * sr],
        }
    });
    rows.collect()
}

fn of(rows: &[Row], window_s: f64) -> Turns {
    turns(&[rows], &Options::new(window_s)).unwrap()
}

fn score(found: &Turns, reading: Reading) -> Score {
    *found.score(reading).unwrap()
}

#[test]
fn a_steady_turn_is_followed_exactly_and_its_conjugate_is_opposite() {
    let rows = about(Vector3::new(1.0, 2.0, 2.0), 50.0, 4.0, |t| (0.6 * t, 0.6));
    let found = of(&rows, 0.25);
    // The stamps are those of 2023, in which a double resolves 0.24 microseconds.
    assert!(score(&found, Reading::Xyzw).residual < 1e-5);
    assert!((score(&found, Reading::Conjugate).residual - 2.0).abs() < 1e-5);
    assert!((found.rotation_rad - 0.6 * found.covered_s).abs() < 1e-6);
    assert!(found.covered_s > 3.4 && found.covered_s <= 3.7);
    assert!((found.axis_rms_rad_s[1] - 0.4).abs() < 1e-5 && (found.step_s - 0.02).abs() < 1e-6);
    // A constant has no meaningful R2, and the caller can see it.
    assert!(found.varying_rms_rad < 1e-5);
    assert!((score(&found, Reading::Xyzw).gain - 1.0).abs() < 1e-5);
}

#[test]
fn each_spelling_is_its_own_readings_and_no_others() {
    for (spelled, truth) in [
        (Reading::Xyzw, Reading::Xyzw),
        (Reading::Conjugate, Reading::Conjugate),
        (Reading::Wxyz, Reading::Wxyz),
        (Reading::WxyzConjugate, Reading::WxyzConjugate),
    ] {
        let rows: Vec<Row> = tumbling()
            .into_iter()
            .map(|row| {
                let [x, y, z, w] = row.slots;
                let slots = match spelled {
                    Reading::Xyzw => [x, y, z, w],
                    Reading::Conjugate => [-x, -y, -z, w],
                    Reading::Wxyz => [w, x, y, z],
                    Reading::WxyzConjugate => [w, -x, -y, -z],
                };
                // Neither the sign nor the norm of a quaternion says anything.
                Row {
                    slots: slots.map(|v| -1.01 * v),
                    ..row
                }
            })
            .collect();
        let found = of(&rows, 0.5);
        for s in found.scores {
            if s.reading == truth {
                assert!(s.residual < 1e-3 && s.r2 > 0.999_99 && s.lag_s == 0.0, "{s:?}");
                assert!(s.axis_correlation.iter().all(|r| r.unwrap() > 0.99));
            } else {
                assert!(s.residual > 0.7 && s.r2 < 0.3, "{spelled:?} {s:?}");
            }
        }
    }
}

#[test]
fn a_turn_of_the_world_is_not_seen() {
    let world = from_rpy(1.0, 0.4, -2.0);
    let rows: Vec<Row> = tumbling()
        .into_iter()
        .map(|row| {
            let q = world * Reading::Xyzw.world_from_body(row.slots).unwrap();
            Row {
                slots: slots(&q),
                ..row
            }
        })
        .collect();
    assert!(score(&of(&rows, 0.5), Reading::Xyzw).residual < 1e-3);
}

#[test]
fn a_late_orientation_has_a_positive_lag() {
    let rows = swinging(Vector3::new(0.2, 0.1, 1.0), 0.04);
    let s = score(&of(&rows, 0.5), Reading::Xyzw);
    assert!((s.lag_s - 0.04).abs() < 1e-9 && s.residual < 1e-3);
    // A phase of 2 pi 0.4 Hz 0.04 s between two swings of equal size: 2 sin(phase / 2).
    assert!((s.residual_without_lag - 0.1005).abs() < 0.01);
}

#[test]
fn a_bias_falls_out_of_r2_and_is_told() {
    let mut rows = swinging(Vector3::z(), 0.0);
    for row in &mut rows {
        row.rate_rad_s = [0.02, -0.01, row.rate_rad_s[2] + 0.03];
    }
    let bias = Vector3::new(0.02, -0.01, 0.03);
    let kept = Options {
        max_bias_rad_s: 0.0,
        ..Options::new(0.5)
    };
    let s = score(&turns(&[&rows], &kept).unwrap(), Reading::Xyzw);
    assert!(s.r2 > 0.999 && s.residual > 0.02);
    assert!((s.bias_rad_s - bias).norm() < 2e-3);
    let found = of(&rows, 0.5);
    let s = score(&found, Reading::Xyzw);
    assert!((found.bias_rad_s - bias).norm() < 2e-3 && s.bias_rad_s.norm() < 1e-6 && s.residual < 0.02);
}

#[test]
fn degrees_per_second_show_in_the_gain_although_their_turns_wrap() {
    let mut rows = tumbling();
    for row in &mut rows {
        row.rate_rad_s = row.rate_rad_s.map(f64::to_degrees);
    }
    let found = of(&rows, 0.5);
    let s = score(&found, Reading::Xyzw);
    assert!((s.gain * 57.295_78 - 1.0).abs() < 0.01 && s.gain_correlation > 0.999);
    assert!(found.scores.iter().all(|s| s.residual > 0.9));
}

#[test]
fn axes_of_the_gyro_are_found_when_it_turns_about_all() {
    for map in AxisMap::all() {
        let mut rows = tumbling();
        for row in &mut rows {
            row.rate_rad_s = (map.matrix() * Vector3::from(row.rate_rad_s)).into();
        }
        let search = score(&of(&rows, 0.25), Reading::Xyzw).axis_search().unwrap();
        let best = search.best().unwrap();
        assert_eq!(best.map, map.inverse());
        // A mirrored gyro turns the other way while it is integrated: of second order, and small in short windows.
        assert!(search.residual(&best) < 0.02 && search.margin().unwrap() > 10.0);
    }
    // About z alone, the conjugate, the gyro in forward-right-down and the negated gyro are one.
    let mut rows = swinging(Vector3::z(), 0.0);
    for row in &mut rows {
        row.rate_rad_s[2] *= -1.0;
    }
    let found = of(&rows, 0.25);
    assert!(score(&found, Reading::Conjugate).residual < 1e-3);
    let class = score(&found, Reading::Xyzw).axis_search().unwrap().class(3.0);
    assert!(class.contains(&AxisMap::from_turn(AxisTurn::FluFrd)) && class.len() == 8);
    assert_eq!(score(&found, Reading::Xyzw).axis_correlation[0], None);
}

#[test]
fn nothing_is_integrated_across_what_is_missing() {
    let whole = tumbling();
    let jump = from_rpy(0.0, 0.0, 2.0);
    let turned = |row: &Row| Row {
        slots: slots(&(jump * Reading::Xyzw.world_from_body(row.slots).unwrap())),
        ..*row
    };
    // The orientation jumps at 10 s: behind a hole, a row of zeros, a step back, the end of a stretch.
    let hole: Vec<Row> = whole[..1000]
        .iter()
        .copied()
        .chain(whole[1010..].iter().map(turned))
        .collect();
    let mut zeros = whole[..1000].to_vec();
    zeros.push(Row {
        slots: [0.0; 4],
        ..whole[1000]
    });
    zeros.extend(whole[1001..].iter().map(turned));
    let back: Vec<Row> = whole.iter().copied().chain(whole[..1500].iter().map(turned)).collect();
    for rows in [&hole, &zeros, &back] {
        let s = score(&of(rows, 0.5), Reading::Xyzw);
        assert!(s.residual < 1e-3, "{}", s.residual);
    }
    let second: Vec<Row> = whole[1000..].iter().map(turned).collect();
    let found = turns(&[whole[..1000].to_vec(), second], &Options::new(0.5)).unwrap();
    assert!(score(&found, Reading::Xyzw).residual < 1e-3);
    // Repeated rows change nothing but rounding.
    let doubled: Vec<Row> = whole.iter().flat_map(|r| [*r, *r]).collect();
    assert_eq!(of(&doubled, 0.5), of(&whole, 0.5));
}

#[test]
fn overlapping_windows_count_their_rotation_once() {
    let rows = tumbling();
    let apart = of(&rows, 0.5);
    let overlapping = turns(
        &[rows],
        &Options {
            hop_s: 0.1,
            ..Options::new(0.5)
        },
    )
    .unwrap();
    assert!(overlapping.windows > 4 * apart.windows);
    assert!((overlapping.rotation_rad / apart.rotation_rad - 1.0).abs() < 0.05);
    assert!((overlapping.covered_s / apart.covered_s - 1.0).abs() < 0.05);
}

#[test]
fn too_little_gives_nothing() {
    let rows = swinging(Vector3::z(), 0.0);
    assert_eq!(turns::<Vec<Row>>(&[], &Options::new(0.5)), None);
    assert_eq!(turns(&[&rows[..60]], &Options::new(0.5)), None);
    assert_eq!(
        turns(
            &[vec![
                Row {
                    slots: [0.0; 4],
                    ..rows[0]
                };
                9
            ]],
            &Options::new(0.5)
        ),
        None
    );
    let still = about(Vector3::z(), 50.0, 5.0, |_| (0.0, 0.0));
    let found = of(&still, 0.5);
    assert!(found.active == 0 && found.rotation_rad == 0.0 && score(&found, Reading::Xyzw).residual.is_nan());
    assert_eq!(score(&found, Reading::Xyzw).axis_search(), None);
    // A gyro at 1 Hz: a window is one step.
    let slow: Vec<Row> = rows.iter().step_by(100).copied().collect();
    assert_eq!(of(&slow, 0.25).windows, 8);
}
