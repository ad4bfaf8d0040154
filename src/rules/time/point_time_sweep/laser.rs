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
