//! The source and the age of an edge, in words.

use std::collections::BTreeSet;

use crate::run::Run;
use crate::world::graph::EdgeOrigin;
use crate::world::tf2::{Factor, SampleOrigin, namespaces};
use crate::world::{Claim, ClaimKind, World};

use super::super::text::{one_line, trimmed};
use super::Names;

/// The worlds of a run with the namespaces of their TF; `/` if nothing was recorded.
pub(super) fn rooms(run: &Run) -> Vec<(&World, &str)> {
    let mut rooms = Vec::new();
    for world in super::worlds(run) {
        let mut of: BTreeSet<&str> = world.bags.iter().flat_map(namespaces).collect();
        if of.is_empty() {
            of.insert("/");
        }
        rooms.extend(of.into_iter().map(|namespace| (world, namespace)));
    }
    rooms
}

/// `drive.mcap /tf`, `robot.urdf:12 joint lidar_joint (fixed)`.
pub(super) fn who(world: &World, origins: &[EdgeOrigin], factor: &Factor, names: &Names<'_>) -> String {
    let said = match origins.get(factor.tags.0) {
        Some(EdgeOrigin::Tf(bag, edge)) => world.bags.get(*bag).and_then(|bag| {
            let edge = bag.tf.get(*edge)?;
            Some(format!("{} {}", names.name(bag.source), edge.topic))
        }),
        Some(EdgeOrigin::Joint(claim) | EdgeOrigin::Published(claim)) => {
            world.claims.get(*claim).map(|claim| match &claim.kind {
                ClaimKind::Joint { joint, fixed, .. } => {
                    let kind = if *fixed { "fixed" } else { "at zero" };
                    format!("{} joint {joint} ({kind})", names.line(&claim.place))
                }
                ClaimKind::File { .. } => format!("{} {} (published)", names.line(&claim.place), claim.label),
            })
        }
        None => None,
    };
    one_line(&said.unwrap_or_default())
}

/// How many transforms of an edge were kept, and of how many, if a value was interpolated across dropped ones.
pub(super) fn thinned(world: &World, origins: &[EdgeOrigin], factor: &Factor) -> Option<(usize, u64)> {
    let SampleOrigin::Between(..) = factor.made_from else {
        return None;
    };
    let (_, edge) = origins.get(factor.tags.0)?.recorded(world)?;
    (edge.count > edge.samples.len() as u64).then_some((edge.samples.len(), edge.count))
}

/// The number of other launch file statements that place the child of a published edge elsewhere: which one is started is unknown.
pub(super) fn rivals(world: &World, origins: &[EdgeOrigin], factor: &Factor) -> usize {
    let Some(EdgeOrigin::Published(index)) = origins.get(factor.tags.0) else {
        return 0;
    };
    let child = |claim: &Claim| Some(claim.frames.as_ref()?.1.canonical());
    let Some(used) = world.claims.get(*index) else { return 0 };
    let others = world
        .claims
        .iter()
        .filter(|claim| claim.is_published() && child(claim) == child(used));
    others
        .filter(|claim| (&claim.frames, &claim.pose) != (&used.frames, &used.pose))
        .count()
}

/// `static`, `0.02 s old`, `0.01 s after a sample, 0.01 s before the next`.
pub(super) fn age(made_from: SampleOrigin, stamp_ns: i64) -> String {
    match made_from {
        SampleOrigin::Static => "static".to_owned(),
        SampleOrigin::Sample(at) if at == stamp_ns || stamp_ns == 0 => "a sample at this timestamp".to_owned(),
        SampleOrigin::Sample(at) => format!(
            "{} s old: the parent changes afterwards",
            seconds(stamp_ns.saturating_sub(at))
        ),
        SampleOrigin::Between(before, after) => format!(
            "{} s after a sample, {} s before the next",
            seconds(stamp_ns.saturating_sub(before)),
            seconds(after.saturating_sub(stamp_ns))
        ),
    }
}

/// A duration, to a tenth of a millisecond.
pub(super) fn seconds(ns: i64) -> String {
    trimmed(&format!("{:.4}", ns as f64 / 1e9))
}
