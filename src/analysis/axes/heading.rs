//! The yaw of an orientation compared with the course of a track: its sense and its zero.
//!
//! Must not judge.

use std::f64::consts::TAU;

use serde::Deserialize;

use crate::analysis::motion::{Course, Yaws};
use crate::math::circular::{Span, circular_mean, wrapped};
use crate::verdict::Measured;

/// Sense of a yaw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sense {
    /// Counter-clockwise, seen from above: REP-103.
    Left,
    /// Clockwise: a compass, or z down.
    Right,
}

impl Sense {
    /// How steadily a yaw follows the course counted this way, and counted the other way.
    pub(crate) fn agreements(self, [own, other]: [f64; 2], samples: u64, limits: &Limits) -> [Measured; 2] {
        let [way, against] = match self {
            Self::Left => ["counter-clockwise", "clockwise"],
            Self::Right => ["clockwise", "counter-clockwise"],
        };
        [
            Measured::new(format!("agreement with the course, yaw counted {way}"), own, "1")
                .at_least(limits.min_resultant)
                .samples(samples),
            Measured::new(format!("the same, counted {against}"), other, "1").samples(samples),
        ]
    }
}

/// A yaw compared with a course.
#[derive(Debug, Default)]
pub(crate) struct Heading {
    /// Windows with a turn that were judged.
    pub(crate) windows: usize,
    /// Windows in which the yaw turns with the course, and opposite to it.
    pub(crate) votes: [usize; 2],
    /// Courses in the windows that voted.
    pub(crate) samples: usize,
    /// Resultants of `course - yaw` and `course + yaw` over the windows that voted: the mean, weighted by samples.
    pub(crate) resultants: [f64; 2],
    /// `yaw - course`, or `yaw + course`, over the windows that voted for the winner, radians, with its resultant.
    pub(crate) offset_rad: f64,
    /// Resultant of that offset over all those windows: 1 where they agree.
    pub(crate) offset_resultant: f64,
    /// Largest turn of the course within a window, radians.
    pub(crate) widest_rad: f64,
    /// Longest distance in a window that turned enough, metres.
    pub(crate) longest_m: f64,
    /// Time of the first and last course that voted, seconds after the recording's start.
    pub(crate) span_s: Option<(f64, f64)>,
    /// Course and yaw in the windows that voted, radians.
    pub(crate) pairs_rad: Vec<[f64; 2]>,
}

/// A course with the yaw at that time.
struct Pair {
    course: Course,
    yaw_rad: f64,
}

impl Heading {
    /// Compares the yaw of the base's x axis, by the orientation as published, with the courses.
    pub(crate) fn of(yaws: &Yaws, courses: &[Vec<Course>], limits: &Limits) -> Self {
        let mut heading = Self::default();
        let mut voted: Vec<(Sense, Vec<Pair>)> = Vec::new();
        for run in courses {
            let mut window: Vec<Pair> = Vec::new();
            let mut span = Span::default();
            for course in run {
                let Some(yaw_rad) = yaws.at(course.t_s) else {
                    window.clear();
                    span = Span::default();
                    continue;
                };
                window.push(Pair {
                    course: *course,
                    yaw_rad,
                });
                let turned = span.add(course.angle_rad);
                heading.widest_rad = heading.widest_rad.max(turned);
                let lasts = course.t_s - window.first().map_or(course.t_s, |first| first.course.t_s);
                if turned >= limits.window_turn_deg.to_radians() || lasts >= limits.window_s {
                    let window = std::mem::take(&mut window);
                    span = Span::default();
                    voted.extend(heading.ask(window, turned, limits));
                }
            }
            voted.extend(heading.ask(window, span.rad(), limits));
        }
        heading.count(&voted);
        heading
    }

    /// Vote of a window; `None` if it turned or moved too little, or is not clear.
    fn ask(&mut self, window: Vec<Pair>, turned_rad: f64, limits: &Limits) -> Option<(Sense, Vec<Pair>)> {
        if turned_rad < limits.min_turn_deg.to_radians() {
            return None;
        }
        let way: Vec<Course> = window.iter().map(|pair| pair.course).collect();
        let way_m = way_m(&way);
        self.longest_m = self.longest_m.max(way_m);
        if way_m < limits.min_way_m {
            return None;
        }
        self.windows += 1;
        Some((vote(&window, limits)?, window))
    }

