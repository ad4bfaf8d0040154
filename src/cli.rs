//! The command line: parses arguments, calls the module that does the work, and returns an [`Answer`]. No logic of its own.
//!
//! Reads standard input for `-` and writes the files of `--output`. `main` prints the answer.

mod args;
mod assure;
mod call;
mod check;
mod completions;
mod convert;
mod diff;
mod fixes;
mod init;
mod stamp;
mod stream;
#[cfg(test)]
mod tests;
mod tree;
mod view;
pub mod watch;

use std::ffi::OsString;
use std::fmt::Write;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};

use clap::{CommandFactory, Parser};

use crate::engine::{self, UsageError, evidence};
use crate::files::{self, Outputs};
use crate::page::Page;
use crate::report::{ReportError, Style, explain, rules_table, terminal};
use crate::rules::RULES;
use crate::run::{EXIT_CLEAN, EXIT_CRASHED, EXIT_USAGE, Run};
use crate::visible::clean;

use args::{Cli, Collect, RulesFormat, Verb};

/// The result of a command: texts for standard output and standard error, and the exit code.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// For standard output.
    pub out: String,
    /// For standard error.
    pub err: String,
    /// The exit code.
    pub code: u8,
    /// Files and folders to watch: the command runs again when one of them changes.
    pub watched: Vec<PathBuf>,
}

impl Answer {
    /// Inputs that could not be read, on standard error without colour, and the exit code that follows from them.
    fn of_reading(run: &Run, surroundings: Surroundings) -> Self {
        let style = Style {
            color: false,
            ..surroundings.style
        };
        Self {
            err: terminal::render_unread(run, style),
            code: run.exit_code_of_reading(),
            ..Self::default()
        }
    }
}

/// Properties of the terminal and the process.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// What standard output can show.
    pub style: Style,
    /// Whether standard error is a terminal.
    pub progress: bool,
    /// Whether this process is the frames-lint program, which can be started again, and not a user of the library.
    pub is_program: bool,
}

impl Surroundings {
    /// Those of this process: colour on a terminal unless `NO_COLOR` is set or the terminal is dumb.
    pub fn detect() -> Self {
        let is_terminal = std::io::stdout().is_terminal();
        let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        Self {
            style: Style {
                color: is_terminal && !set("NO_COLOR") && !dumb,
                unicode: !is_terminal || supports_unicode::supports_unicode(),
                width: is_terminal.then(width).flatten(),
                links: supports_hyperlinks::on(supports_hyperlinks::Stream::Stdout),
            },
            progress: std::io::stderr().is_terminal(),
            is_program: true,
        }
    }

    fn xacro(self, args: Vec<String>, run: bool) -> engine::XacroOptions {
        engine::XacroOptions {
            own: self.is_program.then(std::env::current_exe).and_then(Result::ok),
            args,
            run,
            ..engine::XacroOptions::default()
        }
    }
}

/// Columns of the terminal: `COLUMNS` if it is set, else its size.
fn width() -> Option<usize> {
    let columns = std::env::var("COLUMNS")
        .ok()
        .and_then(|columns| columns.trim().parse().ok());
    let columns = columns.filter(|columns| *columns > 0);
    columns.or_else(|| terminal_size::terminal_size().map(|(width, _)| usize::from(width.0)))
}

/// Why a command failed.
enum Failure {
    /// A wrong call.
    Usage(String),
    /// A bug in frames-lint.
    Ours(String),
}

impl From<Failure> for Answer {
    fn from(failure: Failure) -> Self {
        let (err, code) = match failure {
            Failure::Usage(message) => (format!("error: {message}\n"), EXIT_USAGE),
            Failure::Ours(message) => (format!("frames-lint: internal error: {message}\n"), EXIT_CRASHED),
        };
        Self {
            err,
            code,
            ..Self::default()
        }
    }
}

impl From<UsageError> for Failure {
    fn from(error: UsageError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        Self::Ours(error.to_string())
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self::Ours(error.to_string())
    }
}

/// Runs a command line, which begins with the program's name.
pub fn run(arguments: impl IntoIterator<Item = OsString>, stdin: &mut dyn Read, surroundings: Surroundings) -> Answer {
    let mut early = Vec::new();
    let mut answer = run_to(arguments, stdin, &mut early, surroundings);
    answer.out.insert_str(0, &String::from_utf8_lossy(&early));
    answer
}

