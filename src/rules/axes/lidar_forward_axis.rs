//! AXES12: where the x axis of a lidar points, by the way it goes.

use serde::Deserialize;

use crate::math::circular::{circular_mean, difference};
use crate::rules::cross::extrinsic_direction::{self, Seen};
use crate::rules::hand_eye::HandEye;
use crate::rules::lidar::Clouds;
use crate::rules::sensor::lidar_turn;
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

/// AXES12.
pub struct LidarForwardAxis;

/// Limits of AXES12.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_way_m: f64,
    max_turn_deg: f64,
    max_sigma: f64,
    min_pairs: usize,
    min_resultant: f64,
    max_error_deg: f64,
    pass_deg: f64,
    error_deg: f64,
    named_deg: f64,
}

/// The yaw between the way of the lidar by its scans and by the poses.
pub(crate) struct Yaw {
    /// What the mounting lacks, degrees.
    pub(crate) off_deg: f64,
    /// Standard error of that, degrees.
    pub(crate) error_deg: f64,
    resultant: f64,
    pub(crate) pairs: usize,
}

impl Yaw {
    /// How many quarter turns it is, where it is near some; 0 where the mounting is right.
    pub(crate) fn quarters(&self, limits: &Limits) -> Option<i8> {
        if self.off_deg.abs() <= limits.pass_deg {
            return Some(0);
        }
        let near = |quarters: &i8| (self.off_deg - 90.0 * f64::from(*quarters)).abs() <= limits.named_deg;
        [-2, -1, 1, 2].into_iter().find(near)
    }

    /// The numbers of a finding or a pass.
    pub(crate) fn measured(&self, limits: &Limits) -> [Measured; 2] {
        [
            Measured::new("yaw that the mounting lacks", self.off_deg, "deg")
                .turn()
                .limit(limits.pass_deg)
                .spread(self.error_deg)
                .samples(self.pairs as u64),
            Measured::new("resultant", self.resultant, "1").limit(limits.min_resultant),
        ]
    }
}

/// What a lidar shows beside the poses: the yaw that its mounting lacks, and the pairs it comes from.
pub(crate) fn look(world: &World, clouds: &Clouds, limits: &Limits) -> Result<(Yaw, HandEye), (NotEvaluated, String)> {
    let known = HandEye::of(world, clouds, |steps| {
        steps.chained(|moved| moved.way_m() >= limits.min_way_m)
    })?;
    Ok((yaw(&known, limits)?, known))
}

impl Rule for LidarForwardAxis {
    const PAGE: &'static str = include_str!("../../../rules/axes/lidar-forward-axis.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "forward", out);
        for clouds in Clouds::scanners(world) {
            match look(world, &clouds, limits) {
                Ok((yaw, known)) => judge_yaw(world, &clouds, &known, &yaw, limits, out),
                Err((reason, why)) => out.not_evaluated(clouds.subject("forward"), reason, why),
            }
        }
    }
}

