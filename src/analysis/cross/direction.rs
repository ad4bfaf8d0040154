//! Which direction of a mounting transform matches the motions of scans and body.

use nalgebra::Isometry3;
use serde::Deserialize;

use crate::analysis::hand_eye::{HandEye, Pair, half_turn, in_plane};
use crate::analysis::{Estimates, lidar::Clouds, scan_motion::moved::ScanStep};
use crate::math::{circular::difference, stats::median};
use crate::verdict::NotEvaluated;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_way_m: f64,
    pub(crate) min_turn_deg: f64,
    pub(crate) long_s: f64,
    pub(crate) min_pairs: usize,
    pub(crate) max_sigma_m: f64,
    pub(crate) min_apart_m: f64,
    pub(crate) min_apart_deg: f64,
    pub(crate) ratio: f64,
    pub(crate) paired_ratio: f64,
    pub(crate) paired_t: f64,
    pub(crate) min_excess_m: f64,
    pub(crate) max_residual_m: f64,
    pub(crate) within_sigmas: f64,
    pub(crate) apart_sigmas: f64,
    pub(crate) least_yaw_deg: f64,
    pub(crate) least_place_m: f64,
}

/// Hypotheses about the mounting transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    AsPublished,
    Inverse,
    Turned,
    InverseTurned,
}

impl Reading {
    /// Whether it must win against another. The transform as published needs no fault, and is not compared with two faults at once: at a
    /// yaw of 90 deg both together nearly cancel.
    pub(crate) fn is_held_against(self, rival: Self) -> bool {
        self != rival && (self, rival) != (Self::AsPublished, Self::InverseTurned)
    }
}

/// The residuals of a reading for each pair, metres.
pub(crate) struct Residuals {
    pub(crate) reading: Reading,
    pub(crate) all_m: Vec<f64>,
    pub(crate) median_m: f64,
}

impl Residuals {
    pub(crate) fn of(reading: Reading, all_m: Vec<f64>) -> Self {
        let median_m = median(&all_m).unwrap_or(f64::INFINITY);
        Self {
            reading,
            all_m,
            median_m,
        }
    }

    /// Whether another has clearly smaller residuals: by the ratio, or slightly smaller ones on nearly every pair.
    pub(crate) fn is_beaten_by(&self, better: &Self, limits: &Limits) -> bool {
        let by = |ratio: f64| self.median_m >= ratio * better.median_m;
        if by(limits.ratio) && self.median_m - better.median_m >= limits.min_excess_m {
            return true;
        }
        let more: Vec<f64> = self.all_m.iter().zip(&better.all_m).map(|(a, b)| a - b).collect();
        let count = more.len() as f64;
        let mean = more.iter().sum::<f64>() / count;
        let variance = more.iter().map(|more| (more - mean).powi(2)).sum::<f64>() / (count - 1.0);
        by(limits.paired_ratio) && mean >= limits.paired_t * (variance / count).sqrt()
    }
}

/// The residuals of a reading.
pub(crate) fn of(residuals: &[Residuals], reading: Reading) -> Option<&Residuals> {
    residuals.iter().find(|known| known.reading == reading)
}

/// The readings of a mounting compared with the motion.
pub(crate) struct DirectionFit {
    pub(crate) known: HandEye,
    pub(crate) pairs: usize,
    /// The residuals of each reading, the best first.
    pub(crate) residuals: Vec<Residuals>,
    pub(crate) decided: Option<Reading>,
    /// Whether the inverse explains the motion better than the transform as stated, perhaps among others.
    pub(crate) inverse_serves: bool,
}

impl DirectionFit {
    pub(crate) fn of(&self, reading: Reading) -> f64 {
        of(&self.residuals, reading).map_or(f64::NAN, |known| known.median_m)
    }
}

/// The same for another rule, by the limits of this one.
pub(crate) fn direction_fit(world: &Estimates, clouds: &Clouds) -> Option<DirectionFit> {
    look(
        world,
        clouds,
        &world.limits::<crate::analysis::cross::direction::Limits>(),
    )
    .ok()
}

/// What a finding about a missing yaw of a mounting adds where the inverse explains that yaw as well: by the motions, or where they do not
/// decide, by the yaw of the inverse within an error.
pub(crate) fn doubt(
    seen: Option<&DirectionFit>,
    stated: &Isometry3<f64>,
    lacks_rad: f64,
    error_rad: f64,
) -> &'static str {
    let inverse = stated.inverse();
    let has_that_yaw = || difference(lacks_rad, in_plane(&(inverse * inverse)).rotation.angle()).abs() <= error_rad;
    match seen {
        Some(seen) if seen.decided.is_none() && seen.inverse_serves => {
            "; or it is inverted: its inverse matches the motions as well"
        }
        None if has_that_yaw() => "; or it is inverted: its inverse has that yaw",
        _ => "",
    }
}

