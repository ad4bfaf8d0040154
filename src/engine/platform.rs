//! Sorts readings into platforms: a folder is one platform, unless it clearly holds several robots.
//!
//! One robot in a folder: everything there is judged together. Several robots: each description is a platform, and
//! another file joins the robot it shares most frames with, or the nearest one below the folder; where that is not
//! unique it is judged by itself, because comparing it with the wrong robot would invent findings. No robot at all:
//! files that lie in one folder belong together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::read::discover::Inputs;
use crate::read::input::Input;
use crate::source::{Derived, Source, SourceId};
use crate::world::{Facts, FrameId, FrameRole, World};

use super::gather::Reading;

/// A source with its facts, and what says which platform it belongs to.
#[derive(Clone)]
pub(super) struct Member {
    /// The source.
    pub(super) id: SourceId,
    group: usize,
    display: String,
    in_recording: bool,
    facts: Facts,
    dir: PathBuf,
    root: PathBuf,
    path: PathBuf,
}

impl Member {
    /// A source that was read from this input, or came out of it.
    pub(super) fn new(source: &Source, facts: Facts, input: &Input) -> Self {
        Self {
            id: source.id,
            group: input.group,
            display: source.path.clone(),
            in_recording: matches!(source.derived, Some(Derived::Message(_))),
            facts,
            dir: input.path.parent().unwrap_or(Path::new("")).to_path_buf(),
            root: input.root.clone(),
            path: input.path.clone(),
        }
    }
}

/// The sources of readings, and all of them with their facts.
pub(super) fn members(readings: Vec<Reading>, inputs: &Inputs) -> (Vec<Source>, Vec<Member>) {
    let mut members = Vec::with_capacity(readings.len());
    let mut sources = Vec::with_capacity(readings.len());
    for Reading { source, facts, input } in readings {
        members.extend(inputs.files.get(input).map(|input| Member::new(&source, facts, input)));
        sources.push(source);
    }
    (sources, members)
}

/// Splits sources into worlds, ordered by their first one. Their lists of sources are empty.
pub(super) fn platforms(members: Vec<Member>) -> Vec<World> {
    let mut groups: BTreeMap<usize, Vec<Member>> = BTreeMap::new();
    for member in members {
        groups.entry(member.group).or_default().push(member);
    }
    let mut worlds: Vec<World> = groups.into_values().flat_map(clusters).map(world).collect();
    worlds.sort_by(|a, b| a.members.cmp(&b.members));
    worlds
}

