//! CROSS02: two sources state one transform, and a known convention error explains the difference.

use nalgebra::Isometry3;

use crate::advice::{literal::with_fix, places::swap_edits, restate::restated};
use crate::analysis::cross::blame::{blame, holds_radians_twice};
use crate::analysis::cross::exact::{Limits, SharedRelations, off_axes_deg};
use crate::analysis::cross::exchange::exchanged;
use crate::analysis::cross::notation::KeyNotations;
use crate::analysis::cross::pair::{Direction, Pair, Statement, TURNED};
use crate::analysis::cross::statements::pairs;
use crate::math::relation::{Classification, Relation, Tolerance, classify};
use crate::math::rotation::{from_rpy, rotation_angle_between};
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::verdict::{Edit, Safety};
use crate::world::{Claim, World};

pub(crate) struct ExtrinsicRelation;

impl Rule for ExtrinsicRelation {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut alike = SharedRelations::default();
        let mut blamed: Vec<(String, Pair, Classification)> = Vec::new();
        let pairs = pairs(world, out);
        let notations = KeyNotations::of(&pairs);
        for mut pair in pairs {
            notations.confirm(&mut pair);
            let subject = pair.subject(world);
            let found = blame(&mut pair, limits.mount_m);
            if let Some(relation) = found.error() {
                alike.add(limits, &pair, relation);
            }
            blamed.push((subject, pair, found));
        }
        let within = [limits.exact_deg.to_radians(), limits.exact_m];
        let exchanged = exchanged(blamed.iter().map(|(_, pair, _)| pair), within);
        for (index, (subject, pair, found)) in blamed.iter().enumerate() {
            if let Some((with, (_, other, _))) = exchanged.get(&index).and_then(|at| Some((at, blamed.get(*at)?))) {
                // One finding for both.
                if index < *with {
                    out.fail(exchange(subject, pair, other, found));
                }
                continue;
            }
            let is_sure = found.error().is_some_and(|relation| {
                limits.fits(&pair.reference.pose, found) || alike.count(pair, relation) >= limits.min_sensors
            });
            judge_pair(world, subject.clone(), pair, found, is_sure, limits, out);
        }
    }
}

/// The finding of two transforms of one source that each have the numbers of the other.
fn exchange(subject: &str, pair: &Pair, with: &Pair, found: &Classification) -> Finding {
    let [a, b] = [pair, with].map(|one| one.other.who.replace(TURNED, ""));
    let [right_a, right_b] = [pair, with].map(|one| one.reference.who.replace(TURNED, ""));
    let mut detail = format!("{a} has the transform of {right_b}, and {b} has the transform of {right_a}.");
    if found.class.contains(&Relation::MirroredY) {
        detail = format!("{detail} Or both are mirrored left to right (y, roll and yaw negated).");
    }
    let message = format!("the transforms of {a} and {b} are exchanged");
    let reference = &pair.reference;
    let (target, source) = (reference.target.to_string(), reference.source_frame.to_string());
    let finding = Finding::error(subject, message, pair.other.place.clone())
        .likely()
        .prefers(target, source, reference.pose)
        .relation("exchanged")
        .detail(detail)
        .help(format!(
            "exchange the numbers of {a} and {b}; if {right_a} and {right_b} are exchanged instead, correct these"
        ))
        .measured(Measured::new("rotation difference", found.angle_rad.to_degrees(), "deg").turn())
        .measured(Measured::new("translation difference", found.distance_m, "m"));
    pair.point_at_all(finding)
        .confidence(with.reading())
        .related(with.other.place.clone(), format!("stated by {b}"))
        .related(with.reference.place.clone(), format!("stated by {right_b}"))
}

