//! Plots of the rules on axes. Must not judge.

use crate::analysis::axes::heading::{Heading, Sense};
use crate::math::circular::wrapped;
use crate::verdict::plot::{Axis, Level, Plot, Series};

/// Yaw over course, with the fitted line and that of REP-103.
pub(crate) fn yaw(title: String, heading: &Heading, is_geodetic: bool) -> Plot {
    let degrees = |pair: &[f64; 2]| pair.map(|rad| wrapped(rad).to_degrees());
    let pairs = heading.pairs_rad.iter().map(degrees);
    let mut series = vec![Series::points("yaw at each course", pairs)];
    // Without east, the course has an arbitrary zero, and no line is the right one.
    if is_geodetic {
        series.extend(Series::lines("REP-103: yaw = course", along_deg(1.0, 0.0)));
    }
    let (sign, words) = match heading.winner() {
        Sense::Left => (1.0, "counter-clockwise"),
        Sense::Right => (-1.0, "clockwise"),
    };
    let offset_deg = heading.offset_rad.to_degrees();
    let fits = format!("the best fit: {words}, {offset_deg:.0} deg at course 0");
    series.extend(Series::lines(&fits, along_deg(sign, offset_deg)));
    Plot {
        title,
        x: Axis::new("course", "deg"),
        y: Axis::new("yaw", "deg"),
        equal: true,
        series,
        limits: Vec::new(),
    }
}

/// The angles `sign * x + offset` for x from -179 to 179 degrees, broken where they wrap.
fn along_deg(sign: f64, offset_deg: f64) -> Vec<Vec<[f64; 2]>> {
    let mut lines = vec![Vec::new()];
    let mut last = None;
    for x in (-179..180).step_by(2).map(f64::from) {
        let y = wrapped((sign * x + offset_deg).to_radians()).to_degrees();
        if last.is_some_and(|last: f64| (y - last).abs() > 180.0) {
            lines.push(Vec::new());
        }
        last = Some(y);
        if let Some(line) = lines.last_mut() {
            line.push([x, y]);
        }
    }
    lines
}

/// The GNSS track and the odometry fitted to it, rotated and mirrored, in stretches: east and north, metres.
pub(crate) fn tracks(title: String, aligned: [Vec<Vec<[f64; 2]>>; 3], with_mirrored: bool) -> Option<Plot> {
    let [fixed, turned, mirrored] = aligned;
    let mut series = Series::lines("GNSS", fixed);
    series.extend(Series::lines("odometry, rotated to fit", turned));
    if with_mirrored {
        series.extend(Series::lines("odometry, mirrored to fit", mirrored));
    }
    (!series.is_empty()).then(|| Plot {
        title,
        x: Axis::new("east of the first fix", "m"),
        y: Axis::new("north of the first fix", "m"),
        equal: true,
        series,
        limits: Vec::new(),
    })
}

/// z of the ground over time, with its expected value and tolerance, metres.
pub(crate) fn ground(
    title: String,
    points: impl IntoIterator<Item = [f64; 2]>,
    expected_m: Option<(f64, f64)>,
) -> Option<Plot> {
    let points = Series::points("ground in a cloud", points);
    let level = |label: &str, at: f64| Level {
        label: label.to_owned(),
        at,
    };
    let limits = expected_m.map(|(at_m, off_m)| {
        vec![
            level("expected", at_m),
            level("highest allowed", at_m + off_m),
            level("lowest allowed", at_m - off_m),
        ]
    });
    (!points.points.is_empty()).then(|| Plot {
        title,
        x: Axis::new("log time after the start", "s"),
        y: Axis::new("z of the ground", "m"),
        equal: false,
        series: vec![points],
        limits: limits.unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::indexing_slicing)]
    use super::*;

    #[test]
    fn a_line_of_angles_is_broken_where_it_wraps() {
        assert_eq!(along_deg(1.0, 0.0).len(), 1);
        let lines = along_deg(-1.0, 90.0);
        assert_eq!(lines.len(), 2);
        // From 90 + 179 = -91 at -179 down to -179 at -91, then from 179 at -89 down to -89.
        assert!((lines[0][0][1] + 91.0).abs() < 1e-9);
        assert!((lines[1][0][1] - 179.0).abs() < 1e-9);
        assert!((lines[1].last().map_or(0.0, |last| last[1]) + 89.0).abs() < 1e-9);
    }

    #[test]
    fn an_empty_series_gives_no_plot() {
        assert_eq!(tracks(String::new(), Default::default(), true), None);
        assert_eq!(ground(String::new(), [], Some((0.0, 0.1))), None);
        let drawn = ground(String::new(), [[0.0, 0.02]], Some((0.0, 0.1)));
        assert_eq!(drawn.map(|plot| plot.limits.len()), Some(3));
    }
}
