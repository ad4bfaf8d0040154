//! The tracks of a platform, in the order in which they are used.
//!
//! Owns how many are used, and reports if some are not.

use std::sync::Arc;

use crate::analysis::motion::{Stream, Track};
use crate::world::motion::{FixRow, PoseRow};

/// Number of receivers, and of streams of poses, that are used; a recording with more is of a fleet.
const MOST: usize = 16;

/// The tracks of a platform.
pub(crate) struct Tracks {
    /// By GNSS receivers, then by poses.
    pub(crate) asked: Vec<Arc<Track>>,
    /// Number of all streams with a track.
    streams: usize,
}

impl Tracks {
    /// The first receivers and the first poses.
    pub(crate) fn of(fixes: &[&Stream<FixRow>], poses: &[&Stream<PoseRow>]) -> Self {
        let by_satellites = fixes.iter().take(MOST).map(|fixes| fixes.track());
        let by_poses = poses.iter().take(MOST).map(|poses| poses.track());
        Self {
            asked: by_satellites.chain(by_poses).collect(),
            streams: fixes.len() + poses.len(),
        }
    }

    /// A reason, with how many streams were not used.
    pub(crate) fn why(&self, reason: impl Into<String>) -> String {
        let (reason, asked) = (reason.into(), self.asked.len());
        if asked < self.streams {
            format!("{reason}; of {} streams with a track, {asked} were used", self.streams)
        } else {
            reason
        }
    }
}
