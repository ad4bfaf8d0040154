//! The findings of TREE09 on the look-ups of one topic.

use crate::source::Place;
use crate::verdict::{Finding, Measured};
use crate::world::bag::{TfEdge, TopicEvidence};
use crate::world::{BagEvidence, FrameId};
use serde::Deserialize;

use crate::analysis::tree::lookups::{Culprit, Failures, Listener, TopicLookups};

/// When look-ups fail, and at what: topics that share it share their finding.
pub(crate) type Cause = (FailurePattern, Culprit);

/// Which look-ups of a topic fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum FailurePattern {
    Always,
    Between,
    AtTheEnd,
    Late,
    AtTheStart,
}

/// One topic with its look-ups and their results.
pub(crate) struct Case<'a> {
    pub(crate) bag: &'a BagEvidence,
    pub(crate) topic: &'a TopicEvidence,
    pub(crate) frame: &'a FrameId,
    pub(crate) target: &'a FrameId,
    pub(crate) heard: &'a Listener<'a>,
    pub(crate) asked: &'a TopicLookups,
    pub(crate) limits: &'a Limits,
}

impl Case<'_> {
    /// Look-ups that fail although there is TF before and after.
    pub(crate) fn measured(&self) -> Measured {
        Measured::new("failing look-ups", share(self.asked.inside.count, self.answered()), "1")
            .limit(self.limits.max_failing)
            .samples(self.asked.count)
    }

    /// The worst fault.
    pub(crate) fn finding(&self) -> Option<(Cause, Finding)> {
        let asked = self.asked;
        // A stamp may equal that of an edge's only transform by chance.
        let most = if asked.leading.count > asked.trailing.count {
            &asked.leading
        } else {
            &asked.trailing
        };
        let once = most
            .main
            .as_ref()
            .and_then(|(culprit, is_past)| self.edge(culprit, *is_past));
        let sent_once = once.is_some_and(|edge| edge.count == 1) && share(most.count, asked.count) > 0.5;
        let parts = [
            (FailurePattern::Always, most, most.count == asked.count || sent_once),
            (FailurePattern::Between, &asked.inside, asked.inside.count > 0),
            (
                FailurePattern::AtTheEnd,
                &asked.trailing,
                asked.trailing.seconds > self.end_s(),
            ),
        ];
        for (when, failures, fails) in parts {
            if let (true, Some((culprit, is_past))) = (fails, &failures.main) {
                let finding = self.failed(when, failures, culprit, *is_past);
                return Some(((when, culprit.clone()), finding));
            }
        }
        if share(asked.forgotten, asked.count) > self.limits.max_failing {
            return Some(((FailurePattern::Late, Culprit::Way), self.late()));
        }
        let (culprit, is_past) = asked.leading.main.as_ref()?;
        let is_slow = asked.leading.seconds > self.limits.max_start_s;
        is_slow.then(|| {
            let finding = self.failed(FailurePattern::AtTheStart, &asked.leading, culprit, *is_past);
            ((FailurePattern::AtTheStart, culprit.clone()), finding)
        })
    }

    /// Look-ups from the first to the last that succeeded.
    fn answered(&self) -> u64 {
        let asked = &self.asked;
        asked
            .count
            .saturating_sub(asked.leading.count)
            .saturating_sub(asked.trailing.count)
    }

    /// How long look-ups may fail at the end: a slow edge cannot cover the last part of its own period.
    fn end_s(&self) -> f64 {
        let slowest = match &self.asked.trailing.main {
            Some((Culprit::Edge(child), _)) => self
                .heard
                .edges_to(child)
                .filter_map(|edge| edge.stamps.median_step_ns)
                .max(),
            _ => None,
        };
        self.limits.max_end_s.max(slowest.unwrap_or(0) as f64 / 1e9 * 3.0)
    }

    fn failed(&self, when: FailurePattern, failures: &Failures, culprit: &Culprit, is_past: bool) -> Finding {
        let Self {
            topic,
            frame,
            target,
            limits,
            ..
        } = self;
        let (limit, part) = match when {
            FailurePattern::Always => (limits.max_failing, share(failures.count, self.asked.count)),
            FailurePattern::Between => (limits.max_failing, share(failures.count, self.answered())),
            _ => (0.0, share(failures.count, self.asked.count)),
        };
        let exception = match culprit {
            Culprit::Edge(_) => "ExtrapolationException",
            _ => "ConnectivityException",
        };
        let edge = self.edge(culprit, is_past);
        let why = self.why(culprit, edge, is_past);
        let lookups = format!("`{}`: look-ups of `{frame}` in `{target}` fail for", topic.topic);
        let message = match when {
            FailurePattern::Always => format!("{lookups} {:.0} % of the messages", part * 100.0),
            FailurePattern::AtTheEnd => format!("{lookups} the last {:.1} s", failures.seconds),
            FailurePattern::AtTheStart => format!("{lookups} the first {:.1} s", failures.seconds),
            _ => format!("{lookups} {:.1} % of the messages", part * 100.0),
        };
        let detail = format!("tf2 throws {exception}: {why}.");
        let place = self.place(edge, when == FailurePattern::AtTheEnd);
        let subject = subject_of(topic);
        let finding = match when {
            FailurePattern::Always => Finding::error(subject, message, place),
            FailurePattern::Between if part > limits.max_failing => Finding::error(subject, message, place),
            FailurePattern::AtTheStart => Finding::note(subject, message, place),
            FailurePattern::AtTheEnd => Finding::warning(subject, message, place).likely(),
            _ => Finding::warning(subject, message, place),
        };
        let finding = match edge {
            Some(edge) if edge.count == 1 => finding.label("the only transform"),
            Some(_) if when == FailurePattern::AtTheEnd => finding.label("the last transform"),
            _ => finding,
        };
        let seconds = Measured::new("time without a transform", failures.seconds, "s");
        finding
            .detail(detail)
            .help(help(when, edge))
            .measured(
                Measured::new("failing look-ups", part, "1")
                    .limit(limit)
                    .samples(failures.count),
            )
            .measured(match when {
                FailurePattern::AtTheStart => seconds.limit(limits.max_start_s),
                FailurePattern::AtTheEnd => seconds.limit(self.end_s()),
                _ => seconds,
            })
    }

    fn late(&self) -> Finding {
        let Self {
            topic, asked, limits, ..
        } = self;
        let part = share(asked.forgotten, asked.count);
        let message = format!(
            "`{}`: {:.1} % of the messages are older than tf2's cache of {} s when recorded",
            topic.topic,
            part * 100.0,
            limits.cache_s,
        );
        Finding::warning(subject_of(topic), message, self.place(None, false))
            .likely()
            .detail("A tf2 buffer of the default length has dropped the transforms at their stamps by then.")
            .help("reduce the delay of the data, or give the listener's buffer a longer cache (tf2::durationFromSec)")
            .measured(
                Measured::new("messages older than the cache", part, "1")
                    .limit(limits.max_failing)
                    .samples(asked.count),
            )
            .measured(Measured::new("largest age", asked.oldest_s, "s").limit(limits.cache_s))
    }

    /// The edge that has no value: for the past the one that begins first.
    fn edge(&self, culprit: &Culprit, is_past: bool) -> Option<&TfEdge> {
        let Culprit::Edge(child) = culprit else { return None };
        if is_past {
            self.heard.edges_to(child).min_by_key(|edge| edge.first_at.log_ns)
        } else {
            self.heard.edges_to(child).max_by_key(|edge| edge.last_at.log_ns)
        }
    }

    fn why(&self, culprit: &Culprit, edge: Option<&TfEdge>, is_past: bool) -> String {
        let Some(edge) = edge else {
            return match culprit {
                Culprit::Loop => "the frame tree contains a loop".to_owned(),
                _ => self.disconnected(),
            };
        };
        let name = format!("`{}` -> `{}`", edge.parent, edge.child);
        match edge.count {
            1 => format!(
                "{name} was sent once on `{}`, and is valid only at that instant",
                edge.topic
            ),
            _ if is_past => format!(
                "{name} starts {:.1} s into the recording",
                self.after_start_s(edge.first_at.log_ns)
            ),
            _ => format!(
                "{name} ends {:.1} s into the recording",
                self.after_start_s(edge.last_at.log_ns)
            ),
        }
    }

    /// Which frame has another parent, and when, where two frames are connected at some times only.
    fn disconnected(&self) -> String {
        let Self { frame, target, .. } = self;
        let above = self.heard.above([*frame, *target]);
        let switched = above.iter().find(|child| {
            let mut parents = self.heard.edges_to(child).map(|edge| edge.parent.canonical());
            let first = parents.next();
            parents.any(|parent| Some(parent) != first)
        });
        let Some(child) = switched else {
            return format!("at these times no transforms connect `{frame}` and `{target}`");
        };
        let parents: Vec<String> = self
            .heard
            .edges_to(child)
            .map(|edge| {
                let [from_s, to_s] = [&edge.first_at, &edge.last_at].map(|at| self.after_start_s(at.log_ns));
                format!("`{}` on `{}` ({from_s:.1} to {to_s:.1} s)", edge.parent, edge.topic)
            })
            .collect();
        format!(
            "at these times `{frame}` and `{target}` are not connected: `{child}` has several parents, {}",
            parents.join(" and ")
        )
    }

    /// Log time since the start of the recording, seconds.
    fn after_start_s(&self, log_ns: i64) -> f64 {
        log_ns.saturating_sub(self.bag.start_ns.unwrap_or(log_ns)) as f64 / 1e9
    }

    fn place(&self, edge: Option<&TfEdge>, at_end: bool) -> Place {
        let of_edge = edge.map(|edge| if at_end { &edge.last_at } else { &edge.first_at });
        let message = of_edge.or(self.topic.stamps.first.as_ref());
        Place::of(self.bag.source, message)
    }
}

