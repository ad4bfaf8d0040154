//! `check --fix`, `--unsafe-fixes` and `--diff`: shows fixes, or applies them until none remains.

use std::fmt::Write;
use std::mem::ManuallyDrop;
use std::path::PathBuf;

use crate::engine::{self, Options};
use crate::fix;
use crate::report::{plural, terminal};
use crate::run::Run;

use super::args::ReportOptions;
use super::{Answer, Failure};

/// A fix may make another one possible in the same place; more rounds than this never helped.
const ROUNDS: usize = 8;

/// Shows the fixes as a diff on standard output. The ending of the report goes to standard error; the exit code is the report's.
pub(super) fn show(run: &Run, options: &Options, all: bool, reporting: &ReportOptions) -> Answer {
    let plan = fix::plan(run, all, checked(options));
    let fail_on = reporting.fail_on(run);
    let mut err = words(&plan, "would fix");
    err.push_str(&terminal::plain_ending(run, fail_on));
    Answer {
        out: plan.diff(),
        err,
        code: run.exit_code(fail_on),
        ..Answer::default()
    }
}

/// Applies fixes and checks again, until none remains. Returns what was done, and whether every file could be written.
pub(super) fn apply(run: &mut ManuallyDrop<Run>, options: &Options, all: bool) -> Result<(String, bool), Failure> {
    let mut said = String::new();
    for _ in 0..ROUNDS {
        let plan = fix::plan(run, all, checked(options));
        if plan.patches.is_empty() {
            if said.is_empty() || !plan.left.is_empty() {
                said.push_str(&words(&plan, "fixed"));
            }
            break;
        }
        let failed = plan.write();
        **run = engine::check(options)?;
        if !failed.is_empty() {
            let planned = plan.patches.len();
            let _ = writeln!(said, "fixed {} of {}", planned - failed.len(), plural(planned, "file"));
            for why in failed {
                let _ = writeln!(said, "error: {why}");
            }
            return Ok((said, false));
        }
        said.push_str(&words(&plan, "fixed"));
    }
    Ok((said, true))
}

/// The paths in which files may be changed: those checked, or any with --force.
fn checked(options: &Options) -> Option<&[PathBuf]> {
    (!options.outputs.force).then_some(&options.paths)
}

/// `fixed 3 findings in 2 files`, what was not fixed and why, and what --unsafe-fixes would do.
fn words(plan: &fix::Plan, verb: &str) -> String {
    let mut words = format!(
        "{verb} {} in {}\n",
        plural(plan.fixed, "finding"),
        plural(plan.patches.len(), "file")
    );
    for why in &plan.left {
        let _ = writeln!(words, "not fixed: {why}");
    }
    if plan.not_asked > 0 {
        let fixes = if plan.not_asked == 1 {
            "1 other fix changes".to_owned()
        } else {
            format!("{} other fixes change", plan.not_asked)
        };
        let _ = writeln!(
            words,
            "{fixes} behaviour: show with --diff --unsafe-fixes, apply with --unsafe-fixes"
        );
    }
    words
}
