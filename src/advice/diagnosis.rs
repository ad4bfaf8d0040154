//! Completes findings on inertial sensors by the sensor's diagnosis: causes, help, and the rule that reports the fault best.

use crate::analysis::axes::imu_mounting;
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Imu, Motion};
use crate::analysis::{Estimates, axes::causes::Aspect, axes::diagnosis::Diagnosis, look::Estimate};
use crate::rules::codes;
use crate::verdict::{Finding, Judge, RuleCode, Severity};

/// Judges one measurement of every inertial sensor, under the subject that `named` makes; reports the reason where it was not possible.
pub(crate) fn judge_each<T, L>(
    (world, limits): (&Estimates, &L),
    named: impl Fn(&str) -> String,
    part: impl Fn(&Sensor) -> &Estimate<T>,
    judge: impl Fn((&Imu, &Sensor), String, &T, &L, &mut Judge),
    out: &mut Judge,
) {
    let (motion, sensors) = (Motion::of(world), Sensors::of(world));
    for (imu, sensor) in sensors.each(&motion) {
        let subject = named(&imu.stream.subject);
        match part(sensor) {
            Ok(seen) => judge((imu, sensor), subject, seen, limits, out),
            Err((why, reason)) => out.not_evaluated(subject, *why, reason),
        }
    }
}

/// The finding of a rule on one measurement of a sensor, with causes, help and the declared convention; `otherwise` is the help if no
/// known fault fits. If another measurement shows the fault better, the finding defers to that one's rule.
pub(crate) fn explain(diagnosis: &Diagnosis, imu: &Imu, own: Aspect, finding: Finding, otherwise: &str) -> Finding {
    let help = diagnosis.help().unwrap_or_else(|| otherwise.to_owned());
    let finding = diagnosis.expressed_in.annotate(finding).help(help);
    let mut finding = finding.detail(diagnosis.sentence());
    if let Some(word) = diagnosis.word() {
        finding = finding.relation(word);
    }
    let finding = imu_mounting::EXACT.into_iter().fold(finding, |finding, relation| {
        finding.unless_with(codes::AXES16, relation)
    });
    defer(diagnosis, imu, Some(own), finding)
}

/// The finding, deferring to the rule of the measurement that shows the fault best.
pub(crate) fn defer(diagnosis: &Diagnosis, imu: &Imu, own: Option<Aspect>, finding: Finding) -> Finding {
    match (diagnosis.shown_by.filter(|aspect| Some(*aspect) != own), &imu.mount) {
        (Some(Aspect::Body), Some(mount)) => {
            let finding = finding.unless_about(codes::AXES13, format!("`{}`", mount.base));
            if diagnosis.goes_backward {
                Finding {
                    severity: Severity::Note,
                    ..finding.hint()
                }
            } else {
                finding
            }
        }
        (Some(aspect), _) => finding.unless(rule_of(aspect)),
        (None, _) => finding,
    }
}

/// The finding, unless the track that it compares with is itself mirrored, because latitude and longitude are swapped.
pub(crate) fn unless_swapped(track: &str, finding: Finding) -> Finding {
    finding.unless_about(codes::AXES07, swapped_track(track.trim_start_matches("topic ")))
}

/// The fault of a track, in backticks, whose latitude and longitude are swapped.
pub(crate) fn swapped_track(track: &str) -> String {
    format!("{track}: latitude and longitude are swapped")
}

/// The rule of a measurement.
pub(crate) fn rule_of(aspect: Aspect) -> RuleCode {
    match aspect {
        Aspect::Base => codes::AXES01,
        Aspect::World => codes::AXES03,
        Aspect::Turn => codes::QUAT01,
        Aspect::Heading => codes::AXES04,
        Aspect::Sense => codes::AXES05,
        Aspect::Push | Aspect::Hand => codes::AXES06,
        Aspect::AngleOrder => codes::QUAT03,
        Aspect::Body => codes::AXES13,
    }
}
