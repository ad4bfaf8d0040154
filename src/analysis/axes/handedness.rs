//! Two tracks of one platform, fitted to each other rotated and mirrored, window by window.
//!
//! Must not judge.

use std::hash::Hasher;
use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use serde::Deserialize;

use crate::analysis::estimates::{Estimates, InputHasher, hash_numbers};
use crate::analysis::motion::Track;
use crate::math::drifting::{aligned_drifting, fit_drifting};
use crate::math::similarity2::{path_length, spread};
use crate::math::stats::{mad, median};

/// Interval between two evaluations of a growing window, seconds.
const LOOK_EVERY_S: f64 = 1.0;

/// Votes of the windows.
#[derive(Debug, Default)]
pub(crate) struct Votes {
    /// Windows in which the odometry turned enough.
    pub(crate) windows: usize,
    /// Votes for rotated, and for mirrored.
    pub(crate) says: [usize; 2],
    /// Root mean squares of the rotated and of the mirrored fit in the windows that voted: the medians, metres.
    pub(crate) rms_m: [f64; 2],
    /// Longest distance in a window, metres.
    pub(crate) longest_m: f64,
    /// Largest standard deviation of the odometry across its main direction in any window, metres.
    pub(crate) widest_m: f64,
    /// Residual of the better fit in each window over the extent of the GNSS track: 0 fits, 1 means nothing.
    remains: Vec<f64>,
    /// The same of the windows that voted.
    voted_remains: Vec<f64>,
    /// Metres of the GNSS track for a metre of odometry, in the windows that voted.
    scales: Vec<f64>,
    /// Start and end of the windows that voted, seconds after the recording's start.
    voted_s: Vec<(f64, f64)>,
}

/// Root mean squares of the rotated and mirrored fits in the windows that voted, metres.
type Fits = [Vec<f64>; 2];

/// Positions of the odometry, and of the GNSS track.
type Places = (Vec<Vector2<f64>>, Vec<Vector2<f64>>);

/// One position by both tracks.
struct PositionPair {
    t_s: f64,
    odometry: Vector2<f64>,
    satellites: Vector2<f64>,
}

impl Votes {
    /// Fits the odometry to the GNSS track; `min_minor_m` is its minimum spread across its main direction.
    pub(crate) fn of(
        world: &Estimates,
        satellites: &Track,
        odometry: &Track,
        min_minor_m: f64,
        limits: &Limits,
    ) -> Arc<Self> {
        let numbers = |hasher: &mut InputHasher| {
            hasher.write(format!("{limits:?}").as_bytes());
            hash_numbers(hasher, [min_minor_m]);
            for track in [satellites, odometry] {
                hasher.write_usize(track.stretches.len());
                for stretch in &track.stretches {
                    hasher.write_usize(stretch.len());
                    hash_numbers(hasher, stretch.iter().flat_map(|(t_s, place)| [*t_s, place.x, place.y]));
                }
            }
        };
        world.shared(numbers, || Self::counted(satellites, odometry, min_minor_m, limits))
    }

    fn counted(satellites: &Track, odometry: &Track, min_minor_m: f64, limits: &Limits) -> Self {
        let mut found = Self::default();
        let mut rms = Fits::default();
        let mut at = odometry.follow();
        for stretch in &satellites.stretches {
            let mut window: Vec<PositionPair> = Vec::new();
            // Evaluated at intervals, or the cost would grow with the square of its length.
            let mut next_s = limits.window_s;
            for (t_s, satellite) in stretch {
                let Some(place) = at(*t_s) else {
                    window.clear();
                    next_s = limits.window_s;
                    continue;
                };
                window.push(PositionPair {
                    t_s: *t_s,
                    odometry: place.xy(),
                    satellites: Vector3::xy(satellite),
                });
                let lasts = window.first().map_or(0.0, |first| t_s - first.t_s);
                if lasts < next_s && lasts < limits.longest_window_s {
                    continue;
                }
                next_s = lasts + LOOK_EVERY_S;
                let voted = found.look(&window, min_minor_m, &mut rms, limits);
                if voted || lasts >= limits.longest_window_s {
                    window.clear();
                    next_s = limits.window_s;
                }
            }
            found.look(&window, min_minor_m, &mut rms, limits);
        }
        found.rms_m = rms.map(|values| median(&values).unwrap_or(f64::NAN));
        found
    }

    /// The times of each window that voted, seconds, and the positions of odometry and GNSS at them, metres in their own frames.
    fn voted(&self, satellites: &Track, odometry: &Track) -> impl Iterator<Item = (Vec<f64>, Places)> {
        let mut at = odometry.follow();
        self.voted_s.iter().map(move |(from_s, to_s)| {
            let places = satellites.stretches.iter().flatten();
            let both = places
                .filter(|(t_s, _)| (*from_s..=*to_s).contains(t_s))
                .filter_map(|(t_s, place)| Some((*t_s, (at(*t_s)?.xy(), place.xy()))));
            both.unzip()
        })
    }

    /// Root mean square of the better fit of two other tracks in the windows that voted: the median, metres.
    pub(crate) fn better_m(&self, satellites: &Track, odometry: &Track, limits: &Limits) -> Option<f64> {
        let mut better = Vec::new();
        for (times, (of_odometry, of_satellites)) in self.voted(satellites, odometry) {
            let fits = fit_drifting(&times, &of_odometry, &of_satellites, limits.drift_deg_s.to_radians())?;
            better.push(fits.proper.rms_m.min(fits.improper.rms_m));
        }
        median(&better)
    }

