//! How a stream of poses moves: the steps between neighbours, online and in constant memory.
//!
//! Owns step, surprise and undone step as [`StepEvidence`] defines them. Must not know whose poses they are.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::world::Pose;
use crate::world::content::{PoseAt, Step, StepAt, StepEvidence};

use super::super::point::{Point, PointOwner};
use super::super::thin::{Reservoir, SampleBudget};

/// A step by more than this moves, metres and radians.
const MOVES: f64 = 1e-9;
/// A step by more than this can be undone, metres.
const LARGE_M: f64 = 1e-3;
/// A step by more than this can be undone, radians: 0.05°.
const LARGE_RAD: f64 = 0.05 * std::f64::consts::PI / 180.0;
/// The share of a step that may remain after the next step undoes it.
const LEFT: f64 = 0.2;
/// A stamp that falls back by more than this is a clock that was reset, nanoseconds; smaller ones are out of order.
const RESTART_NS: i64 = 1_000_000_000;

/// Takes in poses in recording order.
#[derive(Clone, Debug)]
pub(in super::super) struct Steps {
    last: Option<KnownPose>,
    /// The step that led to the last pose.
    before: Option<PriorStep>,
    count: u64,
    moving: u64,
    sample: Reservoir<Step>,
    farthest: LargestSteps,
    widest: LargestSteps,
    most_surprising: LargestSteps,
    undone: u64,
    first_undone: Option<StepEnds>,
}

/// A pose taken in.
#[derive(Clone, Copy, Debug)]
struct KnownPose {
    point: Point,
    stamp_ns: i64,
    pose: Pose,
    /// That of the pose, whose quaternion has unit norm.
    rotation: UnitQuaternion<f64>,
}

impl KnownPose {
    fn position(&self) -> Vector3<f64> {
        Vector3::from(self.pose.translation_m)
    }
}

/// A step taken, and the pose it started from.
#[derive(Clone, Copy, Debug)]
struct PriorStep {
    from: KnownPose,
    step: Step,
}

/// A step with its ends.
#[derive(Clone, Copy, Debug)]
struct StepEnds {
    step: Step,
    before: (Point, Pose),
    after: (Point, Pose),
}

impl Steps {
    pub(in super::super) fn new(share: SampleBudget) -> Self {
        Self {
            last: None,
            before: None,
            count: 0,
            moving: 0,
            sample: Reservoir::new(share.moves),
            farthest: LargestSteps::new(share.largest),
            widest: LargestSteps::new(share.largest),
            most_surprising: LargestSteps::new(share.largest),
            undone: 0,
            first_undone: None,
        }
    }

    /// Messages were left out here: the next pose does not follow the last one.
    pub(in super::super) fn seam(&mut self) {
        self.last = None;
        self.before = None;
    }

    /// Takes in a pose. One without a stamp, or whose stamp does not grow, is skipped.
    pub(in super::super) fn push(&mut self, point: Point, pose: Pose) {
        let Some(stamp_ns) = point.stamp_ns.filter(|stamp| *stamp != 0) else {
            return;
        };
        let [x, y, z, w] = pose.rotation_xyzw;
        let now = KnownPose {
            point,
            stamp_ns,
            pose,
            rotation: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
        };
        let Some(last) = self.last else {
            self.last = Some(now);
            return;
        };
        let dt_ns = stamp_ns.saturating_sub(last.stamp_ns);
        if dt_ns <= 0 {
            if dt_ns < -RESTART_NS {
                self.seam();
                self.last = Some(now);
            }
            return;
        }
        self.step(last, now, dt_ns);
    }

    fn step(&mut self, last: KnownPose, now: KnownPose, dt_ns: i64) {
        let rests = last.pose == now.pose;
        let (distance_m, angle_rad) = if rests {
            (0.0, 0.0)
        } else {
            (
                length(now.position() - last.position()),
                angle_between(&last.rotation, &now.rotation),
            )
        };
        let (surprise_m, surprise_rad) = self.surprise(&last, &now, dt_ns);
        let step = Step {
            dt_ns,
            distance_m,
            angle_rad,
            surprise_m,
            surprise_rad,
        };
        self.count += 1;
        self.moving += u64::from(distance_m > MOVES || angle_rad > MOVES);
        self.sample.push(step);
        let between = StepEnds {
            step,
            before: (last.point, last.pose),
            after: (now.point, now.pose),
        };
        self.farthest.push(distance_m, &between);
        self.widest.push(angle_rad, &between);
        self.most_surprising.push(surprise_m, &between);
        if let Some(before) = self.before.filter(|before| is_undone(before, &now)) {
            self.undone += 1;
            self.first_undone.get_or_insert(StepEnds {
                step: before.step,
                before: (before.from.point, before.from.pose),
                after: (last.point, last.pose),
            });
        }
        self.before = Some(PriorStep { from: last, step });
        self.last = Some(now);
    }

