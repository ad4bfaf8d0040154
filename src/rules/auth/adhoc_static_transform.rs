//! AUTH03: latched transforms that are in no URDF and no calibration file.

use std::collections::BTreeSet;

use crate::analysis::{names, tf};
use crate::rules::prelude::*;
use crate::tables::Tables;
use crate::world::{BagEvidence, ClaimKind, FrameId, World, bag::TfEdge};

pub(crate) struct AdhocStaticTransform;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_edges: f64,
}

impl Rule for AdhocStaticTransform {
    const NEEDS: &'static [Need] = &[Need::Robot, Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let links = links(world);
        let stated = stated(world);
        for bag in &world.bags {
            judge_bag(world, bag, (&links, &stated), limits, out);
        }
    }
}

/// The links of every robot that could be read whole.
fn links(world: &World) -> BTreeSet<FrameId> {
    let whole = world.robots.iter().filter(|robot| robot.fragment.is_none());
    let names = whole.flat_map(|robot| &robot.links).map(|link| &link.name.value);
    names.map(|name| FrameId::new(name).canonical()).collect()
}

/// Frames that calibration files state a transform of, in either direction.
fn stated(world: &World) -> BTreeSet<FrameId> {
    let claims = world.claims.iter();
    claims
        .filter(|claim| matches!(claim.kind, ClaimKind::File { .. }))
        .filter_map(|claim| claim.frames.as_ref())
        .flat_map(|(target, source)| [target.canonical(), source.canonical()])
        .collect()
}

fn judge_bag(
    world: &World,
    bag: &BagEvidence,
    (links, stated): (&BTreeSet<FrameId>, &BTreeSet<FrameId>),
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = format!("latched transforms of {}", world.path(bag.source));
    let latched: Vec<&TfEdge> = bag.tf.iter().filter(|edge| edge.is_static).collect();
    if latched.is_empty() {
        return out.missing(subject, "no latched transforms: record `/tf_static`");
    }
    if tf::frames(bag).is_disjoint(links) {
        let why = "no frame of TF is a link of the URDF, which describes another robot";
        return out.missing(subject, why);
    }
    // Only children of the robot's own links; frames below these move with them.
    let adhoc: Vec<&TfEdge> = latched
        .iter()
        .copied()
        .filter(|edge| links.contains(&edge.parent.canonical()) && !is_stated(edge, links, stated, &world.tables))
        .collect();
    let measured = Measured::count("latched transforms that no file states", adhoc.len()).limit(limits.max_edges);
    let measured = measured.samples(latched.len() as u64);
    if adhoc.len() as f64 <= limits.max_edges {
        out.pass(subject, [measured]);
    } else if let Some(finding) = finding(bag, subject, &adhoc) {
        out.fail(finding.measured(measured));
    }
}

/// Whether the edge has a source: the URDF, a calibration file, a driver inside its device, or the map.
fn is_stated(edge: &TfEdge, links: &BTreeSet<FrameId>, stated: &BTreeSet<FrameId>, tables: &Tables) -> bool {
    let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
    links.contains(&child)
        || stated.contains(&child)
        || names::is_world(&parent)
        || names::is_world(&child)
        || tables.driver_of_edge(parent.as_str(), child.as_str()).is_some()
}

/// Frames of sensor data matter; others may serve planning or display.
fn finding(bag: &BagEvidence, subject: String, adhoc: &[&TfEdge]) -> Option<Finding> {
    let mut carried: Vec<FrameId> = tf::sensor_frames(bag).map(|(frame, ..)| frame).collect();
    carried.retain(|frame| adhoc.iter().any(|edge| edge.child.canonical() == *frame));
    let first = adhoc
        .iter()
        .find(|edge| carried.contains(&edge.child.canonical()))
        .or_else(|| adhoc.first())?;
    let place = |edge: &TfEdge| Place::message(bag.source, edge.first_at.clone());
    let words = |edge: &TfEdge| format!("`{}` -> `{}`", edge.parent, edge.child);
    let (which, what) = match adhoc.len() {
        1 => (format!("{} on `{}` is", words(first), first.topic), "this transform"),
        n => (format!("{n} latched transforms of the robot are"), "these transforms"),
    };
    let message = format!("{which} in no URDF and no calibration file");
    let help = format!("write {what} into the URDF, or into a calibration file whose loader publishes {what}");
    let finding = Finding::new(Severity::Note, subject, message, place(first));
    let mut finding = finding.likely().label(words(first)).help(help);
    if adhoc.len() > 1 {
        let children: BTreeSet<FrameId> = adhoc.iter().map(|edge| edge.child.canonical()).collect();
        finding = finding.detail(format!("Child frames: {}.", tf::listed(&children)));
    }
    if let Some(frame) = carried.first() {
        finding.severity = Severity::Warning;
        finding = finding.detail(format!("Sensor data are expressed in `{frame}`."));
    }
    for edge in adhoc.iter().filter(|edge| edge.child != first.child).take(3) {
        finding = finding.related(place(edge), words(edge));
    }
    Some(finding)
}
