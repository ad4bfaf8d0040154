//! The motion of a recording on one clock: inertial sensors, satellite tracks, poses and velocities, aligned.
//!
//! Made once for all rules that judge motion. Numbers are as published, or, where the configuration or a frame's name says
//! that they are told in another convention, brought from there to that of ROS. Must not judge.

mod clock;
mod convention;
mod imu;
mod inertial;
mod mount;
mod stream;
mod track;

use std::sync::Arc;

use crate::rules::names;
use crate::tables::{self, Known, Simulator};
use crate::world::motion::{FixRow, PoseRow, TwistRow};
use crate::world::{BagEvidence, World};

pub(crate) use convention::ToldIn;
pub(crate) use imu::Imu;
pub(crate) use stream::{Stream, Timed};
pub(crate) use track::{Course, Track, around, span_rad};

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
    /// The simulator that names in the recording tell.
    pub(crate) simulator: Option<Known<Simulator>>,
}

impl Motion {
    /// The motion of a world; worked out once.
    pub(crate) fn of(world: &World) -> Arc<Self> {
        world.derived(|world| Self {
            bags: world.bags.iter().map(|bag| BagMotion::of(world, bag)).collect(),
        })
    }

    /// The simulator of the recording that a sensor is in.
    pub(crate) fn simulator_of(&self, imu: &Imu) -> Option<Known<Simulator>> {
        let bag = self
            .bags
            .iter()
            .find(|bag| bag.imus.iter().any(|one| std::ptr::eq(one, imu)))?;
        bag.simulator
    }
}

impl BagMotion {
    fn of(world: &World, bag: &BagEvidence) -> Self {
        let mut motion = Self {
            imus: Vec::new(),
            fixes: Vec::new(),
            poses: Vec::new(),
            twists: Vec::new(),
            simulator: bag.topics.values().find_map(|topic| tables::simulator(&topic.words())),
        };
        for topic in bag.topics.values() {
            let of = &topic.content.motion;
            motion.imus.extend(Imu::of(world, bag, topic));
            motion.fixes.extend(Stream::of_topic(bag, topic, of.fixes.as_ref()));
            let poses = Stream::of_topic(bag, topic, of.poses.as_ref());
            motion.poses.extend(poses.map(|poses| poses.in_ros(world)));
            let twists = Stream::of_topic(bag, topic, of.twists.as_ref());
            motion.twists.extend(twists.map(|twists| twists.in_ros(world)));
        }
        let edges = bag.tf.iter().filter_map(|edge| Stream::of_edge(bag, edge));
        motion.poses.extend(edges.map(|edge| edge.in_ros(world)));
        motion
    }

    /// Where the platform went: by satellite receivers first, then by odometry and poses.
    pub(crate) fn tracks(&self) -> Vec<Track> {
        let fixes = self.fixes.iter().map(Track::of_fixes);
        // Joints move, too, and say nothing of the platform's way.
        let is_way = |poses: &&Stream<PoseRow>| poses.frame.as_ref().is_none_or(names::is_world);
        fixes
            .chain(self.poses.iter().filter(is_way).map(Track::of_poses))
            .collect()
    }
}
