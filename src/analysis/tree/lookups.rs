//! Looks up the frames of a recording's own sensor messages in its TF, as a listener would. Measures; must not judge.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::analysis::{names, names::Standard};
use crate::math::stats::median;
use crate::world::bag::{BagEvidence, StampEvidence, TfEdge, TopicEvidence};
use crate::world::tf2::{Buffer, Extrapolation, LookupError};
use crate::world::{FrameId, tf2};

/// Number of edges up to the roots of both frames from which fewer stamps are looked up.
const DEEP: usize = 64;

/// A recording's TF, with a buffer for each namespace that was looked up.
pub(crate) struct Listeners<'w> {
    bag: &'w BagEvidence,
    /// The namespaces that contain a frame.
    of_frame: BTreeMap<FrameId, BTreeSet<&'w str>>,
    heard: BTreeMap<&'w str, Listener<'w>>,
}

/// The TF of one namespace of a recording.
pub(crate) struct Listener<'w> {
    bag: &'w BagEvidence,
    edges: Vec<&'w TfEdge>,
    buffer: Buffer,
}

/// What a run of look-ups failed at: the child of an edge, or the whole way.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Culprit {
    /// No value at the stamp of the edge that ends in this child.
    Edge(FrameId),
    /// The frames are not connected at that time.
    Way,
    /// The tree is a loop.
    Loop,
}

/// Failed look-ups in a row, or in all.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Failures {
    /// How many.
    pub(crate) count: u64,
    /// How long they last by log time, seconds.
    pub(crate) seconds: f64,
    /// What most of them failed at, and whether that was before the edge's first value.
    pub(crate) main: Option<(Culprit, bool)>,
}

/// The look-ups of one topic.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TopicLookups {
    /// All of them.
    pub(crate) count: u64,
    /// Those before the first that succeeded; all where none did.
    pub(crate) leading: Failures,
    /// Those after the last that succeeded.
    pub(crate) trailing: Failures,
    /// Those between the first and the last that succeeded.
    pub(crate) inside: Failures,
    /// Those that succeed, but whose stamp is so old at the log time that a cache of the given length has dropped it.
    pub(crate) forgotten: u64,
    /// Largest age of a stamp relative to the newest TF on the way at the log time, seconds.
    pub(crate) oldest_s: f64,
}

impl<'w> Listeners<'w> {
    pub(crate) fn new(bag: &'w BagEvidence) -> Self {
        let mut of_frame: BTreeMap<FrameId, BTreeSet<&str>> = BTreeMap::new();
        for edge in &bag.tf {
            for frame in [edge.parent.canonical(), edge.child.canonical()] {
                of_frame.entry(frame).or_default().insert(tf2::namespace(&edge.topic));
            }
        }
        Self {
            bag,
            of_frame,
            heard: BTreeMap::new(),
        }
    }

    /// The TF that a topic's frame is part of: of several namespaces, the one whose name the topic shares most of.
    pub(crate) fn of(&mut self, frame: &FrameId, topic: &str) -> Option<&Listener<'w>> {
        let shared = |namespace: &&&str| {
            let pairs = topic.bytes().zip(namespace.bytes());
            pairs.take_while(|(a, b)| a == b).count()
        };
        let namespaces = self.of_frame.get(frame)?;
        let namespace = namespaces.iter().rev().max_by_key(shared).copied()?;
        let bag = self.bag;
        Some(self.heard.entry(namespace).or_insert_with(|| {
            Listener {
                bag,
                edges: bag
                    .tf
                    .iter()
                    .filter(|edge| tf2::namespace(&edge.topic) == namespace)
                    .collect(),
                buffer: Buffer::of_recording(bag, namespace, None),
            }
        }))
    }
}

