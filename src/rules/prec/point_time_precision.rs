//! PREC02: times of points that are too large for the precision of their type.

use crate::analysis::{lidar::Clouds, single_precision::step_of_single};
use crate::rules::prelude::*;

pub(crate) struct PointTimePrecision;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_share: f64,
}

impl Rule for PointTimePrecision {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for clouds in Clouds::published(world) {
            judge_clouds(&clouds, limits, out);
        }
    }
}

fn judge_clouds(clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let largest = |low: f64, high: f64| low.abs().max(high.abs());
    let widest = clouds
        .timed()
        .map(|(_, times)| (times, largest(times.range[0], times.range[1])))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((times, largest)) = widest else { return };
    let subject = clouds.subject("precision of the times of the points");
    let step = match times.datatype.as_str() {
        "float32" => step_of_single(largest),
        "float64" => largest * f64::EPSILON,
        _ => 1.0,
    };
    let Some(period_s) = clouds.period_s() else {
        let why = "the scan period is unknown: the stamps of the clouds do not advance";
        return out.too_little(subject, why);
    };
    // In float32, times in seconds since 1970 do not change during a scan: their size shows the unit.
    let is_epoch_s = times.datatype.starts_with("float") && (1e8..1e11).contains(&largest);
    let unit_s = match clouds.unit(times) {
        Some((unit_s, _)) => unit_s,
        None if is_epoch_s => 1.0,
        None => {
            return out.too_little(
                subject,
                format!(
                    "the unit of `{}` is unknown: its span matches the scan period in no unit",
                    times.field
                ),
            );
        }
    };
    let share = step * unit_s / period_s;
    let measured = [
        Measured::new("step of the times as a share of a scan", share, "1").limit(limits.max_share),
        Measured::new("step of the times", step * unit_s, "s"),
    ];
    if share <= limits.max_share {
        return out.pass(subject, measured);
    }
    let message = format!(
        "`{}`: `{}` ({}) has steps of {:.3} s, but a scan takes {period_s:.3} s",
        clouds.topic.topic,
        times.field,
        times.datatype,
        step * unit_s
    );
    let finding = Finding::error(subject, message, clouds.place())
        .relation("precision")
        .detail(format!(
            "Its values are as large as {largest:.0}, where two neighbouring {} numbers are that far apart.",
            times.datatype
        ))
        .help("publish times from the start of the scan, or in float64");
    out.fail(finding.measured(measured));
}
