//! Rows to runs without a hole, runs to windows.
//!
//! Owns the cleaning, the integral of the gyro at any time, and the turns of the orientation over each window.

use nalgebra::{UnitQuaternion, Vector3};

use super::{Options, Row, median};
use crate::math::readings::Reading;

/// Rows without a hole, and the integral of their rate from the first row on.
pub(super) struct Run {
    times_s: Vec<f64>,
    orientations: Vec<[UnitQuaternion<f64>; 4]>,
    turned: Vec<UnitQuaternion<f64>>,
    plain: Vec<Vector3<f64>>,
}

/// A piece of one run, with its turn under each reading, in the order of [`Reading::ALL`].
pub(super) struct Window {
    pub(super) run: usize,
    /// Its first row and its last.
    rows: (usize, usize),
    start_s: f64,
    end_s: f64,
    pub(super) turns: [Vector3<f64>; 4],
}

impl Window {
    pub(super) fn length_s(&self) -> f64 {
        self.end_s - self.start_s
    }
}

/// A row that can be used.
struct ValidRow {
    t_s: f64,
    orientations: [UnitQuaternion<f64>; 4],
    rate: Vector3<f64>,
}

impl ValidRow {
    fn new(row: &Row) -> Option<ValidRow> {
        let rate = Vector3::from(row.rate_rad_s);
        let first = Reading::Xyzw.world_from_body(row.slots)?;
        let finite = row.t_s.is_finite() && rate.iter().all(|w| w.is_finite());
        finite.then(|| ValidRow {
            t_s: row.t_s,
            // The norm is that of the slots, so no reading fails where the first did not.
            orientations: Reading::ALL.map(|r| r.world_from_body(row.slots).unwrap_or(first)),
            rate,
        })
    }
}

/// The rows cut at holes, steps back and rows that are not sound, and the median step in seconds (0 without steps).
pub(super) fn runs<S: AsRef<[Row]>>(stretches: &[S], options: &Options) -> (Vec<Run>, f64) {
    let mut steps: Vec<f64> = Vec::new();
    for stretch in stretches {
        let rows = stretch.as_ref();
        let pairs = rows.iter().zip(rows.iter().skip(1));
        steps.extend(pairs.map(|(a, b)| b.t_s - a.t_s).filter(|dt| *dt > 0.0));
    }
    let step_s = median(&steps).unwrap_or(0.0);
    let mut runs = Vec::new();
    for stretch in stretches {
        let mut current: Vec<ValidRow> = Vec::new();
        for row in stretch.as_ref() {
            let Some(sound) = ValidRow::new(row) else {
                runs.extend(Run::new(std::mem::take(&mut current)));
                continue;
            };
            match current.last().map(|last| sound.t_s - last.t_s) {
                Some(0.0) => continue,
                Some(dt) if dt < 0.0 || dt > options.hole_factor * step_s => {
                    runs.extend(Run::new(std::mem::take(&mut current)));
                }
                _ => {}
            }
            current.push(sound);
        }
        runs.extend(Run::new(current));
    }
    (runs, step_s)
}

impl Run {
    /// `None` for fewer than two rows.
    fn new(rows: Vec<ValidRow>) -> Option<Run> {
        let first = rows.first()?;
        if rows.len() < 2 {
            return None;
        }
        let (mut turn, mut sum) = (UnitQuaternion::identity(), Vector3::zeros());
        let (mut turned, mut plain) = (vec![turn], vec![sum]);
        let mut before = (first.t_s, first.rate);
        for row in rows.iter().skip(1) {
            let step = (before.1 + row.rate) * (0.5 * (row.t_s - before.0));
            turn *= UnitQuaternion::from_scaled_axis(step);
            turn.renormalize_fast();
            sum += step;
            turned.push(turn);
            plain.push(sum);
            before = (row.t_s, row.rate);
        }
        Some(Run {
            times_s: rows.iter().map(|r| r.t_s).collect(),
            orientations: rows.into_iter().map(|r| r.orientations).collect(),
            turned,
            plain,
        })
    }

