//! One TF edge while it is being collected.

use crate::world::bag::{Contradictions, Faults, TfEdge, TfFault, TfSample};
use crate::world::{FrameId, Pose};

use super::content::poses::{Poses, finish_poses, push_pose};
use super::content::steps::Steps;
use super::point::Point;
use super::series::RowBudget;
use super::stamps::Stamps;
use super::thin::{SampleBudget, ThinnedSeries};
use super::writers::{Writer, WriterCounts, Writers};

/// tf2 drops a transform whose quaternion has `| |q|² - 1 |` of this or more: `QUATERNION_NORMALIZATION_TOLERANCE` in
/// geometry2, tf2/src/buffer_core.cpp.
const NORM_TOLERANCE: f64 = 10e-3;
/// Differences of this size weigh the same when the sample that differs most is looked for: 0.1° and 1 mm.
const ANGLE_UNIT_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;
const DISTANCE_UNIT_M: f64 = 1e-3;

/// Topic, parent and child, by their numbers.
type Key = (usize, u32, u32);

pub(super) struct EdgeState {
    pub(super) key: Key,
    pub(super) first: Point,
    pub(super) count: u64,
    last: Point,
    samples: ThinnedSeries<(Point, Pose)>,
    extreme: Option<Extreme>,
    previous: Option<(Point, Pose)>,
    /// How many repeat the stamp of the one before and differ, and the one that differs most.
    contradictions: Option<(u64, Extreme)>,
    non_finite: FaultState,
    zero_quaternion: FaultState,
    denormalized: FaultState,
    worst_norm_error: f64,
    stamps: Stamps,
    steps: Steps,
    poses: Poses,
    written: WriterCounts,
}

/// The sample that differs most from another.
struct Extreme {
    sample: (Point, Pose),
    angle_rad: f64,
    distance_m: f64,
}

impl EdgeState {
    /// An edge that came `rank`-th, from 0.
    pub(super) fn new(key: Key, first: Point, rank: usize) -> Self {
        let share = SampleBudget::of(rank);
        Self {
            key,
            first,
            count: 0,
            last: first,
            samples: ThinnedSeries::new(share.poses),
            extreme: None,
            previous: None,
            contradictions: None,
            non_finite: FaultState::new(share),
            zero_quaternion: FaultState::new(share),
            denormalized: FaultState::new(share),
            worst_norm_error: 0.0,
            stamps: Stamps::new(share),
            steps: Steps::new(share),
            poses: Poses::new(RowBudget::of(rank)),
            written: WriterCounts::default(),
        }
    }

