//! A lidar's own motion beside that of the platform it is on: pairs of motions that the mounting must bring together.
//!
//! Owns which poses are held against which lidar, and the pairs. Must not judge.

use nalgebra::{Isometry2, Isometry3, Translation3, UnitQuaternion, Vector2, Vector3};

use crate::analysis::motion::{BagMotion, Motion, Stream, Turned};
use crate::analysis::scan_motion::moved::{Moment, Moved};
use crate::analysis::scan_motion::{ScanMotion, Steps};
use crate::analysis::{Estimates, lidar::Clouds, time::sweep::sweeps_the_other_way};
use crate::source::Place;
use crate::verdict::NotEvaluated;
use crate::world::{FrameId, World, motion::PoseRow};

/// Longest step between two poses, seconds.
const MAX_STEP_S: f64 = 0.6;

/// How much later or earlier than its stamp a scan may show the platform: so many steps, and their length in seconds. A turn at 10 Hz is 0.1,
/// and where stamps are of another clock, a cloud is logged some tenths after it was made.
const MAX_LATE: i32 = 60;
const LATE_STEP_S: f64 = 0.01;
/// Turns that differ by this many times the least mean square, and by this angle besides, are explained alike.
const ALIKE: f64 = 1.5;
const ALIKE_RAD: f64 = 0.0005;
/// And by this many times, not alike at all.
const UNLIKE: f64 = 4.0;

/// Words of topics with poses that are worked out of scans: those agree with any mounting, for they were told by it.
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

/// Least part of up that lies along z of the body, where the transforms turn the lidar's up to: 60 degrees. A turned axis is AXES10's.
const LEAST_UP: f64 = 0.5;
/// Turning of all pairs, root mean square, from which on its sign and its moment are looked at, radians: 0.5 degrees.
const LEAST_TURN_RAD: f64 = 0.0087;
/// Turning of the scans over that of the poses from which on they surely turn to the same side, or to the other.
const SURE: f64 = 0.5;

/// A lidar whose motion is known twice.
pub(crate) struct HandEye {
    /// The frame that the poses move.
    pub(crate) body: FrameId,
    /// The frame of the cloud.
    pub(crate) lidar: FrameId,
    /// `body_from_lidar`, as the transforms say.
    pub(crate) told: Isometry3<f64>,
    /// What reports call the poses, and where they are.
    pub(crate) poses: (String, Place),
    /// Pairs of motions.
    pub(crate) pairs: Vec<Pair>,
    /// The moment that the scans show.
    pub(crate) late: Late,
}

/// How much later than its stamp the platform was where a scan shows it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Late {
    /// Seconds; zero where nothing turns.
    by_s: f64,
    /// How far that may be off, seconds: others explain the turns nearly as well.
    pub(crate) unsure_s: f64,
    /// Whether what explains them best is the latest or the earliest that was tried, and the stamps do not.
    is_beyond: bool,
}

/// The same motion, twice: the later in the axes of the earlier.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Of the body, by its poses.
    pub(crate) body: Isometry3<f64>,
    /// Of the lidar, in its own axes, by its scans.
    pub(crate) lidar: Isometry3<f64>,
    /// Standard errors of the scans' match, radians and metres.
    pub(crate) sigma_rad: f64,
    pub(crate) sigma_m: f64,
    /// How long they took, seconds.
    pub(crate) lasted_s: f64,
}

impl Pair {
    /// How far the lidar went, and how far it turned: metres and radians.
    pub(crate) fn size(&self) -> (f64, f64) {
        (self.lidar.translation.vector.norm(), self.lidar.rotation.angle())
    }

    /// The residual where `body_from_lidar` brings the two together, metres: two metres a radian besides.
    pub(crate) fn residual_m(&self, body_from_lidar: &Isometry3<f64>) -> f64 {
        let left = (self.body * body_from_lidar).inv_mul(&(body_from_lidar * self.lidar));
        left.translation.vector.norm() + 2.0 * left.rotation.angle()
    }
}

