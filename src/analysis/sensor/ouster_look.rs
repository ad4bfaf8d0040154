//! Which of the two frames of an Ouster its clouds are expressed in.

use std::f64::consts::TAU;

use serde::Deserialize;

use crate::analysis::{lidar::Clouds, ouster::Axes};
use crate::math::circular::{circular_mean, difference};
use crate::verdict::Measured;
use crate::world::cloud::CloudSample;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_clouds: usize,
    pub(crate) min_points: usize,
    pub(crate) min_resultant: f64,
    pub(crate) min_ratio: f64,
    pub(crate) max_off_deg: f64,
    pub(crate) min_turn: f64,
}

/// Azimuth of the first column, in one cloud.
pub(crate) struct FirstAzimuth {
    pub(crate) azimuth_rad: f64,
    pub(crate) resultant: f64,
    pub(crate) other: f64,
}

/// The azimuth of the first column of a topic's clouds.
pub(crate) struct AzimuthFit {
    /// The frame that the clouds are expressed in; `None` where the first column matches neither.
    pub(crate) axes: Option<Axes>,
    pub(crate) azimuth_rad: f64,
    pub(crate) measured: [Measured; 3],
}

/// Which axes the clouds are expressed in, or why that is not determined.
pub(crate) fn look(clouds: &Clouds, limits: &Limits) -> Result<AzimuthFit, String> {
    let firsts: Vec<FirstAzimuth> = clouds
        .evidence
        .samples
        .iter()
        .filter_map(|sample| first(clouds, sample, limits))
        .collect();
    if firsts.len() < limits.min_clouds {
        return Err(format!(
            "in {} of {} sampled clouds the azimuth follows the columns, or the times of a whole turn; {} are needed",
            firsts.len(),
            clouds.evidence.samples.len(),
            limits.min_clouds
        ));
    }
    let mean = circular_mean(firsts.iter().map(|first| (first.azimuth_rad, 1.0)));
    let mean = mean.ok_or("the first columns of the clouds have no common azimuth")?;
    let least = firsts.iter().map(|first| first.resultant).fold(1.0, f64::min);
    let other = firsts.iter().map(|first| first.other).fold(0.0, f64::max);
    let near = |axes: &Axes| difference(mean.mean_rad, axes.azimuth_rad()).abs().to_degrees() <= limits.max_off_deg;
    Ok(AzimuthFit {
        axes: Axes::BOTH.into_iter().find(near),
        azimuth_rad: mean.mean_rad,
        measured: [
            Measured::new("azimuth of the first column", mean.mean_rad.to_degrees(), "deg")
                .samples(firsts.len() as u64),
            Measured::new("fit of a clockwise turn (1: perfect)", least, "1").at_least(limits.min_resultant),
            Measured::new("fit of a counter-clockwise turn (1: perfect)", other, "1"),
        ],
    })
}

pub(crate) fn is_organised(sample: &CloudSample) -> bool {
    let [height, width] = sample.size;
    height > 1 && width > 1
}

/// How far along the turn a point was measured: by its column, or by its time.
pub(crate) fn share(clouds: &Clouds, sample: &CloudSample, index: usize) -> Option<f64> {
    let point = sample.points.get(index)?;
    if is_organised(sample) {
        return Some(f64::from(point.cell[1]) / f64::from(sample.size[1]));
    }
    let (unit_s, _) = clouds.unit(sample.times.as_ref()?)?;
    Some(point.time * unit_s / clouds.period_s()?)
}

/// The azimuth of the first column of a cloud; `None` where it is not determined.
pub(crate) fn first(clouds: &Clouds, sample: &CloudSample, limits: &Limits) -> Option<FirstAzimuth> {
    let is_organised = is_organised(sample);
    let share = |index: usize| share(clouds, sample, index);
    if !is_organised {
        // A part of a turn, or a turn whose first time is not that of its first column, would give a wrong azimuth.
        let times = sample.times.as_ref()?;
        let (unit_s, _) = clouds.unit(times)?;
        let span = (times.range[1] - times.range[0]) * unit_s / clouds.period_s()?;
        if span < limits.min_turn {
            return None;
        }
    }
    let with = |sign: f64| {
        let angles = sample.points.iter().enumerate().filter_map(|(index, point)| {
            let [x, y, _] = point.xyz;
            Some((y.atan2(x) + sign * TAU * share(index)?, 1.0))
        });
        circular_mean(angles)
    };
    let (clockwise, other) = (with(1.0)?, with(-1.0)?);
    let is_clear = sample.points.len() >= limits.min_points
        && clockwise.resultant >= limits.min_resultant
        && clockwise.resultant >= limits.min_ratio * other.resultant;
    is_clear.then_some(FirstAzimuth {
        azimuth_rad: clockwise.mean_rad,
        resultant: clockwise.resultant,
        other: other.resultant,
    })
}
