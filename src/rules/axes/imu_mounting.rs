//! AXES16: the rotation of an inertial sensor's mounting, compared with the turns of the platform's poses.

use nalgebra::UnitQuaternion;

use crate::analysis::axes::imu_mounting::{ImuMounting, Limits};
use crate::analysis::motion::{Imu, Motion};
use crate::math::constants::AxisTurn;
use crate::math::rotation::rpy_in_words;
use crate::rules::prelude::*;

pub(crate) struct ImuMountingRotation;

impl Rule for ImuMountingRotation {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &Motion::of(world).bags {
            let of = |imu| (imu, ImuMounting::of(world, bag, imu, limits));
            let sensors: Vec<_> = bag.imus.iter().map(of).collect();
            for (imu, found) in &sensors {
                let subject = format!("mounting rotation of {}", imu.stream.subject);
                match found {
                    Ok(found) => {
                        let others = sensors
                            .iter()
                            .filter_map(|(other, of)| Some((*other, of.as_ref().ok()?)));
                        let mut exchanged = others
                            .filter(|(_, of)| is_exchanged(found, of, limits))
                            .map(|(other, _)| other);
                        judge_mounting(imu, subject, found, exchanged.next(), limits, out);
                    }
                    Err((why, reason)) => out.not_evaluated(subject, *why, reason),
                }
            }
        }
    }
}

/// Whether each of two sensors turns as the other one is mounted.
fn is_exchanged(a: &ImuMounting, b: &ImuMounting, limits: &Limits) -> bool {
    let is_near = |a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>| a.angle_to(b).to_degrees() <= limits.max_off_deg;
    a.body == b.body && is_near(&a.fitted, &b.stated) && is_near(&b.fitted, &a.stated)
}

/// The convention errors that turn the measured rotation into the stated one.
fn errors(found: &ImuMounting, limits: &Limits) -> Vec<&'static str> {
    let is_same = |other: UnitQuaternion<f64>| found.fitted.angle_to(&other).to_degrees() <= limits.max_off_deg / 2.0;
    let turns = AxisTurn::all().iter();
    let turns = turns
        .filter(|turn| is_same(found.stated * turn.quaternion()))
        .map(|turn| turn.word());
    let inverse = is_same(found.stated.inverse()).then_some("inverse");
    inverse.into_iter().chain(turns).collect()
}

fn judge_mounting(
    imu: &Imu,
    subject: String,
    found: &ImuMounting,
    exchanged: Option<&Imu>,
    limits: &Limits,
    out: &mut Judge,
) {
    let [as_stated, as_fitted] = found.residuals;
    let sigma_deg = found.sigma_rad.to_degrees();
    let off_deg = found.stated.angle_to(&found.fitted).to_degrees();
    let measured = [
        Measured::new("rotation missing in the mounting", off_deg, "deg")
            .limit(limits.max_off_deg)
            .spread(sigma_deg)
            .samples(found.windows as u64),
        Measured::new("unexplained share of the turns, as stated", as_stated, "1"),
        Measured::new(
            "unexplained share of the turns, with the fitted mounting",
            as_fitted,
            "1",
        )
        .limit(limits.max_residual),
    ];
    if !(1.0 / limits.max_gain..=limits.max_gain).contains(&found.gain) {
        let why = format!(
            "the gyro turns {:.2} times as far as {}: another unit, or another body",
            found.gain, found.poses.0
        );
        return out.too_little(subject, why);
    }
    if as_fitted > limits.max_residual {
        let why = format!(
            "no rotation of the axes makes the gyro turn as {}: {:.0} % is unexplained",
            found.poses.0,
            100.0 * as_fitted
        );
        return out.too_little(subject, why);
    }
    let uncertain_deg = limits.sigmas * sigma_deg;
    if off_deg <= limits.max_off_deg && uncertain_deg <= limits.max_off_deg {
        return out.pass(subject, measured);
    }
    if off_deg <= limits.max_off_deg.max(uncertain_deg) || uncertain_deg > limits.max_off_deg {
        let why = format!(
            "{off_deg:.0} +- {sigma_deg:.0} deg from the stated rotation: not accurate enough to decide; record turns about several axes"
        );
        return out.too_little(subject, why);
    }
    let finding = wrong(imu, subject, found, exchanged, limits);
    out.fail(imu.stream.expressed_in.annotate(finding).measured(measured));
}

fn wrong(imu: &Imu, subject: String, found: &ImuMounting, exchanged: Option<&Imu>, limits: &Limits) -> Finding {
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
    let finding = relation.into_iter().fold(finding, Finding::relation);
    let spoken = [
        codes::AXES01,
        codes::AXES03,
        codes::AXES05,
        codes::AXES06,
        codes::AXES08,
        codes::AXES13,
        codes::QUAT01,
        codes::CROSS08,
    ];
    spoken.into_iter().fold(finding, Finding::unless)
}
