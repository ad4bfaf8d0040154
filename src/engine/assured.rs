//! Tries known mistakes on a judged world: those that the user wants to see, and those that the configuration requires to be found.

use crate::assure::{Assurance, RuleRunner, assure as try_all};
use crate::config::Config;
use crate::faults::Selection;
use crate::progress::Progress;
use crate::verdict::Verdict;
use crate::world::World;

use super::governed::Governance;
use super::plan::Choice;
use super::policy::{PolicyOfCopies, RunPolicy};
use super::timings::{Phase, Timings};
use super::{Options, Rules, Setup, judge};

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

/// Rules with what the user accepts: a mistake whose finding would be accepted is not found.
struct GovernedRules<'p> {
    rules: Choice,
    /// `None` where nothing is accepted.
    policy: Option<PolicyOfCopies<'p>>,
}

impl RuleRunner for GovernedRules<'_> {
    fn judge(&self, world: &World, is_wanted: &dyn Fn(&str) -> bool) -> Verdict {
        let mut verdict = RuleRunner::judge(&self.rules, world, is_wanted);
        if let Some(policy) = &self.policy {
            policy.mark(&mut verdict, &world.sources);
        }
        verdict
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

impl Setup<'_> {
    /// Tries mistakes on judged worlds, each with the index of its configuration, if that is wanted or required. The worlds have their
    /// sources.
    pub(super) fn assure<'w>(
        &self,
        worlds: impl IntoIterator<Item = (usize, &'w World)>,
        policy: &RunPolicy,
    ) -> Vec<(usize, Assurance)> {
        let assured = worlds
            .into_iter()
            .filter_map(|(governed, world)| Some((governed, self.assure_one(world, governed, policy)?)));
        assured.collect()
    }

    /// Tries the mistakes that are wanted and those that the configuration requires; none if there are none.
    fn assure_one(&self, world: &World, governed: usize, policy: &RunPolicy) -> Option<Assurance> {
        let governance = self.governed.at(governed);
        if !governance.assures(self.options) {
            return None;
        }
        let configs = governance.config.iter();
        let required: Vec<&str> = configs
            .flat_map(Config::detections)
            .map(|required| required.rule.as_str())
            .collect();
        let mut selection = self.options.assure.clone().unwrap_or_default();
        selection.join(&Selection::of(&required));
        let progress = Progress::of_trials(self.options.progress);
        let rules = GovernedRules {
            rules: governance.choice.without_plots(),
            policy: policy.of_copies(governed, &world.sources),
        };
        let assurance = self.options.timings.of(Phase::Judge, "known mistakes", || {
            try_all(world, &rules, &selection, &progress)
        });
        Some(assurance)
    }
}