/// Which reading of a mounting matches the two motions.
pub(crate) fn look(
    world: &Estimates,
    clouds: &Clouds,
    limits: &Limits,
) -> Result<DirectionFit, (NotEvaluated, String)> {
    let turned_deg = |moved: &ScanStep| moved.turned_rad().abs().to_degrees();
    let known = HandEye::of(world, clouds, |steps| {
        steps.chained_to_the_end(|moved| turned_deg(moved) >= limits.min_turn_deg || moved.lasted_s() >= limits.long_s)
    })?;
    let inverse = known.stated.inverse();
    let apart = known.stated.inv_mul(&inverse);
    if apart.translation.vector.norm() < limits.min_apart_m
        && apart.rotation.angle().to_degrees() < limits.min_apart_deg
    {
        let why = format!("`{}_from_{}` and its inverse are nearly equal", known.body, known.lidar);
        return Err((NotEvaluated::NotApplicable, why));
    }
    let is_turned = |pair: &&Pair| pair.size().1.to_degrees() >= limits.min_turn_deg;
    let mut sure: Vec<&Pair> = known
        .pairs
        .iter()
        .filter(|pair| pair.sigma_m <= limits.max_sigma_m && (is_turned(pair) || pair.size().0 >= limits.min_way_m))
        .collect();
    if sure.len() < limits.min_pairs {
        let why = format!(
            "{} pairs of scans moved enough and matched well with {}; {} are needed: record more motion",
            sure.len(),
            known.poses.0,
            limits.min_pairs
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    // On a straight way every lever arm fits: use the pairs that turn, or else those that turn the most.
    sure.sort_by(|a, b| b.size().1.total_cmp(&a.size().1));
    let turned = sure.iter().filter(|pair| is_turned(pair)).count();
    sure.truncate(turned.max(limits.min_pairs));
    let all = |mounting: &Isometry3<f64>| -> Vec<f64> { sure.iter().map(|pair| pair.residual_m(mounting)).collect() };
    let readings = [
        (Reading::AsPublished, known.stated),
        (Reading::Inverse, inverse),
        (Reading::Turned, known.stated * half_turn()),
        (Reading::InverseTurned, inverse * half_turn()),
    ];
    let by_place = placed(world, &known, &readings, limits);
    let mut residuals: Vec<Residuals> = readings
        .iter()
        .map(|(reading, mounting)| Residuals::of(*reading, all(mounting)))
        .collect();
    residuals.sort_by(|a, b| a.median_m.total_cmp(&b.median_m));
    let published = of(&residuals, Reading::AsPublished);
    let by_pairs = residuals.first().zip(published).and_then(|(best, published)| {
        let best = if published.is_beaten_by(best, limits) {
            best
        } else {
            published
        };
        let mut rivals = residuals
            .iter()
            .filter(|rival| best.reading.is_held_against(rival.reading));
        let is_best = rivals.all(|rival| rival.is_beaten_by(best, limits));
        (is_best && best.median_m <= limits.max_residual_m).then_some(best.reading)
    });
    let inverse_serves = of(&residuals, Reading::Inverse)
        .zip(published)
        .is_some_and(|(inverse, published)| {
            inverse.median_m <= limits.max_residual_m && published.is_beaten_by(inverse, limits)
        });
    Ok(DirectionFit {
        inverse_serves,
        pairs: sure.len(),
        residuals,
        decided: match by_place {
            Some(by_place) => by_place.agreed(by_pairs),
            None => by_pairs,
        },
        known,
    })
}

/// What all pairs together determine of the mounting.
pub(crate) struct MountFit {
    /// The readings that are there, within its errors.
    pub(crate) near: Vec<Reading>,
    /// The one of them that all others are far from.
    pub(crate) alone: Option<Reading>,
}

impl MountFit {
    /// The reading that both methods allow. A mounting with another error may still have the right direction.
    pub(crate) fn agreed(&self, by_pairs: Option<Reading>) -> Option<Reading> {
        match (by_pairs, self.alone) {
            (Some(by_pairs), None) => {
                (by_pairs == Reading::AsPublished || self.near.contains(&by_pairs)).then_some(by_pairs)
            }
            (Some(by_pairs), Some(alone)) => (by_pairs == alone).then_some(alone),
            (None, alone) => alone,
        }
    }
}

/// Which readings are where least squares over all pairs put the mounting; `None` where those do not determine it.
pub(crate) fn placed(
    world: &Estimates,
    known: &HandEye,
    readings: &[(Reading, Isometry3<f64>)],
    limits: &Limits,
) -> Option<MountFit> {
    let found =
        crate::analysis::cross::hand_eye::estimated(known, &world.limits::<crate::analysis::cross::hand_eye::Limits>())
            .ok()?;
    let [yaw, x, y] = found.sigma;
    let least_rad = limits.least_yaw_deg.to_radians();
    let sigma = [
        yaw.hypot(least_rad),
        x.hypot(limits.least_place_m),
        y.hypot(limits.least_place_m),
    ];
    let sigmas = |mounting: &Isometry3<f64>| -> f64 {
        let turned = in_plane(&(mounting * known.stated.inverse())).rotation.angle();
        let off = found.place - mounting.translation.vector.xy();
        let off = [difference(found.yaw_rad, turned), off.x, off.y];
        off.iter()
            .zip(sigma)
            .map(|(off, sigma)| (off / sigma).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let off: Vec<(Reading, f64)> = readings
        .iter()
        .map(|(reading, mounting)| (*reading, sigmas(mounting)))
        .collect();
    let is_alone = |(reading, best): &&(Reading, f64)| {
        let mut rivals = off.iter().filter(|(rival, _)| reading.is_held_against(*rival));
        rivals.all(|(_, sigmas)| sigmas.powi(2) - best.powi(2) >= limits.apart_sigmas.powi(2))
    };
    let near = || off.iter().filter(|(_, sigmas)| *sigmas <= limits.within_sigmas);
    Some(MountFit {
        alone: near().find(is_alone).map(|(reading, _)| *reading),
        near: near().map(|(reading, _)| *reading).collect(),
    })
}
