//! AXES10: a cloud whose ground is not where z says that down is.

use std::sync::Arc;

use nalgebra::Vector3;
use serde::Deserialize;

use crate::math::support::{Options, Support, support};
use crate::rules::lidar::Clouds;
use crate::rules::motion::{Motion, mount};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;
use crate::world::cloud::CloudSample;

/// AXES10.
pub struct UpAxisFlip;

/// Limits of AXES10.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_clouds: usize,
    min_agreement: f64,
    min_score: f64,
    min_ratio: f64,
    max_below: f64,
    min_on: f64,
    min_above: f64,
    max_at_horizon: f64,
    least_m: f64,
    max_off_deg: f64,
    ceiling_cells: usize,
}

/// The axes of a cloud, and what they are called.
const AXES: [([f64; 3], &str); 6] = [
    ([0.0, 0.0, 1.0], "z"),
    ([0.0, 0.0, -1.0], "-z"),
    ([1.0, 0.0, 0.0], "x"),
    ([-1.0, 0.0, 0.0], "-x"),
    ([0.0, 1.0, 0.0], "y"),
    ([0.0, -1.0, 0.0], "-y"),
];

/// Which axis points up in one cloud.
struct Up {
    axis: usize,
    score: f64,
    next: f64,
    /// Whether something like a ceiling lies opposite.
    is_indoors: bool,
}

impl Rule for UpAxisFlip {
    const PAGE: &'static str = include_str!("../../../rules/axes/up-axis-flip.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let motion = Motion::of(world);
        for clouds in Clouds::all(world) {
            judge_clouds(world, &motion, &clouds, limits, out);
        }
    }
}

fn judge_clouds(world: &World, motion: &Arc<Motion>, clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("up");
    if !clouds.is_of_a_lidar() {
        let why = "nothing says that these are the points of a lidar as it measured them";
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let ups: Vec<Up> = clouds.evidence.samples.iter().filter_map(|sample| up(sample, limits)).collect();
    let count = |axis: usize| ups.iter().filter(|up| up.axis == axis).count();
    let most = (0..AXES.len()).max_by_key(|axis| (count(*axis), AXES.len() - axis)).unwrap_or(0);
    let of_most = || ups.iter().filter(|up| up.axis == most);
    if count(most) < limits.min_clouds || (count(most) as f64) < limits.min_agreement * ups.len() as f64 {
        let why = format!(
            "in {} of {} sampled clouds a ground shows, {} of them on one side; {} are needed",
            ups.len(),
            clouds.evidence.samples.len(),
            count(most),
            limits.min_clouds
        );
        return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
    }
    let Some((axis, word)) = AXES.get(most) else { return };
    let axis = Vector3::from(*axis);
    let mount = clouds.frame().and_then(|frame| mount(world, &frame));
    let in_base = mount.as_ref().map_or(axis, |mount| mount.base_from_sensor.rotation * axis);
    let off_deg = in_base.angle(&Vector3::z()).to_degrees();
    let measured = [
        Measured::new("angle from z of the base", off_deg, "deg").limit(limits.max_off_deg),
        Measured::new("cells on the ground, weighed", of_most().map(|up| up.score).fold(f64::INFINITY, f64::min), "1")
            .limit(limits.min_score)
            .samples(count(most) as u64),
        Measured::new("the same of the next axis", of_most().map(|up| up.next).fold(0.0, f64::max), "1"),
    ];
    if off_deg <= limits.max_off_deg {
        return out.pass(subject, measured);
    }
    let is_indoors = of_most().any(|up| up.is_indoors);
    let has_gravity = motion.bags.get(clouds.index).is_some_and(|bag| !bag.imus.is_empty());
    let (relation, what, help) = named(word);
    let told = mount.as_ref().map_or_else(
        || "and nothing ties its frame to a base".to_owned(),
        |mount| format!("`{}_from_{}` turns that {off_deg:.0} deg away from up", mount.base, clouds.frame().map_or_else(String::new, |frame| frame.as_str().to_owned())),
    );
    let message = format!(
        "the ground in the cloud on `{}` lies opposite to its {word}: {what}, {told}",
        clouds.topic.topic
    );
    let finding = if mount.is_some() {
        Finding::error(subject, message, clouds.place())
    } else {
        Finding::warning(subject, message, clouds.place())
    };
    // A ceiling looks like a ground from below, and nothing else says which of the two it is.
    let finding = if mount.is_none() || is_indoors && !has_gravity {
        finding.hint()
    } else {
        finding.likely()
    };
    let finding = finding.relation(relation).help(help);
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

/// What a cloud with this axis up may be.
fn named(axis: &str) -> (&'static str, &'static str, &'static str) {
    match axis {
        "z" => (
            "mount",
            "the cloud itself has z up",
            "the transform of the mounting is turned: a driver that corrects a sensor on its head needs a mounting without that turn",
        ),
        "-z" => (
            "x180",
            "z points down",
            "give the mounting of a sensor that hangs on its head in TF, or let its driver correct it; not both",
        ),
        "-y" => (
            "optical",
            "y points down, as in optical axes",
            "convert the cloud to x forward, y left, z up, or give the frame the rotation RPY(-90, 0, -90) deg of an optical frame",
        ),
        "y" => (
            "y-up",
            "y points up, as in graphics",
            "turn the cloud by 90 deg about x: z points up (REP-103)",
        ),
        _ => (
            "on-its-side",
            "x points up or down",
            "compare the mounting with its transform: the sensor lies on its side",
        ),
    }
}

/// The axis that points up in a cloud; `None` where no plane is surely the ground.
fn up(sample: &CloudSample, limits: &Limits) -> Option<Up> {
    let points: Vec<Vector3<f64>> = sample.points.iter().map(|point| Vector3::from(point.xyz)).collect();
    let found = AXES.map(|(axis, _)| support(&points, &Vector3::from(axis), &Options::default()));
    let scores = found.map(|found| found.map_or(0.0, |found| score(&found, limits)));
    let best = (0..AXES.len()).max_by(|a, b| {
        let of = |index: &usize| scores.get(*index).copied().unwrap_or(0.0);
        of(a).total_cmp(&of(b)).then(b.cmp(a))
    })?;
    let ground = (*found.get(best)?)?;
    let best_score = *scores.get(best)?;
    let next = scores
        .iter()
        .enumerate()
        .filter(|(index, _)| *index != best)
        .map(|(_, score)| *score)
        .fold(0.0, f64::max);
    let is_ground = ground.on >= limits.min_on
        && ground.above >= limits.min_above
        && ground.height_m >= limits.least_m
        && ground.at_horizon <= limits.max_at_horizon;
    let opposite = found.get(best ^ 1).copied().flatten();
    (is_ground && best_score >= limits.min_score && best_score >= limits.min_ratio * next).then_some(Up {
        axis: best,
        score: best_score,
        next,
        is_indoors: opposite.is_some_and(|opposite| opposite.cells >= limits.ceiling_cells),
    })
}

/// The cells on a plane, less where points lie beneath it.
fn score(found: &Support, limits: &Limits) -> f64 {
    found.cells as f64 * (1.0 - found.below / limits.max_below).max(0.0)
}
