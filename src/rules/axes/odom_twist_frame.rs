//! AXES08: the velocity of odometry compared with the motion of its own pose.

use crate::analysis::axes::twist::{Limits, Reading, Twists};
use crate::analysis::axes::twist_frame::{SIDE_BETTER, has_twist};
use crate::analysis::motion::{Motion, Stream};
use crate::analysis::quat::level::is_reordered;
use crate::math::regress::bound_that_reaches_one;
use crate::rules::prelude::*;
use crate::world::motion::PoseRow;

/// Metres per second in other units.
const UNITS: [(f64, &str); 5] = [
    (3.6, "km/h"),
    (1.0 / 0.447_04, "miles per hour"),
    (1.0 / 0.514_444, "knots"),
    (100.0, "cm/s"),
    (1000.0, "mm/s"),
];

pub(crate) struct OdomTwistFrame;

impl Rule for OdomTwistFrame {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &Motion::of(world).bags {
            for stream in bag.poses.iter().filter(|stream| has_twist(stream)) {
                if is_reordered(stream, &world.limits()) {
                    let subject = format!("velocity of {}", stream.subject);
                    let why =
                        "the orientation is level only when it is read as w, x, y, z: fix the quaternion order first";
                    out.not_applicable(subject, why);
                    continue;
                }
                let twists = Twists::of(stream, limits);
                let pose = wrong_pose(&twists, limits);
                if let Some((best, second)) = pose {
                    fail_pose(stream, &twists, best, second, limits, out);
                } else {
                    judge_linear(stream, &twists, limits, out);
                }
                // An inverted orientation also rotates opposite to its yaw rate.
                let is_inverse = pose.is_some_and(|(best, _)| best.0 == Reading::Inverse);
                let cause = is_inverse.then(|| format!("velocity of {}", stream.subject));
                judge_turning(stream, &twists, cause, limits, out);
            }
        }
    }
}

/// The wrong pose that explains the motion, if no reading of the velocity does, and the next best one.
fn wrong_pose(twists: &Twists, limits: &Limits) -> Option<((Reading, f64), (Reading, f64))> {
    if twists.distance_m < limits.min_distance_m || twists.is_zero {
        return None;
    }
    let of_twist = twists.readings(limits.least_aside);
    let of_pose = twists.readings_of_pose();
    let best = *of_pose.first()?;
    let second = [of_pose.get(1), of_twist.first()].into_iter().flatten();
    let second = *second.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let is_clear = second.1 >= limits.min_ratio * best.1.max(limits.max_residual / 10.0);
    (best.1 <= limits.max_residual && of_twist.first()?.1 > limits.max_residual && is_clear).then_some((best, second))
}

/// The residual with the velocity or the pose read in this way.
fn residual(twists: &Twists, (reading, residual): &(Reading, f64)) -> Measured {
    let read = if reading.is_of_pose() { "pose" } else { "velocity" };
    let what = format!("unexplained share of the motion, {read} read as {}", reading.word());
    Measured::new(what, *residual, "1").samples(twists.windows)
}

/// What is measured where one reading explains the motion, and the next best one does not.
fn measured(twists: &Twists, best: &(Reading, f64), second: &(Reading, f64), limits: &Limits) -> [Measured; 4] {
    let as_defined = twists.residual(Reading::Body);
    [
        Measured::new("unexplained share of the motion, as published", as_defined, "1"),
        residual(twists, best).limit(limits.max_residual),
        residual(twists, second),
        Measured::new("distance that the pose moves", twists.distance_m, "m"),
    ]
}

fn fail_pose(
    stream: &Stream<PoseRow>,
    twists: &Twists,
    best: (Reading, f64),
    second: (Reading, f64),
    limits: &Limits,
    out: &mut Judge,
) {
    // In a plane, a mirrored position is also one rotated about a horizontal axis: z of the orientation distinguishes the two.
    let (words, word, help) = if twists.is_upside_down && best.0 != Reading::Inverse {
        (
            "orientation has z down, while the position has z up".to_owned(),
            "z-down",
            "express position and orientation in the same world: `R_enu = P * R_ned` (P: NED to ENU), position (y, x, -z)",
        )
    } else {
        (
            best.0.words(&[stream.frame_name(), stream.child_name()]),
            best.0.word(),
            best.0.help(),
        )
    };
    let message = format!("`{}`: {words}", stream.topic);
    let finding = Finding::error(format!("velocity of {}", stream.subject), message, stream.place()).detail(
        "With the correction, the pose moves as the velocity says. As published, no reading of the velocity explains the motion of the pose.",
    );
    out.fail(
        stream
            .expressed_in
            .annotate(finding)
            .likely()
            .relation(word)
            .help(help)
            .measured(measured(twists, &best, &second, limits)),
    );
}

