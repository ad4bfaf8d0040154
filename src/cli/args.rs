//! The command-line arguments (clap) and their help texts.

mod reading;
mod reporting;
mod values;

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
use clap_complete::ArgValueCandidates;

use crate::config::PROFILES;
use crate::engine;
use crate::fitness::Calibration;

pub(super) use reading::ReadOptions;
pub(super) use reporting::{Output, ReportOptions};

use values::{Targets, calibrations, is, mistakes, output, rules, selectors, size, verbs, xacro_arg};

const EXIT_CODES: &str = "\
Exit codes:
   0  clean: something was checked, and no finding is at or above --fail-on
   1  a finding at or above --fail-on; hints never count
   2  wrong command line or configuration
   3  incomplete: an input was not read in full, a requirement is not met, nothing was checked,
      or a recording is not shown to be fit (--for)
  70  internal error: a bug in frames-lint";

/// Linter and acceptance gate for the coordinate frames of robots
///
/// Reads URDF, xacro, calibration files and recordings together, and reports what is wrong with the coordinate frames,
/// where, by how much, and how to fix it.
#[derive(Debug, Parser)]
#[command(name = "frames-lint", version, after_help = EXIT_CODES, disable_help_subcommand = true)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Check files and folders, and report findings
    Check(Check),
    /// Show which known mistakes these data would have shown
    ///
    /// Puts each known mistake (an inverse extrinsic, a wrong quaternion order, a late clock, ...) into a copy of what was read, checks the
    /// copy, and lists which mistakes would have been named, noticed or missed, and what to record so that they are found.
    Assure(Assure),
    /// Compare two platforms or recordings: changed transforms, topics and clocks
    ///
    /// Where a known convention error (inverse, quaternion order, degrees, ...) explains a change, the error is named.
    Diff(Diff),
    /// Write an initial frames-lint.yaml from what the inputs contain
    ///
    /// It lists which source states which transform, and requires what could be checked this time to be checked from now on. With --from it
    /// holds the next recordings to what a good one contains.
    Init(Init),
    /// Explain a rule: what it checks, why it matters, how it decides, how to fix it
    Explain {
        /// Code or name of the rule (TREE01 or orphan-subtree)
        #[arg(add = ArgValueCandidates::new(rules))]
        rule: String,
    },
    /// List the rules
    Rules {
        /// Output format
        #[arg(long, value_enum, default_value = "text")]
        format: RulesFormat,
    },
    /// Save what is read from the inputs, for a later `check --evidence`
    ///
    /// Applies no rules. The evidence file is small and can be checked without the original recordings.
    Collect(Collect),
    /// Draw the frame tree, with the source of each transform
    ///
    /// Applies no rules.
    Tree(Tree),
    /// Show frames, point clouds, tracks, plots and findings in the Rerun viewer
    View(View),
    /// Check products of transforms in source code (C++, Python, Rust)
    ///
    /// In a product such as `map_from_base * base_from_lidar`, adjacent frames in the names must match.
    Chain(Chain),
    /// Convert a transform to the format of another tool, or to another notation
    ///
    /// The chain of transforms that leads to the result is written as well.
    Convert(Convert),
    /// Expand one xacro file (run by `check` in a separate process for each file)
    #[command(name = engine::EXPAND_XACRO, hide = true)]
    ExpandXacro {
        /// Xacro file
        file: PathBuf,
        /// Arguments of the xacro file
        #[arg(value_name = "NAME:=VALUE", value_parser = xacro_arg)]
        args: Vec<String>,
        /// Folder that may be read; repeatable (default: all)
        #[arg(long, value_name = "DIR")]
        allowed: Vec<PathBuf>,
        /// Base folder of relative paths in the file (default: working directory)
        #[arg(long, value_name = "DIR")]
        from: Option<PathBuf>,
    },
    /// Write a completion script for a shell
    Completions {
        /// Shell to write the script for
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Write a manual page (roff)
    Man {
        /// Command to describe (default: the program itself)
        #[arg(value_name = "COMMAND", add = ArgValueCandidates::new(verbs))]
        verb: Option<String>,
    },
}

