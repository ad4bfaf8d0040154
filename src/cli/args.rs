//! The arguments, as clap reads them. Help texts live here.

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
   0  clean: something was checked, and no finding counts
   1  a finding at or above --fail-on; hints never count
   2  the call or the configuration is wrong
   3  incomplete: an input could not be read in full, a requirement is not met, or nothing was checked at all
  70  a fault of frames-lint";

/// A linter and acceptance gate for the coordinate frames of robots: reads URDF, xacro, calibration files and recordings
/// together, and says what is wrong with the frames, where, and by how much.
#[derive(Debug, Parser)]
#[command(name = "frames-lint", version, after_help = EXIT_CODES, disable_help_subcommand = true)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Check files and folders
    Check(Check),
    /// Compare two platforms, or two recordings of one: which transforms, topics and clocks changed, and what explains it
    Diff(Diff),
    /// Write a configuration to begin with: who states which transform, what must be judged from now on
    Init(Init),
    /// Explain a rule: what it checks, why, how it decides, how to fix
    Explain {
        /// Code or name of the rule (TREE01, orphan-subtree)
        #[arg(add = ArgValueCandidates::new(rules))]
        rule: String,
    },
    /// List the rules
    Rules {
        /// How to list them
        #[arg(long, value_enum, default_value = "text")]
        format: RulesFormat,
    },
    /// Save what was read, to be judged later with `check --evidence`; judges nothing
    Collect(Collect),
    /// Draw the frame tree with who says what; judges nothing
    Tree(Tree),
    /// Show frames, clouds, tracks, plots and findings in the viewer of rerun.io
    View(View),
    /// Check the products of transforms in source code (C++, Python, Rust): do the frames of their names cancel?
    Chain(Chain),
    /// Write a transform in another dialect or form, with the chain that leads to it
    Convert(Convert),
    /// Write the expansion of a xacro file: what reading calls for each of them, in a process of its own
    #[command(name = engine::EXPAND_XACRO, hide = true)]
    ExpandXacro {
        /// The file
        file: PathBuf,
        /// Arguments for it
        #[arg(value_name = "NAME:=VALUE", value_parser = xacro_arg)]
        args: Vec<String>,
        /// Folder that may be read; may be repeated, and without it any may
        #[arg(long, value_name = "DIR")]
        allowed: Vec<PathBuf>,
        /// Folder that relative paths in the file start from; without it the working directory
        #[arg(long, value_name = "DIR")]
        from: Option<PathBuf>,
    },
    /// Write a completion script for a shell
    Completions {
        /// The shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Write a manual page
    Man {
        /// The verb whose page is wanted; the program's own page without it
        #[arg(add = ArgValueCandidates::new(verbs))]
        verb: Option<String>,
    },
}

#[derive(Debug, Args)]
pub(super) struct Input {
    /// Files and folders; `-` takes a list from standard input, one path a line or NUL-separated
    #[arg(required = true, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub(super) paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) reading: Reading,
}

#[derive(Clone, Debug, Args)]
pub(super) struct Reading {
    /// Argument for xacro files; may be repeated
    #[arg(long = "xacro-arg", value_name = "NAME:=VALUE", value_parser = xacro_arg)]
    pub(super) xacro_args: Vec<String>,
    /// Who expands xacro files: this program alone (own), or also the installed xacro program and the environment (run), which execute what
    /// the files say
    #[arg(long, value_name = "WHO", value_enum, default_value_t)]
    pub(super) xacro: Xacro,
    /// Let configurations that are found extend files, and take tables from files, outside of their repositories
    #[arg(long)]
    pub(super) outside: bool,
    /// Folder with message definitions (package/msg/Type.msg), for recordings that carry none; may be repeated
    #[arg(long = "msg-path", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(super) msg_paths: Vec<PathBuf>,
    /// Read recordings wholly, instead of windows spread over their length
    #[arg(long, conflicts_with_all = ["windows", "budget"])]
    pub(super) full: bool,
    /// Number of windows that a recording is read in, instead of what the rules ask for
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) windows: Option<u32>,
    /// Time until which more is read of recordings where a rule lacks evidence (30s, 2min), instead of 2 GiB of each
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration)]
    pub(super) budget: Option<std::time::Duration>,
}