fn judge_linear(stream: &Stream<PoseRow>, twists: &Twists, limits: &Limits, out: &mut Judge) {
    let subject = format!("velocity of {}", stream.subject);
    let little = |why: String, out: &mut Judge| out.too_little(&subject, why);
    if twists.distance_m < limits.min_distance_m {
        let why = format!(
            "the pose moves only {:.2} m in gap-free windows, {} m are needed",
            twists.distance_m, limits.min_distance_m
        );
        return little(why, out);
    }
    if twists.is_zero {
        let why = "the velocity is zero in every message although the pose moves: it is not filled in";
        return out.missing(&subject, why);
    }
    let readings = twists.readings(limits.least_aside);
    let [best, second, ..] = readings.as_slice() else {
        return;
    };
    if best.1 > limits.max_residual {
        let (times, left) = twists.scale;
        if times > 0.0 && best.1 >= limits.min_ratio * left.max(limits.max_residual / 10.0) {
            return out.fail(scaled(stream, subject, twists, limits));
        }
        let why = format!(
            "no reading of the velocity explains the motion of the pose: the best ({}) leaves a residual of {:.0} %",
            best.0.word(),
            100.0 * best.1
        );
        return little(why, out);
    }
    // Differences between negligible residuals mean nothing.
    if second.1 < limits.min_ratio * best.1.max(limits.max_residual / 10.0) {
        let why = format!(
            "this motion cannot distinguish {} from {} (residuals {:.3} and {:.3}): record a turn",
            best.0.word(),
            second.0.word(),
            best.1,
            second.1
        );
        return little(why, out);
    }
    if best.0 == Reading::Body {
        let mirrored = twists.residual(Reading::RightHand);
        if mirrored < SIDE_BETTER * best.1 {
            let why = format!(
                "with y negated the velocity matches the motion better (residuals {mirrored:.3} and {:.3}), but there is too little \
                 sideways motion to decide",
                best.1
            );
            return little(why, out);
        }
        return out.pass(
            &subject,
            [best, second].map(|reading| residual(twists, reading).limit(limits.max_residual)),
        );
    }
    let message = format!(
        "`{}`: {}",
        stream.topic,
        best.0.words(&[stream.frame_name(), stream.child_name()])
    );
    let also = match best.0 {
        Reading::Backwards => ", for example the yaw by 180 deg",
        Reading::Swapped => ", for example the yaw by 90 deg",
        _ => "",
    };
    let detail = format!(
        "With the correction, the velocity explains the motion of the pose (unexplained share {:.2}, as published {:.2}). Another possible \
         cause: the velocity is right, and the position or the orientation of the pose is wrong{also}.",
        best.1,
        twists.residual(Reading::Body)
    );
    out.fail(
        stream
            .expressed_in
            .annotate(Finding::error(&subject, message, stream.place()).detail(detail))
            .likely()
            .relation(best.0.word())
            .help(best.0.help())
            .measured(measured(twists, best, second, limits)),
    );
}

/// A velocity with the right direction and the wrong magnitude.
fn scaled(stream: &Stream<PoseRow>, subject: String, twists: &Twists, limits: &Limits) -> Finding {
    let (times, left) = twists.scale;
    let unit = UNITS
        .iter()
        .find(|(factor, _)| (times / factor - 1.0).abs() <= limits.max_residual / 10.0);
    let message = format!(
        "`{}`: velocity is {times:.4} times that of the pose{}",
        stream.topic,
        unit.map_or_else(String::new, |(_, word)| format!(": the unit is probably {word}"))
    );
    let detail = format!(
        "The direction is right: divided by {times:.4}, the velocity explains the motion of the pose except for {:.1} %.",
        100.0 * left
    );
    let as_defined = twists.residual(Reading::Body);
    let residual =
        Measured::new("unexplained share of the motion, as published", as_defined, "1").limit(limits.max_residual);
    let finding = Finding::error(subject, message, stream.place())
        .likely()
        .detail(detail)
        .relation("scale");
    stream
        .expressed_in
        .annotate(finding)
        .help(format!(
            "compare the position with a known distance:\n(1) if the position is in metres, divide the velocity by {times:.4} to publish \
             m/s (REP-103)\n(2) if the position is not in metres, convert the position to metres"
        ))
        .measured(Measured::new("velocity / velocity of the pose", times, "1").samples(twists.windows))
        .measured(residual)
        .measured(Measured::new("distance that the pose moves", twists.distance_m, "m"))
}