fn judge_pair(
    world: &World,
    subject: String,
    pair: &Pair,
    found: &Classification,
    is_sure: bool,
    limits: &Limits,
    out: &mut Judge,
) {
    if let Some(why) = &pair.repeats {
        return out.not_applicable(subject, why);
    }
    let (angle_deg, distance_m) = (found.angle_rad.to_degrees(), found.distance_m);
    let rotation =
        Measured::new("rotation difference", angle_deg, "deg").limit(Tolerance::default().angle_rad.to_degrees());
    // Another convention is no error by an angle.
    let is_explained = found.best.is_some_and(|best| best != Relation::Equal);
    let difference = [
        if is_explained { rotation } else { rotation.turn() },
        Measured::new("translation difference", distance_m, "m").limit(Tolerance::default().distance_m),
    ];
    match found.best {
        Some(Relation::Equal) => out.pass(subject, difference),
        None => {
            let why = format!(
                "they differ by {angle_deg:.2} deg and {distance_m:.3} m, and no known convention error explains that"
            );
            out.not_applicable(subject, why);
        }
        Some(_) if pair.alternatives && !distinctive(pair, limits) => {
            let why = "the same key in two files of a folder, and rotations along the axes: may be two devices";
            out.too_little(subject, why);
        }
        Some(_) => {
            let found = &admitted(world, pair, found, limits);
            let relation = found.error().unwrap_or(Relation::Equal);
            let right = relation.reversed().and_then(|back| back.apply(&pair.other.pose));
            let (target, source) = (
                pair.reference.target.to_string(),
                pair.reference.source_frame.to_string(),
            );
            let wants = if contradicts_itself(world, pair) {
                ". The key and the frames stated beside the numbers contradict each other: correct the wrong one"
            } else {
                publisher_wants(world, pair, relation)
            };
            let finding = finding(world, pair, subject, (relation, wants), found, difference).unless(codes::QUAT03);
            let roles = if is_sure { Confidence::Likely } else { Confidence::Hint };
            let finding = pair.point_at_all_with(finding, roles);
            let finding = finding.prefers(target, source, right.unwrap_or(pair.reference.pose));
            let title = format!("undo the error ({})", relation.word());
            let edits = corrected(world, pair, relation, found);
            out.fail(with_fix(finding, &title, Safety::ChangesBehaviour, edits));
        }
    }
}

fn finding(
    world: &World,
    pair: &Pair,
    subject: String,
    (relation, wants): (Relation, &str),
    found: &Classification,
    difference: [Measured; 2],
) -> Finding {
    let mut names = pair.names(world);
    if relation == Relation::Inverse {
        // As stated, since the error is the direction.
        names = names.map(|name| name.replace(TURNED, ""));
    }
    let [other, reference] = names;
    let is_exchanged = relation == Relation::Inverse && pair.other.direction != pair.reference.direction;
    let (message, what) = if is_exchanged {
        let [a, b] = [&pair.other, &pair.reference].map(stated_edge);
        (
            format!("{other} has the numbers of {reference}, but with parent and child exchanged"),
            format!("{other} states {a}, and {reference} states {b}. With parent and child of {other} exchanged"),
        )
    } else {
        (
            format!("{other} {}", relation.relates_to(&reference)),
            format!(
                "{} If {reference} is right, this is the error in {other}. {} With this error undone",
                pair.frames_stated(),
                relation.describe_beside(&pair.reference.pose.rotation)
            ),
        )
    };
    let mut detail = format!(
        "{what}, the two differ by {:.2} deg and {:.3} m.",
        found.residual_angle_rad.to_degrees(),
        found.residual_m
    );
    if [&other, &reference].iter().any(|name| name.contains(TURNED)) {
        detail = format!("{detail} A transform marked \"(inverted)\" is stated in the opposite direction.");
    }
    let also: Vec<&str> = found.class.iter().skip(1).map(|other| other.word()).collect();
    if !also.is_empty() {
        detail = format!(
            "{detail} Other known errors that explain the difference as well: {}.",
            also.join(", ")
        );
    }
    if relation == Relation::Degrees && holds_radians_twice(pair) {
        detail = format!("{detail} Or {reference} is wrong: its radians were converted once more.");
    }
    if pair.is_by_role() {
        detail = format!(
            "{detail} Assumes that {}, by the names that programs use for their sensors.",
            pair.taken()
        );
    }
    let step = match relation {
        Relation::Inverse => {
            let verb = if is_exchanged {
                "exchange the two frames of"
            } else {
                "invert"
            };
            format!("if {reference} is right, {verb} {other}; if {other} is right, invert {reference}")
        }
        _ => "find out which of the two describes the robot, and correct the other".to_owned(),
    };
    let help = format!("{step}{wants}{}", same_cause(relation));
    let [rotation, translation] = difference;
    Finding::error(subject, message, pair.other.place.clone())
        .detail(detail)
        .help(help)
        .relation(relation.word())
        .measured(rotation)
        .measured(translation)
        .measured(Measured::new(
            "rotation difference with the error undone",
            without_noise(found.residual_angle_rad.to_degrees()),
            "deg",
        ))
        .measured(Measured::new(
            "translation difference with the error undone",
            without_noise(found.residual_m),
            "m",
        ))
        .measured(Measured::count("known errors that explain it", found.class.len()))
}

