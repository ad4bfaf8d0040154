//! The yaw of a body over time, by an orientation as published.

use nalgebra::{UnitQuaternion, Vector3};

use crate::analysis::{motion::along::near, motion::stream::Stream};
use crate::math::{circular::wrapped, readings::Reading};
use crate::world::motion::{InertialRow, OrientationRow, PoseRow};

/// Longest step between two orientations that a yaw is interpolated over, seconds.
const MAX_STEP_S: f64 = 2.5;
/// Minimum horizontal part of the x axis.
const MIN_HORIZONTAL: f64 = 0.5;

/// A row with an orientation.
pub(crate) trait OrientedRow {
    /// `x y z w` slots as published, not normalised.
    fn slots(&self) -> [f64; 4];
}

macro_rules! oriented {
    ($($row:ty),*) => {$(
        impl OrientedRow for $row {
            fn slots(&self) -> [f64; 4] {
                self.orientation
            }
        }
    )*};
}

oriented!(InertialRow, OrientationRow, PoseRow);

/// Yaw of the base's x axis over time, radians from the world's x towards its y.
pub(crate) struct Yaws {
    stretches: Vec<Vec<(f64, f64)>>,
}

impl Yaws {
    /// By the orientations of a sensor with this mounting.
    pub(crate) fn of<R: OrientedRow>(stream: &Stream<R>, base_from_sensor: &UnitQuaternion<f64>) -> Self {
        let forward = base_from_sensor.inverse() * Vector3::x();
        let yaw = |row: &R| {
            let forward = Reading::Xyzw.world_from_body(row.slots())? * forward;
            (forward.xy().norm() >= MIN_HORIZONTAL).then(|| forward.y.atan2(forward.x))
        };
        let stretches = stream.stretches.iter();
        Self {
            stretches: stretches
                .map(|rows| {
                    rows.iter()
                        .filter_map(|timed| Some((timed.t_s, yaw(&timed.row)?)))
                        .collect()
                })
                .collect(),
        }
    }

    /// The yaw at a time, between two that are known.
    pub(crate) fn at(&self, t_s: f64) -> Option<f64> {
        let ([a, b], share) = near(&self.stretches, t_s, MAX_STEP_S)?;
        Some(a + wrapped(b - a) * share)
    }
}
