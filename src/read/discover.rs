//! Finds the files of a run and recognises what each one is, by content and by name.
//!
//! Owns the walk over folders and the recognition of kinds. Must not read more of a file than its first bytes.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use ignore::WalkBuilder;

use crate::read::calibration::plain;
use crate::read::{code, feather, launch, points, text};
use crate::source::SourceKind;

use super::bag::{Container, metadata};
use super::input::{Input, ending};
use super::packets::Correction;
use super::recordings;

/// The name of frames-lint's own configuration, which is not a calibration file.
pub const CONFIGURATION: &str = "frames-lint.yaml";

/// All files of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Files to read, in a fixed order.
    pub files: Vec<Input>,
    /// Files in folders that no reader can use, counted by ending.
    pub skipped: BTreeMap<String, usize>,
    /// Files with the corrections of an AT128, by the group of inputs that they came with: packets in recordings need them.
    pub corrections: Vec<(usize, PathBuf)>,
    /// Folders with a `package.xml`, in the order in which they were found.
    pub packages: Vec<PathBuf>,
}

impl Inputs {
    /// Folders of packages by name (the folder's name); of several with one name, the one that has the most folders in common with a file.
    pub fn packages_near(&self, file: &Path) -> BTreeMap<String, PathBuf> {
        let common = |folder: &Path| {
            let same = folder.components().zip(file.components()).take_while(|(a, b)| a == b);
            same.count()
        };
        let mut near: BTreeMap<String, PathBuf> = BTreeMap::new();
        for folder in &self.packages {
            let Some(name) = folder.file_name() else { continue };
            let name = name.to_string_lossy().into_owned();
            if near.get(&name).is_none_or(|known| common(folder) > common(known)) {
                near.insert(name, folder.clone());
            }
        }
        near
    }
}

/// Formats that may state transforms but have no reader: listed in the report, never ignored silently.
const UNREAD_FORMATS: &[(&str, &str)] = &[
    ("py", "not a launch file of ROS 2"),
    ("srdf", "SRDF is not read: it has no transforms of its own"),
    ("sdf", "SDF is not read"),
    ("world", "Gazebo worlds are not read"),
    ("lua", "not a Lua file of Cartographer"),
    ("ini", "not an ini file with sensors of MRPT"),
    ("info", "not an info file with cameras of ROVIO"),
    ("feather", "not a feather table of version 2"),
    ("csv", "not a table of transforms"),
    ("txt", "plain text in an unknown form"),
    ("conf", "configuration files of this format are not read"),
    ("cfg", "configuration files of this format are not read"),
    ("toml", "TOML files are not read"),
    ("xml", "this XML is not a robot description"),
];

/// How a file with the corrections of an AT128 is listed: it is read only for a recording with its packets.
const CORRECTION: &str = "AT128 correction (for its packets only)";

/// Which files are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileSelection {
    /// Descriptions, calibrations, launch files and recordings.
    #[default]
    Facts,
    /// Source code.
    Code,
}

/// Collects the files under `paths`. A path that does not exist becomes an input with that problem.
pub fn discover(paths: &[PathBuf]) -> Inputs {
    discover_of(paths, FileSelection::Facts)
}

/// The same for files of one sort. The order of the paths does not matter.
pub fn discover_of(paths: &[PathBuf], wanted: FileSelection) -> Inputs {
    let mut inputs = Inputs::default();
    let paths: BTreeSet<&PathBuf> = paths.iter().collect();
    for (index, path) in paths.into_iter().enumerate() {
        if path.is_dir() {
            walk(path, index + 1, wanted, &mut inputs);
        } else {
            inputs.files.push(named_file(path, wanted));
        }
    }
    once(&mut inputs.files);
    recordings::join(&mut inputs.files);
    inputs
}