impl HandEye {
    /// The pairs of a lidar, of the motions that are picked of its steps; or why there are none. One that turns against the poses
    /// has none: what that is, AXES11 says.
    pub(crate) fn of(
        world: &Estimates,
        clouds: &Clouds,
        pick: impl Fn(&Steps) -> Vec<Moved>,
    ) -> Result<Self, (NotEvaluated, String)> {
        let known = Self::unchecked(world, clouds, pick)?;
        match known.turns_along() {
            None if sweeps_the_other_way(clouds, &world.limits()) => {
                let why =
                    "its points sweep to the other side, as in a mirror image, and no turn shows that they are none";
                Err((NotEvaluated::NotApplicable, why.to_owned()))
            }
            Some(false) => {
                let why = format!(
                    "its scans turn against {}: no mounting brings a mirror image together with them",
                    known.poses.0
                );
                Err((NotEvaluated::NotApplicable, why))
            }
            _ => Ok(known),
        }
    }

    /// [`Self::of`], whichever way it turns.
    pub(crate) fn unchecked(
        world: &Estimates,
        clouds: &Clouds,
        pick: impl Fn(&Steps) -> Vec<Moved>,
    ) -> Result<Self, (NotEvaluated, String)> {
        if !clouds.is_of_a_lidar() {
            let why = "nothing says that these are the points of a lidar as it measured them".to_owned();
            return Err((NotEvaluated::NotApplicable, why));
        }
        let missing = |why: &str| (NotEvaluated::MissingInput, why.to_owned());
        let (motion, scans) = (Motion::of(world), ScanMotion::of(world));
        let lidar = clouds.frame().ok_or_else(|| missing("the clouds name no frame"))?;
        let no_poses = || missing("no poses of a frame that is tied to it say how the platform moved");
        let steps = scans.steps(clouds).ok_or_else(no_poses)?;
        if steps.is_up.is_none() {
            return Err((NotEvaluated::TooLittleEvidence, steps.why.to_owned()));
        }
        let tied = tied(world, &motion, clouds, &lidar);
        if !tied.is_empty() && tied.iter().all(|(poses, ..)| is_by_scans(poses)) {
            let why =
                "the poses are worked out of scans of a lidar, and agree with whatever mounting they were told by";
            return Err(missing(why));
        }
        let tied = tied.into_iter().filter(|(poses, ..)| !is_by_scans(poses));
        let moved = pick(steps);
        let of = |(poses, body, told): (&Stream<PoseRow>, FrameId, Isometry3<f64>)| {
            let (pairs, late) = pairs(steps, &moved, poses);
            Self {
                pairs,
                late,
                poses: (poses.subject.clone(), poses.place()),
                body,
                lidar: lidar.clone(),
                told,
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
                "its scans turn when {} do not: their clocks are further apart than is looked for",
                best.poses.0
            );
            return Err((NotEvaluated::TooLittleEvidence, why));
        }
        let sign = if steps.is_up == Some(true) { 1.0 } else { -1.0 };
        if sign * (best.told.rotation * Vector3::z()).z < LEAST_UP {
            let why = format!("the ground does not lie beneath `{}`", best.body);
            return Err((NotEvaluated::NotApplicable, why));
        }
        Ok(best)
    }

    /// `world_from_body` at the moment of a cloud, by its poses.
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
        let poses = poses.map(|poses| (poses.stamp_offset_s, Turned::of(poses), poses.track()));
        let late_s = self.late.by_s;
        move |moment| {
            let (stamp_offset_s, turned, track) = poses.as_ref()?;
            let t_s = moment.on(*stamp_offset_s) + late_s;
            pose_at(turned, &track.at(t_s)?, t_s)
        }
    }

    /// Whether the scans turn to the side that the poses turn to, where both turn.
    fn turns_along(&self) -> Option<bool> {
        let turns = self.pairs.iter().map(|pair| {
            let lidar = self.told.rotation * pair.lidar.rotation.scaled_axis();
            (pair.body.rotation.scaled_axis().z, lidar.z)
        });
        let (squares, products) = turns.fold((0.0, 0.0), |(squares, products), (body, lidar)| {
            (squares + body * body, products + body * lidar)
        });
        let turns = squares > LEAST_TURN_RAD.powi(2) * self.pairs.len() as f64 && products.abs() > SURE * squares;
        turns.then_some(products > 0.0)
    }
}

