//! The unit of a gyro that no orientation decides: by the turns of the platform's course, or by how gravity moves in its axes.

use nalgebra::Vector3;

use crate::analysis::axes::sensors::Sensor;
use crate::analysis::motion::Imu;
use crate::math::tilting::{TiltRow, Tilting};
use crate::rules::prelude::*;

use super::{IN_DEGREES, Limits, TWICE_IN_RADIANS};

/// Length of the windows in which gravity moves, and their longest step, seconds.
const WINDOW_S: f64 = 0.5;
const MAX_STEP_S: f64 = 0.1;

/// Something that rotates with the gyro.
struct Witness {
    /// What rotates: the course of a track, or gravity.
    words: String,
    /// Its rotation over that by the gyro: 1 for rad/s, pi/180 for deg/s.
    gain: f64,
    correlation: f64,
    samples: usize,
    /// Whether forces that are not gravity's cannot be taken for its rotation.
    is_kinematic: bool,
}

/// Judges the unit of a gyro; `why` is why no orientation decides.
pub(super) fn judge((imu, sensor): (&Imu, &Sensor), subject: String, why: &str, limits: &Limits, out: &mut Judge) {
    let by_course = sensor.sense.as_ref().ok().map(|fit| Witness {
        words: format!("the course of {}", fit.track),
        gain: 1.0 / fit.slope.gain.abs(),
        correlation: fit.slope.correlation,
        samples: fit.slope.pairs,
        is_kinematic: true,
    });
    let tilting = tilting(imu);
    let by_gravity = tilting.as_ref().and_then(|found| by_gravity(found, limits));
    let witnesses: Vec<Witness> = by_course.into_iter().chain(by_gravity).collect();
    let units = [
        (1.0, None),
        (1f64.to_radians(), Some(IN_DEGREES)),
        (1f64.to_degrees(), Some(TWICE_IN_RADIANS)),
    ];
    let unit = |found: &Witness| {
        let near = |value: f64| (found.gain / value).max(value / found.gain) <= limits.max_factor;
        let mut possible = units.iter().take(if found.is_kinematic { 3 } else { 2 });
        possible.find(|(value, _)| near(*value)).map(|(_, wrong)| *wrong)
    };
    let decided = witnesses.iter().find_map(|found| Some((found, unit(found)?)));
    let Some((found, wrong)) = decided else {
        let why = if let Some(found) = witnesses.first() {
            format!(
                "{why}; {} rotates {:.3} times as far as the gyro, which neither rad/s nor deg/s explains: they may not rotate together",
                found.words, found.gain
            )
        } else {
            let [range_deg, correlation] = tilting.map_or([0.0; 2], |found| {
                [found.range_rad.to_degrees(), found.correlation.abs()]
            });
            format!(
                "{why}; no course turns with it, and gravity moves by {range_deg:.0} deg in its axes ({} needed), as by the gyro with a correlation of \
                     {correlation:.2} ({} needed): turn the sensor by hand, upside down and back, for 20 s, or record a drive with turns and GNSS or odometry",
                limits.min_range_deg, limits.min_tilting
            )
        };
        return out.too_little(subject, why);
    };
    let Witness {
        words,
        gain,
        correlation,
        samples,
        ..
    } = found;
    let measured = [
        Measured::new(format!("rotation of {words} over rotation by the gyro"), *gain, "1")
            .expected(1.0)
            .samples(*samples as u64),
        Measured::new("correlation", correlation.abs(), "1"),
    ];
    let Some((what, help)) = wrong else {
        return out.pass(subject, measured);
    };
    let message = format!(
        "`{}`: {what} ({words} rotates {gain:.4} times as far)",
        imu.stream.topic
    );
    let finding = Finding::error(subject, message, imu.stream.place()).likely().help(help);
    out.fail(finding.measured(measured));
}

/// How gravity moves in the sensor's axes.
fn tilting(imu: &Imu) -> Option<Tilting> {
    let force = imu.inertial.force.filter(|force| *force > 0.0)?;
    let windows = imu.stream.windows(WINDOW_S, MAX_STEP_S).into_iter().map(|window| {
        let rows = window.iter().map(|timed| {
            let [gyro, force] = [timed.row.angular_velocity, timed.row.linear_acceleration].map(Vector3::from);
            (timed.t_s, gyro, force)
        });
        rows.filter(|(_, gyro, force)| gyro.norm().is_finite() && force.norm().is_finite())
            .collect::<Vec<TiltRow>>()
    });
    Tilting::of(&windows.collect::<Vec<_>>(), force)
}

/// The motion of gravity, if it follows the gyro.
fn by_gravity(found: &Tilting, limits: &Limits) -> Option<Witness> {
    let turned_deg = found.turned_rad.to_degrees() * found.correlation.abs();
    // A vehicle that brakes leans a little, as if gravity turned a lot.
    let is_clear = found.range_rad.to_degrees() >= limits.min_range_deg
        && turned_deg >= limits.min_rotation_deg
        && found.correlation.abs() >= limits.min_tilting
        && found.t().abs() >= limits.min_t;
    is_clear.then(|| Witness {
        words: "gravity in the sensor's axes".to_owned(),
        gain: found.gain.abs(),
        correlation: found.correlation,
        samples: found.windows,
        is_kinematic: false,
    })
}
