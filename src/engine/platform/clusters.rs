//! Which sources belong to one platform: around robots, around recordings, by folders and by the frames that they name.
//!
//! Owns the choice. Must not judge, and must not read files.
//!
//! A platform forms around a robot, that is a complete description. A tree of folders with one robot is one platform, except for a folder
//! with its own statements and recordings if the robot's folder has some too. With several robots, the search goes up from a file's folder
//! to the first folder that contains a robot, in it or below. If that is one robot, the file belongs to it. If there are several, it belongs
//! to the one whose frames it names most; if that is not unique, to the one that its own name or folder names; if that is not unique, to the
//! one whose transforms it states; else it is judged with each of them, and its source has a note. A folder beside a robot's folder that
//! contains the same kinds of files (statements, recordings) is of another platform. Without any robot, platforms form around the folders of
//! recordings; without recordings, each folder is one, with its parts: folders that packages keep one kind of file in (`launch`, `config`).

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::analysis::cross::fit::Fit;
use crate::source::{SourceId, packages};
use crate::world::{FrameId, FrameRole, Robot, World};

use super::{Member, is_robot, world};

/// Members of each world, and notes on how they were joined.
#[derive(Default)]
pub(super) struct Clusters {
    pub(super) members: Vec<Vec<Member>>,
    pub(super) notes: Vec<(SourceId, String)>,
}

/// Sorts the members of one group; `recorded` are the folders of its recordings.
pub(super) fn clusters(members: Vec<Member>, recorded: &BTreeSet<PathBuf>) -> Clusters {
    let (fragments, mut members): (Vec<_>, Vec<_>) = members.into_iter().partition(is_fragment);
    // Macros and properties alone are no robot: beside one they belong to it.
    let has_robot = members.iter().any(is_robot);
    let (macros, fragments): (Vec<_>, Vec<_>) = fragments
        .into_iter()
        .partition(|fragment| has_robot && fragment.facts.robots.iter().all(Robot::is_empty));
    members.extend(macros.into_iter().map(|mut macros| {
        macros.facts.robots.clear();
        macros
    }));
    let (robots, others): (Vec<_>, Vec<_>) = members.into_iter().partition(is_robot);
    let root = common_folder(
        robots
            .iter()
            .chain(&others)
            .map(|member| member.dir.as_path())
            .chain(recorded.iter().map(PathBuf::as_path)),
    );
    let mut clusters = around_robots(robots, units(others), recorded, &root);
    clusters
        .members
        .extend(fragments.into_iter().map(|fragment| vec![fragment]));
    clusters
}

/// The sources of one input: a recording and its description, or a file.
struct Unit {
    members: Vec<Member>,
    dir: PathBuf,
    /// Its names of frames: certain ones, then keys that may be names of frames.
    names: [BTreeSet<FrameId>; 2],
    kinds: Kinds,
}

impl Unit {
    /// Whether it is a file of points.
    fn is_cloud(&self) -> bool {
        self.members.iter().any(|member| !member.facts.point_files.is_empty())
    }
}

/// What a platform may be split by: folders with descriptions, with statements of transforms, with recordings.
#[derive(Clone, Copy, Default)]
struct Kinds {
    states: bool,
    records: bool,
}

impl Kinds {
    fn has_any_of(self, other: Self) -> bool {
        self.states && other.states || self.records && other.records
    }

    fn and(self, other: Self) -> Self {
        Self {
            states: self.states || other.states,
            records: self.records || other.records,
        }
    }
}

fn units(members: Vec<Member>) -> Vec<Unit> {
    let mut inputs: BTreeMap<PathBuf, Vec<Member>> = BTreeMap::new();
    for member in members {
        inputs.entry(member.path.clone()).or_default().push(member);
    }
    let unit = |members: Vec<Member>| {
        let records = members.iter().any(|member| !member.facts.bags.is_empty());
        Unit {
            dir: members.first().map(|first| first.dir.clone()).unwrap_or_default(),
            names: [false, true].map(|are_keys| members.iter().flat_map(|member| names_of(member, are_keys)).collect()),
            kinds: Kinds {
                states: !records && members.iter().any(|member| member.facts.state_transforms()),
                records,
            },
            members,
        }
    };
    inputs.into_values().map(unit).collect()
}

