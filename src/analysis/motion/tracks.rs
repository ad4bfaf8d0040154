//! The streams that say where a platform went, in the order in which they are asked.
//!
//! Owns how many are asked, and says where some were not.

use std::sync::Arc;

use crate::analysis::motion::{Stream, Track};
use crate::world::motion::{FixRow, PoseRow};

/// So many receivers, and so many streams of poses, say where a platform went; a recording of more is of a fleet.
const MOST: usize = 16;

/// Where a platform went.
pub(crate) struct Tracks {
    /// By satellite receivers, then by poses.
    pub(crate) asked: Vec<Arc<Track>>,
    /// Of how many streams.
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

    /// Why none of them tells, and how many were not asked.
    pub(crate) fn why(&self, reason: impl Into<String>) -> String {
        let (reason, asked) = (reason.into(), self.asked.len());
        if asked < self.streams {
            format!(
                "{reason}; of {} streams that show where it went, {asked} were asked",
                self.streams
            )
        } else {
            reason
        }
    }
}
