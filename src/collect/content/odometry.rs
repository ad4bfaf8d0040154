//! Odometry of one topic.

use crate::read::messages::content::Odometry;
use crate::world::Pose;
use crate::world::content::{OdometryEvidence, PoseAt};

use super::super::point::{Point, PointOwner};
use super::super::thin::{SampleBudget, ThinnedSeries};
use super::steps::Steps;

/// Takes in odometry in recording order.
pub(super) struct Odometries {
    samples: ThinnedSeries<(Point, Pose)>,
    steps: Steps,
    largest_speed_m_s: f64,
    largest_turn_rad_s: f64,
}

impl Odometries {
    pub(super) fn new(share: SampleBudget) -> Self {
        Self {
            samples: ThinnedSeries::new(share.poses),
            steps: Steps::new(share),
            largest_speed_m_s: f64::NAN,
            largest_turn_rad_s: f64::NAN,
        }
    }

    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        self.steps.seam();
    }

    pub(super) fn push(&mut self, point: Point, odometry: &Odometry<'_>) {
        if let Some(pose) = Pose::from_raw(odometry.position, odometry.orientation) {
            self.samples.push((point, pose));
            self.steps.push(point, pose);
        }
        enlarge(&mut self.largest_speed_m_s, odometry.linear);
        enlarge(&mut self.largest_turn_rad_s, odometry.angular);
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> OdometryEvidence {
        let at = |(point, pose): (Point, Pose)| PoseAt { at: point.on(on), pose };
        OdometryEvidence {
            samples: self.samples.finish().into_iter().map(at).collect(),
            steps: self.steps.finish(on),
            largest_speed_m_s: self.largest_speed_m_s,
            largest_turn_rad_s: self.largest_turn_rad_s,
        }
    }
}

/// The largest finite length of a vector, NaN before the first.
fn enlarge(largest: &mut f64, vector: [f64; 3]) {
    let length = vector.iter().map(|value| value * value).sum::<f64>().sqrt();
    if length.is_finite() {
        *largest = largest.max(length);
    }
}