/// What a platform forms around.
struct Anchor {
    dir: PathBuf,
    /// The file, or the folder if it is a folder.
    path: PathBuf,
    frames: BTreeSet<FrameId>,
    name: String,
}

/// A file that may belong to more robots than this is judged with none of them.
const MAX_CANDIDATES: usize = 4;

/// The platforms of a unit.
enum Placement {
    /// Each of these anchors.
    With(Vec<usize>),
    /// None. These are the candidates.
    Alone(Vec<usize>),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum AnchorKind {
    Robot,
    Robots,
    Recordings,
}

/// The folders of a run with their contents.
struct Layout<'a> {
    anchors: &'a [Anchor],
    /// The anchors in each folder and below it.
    within: BTreeMap<&'a Path, Vec<usize>>,
    /// The contents of each folder and below.
    kinds: BTreeMap<&'a Path, Kinds>,
    root: &'a Path,
    /// The anchors of the platforms.
    around: AnchorKind,
}

impl Layout<'_> {
    fn home(&self, unit: &Unit) -> Placement {
        let folders = unit.dir.ancestors().take_while(|folder| folder.starts_with(self.root));
        for folder in folders {
            let Some(near) = self.within.get(folder) else { continue };
            let is_here = |at: &usize| self.anchors.get(*at).is_some_and(|anchor| anchor.dir == folder);
            let here: Vec<usize> = near.iter().copied().filter(is_here).collect();
            return match (here.as_slice(), unit.dir == folder) {
                // In a large collection, folders below the top folder are not related.
                ([], false) if near.len() > MAX_CANDIDATES && *folder == *self.root => Placement::Alone(Vec::new()),
                ([], false) => {
                    let here = self.side(folder, &unit.dir);
                    let open = near.iter().copied().filter(|at| self.is_open(folder, *at, here));
                    self.choose(open.collect(), near, unit)
                }
                ([], true) => self.choose(near.clone(), near, unit),
                _ => self.choose(here.clone(), &here, unit),
            };
        }
        Placement::Alone(Vec::new())
    }

    /// The contents of the direct subfolder of this folder that contains or is the other folder.
    fn side(&self, folder: &Path, dir: &Path) -> Kinds {
        let below = dir.strip_prefix(folder).ok().and_then(|below| below.iter().next());
        let side = folder.join(below.unwrap_or_default());
        self.kinds.get(side.as_path()).copied().unwrap_or_default()
    }

    /// Whether the anchor's subfolder lacks the kinds of files in the unit's subfolder: the two may be one platform, split by kinds of files.
    fn is_open(&self, folder: &Path, anchor: usize, here: Kinds) -> bool {
        let Some(anchor) = self.anchors.get(anchor) else {
            return false;
        };
        let there = self.side(folder, &anchor.dir);
        match self.around {
            // With one robot, everything belongs to it, unless a folder beside it has everything of another platform.
            AnchorKind::Robot => !(here.states && here.records && (there.states || there.records)),
            AnchorKind::Robots | AnchorKind::Recordings => !there.has_any_of(here),
        }
    }

    /// Those of several anchors whose frames the unit names most.
    fn choose(&self, open: Vec<usize>, near: &[usize], unit: &Unit) -> Placement {
        if open.len() == 1 && near.len() == 1 {
            return Placement::With(open);
        }
        if self.around == AnchorKind::Recordings {
            return if open.is_empty() {
                Placement::Alone(open)
            } else {
                Placement::With(open)
            };
        }
        let sharing_most = |among: &[usize], names: &BTreeSet<FrameId>| {
            let shared = |at: &usize| {
                let frames = self.anchors.get(*at).map(|anchor| &anchor.frames);
                frames.map_or(0, |frames| frames.intersection(names).count())
            };
            let most = among.iter().map(shared).max().unwrap_or_default();
            let best = among.iter().copied().filter(|at| most > 0 && shared(at) == most);
            self.called_alike(self.nearest(best.collect(), &unit.dir), unit)
        };
        let best = |among: &[usize]| {
            let by_names = unit.names.iter().map(|names| sharing_most(among, names));
            by_names.into_iter().find(|best| !best.is_empty()).unwrap_or_default()
        };
        let homes = best(&open);
        if !homes.is_empty() && homes.len() <= MAX_CANDIDATES {
            return Placement::With(homes);
        }
        let mut beside = best(near);
        // A file that states transforms must be judged somewhere.
        if beside.is_empty() && unit.kinds.states {
            beside = self.nearest(near.to_vec(), &unit.dir);
        }
        Placement::Alone(beside)
    }

    /// Those of these anchors after which a file, or one of its folders, is named: `calibration/alpha.yaml` of `urdf/alpha.urdf`.
    fn called_alike(&self, anchors: Vec<usize>, unit: &Unit) -> Vec<usize> {
        let path = unit
            .members
            .first()
            .map_or(unit.dir.as_path(), |first| first.path.as_path());
        let is_named = |test: &dyn Fn(&Path) -> bool| -> Vec<usize> {
            let paths = anchors
                .iter()
                .filter(|at| self.anchors.get(**at).is_some_and(|anchor| test(&anchor.path)));
            paths.copied().collect()
        };
        let own = stem(path);
        let extends = |long: &str, short: &str| {
            let rest = long.strip_prefix(short).filter(|_| !short.is_empty());
            rest.is_some_and(|rest| rest.starts_with(|letter: char| !letter.is_alphanumeric()))
        };
        let is_in_folder = |anchor: &Path| {
            let common = common_folder([anchor, path].into_iter()).components().count();
            let folders = |path: &Path| {
                let names = path.parent().into_iter().flat_map(Path::components).skip(common);
                names.map(|name| name.as_os_str().to_owned()).collect::<BTreeSet<_>>()
            };
            !folders(anchor).is_disjoint(&folders(path))
        };
        let tests: [&dyn Fn(&Path) -> bool; 3] = [
            &|anchor| stem(anchor) == own,
            &|anchor| extends(&own, &stem(anchor)) || extends(&stem(anchor), &own),
            &is_in_folder,
        ];
        let found = tests.into_iter().map(is_named).find(|named| !named.is_empty());
        found.unwrap_or(anchors)
    }

    /// Those of these anchors that are the fewest folders away.
    fn nearest(&self, anchors: Vec<usize>, from: &Path) -> Vec<usize> {
        let steps = |at: &usize| {
            self.anchors.get(*at).map_or(usize::MAX, |anchor| {
                let common = common_folder([anchor.dir.as_path(), from].into_iter());
                let length = |dir: &Path| dir.components().count();
                length(&anchor.dir) + length(from) - 2 * length(&common)
            })
        };
        let least = anchors.iter().map(steps).min();
        anchors.into_iter().filter(|at| Some(steps(at)) == least).collect()
    }

    fn names(&self, anchors: &[usize]) -> String {
        let (named, more) = anchors.split_at(anchors.len().min(MAX_CANDIDATES));
        let names = named.iter().filter_map(|at| self.anchors.get(*at));
        let names: Vec<String> = names.map(|anchor| format!("`{}`", anchor.name)).collect();
        match more.len() {
            0 => names.join(" and "),
            more => format!("{} and {more} more", names.join(", ")),
        }
    }
}

