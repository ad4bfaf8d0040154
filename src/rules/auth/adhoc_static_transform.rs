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
    whole
        .flat_map(|robot| &robot.links)
        .map(|link| FrameId::new(&link.name.value).canonical())
        .collect()
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
    let measured = Measured::count("latched transforms without a source", adhoc.len()).limit(limits.max_edges);
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
    let children: BTreeSet<FrameId> = adhoc.iter().map(|edge| edge.child.canonical()).collect();
    let (severity, used) = match carried.first() {
        Some(frame) => (Severity::Warning, format!(" Sensor data are expressed in `{frame}`.")),
        None => (Severity::Note, String::new()),
    };
    let message = match adhoc.len() {
        1 => "1 latched transform of the robot is in no URDF and no calibration file".to_owned(),
        n => format!("{n} latched transforms of the robot are in no URDF and no calibration file"),
    };
    let detail = format!("Child frames: {}.{used}", tf::listed(&children));
    let place = |edge: &TfEdge| Place::message(bag.source, edge.first_at.clone());
    let words = |edge: &TfEdge| format!("`{}` -> `{}`", edge.parent, edge.child);
    let mut finding = Finding::new(severity, subject, message, place(first))
        .likely()
        .label(words(first))
        .detail(detail)
        .help("add them to the URDF or to a calibration file that is kept with it, and publish them from there");
    for edge in adhoc.iter().filter(|edge| edge.child != first.child).take(3) {
        finding = finding.related(place(edge), words(edge));
    }
    Some(finding)
}
