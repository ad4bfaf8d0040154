//! What the mounting of a lidar lacks in yaw.

use serde::Deserialize;

use crate::analysis::{Estimates, hand_eye::HandEye, lidar::Clouds};
use crate::math::circular::{circular_mean, difference};
use crate::verdict::{Measured, NotEvaluated};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_way_m: f64,
    pub(crate) max_turn_deg: f64,
    pub(crate) max_sigma: f64,
    pub(crate) min_pairs: usize,
    pub(crate) min_resultant: f64,
    pub(crate) max_error_deg: f64,
    pub(crate) pass_deg: f64,
    pub(crate) error_deg: f64,
    pub(crate) named_deg: f64,
}

/// The yaw between the way of the lidar by its scans and by the poses.
pub(crate) struct Yaw {
    /// What the mounting lacks, degrees.
    pub(crate) off_deg: f64,
    /// Standard error of that, degrees.
    pub(crate) error_deg: f64,
    pub(crate) resultant: f64,
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
pub(crate) fn look(
    world: &Estimates,
    clouds: &Clouds,
    limits: &Limits,
) -> Result<(Yaw, HandEye), (NotEvaluated, String)> {
    let known = HandEye::of(world, clouds, |steps| {
        steps.chained(|moved| moved.way_m() >= limits.min_way_m)
    })?;
    Ok((yaw(&known, limits)?, known))
}

pub(crate) fn yaw(known: &HandEye, limits: &Limits) -> Result<Yaw, (NotEvaluated, String)> {
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