fn around_robots(robots: Vec<Member>, units: Vec<Unit>, recorded: &BTreeSet<PathBuf>, root: &Path) -> Clusters {
    if robots.is_empty() {
        return around_recordings(units, recorded, root);
    }
    let anchor = |robot: &Member| Anchor {
        dir: robot.dir.clone(),
        path: robot.path.clone(),
        frames: names_of(robot, false).collect(),
        name: robot.display.clone(),
    };
    let anchors: Vec<Anchor> = robots.iter().map(anchor).collect();
    let around = if robots.len() > 1 {
        AnchorKind::Robots
    } else {
        AnchorKind::Robot
    };
    let clusters = robots.into_iter().map(|robot| vec![robot]).collect();
    let (mut clusters, alone) = distributed(units, (&anchors, clusters), recorded, (root, around));
    let rest = around_recordings(alone, recorded, root);
    clusters.members.extend(rest.members);
    clusters.notes.extend(rest.notes);
    clusters
}

/// Files beside recordings, or below or beside their folders, are judged with them; the others folder by folder.
fn around_recordings(units: Vec<Unit>, recorded: &BTreeSet<PathBuf>, root: &Path) -> Clusters {
    let anchor = |dir: &PathBuf| Anchor {
        dir: dir.clone(),
        path: dir.clone(),
        frames: BTreeSet::new(),
        name: dir.display().to_string(),
    };
    let anchors: Vec<Anchor> = recorded.iter().map(anchor).collect();
    let empty = vec![Vec::new(); anchors.len()];
    let (mut clusters, alone) = distributed(units, (&anchors, empty), recorded, (root, AnchorKind::Recordings));
    clusters.members.retain(|members| !members.is_empty());
    let mut folders: BTreeMap<PathBuf, Vec<Member>> = BTreeMap::new();
    let (clouds, others): (Vec<_>, Vec<_>) = alone.into_iter().partition(Unit::is_cloud);
    for unit in others {
        let whole = packages::whole_of(&unit.dir, root);
        folders.entry(whole).or_default().extend(unit.members);
    }
    // Tiles of a map are below the folder with its origin.
    for unit in clouds {
        let mut above = unit.dir.ancestors().take_while(|folder| folder.starts_with(root));
        let home = above.find(|folder| folders.contains_key(*folder)).unwrap_or(root);
        folders.entry(home.to_path_buf()).or_default().extend(unit.members);
    }
    clusters.members.extend(folders.into_values());
    clusters
}

