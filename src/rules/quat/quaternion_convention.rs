//! QUAT01: an orientation against the integral of its gyro.

use nalgebra::Matrix3;
use serde::Deserialize;

use crate::math::readings::Reading;
use crate::math::turns::{Score, Turns};
use crate::rules::axes::causes::{Diagnosis, Turn};
use crate::rules::axes::sensors::{Look, Sensors};
use crate::rules::motion::{Imu, Motion};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

use super::by_gyro::{Margins, Ordered, ordered};

/// QUAT01.
pub struct QuaternionConvention;

/// Limits of QUAT01.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_rotation_deg: f64,
    max_step_s: f64,
    agrees: f64,
    opposes: f64,
    unrelated: f64,
    unrelated_deg: f64,
    ratio: f64,
    noise: f64,
    axis_deg_s: f64,
    axis_step_s: f64,
    axis_wrong: f64,
    axis_right: f64,
}

/// What was seen.
pub(crate) struct Turned {
    pub(crate) class: Turn,
    as_published: Score,
    inverse: Score,
    reordered: Score,
    windows: usize,
    rotation_deg: f64,
    /// The axis about which it does not follow, of those that turn.
    axis: Option<usize>,
    /// The order of angles behind it, where the gyro shows another than that of ROS.
    pub(super) ordered: Option<Ordered>,
    /// How many axes turn fast enough to speak.
    speaking: usize,
}

