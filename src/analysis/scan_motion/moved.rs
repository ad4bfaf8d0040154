//! Times of clouds, and the motion of a lidar between two of them.

use nalgebra::Isometry2;

/// Stamps of one clock differ from log times by less than this, seconds.
const SAME_CLOCK_S: f64 = 1.0;

/// Time of a cloud, nanoseconds after the recording's start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    stamp_ns: Option<i64>,
    log_ns: i64,
}

impl Moment {
    /// Of a message with this stamp, if it has one, and log time.
    pub(crate) fn new(stamp_ns: Option<i64>, log_ns: i64, start_ns: i64) -> Self {
        Self {
            stamp_ns: stamp_ns.map(|stamp_ns| stamp_ns.saturating_sub(start_ns)),
            log_ns: log_ns.saturating_sub(start_ns),
        }
    }

    /// Time since another, seconds: by stamps, if both have them.
    pub(crate) fn since(&self, earlier: &Self) -> f64 {
        seconds(match (self.stamp_ns, earlier.stamp_ns) {
            (Some(to), Some(from)) => to.saturating_sub(from),
            _ => self.log_ns.saturating_sub(earlier.log_ns),
        })
    }

    /// The same time on the clock of a stream with this offset between stamps and log times, seconds after the recording's start.
    pub(crate) fn on(&self, stamp_offset_s: Option<f64>) -> f64 {
        let log_s = seconds(self.log_ns);
        let by_stamps = self
            .stamp_ns
            .zip(stamp_offset_s)
            .map(|(stamp_ns, offset_s)| seconds(stamp_ns) - offset_s);
        by_stamps
            .filter(|t_s| (t_s - log_s).abs() < SAME_CLOCK_S)
            .unwrap_or(log_s)
    }
}

fn seconds(ns: i64) -> f64 {
    ns as f64 * 1e-9
}

/// The motion of a lidar between two of its clouds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScanStep {
    pub(crate) from: Moment,
    pub(crate) to: Moment,
    /// `from_level_from_to_level`: pose of the later sensor in the level axes of the earlier one ([`Steps`](super::Steps)).
    pub(crate) motion: Isometry2<f64>,
    /// Standard errors of the angle and of the place, radians and metres.
    pub(crate) sigma: [f64; 2],
}

impl ScanStep {
    /// Distance, metres.
    pub(crate) fn way_m(&self) -> f64 {
        self.motion.translation.vector.norm()
    }

    /// Rotation about the level z, radians.
    pub(crate) fn turned_rad(&self) -> f64 {
        self.motion.rotation.angle()
    }

    /// Duration, seconds.
    pub(crate) fn lasted_s(&self) -> f64 {
        self.to.since(&self.from)
    }
}
