//! What the rules of an inertial sensor see of it, and the fault that explains all of it together.
//!
//! Made once, by the limits of the rules' pages: each of the rules reports what it sees, or points to the one that reports
//! the fault.

use std::sync::Arc;

use crate::rules::limits_of;
use crate::rules::motion::{BagMotion, Imu, Motion, Track};
use crate::rules::quat::quaternion_convention::{self, QuaternionConvention};
use crate::tables::{Offset, Simulator};
use crate::verdict::NotEvaluated;
use crate::world::{FrameId, World};

use super::accel_vs_speed::{self, AccelVsSpeed, Pushed};
use super::bases::{Base, Bases};
use super::causes::{self, Cause, Seen};
use super::diagnosis::{self, Diagnosis};
use super::gyro_vs_turn_sign::{self, GyroVsTurnSign};
use super::heading_convention::{self, Decided, HeadingConvention};
use super::imu_gravity_sign::{self, ImuGravitySign, Up};
use super::orientation_vs_gravity::{self, Above, OrientationVsGravity};
use super::rates::Integrals;
use super::worlds::Worlds;

/// What a rule sees, or why it sees nothing.
pub(crate) type Look<T> = Result<T, (NotEvaluated, String)>;

/// What the place of a track is in a finding.
pub(crate) const TRACK: &str = "where it went";

/// One inertial sensor.
pub(crate) struct Sensor {
    pub(super) base: Look<Up>,
    pub(super) world: Look<Above>,
    pub(crate) turn: Look<quaternion_convention::Turned>,
    pub(super) heading: Look<Decided>,
    pub(super) sense: Look<gyro_vs_turn_sign::Turned>,
    pub(super) push: Look<Pushed>,
    /// The fault that explains them.
    pub(crate) diagnosis: Diagnosis,
    /// What the driver's profile says of the yaw's offset from the course, where that is large.
    pub(crate) offset: Option<Offset>,
    /// The simulator that names in its recording tell.
    pub(super) simulator: Option<Arc<Simulator>>,
    /// What the base's yaw is more than its course, radians, where another axis of it than x points forward.
    pub(super) base_yaw_rad: Option<f64>,
    /// A wrong setting of a driver that would look the same as what was seen.
    pub(crate) unseen: Option<&'static Cause>,
}

/// Every inertial sensor, recording by recording, in the order of [`Motion`].
pub(crate) struct Sensors {
    bags: Vec<Vec<Sensor>>,
}

impl Sensors {
    /// The sensors of a world; looked at once.
    pub(crate) fn of(world: &World) -> Arc<Self> {
        let (motion, bases, worlds) = (Motion::of(world), Bases::of(world), Worlds::of(world));
        world.derived(|_| Self {
            bags: motion
                .bags
                .iter()
                .zip(&bases.bags)
                .enumerate()
                .map(|(index, (bag, bases))| {
                    sensors(bag, bases, |frame| worlds.is_off(index, frame)).unwrap_or_default()
                })
                .collect(),
        })
    }

    /// The sensors of one of the recordings.
    pub(crate) fn of_bag(&self, index: usize) -> &[Sensor] {
        self.bags.get(index).map_or(&[], Vec::as_slice)
    }

    /// Every sensor of the motion with what is seen of it.
    pub(crate) fn each<'a>(&'a self, motion: &'a Motion) -> impl Iterator<Item = (&'a Imu, &'a Sensor)> {
        let bags = motion.bags.iter().zip(&self.bags);
        bags.flat_map(|(bag, known)| bag.imus.iter().zip(known))
    }
}

/// The tracks, or why nothing can be held against them.
pub(super) fn needed(tracks: &[Arc<Track>]) -> Look<()> {
    if tracks.is_empty() {
        let why = "no satellite fixes, odometry or poses show where it went".to_owned();
        return Err((NotEvaluated::MissingInput, why));
    }
    Ok(())
}