/// Keeps each file once, however its path is spelled: read twice, a robot would contradict or confirm itself. A file
/// that is also part of a folder stays with the folder.
fn once(files: &mut Vec<Input>) {
    let mut kept: BTreeMap<PathBuf, usize> = BTreeMap::new();
    let mut unique: Vec<Input> = Vec::with_capacity(files.len());
    for input in files.drain(..) {
        let identity = std::fs::canonicalize(&input.path).unwrap_or_else(|_| input.path.clone());
        let known = kept.get(&identity).copied().and_then(|index| unique.get_mut(index));
        match known {
            None => {
                kept.insert(identity, unique.len());
                unique.push(input);
            }
            Some(known) if known.group == LOOSE && input.group != LOOSE => *known = input,
            Some(_) => {}
        }
    }
    *files = unique;
}

/// Clouds of a folder that are read.
const MAX_CLOUDS: usize = 5;

/// The group of files that were named one by one.
const LOOSE: usize = 0;

/// A file the user named: the report always shows what became of it.
fn named_file(path: &Path, wanted: FileSelection) -> Input {
    let root = path.parent().unwrap_or(Path::new(""));
    let mut input = met(path, root, LOOSE, SourceKind::Unsupported);
    match first_bytes(path) {
        Err(error) => {
            input.kind = kind_of_name(path).unwrap_or(SourceKind::Unsupported);
            input.refusal = Some(format!("cannot be opened: {error}"));
        }
        Ok(_) if wanted == FileSelection::Code => {
            if code::is_code(&ending(path)) {
                input.kind = SourceKind::Code;
            } else {
                input.refusal = Some("not source code in C++, Python or Rust".to_owned());
            }
        }
        Ok(head) => match recognise(path, &head) {
            _ if own_document(&head).is_some() => input.refusal = own_document(&head).map(str::to_owned),
            Some(kind) => input.kind = kind,
            None => {
                input.refusal = Some(unread_format(path).map_or_else(
                    || {
                        "not a format that frames-lint reads (URDF, xacro, YAML, JSON, MCAP, ROS 1 bags, rosbag2, pcap, \
                         OSF, PCD, PLY, LAS)"
                            .to_owned()
                    },
                    str::to_owned,
                ));
            }
        },
    }
    input
}

fn walk(root: &Path, group: usize, wanted: FileSelection, inputs: &mut Inputs) {
    let before = inputs.files.len();
    let walker = WalkBuilder::new(root)
        .require_git(false)
        .sort_by_file_name(Ord::cmp)
        .build();
    for entry in walker {
        let entry = match entry {
            Ok(entry) => entry,
            Err(error) => {
                let refusal = format!("the folder cannot be listed: {error}");
                inputs.files.push(unusable(root, group, refusal));
                continue;
            }
        };
        let path = entry.path();
        let Some(kind) = entry.file_type() else { continue };
        if kind.is_symlink() {
            // Installed workspaces link every file. Linked folders are not entered: they may lead anywhere, or in a cycle.
            if path.is_dir() {
                *inputs.skipped.entry("linked folder".to_owned()).or_default() += 1;
                continue;
            }
        } else if kind.is_dir() {
            continue;
        }
        if wanted == FileSelection::Code {
            if code::is_code(&ending(path)) {
                inputs.files.push(met(path, root, group, SourceKind::Code));
            }
            continue;
        }
        if path.file_name().is_some_and(|name| name == "package.xml")
            && let Some(folder) = path.parent()
        {
            inputs.packages.push(folder.to_path_buf());
            continue;
        }
        met_file(path, root, group, inputs);
    }
    thin_clouds(before, inputs);
    if inputs.files.len() == before {
        inputs.files.push(unusable(
            root,
            group,
            "the folder contains no file that frames-lint reads".to_owned(),
        ));
    }
}

