//! What the rules of an inertial sensor see together, and the fault that explains it.
//!
//! Made once: each of the rules reports its own measurement, or points to the one that reports the fault.

use std::sync::Arc;

use crate::page::Front;
use crate::rules::Rule;
use crate::rules::motion::{BagMotion, Imu, Motion, Track};
use crate::rules::quat::quaternion_convention::{self, QuaternionConvention};
use crate::world::World;

use super::accel_vs_speed::{self, AccelVsSpeed};
use super::causes::{Diagnosis, Seen};
use super::gyro_vs_turn_sign::{self, GyroVsTurnSign};
use super::heading_convention::{self, HeadingConvention};
use super::imu_gravity_sign::{self, ImuGravitySign};
use super::orientation_vs_gravity::{self, OrientationVsGravity};

/// The diagnoses of every inertial sensor, recording by recording, in the order of [`Motion`].
pub(crate) struct Sensors {
    bags: Vec<Vec<Diagnosis>>,
}

impl Sensors {
    /// The diagnoses of a world; worked out once.
    pub(crate) fn of(world: &World) -> Arc<Self> {
        let motion = Motion::of(world);
        world.derived(|_| Self {
            bags: motion.bags.iter().map(diagnoses).collect(),
        })
    }

    /// Every sensor of the motion with its diagnosis, and its recording's.
    pub(crate) fn each<'a>(
        &'a self,
        motion: &'a Motion,
    ) -> impl Iterator<Item = (&'a BagMotion, &'a Imu, &'a Diagnosis)> {
        let bags = motion.bags.iter().zip(&self.bags);
        bags.flat_map(|(bag, known)| bag.imus.iter().zip(known).map(move |(imu, known)| (bag, imu, known)))
    }
}

/// The limits of another rule's page.
fn limits<R: Rule>() -> Option<R::Limits> {
    Front::parse(R::PAGE).ok()?.limits().ok()
}

fn diagnoses(bag: &BagMotion) -> Vec<Diagnosis> {
    let tracks = bag.tracks();
    let of = |imu: &Imu| Diagnosis::of(seen(imu, &tracks).unwrap_or_default());
    bag.imus.iter().map(of).collect()
}

fn seen(imu: &Imu, tracks: &[Track]) -> Option<Seen> {
    let (base, world) = (limits::<ImuGravitySign>()?, limits::<OrientationVsGravity>()?);
    let (turn, heading) = (limits::<QuaternionConvention>()?, limits::<HeadingConvention>()?);
    let (sense, push) = (limits::<GyroVsTurnSign>()?, limits::<AccelVsSpeed>()?);
    Some(Seen {
        base: imu_gravity_sign::look(imu, &base).ok().map(|seen| seen.class),
        world: orientation_vs_gravity::look(imu, &world).ok().map(|seen| seen.class),
        turn: quaternion_convention::look(imu, &turn).ok().map(|seen| seen.class),
        heading: heading_convention::look(imu, tracks, &heading)
            .ok()
            .map(|seen| seen.class()),
        sense: gyro_vs_turn_sign::look(imu, tracks, &sense).ok().map(|seen| seen.class),
        push: accel_vs_speed::look(imu, tracks, &push).ok().map(|seen| seen.class),
    })
}
