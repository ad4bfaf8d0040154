//! Sorts readings into platforms. The nearest folder decides.

mod clusters;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::read::discover::Inputs;
use crate::read::input::Input;
use crate::source::{Derivation, Source, SourceId};
use crate::world::{Facts, FrameId, World};

use super::gather::Reading;

/// A source with its facts, and what determines its platform.
#[derive(Clone)]
pub(super) struct Member {
    /// The source.
    pub(super) id: SourceId,
    group: usize,
    display: String,
    in_recording: bool,
    facts: Facts,
    dir: PathBuf,
    path: PathBuf,
}

impl Member {
    /// A source read from this input, or extracted from it.
    pub(super) fn new(source: &Source, facts: Facts, input: &Input) -> Self {
        Self {
            id: source.id,
            group: input.group,
            display: source.path.clone(),
            in_recording: matches!(source.derived, Some(Derivation::Message(_))),
            facts,
            dir: input.path.parent().unwrap_or(Path::new("")).to_path_buf(),
            path: input.path.clone(),
        }
    }
}

/// The sources of readings, and all of them with their facts.
pub(super) fn members(readings: Vec<Reading>, inputs: &Inputs) -> (Vec<Arc<Source>>, Vec<Member>) {
    let mut members = Vec::with_capacity(readings.len());
    let mut sources = Vec::with_capacity(readings.len());
    for Reading { source, facts, input } in readings {
        members.extend(inputs.files.get(input).map(|input| Member::new(&source, facts, input)));
        sources.push(Arc::new(source));
    }
    (sources, members)
}

/// Sources sorted into worlds.
pub(super) struct Platforms {
    /// Ordered by their first source. Their lists of sources are empty.
    pub(super) worlds: Vec<World>,
    /// Notes on how sources were joined.
    pub(super) notes: Vec<(SourceId, String)>,
}

impl Platforms {
    /// Sorts members. The inputs give the places of recordings, also of those that are not among the members.
    pub(super) fn of(members: Vec<Member>, inputs: &Inputs) -> Self {
        let mut groups: BTreeMap<usize, Vec<Member>> = BTreeMap::new();
        for member in members {
            groups.entry(member.group).or_default().push(member);
        }
        let (mut worlds, mut notes) = (Vec::new(), Vec::new());
        for (group, members) in groups {
            let recordings = inputs
                .files
                .iter()
                .filter(|input| input.group == group && input.kind.is_bag());
            let recorded = recordings.filter_map(|input| input.path.parent().map(Path::to_path_buf));
            let clusters = clusters::clusters(members, &recorded.collect());
            worlds.extend(clusters.members.into_iter().map(world));
            notes.extend(clusters.notes);
        }
        worlds.sort_by(|a, b| a.members.cmp(&b.members));
        Self { worlds, notes }
    }

    /// Adds the notes to the sources.
    pub(super) fn note(&self, sources: &mut [Arc<Source>]) {
        for (id, note) in &self.notes {
            if let Some(source) = sources.iter_mut().find(|source| source.id == *id) {
                Arc::make_mut(source).notes.push(note.clone());
            }
        }
    }
}

fn world(members: Vec<Member>) -> World {
    let mut world = World::default();
    world.label = label(&members);
    let channels = members.iter().flat_map(|member| member.facts.channels.iter().cloned());
    let channels: BTreeMap<FrameId, FrameId> = channels.collect();
    for member in members {
        world.members.push(member.id);
        world.absorb(member.facts);
    }
    world.name_sensors(&channels);
    world.name_frames_of_packets();
    world
}

/// The robot's file, or the only file, or the folder.
fn label(members: &[Member]) -> String {
    let robot = members.iter().find(|member| is_robot(member));
    match (robot, members) {
        (Some(robot), _) => robot.display.clone(),
        (None, [only]) => only.display.clone(),
        (None, [first, ..]) => first.dir.to_string_lossy().into_owned(),
        (None, []) => String::new(),
    }
}

/// A complete description from a file. Descriptions inside a recording belong to the recording.
fn is_robot(member: &Member) -> bool {
    member
        .facts
        .robots
        .iter()
        .any(|robot| robot.fragment.is_none() && !robot.links.is_empty())
        && !member.in_recording
}
