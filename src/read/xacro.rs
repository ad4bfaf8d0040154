//! Xacro: macro files expanded by this program in a process of its own, else by the `xacro` program if the user allows it, or read as
//! far as they need no expansion.
//!
//! Owns running either within bounds, and the messages about failures. Must not know how URDF is read.

mod marked;
pub mod own;

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use crate::source::{ExpansionPart, LineIndex, Place, ReadStatus, Source, Span};
use crate::world::Facts;

use super::allowed::AllowedFolders;
use super::urdf::{self, MeshLookup};

use self::marked::Copies;
pub use self::marked::Template;

/// How long the `xacro` program may run.
const TIMEOUT: Duration = Duration::from_secs(30);

/// How long this program may run. Real files take some milliseconds.
const OWN_TIMEOUT: Duration = Duration::from_secs(10);

/// How much it may write, bytes. The largest expansion seen in real files has half a megabyte.
const LARGEST: usize = 64 * 1024 * 1024;

/// Entries of a folder that are searched for packages.
const MOST_BESIDE: usize = 10_000;

/// Lines of its error output that are kept.
const LAST_LINES: usize = 6;

/// Why a file was not expanded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Expansion {
    /// There is no program that could expand it.
    NotInstalled,
    /// It ran and failed.
    Failed {
        /// The last lines of its error output.
        stderr: String,
        /// The one-based line of the file itself that it names, if it names one.
        line: Option<usize>,
    },
    /// It did not finish in time.
    TimedOut,
    /// Its output is too large.
    TooLarge,
}

/// The verb with which this program expands one file.
pub const VERB: &str = "expand-xacro";

/// How xacro files are expanded.
#[derive(Clone, Debug, Default)]
pub struct ExpandOptions {
    /// This program, which expands a file when it is called with [`VERB`]; without it there is only the `xacro` program.
    pub own: Option<PathBuf>,
    /// Arguments of the form `name:=value`.
    pub args: Vec<String>,
    /// Whether files may use the environment, and the `xacro` program is run if this one cannot expand one: it executes what files
    /// contain, and reads the files they name.
    pub run: bool,
    /// Folders of files that may be included, besides packages.
    pub allowed: AllowedFolders,
}

/// Expands a xacro file; packages that it names are searched among `packages` and around the file. No shell is involved.
///
/// # Errors
///
/// [`Expansion`] states why there is no expansion; [`Expansion::report`] reports it to the user.
pub fn expand(
    path: &Path,
    means: &ExpandOptions,
    packages: &BTreeMap<String, PathBuf>,
) -> Result<ExpandedFile, Expansion> {
    let is_argument = |arg: &&String| !arg.starts_with('-') && arg.contains(":=");
    if let Some(odd) = means.args.iter().find(|arg| !is_argument(arg)) {
        // Anything else would be an option of the program, which can write files.
        return Err(Expansion::failed(format!(
            "`{odd}` is not an argument of the form name:=value"
        )));
    }
    // A path may begin with a dash.
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let packages = around(&path, packages);
    let allowed = means.allowed.clone().with(packages.values().map(PathBuf::as_path));
    let copies = Copies::new(&path, &packages, &allowed);
    let top = copies.as_ref().map(Copies::top);
    let top = top.as_deref().unwrap_or(&path);
    let own = means.own.as_ref().map(|program| {
        let mut command = Command::new(program);
        if !means.run {
            // A file must not be able to put this machine's environment into a report.
            command.env_clear();
        }
        command.arg(VERB).env("RUST_XACRO_PACKAGE_MAP", listed(&packages));
        // The allocator reserves 1 GiB of addresses otherwise, which the limit of the child could not tell from memory.
        command.env("MIMALLOC_ARENA_RESERVE", "65536");
        if let Some(folder) = path.parent() {
            // The child changes its folder itself: with `current_dir` a statically linked program is started by `fork`, which copies its memory map.
            command.arg("--from").arg(folder);
        }
        let folders = allowed.folders().iter().map(PathBuf::as_path).chain(top.parent());
        for folder in folders {
            command.arg("--allowed").arg(folder);
        }
        expand_by(command, top, &means.args, OWN_TIMEOUT)
    });
    let by_program = |path: &Path| match program().filter(|_| means.run) {
        Some(program) => expand_by(Command::new(program), path, &means.args, TIMEOUT),
        None => Err(Expansion::NotInstalled),
    };
    let expanded = match own.unwrap_or(Err(Expansion::NotInstalled)) {
        Err(failure @ (Expansion::NotInstalled | Expansion::Failed { .. })) => match by_program(top) {
            Err(Expansion::NotInstalled) => Err(failure),
            // Files that it loads by a path from its own folder are not next to the copy.
            Err(_) if top != path => return by_program(&path).map(ExpandedFile::plain),
            expanded => expanded,
        },
        expanded => expanded,
    };
    match (expanded, copies) {
        (Ok(marked), Some(copies)) => {
            let (text, written, templates) = copies.unmarked(&marked);
            Ok(ExpandedFile {
                text,
                written,
                templates,
            })
        }
        (Ok(text), None) => Ok(ExpandedFile::plain(text)),
        (Err(Expansion::Failed { stderr, line }), Some(copies)) => Err(Expansion::Failed {
            stderr: copies.with_files(&stderr),
            line,
        }),
        (Err(failure), _) => Err(failure),
    }
}

