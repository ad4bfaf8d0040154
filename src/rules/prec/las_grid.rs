//! PREC04: the scale, the offset and the bounds in the header of a LAS file.

use crate::analysis::point_files::NamedPoints;
use crate::rules::prelude::*;
use crate::world::point_file::{CrsKind, LasHeader};

pub(crate) struct LasGrid;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    warning_m: f64,
    error_m: f64,
    degree_m: f64,
    bound_steps: f64,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Rule for LasGrid {
    const NEEDS: &'static [Need] = &[Need::Points];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for points in NamedPoints::all(world) {
            match &points.file.las {
                Some(header) => {
                    judge_scale(&points, header, limits, out);
                    judge_bounds(&points, header, limits, out);
                }
                None => out.not_applicable(points.subject("grid"), "only LAS and LAZ have a scale and an offset"),
            }
        }
    }
}

fn judge_scale(points: &NamedPoints, header: &LasHeader, limits: &Limits, out: &mut Judge) {
    let subject = points.subject("scale");
    let crs = points.file.crs.as_ref();
    let unit_m = match crs {
        Some(crs) if crs.kind == CrsKind::Geographic => limits.degree_m,
        crs => crs.and_then(|crs| crs.unit_m).unwrap_or(1.0),
    };
    let [x, y, _] = header.scale.map(f64::abs);
    let step_m = x.max(y) * unit_m;
    let measured = Measured::new("step of x and y", step_m, "m").limit(limits.warning_m);
    if (step_m <= limits.warning_m) && header.scale.iter().all(|scale| scale.is_finite() && *scale != 0.0) {
        return out.pass(subject, measured);
    }
    let severity = if step_m > limits.warning_m && step_m <= limits.error_m {
        Severity::Warning
    } else {
        Severity::Error
    };
    let message = format!("`{}`: x and y have steps of {:.1} cm", points.name(), step_m * 100.0);
    let finding = Finding::new(severity, subject, message, points.file.place.clone())
        .relation("scale")
        .help("write the file again from its source with a scale of 0.001 m (0.00000001 deg), and an offset near the points");
    out.fail(finding.measured(measured));
}

/// Points outside of the stated bounds, and bounds that whole numbers of 32 bits do not reach.
fn judge_bounds(points: &NamedPoints, header: &LasHeader, limits: &Limits, out: &mut Judge) {
    let subject = points.subject("bounds");
    let Some(seen) = &points.file.seen else {
        return out.too_little(subject, "no point was read");
    };
    let axes = (0..3).filter_map(|at| {
        let of = |all: &[f64; 3]| all.get(at).copied();
        let (scale, offset) = (of(&header.scale)?.abs(), of(&header.offset)?);
        let (least, most) = (of(&header.least)?, of(&header.most)?);
        let steps = (least - offset).abs().max((most - offset).abs()) / scale;
        let beyond = (least - of(&seen.least)?).max(of(&seen.most)? - most);
        Some((*AXES.get(at)?, steps, beyond / scale, beyond))
    });
    let axes: Vec<_> = axes.collect();
    let widest = axes.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let farthest = axes.iter().max_by(|a, b| a.2.total_cmp(&b.2));
    let (Some(widest), Some(farthest)) = (widest, farthest) else {
        return;
    };
    let measured = [
        Measured::new("largest bound, in steps from the offset", widest.1, "1").limit(f64::from(i32::MAX)),
        Measured::new("farthest point beyond the bounds", farthest.3.max(0.0), "1")
            .limit(limits.bound_steps)
            .samples(points.file.read),
    ];
    let (relation, message, help) = if widest.1 > f64::from(i32::MAX) {
        (
            "overflow",
            format!(
                "`{}`: {} does not fit into 32 bits with this scale and offset",
                points.name(),
                widest.0
            ),
            "write the file again from its source with an offset near the points: those that do not fit are somewhere else now",
        )
    } else if farthest.2 > limits.bound_steps {
        (
            "bounds",
            format!(
                "`{}`: points are {:.2} beyond the stated bounds of {}",
                points.name(),
                farthest.3,
                farthest.0
            ),
            "recompute the header (`lasinfo -repair`, `pdal translate`): programs choose tiles and origins by its bounds",
        )
    } else {
        return out.pass(subject, measured);
    };
    let finding = Finding::error(subject, message, points.file.place.clone());
    out.fail(finding.relation(relation).help(help).measured(measured));
}