    /// Both integrals at a time, sought from the row `near` on; the rate is constant within a step. A time outside the
    /// run is moved to its end: rounding may put one there. `None` never, for a run has rows.
    fn at(&self, t_s: f64, near: usize) -> Option<Edge> {
        let mut k = near;
        while self.times_s.get(k + 1).is_some_and(|t| *t <= t_s) {
            k += 1;
        }
        while k > 0 && self.times_s.get(k).is_some_and(|t| *t > t_s) {
            k -= 1;
        }
        let (t, turn, plain) = (*self.times_s.get(k)?, *self.turned.get(k)?, *self.plain.get(k)?);
        let next = self.times_s.get(k + 1).zip(self.plain.get(k + 1));
        let Some((next_t, next_plain)) = next.filter(|_| t_s > t) else {
            return Some(Edge { row: k, turn, plain });
        };
        let step = (next_plain - plain) * ((t_s - t) / (next_t - t));
        Some(Edge {
            row: k,
            turn: turn * UnitQuaternion::from_scaled_axis(step),
            plain: plain + step,
        })
    }
}

/// The integrals of a run's gyro at one time, and the row before it.
#[derive(Clone, Copy)]
struct Edge {
    row: usize,
    turn: UnitQuaternion<f64>,
    plain: Vector3<f64>,
}

/// The gyro in one window: its turn as a rotation vector in the body's axes at the start, and the plain
/// integral of its rate, radians.
#[derive(Clone, Copy)]
pub(super) struct WindowTurn {
    pub(super) turn: Vector3<f64>,
    pub(super) plain: Vector3<f64>,
}

impl WindowTurn {
    /// Without the effect of a bias, radians: good for turns of less than a radian or so.
    pub(super) fn take_off(&mut self, bias_rad: &Vector3<f64>) {
        self.turn -= bias_rad;
        self.plain -= bias_rad;
    }
}

/// The gyro's turns over every `nth` window, when the orientation is late by `lag_s`.
pub(super) fn turned(runs: &[Run], windows: &[Window], nth: usize, lag_s: f64) -> Vec<WindowTurn> {
    // The end of a window is mostly the start of the next.
    let mut last: Option<((usize, usize), Edge)> = None;
    let turned = windows.iter().step_by(nth).map(|w| {
        let run = runs.get(w.run)?;
        let same = last.filter(|(place, _)| *place == (w.run, w.rows.0));
        let from = same.map_or_else(|| run.at(w.start_s - lag_s, w.rows.0), |(_, edge)| Some(edge))?;
        let to = run.at(w.end_s - lag_s, from.row)?;
        last = Some(((w.run, w.rows.1), to));
        Some(WindowTurn {
            turn: (from.turn.inverse() * to.turn).scaled_axis(),
            plain: to.plain - from.plain,
        })
    });
    let nothing = WindowTurn {
        turn: Vector3::zeros(),
        plain: Vector3::zeros(),
    };
    // Every window names a run, and every run has rows.
    turned.map(|turned| turned.unwrap_or(nothing)).collect()
}

/// Every window of every run, leaving room for the lags on both sides.
pub(super) fn windows(runs: &[Run], options: &Options, step_s: f64) -> Vec<Window> {
    let mut windows = Vec::new();
    // A third of a step of grace: with stamps that jitter, a window of ten steps shall not become one of eleven, nor
    // one of twelve and a half (0.25 s at 50 Hz) now twelve, now thirteen.
    let grace_s = step_s / 3.0;
    let (length, hop) = (options.window_s - grace_s, options.hop_s - grace_s);
    for (index, run) in runs.iter().enumerate() {
        let (Some(first), Some(last)) = (run.times_s.first(), run.times_s.last()) else {
            continue;
        };
        let from = |t_s: f64| run.times_s.partition_point(|t| *t < t_s);
        let mut start = from(first + options.max_lag_s);
        while let Some(&start_s) = run.times_s.get(start) {
            let end = from(start_s + length).max(start + 1);
            let Some(&end_s) = run.times_s.get(end).filter(|t| **t + options.max_lag_s <= *last) else {
                break;
            };
            let (Some(a), Some(b)) = (run.orientations.get(start), run.orientations.get(end)) else {
                break;
            };
            let mut turns = [Vector3::zeros(); 4];
            for (turn, (a, b)) in turns.iter_mut().zip(a.iter().zip(b)) {
                *turn = (a.inverse() * b).scaled_axis();
            }
            windows.push(Window {
                run: index,
                rows: (start, end),
                start_s,
                end_s,
                turns,
            });
            start = from(start_s + hop).max(start + 1);
        }
    }
    windows
}
