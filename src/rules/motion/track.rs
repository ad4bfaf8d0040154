//! Where a platform went, and the course and speed of it: from satellite fixes, odometry and poses.
//!
//! Owns the local plane of fixes and the times at which courses are taken. Must not judge.

use nalgebra::{Vector2, Vector3};

use crate::math::circular::wrapped;
use crate::math::geodesy::Geodetic;
use crate::source::Place;
use crate::world::motion::{FixRow, PoseRow};

use super::stream::{Stream, Timed};

/// A course is taken over this long, seconds: noise of a position weighs less over a longer way, turns blur.
const COURSE_OVER_S: f64 = 2.0;
/// From one course to the next, seconds.
const COURSE_EVERY_S: f64 = 0.5;
/// Longest step between two positions, seconds: receivers speak once a second.
const MAX_STEP_S: f64 = 2.5;

/// Positions over time, metres, in a frame with x and y in the horizontal plane as published.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    /// What reports call it.
    pub(crate) subject: String,
    /// Where it begins.
    pub(crate) place: Place,
    /// Whether it is of satellite fixes: x east, y north, z up.
    pub(crate) is_geodetic: bool,
    /// Runs of positions without a hole.
    pub(crate) stretches: Vec<Vec<(f64, Vector3<f64>)>>,
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
    /// The track of a receiver, in a plane that touches the ellipsoid at its first fix.
    pub(crate) fn of_fixes(stream: &Stream<FixRow>) -> Self {
        let origin = stream.rows().next().map(|timed| timed.row);
        let place = |timed: &Timed<FixRow>| {
            let origin = origin?;
            Some((timed.t_s, local(&origin, &timed.row))).filter(|(_, p)| p.iter().all(|value| value.is_finite()))
        };
        Self {
            subject: stream.subject.clone(),
            place: stream.place(),
            is_geodetic: true,
            stretches: runs(stream.stretches.iter().map(|rows| rows.iter().filter_map(place))),
        }
    }

    /// The track of odometry or poses, in their own frame.
    pub(crate) fn of_poses(stream: &Stream<PoseRow>) -> Self {
        let place = |timed: &Timed<PoseRow>| {
            let position = Vector3::from(timed.row.position);
            position
                .iter()
                .all(|value| value.is_finite())
                .then_some((timed.t_s, position))
        };
        Self {
            subject: stream.subject.clone(),
            place: stream.place(),
            is_geodetic: false,
            stretches: runs(stream.stretches.iter().map(|rows| rows.iter().filter_map(place))),
        }
    }

    /// The position at a time, between two that are known.
    pub(crate) fn at(&self, t_s: f64) -> Option<Vector3<f64>> {
        self.stretches.iter().find_map(|stretch| at(stretch, t_s))
    }

    /// The courses of each stretch, every half second, where it is faster than this, m/s.
    pub(crate) fn courses(&self, min_speed_m_s: f64) -> Vec<Vec<Course>> {
        let mut all = Vec::new();
        for stretch in &self.stretches {
            let (Some((first, _)), Some((last, _))) = (stretch.first(), stretch.last()) else {
                continue;
            };
            let mut run = Vec::new();
            let mut t_s = first + COURSE_OVER_S / 2.0;
            while t_s + COURSE_OVER_S / 2.0 <= *last {
                let ends = [t_s - COURSE_OVER_S / 2.0, t_s + COURSE_OVER_S / 2.0].map(|t| at(stretch, t));
                t_s += COURSE_EVERY_S;
                let [Some(from), Some(to)] = ends else { continue };
                let way = Vector2::new(to.x - from.x, to.y - from.y);
                let speed_m_s = way.norm() / COURSE_OVER_S;
                if speed_m_s > min_speed_m_s {
                    run.push(Course {
                        t_s: t_s - COURSE_EVERY_S,
                        angle_rad: way.y.atan2(way.x),
                        speed_m_s,
                    });
                } else if !run.is_empty() {
                    all.push(std::mem::take(&mut run));
                }
            }
            all.push(run);
        }
        all.retain(|run| !run.is_empty());
        all
    }
}

/// How far the courses turn, from the rightmost to the leftmost, radians.
pub(crate) fn span_rad(courses: &[Course]) -> f64 {
    let (mut turned, mut least, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
    for pair in courses.windows(2) {
        if let [a, b] = pair {
            turned += wrapped(b.angle_rad - a.angle_rad);
            (least, most) = (least.min(turned), most.max(turned));
        }
    }
    most - least
}

/// East, north, up of a fix about another, metres. Good to a millimetre in a kilometre.
fn local(origin: &FixRow, fix: &FixRow) -> Vector3<f64> {
    let [east, north] = [
        wrapped((fix.longitude_deg - origin.longitude_deg).to_radians()),
        (fix.latitude_deg - origin.latitude_deg).to_radians(),
    ];
    let place = Geodetic {
        latitude_rad: origin.latitude_deg.to_radians(),
        longitude_rad: origin.longitude_deg.to_radians(),
        height_m: if origin.altitude_m.is_finite() {
            origin.altitude_m
        } else {
            0.0
        },
    };
    let up = fix.altitude_m - origin.altitude_m;
    Vector3::new(
        east * (place.prime_vertical_radius_m() + place.height_m) * place.latitude_rad.cos(),
        north * (place.meridian_radius_m() + place.height_m),
        if up.is_finite() { up } else { 0.0 },
    )
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

/// The two values of a run, in the order of time, that a time lies between, and its share of the way from one to the other.
pub(crate) fn around<V>(run: &[(f64, V)], t_s: f64) -> Option<([&(f64, V); 2], f64)> {
    let after = run.partition_point(|(t, _)| *t < t_s).max(1);
    let (a, b) = (run.get(after - 1)?, run.get(after)?);
    (a.0 <= t_s).then(|| ([a, b], (t_s - a.0) / (b.0 - a.0)))
}
