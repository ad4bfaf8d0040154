//! The motion of a recording on one clock: inertial sensors, satellite tracks, poses and velocities, aligned.
//!
//! Made once for all rules that judge motion. Numbers stay as published; what they mean is for the rules to find out. Must
//! not judge.

mod clock;
mod imu;
mod inertial;
mod mount;
mod stream;
mod track;
mod turned;

use std::sync::Arc;

use crate::rules::names;
use crate::world::motion::{FixRow, PoseRow, TwistRow};
use crate::world::{BagEvidence, FrameId, World};

pub(crate) use imu::Imu;
pub(crate) use stream::{Stream, Timed, edge_subject};
pub(crate) use track::{Course, Track, around, span_rad};
pub(crate) use turned::Turned;

/// The streams of motion of each recording of a world, in its order.
pub(crate) struct Motion {
    /// One for each of the world's recordings.
    pub(crate) bags: Vec<BagMotion>,
}

/// The streams of motion of one recording, by topic.
pub(crate) struct BagMotion {
    /// Inertial sensors.
    pub(crate) imus: Vec<Imu>,
    /// Satellite receivers.
    pub(crate) fixes: Vec<Stream<FixRow>>,
    /// Odometry, poses on topics, and moving transforms.
    pub(crate) poses: Vec<Stream<PoseRow>>,
    /// Velocities on topics of their own.
    pub(crate) twists: Vec<Stream<TwistRow>>,
}

impl Motion {
    /// The motion of a world; worked out once.
    pub(crate) fn of(world: &World) -> Arc<Self> {
        world.derived(|world| Self {
            bags: world.bags.iter().map(|bag| BagMotion::of(world, bag)).collect(),
        })
    }
}

impl BagMotion {
    fn of(world: &World, bag: &BagEvidence) -> Self {
        let mut motion = Self {
            imus: Vec::new(),
            fixes: Vec::new(),
            poses: Vec::new(),
            twists: Vec::new(),
        };
        for topic in bag.topics.values() {
            let of = &topic.content.motion;
            motion.imus.extend(Imu::of(world, bag, topic));
            motion.fixes.extend(Stream::of_topic(bag, topic, of.fixes.as_ref()));
            motion.poses.extend(Stream::of_topic(bag, topic, of.poses.as_ref()));
            motion.twists.extend(Stream::of_topic(bag, topic, of.twists.as_ref()));
        }
        motion
            .poses
            .extend(bag.tf.iter().filter_map(|edge| Stream::of_edge(bag, edge)));
        motion
    }

    /// Where the platform went: by satellite receivers first, then by odometry and poses, in frames that are not left out.
    pub(crate) fn tracks(&self, is_left_out: impl Fn(Option<&FrameId>) -> bool) -> Vec<Track> {
        let fixes = self.fixes.iter().map(Track::of_fixes);
        // Joints move, too, and say nothing of the platform's way.
        let is_way = |poses: &&Stream<PoseRow>| {
            poses.frame.as_ref().is_none_or(names::is_world) && !is_left_out(poses.frame.as_ref())
        };
        fixes
            .chain(self.poses.iter().filter(is_way).map(Track::of_poses))
            .collect()
    }
}
