//! How far odometry drifts from another track of the same platform, between the first and the last third of a drive.
//!
//! Each third is aligned with the other track by a rotation and a translation of its own; the drift is the distance between the
//! two images of the middle of the last third. Must not judge.

use std::sync::Arc;

use nalgebra::{Rotation2, Vector2, Vector3};
use serde::Deserialize;

use crate::analysis::motion::{BagMotion, Stream, Track};
use crate::analysis::names;
use crate::math::similarity2::{fit_similarities, path_length, spread};
use crate::math::stats::median;
use crate::verdict::Measured;
use crate::world::{FrameId, motion::PoseRow};

/// A drift.
pub(crate) struct Drift {
    /// What it was compared with.
    pub(crate) against: String,
    /// Metres.
    pub(crate) by_m: f64,
    /// Its standard deviation, metres.
    pub(crate) sigma_m: f64,
    /// Length of the odometry's path, metres.
    pub(crate) way_m: f64,
    points: usize,
}

impl Drift {
    fn least_m(&self, limits: &Limits) -> f64 {
        limits.drift_m.max(limits.drift_share * self.way_m)
    }

    /// Whether it is one; `None` where it is too uncertain to say.
    pub(crate) fn is_significant(&self, limits: &Limits) -> Option<bool> {
        let (least_m, margin_m) = (self.least_m(limits), limits.margin * self.sigma_m);
        if self.by_m + margin_m <= least_m {
            Some(false)
        } else {
            (self.by_m > limits.sigmas * self.sigma_m && self.by_m - margin_m > least_m).then_some(true)
        }
    }

    pub(crate) fn measured(&self, limits: &Limits) -> [Measured; 2] {
        [
            Measured::new(format!("drift relative to {}", self.against), self.by_m, "m")
                .limit(self.least_m(limits))
                .spread(self.sigma_m)
                .samples(self.points as u64),
            Measured::new("path length of the odometry", self.way_m, "m"),
        ]
    }
}

/// The drift of what moves in `odom` relative to fixes, or poses in `map`: the first that allows a judgement; else why none does.
pub(crate) fn drift(motion: &BagMotion, odom: &FrameId, map: &FrameId, limits: &Limits) -> Result<Drift, String> {
    let in_frame = |frame: &FrameId| {
        let poses = motion
            .poses
            .iter()
            .filter(move |stream| stream.frame.as_ref() == Some(frame));
        let poses: Vec<_> = poses
            .filter(|stream| stream.child.as_ref() != Some(odom) && !names::is_wish(&stream.topic))
            .collect();
        poses
    };
    let odometry: Vec<Arc<Track>> = in_frame(odom).into_iter().map(Stream::<PoseRow>::track).collect();
    let by_poses = in_frame(map)
        .into_iter()
        .map(|stream| (stream.track(), limits.least_sigma_m));
    let fixes = motion.fixes.iter().map(|stream| {
        let sigmas: Vec<f64> = stream.rows().filter_map(|timed| timed.row.horizontal_sd_m()).collect();
        (stream.track(), median(&sigmas).unwrap_or(0.0).max(limits.least_sigma_m))
    });
    let others: Vec<(Arc<Track>, f64)> = by_poses.chain(fixes).collect();
    if others.is_empty() {
        return Err(format!(
            "its drift is unknown without a second source of the position: record GNSS fixes, or a localizer's pose in `{map}`"
        ));
    }
    let pairs = odometry
        .iter()
        .flat_map(|odometry| others.iter().map(move |other| (odometry, other)));
    let mut why = format!("no pose in `{odom}` was recorded to compare with it");
    for (odometry, (other, sigma_m)) in pairs {
        match of(odometry, other, *sigma_m, limits) {
            Ok(drift) => return Ok(drift),
            Err(reason) => why = format!("compared with {}: {reason}", other.subject),
        }
    }
    Err(why)
}

/// A third of both tracks, and the rotation and translation that aligns them.
struct Alignment {
    middle: Vector2<f64>,
    turn: Rotation2<f64>,
    image: Vector2<f64>,
    /// Root mean square of the residual, metres.
    rms_m: f64,
    /// The residual with the scale of the odometry estimated as well: the noise of both.
    noise_m: f64,
    /// Metres of the other track for each metre of the odometry.
    scale: f64,
    /// Standard deviation of the rotation, radians.
    turn_sigma_rad: f64,
}

