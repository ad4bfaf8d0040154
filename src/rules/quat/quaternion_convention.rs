//! QUAT01: an orientation against the integral of its gyro.

use serde::Deserialize;

use crate::math::turns::Score;
use crate::rules::axes::causes::Turn;
use crate::rules::axes::diagnosis::Diagnosis;
use crate::rules::axes::sensors::{Look, Sensors};
use crate::rules::motion::{Imu, Motion};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

use super::by_gyro::{Margins, Ordered, ordered};
use super::ways::Ways;

/// QUAT01.
pub struct QuaternionConvention;

/// Limits of QUAT01.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    pub(super) min_rotation_deg: f64,
    pub(super) max_step_s: f64,
    pub(super) agrees: f64,
    pub(super) opposes: f64,
    pub(super) unrelated: f64,
    pub(super) unrelated_deg: f64,
    pub(super) ratio: f64,
    pub(super) alike: f64,
    pub(super) slow_agrees: f64,
    pub(super) slow_gap: f64,
    pub(super) slow_s: f64,
    pub(super) slow_alike: f64,
    pub(super) slow_short: f64,
    pub(super) unrelated_correlation: f64,
    pub(super) standing: f64,
    pub(super) noise: f64,
    pub(super) axis_deg_s: f64,
    pub(super) axis_step_s: f64,
    pub(super) axis_wrong: f64,
    pub(super) axis_agrees: f64,
    pub(super) axis_right: f64,
    pub(super) axis_noise: f64,
    pub(super) axis_share: f64,
    pub(super) axis_sigmas: f64,
}

/// What was seen.
pub(crate) struct Turned {
    pub(crate) class: Turn,
    pub(super) as_published: Score,
    pub(super) inverse: Score,
    pub(super) reordered: Score,
    pub(super) windows: usize,
    pub(super) rotation_deg: f64,
    /// The largest residual that agrees, in the windows that told.
    pub(super) limit: f64,
    /// The axis about which it does not follow, of those that turn.
    pub(super) axis: Option<usize>,
    /// The order of angles behind it, where the gyro shows another than that of ROS.
    pub(super) ordered: Option<Ordered>,
    /// How many axes turn fast enough to speak.
    pub(super) speaking: usize,
    /// Root mean square of the rate about each axis, rad/s.
    pub(super) axis_rms_rad_s: [f64; 3],
}

impl Turned {
    /// Whether another order of angles would have shown: it turns about several axes.
    pub(super) fn shows_order(&self) -> bool {
        self.speaking > 1
    }

    /// Root mean square of the rate about each axis, degrees a second.
    pub(super) fn rates_deg_s(&self) -> [f64; 3] {
        self.axis_rms_rad_s.map(f64::to_degrees)
    }

    /// Of orientation and gyro about each axis.
    pub(super) fn correlations(&self) -> [Option<f64>; 3] {
        self.as_published.axis_correlation
    }
}

impl Rule for QuaternionConvention {
    const PAGE: &'static str = include_str!("../../../rules/quat/quaternion-convention.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            let subject = format!("orientation of {} against its gyro", imu.stream.subject);
            match &sensor.turn {
                Ok(turned) => judge_turned(imu, subject, turned, &sensor.diagnosis, limits, out),
                Err((why, reason)) => out.not_evaluated(subject, *why, reason),
            }
        }
    }
}