#[derive(Debug, Args)]
pub(super) struct Input {
    /// Files and folders; `-` reads a list of paths from standard input
    ///
    /// The list has one path per line, or NUL-separated paths (`git ls-files -z`).
    #[arg(required = true, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub(super) paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) reading: ReadOptions,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Check {
    /// Files and folders; `-` reads a list of paths from standard input (default: .)
    ///
    /// The list has one path per line, or NUL-separated paths (`git ls-files -z`). With --evidence there is no default.
    #[arg(value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub(super) paths: Vec<PathBuf>,
    /// Evidence file saved by `collect`; repeatable
    ///
    /// Checked like the original inputs, together with the paths on the command line.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) evidence: Vec<PathBuf>,
    /// Configuration for all inputs (default: each frames-lint.yaml, for its folder)
    ///
    /// Without this option, a frames-lint.yaml applies to its folder and everything below.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    /// Show which configuration applies to a file and what it changes; check nothing
    #[arg(long, value_name = "FILE", value_hint = ValueHint::AnyPath, conflicts_with_all = ["paths", "evidence"])]
    pub(super) show_settings: Option<PathBuf>,
    /// Profile on which the configuration is based
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(PROFILES.iter().map(|(name, _)| *name)))]
    pub(super) profile: Option<String>,
    /// Baseline: findings listed in it are accepted, only new ones count
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) baseline: Option<PathBuf>,
    /// Write the findings of this run to a baseline, and accept them in this run
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) write_baseline: Option<PathBuf>,
    #[command(flatten)]
    pub(super) fixing: FixOptions,
    /// Check again whenever an input changes, until interrupted (Ctrl-C)
    #[arg(long, conflicts_with_all = ["fix", "unsafe_fixes", "diff", "write_baseline"])]
    pub(super) watch: bool,
    #[command(flatten)]
    pub(super) reading: ReadOptions,
    /// Rules to run: codes, names or families, comma-separated (default: all)
    #[arg(long, value_name = "RULES", value_delimiter = ',', add = ArgValueCandidates::new(selectors))]
    pub(super) select: Vec<String>,
    /// Rules to skip: codes, names or families, comma-separated
    #[arg(long, value_name = "RULES", value_delimiter = ',', add = ArgValueCandidates::new(selectors))]
    pub(super) ignore: Vec<String>,
    #[command(flatten)]
    pub(super) reporting: ReportOptions,
    #[command(flatten)]
    pub(super) views: Views,
    /// Also put known mistakes into a copy of the data, and report which would not have been found
    ///
    /// `frames-lint assure` shows all of them. Findings and exit code stay as they are.
    #[arg(long)]
    pub(super) assure: bool,
    /// Also tell whether the recordings are fit for these calibrations, comma-separated; exit code 3 if not
    ///
    /// Recordings are read completely, unless --windows or --budget is given.
    #[arg(long = "for", value_name = "CALIBRATION", value_delimiter = ',', value_parser = calibrations())]
    pub(super) fit_for: Vec<Calibration>,
    /// Print the time spent on each input and rule to standard error
    #[arg(long)]
    pub(super) timings: bool,
}

/// Views written in addition to a report.
#[derive(Debug, Args)]
pub(super) struct Views {
    /// Write a file for the Rerun viewer as well (open it with `rerun FILE`)
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) rrd: Option<PathBuf>,
    /// Maximum size of the --rrd file (MB, or with a unit: 800kB, 2GB)
    ///
    /// Samples and points are thinned out, and meshes left out, until the file is small enough.
    #[arg(long, value_name = "SIZE", default_value = "100MB", value_parser = size)]
    pub(super) max_size: u64,
}

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("where").required(true).multiple(true))]
pub(super) struct View {
    #[command(flatten)]
    pub(super) input: Input,
    /// Configuration that declares conventions of the inputs
    ///
    /// Default: the nearest frames-lint.yaml in the folders above the inputs.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    /// Write the views to a file (open it with `rerun FILE`)
    #[arg(short, long, value_name = "FILE", group = "where", value_hint = ValueHint::FilePath)]
    pub(super) output: Option<PathBuf>,
    /// Overwrite an existing file that contains no views
    #[arg(long)]
    pub(super) force: bool,
    /// Start the viewer (the program `rerun`) and show the views
    #[arg(long, group = "where")]
    pub(super) spawn: bool,
    /// Send the views to a running viewer (rerun+http://127.0.0.1:9876/proxy)
    #[arg(long, value_name = "URL", group = "where")]
    pub(super) connect: Option<String>,
    /// Maximum size of the views (MB, or with a unit: 800kB, 2GB)
    ///
    /// Samples and points are thinned out, and meshes left out, until the views are small enough.
    #[arg(long, value_name = "SIZE", default_value = "100MB", value_parser = size)]
    pub(super) max_size: u64,
}