/// Who expands xacro files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Xacro {
    /// This program alone, without the environment
    #[default]
    Own,
    /// The installed xacro program as well
    Run,
}

impl Reading {
    /// What the engine is asked for with these paths.
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

    /// The same in words.
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
            (true, _) => "read wholly".to_owned(),
            (false, Some(windows)) => format!("read in {windows} windows spread over their length; {budget}"),
            (false, None) => format!("read in windows spread over their length, as the rules ask for; {budget}"),
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
    /// Files and folders; `-` takes a list from standard input, one path a line or NUL-separated
    /// [default: the folder that it is called in, without --evidence]
    #[arg(value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub(super) paths: Vec<PathBuf>,
    /// Evidence saved by `collect`, judged as the files were; may be repeated, and stand beside paths
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) evidence: Vec<PathBuf>,
    /// Configuration for everything; without it each frames-lint.yaml counts for its folder and below
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    /// Show which configuration governs a file, and what it changes
    #[arg(long, value_name = "FILE", value_hint = ValueHint::AnyPath, conflicts_with_all = ["paths", "evidence"])]
    pub(super) show_settings: Option<PathBuf>,
    /// Profile that the configuration stands on
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(PROFILES.iter().map(|(name, _)| *name)))]
    pub(super) profile: Option<String>,
    /// Baseline: the findings in it are accepted, and new ones are not
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) baseline: Option<PathBuf>,
    /// Write the findings of this run to a baseline, and accept them
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) write_baseline: Option<PathBuf>,
    #[command(flatten)]
    pub(super) fixing: Fixing,
    /// Check again whenever one of the inputs changes, until interrupted
    #[arg(long, conflicts_with_all = ["fix", "unsafe_fixes", "diff", "write_baseline"])]
    pub(super) watch: bool,
    #[command(flatten)]
    pub(super) reading: Reading,
    /// Rules to run: codes, names or families, with commas between; all without it
    #[arg(long, value_name = "RULES", value_delimiter = ',', add = ArgValueCandidates::new(selectors))]
    pub(super) select: Vec<String>,
    /// Rules to leave out: codes, names or families, with commas between
    #[arg(long, value_name = "RULES", value_delimiter = ',', add = ArgValueCandidates::new(selectors))]
    pub(super) ignore: Vec<String>,
    #[command(flatten)]
    pub(super) reporting: Reporting,
    #[command(flatten)]
    pub(super) views: Views,
    /// Tell on standard error where the time goes: which inputs, which rules
    #[arg(long)]
    pub(super) timings: bool,
}

/// Views beside a report.
#[derive(Debug, Args)]
pub(super) struct Views {
    /// Write what there is to be seen to a file for the viewer of rerun.io (`rerun FILE` opens it)
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) rrd: Option<PathBuf>,
    /// How large such a file may be: what is shown is thinned until it fits (MB, or with a unit: 800kB, 2GB)
    #[arg(long, value_name = "SIZE", default_value = "100MB", value_parser = size)]
    pub(super) max_size: u64,
}

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("where").required(true).multiple(true))]
pub(super) struct View {
    #[command(flatten)]
    pub(super) input: Input,
    /// Configuration with the conventions that the files follow; without it the frames-lint.yaml nearest above the inputs
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    /// Write the views to a file (`rerun FILE` opens it)
    #[arg(short, long, value_name = "FILE", group = "where", value_hint = ValueHint::FilePath)]
    pub(super) output: Option<PathBuf>,
    /// Replace a file that is there and holds no views
    #[arg(long)]
    pub(super) force: bool,
    /// Start the viewer, the program `rerun`
    #[arg(long, group = "where")]
    pub(super) spawn: bool,
    /// Send the views to a viewer that runs (rerun+http://127.0.0.1:9876/proxy)
    #[arg(long, value_name = "URL", group = "where")]
    pub(super) connect: Option<String>,
    /// How large the views may be: what is shown is thinned until it fits (MB, or with a unit: 800kB, 2GB)
    #[arg(long, value_name = "SIZE", default_value = "100MB", value_parser = size)]
    pub(super) max_size: u64,
}

