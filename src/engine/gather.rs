//! Reads every input of a run: files in parallel, then the texts extracted from them.
//!
//! Owns the order of sources. Does not judge, and does not decide which sources belong to one platform.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::collect::{CollectOptions, collect};
use crate::progress::Progress;
use crate::read::calibration;
use crate::read::discover::Inputs;
use crate::read::input::Input;
use crate::read::packets::{Correction, Unit};
use crate::read::urdf::MeshLookup;
use crate::read::xacro::Template;
use crate::read::{code, feather, launch, points, text, urdf, xacro, xacro_parts};
use crate::source::{Coverage, Derivation, ExpansionPart, MessageRef, Place, ReadStatus, Source, SourceId, SourceKind};
use crate::tables::Tables;
use crate::world::Facts;

use super::timings::{Phase, Timings};
use super::{parallel, references};

/// Maximum size of a file with the corrections of a lidar, which has 47 kB.
const MAX_CORRECTION_BYTES: u64 = 1 << 20;
/// Maximum size of text files, bytes: no URDF or calibration is larger.
const MAX_TEXT_BYTES: u64 = 64 * 1024 * 1024;

/// What was read from one source.
pub(super) struct Reading {
    /// The source.
    pub(super) source: Source,
    /// Its facts.
    pub(super) facts: Facts,
    /// Index of the input it came from.
    pub(super) input: usize,
}

/// A text extracted from a source, read as a description of a robot or of a sensor.
struct ExtractedText {
    text: String,
    path: String,
    kind: SourceKind,
    derived: Derivation,
    /// For an expansion: the places where it is written. Source ids are numbers of templates until all sources have an id.
    written: Vec<ExpansionPart>,
    templates: Vec<Template>,
    input: usize,
}

/// Reads these of the inputs, whose ids are their indices; extracted sources have ids from `emerged_from` on. Readings are ordered by
/// source id.
pub(super) fn gather(
    inputs: &Inputs,
    which: &[usize],
    emerged_from: usize,
    options: ReadOptions,
    progress: &Progress,
) -> Vec<Reading> {
    let which = which
        .iter()
        .filter_map(|index| Some((*index, inputs.files.get(*index)?)));
    let which: Vec<(usize, &Input)> = which.collect();
    let included = included_xacros(&which);
    let reader = Reader {
        inputs,
        options,
        progress,
        included: &included,
    };
    let first = parallel::map(which, |(index, input)| {
        let read = || reader.read(input, source_id(index), index);
        options.timings.of(Phase::Read, &input.display, read)
    });
    let mut readings = Vec::with_capacity(first.len());
    let mut emerged = Vec::new();
    for (reading, texts) in first {
        readings.push(reading);
        emerged.extend(texts);
    }
    number(&mut emerged, inputs, emerged_from);
    readings.extend(parallel::map(
        emerged.into_iter().enumerate().collect(),
        |(offset, text)| read_emerged(text, source_id(emerged_from + offset), inputs, options.tables),
    ));
    excuse_loaded(&mut readings);
    readings
}

/// A file that a xacro loads (`load_yaml`) is judged in its expansion: that its own format is unknown is not a problem then.
fn excuse_loaded(readings: &mut [Reading]) {
    let is_loading = |source: &&Source| {
        source.kind == SourceKind::Xacro && source.status == ReadStatus::Read && source.text.contains("load_yaml")
    };
    let loading = readings.iter().map(|reading| &reading.source).filter(is_loading);
    let loading: Vec<(String, String)> = loading
        .map(|source| (source.path.clone(), source.text.clone()))
        .collect();
    for source in readings.iter_mut().map(|reading| &mut reading.source) {
        let is_alone = source.problems.len() == 1 && !source.not_understood.is_empty();
        let Some(name) = Path::new(&source.path)
            .file_name()
            .filter(|_| is_alone && source.kind == SourceKind::Yaml)
        else {
            continue;
        };
        let name = name.to_string_lossy();
        if let Some((path, _)) = loading.iter().find(|(_, text)| text.contains(&*name)) {
            source.status = ReadStatus::Read;
            source.detail = Some(format!("loaded by `{path}`; checked in its expansion"));
            source.problems.clear();
            source.not_understood.clear();
        }
    }
}

