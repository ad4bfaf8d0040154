//! The times and angles that the scans of planar scanners tell of themselves: `sensor_msgs/LaserScan` has seconds and radians.

use crate::math::stats::median;
use crate::rules::Judge;
use crate::rules::lidar::Clouds;
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::laser::LaserScanAt;

/// What a second is, where a number is in another unit.
const UNITS: [(f64, &str); 3] = [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")];

/// TIME06 of planar scanners: `scan_time`, and the rays' times together, against the step between scans. `share` of that step is
/// what a scan may take.
pub(super) fn judge_times(scans: &Clouds, share: [f64; 2], out: &mut Judge) {
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
        let why = "the scans have no steps between their stamps: how long one takes is not known";
        return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
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
        return out.fail(measured.fold(finding, Finding::measured));
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
    out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
}

/// The median of what the scans tell, where they tell it: zero says nothing.
fn of(scans: &Clouds, value: impl Fn(&LaserScanAt) -> f64) -> Option<f64> {
    let told = scans.laser?.scans.iter().map(value);
    let told: Vec<f64> = told
        .filter(|value| value.is_finite() && *value != 0.0)
        .map(f64::abs)
        .collect();
    median(&told)
}

/// TIME07 of planar scanners: whether the increment leads from the first angle to the last. `most` steps may be between the last ray
/// and the last angle.
pub(super) fn judge_angles(scans: &Clouds, most: f64, out: &mut Judge) {
    let Some(laser) = scans.laser else { return };
    let subject = scans.subject("sweep of the rays");
    let usable = |scan: &&LaserScanAt| {
        let [first, last, step] = scan.angles;
        scan.rays >= 2 && step != 0.0 && [first, last, step].iter().all(|angle| angle.is_finite())
    };
    let usable: Vec<&LaserScanAt> = laser.scans.iter().filter(usable).collect();
    if usable.is_empty() {
        let why = "no scan has two rays, angles that are numbers, and a step between them";
        return out.not_evaluated(subject, NotEvaluated::InputBroken, why);
    }
    let span = |scan: &LaserScanAt| scan.angles[1] - scan.angles[0];
    let by_rays = |scan: &LaserScanAt| scan.angles[2] * f64::from(scan.rays - 1);
    let half = |count: usize| 2 * count > usable.len();
    let steps = |scan: &LaserScanAt| ((span(scan) - by_rays(scan)) / scan.angles[2]).abs();
    let is_back = |scan: &LaserScanAt| span(scan) * scan.angles[2] < 0.0;
    let off: Vec<f64> = usable.iter().map(|scan| steps(scan)).collect();
    let measured = Measured::new(
        "steps between the last ray and the last angle",
        median(&off).unwrap_or(f64::NAN),
        "1",
    )
    .limit(most)
    .samples(off.len() as u64);
    let backward = usable.iter().find(|scan| is_back(scan));
    let beside = usable.iter().find(|scan| steps(scan) > most);
    let (relation, scan, message) = match (backward, beside) {
        (Some(scan), _) if half(usable.iter().filter(|scan| is_back(scan)).count()) => (
            "direction",
            scan,
            "by `angle_increment` the rays lead away from `angle_max`: whoever takes the increment sees the mirror image of what he \
             sees who takes the two angles",
        ),
        (_, Some(scan)) if half(off.iter().filter(|off| **off > most).count()) => (
            "span",
            scan,
            "by `angle_increment` the last ray is not at `angle_max`: consumers that take the one and that take the other see walls in \
             different directions",
        ),
        _ => return out.pass(subject, [measured]),
    };
    let [first, last, step] = scan.angles.map(f64::to_degrees);
    let message = format!(
        "on `{}` {} rays from {first:.2} to {last:.2} deg are {step:.4} deg apart, which leads to {:.2} deg: {message}",
        scans.topic.topic,
        scan.rays,
        first + by_rays(scan).to_degrees()
    );
    let finding = Finding::warning(subject, message, scans.place())
        .likely()
        .relation(relation)
        .measured(measured)
        .help("let `angle_max` be angle_min + angle_increment * (rays - 1), and the ranges stand in that order");
    out.fail(finding);
}
