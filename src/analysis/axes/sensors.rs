//! All measurements of an inertial sensor, and the fault that explains them together.
//!
//! Made once, with the limits of the rules' pages: each rule reports its own measurement, or defers to the rule that reports
//! the fault.

use std::rc::Rc;
use std::sync::Arc;

use crate::analysis::axes::bases::{Base, Bases};
use crate::analysis::axes::causes::{Cause, Symptoms};
use crate::analysis::axes::{causes, diagnosis, gyro_vs_track};
use crate::analysis::motion::{BagMotion, Imu, Motion};
use crate::analysis::{
    Estimates, axes::base_up::BaseUp, axes::diagnosis::Diagnosis, axes::push::AccelFit, axes::rates::Integrals,
    axes::world_up::WorldUp, axes::worlds::Worlds, axes::yaw_vs_course::HeadingFit, look::Estimate,
};
use crate::tables::{Offset, Simulator};
use crate::verdict::NotEvaluated;
use crate::world::FrameId;

/// One inertial sensor.
pub(crate) struct Sensor {
    pub(crate) base: Estimate<BaseUp>,
    pub(crate) world: Estimate<WorldUp>,
    pub(crate) turn: Estimate<crate::analysis::quat::ways::GyroAgreement>,
    pub(crate) heading: Estimate<HeadingFit>,
    pub(crate) sense: Estimate<gyro_vs_track::GyroFit>,
    pub(crate) push: Estimate<AccelFit>,
    /// The fault that explains them.
    pub(crate) diagnosis: Diagnosis,
    /// The entry of the driver's profile for the yaw's offset from the course, if that is large.
    pub(crate) offset: Option<Offset>,
    /// The simulator that names in the recording identify.
    pub(crate) simulator: Option<Arc<Simulator>>,
    /// Yaw minus course of the base, radians, if another axis than its x points forward.
    pub(crate) base_yaw_rad: Option<f64>,
    /// A wrong driver setting that the measurements do not rule out.
    pub(crate) unseen: Option<&'static Cause>,
}

/// Every inertial sensor, recording by recording, in the order of [`Motion`].
pub(crate) struct Sensors {
    bags: Vec<Vec<Sensor>>,
}

impl Sensors {
    /// The sensors of a world; made once.
    pub(crate) fn of(world: &Estimates) -> Rc<Self> {
        let (motion, bases, worlds) = (Motion::of(world), Bases::of(world), Worlds::of(world));
        world.once(|world| Self {
            bags: motion
                .bags
                .iter()
                .zip(&bases.bags)
                .enumerate()
                .map(|(index, (bag, bases))| sensors(world, bag, bases, |frame| worlds.is_off(index, frame)))
                .collect(),
        })
    }

    /// The sensors of one of the recordings.
    pub(crate) fn of_bag(&self, index: usize) -> &[Sensor] {
        self.bags.get(index).map_or(&[], Vec::as_slice)
    }

    /// Every sensor of the motion with its measurements.
    pub(crate) fn each<'a>(&'a self, motion: &'a Motion) -> impl Iterator<Item = (&'a Imu, &'a Sensor)> {
        let bags = motion.bags.iter().zip(&self.bags);
        bags.flat_map(|(bag, known)| bag.imus.iter().zip(known))
    }
}