/// Gives the places of expansions the ids of their files. A file that is not an input is added after the others.
fn number(emerged: &mut Vec<ExtractedText>, inputs: &Inputs, emerged_from: usize) {
    if emerged.iter().all(|text| text.templates.is_empty()) {
        return;
    }
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let files = inputs.files.iter().enumerate();
    let mut ids: BTreeMap<PathBuf, SourceId> = files
        .map(|(index, input)| (absolute(&input.path), source_id(index)))
        .collect();
    let mut behind = Vec::new();
    let first = emerged_from + emerged.len();
    for expansion in emerged.iter_mut() {
        let mut of_templates = Vec::new();
        for Template { path, text } in std::mem::take(&mut expansion.templates) {
            let id = *ids.entry(path.clone()).or_insert_with(|| {
                behind.push(ExtractedText {
                    text,
                    path: path.display().to_string(),
                    kind: SourceKind::Xacro,
                    derived: Derivation::Included,
                    written: Vec::new(),
                    templates: Vec::new(),
                    input: expansion.input,
                });
                source_id(first + behind.len() - 1)
            });
            of_templates.push(id);
        }
        for written in &mut expansion.written {
            if let Some(id) = of_templates.get(written.place.source.0 as usize) {
                written.place.source = *id;
            }
        }
    }
    emerged.append(&mut behind);
}

/// The id of the source with this index.
pub(super) fn source_id(index: usize) -> SourceId {
    SourceId(u32::try_from(index).unwrap_or(u32::MAX))
}

fn meshes(input: &Input, inputs: &Inputs) -> MeshLookup {
    MeshLookup {
        base_dir: input.path.parent().map(PathBuf::from),
        packages: inputs.packages_near(&input.path),
    }
}

fn read_emerged(
    emerged: ExtractedText,
    id: SourceId,
    inputs: &Inputs,
    tables: &dyn Fn(usize) -> Arc<Tables>,
) -> Reading {
    let mut source = Source::new(id, emerged.path, emerged.kind);
    source.derived = Some(emerged.derived);
    source.examined = Coverage {
        bytes: emerged.text.len() as u64,
        bytes_total: emerged.text.len() as u64,
        ..Coverage::default()
    };
    source.text = emerged.text;
    if source.derived == Some(Derivation::Included) {
        return Reading {
            source,
            facts: Facts::default(),
            input: emerged.input,
        };
    }
    if source.kind == SourceKind::SensorMetadata {
        let facts = calibration::read_json(&mut source, tables(emerged.input).dialects());
        // A truncated text is neither an error of the recording nor of the command line.
        source.status = source.status.min(ReadStatus::Partial);
        return Reading {
            source,
            facts,
            input: emerged.input,
        };
    }
    let lookup = inputs
        .files
        .get(emerged.input)
        .map_or_else(MeshLookup::default, |input| meshes(input, inputs));
    let facts = urdf::read(&mut source, &lookup);
    source.taken = facts.words();
    source.written = emerged.written;
    for at in 0..source.problems.len() {
        if let Some(problem) = source.problems.get(at)
            && let Some(place) = source.written(&problem.place)
            && let Some(problem) = source.problems.get_mut(at)
        {
            problem.place = place;
        }
    }
    Reading {
        source,
        facts,
        input: emerged.input,
    }
}

/// File names that a xacro of the run includes: these are parts, not robots, and are not expanded by themselves.
fn included_xacros(inputs: &[(usize, &Input)]) -> Vec<String> {
    let mut included: Vec<String> = inputs
        .iter()
        .filter(|(_, input)| input.kind == SourceKind::Xacro)
        .filter_map(|(_, input)| {
            Some((
                input.path.file_name()?.to_string_lossy(),
                read_bounded(&input.path).ok()?,
            ))
        })
        .flat_map(|(own, bytes)| {
            let mut names = xacro_parts::includes(&String::from_utf8_lossy(&bytes));
            // A file that includes itself is not a part but an error, which the expansion reports.
            names.retain(|name| *name != own);
            names
        })
        .collect();
    included.sort();
    included.dedup();
    included
}

/// How inputs are read.
#[derive(Clone, Copy)]
pub(super) struct ReadOptions<'a> {
    /// Xacro files.
    pub(super) xacro: &'a xacro::ExpandOptions,
    /// Recordings.
    pub(super) recordings: &'a CollectOptions,
    /// The tables of devices and dialects for the input with this index.
    pub(super) tables: &'a (dyn Fn(usize) -> Arc<Tables> + Sync),
    /// Time spent.
    pub(super) timings: &'a Timings,
}

