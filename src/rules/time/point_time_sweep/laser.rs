//! Scans of planar lasers: a part of the rule.

use crate::analysis::lidar::Clouds;
use crate::math::stats::median;
use crate::verdict::Finding;
use crate::verdict::Judge;
use crate::verdict::Measured;
use crate::verdict::NotEvaluated;
use crate::world::laser::LaserScanAt;

/// TIME07 of planar scanners: whether the increment leads from the first angle to the last. `most` steps may be between the last ray
/// and the last angle.
pub(crate) fn judge_angles(scans: &Clouds, most: f64, out: &mut Judge) {
    let Some(laser) = scans.laser else { return };
    let subject = scans.subject("sweep of the rays");
    let usable = |scan: &&LaserScanAt| {
        let [first, last, step] = scan.angles;
        scan.rays >= 2 && step != 0.0 && [first, last, step].iter().all(|angle| angle.is_finite())
    };
    let usable: Vec<&LaserScanAt> = laser.scans.iter().filter(usable).collect();
    if usable.is_empty() {
        let why = "no scan has at least two rays, finite angles and an `angle_increment` other than zero";
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
    let (relation, scan, detail) = match (backward, beside) {
        (Some(scan), _) if half(usable.iter().filter(|scan| is_back(scan)).count()) => (
            "direction",
            scan,
            "`angle_increment` leads away from `angle_max`: consumers that use the increment see the mirror image of what consumers of the two \
             angles see.",
        ),
        (_, Some(scan)) if half(off.iter().filter(|off| **off > most).count()) => (
            "span",
            scan,
            "Consumers that use `angle_increment` and consumers that use `angle_max` see walls in different directions.",
        ),
        _ => return out.pass(subject, [measured]),
    };
    let help = if relation == "direction" {
        "if the ranges go from `angle_min` to `angle_max`, negate `angle_increment`; if they go the other way, exchange the two angles"
    } else {
        "set `angle_max` to angle_min + angle_increment * (rays - 1), with the ranges in that order"
    };
    let [first, last, step] = scan.angles.map(f64::to_degrees);
    let message = format!(
        "`{}`: {} rays of {step:.4} deg from {first:.2} deg end at {:.2} deg; `angle_max` is {last:.2} deg",
        scans.topic.topic,
        scan.rays,
        first + by_rays(scan).to_degrees()
    );
    let finding = Finding::warning(subject, message, scans.place())
        .likely()
        .relation(relation)
        .measured(measured)
        .detail(detail)
        .help(help);
    out.fail(finding);
}