/// Like [`run`], but reports of lines (`json-lines`) are written to `stdout` during the run.
pub fn run_to(
    arguments: impl IntoIterator<Item = OsString>,
    stdin: &mut dyn Read,
    stdout: &mut dyn std::io::Write,
    surroundings: Surroundings,
) -> Answer {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    if let Some(words) = completions::asked(&arguments) {
        return words.unwrap_or_else(Answer::from);
    }
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(error) => return refuse(&error, &arguments, surroundings),
    };
    let answer = match cli.verb {
        Verb::Check(check) => check::run(check, &arguments, (stdin, stdout), surroundings),
        Verb::Collect(collect) => run_collect(collect, stdin, surroundings),
        Verb::Tree(tree) => tree::run(tree, stdin, surroundings),
        Verb::Chain(chain) => check::chain(chain, &arguments, stdin, surroundings),
        Verb::Convert(convert) => convert::run(convert, stdin, surroundings),
        Verb::Assure(asked) => assure::run(asked, stdin, surroundings),
        Verb::Diff(diff) => diff::run(&diff, surroundings),
        Verb::Init(init) => init::run(init, stdin, surroundings),
        Verb::View(view) => view::run(view, stdin, surroundings),
        Verb::Explain { rule } => run_explain(&rule, surroundings.style),
        Verb::Rules { format } => run_rules(format, surroundings.style),
        Verb::Completions { shell } => {
            completions::script(shell, arguments.first().map_or("".as_ref(), OsString::as_os_str))
        }
        Verb::ExpandXacro {
            file,
            args,
            allowed,
            from,
        } => Ok(match engine::expand_xacro(&file, &args, &allowed, from.as_deref()) {
            Ok(out) => Answer {
                out,
                ..Answer::default()
            },
            Err(said) => Answer {
                err: format!("{said}\n"),
                code: EXIT_USAGE,
                ..Answer::default()
            },
        }),
        Verb::Man { verb } => man(verb.as_deref()),
    };
    answer.unwrap_or_else(Answer::from)
}

/// Help and version are answers; any other error is a wrong call. A path without a command gets a hint.
fn refuse(error: &clap::Error, arguments: &[OsString], surroundings: Surroundings) -> Answer {
    let rendered = error.render();
    let text = if surroundings.style.color {
        rendered.ansi().to_string()
    } else {
        rendered.to_string()
    };
    if !error.use_stderr() {
        return Answer {
            out: text,
            ..Answer::default()
        };
    }
    let mut err = text;
    let first = arguments.get(1).map(|argument| argument.to_string_lossy().into_owned());
    if let (clap::error::ErrorKind::InvalidSubcommand, Some(first)) = (error.kind(), first) {
        let _ = writeln!(err, "\nTo check files, use: frames-lint check {first}");
    }
    Answer {
        err,
        code: EXIT_USAGE,
        ..Answer::default()
    }
}

/// Writes the output of a command to the file that the user named.
fn save(file: &Path, made: impl AsRef<[u8]>) -> Result<(), Failure> {
    files::write(file, made.as_ref())
        .map_err(|error| Failure::Usage(format!("cannot write `{}`: {error}", file.display())))
}

fn run_collect(collect: Collect, stdin: &mut dyn Read, surroundings: Surroundings) -> Result<Answer, Failure> {
    let paths = paths(collect.input.paths, stdin)?;
    let options = engine::Options {
        outputs: Outputs {
            files: collect.output.iter().chain(&collect.clouds).cloned().collect(),
            force: collect.force,
            ..Outputs::default()
        },
        ..collect.input.reading.options(paths, surroundings)
    };
    if let Some(file) = &collect.clouds {
        let (bytes, topic, count) = engine::cloud(&options, collect.topic.as_deref())?;
        save(file, bytes)?;
        if collect.output.is_none() {
            return Ok(Answer {
                err: clean(&format!("`{}`: {count} points of `{topic}`\n", file.display())).into_owned(),
                ..Answer::default()
            });
        }
    }
    let run = engine::collect(&options)?;
    let mut out = evidence::write(&run)?;
    if let Some(file) = collect.output {
        save(&file, std::mem::take(&mut out))?;
    }
    Ok(Answer {
        out,
        ..Answer::of_reading(&run, surroundings)
    })
}

