//! The track of a platform, with course and speed: from GNSS fixes, odometry and poses.
//!
//! Owns the local plane of fixes and the times at which courses are taken. Must not judge.

use std::sync::OnceLock;

use nalgebra::{Vector2, Vector3};

use crate::analysis::motion::along::{Follower, around};
use crate::source::Place;

/// Duration of a course, seconds: longer ones have less noise, but blur turns.
const COURSE_OVER_S: f64 = 2.0;
/// Interval between courses, seconds.
const COURSE_EVERY_S: f64 = 0.5;
/// Longest step between two positions, seconds: receivers publish once a second.
const MAX_STEP_S: f64 = 2.5;

/// Positions over time, metres, in a frame with x and y in the horizontal plane as published.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    /// Its name in reports.
    pub(crate) subject: String,
    /// Where it begins.
    pub(crate) place: Place,
    /// Whether it is of GNSS fixes: x east, y north, z up.
    pub(crate) is_geodetic: bool,
    /// Runs of positions without a gap.
    pub(crate) stretches: Vec<Vec<(f64, Vector3<f64>)>>,
    /// Every course of each stretch, at any speed; made on first use.
    every_course: OnceLock<Vec<Vec<Course>>>,
}

/// The motion of a track at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Course {
    /// Middle of the time it was taken over, seconds after the recording's start.
    pub(crate) t_s: f64,
    /// From x towards y, radians: counter-clockwise from east, of a geodetic track.
    pub(crate) angle_rad: f64,
    /// Horizontal speed, m/s.
    pub(crate) speed_m_s: f64,
}

impl Track {
    /// Of positions, split at gaps that a course may not bridge; those that are not finite are left out.
    pub(crate) fn of(
        subject: String,
        place: Place,
        is_geodetic: bool,
        stretches: impl Iterator<Item = impl Iterator<Item = (f64, Vector3<f64>)>>,
    ) -> Self {
        let finite = |position: &(f64, Vector3<f64>)| position.1.iter().all(|value| value.is_finite());
        Self {
            subject,
            place,
            is_geodetic,
            stretches: runs(stretches.map(|stretch| stretch.filter(finite))),
            every_course: OnceLock::new(),
        }
    }

    /// The position at a time, between two that are known.
    pub(crate) fn at(&self, t_s: f64) -> Option<Vector3<f64>> {
        self.stretches.iter().find_map(|stretch| at(stretch, t_s))
    }

    /// [`Self::at`] at times that mostly increase.
    pub(crate) fn follow(&self) -> impl FnMut(f64) -> Option<Vector3<f64>> + '_ {
        let mut followers: Vec<_> = self.stretches.iter().map(|stretch| Follower::new(stretch)).collect();
        move |t_s| {
            let mut followers = followers.iter_mut();
            followers.find_map(|follower| follower.at(t_s))
        }
    }

    /// The courses of each stretch, every half second, where it is faster than this, m/s.
    pub(crate) fn courses(&self, min_speed_m_s: f64) -> Vec<Vec<Course>> {
        let is_fast = |course: &Course| course.speed_m_s > min_speed_m_s;
        let every = self
            .every_course
            .get_or_init(|| self.stretches.iter().map(|run| courses(run)).collect());
        let runs = every.iter().flat_map(|run| run.split(|course| !is_fast(course)));
        runs.filter(|run| !run.is_empty()).map(<[Course]>::to_vec).collect()
    }
}

/// The courses of a run, every half second.
fn courses(run: &[(f64, Vector3<f64>)]) -> Vec<Course> {
    let (Some((first, _)), Some((last, _))) = (run.first(), run.last()) else {
        return Vec::new();
    };
    let [mut from, mut to] = [Follower::new(run), Follower::new(run)];
    let mut all = Vec::new();
    let mut t_s = first + COURSE_OVER_S / 2.0;
    while t_s + COURSE_OVER_S / 2.0 <= *last {
        let ends = (from.at(t_s - COURSE_OVER_S / 2.0), to.at(t_s + COURSE_OVER_S / 2.0));
        if let (Some(from), Some(to)) = ends {
            let way = Vector2::new(to.x - from.x, to.y - from.y);
            all.push(Course {
                t_s,
                angle_rad: way.y.atan2(way.x),
                speed_m_s: way.norm() / COURSE_OVER_S,
            });
        }
        t_s += COURSE_EVERY_S;
    }
    all
}

/// Splits at steps that are too long.
fn runs(stretches: impl Iterator<Item = impl Iterator<Item = (f64, Vector3<f64>)>>) -> Vec<Vec<(f64, Vector3<f64>)>> {
    let mut all: Vec<Vec<(f64, Vector3<f64>)>> = Vec::new();
    for stretch in stretches {
        let mut run: Vec<(f64, Vector3<f64>)> = Vec::new();
        for point in stretch {
            if run.last().is_some_and(|(t_s, _)| point.0 - t_s > MAX_STEP_S) {
                all.push(std::mem::take(&mut run));
            }
            run.push(point);
        }
        all.push(run);
    }
    all.retain(|run| run.len() > 1);
    all
}

/// The position at a time, between two that are known.
fn at(stretch: &[(f64, Vector3<f64>)], t_s: f64) -> Option<Vector3<f64>> {
    let ([(_, a), (_, b)], share) = around(stretch, t_s)?;
    Some(a + (b - a) * share)
}
