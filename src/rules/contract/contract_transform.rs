//! CONTRACT04: transforms of the contract that are missing, or have moved.

use crate::advice::contract::{MEANT, SUBJECT};
use crate::analysis::contract::latched_unknown;
use crate::analysis::relate::{Difference, PoseTolerance};
use crate::math::relation::Relation;
use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::world::bag::{TfEdge, TfSample};
use crate::world::contract::TransformTerms;
use crate::world::{FrameId, World};

pub(crate) struct ContractTransform;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    tolerance_mm: f64,
    tolerance_deg: f64,
}

/// A transform of the contract: parent and child, and its terms.
type Term<'w> = (&'w (FrameId, FrameId), &'w TransformTerms);

impl Rule for ContractTransform {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let terms = &world.conventions.contract.transforms;
        if world.bags.is_empty() && !terms.is_empty() {
            return out.missing(SUBJECT, Need::Bag.missing());
        }
        let unknown = latched_unknown(world);
        let mut missing: Vec<Term> = Vec::new();
        for term in terms {
            let values = values(world, term.0);
            match (values.is_empty(), unknown) {
                (false, _) => judge_values(term, &values, limits, out),
                (true, Some(why)) => out.too_little(subject(term.0), why),
                (true, None) => missing.push(term),
            }
        }
        // One cause, one finding: nothing latched was recorded.
        if missing.len() == terms.len() && missing.len() > 1 {
            let message = format!(
                "none of the {} transforms of the contract is in the recording",
                missing.len()
            );
            let subject = "transforms of the contract".to_owned();
            out.fail(absent(world, (subject, message), &missing, &moved(world, &missing)));
        } else {
            for term in missing {
                let (parent, child) = term.0;
                let is_renamed = |(_, edge): &(SourceId, &TfEdge)| is_renamed(world, &term, edge, limits);
                let moved = moved(world, &[term]);
                let message = match (moved.first(), edges(world).find(is_renamed)) {
                    (Some((_, edge)), _) => {
                        format!(
                            "`{parent}` -> `{child}` of the contract is not in the recording: there its parent is `{}`",
                            edge.parent
                        )
                    }
                    (None, Some((_, edge))) => {
                        format!(
                            "`{parent}` -> `{child}` of the contract is not in the recording: `{}` has this transform there",
                            edge.child
                        )
                    }
                    (None, None) => format!("`{parent}` -> `{child}` of the contract is not in the recording"),
                };
                out.fail(absent(world, (subject(term.0), message), &[term], &moved));
            }
        }
    }
}

fn subject((parent, child): &(FrameId, FrameId)) -> String {
    format!("transform `{parent}` -> `{child}`")
}

/// Edges of a recording with their source.
fn edges(world: &World) -> impl Iterator<Item = (SourceId, &TfEdge)> {
    world
        .bags
        .iter()
        .flat_map(|bag| bag.tf.iter().map(|edge| (bag.source, edge)))
}

/// The values of a transform: of each edge the first, and the one that differs most from it.
fn values<'w>(world: &'w World, (parent, child): &(FrameId, FrameId)) -> Vec<(SourceId, &'w TfSample)> {
    let own = edges(world).filter(|(_, edge)| edge.parent.canonical() == *parent && edge.child.canonical() == *child);
    let samples = own.flat_map(|(source, edge)| {
        let extreme = edge.extreme.as_ref().map(|(sample, ..)| sample);
        edge.first()
            .into_iter()
            .chain(extreme)
            .map(move |sample| (source, sample))
    });
    samples.collect()
}

