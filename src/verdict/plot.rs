//! Plots: points and lines over two axes, as pure data, bounded in size.
//!
//! Do not know pixels, colours or where they are drawn.

use serde::{Deserialize, Serialize};

/// Maximum number of points of a series.
pub const MAX_POINTS: usize = 2000;

/// A plot that belongs to one judgement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// The title, a few words.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// Whether both axes have the same scale: for positions, and for two angles.
    pub equal: bool,
    /// What was measured, and what it is compared with.
    pub series: Vec<Series>,
    /// Values of y that must not be crossed, or should be met.
    pub limits: Vec<Level>,
}

/// One of the axes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axis {
    /// Its quantity ("time of the recording").
    pub label: String,
    /// Unit: `s`, `m`, `deg`, `1` where there is none.
    pub unit: String,
}

impl Axis {
    /// An axis with its unit.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
        }
    }
}

/// How the points of a series are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// As separate points.
    Points,
    /// As one line, in their order. Lines with the same name belong together.
    Line,
}

/// Points of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// What they are.
    pub name: String,
    /// How they belong together.
    pub kind: Kind,
    /// x and y, in the units of the axes: [`MAX_POINTS`] at most.
    pub points: Vec<[f64; 2]>,
}

/// A value of y with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// What it is.
    pub label: String,
    /// The value, in the unit of y.
    pub at: f64,
}

impl Series {
    /// Separate points. If there are too many, the lowest and the highest of each interval are kept: outliers matter.
    pub fn points(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let points: Vec<[f64; 2]> = points.into_iter().filter(is_finite).collect();
        Self {
            name: name.into(),
            kind: Kind::Points,
            points: with_extremes(points),
        }
    }

    /// Lines with one name through the points of each interval; if there are too many points, every n-th is kept, and the last.
    pub fn lines(name: &str, stretches: impl IntoIterator<Item = Vec<[f64; 2]>>) -> Vec<Self> {
        let mut stretches: Vec<Vec<[f64; 2]>> = stretches.into_iter().collect();
        for stretch in &mut stretches {
            stretch.retain(is_finite);
        }
        stretches.retain(|stretch| stretch.len() > 1);
        let all: usize = stretches.iter().map(Vec::len).sum();
        // Each stretch has a first and a last point besides.
        let room = MAX_POINTS.saturating_sub(2 * stretches.len()).max(1);
        let step = if all > MAX_POINTS { all.div_ceil(room) } else { 1 };
        stretches.truncate(MAX_POINTS / 2);
        let line = |stretch: Vec<[f64; 2]>| Self {
            name: name.to_owned(),
            kind: Kind::Line,
            points: every(step, &stretch),
        };
        stretches.into_iter().map(line).collect()
    }
}

fn is_finite(point: &[f64; 2]) -> bool {
    point.iter().all(|value| value.is_finite())
}

fn with_extremes(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    if points.len() <= MAX_POINTS {
        return points;
    }
    let step = (2 * points.len()).div_ceil(MAX_POINTS);
    let mut kept = Vec::with_capacity(MAX_POINTS);
    for stretch in points.chunks(step) {
        let by_y = |a: &(usize, &[f64; 2]), b: &(usize, &[f64; 2])| a.1[1].total_cmp(&b.1[1]);
        let lowest = stretch.iter().enumerate().min_by(by_y);
        let highest = stretch.iter().enumerate().max_by(by_y);
        let mut both: Vec<(usize, &[f64; 2])> = lowest.into_iter().chain(highest).collect();
        both.sort_by_key(|(index, _)| *index);
        both.dedup_by_key(|(index, _)| *index);
        kept.extend(both.into_iter().map(|(_, point)| *point));
    }
    kept
}

fn every(step: usize, stretch: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = stretch.iter().step_by(step).copied().collect();
    if !stretch.len().wrapping_sub(1).is_multiple_of(step) {
        kept.extend(stretch.last());
    }
    kept
}

#[cfg(test)]
mod tests {
    #![allow(clippy::indexing_slicing)]
    use super::*;

    #[test]
    fn few_points_stay_as_they_are() {
        let points: Vec<[f64; 2]> = (0..MAX_POINTS).map(|i| [i as f64, 1.0]).collect();
        assert_eq!(Series::points("a", points.clone()).points, points);
        assert_eq!(Series::lines("a", [points.clone()])[0].points, points);
    }

    #[test]
    fn of_many_points_those_that_stray_stay() {
        let points = (0..100_003).map(|i| [f64::from(i), if i == 77_777 { -9.0 } else { f64::from(i % 7) }]);
        let kept = Series::points("a", points).points;
        assert!(kept.len() <= MAX_POINTS, "{}", kept.len());
        assert!(kept.contains(&[77_777.0, -9.0]));
        assert!(kept.is_sorted_by(|a, b| a[0] < b[0]), "in their order");
    }

    #[test]
    fn what_is_not_finite_is_no_point() {
        let points = [[0.0, 0.0], [1.0, f64::INFINITY], [f64::NAN, 3.0], [2.0, 0.0]];
        let finite = [[0.0, 0.0], [2.0, 0.0]];
        assert_eq!(Series::points("a", points).points, finite);
        assert_eq!(Series::lines("a", [points.to_vec()])[0].points, finite);
    }

    #[test]
    fn long_lines_are_thinned_together_and_keep_their_ends() {
        let stretch = |from: i32, to: i32| (from..to).map(|i| [f64::from(i), 0.0]).collect::<Vec<_>>();
        let lines = Series::lines("a", [stretch(0, 50_000), stretch(60_000, 60_010), stretch(7, 8)]);
        assert_eq!(lines.len(), 2, "one point is no line");
        let all: usize = lines.iter().map(|line| line.points.len()).sum();
        assert!((1900..=MAX_POINTS).contains(&all), "{all}");
        assert_eq!(lines[0].points.last(), Some(&[49_999.0, 0.0]));
        assert_eq!(lines[1].points.last(), Some(&[60_009.0, 0.0]));
        let many = Series::lines("a", (0..5000).map(|i| stretch(i, i + 9)));
        assert!(many.iter().map(|line| line.points.len()).sum::<usize>() <= MAX_POINTS);
    }
}
