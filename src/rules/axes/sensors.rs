//! What the rules of an inertial sensor see of it, and the fault that explains all of it together.
//!
//! Made once, by the limits of the rules' pages: each of the rules reports what it sees, or points to the one that reports
//! the fault.

use std::sync::Arc;

use crate::page::Front;
use crate::rules::Rule;
use crate::rules::motion::{BagMotion, Imu, Motion, Track};
use crate::rules::quat::quaternion_convention::{self, QuaternionConvention};
use crate::verdict::NotEvaluated;
use crate::world::World;

use super::accel_vs_speed::{self, AccelVsSpeed, Pushed};
use super::causes::{self, Diagnosis, Seen};
use super::gyro_vs_turn_sign::{self, GyroVsTurnSign};
use super::heading_convention::{self, Decided, HeadingConvention};
use super::imu_gravity_sign::{self, ImuGravitySign, Up};
use super::orientation_vs_gravity::{self, Above, OrientationVsGravity};

/// What a rule sees, or why it sees nothing.
pub(crate) type Look<T> = Result<T, (NotEvaluated, String)>;

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
}

/// Every inertial sensor, recording by recording, in the order of [`Motion`].
pub(crate) struct Sensors {
    bags: Vec<Vec<Sensor>>,
}

impl Sensors {
    /// The sensors of a world; looked at once.
    pub(crate) fn of(world: &World) -> Arc<Self> {
        let motion = Motion::of(world);
        world.derived(|_| Self {
            bags: motion.bags.iter().map(|bag| sensors(bag).unwrap_or_default()).collect(),
        })
    }

    /// Every sensor of the motion with what is seen of it.
    pub(crate) fn each<'a>(&'a self, motion: &'a Motion) -> impl Iterator<Item = (&'a Imu, &'a Sensor)> {
        let bags = motion.bags.iter().zip(&self.bags);
        bags.flat_map(|(bag, known)| bag.imus.iter().zip(known))
    }
}

/// The tracks, or why nothing can be held against them.
pub(super) fn needed(tracks: &[Track]) -> Look<()> {
    if tracks.is_empty() {
        let why = "no satellite fixes, odometry or poses show where it went".to_owned();
        return Err((NotEvaluated::MissingInput, why));
    }
    Ok(())
}

/// The limits of another rule's page.
fn limits<R: Rule>() -> Option<R::Limits> {
    Front::parse(R::PAGE).ok()?.limits().ok()
}

/// The sensors of a recording; `None` where a page's limits do not load, which the engine reports.
fn sensors(bag: &BagMotion) -> Option<Vec<Sensor>> {
    if bag.imus.is_empty() {
        return None;
    }
    let (base, world) = (limits::<ImuGravitySign>()?, limits::<OrientationVsGravity>()?);
    let (turn, heading) = (limits::<QuaternionConvention>()?, limits::<HeadingConvention>()?);
    let (sense, push) = (limits::<GyroVsTurnSign>()?, limits::<AccelVsSpeed>()?);
    let tracks = bag.tracks();
    let look = |imu: &Imu| {
        let mut sensor = Sensor {
            base: imu_gravity_sign::look(imu, &base),
            world: orientation_vs_gravity::look(imu, &world),
            turn: quaternion_convention::look(imu, &turn),
            heading: heading_convention::look(imu, &tracks, &heading),
            sense: gyro_vs_turn_sign::look(imu, &tracks, &sense),
            push: accel_vs_speed::look(imu, &tracks, &push),
            diagnosis: Diagnosis::default(),
        };
        sensor.diagnosis = Diagnosis::of(sensor.seen(), &imu.stream.told_in);
        sensor
    };
    Some(bag.imus.iter().map(look).collect())
}

impl Sensor {
    fn seen(&self) -> Seen {
        fn class<T, C>(look: &Look<T>, of: impl Fn(&T) -> C) -> Option<C> {
            look.as_ref().ok().map(of)
        }
        let mut heading = class(&self.heading, Decided::class);
        let mut sense = class(&self.sense, |seen| seen.class);
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