/// Which fixes are applied or shown.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Fixing {
    /// Apply the fixes that are safe, and report what is left
    #[arg(long)]
    pub(super) fix: bool,
    /// Apply the fixes that change behaviour as well
    #[arg(long)]
    pub(super) unsafe_fixes: bool,
    /// Show what would be fixed as a diff, and change nothing; with --unsafe-fixes all of it
    #[arg(long, conflicts_with = "fix")]
    pub(super) diff: bool,
}

/// What is left out of a report for people.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Less {
    /// Show findings and inputs with problems, and nothing else
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Show how many findings each rule has, instead of the findings
    #[arg(long, conflicts_with = "quiet")]
    statistics: bool,
}

impl Less {
    pub(super) fn parts(self) -> Parts {
        match (self.quiet, self.statistics) {
            (true, _) => Parts::Findings,
            (_, true) => Parts::Statistics,
            (false, false) => Parts::All,
        }
    }
}

/// How the verdict is told.
#[derive(Debug, Args)]
pub(super) struct Reporting {
    /// Findings of this severity or worse give exit code 1; hints never do [default: the configuration's `fail-on`, else error]
    #[arg(long, value_enum, value_name = "SEVERITY")]
    pub(super) fail_on: Option<FailOn>,
    /// Form of the report
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: Format,
    /// Colour in the report; auto: on a terminal, unless NO_COLOR is set
    #[arg(long, value_enum, default_value = "auto", value_name = "WHEN")]
    pub(super) color: Color,
    /// List every check that was not evaluated, with its reason
    #[arg(short, long)]
    pub(super) verbose: bool,
    /// Show every finding, however many there are
    #[arg(long)]
    pub(super) all: bool,
    #[command(flatten)]
    pub(super) less: Less,
    /// Write the report to a file, in the form that its name ends in (.sarif, .html, .json, .jsonl, .xml, .md) unless --format says
    /// another; the counts and the verdict go to standard error. With a format before the file, a report of that format besides
    /// (`--output sarif=frames.sarif --output junit=frames.xml`); may be repeated
    #[arg(short, long, value_name = "[FORMAT=]FILE", value_parser = output, add = ArgValueCompleter::new(outputs))]
    pub(super) output: Vec<Output>,
    /// Replace files that are there and are no reports; with --fix, files that may not be written, have several names or lie outside of
    /// what is checked. Inputs are never replaced by outputs
    #[arg(long)]
    pub(super) force: bool,
}

impl Reporting {
    /// The files that are written: reports, and others.
    pub(super) fn outputs<'o>(&self, others: impl IntoIterator<Item = &'o Option<PathBuf>>) -> Outputs {
        let reports = self.output.iter().map(|output| output.file.clone());
        Outputs {
            files: reports.chain(others.into_iter().flatten().cloned()).collect(),
            force: self.force,
            rewritten: None,
        }
    }

    /// From which severity on findings fail the run.
    pub(super) fn fail_on(&self, run: &Run) -> FailOn {
        self.fail_on.or(run.fail_on).unwrap_or_default()
    }

    /// The form of what goes to a file.
    pub(super) fn format_of(&self, output: &Output) -> Format {
        match (output.format, self.format) {
            (None, Format::Human) => by_ending(&output.file),
            (Some(format), _) | (None, format) => format,
        }
    }

    /// Whether the report goes to a file, and only its ending to whoever waits.
    pub(super) fn is_in_file(&self) -> bool {
        self.output.iter().any(|output| output.format.is_none())
    }

    /// Whether every report is written while the run goes on.
    pub(super) fn streams(&self) -> bool {
        let mut formats = self.output.iter().map(|output| self.format_of(output));
        formats.all(|one| one == Format::JsonLines) && (self.is_in_file() || self.format == Format::JsonLines)
    }

    /// Whether some report has this form.
    pub(super) fn has(&self, format: Format) -> bool {
        let mut formats = self.output.iter().map(|output| self.format_of(output));
        (self.format == format && !self.is_in_file()) || formats.any(|one| one == format)
    }
}

