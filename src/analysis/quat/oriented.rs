//! Streams of orientations, and the frames that two of them state to share.
//!
//! Must not judge.

use nalgebra::UnitQuaternion;

use crate::analysis::motion::{BagMotion, Motion, Orientations};
use crate::analysis::{Estimates, axes::causes::Aspect, axes::sensors::Sensors};
use crate::source::Place;
use crate::world::{FrameId, World};

/// A stream of orientations.
pub(crate) struct OrientationStream {
    pub(crate) subject: String,
    pub(crate) place: Place,
    /// The frame that it is expressed in, if it has a name.
    pub(crate) world: Option<FrameId>,
    /// The frame that it is the orientation of.
    pub(crate) body: Option<FrameId>,
    /// The measurement that shows a fault of the sensor best; the fault shows here too.
    pub(crate) shown_by: Option<Aspect>,
    pub(crate) turned: Orientations,
}

/// The streams of a recording: poses first.
pub(crate) fn oriented(world: &Estimates, motion: &Motion, bag: &BagMotion) -> Vec<OrientationStream> {
    let sensors = Sensors::of(world);
    let poses = bag.poses.iter().filter(|stream| stream.is_way());
    let poses = poses.map(|stream| OrientationStream {
        subject: stream.subject.clone(),
        place: stream.place(),
        world: stream.frame.clone(),
        body: stream.child.clone(),
        shown_by: None,
        turned: Orientations::of(stream),
    });
    let imus = bag.imus.iter().filter(|imu| imu.no_orientation.is_none());
    let imus = imus.map(|imu| OrientationStream {
        subject: format!("orientation of {}", imu.stream.subject),
        place: imu.stream.place(),
        world: None,
        body: imu.stream.frame.clone(),
        shown_by: sensors
            .each(motion)
            .find(|(known, _)| std::ptr::eq(*known, imu))
            .and_then(|(_, sensor)| sensor.diagnosis.shown_by),
        turned: Orientations::of(&imu.stream),
    });
    poses.chain(imus).collect()
}

/// The frames that two streams state to share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Claim {
    /// `a_from_b` of their bodies, if these are tied to each other: then only the worlds may differ.
    /// Else both are expressed in a frame of the same name, and only the bodies may differ.
    pub(crate) bodies: Option<UnitQuaternion<f64>>,
}

impl Claim {
    /// `None` if they share no frame.
    pub(crate) fn of(world: &World, a: &OrientationStream, b: &OrientationStream) -> Option<Self> {
        let bodies = a.body.as_ref().zip(b.body.as_ref()).and_then(|(a, b)| {
            if a == b {
                return Some(UnitQuaternion::identity());
            }
            let (a_from_b, _) = world.graph().chain(a, b, |edge| edge.is_rigid)?;
            Some(a_from_b.rotation)
        });
        let same_world = a.world.is_some() && a.world == b.world;
        (bodies.is_some() || same_world).then_some(Self { bodies })
    }
}