struct Reader<'a> {
    inputs: &'a Inputs,
    options: ReadOptions<'a>,
    progress: &'a Progress,
    included: &'a [String],
}

impl Reader<'_> {
    fn read(&self, input: &Input, id: SourceId, index: usize) -> (Reading, Vec<ExtractedText>) {
        let mut source = Source::new(id, input.display.clone(), input.kind);
        source.required = input.required;
        // A rosbag2 has its `metadata.yaml` beside its files; the files of a split recording include the input.
        let own = Some(&input.path).filter(|path| !input.parts.contains(path));
        source.files = own.into_iter().chain(&input.parts).cloned().collect();
        let mut emerged = Vec::new();
        let facts = if let Some(refusal) = &input.refusal {
            source.problem(ReadStatus::Unreadable, Place::whole(id), refusal.clone());
            Facts::default()
        } else {
            self.read_kind(input, &mut source, index, &mut emerged)
        };
        source.taken = facts.words();
        let reading = Reading {
            source,
            facts,
            input: index,
        };
        (reading, emerged)
    }

    fn read_kind(&self, input: &Input, source: &mut Source, index: usize, emerged: &mut Vec<ExtractedText>) -> Facts {
        match input.kind {
            kind if kind.is_bag() => self.read_recording(input, source, index, emerged),
            SourceKind::Points => read_points(input, source),
            SourceKind::Unsupported => {
                source.problem(
                    ReadStatus::Unreadable,
                    Place::whole(source.id),
                    "this format is not supported",
                );
                Facts::default()
            }
            _ => {
                if !load_text(input, source) {
                    return Facts::default();
                }
                let tables = (self.options.tables)(index);
                match input.kind {
                    SourceKind::Yaml => with_references(calibration::read_yaml(source, tables.dialects()), input),
                    SourceKind::Json => with_references(calibration::read_json(source, tables.dialects()), input),
                    SourceKind::Launch => launch::read(source),
                    SourceKind::Code => code::read(source),
                    SourceKind::Text => with_references(calibration::read_plain(source, tables.dialects()), input),
                    SourceKind::Xacro => self.read_xacro(input, source, index, emerged),
                    _ => urdf::read(source, &meshes(input, self.inputs)),
                }
            }
        }
    }

    fn read_recording(
        &self,
        input: &Input,
        source: &mut Source,
        index: usize,
        emerged: &mut Vec<ExtractedText>,
    ) -> Facts {
        let size = |path: &PathBuf| fs::metadata(path).map_or(0, |meta| meta.len());
        let parts = if input.parts.is_empty() {
            std::slice::from_ref(&input.path)
        } else {
            &input.parts
        };
        let task = self.progress.start(&input.display, parts.iter().map(size).sum());
        let mut recordings = self.options.recordings.clone();
        // A rosbag2 folder's metadata lists its files again, with information about them.
        if input.kind != SourceKind::Rosbag2 {
            recordings.parts.clone_from(&input.parts);
        }
        if let Some(unit) = self.unit_beside(input) {
            recordings.clouds.unit = unit;
        }
        let collected = collect(&input.path, &recordings, source, &|done, _total| task.update(done));
        let texts = [
            (SourceKind::RobotDescription, collected.descriptions),
            (SourceKind::SensorMetadata, collected.metadata),
        ];
        for (kind, texts) in texts {
            let emerging = |(message, text): (MessageRef, String)| ExtractedText {
                text,
                path: input.display.clone(),
                kind,
                derived: Derivation::Message(message),
                written: Vec::new(),
                templates: Vec::new(),
                input: index,
            };
            emerged.extend(texts.into_iter().map(emerging));
        }
        collected.facts
    }

    /// The sensor whose corrections are among the inputs of a recording, if there is one.
    fn unit_beside(&self, input: &Input) -> Option<Unit> {
        let mut beside = self
            .inputs
            .corrections
            .iter()
            .filter(|(group, _)| *group == input.group);
        let (_, path) = beside.next()?;
        let is_small = fs::metadata(path).is_ok_and(|meta| meta.len() <= MAX_CORRECTION_BYTES);
        let only = beside.next().is_none() && is_small;
        let correction = Correction::read(&fs::read(path).ok().filter(|_| only)?)?;
        Some(Unit::corrected(Arc::new(correction)))
    }

    fn read_xacro(&self, input: &Input, source: &mut Source, index: usize, emerged: &mut Vec<ExtractedText>) -> Facts {
        let lookup = meshes(input, self.inputs);
        let name = input.path.file_name().map(|name| name.to_string_lossy().into_owned());
        let is_part = name.is_some_and(|name| self.included.contains(&name));
        if is_part || xacro_parts::is_library(&source.text) {
            source.detail =
                Some("included by other xacro files: only parts that need no expansion were read".to_owned());
            return xacro::read_unexpanded(source, &lookup);
        }
        // Most published `.urdf` files still declare the namespace of the xacro they were made from: their own text is
        // checked, so that findings point into it.
        if !xacro_parts::needs_expansion(&source.text) {
            source.kind = SourceKind::Urdf;
            return urdf::read(source, &lookup);
        }
        match xacro::expand(&input.path, self.options.xacro, &self.inputs.packages_near(&input.path)) {
            Ok(expanded) => {
                source.detail = Some("checked in its expansion".to_owned());
                emerged.push(ExtractedText {
                    text: expanded.text,
                    written: expanded.written,
                    templates: expanded.templates,
                    path: input.display.clone(),
                    kind: SourceKind::Urdf,
                    derived: Derivation::Expansion,
                    input: index,
                });
                Facts::default()
            }
            Err(failure) => {
                failure.report(source);
                xacro::read_unexpanded(source, &lookup)
            }
        }
    }
}