/// The sensors of a recording; `None` where a page's limits do not load, which the engine reports.
fn sensors(bag: &BagMotion, bases: &[Base], is_off: impl Fn(Option<&FrameId>) -> bool) -> Option<Vec<Sensor>> {
    if bag.imus.is_empty() {
        return None;
    }
    let (base, world) = (limits_of::<ImuGravitySign>()?, limits_of::<OrientationVsGravity>()?);
    let (turn, heading) = (limits_of::<QuaternionConvention>()?, limits_of::<HeadingConvention>()?);
    let (sense, push) = (limits_of::<GyroVsTurnSign>()?, limits_of::<AccelVsSpeed>()?);
    // In a frame whose z points down, tracks turn the other way; in one that lies on its side, they are no track.
    let tracks = bag.tracks(is_off);
    let asked = |(why, reason): (NotEvaluated, String)| match why {
        NotEvaluated::TooLittleEvidence => (why, tracks.why(reason)),
        _ => (why, reason),
    };
    let look = |imu: &Imu| {
        let integrals = Integrals::of(imu);
        let mut sensor = Sensor {
            base: imu_gravity_sign::look(imu, &base),
            world: orientation_vs_gravity::look(imu, &world),
            turn: quaternion_convention::look(imu, &turn),
            heading: heading_convention::look(imu, &tracks.asked, &heading).map_err(asked),
            sense: gyro_vs_turn_sign::look(&integrals, &tracks.asked, &sense).map_err(asked),
            push: accel_vs_speed::look(imu, &integrals, &tracks.asked, &push).map_err(asked),
            diagnosis: Diagnosis::default(),
            offset: None,
            simulator: bag.simulator.clone(),
            base_yaw_rad: None,
            unseen: None,
        };
        let decided = sensor.heading.as_ref().ok();
        sensor.offset = decided.and_then(|decided| decided.known_offset(imu, &heading));
        let mount = imu.mount.as_ref().map(|mount| &mount.base);
        let on = bases.iter().find(|base| Some(&base.frame) == mount);
        let on = on.and_then(|base| base.seen.as_ref().ok());
        let seen = sensor.seen();
        sensor.diagnosis = Diagnosis::of(seen, &imu.stream.told_in, imu.driver.clone());
        sensor.unseen = diagnosis::unseen(seen);
        if let Some(on) = on.filter(|on| on.is_turned() || on.is_backward()) {
            sensor.diagnosis.leave_mounting_to("AXES13");
            sensor.base_yaw_rad = on.yaw_minus_course_rad();
        }
        sensor.offset = sensor.offset.filter(|_| sensor.base_yaw_rad.is_none());
        sensor
    };
    Some(bag.imus.iter().map(look).collect())
}

impl Sensor {
    /// Where its acceleration points in the base; `None` where that was not measured.
    pub(crate) fn stands(&self) -> Option<causes::Base> {
        self.base.as_ref().ok().map(|up| up.class)
    }

    /// Whether a track that it turns against may be the one with the other hand: poses of a simulator, beside an upright sensor.
    pub(super) fn may_doubt(&self, is_geodetic: bool) -> bool {
        self.simulator.is_some() && !is_geodetic && self.stands() == Some(causes::Base::Up)
    }

    /// Angle between the acceleration and the world's up, by the orientation, radians; or why it was not measured.
    pub(crate) fn up_rad(&self) -> Look<f64> {
        self.world.as_ref().map(Above::off_up_rad).map_err(Clone::clone)
    }

    /// Yaw minus course, radians, where the track knows where east is; or why it was not measured.
    pub(crate) fn offset_rad(&self) -> Look<f64> {
        self.heading
            .as_ref()
            .map_err(Clone::clone)
            .and_then(Decided::offset_rad)
    }

    fn seen(&self) -> Seen {
        fn class<T, C>(look: &Look<T>, of: impl Fn(&T) -> C) -> Option<C> {
            look.as_ref().ok().map(of)
        }
        // What the poses of a simulator contradict is SENSOR09's.
        let mut heading = class(&self.heading, Decided::class)
            .filter(|_| !self.heading.as_ref().is_ok_and(|seen| seen.is_by_a_simulator(self)));
        let mut sense = class(&self.sense, |seen| seen.class)
            .filter(|_| !self.sense.as_ref().is_ok_and(|seen| seen.is_by_a_simulator(self)));
        // Two tracks that contradict each other: what turns against one may be the track's fault, so the other says nothing.
        if let (Ok(by_yaw), Ok(by_gyro)) = (&self.heading, &self.sense)
            && by_yaw.track != by_gyro.track
        {
            match (heading, sense) {
                (Some(causes::Heading::With), Some(causes::Sense::Against)) => heading = None,
                (Some(causes::Heading::Against), Some(causes::Sense::With)) => sense = None,
                _ => {}
            }
        }
        Seen {
            base: class(&self.base, |seen| seen.class),
            world: class(&self.world, |seen| seen.class),
            turn: class(&self.turn, |seen| seen.class),
            heading,
            sense,
            push: class(&self.push, |seen| seen.class),
        }
    }
}
