//! The terms of a contract in recordings: who has a topic or a transform, whether its absence is observed, and the terms that
//! recordings give.

pub(crate) mod sensor;

use std::collections::BTreeMap;

use crate::analysis::{names, tf};
use crate::source::Place;
use crate::world::bag::{HeaderFrame, TfEdge, TfSample, TopicEvidence, is_static_topic};
use crate::world::contract::{Contract, TopicTerms, TransformTerms};
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{BagEvidence, FrameId, World};

/// A topic in a recording.
pub(crate) type Recorded<'w> = (&'w BagEvidence, &'w TopicEvidence);

/// Share by which the mean rate of a steady topic may be from that of its usual step.
const STEADY: f64 = 0.2;
/// Values of a rate in several recordings that are one rate, as a share.
const SAME_RATE: f64 = 0.1;
/// Values of a latched transform that are one value: rounding in text and float32 changes less.
const SAME_RAD: f64 = 0.001;
/// Metres.
const SAME_M: f64 = 0.001;
/// Share of a recording, at its start and at its end, in which a topic that is always there has a message.
const AT_THE_ENDS: f64 = 0.25;
/// Fewer messages may come by chance.
const MIN_MESSAGES: u64 = 10;
/// Of fewer messages none may come later than a quarter of a step if they are to be steady: a timer is more exact.
const FEW_MESSAGES: u64 = 30;
/// Share of gaps of more than three steps; where messages come by chance it is an eighth.
const GAPS: f64 = 0.05;
/// More frames are data, such as those of markers.
const MAX_FRAMES: usize = 4;

/// What starts, stops and reports itself: recorded or not, it says nothing about a platform.
const INCIDENTAL: &[&str] = &[
    "action_msgs",
    "actionlib_msgs",
    "bond",
    "diagnostic_msgs",
    "dynamic_reconfigure",
    "lifecycle_msgs",
    "rcl_interfaces",
    "rosbag2_interfaces",
    "rosgraph_msgs",
    "statistics_msgs",
];

/// Whether a contract has nothing to say about a topic. Static TF is in its transforms.
pub(crate) fn is_incidental(topic: &TopicEvidence) -> bool {
    let package = topic.message_type.split(['/', '.']).next().unwrap_or_default();
    INCIDENTAL.contains(&package) || is_static_topic(&topic.topic)
}

/// A topic that something was published on.
fn has_messages(topic: &TopicEvidence) -> bool {
    topic.total.unwrap_or(0).max(topic.count) > 0
}

/// The topics of the recordings that something was published on.
pub(crate) fn recorded(world: &World) -> impl Iterator<Item = Recorded<'_>> {
    let topics = world
        .bags
        .iter()
        .flat_map(|bag| bag.topics.values().map(move |topic| (bag, topic)));
    topics.filter(|(_, topic)| has_messages(topic))
}

/// Why it proves nothing that a topic is in none of the recordings; `None`: it does.
pub(crate) fn topics_unknown(world: &World) -> Option<&'static str> {
    let unknown = |bag: &BagEvidence| !bag.share.whole && bag.share.messages_total.is_none();
    unread(world, unknown)
}

/// Why it proves nothing that a latched transform is in none of the recordings; `None`: it does.
pub(crate) fn latched_unknown(world: &World) -> Option<&'static str> {
    unread(world, |bag| !tf::latched_is_read(bag))
}

fn unread(world: &World, is_unread: impl Fn(&BagEvidence) -> bool) -> Option<&'static str> {
    if world.bags.iter().any(|bag| bag.truncated) {
        Some("a part of the recording could not be read, so its absence proves nothing")
    } else if world.bags.iter().any(is_unread) {
        Some("only parts of the recording were read, so its absence proves nothing; read it with --full")
    } else {
        None
    }
}

/// The terms that these recordings give, each of a world by its number there: what is in all of them, and what comes by chance as optional.
pub(crate) fn of(recordings: &[(&World, usize)]) -> Contract {
    let bags = recordings.iter().filter_map(|(world, number)| world.bags.get(*number));
    let bags: Vec<&BagEvidence> = bags.collect();
    let mut topics: BTreeMap<&str, Vec<Recorded>> = BTreeMap::new();
    for bag in &bags {
        let spoken = bag
            .topics
            .values()
            .filter(|topic| has_messages(topic) && !is_incidental(topic));
        for topic in spoken {
            topics.entry(&topic.topic).or_default().push((bag, topic));
        }
    }
    let topics = topics
        .into_iter()
        .filter_map(|(name, all)| Some((name.to_owned(), topic_terms(&bags, &all)?)));
    Contract {
        topics: topics.collect(),
        transforms: transforms(recordings),
    }
}

