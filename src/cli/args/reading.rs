//! Arguments on what is read, and how much of it.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};

use crate::engine::{self, Extent};

use super::super::Surroundings;
use super::values::xacro_arg;

#[derive(Clone, Debug, Args)]
pub(in crate::cli) struct ReadOptions {
    /// Argument for xacro files; repeatable
    #[arg(long = "xacro-arg", value_name = "NAME:=VALUE", value_parser = xacro_arg)]
    pub(in crate::cli) xacro_args: Vec<String>,
    /// Who expands xacro files: frames-lint alone, or also the installed xacro
    ///
    /// The installed xacro program executes code in the files it expands: use `run` only with files that you trust.
    #[arg(long, value_name = "WHO", value_enum, default_value_t)]
    pub(in crate::cli) xacro: Xacro,
    /// Allow configurations to refer to files outside their repository
    ///
    /// Concerns configurations found beside the inputs: their `extends` and their tables. Not allowed by default.
    #[arg(long)]
    pub(in crate::cli) outside: bool,
    /// Folder with message definitions (package/msg/Type.msg); repeatable
    ///
    /// Needed for recordings that contain no definitions of their message types.
    #[arg(long = "msg-path", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(in crate::cli) msg_paths: Vec<PathBuf>,
    /// Read recordings completely, instead of in windows spread over their length
    #[arg(long, conflicts_with_all = ["windows", "budget"])]
    pub(in crate::cli) full: bool,
    /// Number of windows to read of each recording (default: as many as the rules need)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(in crate::cli) windows: Option<u32>,
    /// Time limit for reading more of recordings (30s, 2min; default: none)
    ///
    /// More is read where a rule lacks evidence. Without a time limit, up to 2 GiB of each recording are read.
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration)]
    pub(in crate::cli) budget: Option<std::time::Duration>,
}

/// Programs that may expand xacro files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Xacro {
    /// frames-lint alone, without environment variables
    #[default]
    Own,
    /// Also the installed xacro program, with environment variables
    Run,
}

impl ReadOptions {
    /// The engine's options for these paths.
    pub(in crate::cli) fn options(self, paths: Vec<PathBuf>, surroundings: Surroundings) -> engine::Options {
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
    pub(in crate::cli) fn extent_words(&self) -> String {
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
    pub(in crate::cli) fn extent(&self) -> Extent {
        Extent {
            full: self.full,
            windows: self.windows,
            budget: self.budget,
            bytes: None,
        }
    }
}
