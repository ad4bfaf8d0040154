//! Yaw error of a lidar's mounting.

use nalgebra::Vector2;
use serde::Deserialize;

use crate::analysis::hand_eye::{HandEye, in_plane};
use crate::analysis::{
    Estimates,
    estimates::{InputHasher, hash_numbers},
    lidar::Clouds,
    motion::Motion,
    scan_motion::LevelClouds,
};
use crate::math::circular::{circular_mean, difference};
use crate::math::yaw_search::{Pair, YawCosts, search};
use crate::verdict::{Measured, NotEvaluated};

/// Distance between two scans of the search, metres: more than the spacing of their points.
const SEARCH_WAY_M: f64 = 1.5;
/// Pairs of scans for the search: enough to leave out a tenth and estimate the error.
const SEARCH_PAIRS: usize = 20;
/// Yaws further apart than this are different ones, degrees.
const SEARCH_APART_DEG: f64 = 15.0;
/// Standard errors between the best yaw and another: for the best of 180 yaws, with a margin for pairs at the same place.
const SEARCH_T: f64 = 6.0;

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

/// The yaw between the directions of motion by the scans and by the poses.
pub(crate) struct Yaw {
    /// What the mounting lacks, degrees.
    pub(crate) off_deg: f64,
    /// Standard error of that, degrees.
    pub(crate) error_deg: f64,
    pub(crate) sure: YawCertainty,
    pub(crate) pairs: usize,
}

/// How certain it is that there is one yaw.
pub(crate) enum YawCertainty {
    /// The directions of all pairs: the length of their mean.
    Resultant(f64),
    /// All scans together, which coincide at this yaw alone: margin to any other yaw, in standard errors.
    Search(f64),
}

impl Yaw {
    /// Number of 90-degree turns, if it is near one; 0 if the mounting is right.
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
            Measured::new("yaw missing in the mounting", self.off_deg, "deg")
                .turn()
                .limit(limits.pass_deg)
                .spread(self.error_deg)
                .samples(self.pairs as u64),
            match self.sure {
                YawCertainty::Resultant(resultant) => {
                    Measured::new("agreement of the directions", resultant, "1").at_least(limits.min_resultant)
                }
                YawCertainty::Search(t) => {
                    Measured::new("standard errors between this yaw and the next", t, "1").at_least(SEARCH_T)
                }
            },
        ]
    }
}

/// The yaw that the mounting of a lidar lacks, and the pairs of motions it is estimated from.
pub(crate) fn look(
    world: &Estimates,
    clouds: &Clouds,
    limits: &Limits,
) -> Result<(Yaw, HandEye), (NotEvaluated, String)> {
    let known = HandEye::of(world, clouds, |steps| {
        steps.chained(|moved| moved.way_m() >= limits.min_way_m)
    })?;
    let yaw = yaw(&known, limits).or_else(|(reason, why)| {
        searched(world, clouds, &known, limits).map_err(|found| (reason, format!("{why}; {found}")))
    })?;
    Ok((yaw, known))
}

