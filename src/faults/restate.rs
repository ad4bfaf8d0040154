//! Makes a claim or an edge of TF state another transform, as if its file or its messages had other numbers.

use compact_str::format_compact;
use nalgebra::Isometry3;

use crate::math::relation::{Relation, Tolerance};
use crate::math::rotation::{is_near, to_rpy};
use crate::source::{Place, SourceValue, Span};
use crate::world::bag::TfEdge;
use crate::world::robot::{ConsumerOpinion, NumberList, Robot};
use crate::world::{Claim, ClaimKind, Literal, Pose, Spelling, World};

/// Makes a claim state this transform `target_from_source`; a joint changes with the description that it is of.
pub(super) fn restate_claim(world: &mut World, number: usize, pose: &Isometry3<f64>) {
    let Some(claim) = world.claims.get_mut(number) else {
        return;
    };
    let rpy: [f64; 3] = to_rpy(&pose.rotation).into();
    restate(claim, pose, rpy);
    let claim = claim.clone();
    restate_joint(world, &claim);
}

/// Scales the angles of a claim as they are written, and what a program reads of them. False where it has no angles.
pub(super) fn scale_angles(world: &mut World, number: usize, scale: fn(f64) -> f64) -> bool {
    let Some(claim) = world.claims.get_mut(number) else {
        return false;
    };
    let (Spelling::Rpy { rpy, .. }, Some(pose)) = (&claim.spelling, claim.pose) else {
        return false;
    };
    let rpy = rpy.map(scale);
    let [roll, pitch, yaw] = rpy;
    let mut read = pose.isometry();
    read.rotation = crate::math::rotation::from_rpy(roll, pitch, yaw);
    restate(claim, &read, rpy);
    let claim = claim.clone();
    restate_joint(world, &claim);
    true
}

/// Gives a claim other numbers as it is written, and the pose that is read of them; a joint changes with the description that it is of.
pub(super) fn respell_claim(world: &mut World, number: usize, spelling: Spelling, pose: Option<Pose>) {
    let Some(claim) = world.claims.get_mut(number) else {
        return;
    };
    let numbers = |spelling: &Spelling| match spelling {
        Spelling::Rpy { rpy, .. } => rpy.to_vec(),
        Spelling::Quaternion { xyzw, .. } => xyzw.to_vec(),
        Spelling::Matrix { values, .. } => values.clone(),
        Spelling::Translation { .. } => Vec::new(),
    };
    let (old, new) = (numbers(&claim.spelling), numbers(&spelling));
    rewrite(&mut claim.rotation_literals, &old, &new);
    if let (Some(old), Some(new)) = (&claim.pose, &pose) {
        rewrite(&mut claim.translation_literals, &old.translation_m, &new.translation_m);
    }
    (claim.spelling, claim.pose) = (spelling, pose);
    let claim = claim.clone();
    restate_joint(world, &claim);
}

/// Whether two transforms differ by nothing that any rule sees.
pub(super) fn is_same(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    is_near(a, b, [1e-6, 1e-6])
}

/// The relations that make one transform of another, seen from either of them and in either direction.
pub(super) fn relations_between(truth: &Isometry3<f64>, held: &Isometry3<f64>) -> Vec<&'static str> {
    let limits = Tolerance::default();
    let length_m = truth.translation.vector.norm().max(held.translation.vector.norm());
    let distance_m = limits.distance_m + limits.relative_distance * length_m;
    let makes = |relation: &Relation, from: &Isometry3<f64>, to: &Isometry3<f64>| {
        let made = relation.apply(from);
        made.is_some_and(|made| is_near(&made, to, [limits.angle_rad, distance_m]))
    };
    let turned = [truth.inverse(), held.inverse()];
    let fits = |relation: &&Relation| {
        makes(relation, truth, held)
            || makes(relation, held, truth)
            || makes(relation, &turned[0], &turned[1])
            || makes(relation, &turned[1], &turned[0])
    };
    let others = Relation::all().iter().skip(1);
    others.filter(fits).map(|relation| relation.word()).collect()
}

/// Makes every sample of a constant edge this transform `parent_from_child`.
pub(super) fn restate_edge(edge: &mut TfEdge, pose: &Isometry3<f64>) {
    let pose = Pose::from_isometry(pose);
    let extreme = edge.extreme.iter_mut().map(|(sample, ..)| sample);
    for sample in edge.samples.iter_mut().chain(extreme) {
        sample.pose = pose;
    }
}