impl Alignment {
    fn of(both: &[(Vector2<f64>, Vector2<f64>)], sigma_m: f64) -> Option<Self> {
        let (from, to): (Vec<_>, Vec<_>) = both.iter().copied().unzip();
        let count = both.len() as f64;
        let mean = |points: &[Vector2<f64>]| points.iter().sum::<Vector2<f64>>() / count;
        let (middle, image) = (mean(&from), mean(&to));
        // The best rotation is that of the best similarity: it does not depend on the scale.
        let best = fit_similarities(&from, &to)?.proper;
        let turn = Rotation2::new(best.angle_rad);
        let rest = |(from, to): &(Vector2<f64>, Vector2<f64>)| (turn * (from - middle) - (to - image)).norm_squared();
        let rms_m = (both.iter().map(rest).sum::<f64>() / count).sqrt();
        let spread = spread(&from)?;
        // Errors of a receiver last for minutes: more points do not reduce them.
        let noise_m = best.rms_m;
        let turn_sigma_rad = sigma_m.max(noise_m) / spread.major_sd_m.hypot(spread.minor_sd_m);
        let is_finite = rms_m.is_finite() && noise_m.is_finite() && turn_sigma_rad.is_finite();
        is_finite.then_some(Self {
            middle,
            turn,
            image,
            rms_m,
            noise_m,
            scale: best.scale,
            turn_sigma_rad,
        })
    }

    fn apply(&self, point: Vector2<f64>) -> Vector2<f64> {
        self.image + self.turn * (point - self.middle)
    }
}

fn of(odometry: &Track, other: &Track, sigma_m: f64, limits: &Limits) -> Result<Drift, String> {
    let points = other.stretches.iter().flatten();
    let both: Vec<(Vector2<f64>, Vector2<f64>)> = points
        .filter_map(|(t_s, place)| Some((odometry.at(*t_s)?.xy(), Vector3::xy(place))))
        .collect();
    let third = both.len() / 3;
    if third < limits.min_points {
        return Err(format!(
            "{} points in common, {} are needed",
            both.len(),
            3 * limits.min_points
        ));
    }
    let part = |from: usize, to: usize| both.get(from..to).and_then(|part| Alignment::of(part, sigma_m));
    let way_m = path_length(&both.iter().map(|(odometry, _)| *odometry).collect::<Vec<_>>());
    let (Some(first), Some(last)) = (part(0, third), part(both.len() - third, both.len())) else {
        return Err("the vehicle does not move in the first or the last third of the drive".to_owned());
    };
    if first.rms_m.max(last.rms_m) > limits.max_residual * way_m {
        return Err("the odometry does not match it even over a third of the drive".to_owned());
    }
    let strays = |aligned: &Alignment| (aligned.scale - 1.0).abs() > limits.max_scale;
    if let Some(part) = [&first, &last].into_iter().find(|part| strays(part)) {
        return Err(format!(
            "over a third of the drive it is {:.2} times as long as the odometry, so the two do not follow the same path",
            part.scale
        ));
    }
    let by_m = (first.apply(last.middle) - last.image).norm();
    let far_m = (last.middle - first.middle).norm();
    // A wrong scale is part of the drift, and changes neither the rotation nor the middle of a third: it is no noise.
    let sigma_m = (sigma_m.max(first.noise_m))
        .hypot(sigma_m.max(last.noise_m))
        .hypot(first.turn_sigma_rad * far_m);
    Ok(Drift {
        against: other.subject.clone(),
        by_m,
        sigma_m,
        way_m,
        points: both.len(),
    })
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Change of the correction above which it counts as moving, metres.
    pub constant_m: f64,
    /// Change of the correction above which it counts as moving, degrees.
    pub constant_deg: f64,
    /// How long a correction that moved before may stand still beside poses that move away, seconds.
    pub held_s: f64,
    /// How far these may move away, metres.
    pub held_m: f64,
    /// Drift of odometry that needs a correction, metres.
    pub(crate) drift_m: f64,
    /// The same, as a share of the path.
    pub(crate) drift_share: f64,
    /// Smallest standard deviation that is assumed for the other source, metres.
    pub(crate) least_sigma_m: f64,
    /// Deviations that a drift must exceed.
    pub(crate) sigmas: f64,
    /// Deviations between the least drift that counts and one that is reported.
    pub(crate) margin: f64,
    pub(crate) max_scale: f64,
    /// Points of each third.
    pub(crate) min_points: usize,
    /// Residual of a third, over the path length, above which the two tracks are not of one platform.
    pub(crate) max_residual: f64,
}
