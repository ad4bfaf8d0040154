//! Evidence documents: what was read, saved to be judged later without the files.
//!
//! Owns the document's format and version, and combines several documents into one run. Does not judge.
//!
//! ```json
//! {"schema": "frames-lint-evidence/1", "tool": {"name": "frames-lint", "version": "0.1.0"},
//!  "skipped": {"pcd": 3}, "sources": [...], "worlds": [...]}
//! ```
//!
//! Sources and worlds are written as the library keeps them, with the texts of sources, because findings point into
//! them. Numbers that JSON does not support are words (see [`crate::world::number`]). A change that an older or newer reader
//! would misread needs a new schema name.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::run::Run;
use crate::source::{Place, ReadStatus, Source, SourceId, SourceKind};
use crate::visible::json_line;
use crate::world::World;

/// Name of the document's format.
pub const SCHEMA: &str = "frames-lint-evidence/1";
/// Maximum size of a document, bytes. Evidence of a recording has some megabytes, for recordings of any length.
const MAX_BYTES: u64 = 1 << 30;

#[derive(Serialize)]
struct Output<'a> {
    schema: &'static str,
    tool: Tool<'a>,
    skipped: &'a BTreeMap<String, usize>,
    sources: &'a [Arc<Source>],
    worlds: &'a [World],
}

#[derive(Serialize)]
struct Tool<'a> {
    name: &'a str,
    version: &'a str,
}

#[derive(Deserialize)]
struct Document {
    skipped: BTreeMap<String, usize>,
    sources: Vec<Arc<Source>>,
    worlds: Vec<World>,
}

/// The start of a document of any version.
#[derive(Deserialize)]
struct Head {
    schema: Option<String>,
    tool: Option<HeadTool>,
}

#[derive(Deserialize)]
struct HeadTool {
    version: Option<String>,
}

/// The saved data of a run.
#[derive(Debug, Default)]
pub struct SavedEvidence {
    /// The worlds, each with all sources of the document.
    pub worlds: Vec<World>,
    /// The sources.
    pub sources: Arc<Vec<Arc<Source>>>,
    /// Files in folders for which no reader exists.
    pub skipped: BTreeMap<String, usize>,
    /// The index of the configuration that governs it.
    pub governed: usize,
}

/// The evidence document of a run. The same run gives the same bytes.
pub fn write(run: &Run) -> Result<String, serde_json::Error> {
    json_line(&Output {
        schema: SCHEMA,
        tool: Tool {
            name: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
        },
        skipped: &run.skipped,
        sources: &run.sources,
        worlds: &run.worlds,
    })
}

/// Reads a document. If that fails, returns one source that states why, and an otherwise empty world.
pub(super) fn read(path: &Path) -> SavedEvidence {
    load(path)
        .and_then(|bytes| parse(&bytes))
        .unwrap_or_else(|why| unreadable(path, why))
}

fn unreadable(path: &Path, why: String) -> SavedEvidence {
    let id = SourceId(0);
    let display = path.to_string_lossy().into_owned();
    let mut source = Source::new(id, display.clone(), SourceKind::Json);
    let help = "save it again with `frames-lint collect PATH... -o FILE`";
    source.problem_with_help(ReadStatus::Unreadable, Place::whole(id), why, Some(help.to_owned()));
    let mut world = World::default();
    world.label = display;
    world.members = vec![id];
    let sources = Arc::new(vec![Arc::new(source)]);
    world.sources = Arc::clone(&sources);
    SavedEvidence {
        worlds: vec![world],
        sources,
        ..SavedEvidence::default()
    }
}

/// The bytes of a regular file of bounded size.
fn load(path: &Path) -> Result<Vec<u8>, String> {
    let cannot = |error: std::io::Error| format!("cannot be read: {error}");
    let meta = std::fs::metadata(path).map_err(cannot)?;
    if !meta.is_file() {
        return Err("cannot be read: it is not a regular file".to_owned());
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(cannot)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(cannot)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!(
            "is larger than {} MB, the maximum size of evidence",
            MAX_BYTES >> 20
        ));
    }
    Ok(bytes)
}

/// The contents of a document; the error states what is wrong, and where.
pub fn parse(bytes: &[u8]) -> Result<SavedEvidence, String> {
    let head = match serde_json::from_slice::<Head>(bytes) {
        Ok(head) => head,
        Err(error) => return Err(format!("is not evidence of frames-lint: {error}")),
    };
    let version = head.tool.and_then(|tool| tool.version);
    let by = version.map_or_else(String::new, |version| format!(" (written by frames-lint {version})"));
    match head.schema {
        Some(schema) if schema == SCHEMA => {}
        Some(schema) => {
            return Err(format!(
                "has the schema `{schema}`{by}, but this version reads `{SCHEMA}`"
            ));
        }
        None => {
            return Err(format!(
                "is not evidence of frames-lint: `\"schema\": \"{SCHEMA}\"` is missing"
            ));
        }
    }
    let document: Document =
        serde_json::from_slice(bytes).map_err(|error| format!("is damaged evidence{by}: {error}"))?;
    if let Some(fault) = fault(&document) {
        return Err(format!("is damaged evidence: {fault}"));
    }
    let sources = Arc::new(document.sources);
    let mut worlds = document.worlds;
    for world in &mut worlds {
        world.sources = Arc::clone(&sources);
    }
    Ok(SavedEvidence {
        worlds,
        sources,
        skipped: document.skipped,
        governed: 0,
    })
}

/// What is wrong with ids: every source must be at its own, and members of worlds must exist.
fn fault(document: &Document) -> Option<String> {
    let count = document.sources.len();
    let is_known = |id: &SourceId| (id.0 as usize) < count;
    let misplaced = (0..).zip(&document.sources).find(|(at, source)| source.id.0 != *at);
    if let Some((at, source)) = misplaced {
        return Some(format!("source {at} has the id {}", source.id.0));
    }
    let members = document.worlds.iter().flat_map(|world| &world.members);
    let places = document.sources.iter().flat_map(|source| &source.problems);
    let parts = document.sources.iter().flat_map(|source| &source.not_understood);
    let bags = document.worlds.iter().flat_map(|world| &world.bags);
    let robots = document.worlds.iter().flat_map(|world| &world.robots);
    members
        .chain(places.map(|problem| &problem.place.source))
        .chain(parts.map(|part| &part.place.source))
        .chain(bags.map(|bag| &bag.source))
        .chain(robots.map(|robot| &robot.source))
        .find(|id| !is_known(id))
        .map(|id| format!("there is no source {}", id.0))
}