fn topic_terms(bags: &[&BagEvidence], all: &[Recorded]) -> Option<TopicTerms> {
    let (bag, topic) = *all.first()?;
    // One drive may be in several files, each with topics of its own.
    let is_beside = |other: &BagEvidence| all.iter().any(|(bag, _)| overlap(bag, other));
    let is_in_all = bags.iter().all(|bag| is_beside(bag)) && all.iter().all(|(bag, topic)| is_always_there(bag, topic));
    Some(TopicTerms {
        message_type: Some(topic.message_type.clone()),
        rate_hz: rate_hz(all),
        tolerance_percent: None,
        frames: frames(all, |topic| &topic.header_frames),
        child_frames: frames(all, |topic| &topic.child_frames),
        sensor: sensor::terms(all.iter().map(|(_, topic)| *topic)),
        is_optional: !is_in_all || names::is_wish(&topic.topic),
        place: Place::of(bag.source, topic.stamps.first.as_ref()),
    })
}

fn overlap(a: &BagEvidence, b: &BagEvidence) -> bool {
    a.source == b.source || a.start_ns <= b.end_ns && b.start_ns <= a.end_ns
}

/// Latched, or with messages from the start to the end.
fn is_always_there(bag: &BagEvidence, topic: &TopicEvidence) -> bool {
    let count = topic.total.unwrap_or(topic.count);
    let within = || {
        let (start, end) = bag.start_ns.zip(bag.end_ns)?;
        let margin = end.saturating_sub(start) as f64 * AT_THE_ENDS;
        let (before, after) = (
            topic.first_log_ns?.saturating_sub(start),
            end.saturating_sub(topic.last_log_ns?),
        );
        Some(before as f64 <= margin && after as f64 <= margin)
    };
    // A sensor that is started late, or stops, is still a sensor of the platform.
    let is_of_a_sensor = || count >= FEW_MESSAGES && is_of_a_sensor(topic);
    topic.latched
        || count >= MIN_MESSAGES && !comes_by_chance(topic, count) && (within().unwrap_or(false) || is_of_a_sensor())
}

/// Whether the messages of a topic are measurements, by their content.
fn is_of_a_sensor(topic: &TopicEvidence) -> bool {
    let content = &topic.content;
    content.imu.is_some()
        || content.fixes.is_some()
        || content.odometry.is_some()
        || content.clouds.is_some()
        || content.lasers.is_some()
        || content.images.is_some()
        || content.calibrations.is_some()
}

/// Whether the messages of a topic are events: the gaps between its stamps are as of what comes by chance. Few without stamps may be.
fn comes_by_chance(topic: &TopicEvidence, count: u64) -> bool {
    let stamps = &topic.stamps;
    let Some(step_ns) = stamps.median_step_ns.filter(|step| *step > 0) else {
        return count < FEW_MESSAGES;
    };
    let has_long = || {
        let longest = stamps.largest_gap.as_ref().map_or(0, |(gap_ns, _)| *gap_ns);
        longest - step_ns > step_ns / 4
    };
    if count < FEW_MESSAGES {
        has_long()
    } else {
        stamps.long_gaps as f64 > GAPS * stamps.count as f64
    }
}

/// The rate of a topic that is steady in all of the recordings.
fn rate_hz(all: &[Recorded]) -> Option<f64> {
    let mut rates = Vec::new();
    for (bag, topic) in all {
        let [least, most] = bag.rate_hz(topic).filter(|_| !topic.latched)?;
        let usual = topic.stamps.usual_hz()?;
        let is_steady = [least, most].iter().all(|rate| (rate / usual - 1.0).abs() <= STEADY)
            && !comes_by_chance(topic, topic.total.unwrap_or(topic.count));
        rates.push(least);
        if !is_steady {
            return None;
        }
    }
    let (least, most) = rates
        .iter()
        .fold((f64::MAX, 0.0), |(a, b), rate| (rate.min(a), rate.max(b)));
    (most <= least * (1.0 + SAME_RATE)).then_some(f64::midpoint(least, most))
}

