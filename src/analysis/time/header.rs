//! The times of a cloud's points relative to the stamp of its header. Must not judge.

use serde::Deserialize;

use crate::analysis::lidar::Clouds;
use crate::tables::TimeOrigin;
use crate::world::cloud::{CloudSample, PointTimes};

/// The limits of TIME08.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_clouds: usize,
    pub(crate) near: f64,
    pub(crate) beside: f64,
    epoch_s: f64,
}

/// From the stamp of the header to the first point of a cloud and to the last, seconds; `None` where unit, period or origin of their
/// times are unknown.
pub(crate) fn points_after_header_s(
    clouds: &Clouds,
    sample: &CloudSample,
    times: &PointTimes,
    limits: &Limits,
) -> Option<[f64; 2]> {
    let (unit_s, _) = clouds.unit(times)?;
    let stamp_ns = sample.at.stamp_ns?;
    let is_absolute = match clouds.driver.and_then(|driver| driver.time.as_ref()) {
        Some(time) => time.counts_from == TimeOrigin::Epoch,
        None => times.range[0] * unit_s >= limits.epoch_s,
    };
    let origin_s = match times.timebase_ns {
        Some(timebase_ns) => (i128::from(timebase_ns) - i128::from(stamp_ns)) as f64 * 1e-9,
        // The difference first: a double does not hold the nanoseconds of a time since 1970.
        None if is_absolute => -(stamp_ns as f64) * 1e-9,
        None => 0.0,
    };
    Some(times.range.map(|time| time * unit_s + origin_s))
}
