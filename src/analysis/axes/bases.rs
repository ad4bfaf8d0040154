//! Directions of the axes of a platform's own frame, by pose and velocity of its odometry and by gravity.
//!
//! Made once: the rules of inertial sensors leave a rotated base to AXES13. Must not report.

use std::rc::Rc;

use nalgebra::Vector3;
use serde::Deserialize;

use crate::analysis::motion::{BagMotion, Imu, Motion, Orientations, Stream};
use crate::analysis::{Estimates, axes::turns_with::turns_with, look::Estimate, names};
use crate::math::readings::Reading;
use crate::source::Place;
use crate::verdict::NotEvaluated;
use crate::world::{FrameId, motion::PoseRow};

/// A direction along an axis of the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Axis {
    /// 0, 1, 2: x, y, z.
    pub(crate) index: usize,
    pub(crate) is_negative: bool,
}

impl Axis {
    /// The axis that a direction lies along, to within an angle.
    fn near(direction: &Vector3<f64>, max_deg: f64) -> Option<Self> {
        let index = direction.iamax();
        let part = direction.get(index).copied()? / direction.norm();
        (part.abs() >= max_deg.to_radians().cos()).then_some(Self {
            index,
            is_negative: part < 0.0,
        })
    }

    pub(crate) fn vector(self) -> Vector3<f64> {
        let mut vector = Vector3::zeros();
        if let Some(part) = vector.get_mut(self.index) {
            *part = if self.is_negative { -1.0 } else { 1.0 };
        }
        vector
    }

    pub(crate) fn word(self) -> &'static str {
        match (self.index, self.is_negative) {
            (0, false) => "x",
            (1, false) => "y",
            (_, false) => "z",
            (0, true) => "-x",
            (1, true) => "-y",
            (_, true) => "-z",
        }
    }
}

/// Measurements of one base.
pub(crate) struct BaseEstimate {
    /// The axis of the base that points forward.
    pub(crate) forward: Option<Axis>,
    /// Agreement of the windows on it, 0 to 1.
    pub(crate) concentration: f64,
    /// The axis that points along z of the world, by the pose.
    pub(crate) up: Option<Axis>,
    /// The axis that points up by gravity, and the sensor that measures it.
    pub(crate) gravity: Option<(Axis, String)>,
    /// A sensor on the base to whose gyro the pose rotates opposite: the two use different axes of the base.
    pub(crate) against: Option<String>,
    /// Whether the velocity that is published with the pose points along the same axis; `None` without one.
    pub(crate) twist_agrees: Option<bool>,
    pub(crate) way_m: f64,
    /// Whether z points up once the four numbers are read as w, x, y, z.
    pub(crate) is_up_reordered: bool,
}

impl BaseEstimate {
    /// Whether the base itself is rotated: the pose shows it, and nothing contradicts.
    pub(crate) fn is_turned(&self) -> bool {
        self.is_upside_down() || self.is_sideways()
    }

    /// Whether its x points to the rear, or it drives in reverse throughout.
    pub(crate) fn is_backward(&self) -> bool {
        self.forward
            .is_some_and(|forward| forward.index == 0 && forward.is_negative)
            && self.twist_agrees != Some(false)
    }

    /// Yaw minus course of the base, radians, if another axis than x points forward.
    pub(crate) fn yaw_minus_course_rad(&self) -> Option<f64> {
        let forward = self.forward.filter(|_| self.is_sideways() || self.is_backward())?;
        let forward = forward.vector();
        (forward.z == 0.0).then(|| -forward.y.atan2(forward.x))
    }

    /// Whether its z points down in the world, unless gravity shows that the world is upside down.
    pub(crate) fn is_upside_down(&self) -> bool {
        // Without gravity another axis than -z may be the world's fault: a camera's map, or Earth-fixed axes.
        self.up.is_some_and(|up| match &self.gravity {
            Some((axis, _)) if *axis == up => up.index != 2 || up.is_negative,
            // In an upside-down world, the pose rotates with the gyro.
            Some((axis, _)) => self.against.is_some() && up.index == 2 && up.is_negative && axis.index == 2,
            None => up.index == 2 && up.is_negative,
        })
    }

