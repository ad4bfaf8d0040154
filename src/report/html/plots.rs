//! Plots as drawings: points and lines over two axes, with a legend and limits below.
//!
//! Decides where each plot goes (to its finding, or to the others) and draws the data. Colours are in the style sheet.

use std::collections::BTreeMap;
use std::fmt::Write;

use maud::{Markup, PreEscaped, html};

use crate::verdict::Row;
use crate::verdict::plot::{Axis, Kind, Plot};

use super::super::text::{number, plural};
use super::Page;
use super::scale::{Scale, place, range};
use super::shown::ShownFindings;
use super::words::{badge, outcome, plain, rank, words};

/// Maximum number of plots in a report; more are only counted.
const MAX_PLOTS: usize = 80;

/// Size of the data area if the axes are scaled independently, and the margins around it: left for numbers, below for numbers and words.
const WIDTH: f64 = 440.0;
const HEIGHT: f64 = 220.0;
/// Maximum size of the data area if both axes have the same scale, and the minimum length of a side.
const EQUAL: (f64, f64) = (440.0, 360.0);
const LEAST: f64 = 240.0;
const LEFT: f64 = 74.0;
/// Margin at the left for the name of the axis, and for each character of its longest number.
const OF_NAME: f64 = 32.0;
const OF_LETTER: f64 = 10.0;
const TOP: f64 = 12.0;
const RIGHT: f64 = 18.0;
const BENEATH: f64 = 50.0;

/// A limit that would flatten the data by more than this factor is stated, but not drawn.
const FLATTEST: f64 = 200.0;
/// Number of styles of series.
const LOOKS: usize = 4;

/// The plots of a run as they are drawn.
pub(super) struct PlotMarkup {
    of_finding: BTreeMap<usize, Vec<Markup>>,
    others: Vec<Markup>,
    ids: BTreeMap<usize, Vec<String>>,
    left: usize,
}

impl PlotMarkup {
    /// Draws as many as allowed, those of failed checks first.
    pub(super) fn new(page: &Page, shown: &ShownFindings) -> Self {
        let run = page.run;
        let mut drawn = Self {
            of_finding: BTreeMap::new(),
            others: Vec::new(),
            ids: BTreeMap::new(),
            left: 0,
        };
        let mut rows: Vec<(usize, &Row)> = run.verdict.rows.iter().enumerate().collect();
        rows.retain(|(_, row)| !row.plots.is_empty());
        rows.sort_by_key(|(index, row)| (rank(row.outcome), *index));
        let mut count = 0;
        for (index, row) in rows {
            let number = page
                .findings_of(&row.rule, &row.subject)
                .first()
                .map(|(number, _)| *number);
            for plot in &row.plots {
                if count >= MAX_PLOTS {
                    drawn.left += 1;
                    continue;
                }
                let id = format!("plot-{}", count + 1);
                let Some(picture) = draw(plot, &id) else { continue };
                count += 1;
                let figure = figure(plot, row, &id, &picture);
                drawn.ids.entry(index).or_default().push(id);
                match number.filter(|number| shown.is_full(*number)) {
                    Some(number) => drawn.of_finding.entry(number).or_default().push(figure),
                    None => drawn.others.push(figure),
                }
            }
        }
        drawn
    }

    /// The anchors of the plots of a row.
    pub(super) fn ids(&self, row: usize) -> &[String] {
        self.ids.get(&row).map_or(&[], Vec::as_slice)
    }

    /// The plots of a finding.
    pub(super) fn of_finding(&self, number: usize) -> Markup {
        html! { @for figure in self.of_finding.get(&number).into_iter().flatten() { (figure) } }
    }

    /// Those without a finding.
    pub(super) fn others(&self) -> Option<Markup> {
        if self.others.is_empty() && self.left == 0 {
            return None;
        }
        let with_findings: usize = self.of_finding.values().map(Vec::len).sum();
        Some(html! {
            @if with_findings > 0 {
                p class="hint" { (plural(with_findings, "plot")) " of findings: see the findings above." }
            }
            div class="plots" { @for figure in &self.others { (figure) } }
            @if self.left > 0 { p class="left-out" { "… and " (plural(self.left, "more plot")) ", not drawn." } }
        })
    }
}

