//! Test support: simulated drives after section 5 of the domain facts. Only compiled for tests.
//!
//! Car: yaw rate Ornstein-Uhlenbeck, sd 0.12 rad/s, tau 4 s; roll and pitch swing by 0.4 degrees on their springs.
//! The truth is kept as angles, and body rates follow from Euler's kinematic equations: nothing here integrates a
//! rotation, so the tests of integrators do not test themselves.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use nalgebra::{UnitQuaternion, Vector3};

use super::rotation::from_rpy;
use super::tests_support::Rng;

/// The step of the simulation, seconds.
const STEP_S: f64 = 0.01;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    Car,
    Straight,
    Static,
}

/// The true state at one time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct State {
    pub(crate) t_s: f64,
    pub(crate) rpy_rad: [f64; 3],
    pub(crate) body_rate_rad_s: Vector3<f64>,
}

impl State {
    pub(crate) fn world_from_body(&self) -> UnitQuaternion<f64> {
        let [roll, pitch, yaw] = self.rpy_rad;
        from_rpy(roll, pitch, yaw)
    }
}

/// A first-order Gauss-Markov process, stationary from its first value on.
pub(crate) struct Wander {
    value: f64,
    sd: f64,
    keep: f64,
}

impl Wander {
    pub(crate) fn new(rng: &mut Rng, sd: f64, tau_s: f64, step_s: f64) -> Wander {
        Wander {
            value: sd * rng.normal(),
            sd,
            keep: (-step_s / tau_s).exp(),
        }
    }

    pub(crate) fn next(&mut self, rng: &mut Rng) -> f64 {
        self.value = self.keep * self.value + self.sd * (1.0 - self.keep * self.keep).sqrt() * rng.normal();
        self.value
    }
}

/// The states of a drive, `rate_hz` of them per second (a divisor of 100), from 0 s on.
pub(crate) fn drive(rng: &mut Rng, motion: Motion, seconds: f64, rate_hz: u32) -> Vec<State> {
    let (yaw_sd, swing_rad) = match motion {
        Motion::Car => (0.12, 0.4f64.to_radians()),
        Motion::Straight => (0.01, 0.4f64.to_radians()),
        Motion::Static => (0.0, 0.0),
    };
    let mut yaw_rate = Wander::new(rng, yaw_sd, 4.0, STEP_S);
    // A spring of 2 rad/s, damped to half of critical, pushed so that its angle has the deviation wanted.
    let (omega, zeta) = (2.0, 0.5);
    let push = swing_rad * (4.0 * zeta * omega * omega * omega * STEP_S).sqrt();
    let mut swing = [
        [swing_rad * rng.normal(), omega * swing_rad * rng.normal()],
        [swing_rad * rng.normal(), 0.0],
    ];
    let mut yaw = rng.range(-3.0, 3.0);
    let every = 100 / rate_hz as usize;
    let mut states = Vec::new();
    let mut rate = yaw_rate.next(rng);
    for i in 0..=((seconds / STEP_S) as usize) {
        let [[roll, roll_rate], [pitch, pitch_rate]] = swing;
        if i % every == 0 {
            let (sr, cr) = roll.sin_cos();
            let (sp, cp) = pitch.sin_cos();
            states.push(State {
                t_s: i as f64 * STEP_S,
                rpy_rad: [roll, pitch, yaw],
                body_rate_rad_s: Vector3::new(
                    roll_rate - rate * sp,
                    pitch_rate * cr + rate * sr * cp,
                    rate * cr * cp - pitch_rate * sr,
                ),
            });
        }
        let next = yaw_rate.next(rng);
        yaw += f64::midpoint(rate, next) * STEP_S;
        rate = next;
        for [angle, speed] in &mut swing {
            let before = *speed;
            *speed += (-2.0 * zeta * omega * *speed - omega * omega * *angle) * STEP_S + push * rng.normal();
            *angle += f64::midpoint(before, *speed) * STEP_S;
        }
    }
    states
}