    /// Whether another axis than x points forward.
    pub(crate) fn is_sideways(&self) -> bool {
        self.forward.is_some_and(|forward| forward.index != 0) && self.twist_agrees != Some(false)
    }
}

/// A platform's own frame.
pub(crate) struct Base {
    pub(crate) frame: FrameId,
    /// The stream that shows it.
    pub(crate) stream: String,
    pub(crate) place: Place,
    pub(crate) seen: Estimate<BaseEstimate>,
}

/// The bases of each recording, in the order of [`Motion`].
pub(crate) struct Bases {
    pub(crate) bags: Vec<Vec<Base>>,
}

impl Bases {
    /// The bases of a world; made once.
    pub(crate) fn of(world: &Estimates) -> Rc<Self> {
        let motion = Motion::of(world);
        world.once(|world| Self {
            bags: motion.bags.iter().map(|bag| bases(world, bag)).collect(),
        })
    }
}

/// The bases of a recording.
fn bases(world: &Estimates, bag: &BagMotion) -> Vec<Base> {
    let (limits, gravity) = (
        world.limits::<crate::analysis::axes::bases::Limits>(),
        world.limits::<crate::analysis::axes::base_up::Limits>(),
    );
    let mut found: Vec<Base> = Vec::new();
    // Odometry with a velocity shows most.
    let has_twist = |stream: &&Stream<PoseRow>| stream.rows().any(|timed| timed.row.twist.is_some());
    let (with, without): (Vec<_>, Vec<_>) = bag.poses.iter().partition(has_twist);
    for stream in with.into_iter().chain(without) {
        let Some(frame) = stream
            .child
            .clone()
            .filter(|frame| names::is_base(frame) && !names::is_device(frame))
        else {
            continue;
        };
        let is_way = stream.frame.as_ref().is_some_and(names::is_world) && !names::is_world(&frame);
        let known = found.iter().find(|base| base.frame == frame);
        if !is_way || names::is_wish(&stream.topic) || known.is_some_and(|base| base.seen.is_ok()) {
            continue;
        }
        found.retain(|base| base.frame != frame);
        let by_gravity = bag.imus.iter().find_map(|imu| up_by(imu, &frame, &gravity, &limits));
        let turned = Orientations::of(stream);
        let is_on_it = |imu: &&Imu| imu.mount.as_ref().is_some_and(|mount| mount.base == frame);
        let mut on_it = bag.imus.iter().filter(is_on_it);
        let against =
            on_it.find(|imu| turns_with(&turned, imu, &imu.base_from_imu(), limits.max_step_s) == Some(false));
        let against = against.map(|imu| imu.stream.subject.clone());
        found.push(Base {
            stream: stream.subject.clone(),
            place: stream.place(),
            seen: look(stream, by_gravity, against, &limits),
            frame,
        });
    }
    found
}

/// The axis of the base that points up by an inertial sensor on it.
fn up_by(
    imu: &Imu,
    base: &FrameId,
    limits: &crate::analysis::axes::base_up::Limits,
    own: &Limits,
) -> Option<(Axis, String)> {
    imu.mount.as_ref().filter(|mount| mount.base == *base)?;
    let up = crate::analysis::axes::base_up::look(imu, limits).ok()?;
    Some((
        Axis::near(&up.direction, own.max_angle_deg)?,
        imu.stream.subject.clone(),
    ))
}

