//! The engine: plan, read, judge. A stand-in that finds nothing.

use std::fmt;
use std::path::PathBuf;

use crate::run::Run;

/// What the user asked for.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Files and folders.
    pub paths: Vec<PathBuf>,
    /// Codes, names and families of the rules to run; all where empty.
    pub select: Vec<String>,
    /// Codes, names and families of the rules to leave out.
    pub ignore: Vec<String>,
    /// Arguments handed to xacro (`name:=value`).
    pub xacro_args: Vec<String>,
    /// Whether to draw a progress bar on a terminal.
    pub progress: bool,
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

/// Reads the inputs and judges them.
pub fn check(_options: &Options) -> Result<Run, UsageError> {
    Ok(Run::default())
}

/// Reads the inputs and judges nothing.
pub fn read(_options: &Options) -> Result<Run, UsageError> {
    Ok(Run::default())
}