impl Turned {
    /// Whether another order of angles would have shown: it turns about several axes.
    pub(super) fn shows_order(&self) -> bool {
        self.speaking > 1
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
            .limit(limits.agrees)
            .samples(windows),
        Measured::new("residual of the inverse", turned.inverse.residual, "1").samples(windows),
        Measured::new("residual read as w x y z", turned.reordered.residual, "1").samples(windows),
        Measured::new("rotation", turned.rotation_deg, "deg").limit(limits.min_rotation_deg),
    ];
    if turned.class == Turn::Agree {
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
    let Some(turns) = &imu.inertial.turns else {
        return little("no unbroken second of orientation and rate".to_owned());
    };
    let score = |reading: Reading| turns.score(reading).copied();
    let (Some(as_published), Some(inverse), Some(reordered)) =
        (score(Reading::Xyzw), score(Reading::Conjugate), score(Reading::Wxyz))
    else {
        return little("no unbroken second of orientation and rate".to_owned());
    };
    let rotation_deg = turns.rotation_rad.to_degrees();
    if rotation_deg < limits.min_rotation_deg {
        return little(format!(
            "it turns by {rotation_deg:.1} deg in windows with a rate, {} deg are needed",
            limits.min_rotation_deg
        ));
    }
    if turns.step_s > limits.max_step_s {
        return little(format!(
            "one message every {:.2} s: a gyro cannot be integrated at that rate, {} s are needed",
            turns.step_s, limits.max_step_s
        ));
    }
    // A gyro in another unit is AXES02's: it hides whether the senses agree.
    let gain = as_published.gain.abs().max(inverse.gain.abs());
    if !(0.5..=2.0).contains(&gain) {
        let best = as_published.gain_correlation.abs().max(inverse.gain_correlation.abs());
        if best > 0.9 {
            return little(format!(
                "the scale of the gyro is {gain:.3} of the orientation's turning: see AXES02"
            ));
        }
    }
    let axis = wrong_axis(turns, &as_published, limits).filter(|_| turns.step_s <= limits.axis_step_s);
    let speaks = |rms: &&f64| rms.to_degrees() >= limits.axis_deg_s;
    let speaking = turns.axis_rms_rad_s.iter().filter(speaks).count();
    let own = as_published.residual;
    // The search is dear, and its answer is sure: asked where anything speaks for it, at any rate.
    let is_odd = own > limits.unrelated || wrong_axis(turns, &as_published, limits).is_some();
    let margins = Margins {
        agrees: limits.agrees,
        ratio: limits.ratio,
        noise: limits.noise,
    };
    let simpler = is_read_otherwise(turns, limits);
    let order = if is_odd && !simpler {
        ordered(imu, own, &margins)
    } else {
        None
    };
    let found = |class: Turn| {
        Ok(Turned {
            class,
            ordered: order.clone(),
            speaking,
            as_published,
            inverse,
            reordered,
            windows: turns.active,
            rotation_deg,
            axis,
        })
    };
    let best_map = maps(&as_published)
        .into_iter()
        .map(|way| way.1)
        .fold(f64::INFINITY, f64::min);
    // A turned or negated gyro is the simpler fault.
    let beats_maps = |order: &Ordered| best_map >= limits.ratio * order.residual.max(limits.noise);
    if order.as_ref().is_some_and(beats_maps) {
        return found(Turn::Ordered);
    }
    if own < limits.agrees && inverse.residual > limits.opposes {
        return found(if axis.is_some() { Turn::Partly } else { Turn::Agree });
    }
    let mut ways = vec![(Turn::Inverse, inverse.residual), (Turn::Reordered, reordered.residual)];
    let reordered_inverse = score(Reading::WxyzConjugate).map(|score| score.residual);
    ways.extend(reordered_inverse.map(|residual| (Turn::ReorderedInverse, residual)));
    ways.extend(maps(&as_published));
    ways.sort_by(|a, b| a.1.total_cmp(&b.1));
    let best = ways.first().map_or(f64::NAN, |way| way.1);
    if best < limits.agrees && own >= limits.ratio * best.max(limits.noise) {
        let alike = ways.iter().filter(|way| way.1 < limits.ratio * best.max(limits.noise));
        let alike: Vec<Turn> = alike.map(|way| way.0).collect();
        match alike.as_slice() {
            [only] => return found(*only),
            all if own > limits.opposes && !all.iter().copied().any(is_reordered) => return found(Turn::Reversed),
            _ => {}
        }
    }
    if own > limits.unrelated && best > limits.unrelated && rotation_deg >= limits.unrelated_deg {
        return found(Turn::Unrelated);
    }
    little(format!(
        "neither follows the other clearly: {:.0} % of the turning is left unexplained as published, {:.0} % by the best other \
         reading",
        100.0 * own,
        100.0 * best
    ))
}

/// Whether the numbers, read in another order or as the inverse, agree with the gyro: a simpler fault than an order of angles.
fn is_read_otherwise(turns: &Turns, limits: &Limits) -> bool {
    let mut ways = [Reading::Conjugate, Reading::Wxyz, Reading::WxyzConjugate].into_iter();
    ways.any(|reading| turns.score(reading).is_some_and(|score| score.residual < limits.agrees))
}

fn is_reordered(turn: Turn) -> bool {
    matches!(turn, Turn::Reordered | Turn::ReorderedInverse)
}

/// Residuals of the gyro with its axes in FRD, negated, and with z alone negated.
fn maps(as_published: &Score) -> Vec<(Turn, f64)> {
    let Some(search) = as_published.axis_search() else {
        return Vec::new();
    };
    let class = |matrix: Matrix3<f64>| {
        let is = |signs: [f64; 3]| (matrix - Matrix3::from_diagonal(&signs.into())).norm() < 0.5;
        if is([1.0, -1.0, -1.0]) {
            Some(Turn::Frd)
        } else if is([-1.0, -1.0, -1.0]) {
            Some(Turn::Negated)
        } else if is([1.0, 1.0, -1.0]) {
            Some(Turn::Yaw)
        } else {
            None
        }
    };
    let ranked = search.ranked().iter();
    ranked
        .filter_map(|scored| Some((class(scored.map.matrix())?, search.residual(scored))))
        .collect()
}

/// An axis about which the orientation does not follow, though the gyro turns about it and another axis fits.
fn wrong_axis(turns: &Turns, score: &Score, limits: &Limits) -> Option<usize> {
    let correlation = score.axis_correlation;
    let fits = correlation.iter().flatten().any(|value| *value > limits.axis_right);
    let axes = correlation.iter().zip(turns.axis_rms_rad_s).enumerate();
    axes.filter(|(_, (correlation, rms))| {
        correlation.is_some_and(|value| value < limits.axis_wrong) && rms.to_degrees() >= limits.axis_deg_s
    })
    .map(|(axis, _)| axis)
    .next()
    .filter(|_| fits)
}
