//! AXES08: the velocity of odometry against the motion of its own pose.

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
                    let why = "the orientation is level only when it is read as w x y z: its axes say nothing of the velocity";
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
                // An inverse orientation turns against its yaw rate as well.
                let is_inverse = pose.is_some_and(|(best, _)| best.0 == Reading::Inverse);
                let cause = is_inverse.then(|| format!("velocity of {}", stream.subject));
                judge_turning(stream, &twists, cause, limits, out);
            }
        }
    }
}

/// The reading of a wrong pose that explains what no reading of the velocity does, and the next one.
fn wrong_pose(twists: &Twists, limits: &Limits) -> Option<((Reading, f64), (Reading, f64))> {
    if twists.distance_m < limits.min_distance_m || twists.is_zero {
        return None;
    }
    let of_twist = twists.told(limits.least_aside);
    let of_pose = twists.told_of_pose();
    let best = *of_pose.first()?;
    let second = [of_pose.get(1), of_twist.first()].into_iter().flatten();
    let second = *second.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let is_told = second.1 >= limits.min_ratio * best.1.max(limits.max_residual / 10.0);
    (best.1 <= limits.max_residual && of_twist.first()?.1 > limits.max_residual && is_told).then_some((best, second))
}

fn fail_pose(
    stream: &Stream<PoseRow>,
    twists: &Twists,
    best: (Reading, f64),
    second: (Reading, f64),
    limits: &Limits,
    out: &mut Judge,
) {
    let as_defined = twists.residual(Reading::Body);
    // A position that is a mirror image of a plane is one that is turned about an axis in it: z of the orientation tells.
    let (words, word, help) = if twists.is_upside_down && best.0 != Reading::Inverse {
        (
            "right, and the orientation is expressed in a world with z down, the position in one with z up",
            "z-down",
            "tell position and orientation in one world: `R_enu = P * R_ned`, and (y, x, -z) of the position",
        )
    } else {
        (best.0.words(), best.0.word(), best.0.help())
    };
    let message = format!(
        "the velocity on {} is {words}: so read it leaves {:.1} % of the motion of the pose, as published {:.0} %",
        stream.topic,
        100.0 * best.1,
        100.0 * as_defined
    );
    let measured = |reading: (Reading, f64)| {
        Measured::new(format!("residual, {}", reading.0.word()), reading.1, "1")
            .limit(limits.max_residual)
            .samples(twists.windows)
    };
    let finding = Finding::error(format!("velocity of {}", stream.subject), message, stream.place());
    out.fail(
        stream
            .expressed_in
            .tell(finding)
            .likely()
            .relation(word)
            .help(help)
            .measured(measured(best))
            .measured(measured(second))
            .measured(Measured::new("residual, as defined", as_defined, "1"))
            .measured(Measured::new("distance", twists.distance_m, "m")),
    );
}

fn judge_linear(stream: &Stream<PoseRow>, twists: &Twists, limits: &Limits, out: &mut Judge) {
    let subject = format!("velocity of {}", stream.subject);
    let little = |why: String, out: &mut Judge| out.too_little(&subject, why);
    if twists.distance_m < limits.min_distance_m {
        let why = format!(
            "the pose moves {:.2} m within unbroken windows, {} m are needed",
            twists.distance_m, limits.min_distance_m
        );
        return little(why, out);
    }
    if twists.is_zero {
        let why = "the velocity is zero in every message, though the pose moves: it is not filled in";
        return out.missing(&subject, why);
    }
    let told = twists.told(limits.least_aside);
    let [best, second, ..] = told.as_slice() else {
        return;
    };
    let measured = |reading: &(Reading, f64)| {
        Measured::new(format!("residual, {}", reading.0.word()), reading.1, "1")
            .limit(limits.max_residual)
            .samples(twists.windows)
    };
    if best.1 > limits.max_residual {
        let (times, left) = twists.scale;
        if times > 0.0 && best.1 >= limits.min_ratio * left.max(limits.max_residual / 10.0) {
            return out.fail(scaled(stream, subject, twists, limits));
        }
        let why = format!(
            "no reading of the velocity explains the motion of the pose: the best, {}, leaves {:.0} % of it",
            best.0.word(),
            100.0 * best.1
        );
        return little(why, out);
    }
    // A residual of nearly nothing is no better than another one of nearly nothing.
    if second.1 < limits.min_ratio * best.1.max(limits.max_residual / 10.0) {
        let why = format!(
            "this motion does not tell {} from {} (residuals {:.3} and {:.3}): it takes a turn",
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
                "with y negated the velocity fits the motion better (residuals {mirrored:.3} and {:.3}), but it goes too little to the \
                 side to tell",
                best.1
            );
            return little(why, out);
        }
        return out.pass(&subject, [measured(best), measured(second)]);
    }
    let as_defined = twists.residual(Reading::Body);
    let child = stream
        .child
        .as_ref()
        .map_or_else(|| "the child frame".to_owned(), |child| format!("`{child}`"));
    let message = format!(
        "the velocity on {} is {}, not in {child}: so read it leaves {:.1} % of the motion of the pose, as defined {:.0} % (or the position or the \
         orientation beside it is wrong, and the velocity right)",
        stream.topic,
        best.0.words(),
        100.0 * best.1,
        100.0 * as_defined
    );
    out.fail(
        stream
            .expressed_in
            .tell(Finding::error(&subject, message, stream.place()))
            .likely()
            .relation(best.0.word())
            .help(best.0.help())
            .measured(measured(best))
            .measured(measured(second))
            .measured(Measured::new("residual, as defined", as_defined, "1"))
            .measured(Measured::new("distance", twists.distance_m, "m")),
    );
}

