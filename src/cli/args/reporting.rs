//! Arguments on reports: format, file, and what they leave out.

use std::path::PathBuf;

use clap::Args;
use clap_complete::ArgValueCompleter;

use crate::files::Outputs;
use crate::report::Format;
use crate::report::terminal::Parts;
use crate::run::{FailOn, Run};

use super::Color;
use super::values::{by_ending, output, outputs};

/// Parts to leave out of a report for people.
#[derive(Clone, Copy, Debug, Args)]
pub(in crate::cli) struct Omissions {
    /// Show only findings and inputs with problems
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Show the number of findings of each rule, instead of the findings
    #[arg(long, conflicts_with = "quiet")]
    statistics: bool,
}

impl Omissions {
    pub(in crate::cli) fn parts(self) -> Parts {
        match (self.quiet, self.statistics) {
            (true, _) => Parts::Findings,
            (_, true) => Parts::Statistics,
            (false, false) => Parts::All,
        }
    }
}

/// How results are reported.
#[derive(Debug, Args)]
pub(in crate::cli) struct ReportOptions {
    /// Lowest severity that gives exit code 1; hints never do
    ///
    /// Default: `fail-on` of the configuration, else error.
    #[arg(long, value_enum, value_name = "SEVERITY")]
    pub(in crate::cli) fail_on: Option<FailOn>,
    /// Format of the report
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: Format,
    /// Colour in the report; auto: only on a terminal, and if NO_COLOR is not set
    #[arg(long, value_enum, default_value = "auto", value_name = "WHEN")]
    pub(in crate::cli) color: Color,
    /// List every check that was not evaluated, with the reason
    #[arg(short, long)]
    pub(in crate::cli) verbose: bool,
    /// Show every finding, without a limit on their number
    #[arg(long)]
    pub(in crate::cli) all: bool,
    #[command(flatten)]
    pub(in crate::cli) less: Omissions,
    /// Write the report to a file; repeatable, one format per file
    ///
    /// The format follows from the file's extension (.sarif, .html, .json, .jsonl, .xml, .md) unless --format names another.
    /// `FORMAT=FILE` sets the format of one file (`--output sarif=frames.sarif --output junit=frames.xml`). The counts and
    /// the verdict go to standard error.
    #[arg(short, long, value_name = "[FORMAT=]FILE", value_parser = output::<Format>, add = ArgValueCompleter::new(outputs))]
    pub(in crate::cli) output: Vec<Output<Format>>,
    /// Overwrite existing files that are not reports
    ///
    /// With --fix: also change files that are read-only, have several names (links), or are outside the checked paths.
    /// An output never overwrites an input.
    #[arg(long)]
    pub(in crate::cli) force: bool,
}

impl ReportOptions {
    /// The files to write: reports and others.
    pub(in crate::cli) fn outputs<'o>(&self, others: impl IntoIterator<Item = &'o Option<PathBuf>>) -> Outputs {
        let reports = self.output.iter().map(|output| output.file.clone());
        Outputs {
            files: reports.chain(others.into_iter().flatten().cloned()).collect(),
            force: self.force,
            rewritten: None,
        }
    }

    /// The lowest severity that fails the run.
    pub(in crate::cli) fn fail_on(&self, run: &Run) -> FailOn {
        self.fail_on.or(run.fail_on).unwrap_or_default()
    }

    /// The format of a report in a file.
    pub(in crate::cli) fn format_of(&self, output: &Output<Format>) -> Format {
        match (output.format, self.format) {
            (None, Format::Human) => by_ending(&output.file),
            (Some(format), _) | (None, format) => format,
        }
    }

    /// Whether the report goes to a file, and only its ending to the terminal.
    pub(in crate::cli) fn is_in_file(&self) -> bool {
        self.output.iter().any(|output| output.format.is_none())
    }

    /// Whether every report is written during the run.
    pub(in crate::cli) fn streams(&self) -> bool {
        let mut formats = self.output.iter().map(|output| self.format_of(output));
        formats.all(|one| one == Format::JsonLines) && (self.is_in_file() || self.format == Format::JsonLines)
    }

    /// Whether a report has this format.
    pub(in crate::cli) fn has(&self, format: Format) -> bool {
        let mut formats = self.output.iter().map(|output| self.format_of(output));
        (self.format == format && !self.is_in_file()) || formats.any(|one| one == format)
    }
}

/// A file for a report in one of the formats `F`.
#[derive(Clone, Debug)]
pub(in crate::cli) struct Output<F> {
    /// Its format; `None`: that of `--format`.
    pub(in crate::cli) format: Option<F>,
    pub(in crate::cli) file: PathBuf,
}