fn figure(plot: &Plot, row: &Row, id: &str, picture: &Picture) -> Markup {
    let (class, sign, word) = outcome(row.outcome);
    html! {
        figure class="plot" id=(id) {
            figcaption {
                strong { (words(&plot.title)) }
                " " a href={ "#rule-" (row.rule) } { (row.rule) } " " (badge(class, sign, word))
            }
            div class="wide" tabindex="0" role="region" aria-label=(plain(&plot.title)) { (PreEscaped(&picture.svg)) }
            ul class="legend" {
                @for (look, name, words) in &picture.legend {
                    li {
                        svg class="swatch" width="34" height="12" viewBox="0 0 34 12" aria-hidden="true" {
                            path class=(look) d=(if look.starts_with('p') { "M8 6h0M17 6h0M26 6h0" } else { "M1 6h32" }) {}
                        }
                        " " (plain(name)) (plain(words))
                    }
                }
            }
        }
    }
}

/// A drawing, and its legend: the class of the style, the name, and further words.
pub(super) struct Picture {
    pub(super) svg: String,
    pub(super) legend: Vec<(String, String, String)>,
}

/// Draws a plot; `None` if it has no point that can be drawn.
pub(super) fn draw(plot: &Plot, id: &str) -> Option<Picture> {
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let (x0, x1) = range(points().map(|point| point[0]))?;
    let measured = range(points().map(|point| point[1]))?;
    let (y0, y1) = with_limits(plot, measured)?;
    let (width, height) = if plot.equal {
        let each = (EQUAL.0 / (x1 - x0)).min(EQUAL.1 / (y1 - y0));
        (((x1 - x0) * each).max(LEAST), ((y1 - y0) * each).max(LEAST))
    } else {
        (WIDTH, HEIGHT)
    };
    let ((x0, x1), (y0, y1)) = if plot.equal {
        // The side that was too short shows a larger range, at the same scale.
        let of_each = ((x1 - x0) / width).max((y1 - y0) / height);
        (about((x0, x1), of_each * width), about((y0, y1), of_each * height))
    } else {
        ((x0, x1), (y0, y1))
    };
    let y = Scale {
        from: y0,
        to: y1,
        start: TOP + height,
        end: TOP,
    };
    let longest = ticks_of_y(plot, &y).iter().map(|(_, text)| text.chars().count()).max();
    let left = LEFT.max(OF_NAME + OF_LETTER * longest.unwrap_or(0) as f64);
    let x = Scale {
        from: x0,
        to: x1,
        start: left,
        end: left + width,
    };
    let mut body = String::new();
    axes(plot, &x, &y, &mut body);
    let legend = data(plot, &x, &y, id, &mut body);
    let (whole_width, whole_height) = (place(left + width + RIGHT), place(TOP + height + BENEATH));
    let count: usize = plot.series.iter().map(|series| series.points.len()).sum();
    let inner = html! {
        title id={ (id) "-name" } { (plain(&plot.title)) }
        desc id={ (id) "-words" } {
            (count) " points. " (plain(&spoken(&plot.x, points().map(|point| point[0])))) " "
            (plain(&spoken(&plot.y, points().map(|point| point[1]))))
        }
        clipPath id={ (id) "-area" } {
            rect x=(place(left)) y=(place(TOP)) width=(place(width)) height=(place(height)) {}
        }
        (PreEscaped(body))
    };
    let svg = html! {
        svg role="img" aria-labelledby={ (id) "-name " (id) "-words" } width=(whole_width) height=(whole_height)
            viewBox={ "0 0 " (whole_width) " " (whole_height) } { (inner) }
    };
    Some(Picture {
        svg: svg.into_string(),
        legend,
    })
}

/// The range of y, including the limits that do not flatten the data.
fn with_limits(plot: &Plot, (low, high): (f64, f64)) -> Option<(f64, f64)> {
    let values = || {
        plot.series
            .iter()
            .flat_map(|series| &series.points)
            .map(|point| point[1])
    };
    let (least, most) = values().fold((f64::MAX, f64::MIN), |(least, most), value| {
        (least.min(value), most.max(value))
    });
    let is_near = |at: &f64| {
        let reach = (most.max(*at) - least.min(*at)).abs();
        most <= least || reach <= FLATTEST * (most - least)
    };
    let limits = plot.limits.iter().map(|limit| limit.at).filter(is_near);
    let mut limits = limits.peekable();
    if limits.peek().is_none() {
        return Some((low, high));
    }
    range(values().chain(limits))
}

/// A range of this length around the middle of another.
fn about((from, to): (f64, f64), length: f64) -> (f64, f64) {
    let middle = f64::midpoint(from, to);
    (middle - length / 2.0, middle + length / 2.0)
}

