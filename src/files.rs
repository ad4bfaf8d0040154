//! Output files: written completely or not at all, and never over a file that was not meant.
//!
//! A file is written beside its destination, flushed to disk and moved into place; the old file stays until then, and its owner, mode
//! and extended attributes are kept. Temporary files are removed when the program is interrupted as well.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once, PoisonError};

/// The temporary files and folders that exist.
static KNOWN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Whether this module handles signals, which end the process.
static IS_PROGRAM: AtomicBool = AtomicBool::new(false);

/// Bytes at the start of a file by which a report is recognised.
const HEAD: u64 = 4096;

/// Text near the start of reports, evidence, baselines and views, for each format.
const MARKS: &[&str] = &[
    "\"schema\": \"frames-lint",
    "\"schema\":\"frames-lint",
    "\"name\": \"frames-lint\"",
    "<testsuites name=\"frames-lint\"",
    "name=\"generator\" content=\"frames-lint",
    ": frames-lint\n",
    " checks passed · ",
];

/// From now on temporary files are removed when a signal ends the process.
pub fn remove_on_signals() {
    IS_PROGRAM.store(true, Ordering::Relaxed);
}

#[cfg(unix)]
fn wait_for_signals() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    // Sent when a file exceeds a size limit: caught, so that the write fails as on a full disk.
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGHUP, SIGINT, SIGTERM, SIGXFSZ]) else {
        return;
    };
    std::thread::spawn(move || {
        if let Some(signal) = signals.forever().find(|signal| *signal != SIGXFSZ) {
            // Locked until the end, so that no new file is created.
            let known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
            for path in known.iter() {
                remove(path);
            }
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    });
}

#[cfg(not(unix))]
fn wait_for_signals() {}

fn remove(path: &Path) {
    // What cannot be removed here is removed with the system's other temporary files.
    let _ = if path.is_dir() {
        fs::remove_dir_all(path)
    } else {
        fs::remove_file(path)
    };
}

/// A file or folder that is removed when this is dropped, and when the program is interrupted.
#[derive(Debug)]
pub struct TempPath {
    path: PathBuf,
}

impl TempPath {
    /// An empty file in the system's temporary folder.
    pub fn file() -> io::Result<(Self, File)> {
        Self::file_in(&std::env::temp_dir(), "frames-lint-", 0o600)
    }

    /// An empty folder in the system's temporary folder, accessible to this user only.
    pub fn folder() -> io::Result<Self> {
        let mut builder = fs::DirBuilder::new();
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
        let make = |path: &Path| builder.create(path);
        Ok(Self::make(&std::env::temp_dir(), "frames-lint-", make)?.0)
    }

    fn file_in(folder: &Path, prefix: &str, mode: u32) -> io::Result<(Self, File)> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, mode);
        #[cfg(not(unix))]
        let _ = mode;
        Self::make(folder, prefix, |path| options.open(path))
    }

    /// Registered before it is created, so that a signal in between removes it. Its name is unique.
    fn make<T>(folder: &Path, prefix: &str, make: impl FnOnce(&Path) -> io::Result<T>) -> io::Result<(Self, T)> {
        static SIGNALS: Once = Once::new();
        if IS_PROGRAM.load(Ordering::Relaxed) {
            SIGNALS.call_once(wait_for_signals);
        }
        let path = folder.join(format!("{prefix}{:032x}", fastrand::u128(..)));
        KNOWN
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .insert(path.clone());
        let temporary = Self { path };
        let made = make(&temporary.path)?;
        Ok((temporary, made))
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for TempPath {
    fn drop(&mut self) {
        remove(&self.path);
        KNOWN.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.path);
    }
}

/// A file that is being written. It appears at its destination when it is [kept](Draft::keep).
#[derive(Debug)]
pub struct Draft {
    file: File,
    /// The temporary file and the destination; `None` if it is written directly: to a terminal, a pipe or a device.
    place: Option<(TempPath, PathBuf)>,
}

