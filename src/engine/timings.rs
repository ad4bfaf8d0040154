//! The time of a run for every input and every rule, summed over rounds, platforms and threads.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::visible::clean;

/// Maximum number of items listed per phase.
const NAMED: usize = 8;

/// A phase of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Phase {
    /// Finding files.
    Find,
    /// Finding and reading configurations.
    Configure,
    /// Reading an input.
    Read,
    /// Running a rule.
    Judge,
}

type Durations = BTreeMap<(Phase, String), Duration>;

/// Wall time by phase, and by input or rule; measured only if wanted.
#[derive(Clone, Debug, Default)]
pub struct Timings(Option<Arc<Mutex<Durations>>>);

impl Timings {
    /// Timings that are measured.
    pub fn kept() -> Self {
        Self(Some(Arc::default()))
    }

    /// Does some work, and adds its time.
    pub(super) fn of<T>(&self, phase: Phase, what: &str, work: impl FnOnce() -> T) -> T {
        let Some(spent) = &self.0 else { return work() };
        let begin = Instant::now();
        let done = work();
        let mut spent = spent.lock().unwrap_or_else(PoisonError::into_inner);
        *spent.entry((phase, what.to_owned())).or_default() += begin.elapsed();
        done
    }

    /// The times: a line for each phase, then its largest items; empty if nothing was measured.
    pub fn words(&self) -> String {
        let Some(spent) = &self.0 else { return String::new() };
        let spent = spent.lock().unwrap_or_else(PoisonError::into_inner);
        let mut text =
            "Time, summed over threads; work shared by rules counts for the rule that runs first\n".to_owned();
        for (phase, name) in [
            (Phase::Find, "find files"),
            (Phase::Configure, "configuration"),
            (Phase::Read, "read"),
            (Phase::Judge, "judge"),
        ] {
            let of_phase = spent.iter().filter(|((of, _), _)| *of == phase);
            let mut items: Vec<(&str, Duration)> = of_phase.map(|((_, what), time)| (what.as_str(), *time)).collect();
            items.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(b.0)));
            let total: Duration = items.iter().map(|(_, time)| *time).sum();
            let _ = writeln!(text, "  {name:<13}  {:>9.3} s", total.as_secs_f64());
            for (what, time) in items.iter().filter(|(what, _)| !what.is_empty()).take(NAMED) {
                let _ = writeln!(text, "    {:>9.3} s  {}", time.as_secs_f64(), clean(what));
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_is_added_up_and_the_longest_comes_first() {
        let timings = Timings::kept();
        for (what, times) in [("B02", 1), ("A01", 3)] {
            for _ in 0..times {
                timings.of(Phase::Judge, what, || std::thread::sleep(Duration::from_millis(2)));
            }
        }
        assert_eq!(timings.of(Phase::Read, "a.urdf", || 7), 7);
        let words = timings.words();
        let at = |what: &str| words.find(what).unwrap_or(usize::MAX);
        assert!(
            at("a.urdf") < at("A01") && at("A01") < at("B02") && at("B02") < usize::MAX,
            "{words}"
        );
        assert_eq!(Timings::default().of(Phase::Find, "", || 1), 1);
        assert!(Timings::default().words().is_empty());
    }
}