/// The expansion of a xacro file.
#[derive(Clone, Debug, Default)]
pub struct ExpandedFile {
    /// The URDF.
    pub text: String,
    /// Where its parts are written; ids of sources are numbers of templates. Empty if not known.
    pub written: Vec<ExpansionPart>,
    /// The file itself, and those that it includes.
    pub templates: Vec<Template>,
}

impl ExpandedFile {
    fn plain(text: String) -> Self {
        Self {
            text,
            ..Self::default()
        }
    }
}

/// The `xacro` program: in an absolute folder of the path, for a relative one may contain checked files.
fn program() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let absolute = std::env::split_paths(&folders).filter(|folder| folder.is_absolute());
    let names: &[&str] = if cfg!(windows) {
        &["xacro.exe", "xacro.bat"]
    } else {
        &["xacro"]
    };
    absolute
        .flat_map(|folder| names.iter().map(move |name| folder.join(name)))
        .find(|program| program.is_file())
}

fn expand_by(mut command: Command, path: &Path, args: &[String], timeout: Duration) -> Result<String, Expansion> {
    command.arg(path).args(args).env("PYTHONIOENCODING", "utf-8");
    match run(command, timeout, LARGEST)? {
        Output {
            success: true, stdout, ..
        } => String::from_utf8(stdout).map_err(|_| Expansion::failed("the expansion is not UTF-8".to_owned())),
        Output { stderr, .. } => {
            let stderr = String::from_utf8_lossy(&stderr).into_owned();
            let line = line_of(&stderr, path);
            let kept: Vec<&str> = stderr.lines().filter(|line| !line.trim().is_empty()).collect();
            let last = kept.get(kept.len().saturating_sub(LAST_LINES)..).unwrap_or_default();
            Err(Expansion::Failed {
                stderr: last.join("\n"),
                line,
            })
        }
    }
}

/// Folders of packages by name: the one that the file belongs to, its neighbours, and those of the input that have other names.
fn around(path: &Path, packages: &BTreeMap<String, PathBuf>) -> BTreeMap<String, PathBuf> {
    let is_package = |folder: &Path| folder.join("package.xml").is_file();
    let absolute = |folder: &PathBuf| std::path::absolute(folder).unwrap_or_else(|_| folder.clone());
    let of_input = packages.iter().map(|(name, folder)| (name.clone(), absolute(folder)));
    let mut found: BTreeMap<String, PathBuf> = of_input.collect();
    if let Some(package) = path.ancestors().skip(1).find(|folder| is_package(folder)) {
        let beside = package.parent().and_then(|folder| folder.read_dir().ok());
        let beside = beside.into_iter().flatten().take(MOST_BESIDE).flatten();
        let folders = beside.map(|entry| entry.path()).filter(|folder| is_package(folder));
        found.extend(folders.filter_map(|folder| Some((named(&folder)?, folder))));
        found.extend(named(package).map(|name| (name, package.to_owned())));
        let manifest = std::fs::read_to_string(package.join("package.xml")).unwrap_or_default();
        let said = manifest
            .split_once("<name>")
            .and_then(|(_, rest)| rest.split_once("</name>"));
        found.extend(said.map(|(name, _)| (name.trim().to_owned(), package.to_owned())));
    }
    found
}

fn named(folder: &Path) -> Option<String> {
    Some(folder.file_name()?.to_string_lossy().into_owned())
}

