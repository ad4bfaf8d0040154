//! Poses of frames from other sources, with the difference; poses corrected by rules; and frames that no transform leads to.

use std::collections::BTreeSet;

use nalgebra::{Isometry3, Vector3};

use crate::source::SourceId;
use crate::verdict::Finding;
use crate::world::{Claim, ClaimKind, FrameId, World};

use super::placed::{FrameEntities, OF_LABELS, axis, label_at};
use super::scene::{Color, Content, Lines, Path, Scene, narrow};

/// Smaller differences are not shown: those of TREE11's rounding.
const SAME_DEG: f64 = 0.05;
const SAME_M: f64 = 1e-3;

pub(super) const OF_PREFERRED: Color = [110, 220, 130];
const OF_DIFFERENCES: Color = [235, 60, 60];

/// The same frame as another source states it, and its difference from the shown pose.
pub(super) fn beside(
    main: Option<Isometry3<f64>>,
    (other, said_by): (Option<Isometry3<f64>>, String),
    (frame, parent): (&FrameId, &Path),
    size_m: f32,
    scene: &mut Scene,
) {
    let Some(other) = other else { return };
    let own = parent.then(format!("{frame} by {said_by}"));
    scene.always(&own, Content::Pose(other));
    scene.always(&own, Content::Axes(size_m * 0.7));
    let apart = main.map(|main| main.inverse() * other);
    let differs = apart.map(|apart| (apart.rotation.angle().to_degrees(), apart.translation.vector.norm()));
    if differs.is_some_and(|(deg, m)| deg <= SAME_DEG && m <= SAME_M) {
        // The name of the frame is shown there already.
        return;
    }
    let label = format!("{frame} by {said_by}");
    scene.always(&own, label_at(&axis(1, size_m * 0.7), label, size_m, OF_LABELS));
    let Some((main, (deg, m))) = main.zip(differs) else {
        return;
    };
    // A pure rotation has no length: it is shown by the displacement of a point in front of the frame.
    let reach = Vector3::x() * f64::from(size_m);
    let tip = |pose: &Isometry3<f64>| narrow(&(pose.translation.vector + pose.rotation * reach));
    let (origin, others) = (narrow(&main.translation.vector), narrow(&other.translation.vector));
    scene.always(
        &own.then("~ difference"),
        // In the frame of the other source itself.
        Content::Lines(Lines {
            strips_m: [[origin, others], [tip(&main), tip(&other)]]
                .into_iter()
                .map(|ends| ends.map(|end| inside(&other, end)).to_vec())
                .collect(),
            color: OF_DIFFERENCES,
            radius: size_m / 30.0,
            labels: vec![format!("{deg:.2} deg, {m:.3} m apart"), String::new()],
        }),
    );
}

fn inside(parent_from_own: &Isometry3<f64>, in_parent: [f32; 3]) -> [f32; 3] {
    let point = nalgebra::Point3::from(in_parent.map(f64::from));
    narrow(&parent_from_own.inverse_transform_point(&point).coords)
}

/// Transforms of calibration files, of frames in the tree and others.
pub(super) fn claims(
    placed: &mut FrameEntities,
    findings: &[&Finding],
    (top, aside_m): (&Path, &mut f64),
    scene: &mut Scene,
) {
    let world = placed.world();
    let of_file = |claim: &&Claim| matches!(claim.kind, ClaimKind::File { .. });
    for claim in world.claims.iter().filter(of_file) {
        let (Some((target, source)), Some(pose)) = (&claim.frames, &claim.pose) else {
            continue;
        };
        let (target, source, pose) = (target.canonical(), source.canonical(), pose.isometry());
        let said_by = name(world, claim.place.source);
        let known = (placed.path(&target).cloned(), placed.path(&source).cloned());
        let (parent, frame, stated) = match known {
            (Some(path), _) => (path, source.clone(), pose),
            (None, Some(path)) => (path, target.clone(), pose.inverse()),
            (None, None) => {
                *aside_m += 2.0;
                let path = top.then(target.as_str());
                let why = format!("{said_by}; not in the tree");
                placed.stand_apart(&target, (&path, *aside_m), &why, findings, scene);
                (path, source.clone(), pose)
            }
        };
        let other_end = if frame == source { &target } else { &source };
        let chain = world.graph().chain(other_end, &frame, |edge| edge.is_rigid);
        let main = chain.map(|(pose, _)| pose);
        let own = parent.then(format!("{frame} by {said_by}"));
        beside(main, (Some(stated), said_by), (&frame, &parent), placed.size_m, scene);
        if placed.path(&frame).is_none() {
            let root = placed.root(other_end).cloned().unwrap_or_else(|| other_end.clone());
            placed.put(&frame, &own, &root);
        }
    }
}

/// Poses of frames corrected by rules.
pub(super) fn preferred(placed: &mut FrameEntities, findings: &[&Finding], scene: &mut Scene) {
    for finding in findings {
        let Some(prefers) = &finding.prefers else { continue };
        let Some(parent) = placed.path(&FrameId::new(prefers.target.as_str())).cloned() else {
            continue;
        };
        let label = format!("{} as {} corrects it", prefers.source, finding.rule);
        let own = parent.then(label.clone());
        scene.always(&own, Content::Pose(prefers.pose));
        scene.always(&own, Content::Axes(placed.size_m * 0.7));
        scene.always(
            &own,
            label_at(&axis(2, placed.size_m * 0.7), label, placed.size_m, OF_PREFERRED),
        );
        let frame = FrameId::new(prefers.source.as_str()).canonical();
        placed.candidates.push((frame, own));
    }
}

/// Frames that only headers of messages name: their poses are unknown.
pub(super) fn of_messages(
    placed: &mut FrameEntities,
    findings: &[&Finding],
    (top, aside_m): (&Path, f64),
    scene: &mut Scene,
) {
    let topics = placed.world().bags.iter().flat_map(|bag| bag.topics.values());
    let named: BTreeSet<FrameId> = topics
        .flat_map(|topic| {
            topic
                .contents()
                .flat_map(|said| said.header_frames.keys())
                .collect::<Vec<_>>()
        })
        .map(FrameId::canonical)
        .filter(|frame| !frame.as_str().is_empty())
        .collect();
    let lost = named.into_iter().filter(|frame| placed.path(frame).is_none());
    for (number, frame) in lost.collect::<Vec<_>>().into_iter().enumerate() {
        let path = top.then(frame.as_str());
        let aside_m = aside_m + 2.0 * (number as f64 + 1.0);
        let why = "named by messages; no transform leads to it";
        placed.stand_apart(&frame, (&path, aside_m), why, findings, scene);
    }
}

/// The last part of a source's path.
pub(super) fn name(world: &World, id: SourceId) -> String {
    let path = world.source(id).map_or("", |source| source.path.as_str());
    let path = path.strip_suffix("/metadata.yaml").unwrap_or(path);
    path.rsplit('/').next().unwrap_or(path).to_owned()
}