    fn count(&mut self, voted: &[(Sense, Vec<Pair>)]) {
        let of = |sense: Sense| voted.iter().filter(move |(voted, _)| *voted == sense);
        self.votes = [Sense::Left, Sense::Right].map(|sense| of(sense).count());
        self.samples = voted.iter().map(|(_, window)| window.len()).sum();
        let mut sums = [0.0; 2];
        for (_, window) in voted {
            for (sum, sense) in sums.iter_mut().zip([Sense::Left, Sense::Right]) {
                *sum += resultant(window, sense).1 * window.len() as f64;
            }
        }
        self.resultants = sums.map(|sum| sum / self.samples.max(1) as f64);
        let winner = self.winner();
        let pairs = of(winner).flat_map(|(_, window)| window);
        if let Some(mean) = circular_mean(pairs.map(|pair| (offset(pair, winner), weight(pair)))) {
            self.offset_rad = mean.mean_rad;
            self.offset_resultant = mean.resultant;
        }
        let times = || voted.iter().flat_map(|(_, window)| window).map(|pair| pair.course.t_s);
        let pairs = voted.iter().flat_map(|(_, window)| window);
        self.pairs_rad = pairs.map(|pair| [pair.course.angle_rad, pair.yaw_rad]).collect();
        self.span_s = times().reduce(f64::min).zip(times().reduce(f64::max));
    }

    /// Standard deviation of the offset, degrees, for a wrapped normal distribution.
    pub(crate) fn offset_spread_deg(&self) -> f64 {
        (-2.0 * self.offset_resultant.max(f64::MIN_POSITIVE).ln())
            .max(0.0)
            .sqrt()
            .to_degrees()
    }

    /// The widest sector without a course, degrees.
    pub(crate) fn widest_gap_deg(&self) -> f64 {
        let mut courses: Vec<f64> = self
            .pairs_rad
            .iter()
            .map(|[course, _]| course.rem_euclid(TAU))
            .collect();
        courses.sort_by(f64::total_cmp);
        let (Some(first), Some(last)) = (courses.first(), courses.last()) else {
            return 360.0;
        };
        let between = courses.windows(2).filter_map(|pair| Some(pair.last()? - pair.first()?));
        between.fold(first + TAU - last, f64::max).to_degrees()
    }

    /// From the first to the last course that voted, seconds.
    pub(crate) fn span_s(&self) -> f64 {
        self.span_s.map_or(0.0, |(from_s, to_s)| to_s - from_s)
    }

    /// The sense that has more votes.
    pub(crate) fn winner(&self) -> Sense {
        let [left, right] = self.votes;
        if right > left { Sense::Right } else { Sense::Left }
    }

    /// The share of the votes that the winner has; `None` without votes.
    pub(crate) fn agreement(&self) -> Option<f64> {
        let [left, right] = self.votes;
        let all = left + right;
        (all > 0).then(|| left.max(right) as f64 / all as f64)
    }
}

/// Vote of one window.
fn vote(window: &[Pair], limits: &Limits) -> Option<Sense> {
    let [left, right] = [Sense::Left, Sense::Right].map(|sense| (sense, resultant(window, sense).1));
    let (best, other) = if right.1 > left.1 { (right, left) } else { (left, right) };
    let clear = 1.0 - other.1 >= limits.variance_ratio * (1.0 - best.1);
    (best.1 >= limits.min_resultant && clear).then_some(best.0)
}

fn resultant(window: &[Pair], sense: Sense) -> (f64, f64) {
    let mean = circular_mean(window.iter().map(|pair| (offset(pair, sense), weight(pair))));
    mean.map_or((0.0, 0.0), |mean| (mean.mean_rad, mean.resultant))
}

fn offset(pair: &Pair, sense: Sense) -> f64 {
    match sense {
        Sense::Left => wrapped(pair.yaw_rad - pair.course.angle_rad),
        Sense::Right => wrapped(pair.yaw_rad + pair.course.angle_rad),
    }
}

fn weight(pair: &Pair) -> f64 {
    pair.course.speed_m_s / (pair.course.speed_m_s + 1.0)
}

/// Distance along courses, metres.
fn way_m(courses: &[Course]) -> f64 {
    let step = |pair: &[Course]| match pair {
        [a, b] => (b.t_s - a.t_s) * (a.speed_m_s + b.speed_m_s) / 2.0,
        _ => 0.0,
    };
    courses.windows(2).map(step).sum()
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_speed_m_s: f64,
    pub(crate) odometry_speed_m_s: f64,
    pub(crate) window_s: f64,
    pub(crate) window_turn_deg: f64,
    pub(crate) min_turn_deg: f64,
    pub(crate) min_span_s: f64,
    pub(crate) min_way_m: f64,
    pub(crate) min_resultant: f64,
    pub(crate) variance_ratio: f64,
    pub(crate) min_agreement: f64,
    pub(crate) max_offset_deg: f64,
    pub(crate) max_spread_deg: f64,
    pub(crate) quarter_deg: f64,
    pub(crate) quarter_spread_deg: f64,
    pub(crate) max_gap_deg: f64,
}