    /// How far the pose is from where the velocity and the angular velocity of the step before would have led it.
    fn surprise(&self, last: &KnownPose, now: &KnownPose, dt_ns: i64) -> (f64, f64) {
        let Some(PriorStep { from, step }) = self.before else {
            return (f64::NAN, f64::NAN);
        };
        let share = dt_ns as f64 / step.dt_ns as f64;
        if step.distance_m == 0.0 && step.angle_rad == 0.0 {
            let distance_m = length(now.position() - last.position());
            return (distance_m, angle_between(&last.rotation, &now.rotation));
        }
        let predicted = last.position() + (last.position() - from.position()) * share;
        let turn = from.rotation.rotation_to(&last.rotation);
        let turned = UnitQuaternion::from_scaled_axis(turn.scaled_axis() * share) * last.rotation;
        (
            length(now.position() - predicted),
            angle_between(&turned, &now.rotation),
        )
    }

    pub(in super::super) fn finish(self, on: PointOwner<'_>) -> StepEvidence {
        StepEvidence {
            count: self.count,
            moving: self.moving,
            sample: self.sample.finish(),
            farthest: self.farthest.finish(on),
            widest: self.widest.finish(on),
            most_surprising: self.most_surprising.finish(on),
            undone: self.undone,
            first_undone: self.first_undone.map(|between| between.on(on)),
        }
    }
}

/// Length of a difference of finite positions; the largest number there is where it overflows.
fn length(vector: Vector3<f64>) -> f64 {
    vector.norm().min(f64::MAX)
}

/// Angle of the shortest turn from one to the other, radians; exact near zero, and the same for `q` and `-q`.
fn angle_between(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    let difference = a.rotation_to(b).into_inner();
    2.0 * difference.imag().norm().atan2(difference.w.abs())
}

/// Whether a pose is back where the step before the last started from: at most a fifth of its distance, or of its angle,
/// remains.
fn is_undone(before: &PriorStep, now: &KnownPose) -> bool {
    let PriorStep { from, step } = before;
    let shifted = || step.distance_m > LARGE_M && length(now.position() - from.position()) <= LEFT * step.distance_m;
    let turned = || step.angle_rad > LARGE_RAD && angle_between(&from.rotation, &now.rotation) <= LEFT * step.angle_rad;
    shifted() || turned()
}

impl StepEnds {
    fn on(self, on: PointOwner<'_>) -> StepAt {
        let at = |(point, pose): (Point, Pose)| PoseAt { at: point.on(on), pose };
        StepAt {
            step: self.step,
            before: at(self.before),
            after: at(self.after),
        }
    }
}

/// The steps with the largest keys, the largest first; of equal ones the earlier.
#[derive(Clone, Debug)]
struct LargestSteps {
    bound: usize,
    kept: Vec<(f64, StepEnds)>,
}

impl LargestSteps {
    fn new(bound: usize) -> Self {
        Self {
            bound,
            kept: Vec::new(),
        }
    }

    fn push(&mut self, key: f64, between: &StepEnds) {
        // A NaN is larger than no step.
        let is_larger = |known: f64| key > known;
        if !is_larger(MOVES) {
            return;
        }
        if self.kept.len() >= self.bound {
            if self.kept.last().is_none_or(|(least, _)| !is_larger(*least)) {
                return;
            }
            self.kept.pop();
        }
        let place = self.kept.partition_point(|(known, _)| !is_larger(*known));
        if self.kept.capacity() == 0 {
            self.kept.reserve_exact(self.bound);
        }
        self.kept.insert(place, (key, *between));
    }

    fn finish(self, on: PointOwner<'_>) -> Vec<StepAt> {
        self.kept.into_iter().map(|(_, between)| between.on(on)).collect()
    }
}