/// A file that a report goes to.
#[derive(Clone, Debug)]
pub(super) struct Output {
    /// Its form; that of `--format` where `None`.
    pub(super) format: Option<Format>,
    pub(super) file: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Chain {
    /// Files and folders with source code; `-` takes a list from standard input, one path a line or NUL-separated
    #[arg(required = true, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub(super) paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) reporting: Reporting,
}

#[derive(Debug, Args)]
pub(super) struct Convert {
    #[command(flatten)]
    pub(super) input: Input,
    /// The form (urdf, tf, matrix, quaternion, rpy) or the dialect (kalibr, vins-fusion, fast-lio, nuscenes, ...)
    #[arg(long, value_name = "FORM", value_parser = Targets)]
    pub(super) to: String,
    /// The transform that takes points of SOURCE to TARGET, over any chain; all that were read without it
    #[arg(long, num_args = 2, value_names = ["TARGET", "SOURCE"])]
    pub(super) frames: Vec<String>,
    /// The key of the dialect to write under; with --is, the key of the statement that is meant
    #[arg(long, value_name = "KEY")]
    pub(super) key: Option<String>,
    /// What a statement without frames is
    #[arg(long, value_name = "TARGET from SOURCE", value_parser = is)]
    pub(super) is: Option<(String, String)>,
    /// Configuration with the conventions that the files follow; without it the frames-lint.yaml nearest above the inputs
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    /// Write to a file instead of standard output; a name that ends in .feather makes a Feather file
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) output: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    pub(super) force: bool,
}

const DIFF_EXIT_CODES: &str = "\
Exit codes:
   0  no change
   1  changes
   2  the call or the configuration is wrong
   3  the two have nothing in common, or no change was found and an input could not be read in full
  70  a rule broke: a fault of frames-lint";

#[derive(Debug, Args)]
#[command(after_help = DIFF_EXIT_CODES)]
pub(super) struct Diff {
    /// What was there before: a file, a recording or a folder
    #[arg(value_name = "BEFORE", value_hint = ValueHint::AnyPath)]
    pub(super) before: PathBuf,
    /// What is there now
    #[arg(value_name = "AFTER", value_hint = ValueHint::AnyPath)]
    pub(super) after: PathBuf,
    /// Form of the comparison
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: DiffFormat,
    /// Configuration with the conventions that both follow; without it the frames-lint.yaml nearest above each
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) config: Option<PathBuf>,
    #[command(flatten)]
    pub(super) reading: Reading,
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
    /// Where it goes; `-` for standard output [default: frames-lint.yaml in the first folder]
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(super) output: Option<PathBuf>,
    /// Overwrite a configuration that is there
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
    /// Replace a file that is there and is no report or evidence
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct Tree {
    #[command(flatten)]
    pub(super) input: Input,
    /// Form of the drawing
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: TreeFormat,
    /// Show the trees as they are at a stamp, in the stamps' own clock: seconds, or a date and time; recordings are read
    /// wholly
    #[arg(long, value_name = "STAMP", value_parser = super::stamp::parse)]
    pub(super) at: Option<i64>,
    /// Show every transform between two frames and their product, at --at or at the latest stamp that all of them have;
    /// recordings are read wholly
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