/// The edge that a statement states, before it was inverted for the comparison.
fn stated_edge(one: &Statement) -> String {
    match one.direction {
        Direction::AsStated => format!("`{}` -> `{}`", one.target, one.source_frame),
        Direction::TurnedRound => format!("`{}` -> `{}`", one.source_frame, one.target),
    }
}

/// The rule that may report the same fault from one source alone.
fn same_cause(relation: Relation) -> String {
    let (rule, what) = match relation {
        Relation::Degrees => (codes::ROT08, "the same numbers"),
        Relation::Millimetres => (codes::ROT06, "the same numbers"),
        Relation::RotationLost | Relation::Optical | Relation::OpticalInverse => (codes::NAME06, "the same frame"),
        _ => return String::new(),
    };
    format!(". If {rule} reports {what}, it is the same fault")
}

/// The relations that still fit, given how the statement is written and how many digits it has.
fn admitted(world: &World, pair: &Pair, found: &Classification, limits: &Limits) -> Classification {
    let mut found = found.clone();
    let claim = pair.other.claim(world);
    // In a launch file that has the edge inverted the two frames are exchanged.
    let is_swapped = pair.other.direction == Direction::TurnedRound && claim.is_some_and(Claim::is_published);
    let has_angles = claim.is_some_and(|claim| claim.rotation_literals.len() == 3);
    let residual = |relation: Relation| {
        let predicted = relation.apply(&pair.reference.pose)?;
        Some(apart(&predicted, &pair.other.pose))
    };
    let fits_digits = |relation: Relation| {
        residual(relation).is_some_and(|(rad, m)| m <= limits.exact_m && rad.to_degrees() <= limits.exact_deg)
    };
    let class = found.class.clone();
    let mut keep = |test: &dyn Fn(Relation) -> bool| {
        if found.class.iter().any(|relation| test(*relation)) {
            found.class.retain(|relation| test(*relation));
        }
    };
    keep(&|relation| !has_angles || !matches!(relation, Relation::Wxyz | Relation::Xyzw));
    if class.iter().any(|relation| fits_digits(*relation)) {
        keep(&fits_digits);
    }
    if is_swapped {
        keep(&|relation| relation == Relation::Inverse);
    }
    let best = found.class.first().copied().filter(|best| Some(*best) != found.best);
    if let Some((best, (rad, m))) = best.and_then(|best| Some((best, residual(best)?))) {
        found.best = Some(best);
        (found.residual_angle_rad, found.residual_m) = (rad, m);
    }
    found
}

