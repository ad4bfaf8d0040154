//! Tries known mistakes on a judged world: those that the user wants to see, and those that the configuration requires to be found.

use crate::assure::{Assurance, RuleRunner, assure as try_all};
use crate::config::Config;
use crate::faults::Selection;
use crate::progress::Progress;
use crate::verdict::Verdict;
use crate::world::World;

use super::governed::Governance;
use super::plan::Choice;
use super::timings::{Phase, Timings};
use super::{Options, Rules, judge};

impl RuleRunner for Choice {
    fn judge(&self, world: &World, is_wanted: &dyn Fn(&str) -> bool) -> Verdict {
        let rules = self.rules.iter().filter(|rule| is_wanted(rule.entry.page.code));
        let rules: Vec<_> = rules.collect();
        let timings = Timings::default();
        judge::judge_sharing(world, rules, &self.settings, Some(&self.kept), None, &timings)
    }
}

impl RuleRunner for Rules {
    fn judge(&self, world: &World, is_wanted: &dyn Fn(&str) -> bool) -> Verdict {
        RuleRunner::judge(&self.0, world, is_wanted)
    }
}

impl Governance {
    /// Whether mistakes are tried on the platforms that it governs.
    pub(super) fn assures(&self, options: &Options) -> bool {
        options.assure.is_some()
            || self
                .config
                .as_ref()
                .is_some_and(|config| config.detections().next().is_some())
    }
}

/// Tries the mistakes that are wanted and those that the configuration requires; none if there are none.
pub(super) fn assure(world: &World, governed: &Governance, options: &Options) -> Option<Assurance> {
    if !governed.assures(options) {
        return None;
    }
    let required: Vec<&str> = governed
        .config
        .iter()
        .flat_map(Config::detections)
        .map(|required| required.rule.as_str())
        .collect();
    let mut selection = options.assure.clone().unwrap_or_default();
    selection.join(&Selection::of(&required));
    let progress = Progress::of_trials(options.progress);
    let rules = governed.choice.without_plots();
    let assurance = options.timings.of(Phase::Judge, "known mistakes", || {
        try_all(world, &rules, &selection, &progress)
    });
    Some(assurance)
}