    /// The GNSS track, and the odometry fitted to it rotated and mirrored, in each window that voted: east and north, metres.
    pub(crate) fn aligned_over(
        &self,
        satellites: &Track,
        odometry: &Track,
        limits: &Limits,
    ) -> [Vec<Vec<[f64; 2]>>; 3] {
        let mut aligned: [Vec<Vec<[f64; 2]>>; 3] = Default::default();
        for (times, (of_odometry, of_satellites)) in self.voted(satellites, odometry) {
            let most_rad_s = limits.drift_deg_s.to_radians();
            let Some([turned, mirrored]) = aligned_drifting(&times, &of_odometry, &of_satellites, most_rad_s) else {
                continue;
            };
            for (lines, track) in aligned.iter_mut().zip([of_satellites, turned, mirrored]) {
                lines.push(track.iter().map(|place| [place.x, place.y]).collect());
            }
        }
        aligned
    }

    /// First and last time that voted, seconds after the recording's start; zeros where none did.
    pub(crate) fn span_s(&self) -> (f64, f64) {
        let ends = self.voted_s.first().zip(self.voted_s.last());
        ends.map_or((0.0, 0.0), |((from_s, _), (_, to_s))| (*from_s, *to_s))
    }

    /// Share of the votes for the majority.
    pub(crate) fn agreement(&self) -> f64 {
        let [turned, mirrored] = self.says;
        turned.max(mirrored) as f64 / (turned + mirrored).max(1) as f64
    }

    /// Whether the odometry is mirrored, if enough windows agree.
    pub(crate) fn majority(&self, limits: &Limits) -> Option<bool> {
        let [turned, mirrored] = self.says;
        (turned + mirrored > 0 && 2.0 * self.agreement() - 1.0 >= limits.min_agreement).then_some(mirrored > turned)
    }

    /// Median residual of the better fit over the extent of the GNSS track, if it is too large for a mirror image.
    pub(crate) fn loosely(&self, limits: &Limits) -> Option<f64> {
        median(&self.voted_remains).filter(|remains| *remains > limits.mirror_leaves)
    }

    /// Metres of the GNSS track for a metre of odometry, and the standard error: the scatter of the windows, at least their residual over the
    /// extent of the track. `None` where none voted.
    pub(crate) fn scale(&self) -> Option<(f64, f64)> {
        let (scale, remains) = (median(&self.scales)?, median(&self.voted_remains)?);
        Some((scale, mad(&self.scales)?.max(remains * scale)))
    }

    /// Lowest residual over the extent of the GNSS track, if there are enough windows and none is explained.
    pub(crate) fn unexplained(&self, limits: &Limits) -> Option<f64> {
        let least = self.remains.iter().copied().fold(f64::INFINITY, f64::min);
        (self.remains.len() >= limits.unexplained_windows && least >= limits.unexplained).then_some(least)
    }

    /// Whether the window spreads enough; counts its vote.
    fn look(&mut self, window: &[PositionPair], min_minor_m: f64, rms: &mut Fits, limits: &Limits) -> bool {
        let odometry: Vec<_> = window.iter().map(|both| both.odometry).collect();
        let satellites: Vec<_> = window.iter().map(|both| both.satellites).collect();
        let times: Vec<_> = window.iter().map(|both| both.t_s).collect();
        let way_m = path_length(&odometry);
        let (Some(first), Some(last), Some(by_satellites), Some(spread)) =
            (times.first(), times.last(), spread(&satellites), spread(&odometry))
        else {
            return false;
        };
        self.longest_m = self.longest_m.max(way_m);
        self.widest_m = self.widest_m.max(spread.minor_sd_m);
        let is_wide = |minor_m: f64| minor_m >= min_minor_m;
        if !is_wide(spread.minor_sd_m) || !is_wide(by_satellites.minor_sd_m) || window.len() < limits.min_points {
            return false;
        }
        // Heading drift bends a straight track as that of a mirror image may be bent.
        let Some(fits) = fit_drifting(&times, &odometry, &satellites, limits.drift_deg_s.to_radians()) else {
            return false;
        };
        self.windows += 1;
        let (turned, mirrored) = (fits.proper.rms_m, fits.improper.rms_m);
        let (best, other) = (turned.min(mirrored), turned.max(mirrored));
        let remains = best / by_satellites.major_sd_m.hypot(by_satellites.minor_sd_m);
        self.remains.push(remains);
        if best <= limits.max_residual * way_m && other >= limits.min_ratio * best {
            let [for_turned, for_mirrored] = &mut self.says;
            *(if turned < mirrored { for_turned } else { for_mirrored }) += 1;
            let [of_turned, of_mirrored] = rms;
            of_turned.push(turned);
            of_mirrored.push(mirrored);
            self.voted_s.push((*first, *last));
            self.voted_remains.push(remains);
            let better = if turned < mirrored { fits.proper } else { fits.improper };
            self.scales.push(better.scale);
        }
        true
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) window_s: f64,
    pub(crate) longest_window_s: f64,
    pub(crate) min_points: usize,
    pub(crate) min_minor_m: f64,
    pub(crate) minor_of_sigma: f64,
    pub(crate) least_sigma_m: f64,
    pub(crate) min_ratio: f64,
    pub(crate) max_residual: f64,
    pub(crate) min_agreement: f64,
    pub(crate) drift_deg_s: f64,
    pub(crate) unexplained: f64,
    pub(crate) mirror_leaves: f64,
    pub(crate) unexplained_windows: usize,
    pub(crate) max_scale: f64,
    pub(crate) sigmas: f64,
}