fn yaw(known: &HandEye, limits: &Limits) -> Result<Yaw, (NotEvaluated, String)> {
    let little = |why: String| (NotEvaluated::TooLittleEvidence, why);
    let straight = known.pairs.iter().filter(|pair| {
        let (way_m, turned_rad) = pair.size();
        way_m >= limits.min_way_m
            && turned_rad.to_degrees() <= limits.max_turn_deg
            && pair.sigma_m <= limits.max_sigma * way_m
    });
    let lever = known.told.translation.vector;
    let off: Vec<(f64, f64)> = straight
        .filter_map(|pair| {
            let by_poses = pair.body.translation.vector + pair.body.rotation * lever - lever;
            let by_scans = known.told.rotation * pair.lidar.translation.vector;
            let stands = by_poses.xy().norm() < 0.5 * limits.min_way_m || by_scans.xy().norm() < 0.5 * limits.min_way_m;
            let rate = pair.body.rotation.scaled_axis().z / pair.lasted_s.max(1e-3);
            (!stands).then(|| {
                (
                    difference(by_poses.y.atan2(by_poses.x), by_scans.y.atan2(by_scans.x)),
                    rate,
                )
            })
        })
        .collect();
    if off.len() < limits.min_pairs {
        return Err(little(format!(
            "{} pairs of scans are {} m apart, straight enough and well matched; {} are needed",
            off.len(),
            limits.min_way_m,
            limits.min_pairs
        )));
    }
    let mean = circular_mean(off.iter().map(|(off, _)| (*off, 1.0)));
    // Where all turn to one side, a moment that is off looks like a yaw.
    let turning = off.iter().map(|(_, rate)| rate).sum::<f64>() / off.len() as f64;
    let late_deg = (turning * known.late.unsure_s).abs().to_degrees();
    let told = mean.map(|mean| Yaw {
        off_deg: mean.mean_rad.to_degrees(),
        error_deg: (mean.sd_rad() / (off.len() as f64).sqrt()).to_degrees().hypot(late_deg),
        resultant: mean.resultant,
        pairs: off.len(),
    });
    told.filter(|yaw| yaw.resultant >= limits.min_resultant && yaw.error_deg <= limits.max_error_deg)
        .ok_or_else(|| {
            little("the way of the scans and that of the poses have no steady angle between them".to_owned())
        })
}

fn judge_yaw(world: &World, clouds: &Clouds, known: &HandEye, yaw: &Yaw, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("forward");
    let measured = yaw.measured(limits);
    if yaw.off_deg.abs() <= limits.pass_deg {
        return out.pass(subject, measured);
    }
    let off_deg = yaw.off_deg.abs();
    if off_deg <= limits.pass_deg + 2.0 * yaw.error_deg {
        let why = format!(
            "the mounting lacks a yaw of {off_deg:.1} deg, give or take {:.1}, and {} are allowed",
            yaw.error_deg, limits.pass_deg
        );
        return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
    }
    let direction = extrinsic_direction::seen(world, clouds);
    if direction.as_ref().is_some_and(Seen::is_inverse) {
        let why = format!("the mounting lacks a yaw of {off_deg:.0} deg, which is part of what CROSS04 reports of it");
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let quarters = yaw.quarters(limits);
    if let Some(owner) = quarters.and_then(|quarters| lidar_turn::owner(world, clouds, known, quarters)) {
        let why = format!("the mounting lacks a yaw of {off_deg:.0} deg: part of what {owner} reports of this sensor");
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let (relation, what) = match quarters {
        Some(1) => (
            "z90",
            "some drivers leave azimuth 0 on y, where others turn it to x: the mounting is for another driver, or for the raw sensor",
        ),
        Some(-1) => (
            "z-90",
            "some drivers leave azimuth 0 on y, where others turn it to x: the mounting is for another driver, or for the raw sensor",
        ),
        Some(2 | -2) => ("z180", "the sensor looks back"),
        _ => ("yaw", "the mounting is turned otherwise than its transform says"),
    };
    let error_rad = (limits.pass_deg + 2.0 * yaw.error_deg).to_radians();
    let or = extrinsic_direction::doubt(direction.as_ref(), &known.told, yaw.off_deg.to_radians(), error_rad);
    let message = format!(
        "`{}_from_{}` lacks a yaw of {:+.1} deg: the scans on `{}` go another way than {}; {what}{or}",
        known.body, known.lidar, yaw.off_deg, clouds.topic.topic, known.poses.0
    );
    let finding = if off_deg > limits.error_deg {
        Finding::error(subject, message, clouds.place())
    } else {
        Finding::warning(subject, message, clouds.place())
    };
    let finding = finding
        .likely()
        .relation(relation)
        .related(known.poses.1.clone(), "where it went")
        .help(format!(
            "turn the mounting by {:+.1} deg about z of `{}`, in front of the rotation that is there",
            yaw.off_deg, known.body
        ));
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}