/// Units joined to the anchors that they belong to, and those that belong to none.
fn distributed(
    units: Vec<Unit>,
    (anchors, members): (&[Anchor], Vec<Vec<Member>>),
    recorded: &BTreeSet<PathBuf>,
    (root, around): (&Path, AnchorKind),
) -> (Clusters, Vec<Unit>) {
    let records = Kinds {
        states: false,
        records: true,
    };
    let places: Vec<(PathBuf, Kinds)> = units
        .iter()
        .map(|unit| (unit.dir.clone(), unit.kinds))
        .chain(recorded.iter().map(|dir| (dir.clone(), records)))
        .collect();
    let mut kinds: BTreeMap<&Path, Kinds> = BTreeMap::new();
    for (folder, here) in places
        .iter()
        .flat_map(|(dir, here)| dir.ancestors().map(move |folder| (folder, here)))
    {
        let all = kinds.entry(folder).or_default();
        *all = all.and(*here);
    }
    let mut within: BTreeMap<&Path, Vec<usize>> = BTreeMap::new();
    for (at, anchor) in anchors.iter().enumerate() {
        for folder in anchor.dir.ancestors() {
            within.entry(folder).or_default().push(at);
        }
    }
    let layout = Layout {
        anchors,
        within,
        kinds,
        root,
        around,
    };
    let mut clusters = Clusters {
        members,
        notes: Vec::new(),
    };
    let mut alone = Vec::new();
    let mut robots = Robots::default();
    for unit in units {
        let id = unit.members.first().map(|first| first.id);
        let mut home = layout.home(&unit);
        let mut is_by_numbers = false;
        if let Placement::With(homes) = &mut home
            && homes.len() > 1
            && around != AnchorKind::Recordings
        {
            let fitting = robots.fitting(homes, &clusters, &unit);
            is_by_numbers = !fitting.is_empty();
            if is_by_numbers {
                *homes = fitting;
            }
        }
        match home {
            Placement::With(homes) => {
                let names = layout.names(&homes);
                let note = match homes.len() {
                    _ if around == AnchorKind::Recordings => None,
                    1 if is_by_numbers => Some(format!("checked together with {names}, whose transforms it states")),
                    0 | 1 => None,
                    _ => Some(format!(
                        "checked together with each of {names}: neither folders nor frame names show to which robot it belongs"
                    )),
                };
                clusters.notes.extend(id.zip(note));
                for home in homes {
                    if let Some(cluster) = clusters.members.get_mut(home) {
                        cluster.extend(unit.members.iter().cloned());
                    }
                }
            }
            Placement::Alone(beside) => {
                if !beside.is_empty() {
                    let names = layout.names(&beside);
                    let note = format!(
                        "checked without {names}: neither folders nor frame names show whether it belongs to them"
                    );
                    clusters.notes.extend(id.map(|id| (id, note)));
                }
                alone.push(unit);
            }
        }
    }
    (clusters, alone)
}

