//! The white noise that a stream of poses shows, message by message.
//!
//! Owns the runs it is taken from. Must not know which noise the messages state.

use nalgebra::{Rotation2, UnitQuaternion, Vector2, Vector3};

use crate::analysis::motion::{Stream, TimedRow};
use crate::math::noise::{Ellipse, fourth_difference};
use crate::math::readings::Reading;
use crate::math::stats::{mad, median};
use crate::world::{bag::TopicEvidence, motion::PoseRow};

/// Steps between poses may differ by this share from the usual one.
const UNEVEN: f64 = 0.25;
/// Longest step between poses, seconds: a platform's motion over four of them is smooth.
const MAX_STEP_S: f64 = 0.25;

/// The noise of one pose against its neighbours.
struct Residual {
    /// Metres, in the frame of the pose.
    linear: Vector3<f64>,
    /// Radians, about the fixed axes of that frame.
    angular: Vector3<f64>,
    yaw_rad: f64,
}

/// Variances that do not depend on the yaw: m², rad².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Variances {
    /// Of x and y, in the mean.
    pub(crate) horizontal: f64,
    /// Of z.
    pub(crate) vertical: f64,
    /// About x and y, in the mean.
    pub(crate) tilt: f64,
    /// About z.
    pub(crate) yaw: f64,
}

/// The noise of a stream.
pub(crate) struct Noise {
    residuals: Vec<Residual>,
    /// Messages behind a row, which is their mean.
    per_row: f64,
}

impl Noise {
    /// The noise of a stream; empty where its steps are too uneven or too long.
    pub(crate) fn of(stream: &Stream<PoseRow>, topic: &TopicEvidence) -> Self {
        let steps = |rows: &Vec<TimedRow<PoseRow>>| -> Vec<f64> {
            let pairs = rows.windows(2);
            pairs
                .filter_map(|pair| Some(pair.get(1)?.t_s - pair.first()?.t_s))
                .collect()
        };
        let all: Vec<f64> = stream.stretches.iter().flat_map(steps).collect();
        let step_s = median(&all).unwrap_or(f64::NAN);
        let mut residuals = Vec::new();
        if step_s <= MAX_STEP_S {
            for rows in &stream.stretches {
                residuals.extend(rows.windows(5).filter_map(|five| residual(five, step_s)));
            }
        }
        let span_ns = topic.last_log_ns.zip(topic.first_log_ns);
        let span_s = span_ns.map_or(f64::NAN, |(last, first)| last.saturating_sub(first) as f64 / 1e9);
        let messages = topic.total.unwrap_or(topic.count).max(topic.count);
        let per_row = messages as f64 / span_s * step_s;
        Self {
            residuals,
            per_row: if per_row.is_finite() { per_row.max(1.0) } else { 1.0 },
        }
    }

    /// How many poses it was measured at.
    pub(crate) fn count(&self) -> usize {
        self.residuals.len()
    }

    /// Variances of one message; robust. `None` without any.
    pub(crate) fn variances(&self) -> Option<Variances> {
        let of = |value: &dyn Fn(&Residual) -> f64| {
            let values: Vec<f64> = self.residuals.iter().map(value).collect();
            // A few jumps must not dominate the variance. Normal noise is not cut off.
            let most = 6.0 * mad(&values)?;
            let kept: Vec<f64> = values.into_iter().filter(|value| value.abs() <= most).collect();
            let squares: f64 = kept.iter().map(|value| value * value).sum();
            Some(self.per_row * squares / (kept.len() as f64).max(1.0))
        };
        Some(Variances {
            horizontal: f64::midpoint(of(&|one| one.linear.x)?, of(&|one| one.linear.y)?),
            vertical: of(&|one| one.linear.z)?,
            tilt: f64::midpoint(of(&|one| one.angular.x)?, of(&|one| one.angular.y)?),
            yaw: of(&|one| one.angular.z)?,
        })
    }

    /// The ellipse of the horizontal noise in the axes of the frame of the poses, and in those of the body by its yaw.
    pub(crate) fn ellipses(&self) -> Option<(Ellipse, Ellipse)> {
        let lengths: Vec<f64> = self.residuals.iter().map(|one| one.linear.xy().norm()).collect();
        // A few jumps must not dominate the ellipse.
        let most = 4.0 * median(&lengths)?;
        let kept = || self.residuals.iter().filter(move |one| one.linear.xy().norm() <= most);
        let in_body = |one: &Residual| -> Vector2<f64> { Rotation2::new(-one.yaw_rad) * one.linear.xy() };
        let scaled = |ellipse: Ellipse| Ellipse {
            trace: ellipse.trace * self.per_row,
            ..ellipse
        };
        Some((
            scaled(Ellipse::of_vectors(kept().map(|one| one.linear.xy()))?),
            scaled(Ellipse::of_vectors(kept().map(in_body))?),
        ))
    }
}

/// The yaw of a pose, radians.
pub(crate) fn yaw(orientation: [f64; 4]) -> Option<f64> {
    let rotation = Reading::Xyzw.world_from_body(orientation)?;
    Some(rotation.euler_angles().2)
}

fn residual(five: &[TimedRow<PoseRow>], step_s: f64) -> Option<Residual> {
    let [a, b, c, d, e] = five else { return None };
    let rows = [a, b, c, d, e];
    let even =
        |(one, next): (&&TimedRow<PoseRow>, &&TimedRow<PoseRow>)| ((next.t_s - one.t_s) / step_s - 1.0).abs() <= UNEVEN;
    if !rows.iter().zip(rows.iter().skip(1)).all(even) {
        return None;
    }
    let middle = Reading::Xyzw.world_from_body(c.row.orientation)?;
    let turn = |row: &TimedRow<PoseRow>| -> Option<Vector3<f64>> {
        let rotation: UnitQuaternion<f64> = Reading::Xyzw.world_from_body(row.row.orientation)?;
        Some((rotation * middle.inverse()).scaled_axis())
    };
    let turns = [turn(a)?, turn(b)?, turn(c)?, turn(d)?, turn(e)?];
    let linear = fourth_difference(rows.map(|row| Vector3::from(row.row.position)));
    let angular = fourth_difference(turns);
    let is_finite = linear.iter().chain(angular.iter()).all(|value| value.is_finite());
    is_finite.then(|| Residual {
        linear,
        angular,
        yaw_rad: middle.euler_angles().2,
    })
}
