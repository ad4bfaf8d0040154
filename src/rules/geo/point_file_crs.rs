//! GEO09: coordinates of a file of points that its coordinate reference system cannot have.

use crate::analysis::point_files::NamedPoints;
use crate::rules::prelude::*;
use crate::world::point_file::{CrsKind, PointsSeen, StatedCrs};

pub(crate) struct PointFileCrs;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    easting_least_m: f64,
    easting_most_m: f64,
    northing_most_m: f64,
    degrees_extent: f64,
    max_unit_off: f64,
}

impl Rule for PointFileCrs {
    const NEEDS: &'static [Need] = &[Need::Points];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for points in NamedPoints::all(world) {
            let subject = points.subject("coordinates");
            match (&points.file.crs, &points.file.seen) {
                (None, _) => out.not_applicable(subject, "the file states no coordinate reference system"),
                (_, None) => out.too_little(subject, "no point was read"),
                (Some(crs), Some(seen)) => {
                    judge_range(subject, &points, (crs, seen), limits, out);
                    judge_unit(&points, crs, limits, out);
                }
            }
        }
    }
}

/// What the coordinates are instead: relation, words, help.
type Cause = (&'static str, &'static str, &'static str);

const DEGREES: Cause = (
    "degrees",
    "they are degrees",
    "state the geographic system of the degrees, or project the points",
);
const METRES: Cause = (
    "metres",
    "they are no degrees",
    "state the projected system that the points are in",
);
const SWAPPED: Cause = (
    "swapped",
    "x and y are exchanged",
    "exchange x and y of the points: easting and longitude first",
);
const LOCAL: Cause = (
    "local",
    "they count from a local origin",
    "remove the system from the header, or add the origin that was subtracted to the points",
);

fn cause(crs: &StatedCrs, seen: &PointsSeen, limits: &Limits) -> Option<Cause> {
    let ([x, y, _], [x_most, y_most, _]) = (seen.least, seen.most);
    let within = |low: f64, high: f64, least: f64, most: f64| least <= low && high <= most;
    let are_degrees = within(x, x_most, -180.0, 180.0)
        && within(y, y_most, -90.0, 90.0)
        && x_most - x <= limits.degrees_extent
        && y_most - y <= limits.degrees_extent;
    match crs.kind {
        CrsKind::Geographic if within(x, x_most, -360.0, 360.0) && within(y, y_most, -90.0, 90.0) => None,
        CrsKind::Geographic if within(x, x_most, -90.0, 90.0) && within(y, y_most, -180.0, 180.0) => Some(SWAPPED),
        CrsKind::Geographic => Some(METRES),
        CrsKind::Projected if crs.utm().is_some() => {
            let is_easting = |low, high| within(low, high, limits.easting_least_m, limits.easting_most_m);
            let is_northing = |low, high| within(low, high, 0.0, limits.northing_most_m);
            if is_easting(x, x_most) && is_northing(y, y_most) {
                None
            } else if are_degrees {
                Some(DEGREES)
            } else if is_easting(y, y_most) && is_northing(x, x_most) {
                Some(SWAPPED)
            } else {
                Some(LOCAL)
            }
        }
        _ => None,
    }
}

fn judge_range(
    subject: String,
    points: &NamedPoints,
    (crs, seen): (&StatedCrs, &PointsSeen),
    limits: &Limits,
    out: &mut Judge,
) {
    let number = |what: &str, value: f64| Measured::new(what, value, "1").samples(points.file.read);
    let measured = [
        number("smallest x", seen.least[0]),
        number("largest x", seen.most[0]),
        number("smallest y", seen.least[1]),
        number("largest y", seen.most[1]),
    ];
    let Some((relation, words, help)) = cause(crs, seen, limits) else {
        return out.pass(subject, measured);
    };
    let message = format!("`{}`: the points cannot be in {}: {words}", points.name(), crs.name);
    let finding = Finding::error(subject, message, points.file.place.clone())
        .relation(relation)
        .detail(format!("The system is stated in the header, as {}.", crs.by))
        .help(help);
    out.fail(finding.measured(measured));
}

fn judge_unit(points: &NamedPoints, crs: &StatedCrs, limits: &Limits, out: &mut Judge) {
    let Some(unit_m) = crs.unit_m else { return };
    let subject = points.subject("unit");
    let measured = Measured::new("unit of x and y", unit_m, "m").expected(1.0);
    if (unit_m - 1.0).abs() <= limits.max_unit_off {
        return out.pass(subject, measured);
    }
    let message = format!("`{}`: x and y are in units of {unit_m:.7} m, not metres", points.name());
    let finding = Finding::warning(subject, message, points.file.place.clone())
        .relation("unit")
        .help("project the points to a system in metres (`pdal translate` with filters.reprojection): robots use metres (REP-103)");
    out.fail(finding.measured(measured));
}