/// The sensors of a recording.
fn sensors(
    estimates: &Estimates,
    bag: &BagMotion,
    bases: &[Base],
    is_off: impl Fn(Option<&FrameId>) -> bool,
) -> Vec<Sensor> {
    if bag.imus.is_empty() {
        return Vec::new();
    }
    let (base, world) = (
        estimates.limits::<crate::analysis::axes::base_up::Limits>(),
        estimates.limits::<crate::analysis::axes::world_up::Limits>(),
    );
    let (turn, heading) = (
        estimates.limits::<crate::analysis::quat::ways::Limits>(),
        estimates.limits::<crate::analysis::axes::heading::Limits>(),
    );
    let (sense, push) = (
        estimates.limits::<gyro_vs_track::Limits>(),
        estimates.limits::<crate::analysis::axes::push::Limits>(),
    );
    // In a frame with z down, tracks turn the other way; in one on its side, they are no tracks.
    let tracks = bag.tracks(is_off);
    let asked = |(why, reason): (NotEvaluated, String)| match why {
        NotEvaluated::TooLittleEvidence => (why, tracks.why(reason)),
        _ => (why, reason),
    };
    let look = |imu: &Imu| {
        let integrals = Integrals::of(imu);
        let mut sensor = Sensor {
            base: crate::analysis::axes::base_up::look(imu, &base),
            world: crate::analysis::axes::world_up::look(imu, &world),
            turn: crate::analysis::quat::turned::look(imu, &turn),
            heading: crate::analysis::axes::yaw_vs_course::look(imu, &tracks.asked, &heading).map_err(asked),
            sense: gyro_vs_track::look(&integrals, &tracks.asked, &sense).map_err(asked),
            push: crate::analysis::axes::push::look(imu, &integrals, &tracks.asked, &push).map_err(asked),
            diagnosis: Diagnosis::default(),
            offset: None,
            simulator: bag.simulator.clone(),
            base_yaw_rad: None,
            unseen: None,
        };
        // What moves on the platform turns and speeds up otherwise.
        if let (Some(carrier), Some(frame)) = (&imu.carrier, &imu.stream.frame) {
            let why =
                format!("`{frame}` moves relative to `{carrier}` by TF, so the track of the platform is not its own");
            let apart = || (NotEvaluated::NotApplicable, why.clone());
            sensor.base = Err(apart());
            sensor.heading = Err(apart());
            sensor.sense = Err(apart());
            sensor.push = Err(apart());
        }
        // A gyro that nothing confirms may be in degrees, and show only its bias.
        if sensor.turn.is_err() && sensor.sense.as_ref().is_ok_and(gyro_vs_track::GyroFit::confirms_gyro) {
            let still = crate::analysis::quat::turned::still(imu, &turn);
            sensor.turn = still.map_or(sensor.turn, Ok);
        }
        // Poses of a simulator may be left-handed; and where the course turns unlike the gyro, the platform does not move where it faces.
        let is_doubtful = sensor.push.as_ref().is_ok_and(|seen| {
            let mut own = tracks.asked.iter().filter(|track| track.subject == seen.track);
            seen.hand.is_some_and(|hand| {
                hand == causes::Hand::Left && sensor.may_doubt(seen.is_geodetic)
                    || own.any(|track| gyro_vs_track::is_uncoupled(&integrals, track, &sense))
            })
        });
        if let Ok(seen) = &mut sensor.push
            && is_doubtful
        {
            seen.hand = None;
        }
        // A yaw that is the integral of its gyro is not compared with a course that is unrelated to the gyro.
        if let Ok(seen) = &sensor.heading
            && seen.class() == causes::Heading::Against
            && sensor.sense.is_err()
            && sensor
                .turn
                .as_ref()
                .is_ok_and(|turned| turned.class == causes::Turn::Agree)
        {
            let mut own = tracks.asked.iter().filter(|track| track.subject == seen.track);
            if own.any(|track| gyro_vs_track::is_uncoupled(&integrals, track, &sense)) {
                let why = "the course is unrelated to the gyro, with which the yaw agrees: the platform does not move where it faces";
                sensor.heading = Err((NotEvaluated::TooLittleEvidence, why.to_owned()));
            }
        }
        let decided = sensor.heading.as_ref().ok();
        sensor.offset = decided.and_then(|decided| decided.known_offset(imu, &heading));
        let mount = imu.mount.as_ref().map(|mount| &mount.base);
        let on = bases.iter().find(|base| Some(&base.frame) == mount);
        let on = on.and_then(|base| base.seen.as_ref().ok());
        // Of what moves sideways, too, the course says nothing about the direction of x.
        if on.is_some_and(|on| on.forward.is_none()) {
            let why = "the platform moves in several directions of its base: its course is not that of its x axis";
            sensor.push = Err((NotEvaluated::TooLittleEvidence, why.to_owned()));
        }
        let seen = sensor.symptoms();
        sensor.diagnosis = Diagnosis::of(seen, &imu.stream.expressed_in, imu.driver.clone());
        sensor.unseen = diagnosis::unseen(seen);
        if let Some(on) = on.filter(|on| on.is_turned() || on.is_backward()) {
            sensor.diagnosis.leave_mounting_to_body(on.is_backward());
            sensor.base_yaw_rad = on.yaw_minus_course_rad();
        }
        sensor.offset = sensor.offset.filter(|_| sensor.base_yaw_rad.is_none());
        sensor
    };
    bag.imus.iter().map(look).collect()
}

