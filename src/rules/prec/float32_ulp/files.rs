//! Files of points.

use crate::analysis::point_files::NamedPoints;
use crate::analysis::single_precision::step_of_single;
use crate::rules::prelude::*;

use super::{CONVERTED, Limits};

/// Proposed origins are multiples of this, metres.
const TILE_M: f64 = 1000.0;

pub(super) fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
    for points in NamedPoints::all(world) {
        judge_one(&points, limits, out);
    }
}

fn judge_one(points: &NamedPoints, limits: &Limits, out: &mut Judge) {
    let (file, subject) = (points.file, points.subject("coordinates of the points"));
    let Some(seen) = file.seen.as_ref().filter(|_| file.read >= limits.min_points as u64) else {
        let why = format!("fewer than {} points were read", limits.min_points);
        return out.too_little(subject, why);
    };
    let is_of = |kind: &str| {
        let mut fields = file.fields.iter();
        fields.any(|field| ["x", "y", "z"].contains(&field.name.as_str()) && field.datatype == kind)
    };
    let is_single = is_of("float32");
    if !is_single && !is_of("float64") {
        return out.not_applicable(subject, "the coordinates are whole numbers with a scale");
    }
    let farthest_m = seen.farthest();
    let step_m = if is_single || seen.is_single {
        step_of_single(farthest_m)
    } else {
        farthest_m * f64::EPSILON
    };
    let measured = [
        Measured::new("step at the largest coordinate", step_m, "m").limit(limits.warning_m),
        Measured::new("largest coordinate", farthest_m, "m").samples(file.read),
    ];
    if step_m < limits.warning_m {
        return out.pass(subject, measured);
    }
    let message = format!(
        "`{}`: points are up to {:.1} km from the origin, where float32 has steps of {:.0} mm",
        points.name(),
        farthest_m / 1e3,
        step_m * 1e3
    );
    let [x, y, z] = seen.middle().map(|value| (value / TILE_M).round() * TILE_M);
    let place = file.coordinates_at.as_ref().unwrap_or(&file.place).clone();
    let finding = Finding::new(limits.severity(step_m), subject, message, place)
        .relation("float32")
        .detail(if is_single { "" } else { CONVERTED })
        .help(format!(
            "write the file again from its source: subtract ({x:.0}, {y:.0}, {z:.0}) m in double precision before the conversion to float32, and \
             state that origin beside the file"
        ));
    out.fail(finding.measured(measured));
}