fn run_explain(word: &str, style: Style) -> Result<Answer, Failure> {
    let mut known = Vec::new();
    for entry in RULES {
        let page = entry.page;
        if [page.code, page.name]
            .iter()
            .any(|name| name.eq_ignore_ascii_case(word))
        {
            return Ok(Answer {
                out: explain::render(page, style),
                code: EXIT_CLEAN,
                ..Answer::default()
            });
        }
        known.extend([page.code, page.name]);
    }
    let meant = engine::nearest(word, &known).map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
    Err(Failure::Usage(format!(
        "no rule is called `{word}`{meant}\n`frames-lint rules` lists all rules"
    )))
}

/// The pages of all rules.
pub fn rules() -> Vec<&'static Page> {
    RULES.iter().map(|entry| entry.page).collect()
}

fn run_rules(format: RulesFormat, style: Style) -> Result<Answer, Failure> {
    let rules = rules();
    let out = match format {
        RulesFormat::Text => rules_table::text(&rules, style),
        RulesFormat::Json => rules_table::json(&rules)?,
        RulesFormat::Markdown => rules_table::markdown(&rules),
    };
    Ok(Answer {
        out,
        ..Answer::default()
    })
}

fn man(verb: Option<&str>) -> Result<Answer, Failure> {
    let mut command = Cli::command();
    command.build();
    let command = match verb {
        None => command,
        Some(verb) => {
            let found = command.find_subcommand(verb).cloned();
            found.ok_or_else(|| Failure::Usage(format!("no command is called `{verb}`")))?
        }
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut text)
        .map_err(|error| Failure::Ours(error.to_string()))?;
    Ok(Answer {
        out: String::from_utf8_lossy(&text).into_owned(),
        ..Answer::default()
    })
}

/// The paths of the command line, with the list on standard input in place of `-`.
fn paths(given: Vec<PathBuf>, stdin: &mut dyn Read) -> Result<Vec<PathBuf>, Failure> {
    let mut paths = Vec::new();
    let mut has_read = false;
    for path in given {
        if path.as_os_str() != "-" {
            paths.push(path);
        } else if !std::mem::replace(&mut has_read, true) {
            let mut list = Vec::new();
            stdin
                .read_to_end(&mut list)
                .map_err(|error| Failure::Usage(format!("cannot read the list of paths on standard input: {error}")))?;
            paths.extend(listed(&list)?);
        }
    }
    if paths.is_empty() {
        return Err(Failure::Usage(
            "the list of paths on standard input is empty".to_owned(),
        ));
    }
    Ok(paths)
}

/// The paths of the command line; without any, and without evidence, the working directory.
fn paths_or_here(given: Vec<PathBuf>, evidence: &[PathBuf], stdin: &mut dyn Read) -> Result<Vec<PathBuf>, Failure> {
    match (given.is_empty(), evidence.is_empty()) {
        (true, true) => Ok(vec![PathBuf::from(".")]),
        (true, false) => Ok(Vec::new()),
        (false, _) => paths(given, stdin),
    }
}

/// NUL-separated paths if there is a NUL (`git ls-files -z`, `find -print0`), else one path per line.
fn listed(list: &[u8]) -> Result<Vec<PathBuf>, Failure> {
    let separator = if list.contains(&0) { 0 } else { b'\n' };
    list.split(|byte| *byte == separator)
        .map(|item| {
            if separator == b'\n' {
                item.strip_suffix(b"\r").unwrap_or(item)
            } else {
                item
            }
        })
        .filter(|item| !item.is_empty())
        .map(|item| path_from(item).ok_or_else(|| Failure::Usage("a path on standard input is not UTF-8".to_owned())))
        .collect()
}

#[cfg(unix)]
#[allow(clippy::unnecessary_wraps)] // other systems can refuse
fn path_from(bytes: &[u8]) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    Some(PathBuf::from(std::ffi::OsStr::from_bytes(bytes)))
}

#[cfg(not(unix))]
fn path_from(bytes: &[u8]) -> Option<PathBuf> {
    std::str::from_utf8(bytes).ok().map(PathBuf::from)
}