fn look(
    stream: &Stream<PoseRow>,
    gravity: Option<(Axis, String)>,
    against: Option<String>,
    limits: &Limits,
) -> Estimate<BaseEstimate> {
    let (mut forward, mut up, mut twist) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
    let (mut way_m, mut rows, mut reordered) = (0.0, 0.0, Vector3::zeros());
    for window in stream.windows(limits.window_s, limits.max_step_s) {
        let (Some(first), Some(last), Some(middle)) = (window.first(), window.last(), window.get(window.len() / 2))
        else {
            continue;
        };
        let Some(orientation) = Reading::Xyzw.world_from_body(middle.row.orientation) else {
            continue;
        };
        let turned = |row: &PoseRow| {
            let here = Reading::Xyzw.world_from_body(row.orientation)?;
            Some(here.angle_to(&orientation).to_degrees())
        };
        let moved = Vector3::from(last.row.position) - Vector3::from(first.row.position);
        let is_straight = [first, last]
            .into_iter()
            .all(|end| turned(&end.row).is_some_and(|angle| angle <= limits.max_turn_deg));
        if !(moved.norm() >= limits.min_step_m && moved.norm().is_finite() && is_straight) {
            continue;
        }
        way_m += moved.norm();
        rows += 1.0;
        forward += orientation.inverse() * moved;
        up += orientation.inverse() * Vector3::z();
        if let Some(other) = Reading::Wxyz.world_from_body(middle.row.orientation) {
            reordered += other.inverse() * Vector3::z();
        }
        let velocity = middle
            .row
            .twist
            .map_or_else(Vector3::zeros, |twist| Vector3::from(twist.linear));
        if velocity.iter().all(|part| part.is_finite()) && velocity.norm() > 0.0 {
            twist += velocity.normalize() * moved.norm();
        }
    }
    if way_m < limits.min_way_m {
        // A stationary base has no forward axis, but an up axis.
        let seen = standing(stream, gravity, against, limits);
        if let Some(seen) = seen.filter(BaseEstimate::is_upside_down) {
            return Ok(seen);
        }
        let why = format!(
            "it moves only {way_m:.1} m straight enough to show its forward axis, {} m are needed",
            limits.min_way_m
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    if rows < limits.min_windows {
        let why = format!(
            "it moves straight in only {rows} windows of {} s, {} are needed",
            limits.window_s, limits.min_windows
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    let concentration = forward.norm() / way_m;
    let steady = |sum: Vector3<f64>, of: f64| {
        Axis::near(&sum, limits.max_angle_deg).filter(|_| sum.norm() >= limits.min_concentration * of)
    };
    let forward = steady(forward, way_m);
    let twist = (twist.norm() > 0.0).then_some(twist);
    Ok(BaseEstimate {
        forward,
        concentration,
        up: steady(up, rows),
        gravity,
        against,
        twist_agrees: twist
            .zip(forward)
            .map(|(twist, forward)| twist.normalize().dot(&forward.vector()) > 0.5),
        way_m,
        is_up_reordered: steady(reordered, rows).is_some_and(|up| up.index == 2 && !up.is_negative),
    })
}

/// Measurements of a stationary base, if gravity and the pose agree that its z points down.
fn standing(
    stream: &Stream<PoseRow>,
    gravity: Option<(Axis, String)>,
    against: Option<String>,
    limits: &Limits,
) -> Option<BaseEstimate> {
    let orientations = stream
        .rows()
        .filter_map(|timed| Reading::Xyzw.world_from_body(timed.row.orientation));
    let ups: Vec<Vector3<f64>> = orientations.map(|turned| turned.inverse() * Vector3::z()).collect();
    let sum: Vector3<f64> = ups.iter().sum();
    let is_steady = !ups.is_empty() && sum.norm() >= limits.min_concentration * ups.len() as f64;
    let up = Axis::near(&sum, limits.max_angle_deg).filter(|up| is_steady && up.index == 2 && up.is_negative)?;
    gravity.as_ref().filter(|(axis, _)| *axis == up)?;
    Some(BaseEstimate {
        forward: None,
        concentration: 0.0,
        up: Some(up),
        gravity,
        against,
        twist_agrees: None,
        way_m: 0.0,
        is_up_reordered: false,
    })
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) window_s: f64,
    pub(crate) max_step_s: f64,
    pub(crate) min_step_m: f64,
    pub(crate) max_turn_deg: f64,
    pub(crate) min_way_m: f64,
    pub(crate) min_windows: f64,
    pub(crate) min_concentration: f64,
    pub(crate) max_angle_deg: f64,
}
