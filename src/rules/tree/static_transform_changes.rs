//! TREE11: latched transforms with more than one value, in one recording or between recordings.

mod across;

use crate::analysis::tree::latched::{
    Change, Key, Limits, StableTally, change, difference, explanation, latched, value,
};
use crate::rules::prelude::*;
use crate::rules::tree::static_transform_changes::across::{FirstValues, judge_across};
use crate::world::BagEvidence;
use crate::world::bag::{TfEdge, TfSample};

pub(crate) struct StaticTransformChanges;

impl Rule for StaticTransformChanges {
    const NEEDS: &'static [Need] = &[Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut across = FirstValues::new();
        let mut bags: Vec<&BagEvidence> = world.bags.iter().filter(|bag| !bag.tf.is_empty()).collect();
        bags.sort_by_key(|bag| (bag.start_ns, bag.source));
        for bag in bags {
            let subject = format!("latched transforms of {}", world.path(bag.source));
            let latched = latched(bag);
            if latched.is_empty() {
                out.not_applicable(subject, "it has no latched transforms");
                continue;
            }
            let mut calm = StableTally::default();
            for (key, edges) in &latched {
                let Some(first) = edges.iter().find_map(|edge| edge.first()) else {
                    continue;
                };
                across.entry(key.clone()).or_default().push((bag, first));
                let others = edges
                    .iter()
                    .flat_map(|edge| edge.first().into_iter().chain(edge.extreme.as_ref().map(|e| &e.0)));
                let Some((other, change)) = others.map(|other| (other, change(first, other))).max_by(Change::order)
                else {
                    continue;
                };
                match change.severity(limits) {
                    None => calm.add(&change),
                    Some(severity) => out.fail(within(bag, key, (first, other, change), severity, limits, edges)),
                }
            }
            calm.report(subject, limits, out);
        }
        judge_across(world, &across, limits, out);
    }
}

fn within(
    bag: &BagEvidence,
    (topic, parent, child): &Key,
    (first, other, change): (&TfSample, &TfSample, Change),
    severity: Severity,
    limits: &Limits,
    edges: &[&TfEdge],
) -> Finding {
    let difference = difference(first, other, limits);
    let writers: Vec<&str> = edges
        .iter()
        .flat_map(|edge| edge.writers.keys())
        .map(String::as_str)
        .collect();
    let by = if writers.len() > 1 {
        format!(" Publishers: {}.", writers.join(", "))
    } else {
        String::new()
    };
    let apart_s = other.at.log_ns.abs_diff(first.at.log_ns) as f64 / 1e9;
    let message = format!(
        "static `{parent}` -> `{child}` has two values, {} apart",
        change.words()
    );
    let detail = format!(
        "On `{topic}`, {apart_s:.1} s apart: {}; and {}.{by}{} tf2 uses the last value for all times, also in the past.",
        value(first),
        value(other),
        explanation(&difference)
    );
    let subject = format!("latched `{parent}` -> `{child}` on {topic}");
    let count = crate::math::stats::total(edges.iter().map(|edge| edge.count));
    let mut finding = Finding::new(severity, subject, message, Place::message(bag.source, other.at.clone()))
        .label("the second value")
        .detail(detail)
        .help("compare both values with the mounting, and publish only the right one; if the frame moves, publish its transform on `/tf`")
        .related(Place::message(bag.source, first.at.clone()), "the first value");
    finding.measured = difference
        .measured
        .into_iter()
        .map(|measured| measured.samples(count))
        .collect();
    finding.relation = difference.relation.map(str::to_owned);
    finding
}
