//! Topics of two recordings: their types and frames, the offset of their stamps from the recorder's clock, and their rates.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Deref;

use crate::math::stats::median;
use crate::run::Run;
use crate::tables::leap_seconds;
use crate::verdict::Measured;
use crate::world::FrameId;
use crate::world::bag::TopicEvidence;

use super::{Change, Comparison, Kind};

/// Variation by transport and load, seconds.
const SAME_S: f64 = 0.1;
/// Share by which a rate varies without any change.
const SAME_RATE: f64 = 0.2;

pub(super) fn compare(a: &Run, b: &Run, out: &mut Comparison) {
    let (before, after) = (topics(a), topics(b));
    if before.is_empty() || after.is_empty() {
        return;
    }
    for (first, second, words) in [(&before, &after, "is gone"), (&after, &before, "is new")] {
        for (name, topic) in first.iter().filter(|(name, _)| !second.contains_key(*name)) {
            let message = format!("{name} {words} ({})", topic.message_type);
            out.changes.push(Change::new(Kind::Convention, *name, message));
        }
    }
    for (name, first) in &before {
        let Some(second) = after.get(name) else { continue };
        out.topics += 1;
        compare_metadata(name, first, second, out);
        clock(name, first, second, out);
    }
}

/// A topic of a recording.
struct Topic<'r> {
    evidence: &'r TopicEvidence,
    /// Messages per second, if the recording gives a rate.
    rate_hz: Option<f64>,
}

impl Deref for Topic<'_> {
    type Target = TopicEvidence;

    fn deref(&self) -> &TopicEvidence {
        self.evidence
    }
}

/// The topics of all recordings of a run that anything was published on; of one in several recordings the first.
fn topics(run: &Run) -> BTreeMap<&str, Topic<'_>> {
    let mut topics = BTreeMap::new();
    for bag in run.worlds.iter().flat_map(|world| &world.bags) {
        for (name, evidence) in bag.topics.iter().filter(|(_, topic)| topic.count > 0) {
            topics.entry(name.as_str()).or_insert(Topic {
                evidence,
                rate_hz: bag.rate_hz(evidence).map(|[least, _]| least),
            });
        }
    }
    topics
}

fn compare_metadata(name: &str, first: &TopicEvidence, second: &TopicEvidence, out: &mut Comparison) {
    let mut changed = |what: &str, before: String, after: String| {
        if before != after {
            let message = format!("{name}: {what} {after} (was {before})");
            out.changes.push(Change::new(Kind::Convention, name, message));
        }
    };
    changed("type is", first.message_type.clone(), second.message_type.clone());
    let frames = |topic: &TopicEvidence, child: bool| {
        let frames = if child {
            &topic.child_frames
        } else {
            &topic.header_frames
        };
        let names: BTreeSet<&FrameId> = frames.keys().collect();
        let names: Vec<String> = names.iter().map(|frame| format!("`{frame}`")).collect();
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    };
    changed("frame is", frames(first, false), frames(second, false));
    changed("child frame is", frames(first, true), frames(second, true));
}

fn clock(name: &str, first: &Topic, second: &Topic, out: &mut Comparison) {
    let offset = |topic: &TopicEvidence| {
        let differences: Vec<f64> = topic
            .stamps
            .samples
            .iter()
            .map(|(stamp, log)| (stamp - log) as f64 / 1e9)
            .collect();
        median(&differences)
    };
    if let (Some(before), Some(after)) = (offset(first), offset(second))
        && (after - before).abs() > SAME_S
    {
        let mut change = Change::new(
            Kind::Clock,
            name,
            format!("{name}: stamps are {after:+.3} s from the recorder's clock (were {before:+.3} s)"),
        );
        let day_s = second.first_log_ns.map_or(0.0, |ns| ns as f64 / 1e9);
        change.explanation = offset_words(after - before, day_s);
        change.measured = vec![Measured::new("change of the stamp offset", after - before, "s").limit(SAME_S)];
        out.changes.push(change);
    }
    if let (Some(before), Some(after)) = (first.rate_hz, second.rate_hz)
        && (after / before - 1.0).abs() > SAME_RATE
    {
        let mut change = Change::new(
            Kind::Clock,
            name,
            format!("{name}: rate is {after:.2} Hz (was {before:.2} Hz)"),
        );
        change.measured = vec![Measured::new("rate relative to before", after / before, "1").limit(1.0 + SAME_RATE)];
        out.changes.push(change);
    }
}

/// Known offsets between time scales on a day, and between time zones.
fn offset_words(seconds: f64, day_unix_s: f64) -> String {
    let size = seconds.abs();
    let near = |value: f64| (size - value).abs() < 0.5;
    let (gps_s, tai_s) = {
        let leap = leap_seconds();
        (leap.gps_minus_utc_s(day_unix_s), leap.tai_minus_utc_s(day_unix_s))
    };
    if near(gps_s) {
        "matches the offset between GPS time and UTC".to_owned()
    } else if near(tai_s) {
        "matches the offset between TAI and UTC".to_owned()
    } else if near(tai_s - gps_s) {
        "matches the offset between TAI and GPS time".to_owned()
    } else if size > 1700.0 && (size % 900.0 < 2.0 || size % 900.0 > 898.0) && size < 51_000.0 {
        "matches the offset of a time zone".to_owned()
    } else {
        String::new()
    }
}
