//! The command-line arguments (clap) and their help texts.

mod values;

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
use clap_complete::{ArgValueCandidates, ArgValueCompleter};

use crate::config::PROFILES;
use crate::engine::{self, Extent};
use crate::files::Outputs;
use crate::report::Format;
use crate::report::terminal::Parts;
use crate::run::{FailOn, Run};

use super::Surroundings;

use values::{Targets, by_ending, is, output, outputs, rules, selectors, size, verbs, xacro_arg};

const EXIT_CODES: &str = "\
Exit codes:
   0  clean: something was checked, and no finding is at or above --fail-on
   1  a finding at or above --fail-on; hints never count
   2  wrong command line or configuration
   3  incomplete: an input was not read in full, a requirement is not met, or nothing was checked
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
    /// Compare two platforms or recordings: changed transforms, topics and clocks
    ///
    /// Where a known convention error (inverse, quaternion order, degrees, ...) explains a change, the error is named.
    Diff(Diff),
    /// Write an initial frames-lint.yaml from what the inputs contain
    ///
    /// It lists which source states which transform, and requires what could be checked this time to be checked from now on.
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

#[derive(Clone, Debug, Args)]
pub(super) struct ReadOptions {
    /// Argument for xacro files; repeatable
    #[arg(long = "xacro-arg", value_name = "NAME:=VALUE", value_parser = xacro_arg)]
    pub(super) xacro_args: Vec<String>,
    /// Who expands xacro files: frames-lint alone, or also the installed xacro
    ///
    /// The installed xacro program executes code in the files it expands: use `run` only with files that you trust.
    #[arg(long, value_name = "WHO", value_enum, default_value_t)]
    pub(super) xacro: Xacro,
    /// Allow configurations to refer to files outside their repository
    ///
    /// Concerns configurations found beside the inputs: their `extends` and their tables. Not allowed by default.
    #[arg(long)]
    pub(super) outside: bool,
    /// Folder with message definitions (package/msg/Type.msg); repeatable
    ///
    /// Needed for recordings that contain no definitions of their message types.
    #[arg(long = "msg-path", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(super) msg_paths: Vec<PathBuf>,
    /// Read recordings completely, instead of in windows spread over their length
    #[arg(long, conflicts_with_all = ["windows", "budget"])]
    pub(super) full: bool,
    /// Number of windows to read of each recording (default: as many as the rules need)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) windows: Option<u32>,
    /// Time limit for reading more of recordings (30s, 2min; default: none)
    ///
    /// More is read where a rule lacks evidence. Without a time limit, up to 2 GiB of each recording are read.
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration)]
    pub(super) budget: Option<std::time::Duration>,
}

/// Programs that may expand xacro files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Xacro {
    /// frames-lint alone, without environment variables
    #[default]
    Own,
    /// Also the installed xacro program, with environment variables
    Run,
}

impl ReadOptions {
    /// The engine's options for these paths.
    pub(super) fn options(self, paths: Vec<PathBuf>, surroundings: Surroundings) -> engine::Options {
        engine::Options {
            extent: self.extent(),
            paths,
            xacro: surroundings.xacro(self.xacro_args, self.xacro == Xacro::Run),
            outside: self.outside,
            msg_paths: self.msg_paths,
            progress: surroundings.progress,
            ..engine::Options::default()
        }
    }

    /// How much of recordings is read, in words.
    pub(super) fn extent_words(&self) -> String {
        let budget = self.budget.map_or_else(
            || "more is read where a rule lacks evidence".to_owned(),
            |budget| {
                format!(
                    "more is read for {} where a rule lacks evidence",
                    humantime::format_duration(budget)
                )
            },
        );
        match (self.full, self.windows) {
            (true, _) => "read completely".to_owned(),
            (false, Some(windows)) => format!("read in {windows} windows spread over their length; {budget}"),
            (false, None) => format!("read in windows spread over their length, as many as the rules need; {budget}"),
        }
    }

