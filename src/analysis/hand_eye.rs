//! A lidar's own motion and that of its platform: pairs of motions that the mounting must match.
//!
//! Owns which poses are compared with which lidar, and the pairs. Must not judge.

use nalgebra::{Isometry2, Isometry3, Translation3, UnitQuaternion, Vector2, Vector3};

use crate::analysis::motion::{BagMotion, Motion, Orientations, Stream};
use crate::analysis::scan_motion::moved::{Moment, ScanStep};
use crate::analysis::scan_motion::{ScanMotion, Steps};
use crate::analysis::{Estimates, estimates::hash_numbers, lidar::Clouds, time::sweep::sweeps_the_other_way};
use crate::source::Place;
use crate::verdict::NotEvaluated;
use crate::world::{FrameId, World, motion::PoseRow};

/// Longest step between two poses, seconds.
const MAX_STEP_S: f64 = 0.6;

/// Range of the searched time offset between scans and poses: number of steps, and their length in seconds. A sweep at 10 Hz takes 0.1 s,
/// and with stamps of another clock a cloud is logged some tenths after it was measured.
const MAX_LATE: i32 = 60;
const LATE_STEP_S: f64 = 0.01;
/// Offsets within this factor of the lowest mean square, plus the square of this angle, explain the turns equally well.
const ALIKE: f64 = 1.5;
const ALIKE_RAD: f64 = 0.0005;
/// From this factor on, they do not.
const UNLIKE: f64 = 4.0;

/// Words of topics with poses estimated from scans: those agree with any mounting, because they used it.
const BY_SCANS: [&str; 19] = [
    "lio",
    "loam",
    "aloam",
    "floam",
    "lego",
    "icp",
    "gicp",
    "kiss",
    "ndt",
    "dlio",
    "dlo",
    "fastlio",
    "liosam",
    "lidarodom",
    "rtabmap",
    "cartographer",
    "hdl",
    "glim",
    "slam",
];

/// Cosine of the largest angle between the lidar's up, by the transforms, and z of the body: 60 degrees. AXES10 judges the rest.
const LEAST_UP: f64 = 0.5;
/// Rotation of all pairs (rms) from which on its sign and its time offset are evaluated, radians: 0.5 degrees.
const LEAST_TURN_RAD: f64 = 0.0087;
/// Rotation of the scans over that of the poses from which on its sign is clear.
const SURE: f64 = 0.5;

/// A lidar with its motion by scans and by poses.
pub(crate) struct HandEye {
    /// The frame that the poses move.
    pub(crate) body: FrameId,
    /// The frame of the cloud.
    pub(crate) lidar: FrameId,
    /// `body_from_lidar`, by the transforms.
    pub(crate) stated: Isometry3<f64>,
    /// Name of the poses in reports, and their place.
    pub(crate) poses: (String, Place),
    /// Pairs of motions.
    pub(crate) pairs: Vec<Pair>,
    /// The time offset of the scans.
    pub(crate) late: TimeShift,
}

/// Time offset between scans and poses.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TimeShift {
    /// Seconds; zero without rotation.
    by_s: f64,
    /// Uncertainty, seconds: other offsets explain the rotation nearly as well.
    pub(crate) unsure_s: f64,
    /// Whether the best offset is at the end of the searched range, and zero does not fit.
    is_beyond: bool,
}

/// The same motion by poses and by scans: the later pose in the axes of the earlier.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Of the body, by its poses.
    pub(crate) body: Isometry3<f64>,
    /// Of the lidar, in its own axes, by its scans.
    pub(crate) lidar: Isometry3<f64>,
    /// Standard errors of the scans' match, radians and metres.
    pub(crate) sigma_rad: f64,
    pub(crate) sigma_m: f64,
    /// Duration, seconds.
    pub(crate) lasted_s: f64,
}

impl Pair {
    /// Distance and rotation of the lidar: metres and radians.
    pub(crate) fn size(&self) -> (f64, f64) {
        (self.lidar.translation.vector.norm(), self.lidar.rotation.angle())
    }

    /// The residual of the two with `body_from_lidar`, metres, plus two metres per radian.
    pub(crate) fn residual_m(&self, body_from_lidar: &Isometry3<f64>) -> f64 {
        let left = (self.body * body_from_lidar).inv_mul(&(body_from_lidar * self.lidar));
        left.translation.vector.norm() + 2.0 * left.rotation.angle()
    }
}

impl HandEye {
    /// The pairs of a lidar, for the motions picked from its steps; or why there are none. A lidar that rotates opposite to the poses has
    /// none: AXES11 reports it.
    pub(crate) fn of(
        world: &Estimates,
        clouds: &Clouds,
        pick: impl Fn(&Steps) -> Vec<ScanStep>,
    ) -> Result<Self, (NotEvaluated, String)> {
        let known = Self::unchecked(world, clouds, pick)?;
        match known.turns_along() {
            None if sweeps_the_other_way(clouds, &world.limits()) => {
                let why =
                    "its points sweep in the reverse direction, as in a mirrored cloud, and no turn rules that out";
                Err((NotEvaluated::NotApplicable, why.to_owned()))
            }
            Some(false) => {
                let why = format!(
                    "its scans rotate opposite to {}, as in a mirrored cloud, which no mounting explains",
                    known.poses.0
                );
                Err((NotEvaluated::NotApplicable, why))
            }
            _ => Ok(known),
        }
    }

