//! AXES17: a map of points whose ground is not below.

use crate::analysis::ground::SIDES;
use crate::analysis::point_files::NamedPoints;
use crate::rules::prelude::*;
use crate::world::point_file::{CrsKind, Relief};

pub(crate) struct MapFileUp;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    length_m: f64,
    width_m: f64,
    max_thickness: f64,
    min_cells: u32,
    min_ground: f64,
    min_ratio: f64,
}

impl Rule for MapFileUp {
    const NEEDS: &'static [Need] = &[Need::Points];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for points in NamedPoints::all(world) {
            let subject = points.subject("up");
            let crs = points.file.crs.as_ref();
            match &points.file.seen {
                None => out.too_little(subject, "no point was read"),
                Some(_) if crs.is_some_and(|crs| crs.kind != CrsKind::Projected) => {
                    out.not_applicable(subject, "its coordinates are not on a plane");
                }
                Some(seen) => judge_one(subject, &points, &seen.relief, limits, out),
            }
        }
    }
}

/// The axis that a map is thin along: its other two extents are those of no single scan and no wall.
fn thin(relief: &[Relief; 3], limits: &Limits) -> Option<usize> {
    let mut axes: Vec<(usize, f64)> = relief.iter().map(|one| one.extent).enumerate().collect();
    axes.sort_by(|a, b| a.1.total_cmp(&b.1));
    let [(axis, thickness), (_, width), (_, length)] = *axes else {
        return None;
    };
    let is_map = length >= limits.length_m && width >= limits.width_m && thickness <= limits.max_thickness * width;
    is_map.then_some(axis)
}

fn judge_one(subject: String, points: &NamedPoints, relief: &[Relief; 3], limits: &Limits, out: &mut Judge) {
    let along = thin(relief, limits).and_then(|axis| Some((axis, relief.get(axis)?)));
    let Some((axis, along)) = along else {
        let why = format!(
            "the points do not extend over {} by {} m of a plane: a scan, an object or a wall may be in any axes",
            limits.length_m, limits.width_m
        );
        return out.not_applicable(subject, why);
    };
    let (ground, opposite) = (along.low.max(along.high), along.low.min(along.high));
    if along.cells < limits.min_cells || ground < limits.min_ground || ground < limits.min_ratio * opposite {
        let why = format!(
            "no side is clearly the ground: {:.0} % of the points are on the lowest surface, {:.0} % on the highest, in {} cells",
            along.low * 100.0,
            along.high * 100.0,
            along.cells
        );
        return out.too_little(subject, why);
    }
    let measured = [
        Measured::new("share of the points on the ground", ground, "1")
            .at_least(limits.min_ground)
            .samples(points.file.read),
        Measured::new("the same on the opposite side", opposite, "1").limit(ground / limits.min_ratio),
        Measured::new("extent of the points along up", along.extent, "m"),
    ];
    // Sides are in the order z, -z, x, -x, y, -y.
    let side = 2 * ((axis + 1) % 3) + usize::from(along.high > along.low);
    let Some((_, up)) = SIDES.get(side).filter(|_| side != 0) else {
        return out.pass(subject, measured);
    };
    let message = format!("`{}`: up is {up} by the ground of the map, not z", points.name());
    let help = match *up {
        "-z" => "rotate the points by 180 deg about x, if they are not meant to be in north, east, down",
        "y" | "-y" => "rotate the points from the axes of a camera, or of graphics, to z up (REP-103)",
        _ => "rotate the points so that z points up (REP-103)",
    };
    let place = points
        .file
        .coordinates_at
        .as_ref()
        .unwrap_or(&points.file.place)
        .clone();
    let finding = Finding::warning(subject, message, place).relation(if *up == "-z" { "z-down" } else { "up-axis" });
    out.fail(finding.likely().help(help).measured(measured));
}