impl Draft {
    /// For the file at `path`, which may exist, also as a link.
    pub fn of(path: &Path) -> io::Result<Self> {
        let target = behind_links(path);
        let old = match fs::metadata(&target) {
            Ok(old) if old.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(old) if !old.is_file() => {
                let file = OpenOptions::new().write(true).open(&target)?;
                return Ok(Self { file, place: None });
            }
            Ok(old) => Some(old),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mode = if old.is_some() { 0o600 } else { 0o666 };
        let (temporary, file) = TempPath::file_in(folder, ".frames-lint-", mode)?;
        if let Some(old) = old {
            keep_attributes(&target, &old, &temporary.path, &file)?;
        }
        Ok(Self {
            file,
            place: Some((temporary, target)),
        })
    }

    /// Moves it to its destination and flushes it to disk.
    pub fn keep(mut self) -> io::Result<()> {
        self.file.flush()?;
        let Some((temporary, target)) = self.place else {
            return Ok(());
        };
        self.file.sync_all()?;
        fs::rename(&temporary.path, &target)?;
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
        // Some systems cannot sync a folder. The file itself is complete by then.
        let _ = File::open(folder.unwrap_or(Path::new("."))).and_then(|folder| folder.sync_all());
        Ok(())
    }

    /// The path of the temporary file, for writers that need a path.
    pub fn path(&self) -> Option<&Path> {
        self.place.as_ref().map(|(temporary, _)| temporary.path())
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Writes a file, completely or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut draft = Draft::of(path)?;
    draft.write_all(bytes)?;
    draft.keep()
}

/// The target of a link, whether it exists or not: a link stays a link.
fn behind_links(path: &Path) -> PathBuf {
    if let Ok(target) = fs::canonicalize(path) {
        return target;
    }
    match fs::read_link(path) {
        Ok(target) => path.parent().unwrap_or(Path::new("")).join(target),
        Err(_) => path.to_path_buf(),
    }
}

#[cfg(unix)]
fn keep_attributes(target: &Path, old: &fs::Metadata, new: &Path, file: &File) -> io::Result<()> {
    use std::os::unix::fs::MetadataExt;
    let made = file.metadata()?;
    if (made.uid(), made.gid()) != (old.uid(), old.gid()) {
        std::os::unix::fs::fchown(file, Some(old.uid()), Some(old.gid())).map_err(|error| {
            let what = format!("it belongs to another user or group, and the owner cannot be kept: {error}");
            io::Error::new(error.kind(), what)
        })?;
    }
    // Some systems have no extended attributes.
    for name in xattr::list(target).into_iter().flatten() {
        let value = xattr::get(target, &name)?;
        let kept = value.map_or(Ok(()), |value| xattr::set(new, &name, &value));
        // Attributes of security modules are set by the system itself.
        let is_of_system = ["security.", "trusted."].map(|space| name.to_string_lossy().starts_with(space));
        if !is_of_system.contains(&true) {
            kept?;
        }
    }
    file.set_permissions(old.permissions())
}

#[cfg(not(unix))]
fn keep_attributes(_target: &Path, old: &fs::Metadata, _new: &Path, file: &File) -> io::Result<()> {
    file.set_permissions(old.permissions())
}

/// The files that a run writes.
#[derive(Clone, Debug, Default)]
pub struct Outputs {
    /// Their paths.
    pub files: Vec<PathBuf>,
    /// Whether the user allows to overwrite files that are not reports.
    pub force: bool,
    /// The one among them that the run may also read: a baseline that is rewritten.
    pub rewritten: Option<PathBuf>,
}

impl Outputs {
    /// Whether a file is one of them, also under another name.
    pub fn contain(&self, path: &Path) -> bool {
        self.files
            .iter()
            .any(|file| identity(file).is_some_and(|own| identity(path) == Some(own)))
    }

    /// Whether a file is read and then rewritten.
    pub fn rewrite(&self, path: &Path) -> bool {
        let own = self.rewritten.as_deref().and_then(identity);
        own.is_some_and(|own| identity(path) == Some(own))
    }

    /// Why they may not be written: a folder is missing or read-only, one is an input of the run (also under another name), two are the same
    /// file, or one exists and is not a report of frames-lint. A report found in a folder is not an input: it may be replaced if it was
    /// `found`, not if it was `given`.
    pub fn refused<'p>(
        &self,
        found: impl Iterator<Item = &'p Path>,
        given: impl Iterator<Item = &'p Path>,
    ) -> Option<String> {
        let mut known: Vec<(Identity, &Path)> = Vec::new();
        for (at, file) in self.files.iter().enumerate() {
            let shown = file.display();
            let own = resolved(file);
            let same = |other: &&PathBuf| resolved(other) == own;
            let is_stream = fs::metadata(file).is_ok_and(|about| !about.is_file() && !about.is_dir());
            if !is_stream && self.files.iter().take(at).any(|other| same(&other)) {
                return Some(format!(
                    "`{shown}` is given for two outputs: write each to its own file"
                ));
            }
            if !is_stream && !may_be_replaced(file) {
                let target = resolved(&behind_links(file));
                let is_there = target.as_deref().and_then(Path::parent).is_some_and(Path::is_dir);
                let why = if is_there { "is read-only" } else { "does not exist" };
                return Some(format!("cannot write `{shown}`: its folder {why}"));
            }
            let Some(identity) = identity(file).filter(|_| !is_stream) else {
                continue;
            };
            if let Some((_, other)) = known.iter().find(|(other, _)| *other == identity) {
                return Some(format!(
                    "`{shown}` and `{}` are the same file: write each output to its own file",
                    other.display()
                ));
            }
            known.push((identity, file));
        }
        let mut inputs = given.map(|path| (path, true)).chain(found.map(|path| (path, false)));
        let input = inputs.find_map(|(input, is_given)| {
            let own = identity(input)?;
            let (_, output) = known.iter().find(|(identity, _)| *identity == own)?;
            (is_given || !is_ours(output)).then_some((input, *output))
        });
        if let Some((input, output)) = input {
            let (input, output) = (input.display(), output.display());
            return Some(format!("`{output}` is not overwritten: it is the input `{input}`"));
        }
        let (_, foreign) = known
            .iter()
            .find(|(_, file)| !is_ours(file) && (!self.force || is_source(file)))?;
        let shown = foreign.display();
        Some(if is_source(foreign) {
            format!(
                "`{shown}` exists and could be an input (by its extension): it is not overwritten, even with --force"
            )
        } else if foreign.is_dir() {
            format!("`{shown}` is a folder, not a file")
        } else {
            format!("`{shown}` exists and is not a report of frames-lint; overwrite it with --force")
        })
    }
}

/// A path with its folder resolved: identifies a file that does not exist yet.
fn resolved(path: &Path) -> Option<PathBuf> {
    let absolute = std::path::absolute(path).ok()?;
    match (absolute.parent().map(fs::canonicalize), absolute.file_name()) {
        (Some(Ok(folder)), Some(name)) => Some(folder.join(name)),
        _ => Some(absolute),
    }
}

#[cfg(unix)]
type Identity = (u64, u64);

/// Identifies an existing file under any name: device and inode.
#[cfg(unix)]
fn identity(path: &Path) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    let about = fs::metadata(path).ok()?;
    Some((about.dev(), about.ino()))
}