/// Fixes to apply or to show.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct FixOptions {
    /// Apply the safe fixes, then check again and report the remaining findings
    #[arg(long)]
    pub(super) fix: bool,
    /// Apply all fixes, including those that change behaviour
    #[arg(long)]
    pub(super) unsafe_fixes: bool,
    /// Show the safe fixes as a diff and change no file; with --unsafe-fixes all fixes
    #[arg(long)]
    pub(super) diff: bool,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Chain {
    /// Source files and folders; `-` reads a list of paths from standard input
    ///
    /// The list has one path per line, or NUL-separated paths (`git ls-files -z`).
    #[arg(required = true, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub(super) paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) reporting: ReportOptions,
}

#[derive(Debug, Args)]
pub(super) struct Convert {
    #[command(flatten)]
    pub(super) input: Input,
    /// Notation (urdf, tf, matrix, quaternion, rpy), or tool (kalibr, fast-lio, ...)
    #[arg(long, value_name = "FORM", value_parser = Targets)]
    pub(super) to: String,
    /// Convert TARGET_from_SOURCE, over any chain (default: every transform read)
    ///
    /// It takes coordinates expressed in SOURCE to coordinates expressed in TARGET.
    #[arg(long, num_args = 2, value_names = ["TARGET", "SOURCE"])]
    pub(super) frames: Vec<String>,
    /// Key to write under; with --is, the key of the transform in the input
    #[arg(long, value_name = "KEY")]
    pub(super) key: Option<String>,
    /// Frames of a transform whose file does not name them
    #[arg(long, value_name = "TARGET from SOURCE", value_parser = is)]
    pub(super) is: Option<(String, String)>,
    /// Configuration that declares conventions of the inputs
    ///
    /// Default: the nearest frames-lint.yaml in the folders above the inputs.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    /// Write to a file instead of standard output; *.feather gives a Feather file
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) output: Option<PathBuf>,
    /// Overwrite an existing file
    #[arg(long)]
    pub(super) force: bool,
}

const ASSURE_EXIT_CODES: &str = "\
Exit codes:
   0  mistakes were tried; how many were missed does not matter
   2  wrong command line or configuration
   3  no known mistake applies, or an input was not read in full
  70  internal error: a bug in frames-lint";

#[derive(Debug, Args)]
#[command(after_help = ASSURE_EXIT_CODES)]
pub(super) struct Assure {
    /// Files and folders; `-` reads a list of paths from standard input (default: .)
    ///
    /// The list has one path per line, or NUL-separated paths (`git ls-files -z`). With --evidence there is no default.
    #[arg(value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub(super) paths: Vec<PathBuf>,
    /// Evidence file saved by `collect`; repeatable
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) evidence: Vec<PathBuf>,
    /// Configuration for all inputs (default: each frames-lint.yaml, for its folder)
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    /// Mistakes to try: names or families, comma-separated (default: all)
    #[arg(long, value_name = "MISTAKES", value_delimiter = ',', add = ArgValueCandidates::new(mistakes))]
    pub(super) select: Vec<String>,
    /// List the known mistakes, and try none
    #[arg(long, conflicts_with_all = ["paths", "evidence"])]
    pub(super) list: bool,
    /// Format of the report (default: by the extension of --output, else text)
    #[arg(long, value_enum)]
    pub(super) format: Option<AssureFormat>,
    /// Show the mistakes that would have been named as well, without a limit on their number
    #[arg(long)]
    pub(super) all: bool,
    /// Write the report to a file instead of standard output
    #[arg(short, long, value_name = "[FORMAT=]FILE", value_hint = ValueHint::FilePath, value_parser = output::<AssureFormat>)]
    pub(super) output: Option<Output<AssureFormat>>,
    /// Overwrite an existing file that is not a report
    #[arg(long)]
    pub(super) force: bool,
    #[command(flatten)]
    pub(super) reading: ReadOptions,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum AssureFormat {
    Text,
    Json,
    Markdown,
    Html,
}