/// Poses of a frame that is tied to the lidar: `body_from_lidar`, as the transforms say.
pub(crate) fn tied<'m>(
    world: &World,
    motion: &'m Motion,
    clouds: &Clouds,
    lidar: &FrameId,
) -> Vec<(&'m Stream<PoseRow>, FrameId, Isometry3<f64>)> {
    let ways = motion.bags.get(clouds.index).into_iter().flat_map(BagMotion::ways);
    let tied = ways.filter_map(|poses| {
        let body = poses.child.clone()?;
        let (told, _) = world.graph().chain(&body, lidar, |edge| edge.is_rigid)?;
        Some((poses, body, told))
    });
    tied.collect()
}

/// Whether poses are worked out of scans, by the words of their topic.
pub(crate) fn is_by_scans(poses: &Stream<PoseRow>) -> bool {
    let topic = poses.topic.to_lowercase();
    let words: Vec<&str> = topic.split(|letter: char| !letter.is_alphanumeric()).collect();
    let is_lidar_odometry = words.iter().any(|word| matches!(*word, "lidar" | "laser"))
        && words.iter().any(|word| matches!(*word, "odom" | "odometry"));
    is_lidar_odometry || words.iter().any(|word| BY_SCANS.contains(word))
}

/// The motions of both between the clouds that were matched, and their moment.
fn pairs(steps: &Steps, moved: &[Moved], poses: &Stream<PoseRow>) -> (Vec<Pair>, Late) {
    let (turned, track) = (Turned::of(poses), poses.track());
    let at = |t_s: f64| pose_at(&turned, &track.at(t_s)?, t_s);
    let late = late(moved, poses, &turned);
    let pair = |moved: &Moved| {
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

/// Where both turn most alike. A stamp is that of the first point or of the last, and what a scan shows is the middle.
fn late(moved: &[Moved], poses: &Stream<PoseRow>, turned: &Turned) -> Late {
    let orientation = |moment: &Moment, late_s: f64| turned.at(moment.on(poses.stamp_offset_s) + late_s, MAX_STEP_S);
    // Which way is up is not asked here: angles alone are compared.
    let left = |late_s: f64| {
        let squares = moved.iter().filter_map(|moved| {
            let body = orientation(&moved.from, late_s)?.inverse() * orientation(&moved.to, late_s)?;
            Some((body.angle() - moved.turned_rad().abs()).powi(2))
        });
        let (count, sum) = squares.fold((0, 0.0), |(count, sum), square| (count + 1, sum + square));
        (count > 0).then(|| sum / f64::from(count))
    };
    let tried = (-MAX_LATE..=MAX_LATE).map(|steps| f64::from(steps) * LATE_STEP_S);
    let found: Vec<(f64, f64)> = tried.filter_map(|late_s| Some((late_s, left(late_s)?))).collect();
    let Some((best_s, least)) = found.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Late::default();
    };
    let is_alike = |(_, left): &&(f64, f64)| *left <= ALIKE * least + ALIKE_RAD * ALIKE_RAD;
    let unsure_s = found.iter().filter(is_alike).map(|(late_s, _)| (late_s - best_s).abs());
    let longest_s = LATE_STEP_S * (f64::from(MAX_LATE) - 0.5);
    let turned = moved.iter().map(|moved| moved.turned_rad().powi(2)).sum::<f64>() / moved.len() as f64;
    let is_unlike = || left(0.0).is_some_and(|as_told| as_told > UNLIKE * least);
    Late {
        by_s: best_s,
        unsure_s: unsure_s.fold(0.0, f64::max),
        is_beyond: best_s.abs() > longest_s && turned > LEAST_TURN_RAD.powi(2) && is_unlike(),
    }
}

pub(crate) fn pose_at(turned: &Turned, place: &Vector3<f64>, t_s: f64) -> Option<Isometry3<f64>> {
    let rotation: UnitQuaternion<f64> = turned.at(t_s, MAX_STEP_S)?;
    Some(Isometry3::from_parts(Translation3::from(*place), rotation))
}

/// Half a turn about z of the lidar: Ouster's other frame.
pub(crate) fn half_turn() -> Isometry3<f64> {
    Isometry3::rotation(Vector3::z() * std::f64::consts::PI)
}

/// A motion as it is in the plane of x and y.
pub(crate) fn in_plane(motion: &Isometry3<f64>) -> Isometry2<f64> {
    let place = motion.translation.vector;
    let x = motion.rotation * Vector3::x();
    Isometry2::new(Vector2::new(place.x, place.y), x.y.atan2(x.x))
}
