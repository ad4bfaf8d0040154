//! The curves of the vehicles: how fast they go, how they turn, and what their ground is like.

use std::f64::consts::{PI, TAU};

use super::description::{Description, Motion, Vehicle};
use super::random::{Random, series};
use super::spline::Spline;
use super::truth::{Curves, Lean, Signal};

/// How long before its start and after its end a drive is known, seconds: for sensors whose stamps are late.
pub const MARGIN_S: f64 = 40.0;

/// The habits of a vehicle: m/s, rad/s, degrees, seconds.
struct Habits {
    speed: f64,
    speed_deviation: f64,
    speed_limit: f64,
    speed_tau_s: f64,
    turn_deviation: f64,
    turn_tau_s: f64,
    least_radius: f64,
    circle: (f64, f64),
    tilt_deg: f64,
    tilt_tau_s: f64,
    aside: f64,
    up: f64,
    step_s: f64,
}

fn habits(vehicle: Vehicle) -> Habits {
    let small = Habits {
        speed: 0.7,
        speed_deviation: 0.3,
        speed_limit: 1.2,
        speed_tau_s: 5.0,
        turn_deviation: 0.3,
        turn_tau_s: 3.0,
        least_radius: 0.0,
        circle: (0.8, 0.4),
        tilt_deg: 1.5,
        tilt_tau_s: 2.0,
        aside: 0.0,
        up: 0.0,
        step_s: 0.25,
    };
    match vehicle {
        Vehicle::Car => Habits {
            speed: 4.0,
            speed_deviation: 2.0,
            speed_limit: 8.0,
            speed_tau_s: 10.0,
            turn_deviation: 0.12,
            turn_tau_s: 4.0,
            least_radius: 5.0,
            circle: (3.0, 0.3),
            tilt_deg: 2.0,
            tilt_tau_s: 4.0,
            step_s: 0.4,
            ..small
        },
        Vehicle::Robot => small,
        Vehicle::Walker => Habits {
            speed: 0.8,
            speed_limit: 1.5,
            tilt_deg: 2.0,
            tilt_tau_s: 3.0,
            aside: 0.15,
            ..small
        },
        Vehicle::Drone => Habits {
            speed: 4.0,
            speed_deviation: 2.0,
            speed_limit: 8.0,
            circle: (3.0, 0.3),
            aside: 0.7,
            up: 0.5,
            ..small
        },
    }
}

/// The curves of a drive.
pub fn curves(drive: &Description) -> Curves {
    let habits = habits(drive.vehicle);
    let mut random = Random::new(drive.seed, "trajectory");
    let start_s = -MARGIN_S - 4.0 * habits.step_s;
    let n = ((drive.duration_s + 2.0 * MARGIN_S) / habits.step_s) as usize + 10;
    let moving = drive.motion != Motion::Still;
    let mut wander = |deviation: f64, tau_s: f64| -> Vec<f64> {
        let series = series(&mut random, n, habits.step_s, tau_s);
        series.into_iter().map(|value| deviation * value).collect()
    };
    // Drawn in the same order whatever the motion: a seed's road is the same for all of them.
    let mut speed = wander(1.0, habits.speed_tau_s);
    let mut turn = wander(1.0, habits.turn_tau_s);
    let tilt = drive.tilt_deg.unwrap_or(habits.tilt_deg).to_radians();
    let tilts = [(); 2].map(|()| wander(tilt, habits.tilt_tau_s));
    let aside = [habits.aside, habits.up].map(|deviation| wander(deviation, 3.0));
    let yaw = random.between(-PI, PI);
    let phase = random.between(0.0, TAU);

    for (k, (speed, turn)) in speed.iter_mut().zip(&mut turn).enumerate() {
        let t_s = start_s + k as f64 * habits.step_s;
        (*speed, *turn) = habits.at(drive, t_s, *speed, *turn);
    }
    let curve = |values: Vec<f64>| Signal::of(Spline::new(start_s, habits.step_s, &values));
    let still = |value: f64| Signal::of(Spline::constant(value));
    let yaw = drive.yaw_deg.map_or(yaw, f64::to_radians);
    let yaw = Signal::of(Spline::integral(start_s, habits.step_s, &turn).through(0.0, yaw));
    let [roll, pitch] = tilts.map(|tilt| if moving { curve(tilt) } else { still(tilt[0]) });
    let [left, up] = aside.map(|aside| if moving { curve(aside) } else { still(0.0) });
    let ahead = curve(speed);
    let gait = |signal: Signal, amplitude: f64, hz: f64, lead: f64| {
        if moving {
            signal.with(amplitude, hz, phase + lead)
        } else {
            signal
        }
    };
    match drive.vehicle {
        Vehicle::Car | Vehicle::Robot => Curves {
            velocity: [ahead, left, up],
            tilt: [roll, pitch],
            yaw,
            lean: Lean::Ground,
        },
        Vehicle::Walker => Curves {
            velocity: [
                gait(ahead, 0.08, 4.0, 0.0),
                gait(left, 0.06, 2.0, 1.0),
                gait(up, 0.08, 4.0, 2.0),
            ],
            tilt: [gait(roll, 0.03, 2.0, 0.5), gait(pitch, 0.015, 4.0, 1.5)],
            yaw: gait(yaw, 0.01, 2.0, 2.5),
            lean: Lean::Free,
        },
        Vehicle::Drone => Curves {
            velocity: [ahead, left, up],
            tilt: [roll, pitch],
            yaw,
            lean: if moving {
                Lean::Thrust(drive.place.gravity(), 0.1)
            } else {
                Lean::Free
            },
        },
    }
}

impl Habits {
    /// Speed and yaw rate at a time, from two wandering numbers of deviation 1.
    fn at(&self, drive: &Description, t_s: f64, speed: f64, turn: f64) -> (f64, f64) {
        let wandering = (self.speed + self.speed_deviation * speed).clamp(0.0, self.speed_limit);
        let (speed, turn) = match drive.motion {
            Motion::Still => return (0.0, 0.0),
            Motion::Turning => (wandering, self.turn_deviation * turn),
            Motion::Straight => (wandering, 0.01 * turn),
            Motion::Circles => (
                self.circle.0 * (1.0 + 0.03 * speed),
                self.circle.1 * (1.0 + 0.03 * turn),
            ),
            Motion::OutAndBack => {
                // Half a circle in six seconds, at a third of the speed.
                let turning = (-3.0..3.0).contains(&(t_s - drive.duration_s / 2.0));
                let around = if turning { PI / 6.0 } else { 0.0 };
                let share = if turning { 1.0 / 3.0 } else { 1.0 };
                return (wandering * share, 0.003 * turn + around);
            }
        };
        let limit = if self.least_radius > 0.0 {
            speed / self.least_radius
        } else {
            f64::INFINITY
        };
        (speed, turn.clamp(-limit, limit))
    }
}