impl<'w> Listener<'w> {
    /// The edges that end in a child, in the order of the evidence.
    pub(crate) fn edges_to(&self, child: &FrameId) -> impl Iterator<Item = &'w TfEdge> {
        self.edges
            .iter()
            .copied()
            .filter(move |edge| edge.child.canonical() == *child)
    }

    /// The target that consumers would look up: the first of `map`, `odom` and the base that any edges ever connect with `frame`.
    pub(crate) fn target(&self, frame: &FrameId) -> Option<FrameId> {
        let mut beside: BTreeMap<FrameId, BTreeSet<FrameId>> = BTreeMap::new();
        for edge in &self.edges {
            let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
            beside.entry(parent.clone()).or_default().insert(child.clone());
            beside.entry(child).or_default().insert(parent);
        }
        let mut reached = BTreeSet::from([frame.clone()]);
        let mut queue = VecDeque::from([frame.clone()]);
        while let Some(at) = queue.pop_front() {
            for next in beside.get(&at).into_iter().flatten() {
                if reached.insert(next.clone()) {
                    queue.push_back(next.clone());
                }
            }
        }
        reached.remove(frame);
        let rank = |candidate: &FrameId| match names::standard(candidate) {
            Some((_, Standard::Map)) => Some(0),
            Some((_, Standard::Odom)) => Some(1),
            Some((_, Standard::Base)) => Some(2),
            _ => names::is_base(candidate).then_some(3),
        };
        let shared = |candidate: &FrameId| {
            let pairs = candidate.as_str().bytes().zip(frame.as_str().bytes());
            pairs.take_while(|(a, b)| a == b).count()
        };
        reached
            .into_iter()
            .filter_map(|candidate| Some((rank(&candidate)?, candidate)))
            // Among equals the one of the same robot, then the shortest name.
            .min_by_key(|(rank, candidate)| {
                let namespaced = std::cmp::Reverse(if candidate.as_str().contains('/') {
                    shared(candidate)
                } else {
                    0
                });
                (*rank, namespaced, candidate.as_str().len(), candidate.clone())
            })
            .map(|(_, candidate)| candidate)
    }

    /// Two frames, and all that are on any way up from them.
    pub(crate) fn above(&self, frames: [&FrameId; 2]) -> BTreeSet<FrameId> {
        let mut above: BTreeSet<FrameId> = BTreeSet::new();
        let mut queue: VecDeque<FrameId> = frames.into_iter().cloned().collect();
        while let Some(frame) = queue.pop_front() {
            if above.insert(frame.clone()) {
                queue.extend(self.edges_to(&frame).map(|edge| edge.parent.canonical()));
            }
        }
        above
    }

    /// The moving edges on any way up from two frames.
    pub(crate) fn moving_above(&self, frames: [&FrameId; 2]) -> Vec<&'w TfEdge> {
        let above = self.above(frames);
        self.edges
            .iter()
            .copied()
            .filter(|edge| !edge.is_static && above.contains(&edge.child.canonical()))
            .collect()
    }

    /// Looks up every sampled stamp of a topic, and counts stamps that are older than a cache of `cache_s`.
    pub(crate) fn ask(&self, target: &FrameId, frame: &FrameId, topic: &TopicEvidence, cache_s: f64) -> TopicLookups {
        let mut newest = NewestStamps::default();
        let mut answers: Vec<(i64, Option<(Culprit, bool)>)> = Vec::new();
        let (mut forgotten, mut oldest_s) = (0, 0.0_f64);
        // Only artificial trees are so deep; they must not take long.
        let stride = 1 + (self.buffer.depth(target) + self.buffer.depth(frame)) / DEEP;
        let stamps = topic.stamps.samples.iter().copied().filter(|(stamp, _)| *stamp != 0);
        for (stamp_ns, log_ns) in stamps.step_by(stride) {
            let answer = self.buffer.rests_on(target.as_str(), frame.as_str(), stamp_ns);
            if let Ok(edges) = &answer {
                let latest = edges.iter().filter_map(|edge| newest.at(self.bag, *edge, log_ns)).max();
                let age_s = latest.map_or(0.0, |latest| (latest as f64 - stamp_ns as f64) / 1e9);
                oldest_s = oldest_s.max(age_s);
                forgotten += u64::from(age_s > cache_s);
            }
            answers.push((log_ns, answer.err().map(|error| culprit(&error))));
        }
        let fails = |(_, failed): &(i64, Option<(Culprit, bool)>)| failed.is_some();
        let first_found = answers
            .iter()
            .position(|answer| !fails(answer))
            .unwrap_or(answers.len());
        let after_last = answers
            .iter()
            .rposition(|answer| !fails(answer))
            .map_or(answers.len(), |last| last + 1);
        let part = |range: std::ops::Range<usize>| answers.get(range).unwrap_or_default();
        TopicLookups {
            count: answers.len() as u64,
            leading: failures(part(0..first_found)),
            trailing: failures(part(after_last..answers.len())),
            inside: failures(part(first_found..after_last)),
            forgotten,
            oldest_s,
        }
    }
}

fn culprit(error: &LookupError) -> (Culprit, bool) {
    match error {
        LookupError::Extrapolation { child, what, .. } => (Culprit::Edge(child.clone()), Extrapolation::is_past(*what)),
        LookupError::Loop => (Culprit::Loop, false),
        _ => (Culprit::Way, false),
    }
}

fn failures(answers: &[(i64, Option<(Culprit, bool)>)]) -> Failures {
    let mut of: BTreeMap<&(Culprit, bool), u64> = BTreeMap::new();
    for failed in answers.iter().filter_map(|(_, failed)| failed.as_ref()) {
        *of.entry(failed).or_default() += 1;
    }
    let logs = || answers.iter().map(|(log, _)| *log);
    let seconds = logs()
        .max()
        .zip(logs().min())
        .map_or(0.0, |(last, first)| last.saturating_sub(first) as f64 / 1e9);
    Failures {
        count: of.values().sum(),
        seconds,
        main: of
            .into_iter()
            .max_by_key(|(_, count)| *count)
            .map(|(main, _)| main.clone()),
    }
}

/// The newest stamp of each moving edge by log time.
#[derive(Default)]
struct NewestStamps {
    of: BTreeMap<usize, Vec<(i64, i64)>>,
}

impl NewestStamps {
    /// The newest stamp that was logged for an edge of `bag.tf` at `log_ns`; `None` for static ones.
    fn at(&mut self, bag: &BagEvidence, number: usize, log_ns: i64) -> Option<i64> {
        let edge = bag.tf.get(number).filter(|edge| !edge.is_static)?;
        let newest = self.of.entry(number).or_insert_with(|| {
            let mut by_log: Vec<(i64, i64)> = edge.stamps.samples.iter().map(|(stamp, log)| (*log, *stamp)).collect();
            by_log.sort_unstable();
            let mut newest = i64::MIN;
            for (_, stamp) in &mut by_log {
                newest = newest.max(*stamp);
                *stamp = newest;
            }
            by_log
        });
        let until = newest.partition_point(|(log, _)| *log <= log_ns);
        newest.get(until.checked_sub(1)?).map(|(_, stamp)| *stamp)
    }
}

/// Median of stamp minus log time, seconds, of the stamps that are not zero.
pub(crate) fn offset_s(stamps: &StampEvidence) -> Option<f64> {
    let offsets: Vec<f64> = stamps
        .samples
        .iter()
        .filter(|(stamp, _)| *stamp != 0)
        .map(|(stamp, log)| (*stamp as f64 - *log as f64) / 1e9)
        .collect();
    median(&offsets)
}