/// A velocity that has the direction of the motion, and another size.
fn scaled(stream: &Stream<PoseRow>, subject: String, twists: &Twists, limits: &Limits) -> Finding {
    let (times, left) = twists.scale;
    let unit = UNITS.iter().find(|(factor, _)| (times / factor - 1.0).abs() <= limits.max_residual / 10.0);
    let message = format!(
        "the velocity on {} is {times:.4} times that of its own pose, in the same direction{}: divided by that it leaves {:.1} % of the \
         motion of the pose, as published {:.0} %",
        stream.topic,
        unit.map_or_else(String::new, |(_, word)| format!(", as in {word}")),
        100.0 * left,
        100.0 * twists.residual(Reading::Body)
    );
    let residual = Measured::new("residual, as defined", twists.residual(Reading::Body), "1").limit(limits.max_residual);
    let finding = Finding::error(subject, message, stream.place()).likely().relation("scale");
    stream
        .expressed_in
        .tell(finding)
        .help("publish metres per second (REP-103); or the position beside it is not in metres: compare a known distance")
        .measured(Measured::new("velocity over that of the pose", times, "1").samples(twists.windows))
        .measured(residual)
        .measured(Measured::new("distance", twists.distance_m, "m"))
}

/// Whether the motion shows that the orientation is no inverse one.
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
            "the pose turns {turned_deg:.0} deg within unbroken windows, {} deg are needed",
            limits.min_turn_deg
        );
        return out.too_little(&subject, why);
    }
    if turning.slope == 0.0 {
        let why = "the turning velocity is zero in every message, though the pose turns: it is not filled in";
        return out.missing(&subject, why);
    }
    let measured = Measured::new("yaw rate, over that of the pose", turning.slope, "1").samples(turning.windows);
    let near = |value: f64| (turning.slope / value - 1.0).abs() <= limits.turn_agrees;
    if near(1.0) {
        out.pass(&subject, [measured]);
    } else if turning.correlation.abs() < limits.max_correlation() {
        let why = format!(
            "the yaw rate does not follow the turning of the pose (correlation {:.2})",
            turning.correlation
        );
        out.too_little(&subject, why);
    } else if let Some(upper) = bound_that_reaches_one(turning.slope, turning.correlation, limits.turn_agrees) {
        let why = format!(
            "the yaw rate is {:.2} to {upper:.2} times what its own pose turns, by which of the two is noise",
            turning.slope
        );
        out.too_little(&subject, why);
    } else {
        let (words, help) = if near(-1.0) && is_confirmed {
            (
                "has the opposite sign",
                "publish the yaw rate counter-clockwise positive, z up (REP-103)",
            )
        } else if near(-1.0) {
            (
                "has the opposite sign, or it is the yaw of the orientation that grows clockwise, as that of the inverse one or of a \
                 compass heading (these data cannot tell which)",
                "publish the yaw rate counter-clockwise positive, z up (REP-103); or conjugate the quaternion (negate x, y and z); or \
                 publish `yaw_ros = pi/2 - heading`",
            )
        } else if near(1f64.to_degrees()) {
            ("is in degrees", "publish rad/s (REP-103)")
        } else {
            (
                "disagrees, or the orientation beside it is wrong",
                "publish rad/s about the child frame's z axis (REP-103)",
            )
        };
        let message = format!(
            "the yaw rate on {} {words}: {:.2} times what its own pose turns",
            stream.topic, turning.slope
        );
        let finding = stream
            .expressed_in
            .tell(Finding::error(&subject, message, stream.place()))
            .likely()
            .help(help)
            .measured(measured.limit(limits.turn_agrees))
            .measured(Measured::new("turned", turned_deg, "deg"));
        out.fail(cause.into_iter().fold(finding, Finding::same_cause_as));
    }
}
