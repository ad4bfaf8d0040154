//! AXES03: where the acceleration points in the world, by the orientation.

use serde::Deserialize;

use crate::math::gravity::WorldForce;
use crate::math::readings::Reading;
use crate::rules::motion::{Imu, Motion};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated, Severity};

use super::causes::World;
use super::diagnosis::Diagnosis;
use super::sensors::{Look, Sensors};

/// AXES03.
pub struct OrientationVsGravity;

/// Limits of AXES03.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_s: f64,
    min_rows: usize,
    min_concentration: f64,
    max_tilt_deg: f64,
    steady_concentration: f64,
    tilted_deg: f64,
    gravity: f64,
    gravity_share: f64,
}

/// What was seen.
pub(super) struct Above {
    pub(super) class: World,
    force: WorldForce,
    seconds: f64,
    rows: usize,
}

impl Above {
    /// Angle between the acceleration and the world's up, radians.
    pub(super) fn off_up_rad(&self) -> f64 {
        self.force.from_up_rad
    }
}

impl Rule for OrientationVsGravity {
    const PAGE: &'static str = include_str!("../../../rules/axes/orientation-vs-gravity.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &crate::world::World, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            let subject = format!("orientation of {}", imu.stream.subject);
            match &sensor.world {
                Ok(above) => judge_above(imu, subject, above, &sensor.diagnosis, limits, out),
                Err((why, reason)) => out.not_evaluated(subject, *why, reason),
            }
        }
    }
}

fn judge_above(imu: &Imu, subject: String, above: &Above, diagnosis: &Diagnosis, limits: &Limits, out: &mut Judge) {
    let rows = above.rows as u64;
    let degrees = above.force.from_up_rad.to_degrees();
    let measured = [
        Measured::new("angle of the mean acceleration to z of the world", degrees, "deg")
            .turn()
            .limit(limits.max_tilt_deg)
            .samples(rows),
        Measured::new("concentration", above.force.concentration, "1")
            .limit(limits.min_concentration)
            .samples(rows),
        Measured::new("time", above.seconds, "s"),
    ];
    if above.class == World::Up {
        return out.pass(subject, measured);
    }
    let seen = format!("the acceleration is {degrees:.0} deg from up");
    if let Some(why) = diagnosis.reported_elsewhere("AXES03", &seen) {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let (severity, what) = match above.class {
        World::Down => (Severity::Error, "points down".to_owned()),
        _ => (
            Severity::Warning,
            format!("points {degrees:.0} deg away from up, steadily"),
        ),
    };
    let message = format!(
        "turned into the world by its own orientation, the acceleration of `{}` {what} ({:+.2} m/s2 along z over {:.0} s, \
         concentration {:.3}){}",
        imu.stream.topic,
        above.force.mean_m_s2.z,
        above.seconds,
        above.force.concentration,
        diagnosis.words()
    );
    let otherwise =
        "align the orientation with gravity: level and at rest `R(q) * acceleration` is +9.81 along z (REP-145)";
    let finding = diagnosis.explain(
        Finding::new(severity, subject, message, imu.stream.place()).likely(),
        otherwise,
    );
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

/// Where the acceleration points in the world.
pub(super) fn look(imu: &Imu, limits: &Limits) -> Look<Above> {
    if let Some(why) = imu.no_orientation {
        return Err((NotEvaluated::NotApplicable, why.to_owned()));
    }
    let little = |reason: String| Err((NotEvaluated::TooLittleEvidence, reason));
    let Some(gravity) = &imu.inertial.gravity else {
        return Err((NotEvaluated::NotApplicable, "it gives no acceleration".to_owned()));
    };
    let Some(force) = gravity.mean(Reading::Xyzw).copied() else {
        return little("no orientation is one".to_owned());
    };
    if gravity.covered_s < limits.min_s || gravity.rows < limits.min_rows {
        return little(format!(
            "{:.1} s and {} rows of orientation with acceleration, {} s and {} are needed",
            gravity.covered_s, gravity.rows, limits.min_s, limits.min_rows
        ));
    }
    let near = |unit: f64| (gravity.norm_m_s2 / unit - 1.0).abs() <= limits.gravity_share;
    if !near(limits.gravity) && !near(1.0) {
        return little(format!(
            "the acceleration is {:.2} long as published, which is no gravity",
            gravity.norm_m_s2
        ));
    }
    let degrees = force.from_up_rad.to_degrees();
    let class = if force.concentration >= limits.min_concentration && degrees <= limits.max_tilt_deg {
        World::Up
    } else if force.concentration >= limits.min_concentration && degrees >= 180.0 - limits.max_tilt_deg {
        World::Down
    } else if force.concentration >= limits.steady_concentration && degrees > limits.tilted_deg {
        World::Elsewhere
    } else {
        return little(format!(
            "the acceleration points to no one place in the world: {degrees:.0} deg from up in the mean, concentration {:.3}",
            force.concentration
        ));
    };
    Ok(Above {
        class,
        force,
        seconds: gravity.covered_s,
        rows: gravity.rows,
    })
}
