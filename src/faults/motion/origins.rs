//! Mistakes in where frames lie: origins on the Earth that files state, and the correction `map` -> `odom`.

use crate::faults::{Change, Family, Subject, SubjectPlace};
use crate::world::World;
use crate::world::bag::TfEdge;
use crate::world::content::Step;

use super::poses::{PoseMessage, change_poses};
use super::streams::{MovingFrame, Stream};

/// A mistake in the origin of a local frame: what it does to latitude and longitude, degrees.
pub(super) struct OriginChange(pub(super) fn([f64; 2]) -> [f64; 2]);

impl Change for OriginChange {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let origins = world.origins.iter().enumerate();
        let stated = origins.filter(|(_, origin)| origin.latitude_longitude_deg.is_some());
        let subject = |(origin, stated): (usize, &crate::world::EarthOrigin)| Subject {
            name: format!("origin `{}` in {}", stated.label, world.path(stated.place.source)),
            words: vec![format!("`{}`", stated.label), "origin".to_owned()],
            at: SubjectPlace::Origin(origin),
        };
        stated.map(subject).collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Origin(origin) = subject.at else {
            return false;
        };
        let origin = world.origins.get_mut(origin);
        let Some(stated) = origin.and_then(|origin| origin.latitude_longitude_deg.as_mut()) else {
            return false;
        };
        let before = stated.map(f64::to_bits);
        *stated = (self.0)(*stated);
        stated.map(f64::to_bits) != before
    }
}

/// A mistake in the correction of odometry on TF.
pub(super) enum CorrectionChange {
    /// Nobody publishes it.
    Missing,
    /// It stays at its first value.
    Held,
    /// The transform of the child in the parent is published the other way round.
    Inverse,
}

impl Change for CorrectionChange {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let is_meant = |stream: &Stream| stream.family == Family::Pose && stream.moving == MovingFrame::World;
        Stream::all(world).filter(is_meant).map(Subject::from).collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let Some(stream) = Stream::of(subject) else {
            return false;
        };
        match self {
            Self::Missing => {
                let Some(bag) = world.bags.get_mut(stream.bag) else {
                    return false;
                };
                let before = bag.tf.len();
                bag.tf.retain(|edge| !stream.has_edge(edge));
                bag.tf.len() < before
            }
            Self::Held => {
                let held = stream.edges_mut(world).map(hold);
                held.filter(|held| *held).count() > 0
            }
            Self::Inverse => change_poses(world, stream, |message, _| PoseMessage::invert(message)),
        }
    }
}

/// Keeps an edge at its first value; false if it does not move.
fn hold(edge: &mut TfEdge) -> bool {
    let Some(first) = edge.samples.first().map(|sample| sample.pose) else {
        return false;
    };
    for sample in &mut edge.samples {
        sample.pose = first;
    }
    let resting = |step: &Step| Step {
        dt_ns: step.dt_ns,
        distance_m: 0.0,
        angle_rad: 0.0,
        surprise_m: 0.0,
        surprise_rad: 0.0,
    };
    edge.steps.sample = edge.steps.sample.iter().map(resting).collect();
    (edge.steps.moving, edge.steps.undone) = (0, 0);
    (edge.steps.farthest, edge.steps.widest) = (Vec::new(), Vec::new());
    (edge.steps.most_surprising, edge.steps.first_undone) = (Vec::new(), None);
    (edge.motion, edge.contradictions) = (None, None);
    edge.extreme.take().is_some()
}
