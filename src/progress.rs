//! The progress bars of reading and of trials, on stderr. Shown only on a terminal, after reading has taken a second.
//!
//! Several inputs may be read at once: the bar shows their sum.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Shorter runs show no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// The bar of reading.
const READING: &str = "reading {wide_msg} {bar:24} {decimal_bytes}/{decimal_total_bytes}";
/// The bar of trials.
const TRYING: &str = "trying {wide_msg} {bar:24} {pos}/{len}";

/// The progress of a run.
#[derive(Debug)]
pub struct Progress {
    template: &'static str,
    state: Option<Mutex<State>>,
}

#[derive(Debug)]
struct State {
    since: Instant,
    done: u64,
    total: u64,
    open: usize,
    bar: Option<ProgressBar>,
}

/// The progress of one input. Finished when dropped.
#[derive(Debug)]
pub struct Task<'a> {
    progress: &'a Progress,
    name: String,
    total: u64,
    done: Mutex<u64>,
}

impl Progress {
    /// A bar of bytes read, if `enabled` and stderr is a terminal; nothing otherwise.
    pub fn new(enabled: bool) -> Self {
        Self::when(enabled && std::io::stderr().is_terminal(), READING)
    }

    /// The same for trials, whose tasks count them instead of bytes.
    pub fn of_trials(enabled: bool) -> Self {
        Self::when(enabled && std::io::stderr().is_terminal(), TRYING)
    }

    fn when(shown: bool, template: &'static str) -> Self {
        Self {
            template,
            state: shown.then(|| {
                Mutex::new(State {
                    since: Instant::now(),
                    done: 0,
                    total: 0,
                    open: 0,
                    bar: None,
                })
            }),
        }
    }

    /// Starts an input of `total_bytes`.
    pub fn start(&self, name: &str, total_bytes: u64) -> Task<'_> {
        self.with(|state| {
            state.total += total_bytes;
            state.open += 1;
        });
        Task {
            progress: self,
            name: name.to_owned(),
            total: total_bytes,
            done: Mutex::new(0),
        }
    }

    /// Removes the bar. Called on drop as well.
    pub fn finish(&self) {
        self.with(|state| {
            if let Some(bar) = state.bar.take() {
                bar.finish_and_clear();
            }
        });
    }

    fn with(&self, change: impl FnOnce(&mut State)) {
        if let Some(state) = &self.state {
            change(&mut state.lock().unwrap_or_else(PoisonError::into_inner));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Task<'_> {
    /// `so_far` bytes of this input have been read. Backward steps are ignored; more than the total counts as the total.
    pub fn update(&self, so_far: u64) {
        if self.progress.state.is_none() {
            return;
        }
        let more = {
            let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
            let now = so_far.min(self.total).max(*done);
            let more = now - *done;
            *done = now;
            more
        };
        self.progress.with(|state| {
            state.done += more;
            state.draw(self.progress.template, &self.name);
        });
    }

    /// The input is read. Dropping the task does the same.
    pub fn finish(self) {
        drop(self);
    }
}

impl Drop for Task<'_> {
    fn drop(&mut self) {
        self.update(self.total);
        self.progress.with(|state| state.open = state.open.saturating_sub(1));
        if self.progress.idle() {
            self.progress.finish();
        }
    }
}

impl Progress {
    fn idle(&self) -> bool {
        let mut idle = false;
        self.with(|state| idle = state.open == 0);
        idle
    }
}

impl State {
    fn draw(&mut self, template: &str, name: &str) {
        if self.bar.is_none() && self.since.elapsed() >= PATIENCE {
            let bar = ProgressBar::with_draw_target(Some(self.total), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            self.bar = Some(bar);
        }
        if let Some(bar) = &self.bar {
            bar.set_length(self.total);
            bar.set_position(self.done);
            // A control character in a file name would break the bar.
            bar.set_message(name.replace(char::is_control, "?"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn done(progress: &Progress) -> (u64, u64, usize) {
        let mut seen = (0, 0, 0);
        progress.with(|state| seen = (state.done, state.total, state.open));
        seen
    }

    #[test]
    fn tasks_add_up_and_finish_by_themselves() {
        fn shared<T: Send + Sync>(_: &T) {}
        let progress = Progress::when(true, READING);
        let first = progress.start("a.mcap", 100);
        let second = progress.start("b.mcap", 10);
        shared(&progress);
        shared(&first);
        first.update(40);
        first.update(30);
        second.update(99);
        assert_eq!(done(&progress), (50, 110, 2));
        first.finish();
        drop(second);
        assert_eq!(done(&progress), (110, 110, 0));
    }

    #[test]
    fn nothing_is_counted_where_nothing_is_shown() {
        let progress = Progress::when(false, READING);
        progress.start("a.mcap", 100).update(40);
        assert!(progress.state.is_none());
    }
}
