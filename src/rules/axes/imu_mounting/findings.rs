//! What is said of an inertial sensor that turns otherwise than its platform.

use nalgebra::UnitQuaternion;

use super::Seen;
use crate::analysis::axes::causes::Base;
use crate::analysis::axes::imu_mounting::{EXACT, ImuMounting, Limits};
use crate::math::constants::AxisTurn;
use crate::math::rotation::rpy_in_words;
use crate::rules::codes;
use crate::verdict::{Finding, RuleCode, Severity};

/// Rules that name the cause of some of the same differences.
const SPOKEN: [RuleCode; 8] = [
    codes::AXES01,
    codes::AXES03,
    codes::AXES05,
    codes::AXES06,
    codes::AXES08,
    codes::AXES13,
    codes::QUAT01,
    codes::CROSS08,
];
/// Gravity may be off by less in a healthy sensor, degrees.
const LEANING_DEG: f64 = 45.0;

/// The axis turns that a rotation is within so many degrees of.
fn turns_near(rotation: UnitQuaternion<f64>, within_deg: f64) -> impl Iterator<Item = AxisTurn> {
    let is_near = move |turn: &AxisTurn| turn.quaternion().angle_to(&rotation).to_degrees() <= within_deg;
    AxisTurn::all().iter().copied().filter(is_near)
}

/// The convention errors that turn the measured rotation into the stated one.
fn errors(found: &ImuMounting, limits: &Limits) -> Vec<&'static str> {
    let within_deg = limits.max_off_deg / 2.0;
    let is_inverse = found.fitted.angle_to(&found.stated.inverse()).to_degrees() <= within_deg;
    let turns = turns_near(found.stated.inverse() * found.fitted, within_deg);
    let inverse = is_inverse.then_some("inverse");
    inverse.into_iter().chain(turns.map(AxisTurn::word)).collect()
}

impl Seen<'_> {
    /// Whether gravity agrees with the stated mounting, and not with the fitted one: then the axes of the poses are wrong.
    pub(super) fn contradicts_gravity(&self) -> bool {
        let base = self.sensor.base.as_ref().ok().filter(|base| base.class == Base::Up);
        base.is_some_and(|base| {
            let up = self.imu.base_from_imu().inverse() * base.direction;
            (self.found.stated * up).angle(&(self.found.fitted * up)).to_degrees() > LEANING_DEG
        })
    }

    pub(super) fn wrong_poses(&self, subject: String) -> Finding {
        let Self { imu, found, .. } = self;
        let turn = turns_near(found.fitted * found.stated.inverse(), LEANING_DEG / 2.0).next();
        let axes = turn.map_or_else(String::new, |turn| format!(" ({})", turn.word()));
        let message = format!(
            "poses by {} turn about other axes of `{}` than the gyro{axes}",
            found.poses.0, found.body
        );
        let finding = Finding::warning(subject, message, found.poses.1.clone())
        .likely()
        .detail(format!(
            "Gravity agrees with the mounting of `{}`, and would not with one that makes the turns equal: the axes of the poses are others than those of `{}`.",
            imu.stream.topic, found.body
        ))
        .help("express the poses in x forward, y left, z up of a world with z up (REP-103), or name their frames so (`_ned`, `_frd`)")
        .related(imu.stream.place(), "the inertial sensor");
        let finding = turn
            .into_iter()
            .fold(finding, |finding, turn| finding.relation(turn.word()));
        SPOKEN.into_iter().fold(finding, Finding::unless)
    }

    pub(super) fn wrong_mounting(&self, subject: String, limits: &Limits) -> Finding {
        let Self {
            imu, found, exchanged, ..
        } = self;
        let frame = imu.stream.frame_name();
        let errors = errors(found, limits);
        let (cause, relation) = match (exchanged, errors.first()) {
            (Some(other), _) => (
                format!(", as if exchanged with `{}`", other.stream.topic),
                Some("exchanged"),
            ),
            (None, Some(first)) => (format!(" ({})", errors.join(" or ")), Some(*first)),
            (None, None) => (String::new(), None),
        };
        let off_deg = found.stated.angle_to(&found.fitted).to_degrees();
        let message = format!(
            "`{}`: {frame} is rotated by {off_deg:.0} deg from its mounting transform{cause}",
            imu.stream.topic
        );
        let help = if exchanged.is_some() {
            "exchange the frames or the topics of the two sensors".to_owned()
        } else {
            format!(
                "correct the transform `{}` -> {frame} to the measured rotation, rounded to how the sensor is built in; or the axes of the driver",
                found.body
            )
        };
        let finding = Finding::warning(subject, message, imu.stream.place())
            .likely()
            .detail(format!(
                "Compared with the turns of `{}` by {}. Mounting: {}. As measured: {}.",
                found.body,
                found.poses.0,
                imu.mounting(),
                rpy_in_words(&found.fitted)
            ))
            .help(help)
            .related(found.poses.1.clone(), "poses");
        match relation {
            // It explains what every other rule measures of this sensor.
            Some(exact) if EXACT.contains(&exact) => Finding {
                severity: Severity::Error,
                ..finding.relation(exact).unless(codes::CROSS08)
            },
            known => SPOKEN
                .into_iter()
                .fold(known.into_iter().fold(finding, Finding::relation), Finding::unless),
        }
    }
}
