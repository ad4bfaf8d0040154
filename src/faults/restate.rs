//! Statements of transforms, restated: a claim, the joint that it comes from, an edge of TF.
//!
//! Numbers change as their text would: spelling and literals follow the pose; places stay.

use nalgebra::{Isometry3, Matrix3};

use crate::math::relation::Relation;
use crate::math::rotation::to_rpy;
use crate::source::{Place, SourceId, SourceValue, Span};
use crate::world::bag::TfEdge;
use crate::world::robot::{ConsumerOpinion, NumberList, Origin};
use crate::world::{Claim, ClaimKind, Literal, Pose, Spelling, World};

/// Differences that no rule sees: metres, and radians.
const SAME: [f64; 2] = [1e-6, 1e-6];

/// Whether two transforms are the same.
pub(super) fn is_same(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    let apart_m = (a.translation.vector - b.translation.vector).norm();
    apart_m <= SAME[0] && a.rotation.angle_to(&b.rotation) <= SAME[1]
}

/// The relations that make what is held of the truth, or the truth of what is held.
pub(super) fn names_of(truth: &Isometry3<f64>, held: &Isometry3<f64>) -> Vec<&'static str> {
    let makes = |relation: &Relation, from: &Isometry3<f64>, to: &Isometry3<f64>| {
        relation.apply(from).is_some_and(|made| is_same(&made, to))
    };
    let relations = Relation::all().iter().filter(|relation| **relation != Relation::Equal);
    relations
        .filter(|relation| makes(relation, truth, held) || makes(relation, held, truth))
        .map(|relation| relation.word())
        .collect()
}

/// Publishes another pose on an edge that never changes. False where it has none, or the new one is the same.
pub(super) fn edge(edge: &mut TfEdge, change: impl Fn(&Isometry3<f64>) -> Option<Isometry3<f64>>) -> bool {
    let changed = |pose: &Pose| Some(Pose::from_isometry(&change(&pose.isometry())?));
    let mut has_changed = false;
    let extreme = edge.extreme.iter_mut().map(|(sample, ..)| sample);
    for sample in edge.samples.iter_mut().chain(extreme) {
        if let Some(pose) = changed(&sample.pose) {
            has_changed |= !is_same(&sample.pose.isometry(), &pose.isometry());
            sample.pose = pose;
        }
    }
    let first = edge.samples.first().map(|sample| sample.pose.isometry());
    if let (Some(first), Some((sample, angle_rad, distance_m))) = (first, &mut edge.extreme) {
        let other = sample.pose.isometry();
        *angle_rad = first.rotation.angle_to(&other.rotation);
        *distance_m = (other.translation.vector - first.translation.vector).norm();
    }
    has_changed
}

/// States another pose in a claim, and in the joint that it comes from. False where it states none, cannot state this one, or the new
/// one is the same.
pub(super) fn claim(
    world: &mut World,
    number: usize,
    change: impl Fn(&Isometry3<f64>) -> Option<Isometry3<f64>>,
) -> bool {
    let Some(claim) = world.claims.get_mut(number) else {
        return false;
    };
    let Some(old) = claim.pose.as_ref().map(Pose::isometry) else {
        return false;
    };
    let Some(mut new) = change(&old) else { return false };
    if !claim.has_translation {
        new.translation = old.translation;
    }
    if !claim.has_rotation {
        new.rotation = old.rotation;
    }
    if is_same(&old, &new) {
        return false;
    }
    let pose = Pose::from_isometry(&new);
    let spelling = spelled(&claim.spelling, &pose);
    respell(claim, spelling, Some(pose));
    joint(world, number);
    true
}