fn help(when: FailurePattern, edge: Option<&TfEdge>) -> String {
    match (when, edge) {
        (_, Some(edge)) if edge.count == 1 => {
            format!(
                "publish `{}` -> `{}` on `/tf_static` (StaticTransformBroadcaster)",
                edge.parent, edge.child
            )
        }
        (FailurePattern::AtTheStart, _) => {
            "ignore these messages in offline processing: this is normal while a robot starts".to_owned()
        }
        (FailurePattern::AtTheEnd, Some(edge)) => format!(
            "find out why the publisher of `{}` -> `{}` stopped",
            edge.parent, edge.child
        ),
        (_, Some(edge)) => format!(
            "publish `{}` -> `{}` for as long as the sensor runs, with stamps of the same clock",
            edge.parent, edge.child
        ),
        (_, None) => "let only one node publish each transform, with one parent for each frame (`ros2 run tf2_tools view_frames` shows the publishers)".to_owned(),
    }
}

fn share(part: u64, of: u64) -> f64 {
    if of == 0 { 0.0 } else { part as f64 / of as f64 }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_messages: u64,
    pub(crate) max_failing: f64,
    pub(crate) max_start_s: f64,
    pub(crate) max_end_s: f64,
    pub(crate) same_clock_s: f64,
    pub(crate) cache_s: f64,
}

pub(crate) fn subject_of(topic: &TopicEvidence) -> String {
    format!("look-ups for topic `{}`", topic.topic)
}