/// Keeps some of the clouds of each folder that has many of them: scans of a recording, or tiles of a map. The others are counted.
fn thin_clouds(from: usize, inputs: &mut Inputs) {
    let is_cloud = |input: &Input| input.kind == SourceKind::Points && input.refusal.is_none();
    let folder = |input: &Input| input.path.parent().map(Path::to_path_buf);
    let mut counts: BTreeMap<Option<PathBuf>, usize> = BTreeMap::new();
    let clouds = inputs.files.iter().skip(from).filter(|input| is_cloud(input));
    clouds.for_each(|input| *counts.entry(folder(input)).or_default() += 1);
    let (mut at, mut seen) = (0, BTreeMap::<Option<PathBuf>, usize>::new());
    let skipped = &mut inputs.skipped;
    inputs.files.retain(|input| {
        at += 1;
        if at <= from || !is_cloud(input) {
            return true;
        }
        let count = counts.get(&folder(input)).copied().unwrap_or_default();
        let index = seen.entry(folder(input)).or_default();
        *index += 1;
        // Evenly spread, the first and the last among them.
        let step = |index: usize| index * (MAX_CLOUDS - 1) / count.saturating_sub(1).max(1);
        let is_kept = count <= MAX_CLOUDS || *index == 1 || step(*index - 1) > step(*index - 2);
        if !is_kept {
            let of_series = format!("{} of a series ({MAX_CLOUDS} are read)", ending(&input.path));
            *skipped.entry(of_series).or_default() += 1;
        }
        is_kept
    });
}

/// A file of a folder.
fn met(path: &Path, root: &Path, group: usize, kind: SourceKind) -> Input {
    Input {
        path: path.to_path_buf(),
        display: display(path),
        kind,
        parts: Vec::new(),
        refusal: None,
        group,
        root: root.to_path_buf(),
        required: true,
    }
}

fn met_file(path: &Path, root: &Path, group: usize, inputs: &mut Inputs) {
    if path.file_name().is_some_and(|name| name == CONFIGURATION) {
        return;
    }
    let mut input = met(path, root, group, SourceKind::Unsupported);
    match first_bytes(path) {
        Err(_) if kind_of_name(path).is_none() => {
            *inputs.skipped.entry(ending(path)).or_default() += 1;
            return;
        }
        Err(error) => {
            input.kind = kind_of_name(path).unwrap_or(SourceKind::Unsupported);
            input.refusal = Some(format!("cannot be opened: {error}"));
        }
        Ok(head) => {
            if own_document(&head).is_some() {
                *inputs.skipped.entry("frames-lint document".to_owned()).or_default() += 1;
                return;
            }
            if let Some(kind) = recognise(path, &head) {
                input.kind = kind;
            } else if Correction::may_be(&head) {
                inputs.corrections.push((group, path.to_path_buf()));
                *inputs.skipped.entry(CORRECTION.to_owned()).or_default() += 1;
                return;
            } else if let Some(reason) = unread_format(path) {
                input.refusal = Some(reason.to_owned());
                input.required = false;
            } else {
                *inputs.skipped.entry(ending(path)).or_default() += 1;
                return;
            }
        }
    }
    inputs.files.push(input);
}

/// A folder as an input with its problem.
fn unusable(root: &Path, group: usize, refusal: String) -> Input {
    Input {
        path: root.to_path_buf(),
        display: display(root),
        kind: SourceKind::Unsupported,
        parts: Vec::new(),
        refusal: Some(refusal),
        group,
        root: root.to_path_buf(),
        required: true,
    }
}

/// A path for reports. Bytes that are not UTF-8 are escaped (`\xff`), and a backslash that could be taken for that is doubled, so that two
/// names stay two.
fn display(path: &Path) -> String {
    let mut text = String::new();
    for chunk in path.as_os_str().as_encoded_bytes().utf8_chunks() {
        // On Windows a backslash separates folders, and every name is UTF-16.
        if cfg!(unix) {
            text.push_str(&chunk.valid().replace("\\x", "\\\\x"));
        } else {
            text.push_str(chunk.valid());
        }
        for byte in chunk.invalid() {
            let _ = write!(text, "\\x{byte:02x}");
        }
    }
    text.strip_prefix("./").map(str::to_owned).unwrap_or(text)
}

fn unread_format(path: &Path) -> Option<&'static str> {
    let ending = ending(path);
    UNREAD_FORMATS
        .iter()
        .find(|(known, _)| *known == ending)
        .map(|(_, reason)| *reason)
}