/// The robots that files were compared with, by their indices.
#[derive(Default)]
struct Robots(BTreeMap<usize, World>);

impl Robots {
    /// Those of these robots whose transforms the unit states; of several, the ones that match best.
    fn fitting(&mut self, among: &[usize], clusters: &Clusters, unit: &Unit) -> Vec<usize> {
        let mut known: Vec<(Fit, usize)> = Vec::new();
        for at in among {
            let alone = || {
                let robot = clusters.members.get(*at).and_then(|members| members.first());
                world(robot.cloned().into_iter().collect())
            };
            let robot = self.0.entry(*at).or_insert_with(alone);
            let claims = unit.members.iter().flat_map(|member| &member.facts.claims);
            known.push((Fit::new(robot, claims), *at));
        }
        let best = known.iter().map(|(fit, _)| *fit).max();
        known.retain(|(fit, _)| Some(*fit) == best && fit.is_any());
        known.into_iter().map(|(_, at)| at).collect()
    }
}

/// The frames that a member names, or its keys that may be names of frames.
fn names_of(member: &Member, are_keys: bool) -> impl Iterator<Item = FrameId> {
    let used = member.facts.frames.iter();
    let used = used.filter(move |used| (used.role == FrameRole::CalibrationLabel) == are_keys);
    // In a list of sensors, the key is the frame (`extrinsics: {lidar: ...}`).
    let claims = member.facts.claims.iter().filter(move |_| are_keys);
    let keys = claims.flat_map(|claim| claim.frames.iter().flat_map(|(target, source)| [target, source]));
    used.map(|used| &used.frame).chain(keys).map(FrameId::canonical)
}

/// The name of a file up to its first dot: `alpha` of `alpha.urdf.xacro`.
fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.split('.').next().unwrap_or_default().to_lowercase()
}

/// The deepest folder that contains all of these.
fn common_folder<'p>(mut folders: impl Iterator<Item = &'p Path>) -> PathBuf {
    let first = folders.next().map(Path::to_path_buf).unwrap_or_default();
    folders.fold(first, |common, folder| {
        let same = common.components().zip(folder.components()).take_while(|(a, b)| a == b);
        same.map(|(component, _)| component).collect()
    })
}

fn is_fragment(member: &Member) -> bool {
    member.facts.robots.iter().any(|robot| robot.fragment.is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_common_folder_is_the_lowest_one() {
        let common = |folders: &[&str]| common_folder(folders.iter().map(Path::new));
        assert_eq!(common(&["ws/car/config", "ws/car/urdf"]), Path::new("ws/car"));
        assert_eq!(common(&["ws/car", "ws/carrier"]), Path::new("ws"));
        assert_eq!(common(&["ws/car"]), Path::new("ws/car"));
        assert_eq!(common(&["car", "drone"]), Path::new(""));
    }
}
