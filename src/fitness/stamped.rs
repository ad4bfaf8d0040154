//! A stream of a recording, with its span on the recorder's clock and its rate.

use crate::analysis::motion::{Stream, edge_subject};
use crate::world::BagEvidence;
use crate::world::bag::TopicEvidence;
use crate::world::motion::PoseRow;

/// A stream of messages.
pub(super) struct Stamped {
    /// Its name in reports: ``topic `/imu` ``.
    pub(super) subject: String,
    /// Its name in the outcomes of rules on stamps.
    pub(super) stamps: String,
    /// First and last log time, seconds of the recorder's clock.
    span_s: Option<[f64; 2]>,
    /// Messages per second: by the median step of their stamps, else by their number.
    pub(super) hz: Option<f64>,
}

impl Stamped {
    /// Of a topic.
    pub(super) fn of(topic: &TopicEvidence) -> Self {
        let subject = format!("topic `{}`", topic.topic);
        let span_s = topic.first_log_ns.zip(topic.last_log_ns);
        let span_s = span_s.map(|(first, last)| [first as f64 * 1e-9, last as f64 * 1e-9]);
        let by_count = || {
            let seconds = span_s
                .map(|[first, last]| last - first)
                .filter(|seconds| *seconds > 0.0)?;
            (topic.count > 1 && !topic.has_more()).then(|| (topic.count - 1) as f64 / seconds)
        };
        Self {
            stamps: subject.clone(),
            subject,
            span_s,
            hz: topic.stamps.usual_hz().or_else(by_count),
        }
    }

    /// Of a stream of poses: a topic, or a moving transform.
    pub(super) fn of_poses(bag: &BagEvidence, poses: &Stream<PoseRow>) -> Self {
        let edge = bag.tf.iter().find(|edge| edge_subject(edge) == poses.subject);
        let whole = bag.topics.get(&poses.topic).filter(|_| edge.is_none()).map(Self::of);
        let start_s = bag.start_ns.unwrap_or_default() as f64 * 1e-9;
        let times = || poses.rows().map(|row| start_s + row.t_s);
        // Rows may be thinned; stamps are counted before that.
        let of_edge = edge.and_then(|edge| edge.stamps.usual_hz());
        let of_all = of_edge.or_else(|| whole.as_ref()?.hz);
        let steps: Vec<f64> = poses
            .stretches
            .iter()
            .flat_map(|rows| rows.iter().zip(rows.iter().skip(1)))
            .map(|(a, b)| b.t_s - a.t_s)
            .collect();
        let by_rows = || {
            let step_s = crate::math::stats::median(&steps).filter(|step| *step > 0.0);
            step_s.map(f64::recip)
        };
        Self {
            stamps: match edge {
                Some(edge) => format!("TF `{}` from `{}` on `{}`", edge.parent, edge.child, edge.topic),
                None => format!("topic `{}`", poses.topic),
            },
            subject: poses.subject.clone(),
            span_s: whole
                .and_then(|whole| whole.span_s)
                .or_else(|| Some([times().reduce(f64::min)?, times().reduce(f64::max)?])),
            hz: of_all.or_else(by_rows),
        }
    }

    /// How long both are recorded, seconds; negative if a time lies between them.
    pub(super) fn together_s(&self, other: &Self) -> Option<f64> {
        let ([a, b], [c, d]) = (self.span_s?, other.span_s?);
        Some(b.min(d) - a.max(c))
    }
}
