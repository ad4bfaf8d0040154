//! PREC01: coordinates that are too large for float32.

mod files;

use crate::analysis::lidar::Clouds;
use crate::analysis::single_precision::{single, step_of_single};
use crate::rules::prelude::*;

pub(crate) struct Float32Ulp;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    warning_m: f64,
    error_m: f64,
    min_points: usize,
}

impl Rule for Float32Ulp {
    const NEEDS: &'static [Need] = &[Need::BagOrPoints];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for clouds in Clouds::published(world) {
            judge_clouds(&clouds, limits, out);
        }
        files::judge(world, limits, out);
    }
}

impl Limits {
    fn severity(&self, step_m: f64) -> Severity {
        if step_m >= self.error_m {
            Severity::Error
        } else {
            Severity::Warning
        }
    }
}

const CONVERTED: &str =
    "The coordinates are float64, but all values are float32 numbers: they were converted from float32.";

fn judge_clouds(clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("coordinates of the points");
    let points = || clouds.evidence.samples.iter().flat_map(|sample| &sample.points);
    let Some((at, farthest_m)) = clouds
        .evidence
        .farthest
        .as_ref()
        .filter(|_| points().count() >= limits.min_points)
    else {
        return out.too_little(
            subject,
            format!("fewer than {} points with a return were sampled", limits.min_points),
        );
    };
    let types = ["x", "y", "z"].map(|name| clouds.datatype(name).unwrap_or_default());
    let is_single = types.contains(&"float32");
    // Doubles that were converted from float32 keep its steps.
    let went_through = !is_single
        && points()
            .flat_map(|point| point.xyz)
            .all(|value| f64::from(single(value)).to_bits() == value.to_bits());
    if !is_single && !types.contains(&"float64") {
        return out.not_applicable(
            subject,
            format!("the coordinates are of type {}, neither float32 nor float64", types[0]),
        );
    }
    let step_m = if is_single || went_through {
        step_of_single(*farthest_m)
    } else {
        farthest_m * f64::EPSILON
    };
    let measured = [
        Measured::new("step at the largest coordinate", step_m, "m").limit(limits.warning_m),
        Measured::new("largest coordinate", *farthest_m, "m").samples(points().count() as u64),
    ];
    if step_m < limits.warning_m {
        return out.pass(subject, measured);
    }
    let detail = if is_single { "" } else { CONVERTED };
    let message = format!(
        "`{}`: points are up to {:.1} km from the origin, where float32 has steps of {:.0} mm",
        clouds.topic.topic,
        farthest_m / 1e3,
        step_m * 1e3
    );
    let finding = Finding::new(
        limits.severity(step_m),
        subject,
        message,
        Place::message(clouds.bag.source, at.clone()),
    )
    .relation("float32")
    .detail(detail)
    .help(
        "subtract a local origin in double precision before the conversion to float32, and publish it as a transform (one origin for each map tile)",
    );
    out.fail(finding.measured(measured));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_are_those_of_ieee_754() {
        for value in [1.0_f32, 65_536.0, 131_072.0, 500_000.0, 5_000_000.0] {
            let step = f64::from(value.next_up()) - f64::from(value);
            assert_eq!(step_of_single(f64::from(value)).to_bits(), step.to_bits(), "{value}");
        }
    }
}
