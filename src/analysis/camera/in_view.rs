//! What lidars show of the cameras of a recording.

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::analysis::camera::looks::{Reason, ViewEstimate, look};
use crate::analysis::{Estimates, camera::published::RecordedCamera, ground::Planes};
use crate::world::{FrameId, World};

/// What lidars show of every camera of a world: by recording and frame.
pub(crate) struct Views(pub(crate) BTreeMap<(usize, FrameId), Result<ViewEstimate, Reason>>);

impl Views {
    /// Worked out once.
    pub(crate) fn of(world: &Estimates) -> Rc<Self> {
        let planes = Planes::of(world);
        world.once(|world| {
            let limits = world.limits::<crate::analysis::camera::looks::Limits>();
            let views = cameras(world).into_iter().map(|(key, camera)| {
                let shown = look(world, &planes, &camera, &key.1, &limits);
                (key, shown)
            });
            Self(views.collect())
        })
    }
}

/// The first calibration of every camera's frame.
pub(crate) fn cameras(world: &World) -> BTreeMap<(usize, FrameId), RecordedCamera<'_>> {
    let mut cameras = BTreeMap::new();
    for published in RecordedCamera::all(world) {
        let index = world.bags.iter().position(|bag| bag.source == published.bag.source);
        if let (Some(index), Some(frame)) = (index, published.frame()) {
            cameras.entry((index, frame)).or_insert(published);
        }
    }
    cameras
}