/// The frames of a topic; none if they are many, or if no message has one.
fn frames(all: &[Recorded], of: fn(&TopicEvidence) -> &BTreeMap<FrameId, HeaderFrame>) -> Vec<FrameId> {
    let mut frames: Vec<FrameId> = all
        .iter()
        .flat_map(|(_, topic)| of(topic).keys())
        .map(FrameId::canonical)
        .collect();
    frames.sort();
    frames.dedup();
    let is_named = frames.iter().any(|frame| !frame.as_str().is_empty());
    frames.retain(|_| is_named);
    if frames.len() > MAX_FRAMES { Vec::new() } else { frames }
}

/// Latched transforms, and those that are published again and again with one value, if they have it in all recordings that have them.
/// Origins of maps are different in every drive, and parts that move have no fixed pose.
fn transforms(recordings: &[(&World, usize)]) -> BTreeMap<(FrameId, FrameId), TransformTerms> {
    let mut edges: BTreeMap<(FrameId, FrameId), Vec<(&BagEvidence, &TfEdge)>> = BTreeMap::new();
    for (world, number) in recordings {
        let is_of_it = |edge: &&Edge| matches!(edge.origin, EdgeOrigin::Tf(bag, _) if bag == *number);
        let rigid = world.graph().edges.iter().filter(|edge| edge.is_rigid);
        for (bag, edge) in rigid.filter(is_of_it).filter_map(|edge| edge.origin.recorded(world)) {
            let frames = (edge.parent.canonical(), edge.child.canonical());
            let is_world = names::is_world(&frames.0) || names::is_world(&frames.1);
            if !is_world && !names::is_moving_part(&frames.1) {
                edges.entry(frames).or_default().push((bag, edge));
            }
        }
    }
    let terms = |edges: &[(&BagEvidence, &TfEdge)]| {
        let (bag, first) = edges.iter().find_map(|(bag, edge)| Some((bag, edge.first()?)))?;
        let is_same = |other: &TfSample| {
            let by = first.pose.isometry().inv_mul(&other.pose.isometry());
            by.rotation.angle() <= SAME_RAD && by.translation.vector.norm() <= SAME_M
        };
        let same = |edge: &TfEdge| {
            let extreme = edge.extreme.as_ref().map(|(sample, ..)| sample);
            edge.first().into_iter().chain(extreme).all(is_same)
        };
        edges.iter().all(|(_, edge)| same(edge)).then(|| TransformTerms {
            pose: first.pose.isometry(),
            tolerance_mm: None,
            tolerance_deg: None,
            place: Place::message(bag.source, first.at.clone()),
        })
    };
    let each = edges.into_iter();
    each.filter_map(|(frames, edges)| Some((frames, terms(&edges)?)))
        .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::indexing_slicing, clippy::cast_possible_truncation)]
    use super::*;
    use crate::source::MessageRef;
    use crate::world::bag::StampEvidence;

    /// A topic whose stamps have these gaps, seconds.
    fn topic(gaps_s: &[f64]) -> TopicEvidence {
        let mut sorted = gaps_s.to_vec();
        sorted.sort_by(f64::total_cmp);
        let ns = |seconds: f64| (seconds * 1e9) as i64;
        let at = MessageRef {
            topic: "/events".to_owned(),
            index: 1,
            stamp_ns: None,
            log_ns: 0,
            field: None,
        };
        let [median, longest] = [sorted.len() / 2, sorted.len() - 1].map(|at| ns(sorted[at]));
        TopicEvidence {
            stamps: StampEvidence {
                count: gaps_s.len() as u64 + 1,
                median_step_ns: Some(median),
                largest_gap: Some((longest, at)),
                long_gaps: gaps_s
                    .iter()
                    .filter(|gap| ns(**gap) > 3 * median && **gap > 1.0)
                    .count() as u64,
                ..StampEvidence::default()
            },
            ..TopicEvidence::default()
        }
    }

    /// Gaps of a Poisson process are exponential: these are its quantiles.
    #[test]
    fn what_comes_by_chance_is_no_stream() {
        let events = |count: u32| {
            let quantile = |i: u32| -5.0 * (1.0 - (f64::from(i) + 0.5) / f64::from(count)).ln();
            topic(&(0..count).map(quantile).collect::<Vec<_>>())
        };
        for count in [10, 20, 60, 500] {
            assert!(comes_by_chance(&events(count), u64::from(count) + 1), "{count}");
        }
        let steady = |count: u32| topic(&(0..count).map(|i| 5.0 + 0.5 * f64::from(i % 3)).collect::<Vec<_>>());
        for count in [10, 20, 60, 500] {
            assert!(!comes_by_chance(&steady(count), u64::from(count) + 1), "{count}");
        }
    }
}
