//! TREE09: sensor messages whose frame cannot be looked up at their stamp.

mod findings;

use std::collections::BTreeMap;

use crate::advice::together::report_once;
use crate::analysis::tree::lookups::{Culprit, Listener, Listeners, offset_s};
use crate::analysis::{names, tf};
use crate::rules::prelude::*;
use crate::rules::tree::tf_lookup_coverage::findings::{Case, Cause, Limits, subject_of};
use crate::world::{BagEvidence, FrameId, bag::TopicEvidence};

pub(crate) struct TfLookupCoverage;

/// Findings by their cause.
type Causes = BTreeMap<Cause, Vec<Finding>>;

impl Rule for TfLookupCoverage {
    const NEEDS: &'static [Need] = &[Need::Bag, Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in world.bags.iter().filter(|bag| !bag.tf.is_empty()) {
            let mut listeners = Listeners::new(bag);
            let mut causes = Causes::new();
            let sensors = |topic: &&TopicEvidence| tf::header_use(&topic.message_type) == tf::HeaderUse::Sensor;
            for topic in bag
                .topics
                .values()
                .filter(sensors)
                .filter(|topic| topic.stamps.count > 0)
            {
                if let Err((why, reason)) = judge_topic(bag, topic, &mut listeners, limits, &mut causes, out) {
                    out.not_evaluated(subject_of(topic), why, reason);
                }
            }
            for findings in causes.into_values() {
                report_once(findings, "fail for the same reason", out);
            }
        }
    }
}

fn judge_topic(
    bag: &BagEvidence,
    topic: &TopicEvidence,
    listeners: &mut Listeners<'_>,
    limits: &Limits,
    causes: &mut Causes,
    out: &mut Judge,
) -> Result<(), (NotEvaluated, String)> {
    let little = |reason: String| (NotEvaluated::TooLittleEvidence, reason);
    let not_ours = |reason: String| (NotEvaluated::NotApplicable, reason);
    let stamped = topic.stamps.count.saturating_sub(topic.stamps.zero);
    if stamped < limits.min_messages {
        let needed = limits.min_messages;
        return Err(little(format!("{stamped} messages with a stamp, {needed} are needed")));
    }
    let mut frames: Vec<FrameId> = topic.header_frames.keys().map(FrameId::canonical).collect();
    frames.dedup();
    let [frame] = frames.as_slice() else {
        return Err(not_ours(match frames.len() {
            0 => "its messages state no frame".to_owned(),
            count => format!("its messages have {count} different frame_ids"),
        }));
    };
    if names::is_world(frame) {
        return Err(not_ours(format!(
            "its frame `{frame}` is a world frame, not a sensor's"
        )));
    }
    if let Some(child) = refused(bag, frame) {
        return Err(not_ours(format!("tf2 rejects every transform of `{child}`")));
    }
    let unknown = || not_ours(format!("TF does not know its frame `{frame}`"));
    let heard = listeners.of(frame, &topic.topic).ok_or_else(unknown)?;
    let alone = || not_ours(format!("TF does not connect `{frame}` to a map, odom or base frame"));
    let target = heard.target(frame).ok_or_else(alone)?;
    if let Some((apart_s, edge)) = other_clock(topic, heard, [&target, frame], limits) {
        let reason = format!("its stamps and those of {edge} come from clocks {apart_s:.1} s apart");
        return Err(not_ours(reason));
    }
    let asked = heard.ask(&target, frame, topic, limits.cache_s);
    let failing = [&asked.leading, &asked.inside, &asked.trailing];
    let fails_at = |culprit: &Culprit| {
        failing
            .iter()
            .any(|part| part.main.as_ref().is_some_and(|(at, _)| at == culprit))
    };
    if fails_at(&Culprit::Loop) {
        return Err(not_ours("the frame tree contains a loop".to_owned()));
    }
    let case = Case {
        bag,
        topic,
        frame,
        target: &target,
        heard,
        asked: &asked,
        limits,
    };
    match case.finding() {
        None => out.pass(subject_of(topic), [case.measured()]),
        // The transforms may be in the part that was not read.
        Some(_) if !bag.share.whole => {
            return Err(little(format!(
                "TF below `{target}` was not read at every stamp of the topic, so a missing transform proves nothing"
            )));
        }
        Some((cause, finding)) => causes.entry(cause).or_default().push(finding),
    }
    Ok(())
}

/// The frame, or an ancestor, of which tf2 accepts no transform at all.
fn refused(bag: &BagEvidence, frame: &FrameId) -> Option<FrameId> {
    let edges = tf::by_child(bag);
    let is_refused = |at: &FrameId| {
        edges
            .get(at)
            .is_some_and(|above| above.iter().all(|edge| edge.samples.is_empty()))
    };
    tf::upward(&edges, frame).find(is_refused)
}

/// A moving edge on the way whose stamps come from another clock than the topic's, with the seconds between them.
fn other_clock(
    topic: &TopicEvidence,
    heard: &Listener<'_>,
    ends: [&FrameId; 2],
    limits: &Limits,
) -> Option<(f64, String)> {
    let ours = offset_s(&topic.stamps)?;
    heard
        .moving_above(ends)
        .into_iter()
        .filter(|edge| edge.stamps.count >= limits.min_messages)
        .filter_map(|edge| {
            Some((
                offset_s(&edge.stamps)? - ours,
                format!("`{}` -> `{}`", edge.parent, edge.child),
            ))
        })
        .find(|(apart_s, _)| apart_s.abs() > limits.same_clock_s)
        .map(|(apart_s, edge)| (apart_s.abs(), edge))
}
