//! Whether what was judged is fit for the calibrations that are asked for.

use crate::analysis::Estimates;
use crate::fitness::{Calibration, Fitness, fitness};
use crate::run::UnmetRequirement;
use crate::verdict::Verdict;
use crate::world::World;

use super::Setup;

impl Setup<'_> {
    /// The fitness of the recordings of judged worlds.
    pub(super) fn fitness(&self, worlds: &[World], verdicts: &[(usize, Verdict)]) -> Vec<Fitness> {
        let mut found = Vec::new();
        for (world, (governed, verdict)) in worlds.iter().zip(verdicts).filter(|(world, _)| !world.bags.is_empty()) {
            let estimates = Estimates::new(world, &self.governed.at(*governed).choice.settings);
            let kinds = self.options.fit_for.iter();
            found.extend(kinds.flat_map(|kind| fitness(&estimates, verdict, *kind)));
        }
        found
    }

    /// With the calibrations that nothing was there for.
    pub(super) fn fitness_of_all(&self, mut found: Vec<Fitness>) -> Vec<Fitness> {
        let is_missing = |kind: &Calibration| found.iter().all(|one| one.calibration != *kind);
        let missing: Vec<Calibration> = self.options.fit_for.iter().copied().filter(is_missing).collect();
        found.extend(missing.into_iter().map(Fitness::without_recording));
        found
    }
}

/// What is not shown to be fit.
pub(super) fn unfit(fitness: &[Fitness]) -> impl Iterator<Item = UnmetRequirement> {
    fitness.iter().filter_map(UnmetRequirement::of_fitness)
}
