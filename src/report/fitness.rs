//! Whether recordings are fit for calibrations, in words: for every report.

use crate::fitness::{Condition, Fitness, FitnessWord};

/// The verdict in one line: what it is fit for.
pub(super) fn title(fitness: &Fitness) -> String {
    let platform = match fitness.platform.as_str() {
        "" => String::new(),
        platform => format!("{platform}: "),
    };
    format!(
        "{platform}{} for {} calibration ({})",
        sentence(fitness.verdict()),
        fitness.calibration.word(),
        fitness.subject
    )
}

fn sentence(verdict: FitnessWord) -> &'static str {
    match verdict {
        FitnessWord::Fit => "Fit",
        FitnessWord::NotFit => "Not fit",
        FitnessWord::Unknown => "Cannot be told whether it is fit",
    }
}

/// What became of a condition, in a word or two.
pub(super) fn state(condition: &Condition) -> String {
    if condition.is_needed {
        condition.state.word().to_owned()
    } else {
        format!("{} (not needed)", condition.state.word())
    }
}
