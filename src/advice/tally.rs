//! Subjects that pass, in one row for each source: a robot of a hundred joints is one line, not a hundred.

use std::collections::BTreeMap;

use crate::source::SourceId;
use crate::verdict::{Judge, Measured};
use crate::world::World;

/// Counts subjects that pass, by source, and keeps the largest measurement.
#[derive(Debug)]
pub(crate) struct Tally {
    what: &'static str,
    passed: BTreeMap<SourceId, (usize, Option<Measured>)>,
}

impl Tally {
    /// `what` is the plural of the subject, as in "joints of robot.urdf".
    pub(crate) fn new(what: &'static str) -> Self {
        Self {
            what,
            passed: BTreeMap::new(),
        }
    }

    /// One more subject of `source` passes. The row shows the largest measurement.
    pub(crate) fn pass(&mut self, source: SourceId, measured: Measured) {
        let (count, worst) = self.passed.entry(source).or_default();
        *count += 1;
        if worst
            .as_ref()
            .is_none_or(|known| measured.value.abs() > known.value.abs())
        {
            *worst = Some(measured);
        }
    }

    /// One more subject of `source` passes, without a measurement.
    pub(crate) fn count(&mut self, source: SourceId) {
        self.passed.entry(source).or_default().0 += 1;
    }

    /// Writes one `pass` for each source with subjects that pass.
    pub(crate) fn report(self, world: &World, out: &mut Judge) {
        for (source, (count, worst)) in self.passed {
            let checked = Measured::count(format!("{} that pass", self.what), count);
            out.pass(
                format!("{} of {}", self.what, world.path(source)),
                worst.into_iter().chain([checked]),
            );
        }
    }
}
