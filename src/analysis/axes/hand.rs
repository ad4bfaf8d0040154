//! Whether two tracks of one drive are mirror images.

use std::sync::Arc;

use crate::analysis::Estimates;
use crate::analysis::axes::handedness::{Limits, Votes};
use crate::analysis::motion::{Stream, Track};
use crate::math::stats::median;
use crate::verdict::Measured;
use crate::world::motion::FixRow;

/// Result of one pair of tracks.
pub(crate) struct Hand {
    /// Whether it is mirrored.
    pub(crate) is_mirrored: bool,
    /// Share of the windows that agree.
    pub(crate) measured: Measured,
}

/// Whether a track is the mirror image of the GNSS track; `None` if there is too little evidence.
pub(crate) fn hand(world: &Estimates, fixes: &Stream<FixRow>, track: &Track, limits: &Limits) -> Option<Hand> {
    let votes = Votes::of(world, &fixes.track(), track, min_minor_m(fixes, limits), limits);
    Some(Hand {
        is_mirrored: votes.majority(limits)?,
        measured: Measured::new("share of the stretches that say the same", votes.agreement(), "1")
            .at_least(limits.min_agreement),
    })
}

/// The track of a receiver with latitude and longitude swapped; `None` if that is no place on the Earth.
pub(crate) fn exchanged_track(fixes: &Stream<FixRow>) -> Option<Arc<Track>> {
    let mut exchanged = fixes.clone();
    for fix in exchanged.stretches.iter_mut().flatten() {
        std::mem::swap(&mut fix.row.latitude_deg, &mut fix.row.longitude_deg);
    }
    let is_place = exchanged.rows().all(|fix| fix.row.latitude_deg.abs() <= 90.0);
    is_place.then(|| exchanged.track())
}

/// Sideways spread that distinguishes odometry from its mirror image under this receiver's noise.
pub(crate) fn min_minor_m(fixes: &Stream<FixRow>, limits: &Limits) -> f64 {
    let sigmas: Vec<f64> = fixes.rows().filter_map(|timed| timed.row.horizontal_sd_m()).collect();
    median(&sigmas).map_or(limits.min_minor_m, |sigma| {
        limits.minor_of_sigma * sigma.max(limits.least_sigma_m)
    })
}