#[cfg(not(unix))]
type Identity = PathBuf;

#[cfg(not(unix))]
fn identity(path: &Path) -> Option<Identity> {
    fs::canonicalize(path).ok()
}

/// Whether a file is empty, or a report, evidence, a baseline or a view that frames-lint wrote.
fn is_ours(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    let head = String::from_utf8_lossy(&head);
    // Line-based formats name the rule of each finding: `error[CROSS02 extrinsic-relation]`.
    let names_rule = || head.split_whitespace().any(is_code);
    let is_view = || head.starts_with("RRF") && head.contains("frames-lint");
    let is_known = MARKS.iter().any(|mark| head.contains(mark));
    read.is_ok() && (head.is_empty() || head.trim() == "[]" || is_known || names_rule() || is_view())
}

/// Whether a file has the extension of an input. Which files an input includes or loads is known only after reading, when it is too late to
/// refuse.
fn is_source(path: &Path) -> bool {
    const ENDINGS: [&str; 14] = [
        "bag", "cfg", "db3", "idl", "launch", "mcap", "msg", "py", "sdf", "toml", "urdf", "xacro", "yaml", "yml",
    ];
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    // `init` overwrites a configuration; one that governs the run is refused as an input.
    let is_configuration = path.file_name().is_some_and(|name| name == "frames-lint.yaml");
    path.is_file()
        && !is_configuration
        && (ending.is_some_and(|ending| ENDINGS.contains(&&*ending)) || path.ends_with("package.xml"))
}

/// Whether a word ends in the code of a rule as in the findings of a report: `error[CROSS02`, `title=CROSS02`, `"CROSS02`.
fn is_code(word: &str) -> bool {
    let Some((_, code)) = word.rsplit_once(['[', '=', '"']) else {
        return false;
    };
    let letters = code.trim_end_matches(|c: char| c.is_ascii_digit());
    code.len() == letters.len() + 2 && letters.len() > 2 && letters.bytes().all(|byte| byte.is_ascii_uppercase())
}

/// Why a fix may change a file only with --force: it is read-only, has several names, or is outside of the checked paths.
pub fn unmeant(path: &Path, checked: &[PathBuf]) -> Option<String> {
    let target = fs::canonicalize(path).ok()?;
    let about = fs::metadata(&target).ok()?;
    if about.permissions().readonly() || !may_be_written(&target) {
        return Some("it is read-only".to_owned());
    }
    let names = names(&about);
    if names > 1 {
        return Some(format!(
            "it has {names} names (hard links), and the fix would change only one of them"
        ));
    }
    let is_checked = |checked: &PathBuf| fs::canonicalize(checked).is_ok_and(|checked| target.starts_with(checked));
    (!checked.iter().any(is_checked)).then(|| "it is outside of the checked paths".to_owned())
}

/// Whether a file can be made, or replaced by another: its folder exists and is writable.
pub fn may_be_replaced(path: &Path) -> bool {
    let target = resolved(&behind_links(path));
    let folder = target.as_deref().and_then(Path::parent);
    folder.is_some_and(|folder| folder.is_dir() && may_be_written(folder))
}

#[cfg(unix)]
fn may_be_written(path: &Path) -> bool {
    nix::unistd::access(path, nix::unistd::AccessFlags::W_OK).is_ok()
}

#[cfg(not(unix))]
fn may_be_written(_path: &Path) -> bool {
    true
}

#[cfg(unix)]
fn names(about: &fs::Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::nlink(about)
}

#[cfg(not(unix))]
fn names(_about: &fs::Metadata) -> u64 {
    1
}