fn restate(claim: &mut Claim, pose: &Isometry3<f64>, new_rpy: [f64; 3]) {
    let held = Pose::from_isometry(pose);
    let new_xyz = held.translation_m;
    if let Some(old) = claim.pose.replace(held) {
        rewrite(&mut claim.translation_literals, &old.translation_m, &new_xyz);
    }
    match &mut claim.spelling {
        Spelling::Rpy { xyz, rpy } => {
            rewrite(&mut claim.rotation_literals, rpy, &new_rpy);
            (*xyz, *rpy) = (new_xyz, new_rpy);
        }
        Spelling::Quaternion { xyz, xyzw, .. } => {
            rewrite(&mut claim.rotation_literals, xyzw, &held.rotation_xyzw);
            (*xyz, *xyzw) = (new_xyz, held.rotation_xyzw);
        }
        Spelling::Translation { xyz } => *xyz = new_xyz,
        Spelling::Matrix { cols, values, .. } => {
            let matrix = pose.to_homogeneous();
            let entry = |at: usize| matrix.get((at / *cols, at % *cols)).copied();
            let new: Vec<f64> = (0..values.len()).filter_map(entry).collect();
            rewrite(&mut claim.rotation_literals, values, &new);
            *values = new;
        }
    }
}

/// Gives the joint of a claim the numbers of the claim.
fn restate_joint(world: &mut World, claim: &Claim) {
    let ClaimKind::Joint { joint: name, .. } = &claim.kind else {
        return;
    };
    let of_file = |robot: &&mut Robot| robot.source == claim.place.source;
    for robot in world.robots.iter_mut().filter(of_file) {
        let (Spelling::Rpy { xyz, rpy }, true) = (&claim.spelling, claim.pose.is_some()) else {
            continue;
        };
        let joints = robot.joints.iter_mut().filter(|joint| joint.name.value == *name);
        for origin in joints.flat_map(|joint| &mut joint.origins) {
            for (attribute, list, new) in [("xyz", &mut origin.xyz, xyz), ("rpy", &mut origin.rpy, rpy)] {
                match list {
                    Some(NumberList { literals, .. }) => {
                        let old: Vec<f64> = literals.iter().map(|literal| literal.value).collect();
                        rewrite(literals, &old, new);
                    }
                    None if new.iter().any(|value| *value != 0.0) => {
                        *list = Some(written_list(attribute, new, &origin.place));
                    }
                    None => {}
                }
            }
        }
        if let ConsumerOpinion::Loads(joints) = &mut robot.consumer {
            for joint in joints.iter_mut().filter(|joint| joint.name == *name) {
                (joint.xyz, joint.rpy) = (*xyz, *rpy);
            }
        }
    }
}

/// An attribute that was not written; its place is that of the element.
fn written_list(attribute: &str, numbers: &[f64; 3], place: &Place) -> NumberList {
    let span = place.span().unwrap_or(Span::new(0, 0));
    let literal = |value: f64| Literal {
        text: format_compact!("{value}"),
        value,
        span,
    };
    let [x, y, z] = numbers;
    NumberList {
        attribute: attribute.into(),
        text: SourceValue::new(format_compact!("{x} {y} {z}"), place.clone()),
        literals: numbers.map(literal).into(),
        expected: 3,
        malformed: None,
    }
}

/// Gives literals new numbers, in the order and the unit of the old ones: quaternions may stand as w, x, y, z, angles in degrees, lengths in
/// millimetres or centimetres.
fn rewrite(literals: &mut [Literal], old: &[f64], new: &[f64]) {
    if literals.len() != old.len() || old.len() != new.len() {
        return;
    }
    for (unit, first) in [(1.0, 0), (1.0, 1), (1_f64.to_degrees(), 0), (1e3, 0), (1e2, 0)] {
        let as_written = |numbers: &[f64]| {
            let mut written: Vec<f64> = numbers.iter().map(|value| value * unit).collect();
            written.rotate_right(first);
            written
        };
        let mut pairs = literals.iter().zip(as_written(old));
        if pairs.all(|(literal, old)| (literal.value - old).abs() < 1e-9) {
            for (literal, value) in literals.iter_mut().zip(as_written(new)) {
                literal.value = value;
                literal.text = format_compact!("{value}");
            }
            return;
        }
    }
}