/// Whether the motion rules out an inverted orientation.
fn confirms_orientation(twists: &Twists, limits: &Limits) -> bool {
    let [as_defined, inverse] = [Reading::Body, Reading::Inverse].map(|reading| twists.residual(reading));
    twists.distance_m >= limits.min_distance_m
        && as_defined <= limits.max_residual
        && inverse >= limits.min_ratio * as_defined.max(limits.max_residual / 10.0)
}

fn judge_turning(stream: &Stream<PoseRow>, twists: &Twists, cause: Option<String>, limits: &Limits, out: &mut Judge) {
    let (turning, is_confirmed) = (&twists.turning, confirms_orientation(twists, limits));
    let subject = format!("turning velocity of {}", stream.subject);
    let turned_deg = turning.turned_rad.to_degrees();
    if turned_deg < limits.min_turn_deg {
        let why = format!(
            "the pose rotates by only {turned_deg:.0} deg in gap-free windows, {} deg are needed",
            limits.min_turn_deg
        );
        return out.too_little(&subject, why);
    }
    if turning.slope == 0.0 {
        let why = "the yaw rate is zero in every message although the pose rotates: it is not filled in";
        return out.missing(&subject, why);
    }
    let measured = Measured::new("yaw rate / rotation rate of the pose", turning.slope, "1").samples(turning.windows);
    let near = |value: f64| (turning.slope / value - 1.0).abs() <= limits.turn_agrees;
    if near(1.0) {
        out.pass(&subject, [measured]);
    } else if turning.correlation.abs() < limits.max_correlation() {
        let why = format!(
            "the yaw rate does not follow the rotation of the pose (correlation {:.2})",
            turning.correlation
        );
        out.too_little(&subject, why);
    } else if let Some(upper) = bound_that_reaches_one(turning.slope, turning.correlation, limits.turn_agrees) {
        let why = format!(
            "the yaw rate is {:.2} to {upper:.2} times that of its pose, depending on which of the two is noisy",
            turning.slope
        );
        out.too_little(&subject, why);
    } else {
        let (words, detail, help) = if near(-1.0) && is_confirmed {
            (
                "has the opposite sign",
                "",
                "negate the yaw rate: counter-clockwise turns about z up are positive (REP-103)",
            )
        } else if near(-1.0) {
            (
                "has the opposite sign",
                "Another possible cause: the yaw of the orientation increases clockwise (inverted orientation, or compass heading). These data \
                 cannot distinguish the causes.",
                "turn to the left:\n(1) if the yaw of the pose increases, negate the yaw rate (REP-103)\n(2) if the yaw of the pose \
                 decreases, conjugate the quaternion (inverted orientation) or publish `yaw_ros = pi/2 - heading` (compass heading)",
            )
        } else if near(1f64.to_degrees()) {
            ("is in deg/s", "", "multiply the yaw rate by pi / 180: rad/s (REP-103)")
        } else {
            (
                "does not match",
                "Another possible cause: the orientation of the pose is wrong.",
                "publish the yaw rate in rad/s about the child frame's z axis (REP-103)",
            )
        };
        let message = format!(
            "`{}`: yaw rate {words} ({:.2} times that of the pose)",
            stream.topic, turning.slope
        );
        let finding = stream
            .expressed_in
            .annotate(Finding::error(&subject, message, stream.place()).detail(detail))
            .likely()
            .help(help)
            .measured(measured.expected(1.0))
            .measured(Measured::new("rotation of the pose that was used", turned_deg, "deg"));
        out.fail(cause.into_iter().fold(finding, Finding::same_cause_as));
    }
}
