//! The motion of a recording on one clock: inertial sensors, GNSS tracks, poses and velocities.
//!
//! Made once for all rules that judge motion. Data are as published, or converted to the convention of ROS if the configuration or
//! a frame's name declares another one. Must not judge.

mod along;
pub(crate) mod clock;
mod compass;
mod convention;
mod imu;
mod inertial;
pub(crate) mod mount;
mod nmea;
mod stream;
mod track;
mod tracks;
mod turned;
mod yaw;

use std::rc::Rc;
use std::sync::Arc;

use crate::analysis::Estimates;
use crate::tables::Simulator;
use crate::world::motion::{FixRow, NmeaRow, OrientationRow, PoseRow, TwistRow};
use crate::world::{BagEvidence, FrameId, bag::TopicEvidence};

pub(crate) use along::{Follower, around};
pub(crate) use compass::Compass;
pub(crate) use convention::StreamConvention;
pub(crate) use imu::Imu;

pub(crate) use stream::{Stream, TimedRow, edge_subject};
pub(crate) use track::{Course, Track};
pub(crate) use tracks::Tracks;
pub(crate) use turned::Orientations;
pub(crate) use yaw::Yaws;

/// The streams of motion of each recording of a world, in its order.
pub(crate) struct Motion {
    /// One for each of the world's recordings.
    pub(crate) bags: Vec<BagMotion>,
}

/// The streams of motion of one recording, by topic, and by field if they are inside messages.
pub(crate) struct BagMotion {
    /// Inertial sensors.
    pub(crate) imus: Vec<Imu>,
    /// GNSS receivers, including those that publish NMEA 0183 sentences.
    pub(crate) fixes: Vec<Stream<FixRow>>,
    /// Odometry, poses on topics, and moving transforms.
    pub(crate) poses: Vec<Stream<PoseRow>>,
    /// If none of these is the platform's track: the tracks of recordings made at the same time, on its clock.
    beside: Vec<Stream<PoseRow>>,
    /// Velocities on topics of their own.
    pub(crate) twists: Vec<Stream<TwistRow>>,
    /// The simulator that names in the recording identify.
    pub(crate) simulator: Option<Arc<Simulator>>,
    /// Velocities of GNSS receivers, east, north, up, without an angular velocity.
    pub(crate) velocities: Vec<Stream<TwistRow>>,
    /// Orientations on topics of their own.
    pub(crate) orientations: Vec<Stream<OrientationRow>>,
    /// Sentences of NMEA 0183.
    pub(crate) nmea: Vec<Stream<NmeaRow>>,
}

impl Motion {
    /// The motion of a world; made once.
    pub(crate) fn of(world: &Estimates) -> Rc<Self> {
        world.once(|world| {
            let mut bags: Vec<BagMotion> = world.bags.iter().map(|bag| BagMotion::of(world, bag)).collect();
            let beside: Vec<_> = (0..bags.len())
                .map(|index| ways_beside(&world.bags, &bags, index))
                .collect();
            for (bag, beside) in bags.iter_mut().zip(beside) {
                bag.beside = beside;
            }
            Self { bags }
        })
    }
}

/// The platform's tracks in recordings made at the same time, on the clock of this one.
fn ways_beside(bags: &[BagEvidence], motions: &[BagMotion], index: usize) -> Vec<Stream<PoseRow>> {
    let (Some(own), Some(motion)) = (bags.get(index), motions.get(index)) else {
        return Vec::new();
    };
    if motion.ways().next().is_some() {
        return Vec::new();
    }
    let others = bags.iter().zip(motions).filter(|(other, _)| other.source != own.source);
    let on_clock = |(other, motion): (&BagEvidence, &BagMotion)| {
        let (start_ns, end_ns) = other.start_ns.zip(other.end_ns)?;
        let is_while = start_ns < own.end_ns? && own.start_ns? < end_ns;
        let later_s = start_ns.saturating_sub(own.start_ns?) as f64 * 1e-9;
        is_while.then(|| motion.ways().map(|way| way.later(later_s)).collect::<Vec<_>>())
    };
    others.filter_map(on_clock).flatten().collect()
}