const DIFF_EXIT_CODES: &str = "\
Exit codes:
   0  no changes
   1  changes
   2  wrong command line or configuration
   3  nothing in common; or no changes found, but an input was not read in full
  70  internal error: a bug in frames-lint";

#[derive(Debug, Args)]
#[command(after_help = DIFF_EXIT_CODES)]
pub(super) struct Diff {
    /// Before: a file, a recording or a folder
    #[arg(value_name = "BEFORE", value_hint = ValueHint::AnyPath)]
    pub(super) before: PathBuf,
    /// After: a file, a recording or a folder
    #[arg(value_name = "AFTER", value_hint = ValueHint::AnyPath)]
    pub(super) after: PathBuf,
    /// Format of the comparison
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: DiffFormat,
    /// Configuration that declares conventions of both
    ///
    /// Default: the nearest frames-lint.yaml in the folders above each of the two.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    #[command(flatten)]
    pub(super) reading: ReadOptions,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum DiffFormat {
    Text,
    Json,
}

#[derive(Debug, Args)]
pub(super) struct Init {
    /// Files and folders; `-` reads a list of paths from standard input
    ///
    /// The list has one path per line, or NUL-separated paths (`git ls-files -z`).
    #[arg(required_unless_present = "from", value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub(super) paths: Vec<PathBuf>,
    /// Good recording, or a folder of them: hold the next ones to what it contains
    ///
    /// Adds a contract: topics with types, rates and frames, latched transforms with tolerances, and the known mistakes that this recording
    /// would have shown. It is read together with the paths.
    #[arg(long, value_name = "GOOD", value_hint = ValueHint::AnyPath)]
    pub(super) from: Option<PathBuf>,
    #[command(flatten)]
    pub(super) reading: ReadOptions,
    /// File to write, `-` for standard output (default: frames-lint.yaml in first path)
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) output: Option<PathBuf>,
    /// Overwrite an existing configuration
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct Collect {
    #[command(flatten)]
    pub(super) input: Input,
    /// Write the evidence to a file instead of standard output
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) output: Option<PathBuf>,
    /// Write the first cloud of a recording to a PCD file, decoded from packets if the recording has these
    ///
    /// Fields: x, y, z, intensity, ring, time. Evidence is written only with --output.
    #[arg(long, value_name = "FILE.pcd", value_hint = ValueHint::FilePath)]
    pub(super) clouds: Option<PathBuf>,
    /// Topic of that cloud (default: the only one with clouds)
    #[arg(long, requires = "clouds")]
    pub(super) topic: Option<String>,
    /// Overwrite an existing file that is neither a report nor evidence
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct Tree {
    #[command(flatten)]
    pub(super) input: Input,
    /// Format of the drawing
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: TreeFormat,
    /// Show the trees at a timestamp: seconds, or a date and time
    ///
    /// The timestamp is one of header stamps. Recordings are read completely.
    #[arg(long, value_name = "STAMP", value_parser = super::stamp::parse)]
    pub(super) at: Option<i64>,
    /// Show every transform between two frames, and their product
    ///
    /// At the timestamp of --at, else at the latest one that all of the transforms have. Recordings are read completely.
    #[arg(long, num_args = 2, value_names = ["TARGET", "SOURCE"])]
    pub(super) chain: Vec<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum RulesFormat {
    Text,
    Json,
    Markdown,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum TreeFormat {
    Text,
    Dot,
    Mermaid,
    Svg,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Color {
    Auto,
    Always,
    Never,
}