/// The spelling of a pose in the form of another.
fn spelled(form: &Spelling, pose: &Pose) -> Spelling {
    let isometry = pose.isometry();
    let xyz = pose.translation_m;
    match form {
        Spelling::Rpy { .. } => {
            let (roll, pitch, yaw) = to_rpy(&isometry.rotation);
            let rpy = [roll, pitch, yaw];
            Spelling::Rpy { xyz, rpy }
        }
        Spelling::Quaternion { xyzw, order_known, .. } => {
            // Of the two quaternions of a rotation, the one that is nearer to the old one.
            let along: f64 = xyzw.iter().zip(pose.rotation_xyzw).map(|(a, b)| a * b).sum();
            let sign = if along < 0.0 { -1.0 } else { 1.0 };
            Spelling::Quaternion {
                xyz,
                xyzw: pose.rotation_xyzw.map(|value| sign * value),
                order_known: *order_known,
            }
        }
        Spelling::Matrix { rows, cols, values } => {
            let rotation: Matrix3<f64> = isometry.rotation.to_rotation_matrix().into_inner();
            let number = |at: usize, old: f64| match (at / cols.max(&1), at % cols.max(&1)) {
                (row @ 0..3, col @ 0..3) => rotation.get((row, col)).copied().unwrap_or(old),
                (row @ 0..3, 3) => xyz.get(row).copied().unwrap_or(old),
                _ => old,
            };
            Spelling::Matrix {
                rows: *rows,
                cols: *cols,
                values: values.iter().enumerate().map(|(at, old)| number(at, *old)).collect(),
            }
        }
        Spelling::Translation { .. } => Spelling::Translation { xyz },
    }
}

/// Replaces the spelling of a claim, with its literals in the units of the file, and the pose that is read of it.
pub(super) fn respell(claim: &mut Claim, spelling: Spelling, pose: Option<Pose>) {
    let [old_xyz, old_turn] = parts(&claim.spelling);
    let [xyz, turn] = parts(&spelling);
    // A matrix of three columns has its translation beside it, and only the pose holds it in metres.
    let xyz = match (xyz.is_empty(), &pose) {
        (true, Some(pose)) => pose.translation_m.to_vec(),
        _ => xyz,
    };
    let old_xyz = match (old_xyz.is_empty(), &claim.pose) {
        (true, Some(pose)) => pose.translation_m.to_vec(),
        _ => old_xyz,
    };
    let metres = unit(&claim.translation_literals, &old_xyz);
    rewrite(&mut claim.translation_literals, &xyz, |_| metres);
    let is_matrix = matches!(spelling, Spelling::Matrix { cols: 4, .. });
    let angles = if matches!(spelling, Spelling::Rpy { .. }) {
        unit(&claim.rotation_literals, &old_turn)
    } else {
        1.0
    };
    rewrite(&mut claim.rotation_literals, &turn, |at| {
        if is_matrix && at % 4 == 3 && at < 12 {
            metres
        } else {
            angles
        }
    });
    claim.spelling = spelling;
    claim.pose = pose;
}

/// Translation and rotation of a spelling, as far as it has numbers for them; a matrix is all rotation, as its literals are.
fn parts(spelling: &Spelling) -> [Vec<f64>; 2] {
    match spelling {
        Spelling::Rpy { xyz, rpy } => [xyz.to_vec(), rpy.to_vec()],
        Spelling::Quaternion { xyz, xyzw, .. } => [xyz.to_vec(), xyzw.to_vec()],
        Spelling::Matrix { cols: 4, values, .. } => {
            let column = [3, 7, 11].map(|at| values.get(at).copied().unwrap_or(f64::NAN));
            [column.to_vec(), values.clone()]
        }
        Spelling::Matrix { values, .. } => [Vec::new(), values.clone()],
        Spelling::Translation { xyz } => [xyz.to_vec(), Vec::new()],
    }
}

/// What a number as written is multiplied by to give the number as read: that of the largest one.
fn unit(literals: &[Literal], read: &[f64]) -> f64 {
    let pairs = literals.iter().map(|literal| literal.value).zip(read.iter().copied());
    let largest = pairs
        .filter(|(written, _)| written.is_finite())
        .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let ratio = largest.map(|(written, read)| read / written);
    ratio.filter(|ratio| ratio.is_normal()).unwrap_or(1.0)
}

