//! Up, found in simulated forces. Only compiled for tests.
#![allow(clippy::unwrap_used, clippy::float_cmp, clippy::indexing_slicing)]

use super::gravity::{Gravity, Row, WorldForce, gravity};
use super::readings::Reading;
use super::rotation::from_rpy;
use super::tests_support::Rng;
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::PI;

const UP: Vector3<f64> = Vector3::new(0.0, 0.0, 9.81);

/// Rows at 20 Hz of a body whose attitude follows `attitude` (roll, pitch, yaw of a time) under a true force.
fn rows(seconds: u32, attitude: impl Fn(f64) -> UnitQuaternion<f64>, spell: impl Fn(&Row) -> Row) -> Vec<Row> {
    let rows = (0..=20 * seconds).map(|i| f64::from(i) / 20.0).map(|t_s| {
        let q = attitude(t_s);
        let slots = [q.i, q.j, q.k, q.w];
        spell(&Row {
            t_s,
            slots,
            force_m_s2: (q.inverse() * UP).into(),
        })
    });
    rows.collect()
}

fn rolling(t_s: f64) -> UnitQuaternion<f64> {
    from_rpy(0.5 * t_s.sin(), 0.3 * (0.7 * t_s).sin(), 0.4 * t_s)
}

fn best(found: &Gravity) -> Reading {
    let nearest = |m: &WorldForce| m.median_from_up_rad.min(m.median_from_down_rad);
    found
        .means
        .iter()
        .min_by(|a, b| nearest(a).total_cmp(&nearest(b)))
        .unwrap()
        .reading
}

#[test]
fn each_spelling_points_up_under_its_own_reading_alone() {
    type RowChange = fn(&Row) -> Row;
    let spellings: [(Reading, RowChange); 4] = [
        (Reading::Xyzw, |r| *r),
        (Reading::Conjugate, |r| {
            let [x, y, z, w] = r.slots;
            Row {
                slots: [-x, -y, -z, w],
                ..*r
            }
        }),
        (Reading::Wxyz, |r| {
            let [x, y, z, w] = r.slots;
            Row {
                slots: [w, x, y, z],
                ..*r
            }
        }),
        (Reading::WxyzConjugate, |r| {
            let [x, y, z, w] = r.slots;
            Row {
                slots: [w, -x, -y, -z],
                ..*r
            }
        }),
    ];
    for (reading, spell) in spellings {
        let found = gravity(&[rows(60, rolling, spell)], 1.0, 5f64.to_radians()).unwrap();
        assert_eq!(best(&found), reading);
        let right = found.mean(reading).unwrap();
        assert!((right.mean_m_s2 - UP).norm() < 1e-9 && right.concentration > 1.0 - 1e-9);
        assert!(right.from_up_rad < 1e-9 && (right.median_from_down_rad - PI).abs() < 1e-9);
        assert!((found.norm_m_s2 - 9.81).abs() < 1e-9 && found.rows == 1201);
        for other in found.means.iter().filter(|m| m.reading != reading) {
            assert!(
                other.concentration < 0.95 && other.median_from_up_rad > 0.2,
                "{other:?}"
            );
        }
    }
}

#[test]
fn north_east_down_points_down_and_says_how_surely() {
    // A forward-right-down body in north-east-down reads -9.81 on its z at rest: -z of its world as well.
    let frd = |t_s: f64| from_rpy(0.02 * t_s.sin(), 0.01, 0.3 * t_s);
    let down = |r: &Row| Row {
        force_m_s2: r.force_m_s2.map(|v| -v),
        ..*r
    };
    let found = gravity(&[rows(20, frd, down)], 1.0, 5f64.to_radians()).unwrap();
    let as_published = found.mean(Reading::Xyzw).unwrap();
    assert!((as_published.mean_m_s2 + UP).norm() < 1e-9 && (as_published.from_up_rad - PI).abs() < 1e-9);
    // A level platform cannot distinguish the conjugate: both point down, and no time was spent tilted.
    let conjugate = found.mean(Reading::Conjugate).unwrap();
    assert!(conjugate.median_from_down_rad < 0.05 && found.tilted_s == 0.0);
}

#[test]
fn turns_average_out_but_a_short_arc_tilts() {
    // Steady circles: 1 m/s^2 towards the centre tilts every moment by atan(1 / 9.81), and no full turn.
    let lean = |r: &Row| {
        let force = Vector3::from(r.force_m_s2) + Vector3::y();
        Row {
            force_m_s2: force.into(),
            ..*r
        }
    };
    let circle = |t_s: f64| from_rpy(0.0, 0.0, 2.0 * PI * t_s / 10.0);
    let whole = gravity(&[rows(50, circle, lean)], 1.0, 0.1).unwrap();
    let arc = gravity(&[rows(1, circle, lean)], 1.0, 0.1).unwrap();
    let tilt = (1.0f64 / 9.81).atan();
    assert!(whole.mean(Reading::Xyzw).unwrap().from_up_rad < 1e-3);
    assert!((whole.mean(Reading::Xyzw).unwrap().concentration - tilt.cos()).abs() < 1e-3);
    assert!((arc.mean(Reading::Xyzw).unwrap().from_up_rad - tilt).abs() < 0.01);
}

#[test]
fn a_wrong_orientation_has_no_concentration() {
    let mut rng = Rng::new(4);
    let rows: Vec<Row> = (0..4000)
        .map(|i| {
            let q = rng.rotation();
            Row {
                t_s: f64::from(i) * 0.05,
                slots: [q.i, q.j, q.k, q.w],
                force_m_s2: UP.into(),
            }
        })
        .collect();
    let found = gravity(&[rows], 1.0, 0.1).unwrap();
    assert!(found.means.iter().all(|m| m.concentration < 0.06));
}

#[test]
fn windows_stay_within_stretches_and_rows_that_say_nothing_are_left_out() {
    let all = rows(10, rolling, |r| *r);
    let found = gravity(&[&all[..100], &all[150..]], 2.0, 0.1).unwrap();
    assert_eq!((found.rows, found.windows), (151, 5));
    assert!((found.covered_s - (4.95 + 2.5)).abs() < 1e-9);
    assert!(found.tilted_s > 2.0 && found.tilted_s < found.covered_s);
    let broken = [
        Row {
            slots: [0.0; 4],
            ..all[0]
        },
        Row {
            force_m_s2: [0.0; 3],
            ..all[0]
        },
        Row {
            force_m_s2: [f64::NAN; 3],
            ..all[0]
        },
        Row {
            t_s: f64::NAN,
            ..all[0]
        },
    ];
    assert_eq!(gravity(&[broken], 1.0, 0.1), None);
    assert_eq!(gravity::<Vec<Row>>(&[], 1.0, 0.1), None);
}
