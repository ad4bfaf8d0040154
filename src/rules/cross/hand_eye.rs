//! CROSS05: a mounting against the one that the motions of lidar and platform determine.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;

use crate::math::planar_hand_eye::{Mounted, mounted};
use crate::math::stats::median;
use crate::rules::hand_eye::{HandEye, Pair, in_plane};
use crate::rules::lidar::Clouds;
use crate::rules::time::point_time_sweep::sweeps_the_other_way;
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

/// CROSS05.
pub struct HandEyeCalibration;

/// Limits of CROSS05.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    long_deg: f64,
    long_s: f64,
    max_sigma_m: f64,
    min_turned_deg: f64,
    max_yaw_deg: f64,
    max_place_m: f64,
    systematic_m: f64,
    sigmas: f64,
    sure_yaw_deg: f64,
    sure_place_m: f64,
    max_scale: f64,
    forward_deg: f64,
}

impl Rule for HandEyeCalibration {
    const PAGE: &'static str = include_str!("../../../rules/cross/hand-eye.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "mounting", out);
        for clouds in Clouds::scanners(world) {
            let known = HandEye::of(world, &clouds, |steps| {
                steps.chained_to_the_end(|moved| {
                    moved.turned_rad().abs().to_degrees() >= limits.long_deg || moved.lasted_s() >= limits.long_s
                })
            });
            match known.and_then(|known| Ok((solved(&known, limits)?, known))) {
                Ok((mounted, known)) => judge_mounted(&clouds, &known, &mounted, limits, out),
                Err((reason, why)) => out.not_evaluated(clouds.subject("place of the mounting"), reason, why),
            }
        }
    }
}

/// The pairs that were matched well.
fn sure<'k>(known: &'k HandEye, limits: &Limits) -> impl Iterator<Item = &'k Pair> {
    let max_sigma_m = limits.max_sigma_m;
    known.pairs.iter().filter(move |pair| pair.sigma_m <= max_sigma_m)
}

