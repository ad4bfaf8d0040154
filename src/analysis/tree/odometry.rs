//! Streams of odometry in a recording: transforms below `odom`, and odometry messages in it; and how fast they go.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::analysis::names;
use crate::analysis::tree::steps::{of_moving, seconds};
use crate::world::bag::{HeaderFrame, TopicEvidence};
use crate::world::content::{Step, StepEvidence};
use crate::world::{BagEvidence, FrameId};

/// One stream.
pub(crate) struct Stream<'a> {
    /// The frame it is expressed in, canonical.
    pub(crate) odom: FrameId,
    /// The frame that moves, canonical.
    pub(crate) child: FrameId,
    /// Its topic.
    pub(crate) topic: &'a str,
    /// How it moves.
    pub(crate) steps: &'a StepEvidence,
    /// The largest speed and angular speed that it reports, m/s and rad/s.
    pub(crate) claimed: Option<(f64, f64)>,
}

/// The streams of a recording by frame and moving frame. Only a frame with the word `odom` in its name must not jump: fixes,
/// localizers and ground truth in `map` or `world` may. Joints are not odometry.
pub(crate) fn streams(bag: &BagEvidence) -> BTreeMap<(FrameId, FrameId), Vec<Stream<'_>>> {
    let mut streams: BTreeMap<(FrameId, FrameId), Vec<Stream>> = BTreeMap::new();
    for topic in bag.topics.values() {
        let (Some(odometry), Some((odom, child))) = (&topic.content.odometry, frames_of(topic)) else {
            continue;
        };
        if promises(&odom, &child) {
            let claimed = (odometry.largest_speed_m_s, odometry.largest_turn_rad_s);
            let claimed = Some(claimed).filter(|(speed, turn)| speed.is_finite() && turn.is_finite());
            let (steps, topic) = (&odometry.steps, topic.topic.as_str());
            let stream = Stream {
                odom: odom.clone(),
                child: child.clone(),
                topic,
                steps,
                claimed,
            };
            streams.entry((odom, child)).or_default().push(stream);
        }
    }
    for edge in bag.tf.iter().filter(|edge| !edge.is_static) {
        let (odom, child) = (edge.parent.canonical(), edge.child.canonical());
        if promises(&odom, &child) {
            let (steps, topic) = (&edge.steps, edge.topic.as_str());
            let stream = Stream {
                odom: odom.clone(),
                child: child.clone(),
                topic,
                steps,
                claimed: None,
            };
            streams.entry((odom, child)).or_default().push(stream);
        }
    }
    streams
}

fn promises(odom: &FrameId, child: &FrameId) -> bool {
    odom.has_token("odom") && !names::is_world(child) && !names::is_moving_part(child)
}

/// The two frames of an odometry topic, if they do not change.
fn frames_of(topic: &TopicEvidence) -> Option<(FrameId, FrameId)> {
    let only = |frames: &BTreeMap<FrameId, HeaderFrame>| {
        let mut names = frames.keys();
        names.next().filter(|_| names.next().is_none()).map(FrameId::canonical)
    };
    Some((only(&topic.header_frames)?, only(&topic.child_frames)?))
}

/// The limits up to which a step may be motion.
pub(crate) struct StepBound {
    /// The largest speed, m/s.
    pub(crate) speed: f64,
    /// The largest angular speed, rad/s.
    turn: f64,
}

impl StepBound {
    /// The largest speeds that the streams report, or do not exceed in nine of ten steps.
    pub(crate) fn of(streams: &[Stream]) -> Self {
        let largest = |of: &dyn Fn(&Stream) -> Option<f64>| streams.iter().filter_map(of).fold(0.0, f64::max);
        let shown =
            |of: fn(&Step) -> f64| move |stream: &Stream| of_moving(stream.steps, 0.9, |step| of(step) / seconds(step));
        let claimed_speed = largest(&|stream| stream.claimed.map(|(speed, _)| speed));
        let claimed_turn = largest(&|stream| stream.claimed.map(|(_, turn)| turn));
        Self {
            speed: claimed_speed.max(largest(&shown(|step| step.distance_m))),
            turn: claimed_turn.max(largest(&shown(|step| step.angle_rad))),
        }
    }

    /// What a step may cover in its time: metres and radians.
    pub(crate) fn limits(&self, step: &Step, limits: &Limits) -> (f64, f64) {
        let during = |speed: f64| limits.times_speed * speed * seconds(step);
        (
            during(self.speed).max(limits.least_m),
            during(self.turn).max(limits.least_deg.to_radians()),
        )
    }

    /// A jump is longer than any motion in its time, and unexpected by the velocity before it: the first step of a start is not.
    pub(crate) fn is_jump(&self, step: &Step, limits: &Limits) -> bool {
        let (m, rad) = self.limits(step, limits);
        (step.distance_m > m && step.surprise_m > m) || (step.angle_rad > rad && step.surprise_rad > rad)
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Step that is never a jump, metres.
    pub least_m: f64,
    /// Rotation that is never a jump, degrees.
    pub least_deg: f64,
    /// A jump is so many times the largest speed.
    pub times_speed: f64,
    /// Steps needed.
    pub min_steps: u64,
    /// A jump that ends this near to the identity is a reset, metres and radians.
    pub origin: f64,
}