impl Sensor {
    /// Direction of its acceleration in the base; `None` if it was not measured.
    pub(crate) fn stands(&self) -> Option<causes::Base> {
        self.base.as_ref().ok().map(|up| up.class)
    }

    /// Whether a track that it contradicts may be the left-handed one: poses of a simulator, beside an upright sensor.
    fn may_doubt(&self, is_geodetic: bool) -> bool {
        self.simulator.is_some() && !is_geodetic && self.stands() == Some(causes::Base::Up)
    }

    /// Whether the yaw contradicts poses of a simulator, which may be left-handed.
    pub(crate) fn heading_is_against_a_simulator(&self) -> bool {
        let heading = self.heading.as_ref();
        heading.is_ok_and(|seen| seen.class() == causes::Heading::Against && self.may_doubt(seen.is_geodetic))
    }

    /// Whether the gyro contradicts poses of a simulator, which may be left-handed.
    pub(crate) fn sense_is_against_a_simulator(&self) -> bool {
        let sense = self.sense.as_ref();
        sense.is_ok_and(|seen| seen.class == causes::Sense::Against && self.may_doubt(seen.is_geodetic))
    }

    /// Angle between the acceleration and the world's up, by the orientation, radians; or why it was not measured.
    pub(crate) fn up_rad(&self) -> Estimate<f64> {
        self.world.as_ref().map_err(Clone::clone).and_then(WorldUp::off_up_rad)
    }

    /// Yaw minus course, radians, if the track knows east; or why it was not measured.
    pub(crate) fn offset_rad(&self) -> Estimate<f64> {
        self.heading
            .as_ref()
            .map_err(Clone::clone)
            .and_then(HeadingFit::offset_rad)
    }

    fn symptoms(&self) -> Symptoms {
        fn class<T, C>(look: &Estimate<T>, of: impl Fn(&T) -> C) -> Option<C> {
            look.as_ref().ok().map(of)
        }
        // A contradiction with the poses of a simulator may be the poses' fault.
        let mut heading = class(&self.heading, HeadingFit::class).filter(|_| !self.heading_is_against_a_simulator());
        let mut sense = class(&self.sense, |seen| seen.class).filter(|_| !self.sense_is_against_a_simulator());
        // Two tracks that contradict each other: a contradiction with one of them may be the track's fault and is not counted.
        if let (Ok(by_yaw), Ok(by_gyro)) = (&self.heading, &self.sense)
            && by_yaw.track != by_gyro.track
        {
            match (heading, sense) {
                (Some(causes::Heading::With), Some(causes::Sense::Against)) => heading = None,
                (Some(causes::Heading::Against), Some(causes::Sense::With)) => sense = None,
                _ => {}
            }
        }
        // The curves of one track say nothing of the turns of another.
        let hand = self.push.as_ref().ok().filter(|by_push| {
            let by_gyro = self.sense.as_ref().ok();
            by_gyro.is_none_or(|by_gyro| by_gyro.track == by_push.track)
        });
        Symptoms {
            base: class(&self.base, |seen| seen.class),
            world: class(&self.world, WorldUp::sign).flatten(),
            turn: class(&self.turn, |seen| seen.class),
            heading,
            sense,
            push: class(&self.push, |seen| seen.class),
            hand: hand.and_then(|seen| seen.hand),
        }
    }
}
