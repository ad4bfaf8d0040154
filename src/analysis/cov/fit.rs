//! The variances that a stream of poses states, compared with the noise that it shows, for several readings of the variances.
//!
//! Must not judge. Shared by COV02 (the order of the blocks) and COV05 (units): each reports its own readings.

use crate::analysis::cov::noise::{Noise, Variances};
use crate::analysis::{cov::declared::StreamCovariance, motion::Stream};
use crate::math::noise::DEG2_PER_RAD2;
use crate::world::motion::PoseRow;

/// What the stated variances may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    /// m² of x, y, z, then rad² about them.
    AsPublished,
    /// Rotations first.
    RotationFirst,
    /// Rotations in degrees squared.
    Degrees,
    /// Positions in square centimetres.
    Centimetres,
    /// Positions in square millimetres.
    Millimetres,
    /// Deviations.
    Deviations,
}

const READINGS: [Reading; 6] = [
    Reading::AsPublished,
    Reading::RotationFirst,
    Reading::Degrees,
    Reading::Centimetres,
    Reading::Millimetres,
    Reading::Deviations,
];

impl Reading {
    /// The stated variances in m² and rad².
    fn variances(self, stated: Variances) -> Variances {
        let scaled = |linear: f64, angular: f64| Variances {
            horizontal: stated.horizontal / linear,
            vertical: stated.vertical / linear,
            tilt: stated.tilt / angular,
            yaw: stated.yaw / angular,
        };
        match self {
            Self::AsPublished => stated,
            Self::RotationFirst => Variances {
                horizontal: stated.tilt,
                vertical: stated.yaw,
                tilt: stated.horizontal,
                yaw: stated.vertical,
            },
            Self::Degrees => scaled(1.0, DEG2_PER_RAD2),
            Self::Centimetres => scaled(1e4, 1.0),
            Self::Millimetres => scaled(1e6, 1.0),
            Self::Deviations => Variances {
                horizontal: stated.horizontal * stated.horizontal,
                vertical: stated.vertical * stated.vertical,
                tilt: stated.tilt * stated.tilt,
                yaw: stated.yaw * stated.yaw,
            },
        }
    }
}

/// Each variance stated with the one shown, where there is any: heights on flat ground have none.
fn pairs(stated: Variances, shown: Variances) -> impl Iterator<Item = (f64, f64)> {
    [
        (stated.horizontal, shown.horizontal),
        (stated.vertical, shown.vertical),
        (stated.tilt, shown.tilt),
        (stated.yaw, shown.yaw),
    ]
    .into_iter()
    .filter(|(_, shown)| *shown > NOTHING)
}

/// How near the readings are to the noise.
pub(crate) struct Fit {
    /// Each with the largest factor between a variance and the noise; the best first.
    pub(crate) readings: Vec<(Reading, f64)>,
    /// Poses behind it.
    pub(crate) poses: u64,
    /// Mean log-likelihood ratio per pose of rotations first over positions first.
    pub(crate) order_ratio: f64,
}

impl Fit {
    /// Of a stream, or why there is none.
    pub(crate) fn of(
        stream: &Stream<PoseRow>,
        declared: &StreamCovariance<'_>,
        min_poses: f64,
    ) -> Result<Self, String> {
        if declared.samples.is_empty() {
            return Err("every covariance is all zeros, or not finite".to_owned());
        }
        if declared.is_constant() {
            return Err("one constant matrix in all messages: hard-coded numbers do not describe the noise".to_owned());
        }
        let noise = Noise::of(stream, declared.topic);
        if (noise.count() as f64) < min_poses {
            return Err(format!("{} evenly spaced poses, {min_poses} are needed", noise.count()));
        }
        let (Some(shown), Some(stated)) = (noise.variances(), declared.variances()) else {
            return Err("the poses show no noise".to_owned());
        };
        if shown.horizontal <= NOTHING || shown.tilt.max(shown.yaw) <= NOTHING {
            return Err("the poses show no noise in x, y and an angle: a filtered estimate".to_owned());
        }
        let readings = READINGS.map(|reading| (reading, miss(reading.variances(stated), shown)));
        let mut readings = readings.to_vec();
        readings.sort_by(|a, b| a.1.total_cmp(&b.1));
        let likelihood = |reading: Reading| -> f64 {
            pairs(reading.variances(stated), shown)
                .map(|(stated, shown)| -0.5 * (stated.ln() + shown / stated))
                .sum()
        };
        Ok(Self {
            readings,
            poses: noise.count() as u64,
            order_ratio: likelihood(Reading::RotationFirst) - likelihood(Reading::AsPublished),
        })
    }

    /// The largest factor between a reading and the noise.
    pub(crate) fn miss(&self, reading: Reading) -> f64 {
        let found = self.readings.iter().find(|known| known.0 == reading);
        found.map_or(f64::INFINITY, |found| found.1)
    }

    /// The best reading, where it is within this factor and every other is off by so many times more.
    pub(crate) fn best(&self, fits: f64, margin: f64) -> Option<Reading> {
        let (best, second) = (self.readings.first()?, self.readings.get(1)?);
        (best.1 <= fits && second.1 >= margin * best.1).then_some(best.0)
    }
}

/// Variances below this are rounding, m² or rad².
const NOTHING: f64 = 1e-14;

/// The largest factor between what is stated and what is shown; infinite where a noisy axis is stated as exact.
fn miss(stated: Variances, shown: Variances) -> f64 {
    let factors = pairs(stated, shown).map(|(stated, shown)| {
        let ratio = stated / shown;
        if ratio > 0.0 {
            ratio.ln().abs().exp()
        } else {
            f64::INFINITY
        }
    });
    factors.fold(1.0, f64::max)
}
