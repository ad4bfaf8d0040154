//! Frame names of the headers of a topic.

use std::collections::BTreeMap;

use crate::world::FrameId;
use crate::world::bag::HeaderFrame;

use super::point::{Point, PointOwner};
use super::thin::SampleBudget;

/// Frame names with their count and first message, bounded.
pub(super) struct Names {
    bound: usize,
    /// Count and first message by name as spelled.
    pub(super) known: BTreeMap<String, (u64, Point)>,
    /// Messages whose name is beyond the bound.
    pub(super) refused: u64,
}

impl Names {
    pub(super) fn new(share: SampleBudget) -> Self {
        Self {
            bound: share.names,
            known: BTreeMap::new(),
            refused: 0,
        }
    }

    pub(super) fn add(&mut self, name: &str, point: Point) {
        if let Some((count, _)) = self.known.get_mut(name) {
            *count += 1;
        } else if self.known.len() < self.bound {
            self.known.insert(name.to_owned(), (1, point));
        } else {
            self.refused += 1;
        }
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> BTreeMap<FrameId, HeaderFrame> {
        let of = |(name, (count, first)): (String, (u64, Point))| {
            let first = first.on(on);
            (FrameId::new(name), HeaderFrame { count, first })
        };
        self.known.into_iter().map(of).collect()
    }
}