    /// [`Self::of`], without the check of the sense of rotation.
    pub(crate) fn unchecked(
        world: &Estimates,
        clouds: &Clouds,
        pick: impl Fn(&Steps) -> Vec<ScanStep>,
    ) -> Result<Self, (NotEvaluated, String)> {
        if !clouds.is_of_a_lidar() {
            let why = "not recognised as raw points of a lidar by its fields, topic or frame".to_owned();
            return Err((NotEvaluated::NotApplicable, why));
        }
        let missing = |why: &str| (NotEvaluated::MissingInput, why.to_owned());
        let (motion, scans) = (Motion::of(world), ScanMotion::of(world));
        let lidar = clouds.frame().ok_or_else(|| missing(clouds.frameless()))?;
        let no_poses = || missing("no poses to compare with: record those of a frame that TF ties to the lidar");
        let steps = scans.steps(clouds).ok_or_else(no_poses)?;
        if steps.is_up.is_none() {
            return Err((NotEvaluated::TooLittleEvidence, steps.why.to_owned()));
        }
        let tied = tied(world, &motion, clouds, &lidar);
        if !tied.is_empty() && tied.iter().all(|(poses, ..)| is_by_scans(poses)) {
            let why = "the poses are estimated from scans of a lidar, so they agree with the mounting that they used";
            return Err(missing(why));
        }
        let tied = tied.into_iter().filter(|(poses, ..)| !is_by_scans(poses));
        let moved = pick(steps);
        let of = |(poses, body, stated): (&Stream<PoseRow>, FrameId, Isometry3<f64>)| {
            let (pairs, late) = pairs(world, steps, &moved, poses);
            Self {
                pairs,
                late,
                poses: (poses.subject.clone(), poses.place()),
                body,
                lidar: lidar.clone(),
                stated,
            }
        };
        let best = tied.map(of).reduce(|best, other| {
            if other.pairs.len() > best.pairs.len() {
                other
            } else {
                best
            }
        });
        let best = best.ok_or_else(no_poses)?;
        if best.late.is_beyond {
            let why = format!(
                "its scans rotate when {} do not: their clock offset is larger than the searched range",
                best.poses.0
            );
            return Err((NotEvaluated::TooLittleEvidence, why));
        }
        let sign = if steps.is_up == Some(true) { 1.0 } else { -1.0 };
        if sign * (best.stated.rotation * Vector3::z()).z < LEAST_UP {
            let why = format!("by the transforms the ground is not below `{}`", best.body);
            return Err((NotEvaluated::NotApplicable, why));
        }
        Ok(best)
    }

    /// `world_from_body` at the time of a cloud, by its poses.
    pub(crate) fn body_at(
        &self,
        world: &World,
        motion: &Motion,
        clouds: &Clouds,
    ) -> impl Fn(&Moment) -> Option<Isometry3<f64>> + use<> {
        let tied = tied(world, motion, clouds, &self.lidar).into_iter();
        let poses = tied
            .map(|(poses, ..)| poses)
            .find(|poses| poses.subject == self.poses.0);
        let poses = poses.map(|poses| (poses.stamp_offset_s, Orientations::of(poses), poses.track()));
        let late_s = self.late.by_s;
        move |moment| {
            let (stamp_offset_s, turned, track) = poses.as_ref()?;
            let t_s = moment.on(*stamp_offset_s) + late_s;
            pose_at(turned, &track.at(t_s)?, t_s)
        }
    }

    /// Whether the scans rotate in the same sense as the poses, if both rotate.
    fn turns_along(&self) -> Option<bool> {
        let turns = self.pairs.iter().map(|pair| {
            let lidar = self.stated.rotation * pair.lidar.rotation.scaled_axis();
            (pair.body.rotation.scaled_axis().z, lidar.z)
        });
        let (squares, products) = turns.fold((0.0, 0.0), |(squares, products), (body, lidar)| {
            (squares + body * body, products + body * lidar)
        });
        let turns = squares > LEAST_TURN_RAD.powi(2) * self.pairs.len() as f64 && products.abs() > SURE * squares;
        turns.then_some(products > 0.0)
    }
}

/// Poses of a frame that is tied to the lidar, with `body_from_lidar` by the transforms.
pub(crate) fn tied<'m>(
    world: &World,
    motion: &'m Motion,
    clouds: &Clouds,
    lidar: &FrameId,
) -> Vec<(&'m Stream<PoseRow>, FrameId, Isometry3<f64>)> {
    let ways = motion.bags.get(clouds.index).into_iter().flat_map(BagMotion::ways);
    let tied = ways.filter_map(|poses| {
        let body = poses.child.clone()?;
        let (stated, _) = world.graph().chain(&body, lidar, |edge| edge.is_rigid)?;
        Some((poses, body, stated))
    });
    tied.collect()
}

