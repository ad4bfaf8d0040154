//! Scans of planar lasers: a part of the rule.

use crate::analysis::lidar::Clouds;
use crate::math::stats::median;
use crate::verdict::Finding;
use crate::verdict::Judge;
use crate::verdict::Measured;
use crate::world::laser::LaserScanAt;

/// Units other than seconds: how many of them are in a second.
const UNITS: [(f64, &str); 3] = [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")];

/// The median of a value over the scans that state it: zero means that it is not known.
fn of(scans: &Clouds, value: impl Fn(&LaserScanAt) -> f64) -> Option<f64> {
    let stated = scans.laser?.scans.iter().map(value);
    let stated: Vec<f64> = stated
        .filter(|value| value.is_finite() && *value != 0.0)
        .map(f64::abs)
        .collect();
    median(&stated)
}

/// TIME06 of planar scanners: `scan_time`, and `time_increment` over all rays, against the step between scans. `share` is the range that a
/// scan may take of that step.
pub(crate) fn judge_times(scans: &Clouds, share: [f64; 2], out: &mut Judge) {
    let stated = [
        ("scan_time", of(scans, |scan| scan.scan_time_s)),
        (
            "time_increment",
            of(scans, |scan| {
                scan.time_increment_s * f64::from(scan.rays.saturating_sub(1))
            }),
        ),
    ];
    let stated: Vec<(&str, f64)> = stated
        .iter()
        .filter_map(|(name, value)| Some((*name, (*value)?)))
        .collect();
    // Scans without times have all rays at once, which is right for a simulator and for a slice of a depth image.
    if stated.is_empty() {
        return;
    }
    let subject = scans.subject("unit of the times of the rays");
    let Some(period_s) = scans.period_s() else {
        return out.too_little(
            subject,
            "the scan period is unknown: the stamps of the scans do not advance",
        );
    };
    let fits = |seconds: f64| (share[0]..=share[1]).contains(&(seconds / period_s));
    let what = |name: &str| match name {
        "scan_time" => "`scan_time`".to_owned(),
        other => format!("`{other}` times the rays"),
    };
    let measured = stated
        .iter()
        .map(|(name, value)| Measured::new(what(name), *value, "s").limit(share[1] * period_s))
        .chain([Measured::new("scan period", period_s, "s")]);
    let other = |(name, value): &(&'static str, f64)| {
        let (_, unit) = UNITS.iter().find(|(per_second, _)| fits(value / per_second))?;
        (!fits(*value)).then_some((*name, *value, *unit))
    };
    if let Some((name, value, unit)) = stated.iter().find_map(other) {
        let message = format!(
            "`{}`: {} is {value:.3}, the scan period ({period_s:.3} s) in {unit}",
            scans.topic.topic,
            what(name)
        );
        let finding = Finding::error(subject, message, scans.place())
            .likely()
            .relation("unit")
            .help("publish `scan_time` and `time_increment` in seconds, the unit of the message: programs that deskew compute with them");
        return out.fail(finding.measured(measured));
    }
    if stated.iter().any(|(_, value)| fits(*value)) {
        return out.pass(subject, measured);
    }
    let values: Vec<String> = stated
        .iter()
        .map(|(name, value)| format!("{} is {value} s", what(name)))
        .collect();
    let why = format!(
        "{}, but the scan period is {period_s:.3} s: no unit explains that",
        values.join(", ")
    );
    out.too_little(subject, why);
}