/// The angle between two transforms and the distance, radians and metres.
fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> (f64, f64) {
    let distance_m = (a.translation.vector - b.translation.vector).norm();
    (rotation_angle_between(&a.rotation, &b.rotation), distance_m)
}

/// Whether the numbers of the statement are also read as another transform: its key contradicts the frames beside it.
fn contradicts_itself(world: &World, pair: &Pair) -> bool {
    let Some(own) = pair.other.claim(world) else {
        return false;
    };
    let spans = |claim: &Claim| {
        claim
            .rotation_literals
            .iter()
            .map(|literal| literal.span)
            .collect::<Vec<_>>()
    };
    let own_spans = spans(own);
    world.claims.iter().any(|other| {
        let is_other = other.place.source == own.place.source && other.frames != own.frames;
        is_other && !own_spans.is_empty() && spans(other) == own_spans
    })
}

/// The edits that undo the error in the numbers that hold it. They keep their own digits: a calibration is finer than a drawing. `None`
/// where more than one error explains the difference, where one of the two is a guess, or where the error can't be undone.
fn corrected(world: &World, pair: &Pair, relation: Relation, found: &Classification) -> Option<Vec<Edit>> {
    let is_guess = pair.reading() < Confidence::Certain || contradicts_itself(world, pair);
    if is_guess || !found.class.iter().all(|other| is_undone_alike(pair, relation, *other)) {
        return None;
    }
    let right = &pair.reference.pose;
    let mut corrected = match (relation.reversed(), pair.other.rpy, pair.other.direction) {
        (Some(back), ..) => back.apply(&pair.other.pose)?,
        (None, Some([roll, pitch, yaw]), Direction::AsStated) if relation == Relation::Degrees => {
            let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_radians);
            Isometry3::from_parts(pair.other.pose.translation, from_rpy(roll, pitch, yaw))
        }
        _ => return None,
    };
    let left = classify(right, &corrected, &Tolerance::default());
    if left.best != Some(Relation::Equal) {
        return None;
    }
    let claim = pair.other.claim(world)?;
    if pair.other.direction == Direction::TurnedRound {
        corrected = corrected.inverse();
        // A launch file with the inverted edge: its two frames are exchanged, the numbers are right.
        if claim.is_published() && relation == Relation::Inverse {
            return swap_edits(world, claim.target_place.as_ref()?, claim.source_place.as_ref()?);
        }
    }
    restated(world, claim, &corrected)
}

/// Whether the two relations, undone, give one transform: without a rotation the inverse is the negated translation.
fn is_undone_alike(pair: &Pair, relation: Relation, other: Relation) -> bool {
    let undone = |relation: Relation| relation.reversed()?.apply(&pair.other.pose);
    relation == other
        || undone(relation).zip(undone(other)).is_some_and(|(a, b)| {
            let (rad, m) = apart(&a, &b);
            rad < 1e-6 && m < 1e-6
        })
}

/// The order of arguments of the program that publishes it, where that order was not kept.
fn publisher_wants(world: &World, pair: &Pair, relation: Relation) -> &'static str {
    let wants = match relation {
        Relation::Ypr => ": static_transform_publisher reads x y z yaw pitch roll parent child",
        Relation::Inverse if pair.other.direction == Direction::TurnedRound => {
            "; static_transform_publisher reads the parent first, then the child"
        }
        _ => return "",
    };
    if pair.other.claim(world).is_some_and(Claim::is_published) {
        wants
    } else {
        ""
    }
}

/// Whether a rotation is well off the axes, so that two devices would not be related by chance.
fn distinctive(pair: &Pair, limits: &Limits) -> bool {
    let pose = &pair.reference.pose;
    off_axes_deg(pose) >= limits.alternatives_turn_deg && pose.translation.vector.norm() > 0.05
}

/// Residuals of floating point differ between machines: below a millionth they are zero.
fn without_noise(residual: f64) -> f64 {
    if residual < 1e-6 { 0.0 } else { residual }
}