fn kind_of_name(path: &Path) -> Option<SourceKind> {
    Some(match ending(path).as_str() {
        "urdf" => SourceKind::Urdf,
        "xacro" => SourceKind::Xacro,
        "yaml" | "yml" | "calib" => SourceKind::Yaml,
        "json" => SourceKind::Json,
        "mcap" | "mcap.zstd" | "mcap.zst" => SourceKind::Mcap,
        "bag" | "bag.active" | "bag.zstd" | "bag.zst" => SourceKind::Rosbag1,
        "db3" | "db3.zstd" | "db3.zst" => SourceKind::Sqlite,
        "pcap" | "pcapng" | "cap" => SourceKind::Pcap,
        "osf" => SourceKind::Osf,
        "pcd" | "las" | "laz" => SourceKind::Points,
        _ => return None,
    })
}

/// What a file is: recordings by their magic bytes under any name, descriptions by name, XML by its root element.
fn recognise(path: &Path, head: &[u8]) -> Option<SourceKind> {
    if head.starts_with(b"\x89MCAP") {
        return Some(SourceKind::Mcap);
    }
    if head.starts_with(b"#ROSBAG V") || head.starts_with(b"#ROSRECORD V") {
        return Some(SourceKind::Rosbag1);
    }
    if head.starts_with(b"SQLite format 3\0") && ending(path) == "db3" {
        return Some(SourceKind::Sqlite);
    }
    match Container::of(head) {
        Container::Capture => return Some(SourceKind::Pcap),
        Container::Osf => return Some(SourceKind::Osf),
        _ => {}
    }
    if head.starts_with(points::LAS_MAGIC) || (ending(path) == "ply" && points::is_ply_cloud(head)) {
        return Some(SourceKind::Points);
    }
    let text = head_text(head);
    if path.file_name().is_some_and(|name| name == metadata::NAME)
        && text.lines().any(|line| line.starts_with(metadata::ROOT))
    {
        return Some(SourceKind::Rosbag2);
    }
    // Expanded files keep the declaration of the namespace: only an element of xacro makes a file a xacro.
    let xacro = || text.contains("<xacro:");
    match kind_of_name(path) {
        Some(SourceKind::Urdf) if xacro() => Some(SourceKind::Xacro),
        Some(kind) => Some(kind),
        None if ending(path) == "xml" && text.contains("<robot") => {
            Some(if xacro() { SourceKind::Xacro } else { SourceKind::Urdf })
        }
        None if launch::is_launch(&ending(path), &text) => Some(SourceKind::Launch),
        None if plain::is_yaml(&ending(path), &text) => Some(SourceKind::Yaml),
        None if head.starts_with(feather::MAGIC) => Some(SourceKind::Text),
        None => plain::form(&ending(path), &text).map(|_| SourceKind::Text),
    }
}

/// The beginning of a text in any encoding.
fn head_text(head: &[u8]) -> String {
    // A letter may be cut off at the end.
    let even = head.get(..head.len() & !1).unwrap_or_default();
    let is_wide = matches!(head, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]);
    let decoded = is_wide.then(|| text::decode(even.to_vec()).ok()).flatten();
    match decoded {
        Some((text, _)) => text,
        None => String::from_utf8_lossy(head).trim_start_matches('\u{feff}').to_owned(),
    }
}

/// Documents that frames-lint writes itself may be next to what they are about: their numbers are not statements of a file.
fn own_document(head: &[u8]) -> Option<&'static str> {
    let start: Vec<u8> = head
        .iter()
        .copied()
        .filter(|byte| !byte.is_ascii_whitespace())
        .take(40)
        .collect();
    if start.starts_with(b"{\"schema\":\"frames-lint-evidence/") {
        Some("is evidence saved by frames-lint: pass it with `--evidence`")
    } else if start.starts_with(b"{\"schema\":\"frames-lint/") {
        Some("is a report of frames-lint")
    } else {
        None
    }
}

/// The first bytes of a regular file. Pipes and devices are refused before opening: they may block, or never end.
fn first_bytes(path: &Path) -> std::io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::Error::other("it is not a regular file"));
    }
    let mut head = Vec::new();
    File::open(path)?.take(8192).read_to_end(&mut head)?;
    Ok(head)
}

#[cfg(test)]
mod tests;