/// Whether poses are estimated from scans, by the words of their topic.
pub(crate) fn is_by_scans(poses: &Stream<PoseRow>) -> bool {
    let topic = poses.topic.to_lowercase();
    let words: Vec<&str> = topic.split(|letter: char| !letter.is_alphanumeric()).collect();
    let is_lidar_odometry = words.iter().any(|word| matches!(*word, "lidar" | "laser"))
        && words.iter().any(|word| matches!(*word, "odom" | "odometry"));
    is_lidar_odometry || words.iter().any(|word| BY_SCANS.contains(word))
}

/// The motions of both between matched clouds, and their time offset.
fn pairs(world: &Estimates, steps: &Steps, moved: &[ScanStep], poses: &Stream<PoseRow>) -> (Vec<Pair>, TimeShift) {
    let (turned, track) = (Orientations::of(poses), poses.track());
    let at = |t_s: f64| pose_at(&turned, &track.at(t_s)?, t_s);
    let numbers = moved.iter().flat_map(|moved| {
        let [from_s, to_s] = [moved.from, moved.to].map(|moment| moment.on(poses.stamp_offset_s));
        [from_s, to_s, moved.turned_rad()]
    });
    let late = *world.shared(
        |hasher| hash_numbers(hasher, numbers.chain(turned.numbers())),
        || late(moved, poses, &turned),
    );
    let pair = |moved: &ScanStep| {
        let times = [moved.from, moved.to].map(|moment| moment.on(poses.stamp_offset_s) + late.by_s);
        let [Some(from), Some(to)] = times.map(at) else {
            return None;
        };
        Some(Pair {
            body: from.inv_mul(&to),
            lidar: steps.in_cloud(moved),
            sigma_rad: moved.sigma[0],
            sigma_m: moved.sigma[1],
            lasted_s: moved.lasted_s(),
        })
    };
    (moved.iter().filter_map(pair).collect(), late)
}

/// The time offset at which the rotations of both match best. A stamp is that of the first or last point, a scan shows the middle.
fn late(moved: &[ScanStep], poses: &Stream<PoseRow>, turned: &Orientations) -> TimeShift {
    let orientation = |moment: &Moment, late_s: f64| turned.at(moment.on(poses.stamp_offset_s) + late_s, MAX_STEP_S);
    // Only the magnitudes of the angles are compared.
    let residual = |late_s: f64| {
        let squares = moved.iter().filter_map(|moved| {
            let body = orientation(&moved.from, late_s)?.inverse() * orientation(&moved.to, late_s)?;
            Some((body.angle() - moved.turned_rad().abs()).powi(2))
        });
        let (count, sum) = squares.fold((0, 0.0), |(count, sum), square| (count + 1, sum + square));
        (count > 0).then(|| sum / f64::from(count))
    };
    let tried = (-MAX_LATE..=MAX_LATE).map(|steps| f64::from(steps) * LATE_STEP_S);
    let found: Vec<(f64, f64)> = tried.filter_map(|late_s| Some((late_s, residual(late_s)?))).collect();
    let Some((best_s, least)) = found.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return TimeShift::default();
    };
    let is_alike = |(_, residual): &&(f64, f64)| *residual <= ALIKE * least + ALIKE_RAD * ALIKE_RAD;
    let unsure_s = found.iter().filter(is_alike).map(|(late_s, _)| (late_s - best_s).abs());
    let longest_s = LATE_STEP_S * (f64::from(MAX_LATE) - 0.5);
    let turned = moved.iter().map(|moved| moved.turned_rad().powi(2)).sum::<f64>() / moved.len() as f64;
    let is_unlike = || residual(0.0).is_some_and(|as_stamped| as_stamped > UNLIKE * least);
    TimeShift {
        by_s: best_s,
        unsure_s: unsure_s.fold(0.0, f64::max),
        is_beyond: best_s.abs() > longest_s && turned > LEAST_TURN_RAD.powi(2) && is_unlike(),
    }
}

pub(crate) fn pose_at(turned: &Orientations, place: &Vector3<f64>, t_s: f64) -> Option<Isometry3<f64>> {
    let rotation: UnitQuaternion<f64> = turned.at(t_s, MAX_STEP_S)?;
    Some(Isometry3::from_parts(Translation3::from(*place), rotation))
}

/// A rotation by 180 degrees about z of the lidar: Ouster's other frame.
pub(crate) fn half_turn() -> Isometry3<f64> {
    Isometry3::rotation(Vector3::z() * std::f64::consts::PI)
}

/// A motion projected to the plane of x and y.
pub(crate) fn in_plane(motion: &Isometry3<f64>) -> Isometry2<f64> {
    let place = motion.translation.vector;
    let x = motion.rotation * Vector3::x();
    Isometry2::new(Vector2::new(place.x, place.y), x.y.atan2(x.x))
}