/// The yaw at which all scans together coincide, if too few could be matched one by one; or why there is none.
fn searched(world: &Estimates, clouds: &Clouds, known: &HandEye, limits: &Limits) -> Result<Yaw, String> {
    let standing = LevelClouds::of(world, clouds).ok_or("no visible ground shows which way is up")?;
    let motion = Motion::of(world);
    let body_at = known.body_at(world, &motion, clouds);
    let mut pairs = Vec::new();
    for run in &standing.runs {
        let mut clouds = run
            .iter()
            .filter_map(|(moment, points)| Some((body_at(moment)?, points)));
        let Some(mut from) = clouds.next() else { continue };
        for to in clouds {
            let body = in_plane(&from.0.inv_mul(&to.0));
            if body.translation.vector.norm() >= SEARCH_WAY_M {
                pairs.push(Pair {
                    body,
                    from: from.1.clone(),
                    to: to.1.clone(),
                });
                from = to;
            }
        }
    }
    pairs.retain(|pair: &Pair| !pair.from.is_empty() && !pair.to.is_empty());
    let stated = known.stated * standing.up_from_cloud.inverse();
    let is_enough = pairs.len() >= SEARCH_PAIRS;
    let stated = in_plane(&stated);
    let place = stated.translation.vector;
    let found = is_enough.then(|| {
        let costs = world.shared(|hasher| hash(&pairs, place, hasher), || YawCosts::of(&pairs, place));
        search(&costs, SEARCH_APART_DEG.to_radians())
    });
    let Some(found) = found.flatten() else {
        return Err(format!(
            "only {} pairs of scans that are {} m apart show objects above the ground, {} are needed to match all of them together",
            pairs.len(),
            SEARCH_WAY_M,
            SEARCH_PAIRS
        ));
    };
    let error_deg = found.sigma_rad.to_degrees();
    if found.t < SEARCH_T || error_deg > limits.max_error_deg {
        return Err(format!(
            "all {} matched together leave another yaw {:.1} standard errors from the best ({} are needed), which is known to \
             {error_deg:.1} deg ({} are needed): record {} times as many, or a place with more objects above the ground",
            found.pairs,
            found.t,
            SEARCH_T,
            limits.max_error_deg,
            more(found.t, error_deg, limits)
        ));
    }
    Ok(Yaw {
        off_deg: difference(found.yaw_rad, stated.rotation.angle()).to_degrees(),
        error_deg,
        sure: YawCertainty::Search(found.t),
        pairs: found.pairs,
    })
}

/// Everything that the costs of yaws depend on.
fn hash(pairs: &[Pair], place: Vector2<f64>, hasher: &mut InputHasher) {
    hash_numbers(hasher, place.iter().copied());
    for pair in pairs {
        hash_numbers(hasher, pair.body.to_homogeneous().iter().copied());
        for points in [&pair.from, &pair.to] {
            hash_numbers(hasher, [points.len() as f64]);
            hash_numbers(hasher, points.iter().flat_map(|point| [point.x, point.y]));
        }
    }
}

/// Factor of pairs that is needed: errors fall with the square root of their number.
fn more(t: f64, error_deg: f64, limits: &Limits) -> f64 {
    let times = (SEARCH_T / t.max(0.5)).max(error_deg / limits.max_error_deg);
    times.powi(2).ceil()
}

pub(crate) fn yaw(known: &HandEye, limits: &Limits) -> Result<Yaw, (NotEvaluated, String)> {
    let little = |why: String| (NotEvaluated::TooLittleEvidence, why);
    let straight = known.pairs.iter().filter(|pair| {
        let (way_m, turned_rad) = pair.size();
        way_m >= limits.min_way_m
            && turned_rad.to_degrees() <= limits.max_turn_deg
            && pair.sigma_m <= limits.max_sigma * way_m
    });
    let lever = known.stated.translation.vector;
    let off: Vec<(f64, f64)> = straight
        .filter_map(|pair| {
            let by_poses = pair.body.translation.vector + pair.body.rotation * lever - lever;
            let by_scans = known.stated.rotation * pair.lidar.translation.vector;
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
            "only {} pairs of scans are {} m apart, straight enough and well matched, {} are needed",
            off.len(),
            limits.min_way_m,
            limits.min_pairs
        )));
    }
    let mean = circular_mean(off.iter().map(|(off, _)| (*off, 1.0)));
    // If all turn to one side, a clock offset looks like a yaw.
    let turning = off.iter().map(|(_, rate)| rate).sum::<f64>() / off.len() as f64;
    let late_deg = (turning * known.late.unsure_s).abs().to_degrees();
    let found = mean.map(|mean| Yaw {
        off_deg: mean.mean_rad.to_degrees(),
        error_deg: (mean.sd_rad() / (off.len() as f64).sqrt()).to_degrees().hypot(late_deg),
        sure: YawCertainty::Resultant(mean.resultant),
        pairs: off.len(),
    });
    let is_steady = mean.is_some_and(|mean| mean.resultant >= limits.min_resultant);
    found
        .filter(|yaw| is_steady && yaw.error_deg <= limits.max_error_deg)
        .ok_or_else(|| {
            little("the angle between the directions of motion by the scans and by the poses is not steady".to_owned())
        })
}