/// Writes numbers in the place of others.
fn rewrite(literals: &mut [Literal], numbers: &[f64], unit: impl Fn(usize) -> f64) {
    for (at, (literal, number)) in literals.iter_mut().zip(numbers).enumerate() {
        let written = number / unit(at);
        if (written - literal.value).abs() > 1e-12 * written.abs().max(1e-3) || written.is_nan() {
            literal.value = written;
            literal.text = written.to_string().into();
        }
    }
}

/// Writes the numbers of a joint's claim into the joint, as its other reader reads them, too.
pub(super) fn joint(world: &mut World, number: usize) {
    let World { claims, robots, .. } = world;
    let Some(claim) = claims.get_mut(number) else { return };
    let ClaimKind::Joint {
        joint: name,
        has_origin,
        ..
    } = &mut claim.kind
    else {
        return;
    };
    *has_origin = true;
    let source = claim.place.source;
    let Some(robot) = robots.iter_mut().find(|robot| robot.source == source) else {
        return;
    };
    let Some(joint) = robot.joints.iter_mut().find(|joint| joint.name.value == *name) else {
        return;
    };
    if joint.origins.is_empty() {
        joint.origins.push(Origin {
            place: claim.place.clone(),
            xyz: None,
            rpy: None,
            quat_xyzw: None,
        });
    }
    let Some(origin) = joint.origins.first_mut() else {
        return;
    };
    let (attribute, old, numbers) = match &claim.spelling {
        Spelling::Quaternion { xyz, xyzw, .. } => ("quat_xyzw", &mut origin.quat_xyzw, [xyz.to_vec(), xyzw.to_vec()]),
        Spelling::Rpy { xyz, rpy } => ("rpy", &mut origin.rpy, [xyz.to_vec(), rpy.to_vec()]),
        _ => return,
    };
    let [xyz, turn] = numbers;
    write_list(&mut origin.xyz, "xyz", &xyz, &claim.place);
    write_list(old, attribute, &turn, &claim.place);
    let literals = |list: &Option<NumberList>| list.as_ref().map_or_else(Vec::new, |list| list.literals.clone());
    claim.translation_literals = literals(&origin.xyz);
    claim.rotation_literals = literals(old);
    if let ConsumerOpinion::Loads(read) = &mut robot.consumer
        && let Some(read) = read.iter_mut().find(|read| read.name == *name)
        && let Some(pose) = &claim.pose
    {
        let (roll, pitch, yaw) = to_rpy(&pose.isometry().rotation);
        read.xyz = pose.translation_m;
        read.rpy = match &claim.spelling {
            Spelling::Rpy { rpy, .. } => *rpy,
            _ => [roll, pitch, yaw],
        };
    }
}

/// Writes numbers into an attribute; one that is not there, and would hold zeros alone, stays so.
fn write_list(list: &mut Option<NumberList>, attribute: &str, numbers: &[f64], place: &Place) {
    if list.is_none() && numbers.iter().all(|number| *number == 0.0) {
        return;
    }
    let (source, span) = (place.source, place.span().unwrap_or(Span::new(0, 0)));
    let list = list.get_or_insert_with(|| empty_list(attribute, source, span, numbers.len()));
    let spans: Vec<Span> = list.literals.iter().map(|literal| literal.span).collect();
    list.literals = numbers
        .iter()
        .enumerate()
        .map(|(at, number)| Literal {
            text: number.to_string().into(),
            value: *number,
            span: spans.get(at).copied().unwrap_or(span),
        })
        .collect();
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    list.text.value = words.join(" ").into();
    list.malformed = None;
}

fn empty_list(attribute: &str, source: SourceId, span: Span, expected: usize) -> NumberList {
    NumberList {
        attribute: attribute.into(),
        text: SourceValue {
            value: "".into(),
            place: Place::text(source, span),
        },
        literals: Vec::new(),
        expected,
        malformed: None,
    }
}