/// The same as [`estimated`], where it is sure.
fn solved(known: &HandEye, limits: &Limits) -> Result<Mounted, (NotEvaluated, String)> {
    let turned_deg: f64 = sure(known, limits)
        .map(|pair| pair.lidar.rotation.angle().to_degrees())
        .sum();
    if turned_deg < limits.min_turned_deg {
        let why = format!(
            "it turned by {turned_deg:.0} deg in {} pairs of scans: where on the body it is shows in turns alone; {} are needed",
            sure(known, limits).count(),
            limits.min_turned_deg
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    let found = estimated(known, limits)?;
    let [yaw, x, y] = found.sigma;
    if yaw.to_degrees() > limits.sure_yaw_deg || x.hypot(y) > limits.sure_place_m {
        let why = format!(
            "yaw and place are determined to {:.2} deg and {:.2} m; {} and {} are needed",
            yaw.to_degrees(),
            x.hypot(y),
            limits.sure_yaw_deg,
            limits.sure_place_m
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    Ok(found)
}

/// What is left of a mounting that is told, in the plane of the body: its yaw and its place.
pub(crate) fn estimated(known: &HandEye, limits: &Limits) -> Result<Mounted, (NotEvaluated, String)> {
    let little = |why: String| (NotEvaluated::TooLittleEvidence, why);
    let turn = Isometry3::from_parts(nalgebra::Translation3::identity(), known.told.rotation);
    let flat: Vec<_> = sure(known, limits)
        .map(|pair| (in_plane(&pair.body), in_plane(&(turn * pair.lidar * turn.inverse()))))
        .collect();
    let mut found =
        mounted(&flat).ok_or_else(|| little(format!("{} pairs of scans do not determine where it is", flat.len())))?;
    if (found.scale - 1.0).abs() > limits.max_scale {
        return Err(little(format!(
            "{} goes {:.2} m for a metre of the scans: one of them is no measure for the other",
            known.poses.0, found.scale
        )));
    }
    // What all matches have in common no group of them shows.
    let ways: Vec<f64> = flat.iter().map(|(_, lidar)| lidar.translation.vector.norm()).collect();
    let way_m = median(&ways).unwrap_or_default();
    let [yaw, ..] = &mut found.sigma;
    *yaw = yaw.hypot(limits.systematic_m.atan2(way_m));
    Ok(found)
}

/// The mounting with the yaw and the place that the scans show, and the rest as it is told.
fn at_place(known: &HandEye, found: &Mounted) -> Isometry3<f64> {
    let place = Translation3::new(found.place.x, found.place.y, known.told.translation.z);
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), found.yaw_rad);
    Isometry3::from_parts(place, yaw * known.told.rotation)
}

fn judge_mounted(clouds: &Clouds, known: &HandEye, found: &Mounted, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("place of the mounting");
    let told = known.told.translation.vector.xy();
    let off = found.place - told;
    let [sigma_yaw, sigma_x, sigma_y] = found.sigma;
    let (yaw_deg, sigma_deg, sigma_m) = (
        found.yaw_rad.to_degrees(),
        sigma_yaw.to_degrees(),
        sigma_x.hypot(sigma_y),
    );
    let measured = [
        Measured::new("yaw that the mounting lacks", yaw_deg, "deg")
            .turn()
            .limit(limits.max_yaw_deg)
            .spread(sigma_deg)
            .samples(found.pairs as u64),
        Measured::new("distance of its place from where it is told", off.norm(), "m")
            .limit(limits.max_place_m)
            .spread(sigma_m),
    ];
    if yaw_deg.abs() > limits.forward_deg {
        let why = format!("the mounting lacks a yaw of {yaw_deg:.0} deg, which AXES12 judges");
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let turned = yaw_deg.abs() > limits.max_yaw_deg.max(limits.sigmas * sigma_deg);
    let moved = off.norm() > limits.max_place_m.max(limits.sigmas * sigma_m);
    if !turned && !moved {
        let is_sure = |sigmas: f64| sigmas * sigma_deg <= limits.max_yaw_deg && sigmas * sigma_m <= limits.max_place_m;
        let is_within = yaw_deg.abs() <= limits.max_yaw_deg && off.norm() <= limits.max_place_m;
        if is_within && is_sure(1.0) || is_sure(limits.sigmas) {
            return out.pass(subject, measured);
        }
        let why = format!(
            "the mounting is off by {:.1} deg and {:.2} m, give or take {sigma_deg:.1} deg and {sigma_m:.2} m: that says neither",
            yaw_deg.abs(),
            off.norm()
        );
        return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
    }
    if sweeps_the_other_way(clouds) {
        let why = "the times of its points run against its sweep, which TIME07 judges: they do not bring a scan to one moment";
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let what = match (turned, moved) {
        (true, true) => format!("lacks a yaw of {yaw_deg:+.1} deg, and is {:.2} m off", off.norm()),
        (true, false) => format!("lacks a yaw of {yaw_deg:+.1} deg"),
        _ => format!("is {:.2} m off", off.norm()),
    };
    let message = format!(
        "`{}_from_{}` {what}: by the scans on `{}` and {} the lidar is at x {:.2}, y {:.2} m, where {:.2}, {:.2} is told",
        known.body, known.lidar, clouds.topic.topic, known.poses.0, found.place.x, found.place.y, told.x, told.y
    );
    let inverse = known.told.inverse();
    let is_inverse = in_plane(&(inverse * inverse)).rotation.angle().to_degrees().abs() <= limits.forward_deg
        && (found.place - inverse.translation.vector.xy()).norm() <= limits.sure_place_m.max(limits.sigmas * sigma_m);
    let (relation, message) = if is_inverse {
        (
            "inverse",
            format!("{message}: that is where its inverse has it, as if it were told the wrong way round"),
        )
    } else {
        ("moved", message)
    };
    let finding = Finding::warning(subject, message, clouds.place())
        .likely()
        .relation(relation)
        .related(known.poses.1.clone(), "where it went")
        .help("calibrate it anew; what moves in a plane does not determine roll, pitch and height")
        .prefers(known.body.to_string(), known.lidar.to_string(), at_place(known, found));
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}