/// The packages in the form of the environment variable: `name=folder`, one after the other.
fn listed(packages: &BTreeMap<String, PathBuf>) -> String {
    let entries = packages
        .iter()
        .map(|(name, folder)| format!("{name}={}", folder.display()));
    entries.collect::<Vec<_>>().join(if cfg!(windows) { ";" } else { ":" })
}

/// Reads the elements of a xacro file that need no expansion: links and joints with literal names, outside of
/// macros and inside, and claims of joints whose numbers are literal. The robot is a fragment.
pub fn read_unexpanded(source: &mut Source, meshes: &MeshLookup) -> Facts {
    urdf::read_unexpanded(source, meshes)
}

impl Expansion {
    fn failed(stderr: String) -> Self {
        Self::Failed { stderr, line: None }
    }

    /// Records on the source that it was not expanded, why, and what to do. Elements that need no expansion can still be read.
    pub fn report(&self, source: &mut Source) {
        let (message, help) = match self {
            Self::NotInstalled => (
                "the xacro was not expanded: no xacro processor is available here".to_owned(),
                "use the program `frames-lint`, or check the expanded URDF".to_owned(),
            ),
            Self::TimedOut => (
                format!(
                    "the xacro was not expanded: expansion did not finish within {} s",
                    OWN_TIMEOUT.as_secs()
                ),
                "expand it by hand, and check the expanded URDF".to_owned(),
            ),
            Self::TooLarge => (
                format!("the xacro was not expanded: its expansion exceeds {} MB", LARGEST >> 20),
                "look for a macro that calls itself".to_owned(),
            ),
            Self::Failed { stderr, .. } => failure(stderr, &source.text),
        };
        let place = self.place(source);
        source.problem_with_help(ReadStatus::Partial, place, message, Some(help));
    }

    fn place(&self, source: &Source) -> Place {
        let Self::Failed { stderr, line } = self else {
            return Place::whole(source.id);
        };
        let index = LineIndex::new(&source.text);
        let named = line
            .and_then(|line| index.line_start(line.saturating_sub(1)))
            .map(|start| {
                let rest = source.text.get(start..).unwrap_or_default();
                Span::new(start, start + rest.lines().next().map_or(0, str::len))
            });
        let first_find = || source.text.find("$(find ").filter(|_| lacks_packages(stderr));
        let missing = || {
            let start = first_find()?;
            let length = source.text.get(start..)?.find(')')? + 1;
            Some(Span::new(start, start + length))
        };
        named
            .or_else(missing)
            .map_or_else(|| Place::whole(source.id), |span| Place::text(source.id, span))
    }
}

/// The message about the failure, and what to do.
fn failure(stderr: &str, text: &str) -> (String, String) {
    if lacks_packages(stderr) {
        let named = stderr
            .split_once("package '")
            .and_then(|(_, rest)| rest.split('\'').next());
        let packages = named.map_or_else(|| packages(text), |name| vec![name]);
        let message = match packages.as_slice() {
            [] => format!(
                "the xacro was not expanded: a package was not found ({})",
                complaint(stderr)
            ),
            names => format!("the xacro was not expanded: it needs {}", list(names)),
        };
        let help = "check the folder with these packages too, or expand it in its ROS workspace and check the expanded URDF; \
                    pass a path that is an argument with --xacro-arg name:=value";
        return (message, help.to_owned());
    }
    let message = format!("the xacro was not expanded: {}", complaint(stderr));
    let undefined = stderr.lines().find_map(|line| {
        line.split_once("Undefined substitution argument ")
            .map(|(_, name)| name.trim())
    });
    let own = stderr.lines().find_map(|line| line.strip_prefix("help: "));
    let help = match (undefined, own) {
        (Some(name), _) => format!("pass --xacro-arg {name}:=<value>"),
        (None, Some(own)) => own.to_owned(),
        (None, None) => {
            "run `xacro` on the file to see the error; pass arguments with --xacro-arg name:=value".to_owned()
        }
    };
    (message, help)
}

/// Whether the error is that packages cannot be found.
fn lacks_packages(stderr: &str) -> bool {
    [
        "ament_index_python",
        "rospkg",
        "PackageNotFoundError",
        "package '",
        "ResourceNotFound",
    ]
    .iter()
    .any(|sign| stderr.contains(sign))
}

