//! Measurements of an inertial sensor by itself: force, rest, gravity in the world, and rotations by gyro and orientation.
//!
//! Made once for all rules that judge the sensor. Must not judge.

use std::hash::Hasher;
use std::sync::Arc;

use crate::analysis::estimates::{Estimates, InputHasher, hash_numbers};
use crate::analysis::motion::stream::{Stream, TimedRow};
use crate::math::gravity::{Gravity, gravity};
use crate::math::rest::{RestEstimate, rest};
use crate::math::turns::{Turns, turns};
use crate::math::{gravity, rest, stats::median, turns};
use crate::world::motion::InertialRow;

/// Length of the windows of gravity, seconds: the mean force of a driving car over ten seconds is off by 5 degrees.
const GRAVITY_WINDOW_S: f64 = 2.0;
/// Tilt that distinguishes an orientation from its inverse, radians (5 degrees).
const TILTED_RAD: f64 = 0.087;
/// Length of the windows of turns, seconds: the best on real recordings.
const TURN_WINDOW_S: f64 = 0.5;
/// Length of the windows of turns for orientations with noise of a degree, seconds.
const SLOW_TURN_WINDOW_S: f64 = 2.0;
/// From one of these to the next, seconds.
const SLOW_TURN_HOP_S: f64 = 0.5;

/// The measurements of one sensor.
#[derive(Clone, Debug)]
pub(crate) struct Inertial {
    /// Median magnitude of the acceleration as published, m/s² by definition; `None` without a finite one.
    pub(crate) force: Option<f64>,
    /// Windows at rest.
    pub(crate) rest: RestEstimate,
    /// Gravity in the world by the orientation; `None` without one.
    pub(crate) gravity: Option<Gravity>,
    /// Rotations by orientation and gyro; `None` without an orientation, or if no stretch is long enough.
    pub(crate) turns: Option<Turns>,
    /// The same over longer windows.
    pub(crate) slow_turns: Option<Turns>,
}

impl Inertial {
    /// Measures the rows of a sensor.
    pub(crate) fn of(world: &Estimates, stream: &Stream<InertialRow>, has_orientation: bool) -> Arc<Self> {
        let numbers = |hasher: &mut InputHasher| {
            hasher.write_u8(u8::from(has_orientation));
            for stretch in &stream.stretches {
                hasher.write_usize(stretch.len());
                for TimedRow { t_s, row, .. } in stretch {
                    hash_numbers(hasher, [*t_s]);
                    hash_numbers(hasher, row.orientation);
                    hash_numbers(hasher, row.angular_velocity);
                    hash_numbers(hasher, row.linear_acceleration);
                }
            }
        };
        world.shared(numbers, || Self::measured(stream, has_orientation))
    }

    fn measured(stream: &Stream<InertialRow>, has_orientation: bool) -> Self {
        let length = |timed: &TimedRow<InertialRow>| norm(timed.row.linear_acceleration);
        let forces: Vec<f64> = stream.rows().map(length).collect();
        let still = |timed: &TimedRow<InertialRow>| rest::Row {
            t_s: timed.t_s,
            rate_rad_s: timed.row.angular_velocity,
            force_m_s2: timed.row.linear_acceleration,
        };
        let level = |timed: &TimedRow<InertialRow>| gravity::Row {
            t_s: timed.t_s,
            slots: timed.row.orientation,
            force_m_s2: timed.row.linear_acceleration,
        };
        let turning = |timed: &TimedRow<InertialRow>| turns::Row {
            t_s: timed.t_s,
            slots: timed.row.orientation,
            rate_rad_s: timed.row.angular_velocity,
        };
        let turns_over = |options: &turns::Options| {
            has_orientation
                .then(|| turns(&made(stream, turning), options))
                .flatten()
        };
        let slow = turns::Options {
            hop_s: SLOW_TURN_HOP_S,
            ..turns::Options::new(SLOW_TURN_WINDOW_S)
        };
        Self {
            force: median(&forces),
            rest: rest(&made(stream, still), &rest::Options::default()),
            gravity: has_orientation
                .then(|| gravity(&made(stream, level), GRAVITY_WINDOW_S, TILTED_RAD))
                .flatten(),
            turns: turns_over(&turns::Options::new(TURN_WINDOW_S)),
            slow_turns: turns_over(&slow),
        }
    }
}

fn made<R>(stream: &Stream<InertialRow>, row: impl Fn(&TimedRow<InertialRow>) -> R) -> Vec<Vec<R>> {
    let stretches = stream.stretches.iter();
    stretches.map(|stretch| stretch.iter().map(&row).collect()).collect()
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}
