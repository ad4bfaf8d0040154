//! The plots of rules: over time if the x axis is time, else in a plane with its axes.

use std::collections::BTreeSet;

use crate::verdict::plot::{Axis, Kind, Plot, Series};
use crate::verdict::{Row, Verdict};

use super::scene::{Color, Content, Drawing, Lines, Path, Scene};

/// The root of the plots, by rule.
pub(super) const PLOTS: &str = "plots";

/// Colours of the series, in their order.
const COLORS: [Color; 5] = [
    [90, 170, 250],
    [250, 190, 60],
    [120, 210, 120],
    [230, 110, 200],
    [180, 180, 180],
];
const OF_LIMITS: Color = [235, 80, 80];
const OF_AXES: Color = [150, 150, 150];
/// Width and height of a plot whose axes have units of their own.
const SIZE: [f64; 2] = [160.0, 90.0];

/// The place of a plot.
pub(super) struct PlotPlace {
    pub(super) path: Path,
    /// The range of the plane that it covers; `None` if it is shown over time.
    pub(super) bounds: Option<Bounds>,
}

/// The lowest and the highest x, and y downwards.
type Bounds = [[f32; 2]; 2];

/// Every plot of a verdict; `at` gives the start of a subject's recordings, and its place in space. Returns the place of each.
pub(super) fn plots<'t>(
    verdict: &Verdict,
    at: &dyn Fn(&str) -> Option<(i64, &'t Path)>,
    scene: &mut Scene,
) -> Vec<PlotPlace> {
    let mut drawn = Vec::new();
    for row in verdict.rows.iter().filter(|row| !row.plots.is_empty()) {
        let Some((start_ns, top)) = at(&row.subject) else {
            continue;
        };
        for plot in &row.plots {
            let path = path(row).then(plot.title.clone());
            let is_over_time = plot.x.unit == "s" && !plot.equal && plot.x.label.contains("time");
            let bounds = if is_over_time {
                over_time(plot, &path, start_ns, scene);
                None
            } else {
                in_plane(plot, &path, scene)
            };
            if plot.equal && plot.x.unit == "m" {
                in_space(plot, top, scene);
            }
            if is_over_time || bounds.is_some() {
                drawn.push(PlotPlace { path, bounds });
            }
        }
    }
    drawn
}

/// The series with their colours: series with the same name have the same colour.
fn colored(plot: &Plot) -> impl Iterator<Item = (&Series, Color)> {
    let mut names: Vec<&str> = Vec::new();
    plot.series.iter().map(move |series| {
        let known = names.iter().position(|name| *name == series.name);
        let number = known.unwrap_or_else(|| {
            names.push(&series.name);
            names.len() - 1
        });
        (series, COLORS.get(number % COLORS.len()).copied().unwrap_or(OF_AXES))
    })
}

/// The place of the plots of a judgement.
fn path(row: &Row) -> Path {
    Path::top(PLOTS).then(row.rule.clone()).then(row.subject.clone())
}

fn over_time(plot: &Plot, path: &Path, start_ns: i64, scene: &mut Scene) {
    let moment = |x_s: f64| start_ns.saturating_add((x_s * 1e9) as i64);
    for (number, (series, color)) in colored(plot).enumerate() {
        let own = path.then(format!("{number} {}", series.name));
        let name = format!("{} ({}, {})", series.name, plot.y.label, plot.y.unit);
        scene.always(&own, Content::Curve(name, color, series.kind == Kind::Line));
        for [x, y] in &series.points {
            scene.at(&own, moment(*x), Content::Number(*y));
        }
    }
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let (first, last) = points().fold((f64::MAX, f64::MIN), |(a, b), [x, _]| (a.min(*x), b.max(*x)));
    for limit in plot.limits.iter().filter(|_| first <= last) {
        let own = path.then(format!("limit: {}", limit.label));
        scene.always(&own, Content::Curve(limit.label.clone(), OF_LIMITS, true));
        scene.at(&own, moment(first), Content::Number(limit.at));
        scene.at(&own, moment(last), Content::Number(limit.at));
    }
}

