//! What is seen of something, or why nothing is.

use std::sync::Arc;

use crate::analysis::motion::Track;
use crate::verdict::NotEvaluated;

/// What is seen, or why nothing is.
pub(crate) type Look<T> = Result<T, (NotEvaluated, String)>;

/// What the place of a track is in a finding.
pub(crate) const TRACK: &str = "where it went";

/// The tracks, or why nothing can be held against them.
pub(crate) fn needed(tracks: &[Arc<Track>]) -> Look<()> {
    if tracks.is_empty() {
        let why = "no satellite fixes, odometry or poses show where it went".to_owned();
        return Err((NotEvaluated::MissingInput, why));
    }
    Ok(())
}
