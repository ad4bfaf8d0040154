//! The options of a run, and the error of a wrong call.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use crate::config::ConfigError;
use crate::faults::Selection;
use crate::files::Outputs;
use crate::fitness::Calibration;
use crate::read::discover::FileSelection;
use crate::read::messages::definition::Definitions;
use crate::read::xacro::ExpandOptions;
use crate::run::FailOn;
use crate::verdict::KeptOutcomes;
use crate::verdict::waiver::Day;

use super::sampling::Extent;
use super::timings::Timings;

/// The options of a run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Files and folders.
    pub paths: Vec<PathBuf>,
    /// Evidence documents, judged together with the paths.
    pub evidence: Vec<PathBuf>,
    /// Which files of the folders are read.
    pub wanted: FileSelection,
    /// Codes, names and families of the rules to run; empty: all.
    pub select: Vec<String>,
    /// Codes, names and families of the rules to skip.
    pub ignore: Vec<String>,
    /// Whether configurations that are found may refer to files outside of their repositories.
    pub outside: bool,
    /// How xacro files are expanded.
    pub xacro: ExpandOptions,
    /// The configuration that [`check`](super::check) uses; `None`: the nearest above the inputs.
    pub config: Option<PathBuf>,
    /// Whether configurations are ignored.
    pub without_config: bool,
    /// The built-in profile on which the configuration is based.
    pub profile: Option<String>,
    /// A baseline: its findings are accepted.
    pub baseline: Option<PathBuf>,
    /// The lowest severity that fails a run, for the verdicts of recordings; `None`: that of the configuration.
    pub fail_on: Option<FailOn>,
    /// What has a verdict of its own.
    pub verdicts: VerdictScope,
    /// Which outcomes are kept.
    pub outcomes: KeptOutcomes,
    /// Data kept for plots and views.
    pub sights: Retention,
    /// The date on which waivers must still be valid; `None`: today in UTC.
    pub today: Option<Day>,
    /// How much of recordings is read.
    pub extent: Extent,
    /// Mistakes to try on everything that is judged; `None`: only those that the configuration requires to be found.
    pub assure: Option<Selection>,
    /// Calibrations for which the recordings should be fit.
    pub fit_for: Vec<Calibration>,
    /// The files that will be written.
    pub outputs: Outputs,
    /// Folders with message definitions, for recordings that contain none.
    pub msg_paths: Vec<PathBuf>,
    /// Whether to draw a progress bar on a terminal.
    pub progress: bool,
    /// Time spent, if wanted.
    pub timings: Timings,
}

impl Options {
    /// The definitions of messages: the built-in ones, and those of the folders that the user named.
    pub(super) fn definitions(&self) -> Result<Arc<Definitions>, UsageError> {
        let mut definitions = Definitions::builtin();
        for folder in &self.msg_paths {
            definitions
                .add_folder(folder)
                .map_err(|what| UsageError(format!("--msg-path: {what}")))?;
        }
        Ok(Arc::new(definitions))
    }
}

/// What has a verdict of its own in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VerdictScope {
    /// Each recording, if there are several.
    #[default]
    Each,
    /// Everything.
    One,
}

/// Data that a run keeps for plots and views; each value includes the ones before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Retention {
    /// The verdict alone.
    None,
    /// And what was read of every platform.
    #[default]
    Worlds,
    /// The plots of rules.
    Plots,
    /// And all data of every platform, including point clouds.
    Everything,
}

/// A wrong command line or configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsageError(pub String);

impl fmt::Display for UsageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for UsageError {}

impl From<ConfigError> for UsageError {
    fn from(error: ConfigError) -> Self {
        Self(error.0)
    }
}