    /// How much of recordings is read.
    pub(super) fn extent(&self) -> Extent {
        Extent {
            full: self.full,
            windows: self.windows,
            budget: self.budget,
            bytes: None,
        }
    }
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

/// Parts to leave out of a report for people.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Omissions {
    /// Show only findings and inputs with problems
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Show the number of findings of each rule, instead of the findings
    #[arg(long, conflicts_with = "quiet")]
    statistics: bool,
}

impl Omissions {
    pub(super) fn parts(self) -> Parts {
        match (self.quiet, self.statistics) {
            (true, _) => Parts::Findings,
            (_, true) => Parts::Statistics,
            (false, false) => Parts::All,
        }
    }
}

/// How results are reported.
#[derive(Debug, Args)]
pub(super) struct ReportOptions {
    /// Lowest severity that gives exit code 1; hints never do
    ///
    /// Default: `fail-on` of the configuration, else error.
    #[arg(long, value_enum, value_name = "SEVERITY")]
    pub(super) fail_on: Option<FailOn>,
    /// Format of the report
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: Format,
    /// Colour in the report; auto: only on a terminal, and if NO_COLOR is not set
    #[arg(long, value_enum, default_value = "auto", value_name = "WHEN")]
    pub(super) color: Color,
    /// List every check that was not evaluated, with the reason
    #[arg(short, long)]
    pub(super) verbose: bool,
    /// Show every finding, without a limit on their number
    #[arg(long)]
    pub(super) all: bool,
    #[command(flatten)]
    pub(super) less: Omissions,
    /// Write the report to a file; repeatable, one format per file
    ///
    /// The format follows from the file's extension (.sarif, .html, .json, .jsonl, .xml, .md) unless --format names another.
    /// `FORMAT=FILE` sets the format of one file (`--output sarif=frames.sarif --output junit=frames.xml`). The counts and
    /// the verdict go to standard error.
    #[arg(short, long, value_name = "[FORMAT=]FILE", value_parser = output, add = ArgValueCompleter::new(outputs))]
    pub(super) output: Vec<Output>,
    /// Overwrite existing files that are not reports
    ///
    /// With --fix: also change files that are read-only, have several names (links), or are outside the checked paths.
    /// An output never overwrites an input.
    #[arg(long)]
    pub(super) force: bool,
}

impl ReportOptions {
    /// The files to write: reports and others.
    pub(super) fn outputs<'o>(&self, others: impl IntoIterator<Item = &'o Option<PathBuf>>) -> Outputs {
        let reports = self.output.iter().map(|output| output.file.clone());
        Outputs {
            files: reports.chain(others.into_iter().flatten().cloned()).collect(),
            force: self.force,
            rewritten: None,
        }
    }

    /// The lowest severity that fails the run.
    pub(super) fn fail_on(&self, run: &Run) -> FailOn {
        self.fail_on.or(run.fail_on).unwrap_or_default()
    }

    /// The format of a report in a file.
    pub(super) fn format_of(&self, output: &Output) -> Format {
        match (output.format, self.format) {
            (None, Format::Human) => by_ending(&output.file),
            (Some(format), _) | (None, format) => format,
        }
    }

    /// Whether the report goes to a file, and only its ending to the terminal.
    pub(super) fn is_in_file(&self) -> bool {
        self.output.iter().any(|output| output.format.is_none())
    }

    /// Whether every report is written during the run.
    pub(super) fn streams(&self) -> bool {
        let mut formats = self.output.iter().map(|output| self.format_of(output));
        formats.all(|one| one == Format::JsonLines) && (self.is_in_file() || self.format == Format::JsonLines)
    }

    /// Whether a report has this format.
    pub(super) fn has(&self, format: Format) -> bool {
        let mut formats = self.output.iter().map(|output| self.format_of(output));
        (self.format == format && !self.is_in_file()) || formats.any(|one| one == format)
    }
}

/// A file for a report.
#[derive(Clone, Debug)]
pub(super) struct Output {
    /// Its format; `None`: that of `--format`.
    pub(super) format: Option<Format>,
    pub(super) file: PathBuf,
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
    #[command(flatten)]
    pub(super) input: Input,
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
