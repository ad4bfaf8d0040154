//! Latched transforms that several recordings of one platform share.
//!
//! Between two recordings a mount may have been calibrated: only a convention error is an error.

use crate::verdict::Measured;
use std::collections::BTreeMap;

use crate::analysis::names;
use crate::source::Place;
use crate::verdict::Judge;
use crate::verdict::{Finding, Severity};
use crate::world::bag::TfSample;
use crate::world::{BagEvidence, World};

use crate::analysis::tree::latched::Limits;
use crate::analysis::tree::latched::{Change, Key, StableTally, change, difference, explanation, value};

/// The first value of each latched transform in each recording, in the order of time.
pub(crate) type FirstValues<'a> = BTreeMap<Key, Vec<(&'a BagEvidence, &'a TfSample)>>;

/// Compares the values of all recordings with the earliest one's.
pub(crate) fn judge_across(world: &World, across: &FirstValues, limits: &Limits, out: &mut Judge) {
    let mut calm = StableTally::default();
    for ((topic, parent, child), values) in across {
        let Some(((bag, first), rest)) = values.split_first() else {
            continue;
        };
        // World frames, and parts such as arms, may have another pose in every drive.
        if rest.is_empty() || names::is_world(parent) || names::is_moving_part(child) {
            continue;
        }
        let others = rest.iter().map(|(bag, other)| ((bag, *other), change(first, other)));
        // Of several recordings that have the value, the earliest.
        let Some(((other_bag, other), change)) = others.rev().max_by(Change::order) else {
            continue;
        };
        let Some(severity) = change.severity(limits) else {
            calm.add(&change);
            continue;
        };
        let difference = difference(first, other, limits);
        let severity = match (difference.relation, severity) {
            (Some(_), _) => Severity::Error,
            (None, Severity::Error) => Severity::Warning,
            (None, _) => Severity::Note,
        };
        let subject = format!("latched `{parent}` -> `{child}` across recordings");
        let message = format!(
            "static `{parent}` -> `{child}` changed between recordings, by {}",
            change.words()
        );
        let detail = format!(
            "On `{topic}` in `{}`: {}. In `{}`: {}.{}",
            world.path(bag.source),
            value(first),
            world.path(other_bag.source),
            value(other),
            explanation(&difference),
        );
        let help = match difference.relation {
            Some("ypr") => {
                "compare roll, pitch and yaw of both values with the mounting; then correct the order of the angles where the wrong value is \
                 published (static_transform_publisher takes yaw, pitch, roll if the numbers have no names), and replace the transform in the \
                 recording with the wrong value"
            }
            Some(_) => "compare both values with the mounting, and publish the right one on every drive",
            None => {
                "keep each recording's calibration with that recording, if the mount was changed or calibrated in between; otherwise publish \
                 one value"
            }
        };
        let mut finding = Finding::new(
            severity,
            subject,
            message,
            Place::message(other_bag.source, other.at.clone()),
        )
        .likely()
        .label("value of the later recording")
        .detail(detail)
        .help(help)
        .related(
            Place::message(bag.source, first.at.clone()),
            "value of the earlier recording",
        );
        finding.measured = difference.measured;
        finding.relation = difference.relation.map(str::to_owned);
        out.fail(finding);
    }
    calm.report("latched transforms across recordings".to_owned(), limits, out);
}

impl StableTally {
    /// Writes the row, if there is anything in it.
    pub(crate) fn report(self, subject: String, limits: &Limits, out: &mut Judge) {
        if self.count > 0 {
            let turn = Measured::new("largest rotation", self.deg, "deg").limit(limits.same_deg);
            let shift = Measured::new("largest translation", self.m, "m").limit(limits.same_m);
            out.pass(subject, [turn.samples(self.count), shift.samples(self.count)]);
        }
    }
}
