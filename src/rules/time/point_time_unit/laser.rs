//! Scans of planar lasers: a part of the rule.

use crate::analysis::lidar::Clouds;
use crate::math::stats::median;
use crate::verdict::Finding;
use crate::verdict::Judge;
use crate::verdict::Measured;
use crate::world::laser::LaserScanAt;

/// What a second is, where a number is in another unit.
const UNITS: [(f64, &str); 3] = [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")];

/// The median of what the scans tell, where they tell it: zero says nothing.
fn of(scans: &Clouds, value: impl Fn(&LaserScanAt) -> f64) -> Option<f64> {
    let told = scans.laser?.scans.iter().map(value);
    let told: Vec<f64> = told
        .filter(|value| value.is_finite() && *value != 0.0)
        .map(f64::abs)
        .collect();
    median(&told)
}

/// TIME06 of planar scanners: `scan_time`, and the rays' times together, against the step between scans. `share` of that step is
/// what a scan may take.
pub(crate) fn judge_times(scans: &Clouds, share: [f64; 2], out: &mut Judge) {
    let told = [
        ("scan_time", of(scans, |scan| scan.scan_time_s)),
        (
            "time_increment",
            of(scans, |scan| {
                scan.time_increment_s * f64::from(scan.rays.saturating_sub(1))
            }),
        ),
    ];
    let told: Vec<(&str, f64)> = told
        .iter()
        .filter_map(|(name, value)| Some((*name, (*value)?)))
        .collect();
    // Scans that tell no times have all rays at once, which is right for a simulator and for a slice of a depth image.
    if told.is_empty() {
        return;
    }
    let subject = scans.subject("unit of the times of the rays");
    let Some(period_s) = scans.period_s() else {
        return out.too_little(subject, "the scans have no steps between their stamps: how long one takes is not known");
    };
    let fits = |seconds: f64| (share[0]..=share[1]).contains(&(seconds / period_s));
    let what = |name: &str| match name {
        "scan_time" => "`scan_time`".to_owned(),
        other => format!("`{other}` times the rays"),
    };
    let measured = told
        .iter()
        .map(|(name, value)| Measured::new(what(name), *value, "s").limit(share[1] * period_s))
        .chain([Measured::new("from one scan to the next", period_s, "s")]);
    let other = |(name, value): &(&'static str, f64)| {
        let (_, unit) = UNITS.iter().find(|(per_second, _)| fits(value / per_second))?;
        (!fits(*value)).then_some((*name, *value, *unit))
    };
    if let Some((name, value, unit)) = told.iter().find_map(other) {
        let message = format!(
            "{} on `{}` is {value:.3}, a scan of {period_s:.3} s in {unit}, where the message has seconds",
            what(name),
            scans.topic.topic
        );
        let finding = Finding::error(subject, message, scans.place())
            .likely()
            .relation("unit")
            .help(format!(
                "publish `{name}` in seconds: who takes the motion out of a scan multiplies by it"
            ));
        return out.fail(finding.measured(measured));
    }
    if told.iter().any(|(_, value)| fits(*value)) {
        return out.pass(subject, measured);
    }
    let values: Vec<String> = told
        .iter()
        .map(|(name, value)| format!("{} is {value} s", what(name)))
        .collect();
    let why = format!(
        "{}, where scans come every {period_s:.3} s: no unit explains that",
        values.join(", ")
    );
    out.too_little(subject, why);
}
