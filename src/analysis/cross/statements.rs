//! Statements about rigid transforms, in pairs about the same two frames.
//!
//! Owns which sources may be compared. Alternatives are no contradictions: two URDF files, or the same key
//! in the files of two devices, state different robots, so only a recording's own description is compared with a file.
//! Rules that judge one source alone take other statements from [`crate::analysis::pairs`].

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::analysis::cross::pair::{Direction, Pair, Rank, Statement, TURNED};
use crate::analysis::places::of_numbers;
use crate::analysis::{cross::blame::oriented, cross::fold::fold, cross::halves::join_halves, cross::roles};
use crate::source::{Confidence, Place, SourceId, SourceKind, packages};
use crate::verdict::Judge;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{Claim, ClaimKind, FrameId, Spelling, World};

/// Up to this many statements of two frames in one folder are each compared with each; of more, each with the first ones and those of similar length.
const MOST_EACH_WITH_EACH: usize = 64;
/// How many of either kind these are: the time that it takes follows the number of statements.
const MOST_REFERENCES: usize = 4;

/// The pairs of statements of a world that are compared, in a fixed order. Where not all pairs are compared, that is reported as not
/// evaluated.
pub(crate) fn pairs(world: &World, out: &mut Judge) -> Vec<Pair> {
    let mut by_frames: BTreeMap<(FrameId, FrameId), Vec<Statement>> = BTreeMap::new();
    for statement in statements(world) {
        let (a, b) = (&statement.target, &statement.source_frame);
        let key = if a <= b {
            (a.clone(), b.clone())
        } else {
            (b.clone(), a.clone())
        };
        by_frames.entry(key).or_default().push(statement);
    }
    let (mut pairs, mut cut) = (Vec::new(), Vec::new());
    for mut statements in by_frames.into_values() {
        add_chains(world, &mut statements);
        statements.sort_by(|a, b| (a.rank, a.bare_quaternion, &a.place).cmp(&(b.rank, b.bare_quaternion, &b.place)));
        let from = pairs.len();
        for (first, second) in each_with_each(world, &statements, &mut cut) {
            let (Some(reference), Some(other)) = (statements.get(first), statements.get(second)) else {
                continue;
            };
            if let Some(pair) = pair(world, reference, other) {
                let mut pair = oriented(pair);
                fold(world, &mut pair, pairs.get_mut(from..).unwrap_or_default());
                pairs.push(pair);
            }
        }
    }
    for (subject, why) in cut {
        out.too_little(subject, why);
    }
    pairs
}

/// Which statements of two frames are compared, by their numbers.
///
/// Files are compared within a folder; descriptions, recordings and launch files with all others.
fn each_with_each(
    world: &World,
    statements: &[Statement],
    cut: &mut Vec<(String, String)>,
) -> BTreeSet<(usize, usize)> {
    let mut groups: BTreeMap<(Rank, Option<&Path>), Vec<usize>> = BTreeMap::new();
    for (number, statement) in statements.iter().enumerate() {
        let is_of_folder = statement.rank == Rank::File && !is_launched(world, statement);
        let path = Path::new(world.path(statement.place.source));
        let folder = is_of_folder.then(|| path.parent().unwrap_or(path));
        groups.entry((statement.rank, folder)).or_default().push(number);
    }
    let is_compared = |(first, second): &(usize, usize)| {
        let both = statements.get(*first).zip(statements.get(*second));
        both.is_some_and(|(a, b)| comparable(world, a, b).is_some())
    };
    let all: Vec<usize> = (0..statements.len()).collect();
    let mut compared = BTreeSet::new();
    for ((_, folder), group) in &groups {
        let is_cut = group.len() > MOST_EACH_WITH_EACH;
        let references = if is_cut { MOST_REFERENCES } else { group.len() };
        let others = if folder.is_some() { group } else { &all };
        let of_group = group.iter().take(references).flat_map(|first| {
            let others = others.iter().filter(move |other| *other != first);
            others.map(move |other| (*other.min(first), *other.max(first)))
        });
        if !is_cut {
            compared.extend(of_group);
            continue;
        }
        let of_group = of_group.chain(of_one_length(statements, group));
        let of_group: BTreeSet<(usize, usize)> = of_group.filter(is_compared).collect();
        if let Some((first, _)) = of_group.first()
            && let Some(first) = statements.get(*first)
        {
            let whose = folder.map_or("in descriptions, recordings and launch files".to_owned(), |folder| {
                format!("in files of `{}`", folder.display())
            });
            let why = format!(
                "of {} statements (more than {MOST_EACH_WITH_EACH}) each was only compared with the first {MOST_REFERENCES} and the \
                 {MOST_REFERENCES} nearest in length: check fewer files in one run",
                group.len()
            );
            let (target, source) = (&first.target, &first.source_frame);
            cut.push((format!("`{target}` from `{source}`, each with each {whose}"), why));
        }
        compared.extend(of_group);
    }
    compared
}