fn judge_values((frames, terms): Term, values: &[(SourceId, &TfSample)], limits: &Limits, out: &mut Judge) {
    let mm = terms.tolerance_mm.unwrap_or(limits.tolerance_mm);
    let deg = terms.tolerance_deg.unwrap_or(limits.tolerance_deg);
    let wanted = terms.pose;
    let by = |sample: &TfSample| {
        let by = wanted.inv_mul(&sample.pose.isometry());
        (by.translation.vector.norm() * 1000.0, by.rotation.angle().to_degrees())
    };
    let excess = |sample: &TfSample| {
        let (by_mm, by_deg) = by(sample);
        (by_mm / mm).max(by_deg / deg)
    };
    let worst = values.iter().max_by(|a, b| excess(a.1).total_cmp(&excess(b.1)));
    let Some((source, sample)) = worst else { return };
    let tolerance = PoseTolerance { deg, m: mm / 1000.0 };
    let difference = Difference::between(&wanted, &sample.pose.isometry(), tolerance);
    if excess(sample) <= 1.0 {
        return out.pass(subject(frames), difference.measured);
    }
    let (by_mm, by_deg) = by(sample);
    let relation = difference.relation.and_then(Relation::from_word);
    let message = format!(
        "`{}` -> `{}` is {by_mm:.1} mm and {by_deg:.2} deg from the contract (tolerance {mm} mm, {deg} deg)",
        frames.0, frames.1
    );
    let mut finding = Finding::error(subject(frames), message, terms.place.clone())
        .label("value by the contract")
        .detail(relation.map_or_else(String::new, |relation| {
            format!("A known error that explains the difference: {}", relation.describe())
        }))
        .help(format!(
            "find out whether the sensor was moved, or its transform changed; {MEANT}"
        ))
        .measured(difference.measured)
        .related(Place::message(*source, sample.at.clone()), "value in the recording");
    finding.relation = difference.relation.map(str::to_owned);
    out.fail(finding);
}

/// Maximum number of places of one finding.
const MAX_PLACES: usize = 5;

fn absent(
    world: &World,
    (subject, message): (String, String),
    terms: &[Term],
    moved: &[(SourceId, &TfEdge)],
) -> Finding {
    let first = terms.first().map(|(_, terms)| terms.place.clone());
    let bag = world.bags.first().map(|bag| Place::whole(bag.source));
    let place = first
        .or_else(|| bag.clone())
        .unwrap_or_else(|| Place::whole(SourceId(0)));
    let help = match (moved.is_empty(), terms.len()) {
        (false, _) => "find out why its parent changed: a child has one parent",
        (true, 1) => "publish it, on `/tf_static` if it does not change, and record that",
        (true, _) => "find out whether `/tf_static` was recorded and published",
    };
    let finding = Finding::error(subject, message, place)
        .label("not recorded")
        .help(format!("{help}; {MEANT}"))
        .measured(Measured::count("transforms of the contract that are missing", terms.len()).limit(0.0));
    let finding = moved.iter().fold(finding, |finding, (source, edge)| {
        let note = format!("`{}` has the parent `{}` here", edge.child, edge.parent);
        finding.related(Place::message(*source, edge.first_at.clone()), note)
    });
    bag.into_iter()
        .fold(finding, |finding, bag| finding.related(bag, "without the transform"))
}

/// Transforms to the children of these terms from other parents.
fn moved<'w>(world: &'w World, terms: &[Term]) -> Vec<(SourceId, &'w TfEdge)> {
    let is_moved = |(_, edge): &(SourceId, &TfEdge)| {
        let is_child = |term: &Term| term.0.1 == edge.child.canonical();
        terms.iter().any(is_child)
    };
    edges(world).filter(is_moved).take(MAX_PLACES).collect()
}

/// Whether a transform that is not of the contract has the parent and the value of this one.
fn is_renamed(world: &World, (frames, terms): &Term, edge: &TfEdge, limits: &Limits) -> bool {
    let known = |child: FrameId| {
        let mut all = world.conventions.contract.transforms.keys();
        all.any(|frames| frames.1 == child)
    };
    let is_same = |sample: &TfSample| {
        let by = terms.pose.inv_mul(&sample.pose.isometry());
        by.translation.vector.norm() * 1000.0 <= limits.tolerance_mm
            && by.rotation.angle().to_degrees() <= limits.tolerance_deg
    };
    edge.extreme.is_none()
        && edge.parent.canonical() == frames.0
        && !known(edge.child.canonical())
        && edge.first().is_some_and(is_same)
}