fn world(members: Vec<Member>) -> World {
    let mut world = World::default();
    world.label = label(&members);
    for member in members {
        world.members.push(member.id);
        world.absorb(member.facts);
    }
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

/// A whole description from a file. Descriptions inside a recording belong to the recording.
fn is_robot(member: &Member) -> bool {
    member
        .facts
        .robots
        .iter()
        .any(|robot| robot.fragment.is_none() && !robot.links.is_empty())
        && !member.in_recording
}

fn is_fragment(member: &Member) -> bool {
    member.facts.robots.iter().any(|robot| robot.fragment.is_some())
}

fn clusters(members: Vec<Member>) -> Vec<Vec<Member>> {
    let (fragments, members): (Vec<_>, Vec<_>) = members.into_iter().partition(is_fragment);
    let (robots, others): (Vec<_>, Vec<_>) = members.into_iter().partition(is_robot);
    let mut clusters: Vec<Vec<Member>> = fragments.into_iter().map(|fragment| vec![fragment]).collect();
    match robots.len() {
        0 => clusters.extend(by_folder(others)),
        1 => clusters.push(robots.into_iter().chain(others).collect()),
        _ => clusters.extend(around(robots, others)),
    }
    clusters
}

/// Files of one folder belong together, and with recordings what lies below their folder, where there is one such folder.
fn by_folder(members: Vec<Member>) -> Vec<Vec<Member>> {
    let recordings = members.iter().filter(|member| !member.facts.bags.is_empty());
    let recorded: BTreeSet<PathBuf> = recordings.map(|member| member.dir.clone()).collect();
    let home = recorded.first().filter(|_| recorded.len() == 1);
    let mut folders: BTreeMap<PathBuf, Vec<Member>> = BTreeMap::new();
    for member in members {
        let home = home.filter(|home| member.dir.starts_with(home));
        folders
            .entry(home.unwrap_or(&member.dir).clone())
            .or_default()
            .push(member);
    }
    folders.into_values().collect()
}

fn around(robots: Vec<Member>, others: Vec<Member>) -> Vec<Vec<Member>> {
    let frames: Vec<BTreeSet<FrameId>> = robots.iter().map(frames_of).collect();
    let dirs: Vec<PathBuf> = robots.iter().map(|robot| robot.dir.clone()).collect();
    let mut clusters: Vec<Vec<Member>> = robots.into_iter().map(|robot| vec![robot]).collect();
    // Files that came out of one input (a recording and its description) stay together.
    let mut inputs: BTreeMap<PathBuf, Vec<Member>> = BTreeMap::new();
    for other in others {
        inputs.entry(other.path.clone()).or_default().push(other);
    }
    let mut alone = Vec::new();
    for members in inputs.into_values() {
        let named: BTreeSet<FrameId> = members.iter().flat_map(frames_of).collect();
        let home = members
            .first()
            .and_then(|first| nearest_robot(first, &named, &frames, &dirs));
        match home.and_then(|index| clusters.get_mut(index)) {
            Some(cluster) => cluster.extend(members),
            None => alone.extend(members),
        }
    }
    clusters.extend(by_folder(alone));
    clusters
}

fn frames_of(member: &Member) -> BTreeSet<FrameId> {
    member
        .facts
        .frames
        .iter()
        .filter(|used| used.role != FrameRole::CalibrationLabel)
        .map(|used| used.frame.canonical())
        .collect()
}

/// The robot with most frames in common, the nearest among those with as many; `None` where that is not one robot.
fn nearest_robot(
    member: &Member,
    named: &BTreeSet<FrameId>,
    frames: &[BTreeSet<FrameId>],
    dirs: &[PathBuf],
) -> Option<usize> {
    let mut ranked: Vec<(usize, usize, usize)> = frames
        .iter()
        .zip(dirs)
        .enumerate()
        .filter_map(|(index, (frames, dir))| {
            let distance = distance_below(&member.root, &member.dir, dir)?;
            Some((frames.intersection(named).count(), distance, index))
        })
        .filter(|(shared, _, _)| *shared > 0)
        .collect();
    ranked.sort_by_key(|(shared, distance, index)| (std::cmp::Reverse(*shared), *distance, *index));
    match ranked.as_slice() {
        [best, second, ..] if (best.0, best.1) == (second.0, second.1) => None,
        [best, ..] => Some(best.2),
        [] => None,
    }
}

/// Steps from one folder to the other. `None` where they have nothing but the given root in common, unless one of
/// them is the root itself.
fn distance_below(root: &Path, a: &Path, b: &Path) -> Option<usize> {
    let common = a.components().zip(b.components()).take_while(|(x, y)| x == y).count();
    let (a_len, b_len, root_len) = (
        a.components().count(),
        b.components().count(),
        root.components().count(),
    );
    let related = common > root_len || a_len == root_len || b_len == root_len;
    related.then_some(a_len + b_len - 2 * common)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_near_only_below_the_given_root() {
        let root = Path::new("ws");
        let distance = |a: &str, b: &str| distance_below(root, Path::new(a), Path::new(b));
        assert_eq!(distance("ws/car/config", "ws/car/urdf"), Some(2));
        assert_eq!(distance("ws/car/config", "ws/drone/urdf"), None);
        assert_eq!(distance("ws", "ws/drone/urdf"), Some(2));
        assert_eq!(distance("ws", "ws"), Some(0));
    }
}