/// Pairs of statements that differ, and whose translations have nearly the same length: convention errors keep the length.
fn of_one_length(statements: &[Statement], group: &[usize]) -> Vec<(usize, usize)> {
    let of_group = group
        .iter()
        .filter_map(|number| Some((*number, statements.get(*number)?)));
    let mut lengths: Vec<(f64, usize, &Statement)> = of_group
        .map(|(number, one)| (one.pose.translation.vector.norm(), number, one))
        .collect();
    lengths.sort_by(|a, b| a.0.total_cmp(&b.0));
    lengths.dedup_by(|a, b| a.2.pose == b.2.pose);
    let near = |(at, (_, first, _)): (usize, &(f64, usize, &Statement))| {
        let behind = lengths.iter().skip(at + 1).take(MOST_REFERENCES);
        behind
            .map(|(_, second, _)| (*first.min(second), *first.max(second)))
            .collect::<Vec<_>>()
    };
    lengths.iter().enumerate().flat_map(near).collect()
}

fn pair(world: &World, reference: &Statement, other: &Statement) -> Option<Pair> {
    let comparable = comparable(world, reference, other)?;
    let turned = reference.target != other.target;
    if turned && !(other.has_rotation && other.has_translation) {
        // A rotation or a translation alone can't be inverted.
        return None;
    }
    let both_rotations = reference.has_rotation && other.has_rotation;
    let both_translations = reference.has_translation && other.has_translation;
    if !both_rotations && !both_translations {
        return None;
    }
    let mut other = other.clone();
    if turned {
        other.pose = other.pose.inverse();
        other.direction = Direction::TurnedRound;
        other.who.push_str(TURNED);
        other.target.clone_from(&reference.target);
        other.source_frame.clone_from(&reference.source_frame);
        std::mem::swap(&mut other.called.0, &mut other.called.1);
    }
    Some(Pair {
        reference: reference.clone(),
        other,
        alternatives: comparable == Comparison::Alternatives,
        repeats: None,
        seconded_by: Vec::new(),
    })
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Comparison {
    Same,
    Alternatives,
}

fn comparable(world: &World, a: &Statement, b: &Statement) -> Option<Comparison> {
    let last = |statement: &Statement| statement.label.rsplit('/').next().map(str::to_owned);
    match (a.rank, b.rank) {
        // Descriptions of several robots; TF of one recording is TREE05's, of several they are several drives.
        (Rank::Urdf, Rank::Urdf) | (Rank::Description, Rank::Description) | (Rank::Tf, Rank::Tf) => None,
        (Rank::File, Rank::File) if a.place.source == b.place.source => {
            (last(a) != last(b) && a.label != b.label).then_some(Comparison::Same)
        }
        // One program's files in a folder are of several robots.
        (Rank::File, Rank::File) if a.roles.is_some() && a.roles == b.roles => None,
        // Frames of one letter (`T_BS`) mean "the sensor of this file".
        (Rank::File, Rank::File) if is_letter(&a.target) || is_letter(&a.source_frame) => None,
        // Two launch files are two ways to start.
        (Rank::File, Rank::File) if is_launched(world, a) && is_launched(world, b) => None,
        (Rank::File, Rank::File) if is_launched(world, a) || is_launched(world, b) => Some(Comparison::Same),
        (Rank::File, Rank::File) => {
            let folder = |one: &Statement| Path::new(world.path(one.place.source)).parent();
            let whole = |one: &Statement| Some(packages::whole_of(folder(one)?, Path::new("")));
            if folder(a) != folder(b) && whole(a) != whole(b) {
                return None;
            }
            Some(if last(a) == last(b) {
                Comparison::Alternatives
            } else {
                Comparison::Same
            })
        }
        _ => Some(Comparison::Same),
    }
}

/// Whether a launch file or a script publishes it.
fn is_launched(world: &World, statement: &Statement) -> bool {
    let source = world.source(statement.place.source);
    source.is_some_and(|source| source.kind == SourceKind::Launch)
}

fn is_letter(frame: &FrameId) -> bool {
    frame.as_str().chars().count() == 1
}

/// All statements about rigid pairs.
pub(crate) fn statements(world: &World) -> Vec<Statement> {
    let files = world.claims.iter().filter_map(|claim| from_claim(world, claim));
    let edges = world
        .bags
        .iter()
        .flat_map(|bag| bag.tf.iter().map(move |edge| (bag.source, edge)));
    let tf = edges.filter_map(|(source, edge)| {
        let first = edge.first().filter(|_| edge.is_static || edge.is_repeated())?;
        Some(Statement {
            target: edge.parent.canonical(),
            source_frame: edge.child.canonical(),
            pose: first.pose.isometry(),
            has_rotation: true,
            has_translation: true,
            who: format!("TF on `{}`", edge.topic),
            place: Place::message(source, first.at.clone()),
            reading: Confidence::Certain,
            label: edge.topic.clone(),
            rpy: None,
            direction: Direction::AsStated,
            rank: Rank::Tf,
            bare_quaternion: false,
            key: None,
            called: (edge.parent.canonical(), edge.child.canonical()),
            roles: None,
        })
    });
    let mut statements: Vec<Statement> = files.chain(tf).collect();
    join_halves(&mut statements);
    statements
}

fn from_claim(world: &World, claim: &Claim) -> Option<Statement> {
    let (target, source_frame) = claim.frames.as_ref()?;
    if !claim.is_rigid() {
        return None;
    }
    let path = world.path(claim.place.source);
    let stated = (target.canonical(), source_frame.canonical());
    let (target, source_frame) = match &claim.kind {
        ClaimKind::File { dialect, .. } => (
            roles::role(world, dialect, path, target),
            roles::role(world, dialect, path, source_frame),
        ),
        ClaimKind::Joint { .. } => stated.clone(),
    };
    if target == source_frame {
        return None;
    }
    // A name that was mapped to another one is a guess, as a role is.
    let is_guessed = (&target, &source_frame) != (&stated.0, &stated.1);
    let (rank, who) = match &claim.kind {
        ClaimKind::Joint { joint, .. } => (joint_rank(world, claim.place.source), format!("joint `{joint}`")),
        ClaimKind::File { .. } => (Rank::File, format!("`{}`", claim.label)),
    };
    Some(Statement {
        target,
        source_frame,
        pose: claim.pose?.isometry(),
        has_rotation: claim.has_rotation,
        has_translation: claim.has_translation,
        who,
        place: claim.place.clone(),
        reading: claim.reading,
        label: claim.label.clone(),
        rpy: match claim.spelling {
            Spelling::Rpy { rpy, .. } => Some(rpy),
            _ => None,
        },
        direction: Direction::AsStated,
        rank,
        key: claim.is_of_a_key().then(|| claim.label.clone()),
        bare_quaternion: matches!(claim.spelling, Spelling::Quaternion { .. }),
        called: stated,
        roles: match &claim.kind {
            ClaimKind::File { dialect, roles } if *roles || is_guessed => Some(dialect.clone()),
            _ => None,
        },
    })
}

fn joint_rank(world: &World, id: SourceId) -> Rank {
    match world.source(id).map(|source| source.kind) {
        Some(SourceKind::RobotDescription) => Rank::Description,
        _ => Rank::Urdf,
    }
}

/// Where a description connects both frames only over other frames, its composed chain is one more statement.
fn add_chains(world: &World, statements: &mut Vec<Statement>) {
    let Some(first) = statements.iter().find(|s| s.rank == Rank::File || s.rank == Rank::Tf) else {
        return;
    };
    let (target, source_frame) = (first.target.clone(), first.source_frame.clone());
    for rank in [Rank::Urdf, Rank::Description, Rank::Tf] {
        if !statements.iter().any(|statement| statement.rank == rank) {
            statements.extend(chain_of(world, rank, &target, &source_frame));
        }
    }
}

/// The transform that a description, or TF, composes between two frames.
pub(crate) fn described(world: &World, target: &FrameId, source_frame: &FrameId) -> Option<Statement> {
    let mut ranks = [Rank::Urdf, Rank::Description, Rank::Tf].into_iter();
    ranks.find_map(|rank| chain_of(world, rank, target, source_frame))
}

fn chain_of(world: &World, rank: Rank, target: &FrameId, source_frame: &FrameId) -> Option<Statement> {
    let graph = world.graph();
    let rank_of = |edge: &Edge| match edge.origin {
        EdgeOrigin::Joint(index) => world
            .claims
            .get(index)
            .map_or(Rank::Urdf, |claim| joint_rank(world, claim.place.source)),
        EdgeOrigin::Published(_) => Rank::File,
        EdgeOrigin::Tf(..) => Rank::Tf,
    };
    let (pose, steps) = graph.chain(target, source_frame, |edge| edge.is_rigid && rank_of(edge) == rank)?;
    let last = steps.last().and_then(|step| graph.edges.get(step.edge))?;
    Some(Statement {
        target: target.clone(),
        source_frame: source_frame.clone(),
        pose,
        has_rotation: true,
        has_translation: true,
        who: match steps.len() {
            1 => "the transform of the tree".to_owned(),
            several => format!("the chain of {several} transforms"),
        },
        place: of_numbers(world, last)?,
        reading: Confidence::Certain,
        label: "chain".to_owned(),
        rpy: None,
        direction: Direction::AsStated,
        rank,
        bare_quaternion: false,
        key: None,
        called: (target.clone(), source_frame.clone()),
        roles: None,
    })
}

/// Whether two statements on different frames may be of one platform, so that one may be composed with the other.
pub(crate) fn are_of_one_platform(world: &World, a: &Statement, b: &Statement) -> bool {
    if a.place.source == b.place.source {
        return true;
    }
    let is_file = |one: &Statement| one.rank == Rank::File;
    match (is_file(a), is_file(b)) {
        (false, false) => a.rank == b.rank,
        _ => comparable(world, a, b) == Some(Comparison::Same),
    }
}