impl BagMotion {
    /// The poses of the platform: its own, else those of recordings made at the same time.
    pub(crate) fn ways(&self) -> impl Iterator<Item = &Stream<PoseRow>> {
        self.poses.iter().filter(|poses| poses.is_way()).chain(&self.beside)
    }

    fn of(world: &Estimates, bag: &BagEvidence) -> Self {
        let limits = world.limits::<crate::analysis::geo::kinds::Limits>();
        let mut motion = Self {
            imus: Vec::new(),
            fixes: Vec::new(),
            poses: Vec::new(),
            beside: Vec::new(),
            twists: Vec::new(),
            simulator: bag
                .topics
                .values()
                .find_map(|topic| world.tables.simulator(&topic.words())),
            velocities: Vec::new(),
            orientations: Vec::new(),
            nmea: Vec::new(),
        };
        for said in bag.topics.values().flat_map(TopicEvidence::contents) {
            let of = &said.content.motion;
            motion.imus.extend(Imu::of(world, bag, &said));
            motion.fixes.extend(Stream::of(bag, &said, of.fixes.as_ref()));
            let poses = Stream::of(bag, &said, of.poses.as_ref());
            motion
                .poses
                .extend(poses.map(|poses| poses.in_ros(world).on_earth(&limits)));
            let twists = Stream::of(bag, &said, of.twists.as_ref());
            // Beside fixes they are the receiver's: east, north, up in any frame.
            if of.fixes.is_some() {
                motion.velocities.extend(twists);
            } else {
                motion.twists.extend(twists.map(|twists| twists.in_ros(world)));
            }
            let orientations = Stream::of(bag, &said, of.orientations.as_ref());
            motion
                .orientations
                .extend(orientations.map(|orientations| orientations.in_ros(world)));
            let positions = of.nmea.as_ref().map(nmea::positions);
            motion.fixes.extend(Stream::of(bag, &said, positions.as_ref()));
            motion.nmea.extend(Stream::of(bag, &said, of.nmea.as_ref()));
        }
        let edges = bag.tf.iter().filter_map(|edge| Stream::of_edge(bag, edge));
        motion
            .poses
            .extend(edges.map(|edge| edge.in_ros(world).on_earth(&limits)));
        motion
    }

    /// The moving transform of TF from a frame to a child, or to any.
    pub(crate) fn transform(&self, frame: &FrameId, child: Option<&FrameId>) -> Option<&Stream<PoseRow>> {
        self.poses.iter().find(|stream| {
            let is_of_child = child.is_none_or(|child| stream.child.as_ref() == Some(child));
            stream.is_transform && stream.frame.as_ref() == Some(frame) && is_of_child
        })
    }

    /// The platform's tracks: by GNSS receivers first, guessed ones last, then by odometry and poses in frames that are not
    /// left out.
    pub(crate) fn tracks(&self, is_left_out: impl Fn(Option<&FrameId>) -> bool) -> Tracks {
        let mut fixes: Vec<&Stream<FixRow>> = self.fixes.iter().collect();
        fixes.sort_by_key(|fixes| fixes.guessed);
        // Joints move as well, but are no track of the platform.
        let is_way = |poses: &&Stream<PoseRow>| {
            poses.is_of_world() && !poses.is_earth_centred() && !is_left_out(poses.frame.as_ref())
        };
        let poses: Vec<&Stream<PoseRow>> = self.poses.iter().filter(is_way).collect();
        Tracks::of(&fixes, &poses)
    }

    /// Angles clockwise from north that the recording states: headings first, then courses over ground.
    pub(crate) fn compasses(&self) -> Vec<Compass> {
        let mut all: Vec<Compass> = self.nmea.iter().flat_map(Compass::all).collect();
        all.sort_by_key(|compass| compass.kind);
        all
    }
}
