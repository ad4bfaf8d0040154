//! What a run is asked for, and a call that cannot be carried out.

use std::fmt;
use std::path::PathBuf;

use crate::config::ConfigError;
use crate::files::Outputs;
use crate::read::discover::Wanted;
use crate::read::xacro::Means;
use crate::run::FailOn;
use crate::verdict::KeptOutcomes;
use crate::verdict::waiver::Day;

use super::sampling::Extent;
use super::timings::Timings;

/// What the user asked for.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Files and folders.
    pub paths: Vec<PathBuf>,
    /// Documents of evidence, judged beside the paths.
    pub evidence: Vec<PathBuf>,
    /// Which files of the folders are read.
    pub wanted: Wanted,
    /// Codes, names and families of the rules to run; all where empty.
    pub select: Vec<String>,
    /// Codes, names and families of the rules to leave out.
    pub ignore: Vec<String>,
    /// Whether configurations that are found may name files outside of their repositories.
    pub outside: bool,
    /// How xacro files are expanded.
    pub xacro: Means,
    /// The configuration that [`check`](super::check) uses; the nearest above the inputs where `None`.
    pub config: Option<PathBuf>,
    /// Whether no configuration is looked for.
    pub without_config: bool,
    /// A profile of the tool that the configuration stands on.
    pub profile: Option<String>,
    /// A baseline: its findings are accepted.
    pub baseline: Option<PathBuf>,
    /// From which severity on findings fail a run, for the verdicts of recordings; as the configuration says where `None`.
    pub fail_on: Option<FailOn>,
    /// What has a verdict of its own.
    pub verdicts: Verdicts,
    /// Which outcomes are kept.
    pub outcomes: KeptOutcomes,
    /// What there is to be looked at besides.
    pub sights: Sights,
    /// The day on which waivers must still hold; this one in UTC where `None`.
    pub today: Option<Day>,
    /// How much of recordings is read.
    pub extent: Extent,
    /// The files that will be written.
    pub outputs: Outputs,
    /// Folders with definitions of messages, for recordings that carry none.
    pub msg_paths: Vec<PathBuf>,
    /// Whether to draw a progress bar on a terminal.
    pub progress: bool,
    /// Where the time goes, if somebody asks.
    pub timings: Timings,
}

/// What has a verdict of its own in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Verdicts {
    /// Each recording, where there are several.
    #[default]
    Each,
    /// Everything.
    One,
}

/// What a run keeps to be looked at; each has what those before it have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sights {
    /// The verdict alone.
    None,
    /// What was read of every platform.
    #[default]
    Worlds,
    /// The plots of rules.
    Plots,
    /// Plots, and all that is known of every platform, clouds of points among it.
    Everything,
}

/// A call that cannot be carried out as it was made.
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
