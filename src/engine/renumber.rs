//! Converts source ids of a part of a run to those of the whole run.

use std::sync::Arc;

use crate::source::{Place, Source, SourceId};
use crate::verdict::Verdict;

/// The first id that is shifted, and by how much.
#[derive(Clone, Copy)]
pub(super) struct IdShift {
    from: u32,
    by: u32,
}

impl IdShift {
    /// Ids from `from` on are shifted to begin at `at`.
    pub(super) fn behind(from: usize, at: usize) -> Self {
        let whole = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        Self {
            from: whole(from),
            by: whole(at.saturating_sub(from)),
        }
    }

    /// Whether every source keeps its id.
    pub(super) fn is_none(self) -> bool {
        self.by == 0
    }

    fn id(self, id: &mut SourceId) {
        if id.0 >= self.from {
            id.0 = id.0.saturating_add(self.by);
        }
    }

    /// A place.
    pub(super) fn place(self, place: &mut Place) {
        self.id(&mut place.source);
    }

    /// Sources, and a verdict about them.
    pub(super) fn all(self, sources: &mut [Arc<Source>], verdict: &mut Verdict) {
        for source in sources.iter_mut().map(Arc::make_mut) {
            self.id(&mut source.id);
            source
                .problems
                .iter_mut()
                .for_each(|problem| self.place(&mut problem.place));
        }
        for finding in verdict.findings.iter_mut().chain(&mut verdict.explained) {
            finding.places.iter_mut().for_each(|label| self.place(&mut label.place));
            let edits = finding.fix.iter_mut().flat_map(|fix| &mut fix.edits);
            edits.for_each(|edit| self.place(&mut edit.place));
        }
    }
}