/// The most informative line of the error output.
fn complaint(stderr: &str) -> String {
    let said = stderr
        .lines()
        .rev()
        .find(|line| line.starts_with("error:") || line.starts_with("XML parsing error:"))
        .or_else(|| stderr.lines().rev().find(|line| line.contains("Exception: ")))
        .or_else(|| stderr.lines().rev().find(|line| !line.starts_with("when ")))
        .unwrap_or("it gave no reason");
    let said = said.strip_prefix("error:").unwrap_or(said).trim();
    match stderr
        .lines()
        .find_map(|line| line.strip_prefix("when processing file: "))
    {
        Some(file) => format!("{said} (in {})", file.trim()),
        None => said.to_owned(),
    }
}

/// Names in `$(find name)`, each once, in the order of the text.
fn packages(text: &str) -> Vec<&str> {
    let mut names = Vec::new();
    for rest in text.split("$(find ").skip(1) {
        let name = rest.split(')').next().unwrap_or_default().trim();
        if !name.is_empty() && name.len() < 100 && !names.contains(&name) && names.len() < 20 {
            names.push(name);
        }
    }
    names
}

fn list(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    let noun = if names.len() == 1 { "package" } else { "packages" };
    format!("the {noun} {}, which cannot be found here", quoted.join(", "))
}

/// The line that an error names, if it is about the file itself and not about one it includes.
fn line_of(stderr: &str, path: &Path) -> Option<usize> {
    let about = stderr
        .lines()
        .find_map(|line| line.strip_prefix("when processing file: "))?;
    if Path::new(about.trim()) != path {
        return None;
    }
    let (_, rest) = stderr.split_once("line ")?;
    let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok()
}

struct Output {
    success: bool,
    stdout: Vec<u8>,
    stderr: Vec<u8>,
}

/// Runs a program within bounds of time and output.
fn run(mut command: Command, timeout: Duration, largest: usize) -> Result<Output, Expansion> {
    let deadline = Instant::now() + timeout;
    // A group of its own, so that its children end with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let spawned = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = spawned.map_err(|error| match error.kind() {
        ErrorKind::NotFound => Expansion::NotInstalled,
        _ => Expansion::Failed {
            stderr: format!("`xacro` could not be started: {error}"),
            line: None,
        },
    })?;
    let stdout = child.stdout.take().map(|pipe| reader(pipe, largest));
    let stderr = child.stderr.take().map(|pipe| reader(pipe, largest));
    let finished = collect(stdout, deadline).and_then(|stdout| {
        if stdout.len() > largest {
            return Err(Expansion::TooLarge);
        }
        let stderr = collect(stderr, deadline)?;
        loop {
            match child.try_wait() {
                Ok(Some(status)) if status.code().is_none() => {
                    return Err(Expansion::failed(
                        "error: expansion was stopped: it is nested too deep, or takes too much memory".to_owned(),
                    ));
                }
                Ok(Some(status)) => {
                    return Ok(Output {
                        success: status.success(),
                        stdout,
                        stderr,
                    });
                }
                Ok(None) if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(5)),
                _ => return Err(Expansion::TimedOut),
            }
        }
    });
    if finished.is_err() {
        // It may have ended in the meantime; then there is nothing to kill.
        let _ = child.kill();
        #[cfg(unix)]
        if let Ok(group) = i32::try_from(child.id()) {
            let _ = nix::sys::signal::killpg(nix::unistd::Pid::from_raw(group), nix::sys::signal::Signal::SIGKILL);
        }
        let _ = child.wait();
    }
    finished
}

/// Reads a pipe on a thread of its own, up to one byte more than `largest`.
fn reader(pipe: impl Read + Send + 'static, largest: usize) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // After a broken pipe, the bytes before it are used.
        let _ = pipe.take(largest as u64 + 1).read_to_end(&mut bytes);
        let _ = sender.send(bytes);
    });
    receiver
}

fn collect(pipe: Option<Receiver<Vec<u8>>>, deadline: Instant) -> Result<Vec<u8>, Expansion> {
    let Some(pipe) = pipe else { return Ok(Vec::new()) };
    let left = deadline.saturating_duration_since(Instant::now());
    match pipe.recv_timeout(left) {
        Ok(bytes) => Ok(bytes),
        Err(RecvTimeoutError::Timeout) => Err(Expansion::TimedOut),
        Err(RecvTimeoutError::Disconnected) => Ok(Vec::new()),
    }
}

#[cfg(test)]
#[path = "xacro_tests.rs"]
mod tests;