/// `time: from 0 to 12.5 s.`
fn spoken(axis: &Axis, values: impl Iterator<Item = f64>) -> String {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    format!(
        "{}: from {} to {}{}.",
        axis.label,
        number(low, 4),
        number(high, 4),
        unit(axis)
    )
}

fn unit(axis: &Axis) -> String {
    match axis.unit.as_str() {
        "" | "1" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// The number of ticks along a side.
fn most(length: f64, each: f64) -> usize {
    // Lengths are at most some hundred.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let count = (length / each) as usize;
    count.clamp(2, 8)
}

fn ticks_of_y(plot: &Plot, y: &Scale) -> Vec<(f64, String)> {
    y.ticks(&plot.y.unit, most(y.start - y.end, 45.0))
}

fn axes(plot: &Plot, x: &Scale, y: &Scale, body: &mut String) {
    let (left, right) = (place(x.start), place(x.end));
    let (top, bottom) = (place(y.end), place(y.start));
    for (value, text) in x.ticks(&plot.x.unit, most(x.end - x.start, 80.0)) {
        let at = place(x.at(value));
        let _ = write!(
            body,
            "<path class=\"grid\" d=\"M{at} {top}V{bottom}\"/><text class=\"tick middle\" x=\"{at}\" y=\"{}\">{text}</text>",
            place(y.start + 18.0)
        );
    }
    for (value, text) in ticks_of_y(plot, y) {
        let at = y.at(value);
        let _ = write!(
            body,
            "<path class=\"grid\" d=\"M{left} {}H{right}\"/><text class=\"tick end\" x=\"{}\" y=\"{}\">{text}</text>",
            place(at),
            place(x.start - 6.0),
            place(at + 4.0)
        );
    }
    let _ = write!(body, "<path class=\"axis\" d=\"M{left} {top}V{bottom}H{right}\"/>");
    let name = |axis: &Axis| match unit(axis) {
        unit if unit.is_empty() => plain(&axis.label),
        unit => plain(&format!("{},{unit}", axis.label)),
    };
    let named = html! {
        text class="name middle" x=(place(f64::midpoint(x.start, x.end))) y=(place(y.start + 40.0)) { (name(&plot.x)) }
        text class="name middle" transform={ "translate(14 " (place(f64::midpoint(y.start, y.end))) ") rotate(-90)" } { (name(&plot.y)) }
    };
    body.push_str(&named.into_string());
}

/// Draws limits and series, and their legend.
fn data(plot: &Plot, x: &Scale, y: &Scale, id: &str, body: &mut String) -> Vec<(String, String, String)> {
    let mut legend: Vec<(String, String, String)> = Vec::new();
    let mut names: Vec<&str> = Vec::new();
    let _ = write!(body, "<g clip-path=\"url(#{id}-area)\">");
    for series in &plot.series {
        let look = names
            .iter()
            .position(|name| *name == series.name)
            .unwrap_or(names.len());
        let class = match series.kind {
            Kind::Points if series.points.len() == 1 => format!("p{} alone", look % LOOKS),
            Kind::Points => format!("p{}", look % LOOKS),
            Kind::Line => format!("l{}", look % LOOKS),
        };
        let mut path = String::new();
        let mut last = None;
        for point in &series.points {
            let at = (place(x.at(point[0])), place(y.at(point[1])));
            // Hundreds of points may coincide in the drawing.
            if last.as_ref() == Some(&at) {
                continue;
            }
            let _ = match (series.kind, last.is_some()) {
                (Kind::Points, _) => write!(path, "M{} {}h0", at.0, at.1),
                (Kind::Line, false) => write!(path, "M{} {}", at.0, at.1),
                (Kind::Line, true) => write!(path, "L{} {}", at.0, at.1),
            };
            last = Some(at);
        }
        let _ = write!(body, "<path class=\"{class}\" d=\"{path}\"/>");
        if look == names.len() {
            names.push(&series.name);
            legend.push((class, series.name.clone(), String::new()));
        }
    }
    for limit in &plot.limits {
        let is_drawn = (y.from..=y.to).contains(&limit.at);
        if is_drawn {
            let (at, left, right) = (place(y.at(limit.at)), place(x.start), place(x.end));
            let _ = write!(body, "<path class=\"limit\" d=\"M{left} {at}H{right}\"/>");
        }
        let beyond = if is_drawn { "" } else { " (outside of the plot)" };
        let words = format!(": {}{}{beyond}", number(limit.at, 4), unit(&plot.y));
        legend.push(("limit".to_owned(), limit.label.clone(), words));
    }
    body.push_str("</g>");
    legend
}
