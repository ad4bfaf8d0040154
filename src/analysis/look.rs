//! A measurement, or why there is none.

use std::sync::Arc;

use crate::analysis::motion::Track;
use crate::verdict::NotEvaluated;

/// A measurement, or why there is none.
pub(crate) type Estimate<T> = Result<T, (NotEvaluated, String)>;

/// Label of the place of a track in a finding.
pub(crate) const TRACK: &str = "compared with this track";

/// The reason, if there are no tracks to compare with.
pub(crate) fn needed(tracks: &[Arc<Track>]) -> Estimate<()> {
    if tracks.is_empty() {
        let why = "no GNSS fixes, odometry or poses to compare with".to_owned();
        return Err((NotEvaluated::MissingInput, why));
    }
    Ok(())
}