fn judge_turned(imu: &Imu, subject: String, turned: &Turned, diagnosis: &Diagnosis, limits: &Limits, out: &mut Judge) {
    let windows = turned.windows as u64;
    let measured = [
        Measured::new("residual as published", turned.as_published.residual, "1")
            .limit(turned.limit)
            .samples(windows),
        Measured::new("residual of the inverse", turned.inverse.residual, "1").samples(windows),
        Measured::new("residual read as w x y z", turned.reordered.residual, "1").samples(windows),
        Measured::new("rotation", turned.rotation_deg, "deg").limit(limits.min_rotation_deg),
    ];
    if matches!(turned.class, Turn::Agree | Turn::Tilting) {
        return out.pass(subject, measured);
    }
    if turned.class == Turn::Ordered {
        let why = "it does once its angles are put together in another order, which QUAT03 names";
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let seen = "the orientation does not follow the gyro";
    if let Some(why) = diagnosis.reported_elsewhere("QUAT01", seen) {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let what = match turned.class {
        Turn::Reordered => "follows its gyro only when the four numbers are read as w, x, y, z".to_owned(),
        Turn::ReorderedInverse => {
            "follows its gyro only when the four numbers are read as w, x, y, z, of the inverse".to_owned()
        }
        Turn::Partly => {
            let axis = turned.axis.and_then(|axis| ["x", "y", "z"].get(axis)).unwrap_or(&"one");
            format!("follows its gyro about one axis, and not about {axis}")
        }
        Turn::Unrelated => "is not the integral of its gyro".to_owned(),
        Turn::OneOf(_) => {
            "follows its gyro only when it is read in another way, of which several serve alike".to_owned()
        }
        _ => "turns against its gyro".to_owned(),
    };
    let message = format!(
        "the orientation of `{}` {what}: over {:.0} deg of rotation {:.0} % of the gyro's turning is left unexplained as published, \
         {:.0} % by the inverse, {:.0} % read as w x y z{}",
        imu.stream.topic,
        turned.rotation_deg,
        100.0 * turned.as_published.residual,
        100.0 * turned.inverse.residual,
        100.0 * turned.reordered.residual,
        diagnosis.words()
    );
    let otherwise = match turned.class {
        Turn::Partly => {
            "look at the order in which roll, pitch and yaw are put together: ROS is Rz(yaw) Ry(pitch) Rx(roll)"
        }
        Turn::Unrelated => "look for fields of another message, degrees for radians, or an Euler order",
        _ => "compare the driver's axes of orientation and gyro: both are of the sensor's frame (REP-145)",
    };
    let finding = diagnosis.explain(Finding::error(subject, message, imu.stream.place()).likely(), otherwise);
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

/// How the orientation turns against the gyro.
pub(crate) fn look(imu: &Imu, limits: &Limits) -> Look<Turned> {
    if let Some(why) = imu.no_orientation {
        return Err((NotEvaluated::NotApplicable, why.to_owned()));
    }
    let little = |reason: String| Err((NotEvaluated::TooLittleEvidence, reason));
    let Some(fast) = imu.inertial.turns.as_ref().and_then(Ways::of) else {
        return little("no unbroken second of orientation and rate".to_owned());
    };
    if fast.turns.step_s > limits.max_step_s {
        return little(format!(
            "one message every {:.2} s: a gyro cannot be integrated at that rate, {} s are needed",
            fast.turns.step_s, limits.max_step_s
        ));
    }
    // A gyro in another unit is AXES02's: it hides whether the senses agree.
    let gain = fast.as_published.gain.abs().max(fast.inverse.gain.abs());
    if !(0.5..=2.0).contains(&gain) && fast.follows() > 0.9 {
        return little(format!(
            "the scale of the gyro is {gain:.3} of the orientation's turning: see AXES02"
        ));
    }
    let slow = imu.inertial.slow_turns.as_ref().and_then(Ways::of);
    let turns_enough = |ways: &Ways| ways.rotation_deg() >= limits.min_rotation_deg;
    let order = turns_enough(&fast).then(|| fast_order(imu, &fast, limits)).flatten();
    if let Some(order) = order.as_ref().filter(|order| fast.are_worse(order.residual, limits)) {
        return Ok(Turned {
            ordered: Some(order.clone()),
            ..fast.found(Turn::Ordered, None, limits)
        });
    }
    let by_ratio = Some(&fast).filter(|ways| turns_enough(ways)).and_then(|ways| {
        let class = ways.by_ratio(limits)?;
        let axis = fast.axis(class, limits).ok()?;
        Some(Turned {
            // What a simpler fault explains is no matter of order.
            ordered: order.filter(|_| matches!(class, Turn::Agree | Turn::Tilting)),
            ..ways.found(class, axis, limits)
        })
    });
    let by_gap = || {
        let ways = slow.as_ref().filter(|ways| turns_enough(ways))?;
        let class = ways.by_gap(limits)?;
        // As much noise as turning in short windows: what two or three long ones make of it may be chance.
        if ways.covers_little(limits) && fast.explains(class) > limits.slow_short {
            return None;
        }
        // What noise hides in short windows is no proof against an axis.
        let axis = fast.axis(class, limits).ok()?;
        axis.is_none().then(|| ways.found(class, None, limits))
    };
    if let Some(turned) = by_ratio.or_else(by_gap) {
        return Ok(turned);
    }
    if !turns_enough(&fast) && !slow.as_ref().is_some_and(turns_enough) {
        return little(format!(
            "it turns by {:.1} deg in windows with a rate, {} deg are needed",
            fast.rotation_deg(),
            limits.min_rotation_deg
        ));
    }
    if fast.is_unrelated(limits) {
        return Ok(fast.found(Turn::Unrelated, None, limits));
    }
    little(fast.unclear(limits))
}

/// The order of the angles behind the orientation, if it is another one. The search is dear, and its answer is sure: asked
/// where anything speaks for it, at any rate.
fn fast_order(imu: &Imu, fast: &Ways, limits: &Limits) -> Option<Ordered> {
    let own = fast.as_published.residual;
    let margins = Margins {
        agrees: limits.agrees,
        ratio: limits.ratio,
        noise: limits.noise,
    };
    let is_odd = own > limits.unrelated || fast.has_odd_axis(limits);
    (is_odd && !fast.is_simpler(limits))
        .then(|| ordered(imu, own, &margins))
        .flatten()
}