/// Superimposed tracks, on the ground: east and north are those of the GNSS tracks.
fn in_space(plot: &Plot, top: &Path, scene: &mut Scene) {
    let path = top.then(plot.title.clone());
    let mut named = BTreeSet::new();
    for (number, (series, color)) in colored(plot).enumerate() {
        let strip = series.points.iter().map(|[x, y]| [*x as f32, *y as f32, 0.0]);
        let lines = Lines {
            strips_m: vec![strip.collect()],
            color,
            radius: -1.5,
            labels: if named.insert(series.name.as_str()) {
                vec![series.name.clone()]
            } else {
                Vec::new()
            },
        };
        scene.always(&path.then(format!("{number} {}", series.name)), Content::Lines(lines));
    }
}

fn in_plane(plot: &Plot, path: &Path, scene: &mut Scene) -> Option<Bounds> {
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let range = |axis: usize| {
        let values = points().filter_map(|point| point.get(axis).copied());
        values.fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(value), high.max(value))
        })
    };
    let ((left, right), (bottom, top)) = (range(0), range(1));
    if left > right || bottom > top {
        return None;
    }
    let levels = || plot.limits.iter().map(|limit| limit.at);
    let (bottom, top) = (levels().fold(bottom, f64::min), levels().fold(top, f64::max));
    // With equal axes, metres stay metres.
    let scale = |low: f64, high: f64, size: f64| {
        if plot.equal {
            1.0
        } else {
            size / (high - low).max(1e-12)
        }
    };
    let (sx, sy) = (scale(left, right, SIZE[0]), scale(bottom, top, SIZE[1]));
    let place = |[x, y]: [f64; 2]| [((x - left) * sx) as f32, ((y - bottom) * sy) as f32];
    let drawing = |strip: Vec<[f32; 2]>, is_line: bool, color: Color| {
        Content::Drawing(Drawing {
            strips: vec![strip],
            is_line,
            color,
            label: String::new(),
        })
    };
    let mut legend: Vec<(String, Color)> = Vec::new();
    for (number, (series, color)) in colored(plot).enumerate() {
        let points: Vec<[f32; 2]> = series.points.iter().map(|point| place(*point)).collect();
        let own = path.then(format!("{number} {}", series.name));
        scene.always(&own, drawing(points, series.kind == Kind::Line, color));
        legend.push((series.name.clone(), color));
    }
    for limit in &plot.limits {
        let ends = [[left, limit.at], [right, limit.at]].map(place).to_vec();
        scene.always(
            &path.then(format!("limit: {}", limit.label)),
            drawing(ends, true, OF_LIMITS),
        );
        legend.push((limit.label.clone(), OF_LIMITS));
    }
    for (name, ends) in [
        ("axis x", [[left, bottom], [right, bottom]]),
        ("axis y", [[left, bottom], [left, top]]),
    ] {
        scene.always(&path.then(name), drawing(ends.map(place).to_vec(), true, OF_AXES));
    }
    let words = |way: &str, axis: &Axis, low: f64, high: f64| {
        let unit = if axis.unit == "1" { "" } else { axis.unit.as_str() };
        (format!("{way}: {}, {low:.3} to {high:.3} {unit}", axis.label), OF_AXES)
    };
    legend.push(words("x axis", &plot.x, left, right));
    legend.push(words("y axis", &plot.y, bottom, top));
    legend.dedup();
    Some(draw_legend(&legend, place([right, top]), path, scene))
}

/// The legend, in lines above a plot of this size. Returns the range of the plane that both cover.
fn draw_legend(legend: &[(String, Color)], [width, height]: [f32; 2], path: &Path, scene: &mut Scene) -> Bounds {
    let (width, height) = (width.max(1e-6), height.max(width / 4.0));
    let line = height.max(width / 2.0) * LINE;
    let mut y = height;
    for (number, (name, color)) in legend.iter().rev().enumerate() {
        y += line;
        let at = Drawing {
            strips: vec![vec![[width / 2.0, y]]],
            is_line: false,
            color: *color,
            label: name.clone(),
        };
        scene.always(&path.then("legend").then(format!("{number}")), Content::Drawing(at));
    }
    [[-0.1 * width, 1.1 * width], [-y - 0.5 * line, 0.1 * height]]
}

/// Height of a line of text, as a share of the plot's height.
const LINE: f32 = 0.14;