    /// Takes in a transform; returns whether tf2 accepts its numbers.
    pub(super) fn push(
        &mut self,
        point: Point,
        writer: Option<Writer>,
        translation: [f64; 3],
        rotation: [f64; 4],
    ) -> bool {
        self.count += 1;
        self.written.push(writer);
        self.last = point;
        self.stamps.push(point);
        let squared: f64 = rotation.iter().map(|v| v * v).sum();
        let finite = translation.iter().chain(&rotation).all(|v| v.is_finite());
        let fault = if !finite {
            &mut self.non_finite
        } else if rotation.iter().all(|v| *v == 0.0) {
            &mut self.zero_quaternion
        } else if (squared - 1.0).abs() >= NORM_TOLERANCE {
            &mut self.denormalized
        } else {
            self.worst_norm_error = self.worst_norm_error.max((squared.sqrt() - 1.0).abs());
            if let Some(pose) = Pose::from_raw(translation, rotation) {
                self.valid(point, pose);
            }
            return true;
        };
        fault.push(point, translation, rotation);
        false
    }

    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        self.stamps.seam();
        self.steps.seam();
        self.poses.seam();
    }

    fn valid(&mut self, point: Point, pose: Pose) {
        self.samples.push((point, pose));
        self.steps.push(point, pose);
        push_pose(&mut self.poses, point, &pose);
        self.repeats(point, &pose);
        let Some(candidate) = self
            .samples
            .first()
            .and_then(|(_, first)| Extreme::of(first, (point, pose)))
        else {
            return;
        };
        if self
            .extreme
            .as_ref()
            .is_none_or(|known| candidate.weight() > known.weight())
        {
            self.extreme = Some(candidate);
        }
    }

    /// Compares a pose with the one before, where both have the same stamp.
    fn repeats(&mut self, point: Point, pose: &Pose) {
        let Some((before, other)) = self.previous.replace((point, *pose)) else {
            return;
        };
        if before.stamp_ns != point.stamp_ns || point.stamp_ns.is_none_or(|stamp_ns| stamp_ns == 0) {
            return;
        }
        if let Some(new) = Extreme::of(&other, (point, *pose)) {
            self.contradictions = Some(match self.contradictions.take() {
                Some((count, known)) if known.weight() >= new.weight() => (count + 1, known),
                known => (known.map_or(1, |(count, _)| count + 1), new),
            });
        }
    }

    pub(super) fn finish(
        self,
        (parent, child): (FrameId, FrameId),
        topic: &str,
        is_static: bool,
        writers: &Writers,
    ) -> TfEdge {
        let sample = |(point, pose): (Point, Pose)| TfSample {
            at: point.on(topic),
            pose,
        };
        let extreme = self
            .extreme
            .map(|extreme| (sample(extreme.sample), extreme.angle_rad, extreme.distance_m));
        let moves = extreme
            .as_ref()
            .is_some_and(|(_, angle_rad, distance_m)| *angle_rad > ANGLE_UNIT_RAD || *distance_m > DISTANCE_UNIT_M);
        let poses = Some(self.poses).filter(|_| moves && !is_static);
        TfEdge {
            parent,
            child,
            topic: topic.to_owned(),
            is_static,
            count: self.count,
            first_at: self.first.on(topic),
            last_at: self.last.on(topic),
            samples: self.samples.finish().into_iter().map(sample).collect(),
            extreme,
            non_finite: self.non_finite.finish(topic),
            zero_quaternion: self.zero_quaternion.finish(topic),
            denormalized: self.denormalized.finish(topic),
            worst_norm_error: self.worst_norm_error,
            stamps: self.stamps.finish(topic),
            contradictions: self.contradictions.map(|(count, worst)| Contradictions {
                count,
                worst: worst.sample.0.on(topic),
                angle_rad: worst.angle_rad,
                distance_m: worst.distance_m,
            }),
            steps: self.steps.finish(topic.into()),
            writers: self.written.finish(writers),
            motion: poses.and_then(finish_poses),
        }
    }
}

impl Extreme {
    /// How a sample differs from a pose; `None` where it does not.
    fn of(from: &Pose, sample: (Point, Pose)) -> Option<Self> {
        let (_, pose) = &sample;
        (from != pose).then(|| Self {
            angle_rad: from.isometry().rotation.rotation_to(&pose.isometry().rotation).angle(),
            distance_m: distance(from.translation_m, pose.translation_m),
            sample,
        })
    }

    /// Whichever of angle and distance is larger in its unit: a small rotation must not hide a large shift.
    fn weight(&self) -> f64 {
        (self.angle_rad / ANGLE_UNIT_RAD).max(self.distance_m / DISTANCE_UNIT_M)
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter()
        .zip(&b)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
        .min(f64::MAX)
}

/// A fault's count and first examples.
struct FaultState {
    bound: usize,
    count: u64,
    examples: Vec<(Point, [f64; 3], [f64; 4])>,
}

impl FaultState {
    fn new(share: SampleBudget) -> Self {
        Self {
            bound: share.examples,
            count: 0,
            examples: Vec::new(),
        }
    }

    fn push(&mut self, point: Point, translation: [f64; 3], rotation: [f64; 4]) {
        self.count += 1;
        if self.examples.len() < self.bound {
            self.examples.push((point, translation, rotation));
        }
    }

    fn finish(self, topic: &str) -> Faults {
        let fault = |(point, translation, rotation): (Point, [f64; 3], [f64; 4])| TfFault {
            at: point.on(topic),
            translation,
            rotation,
        };
        Faults {
            count: self.count,
            examples: self.examples.into_iter().map(fault).collect(),
        }
    }
}