fn read_points(input: &Input, source: &mut Source) -> Facts {
    match fs::File::open(&input.path) {
        Ok(file) => points::read(file, source),
        Err(error) => {
            let why = format!("cannot be read: {error}");
            source.problem(ReadStatus::Unreadable, Place::whole(source.id), why);
            Facts::default()
        }
    }
}

fn with_references(mut facts: Facts, input: &Input) -> Facts {
    if let Some(folder) = input.path.parent() {
        references::resolve(&mut facts.references, folder);
    }
    facts
}

/// Fills the source's text. False if there is no text to read; the source then states the problem.
fn load_text(input: &Input, source: &mut Source) -> bool {
    let id = source.id;
    let whole = Place::whole(id);
    let bytes = match read_bounded(&input.path) {
        Ok(bytes) => bytes,
        Err(reason) => {
            source.problem(ReadStatus::Unreadable, whole, reason);
            return false;
        }
    };
    source.examined = Coverage {
        bytes: bytes.len() as u64,
        bytes_total: bytes.len() as u64,
        ..Coverage::default()
    };
    if bytes.iter().all(u8::is_ascii_whitespace) {
        let message = if bytes.is_empty() {
            "the file is empty"
        } else {
            "the file contains only whitespace"
        };
        source.problem(ReadStatus::Unreadable, whole, message);
        return false;
    }
    let decoded = if bytes.starts_with(feather::MAGIC) {
        source.derived = Some(Derivation::Expansion);
        feather::to_csv(bytes).map(|text| (text, None))
    } else {
        text::decode(bytes)
    };
    match decoded {
        Ok((text, note)) => {
            source.text = text;
            source.detail = note;
            true
        }
        Err(reason) => {
            source.problem(ReadStatus::Unreadable, whole, reason);
            false
        }
    }
}

/// The bytes of a regular file of bounded size. Discovery has refused all others; this also holds if a file grows or is replaced
/// meanwhile.
fn read_bounded(path: &Path) -> Result<Vec<u8>, String> {
    let cannot = |error: std::io::Error| format!("cannot be read: {error}");
    let meta = fs::metadata(path).map_err(cannot)?;
    if !meta.is_file() {
        return Err("cannot be read: it is not a regular file".to_owned());
    }
    let too_large = |bytes: u64| {
        let limit = MAX_TEXT_BYTES >> 20;
        Err(format!(
            "the file has {} MB; text files of more than {limit} MB are not read",
            bytes >> 20
        ))
    };
    if meta.len() > MAX_TEXT_BYTES {
        return too_large(meta.len());
    }
    // A file that grows meanwhile is read to its end.
    let mut bytes = Vec::with_capacity(usize::try_from(meta.len() + 1).unwrap_or_default());
    let file = fs::File::open(path).map_err(cannot)?;
    file.take(MAX_TEXT_BYTES + 1).read_to_end(&mut bytes).map_err(cannot)?;
    if bytes.len() as u64 > MAX_TEXT_BYTES {
        return too_large(bytes.len() as u64);
    }
    Ok(bytes)
}
