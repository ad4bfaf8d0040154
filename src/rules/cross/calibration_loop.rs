//! CROSS03: transforms of one calibration that do not close a loop.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Isometry3;

use crate::advice::stated::settled_by_user;
use crate::analysis::cross::pair::Statement;
use crate::analysis::cross::statements::{are_of_one_platform, described, statements};
use crate::math::relation::{Relation, Tolerance, classify};
use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::world::{FrameId, World};

pub(crate) struct CalibrationLoop;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    edge_deg: f64,
    edge_m: f64,
    warn_sigmas: f64,
    error_sigmas: f64,
}

/// Three transforms that close a loop: `a_from_b`, `b_from_c`, `c_from_a`.
struct Loop<'s> {
    frames: [&'s FrameId; 3],
    /// In the order of the loop, each with its statement.
    edges: [(Isometry3<f64>, &'s Statement); 3],
}

impl Rule for CalibrationLoop {
    const NEEDS: &'static [Need] = &[Need::Calibration];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let all = statements(world);
        let mut by_source: BTreeMap<SourceId, Vec<&Statement>> = BTreeMap::new();
        for statement in all.iter().filter(|statement| statement.is_of_a_file()) {
            if statement.has_rotation && statement.has_translation {
                by_source.entry(statement.place.source).or_default().push(statement);
            }
        }
        for (source, statements) in &by_source {
            let source = *source;
            let (loops, are_more) = loops(statements);
            for one in loops {
                one.judge(world.path(source), limits, out);
            }
            if are_more {
                let why = format!(
                    "only the first {MAX_LOOPS} loops of three frames were checked: give fewer files in one run"
                );
                let subject = format!("more loops in {}", world.path(source));
                out.too_little(subject, why);
            }
        }
        judge_across(world, by_source.values().flatten().copied().collect(), limits, out);
    }
}

/// Most frames of files between which transforms of a description are looked up.
const MAX_FRAMES: usize = 32;

/// Loops whose transforms come from several sources: files, and what a description or TF states between their frames.
fn judge_across(world: &World, files: Vec<&Statement>, limits: &Limits, out: &mut Judge) {
    let is_named = |frame: &FrameId| frame.as_str().chars().count() > 1;
    let files: Vec<&Statement> = files
        .into_iter()
        .filter(|one| is_named(&one.target) && is_named(&one.source_frame))
        .collect();
    let known = &world.graph().frames;
    let frames = files.iter().flat_map(|one| [&one.target, &one.source_frame]);
    let frames: Vec<&FrameId> = frames
        .filter(|frame| known.contains(*frame))
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    let frames = frames.get(..MAX_FRAMES.min(frames.len())).unwrap_or_default();
    let pairs = frames
        .iter()
        .enumerate()
        .flat_map(|(index, a)| frames.iter().skip(index + 1).map(move |b| (*a, *b)));
    let described: Vec<Statement> = pairs.filter_map(|(a, b)| described(world, a, b)).collect();
    let all: Vec<&Statement> = files.into_iter().chain(&described).collect();
    let (loops, _) = loops(&all);
    for one in loops {
        let [a, b, c] = one.edges.each_ref().map(|(_, statement)| *statement);
        let several = a.place.source != b.place.source || b.place.source != c.place.source;
        let of_files = [a, b, c].iter().filter(|one| one.is_of_a_file()).count();
        let fit = [(a, b), (b, c), (a, c)];
        // With only one transform from a file it is a pair that CROSS01 judges against the composed chain.
        if several
            && of_files >= 2
            && fit
                .into_iter()
                .all(|(one, other)| are_of_one_platform(world, one, other))
        {
            let paths: BTreeSet<&str> = [a, b, c].map(|one| world.path(one.place.source)).into_iter().collect();
            let paths: Vec<&str> = paths.into_iter().collect();
            one.judge(&paths.join(" and "), limits, out);
        }
    }
}

/// Loops of one file that are judged; a file that connects each of forty frames to all others has as many.
const MAX_LOOPS: usize = 10_000;

/// The loops of three frames, and whether there are more of them; of several statements on one pair the first counts (the others
/// are CROSS01's).
fn loops<'s>(statements: &[&'s Statement]) -> (Vec<Loop<'s>>, bool) {
    let mut edges: BTreeMap<(&FrameId, &FrameId), (Isometry3<f64>, &'s Statement)> = BTreeMap::new();
    for statement in statements {
        let (target, source) = (&statement.target, &statement.source_frame);
        if target != source && !edges.contains_key(&(target, source)) {
            edges.insert((target, source), (statement.pose, *statement));
            edges.insert((source, target), (statement.pose.inverse(), *statement));
        }
    }
    let mut beside: BTreeMap<&FrameId, Vec<&FrameId>> = BTreeMap::new();
    for (target, source) in edges.keys() {
        beside.entry(*target).or_default().push(*source);
    }
    let of = |frame: &FrameId| beside.get(frame).map_or(&[][..], Vec::as_slice);
    let mut loops = Vec::new();
    for (&(a, b), ab) in edges.iter().filter(|((a, b), _)| a < b) {
        // Look through the shorter list of neighbours: a frame that all others are connected to would make this quadratic.
        let fewer = if of(a).len() < of(b).len() { of(a) } else { of(b) };
        for c in fewer.iter().copied().filter(|c| *c > b) {
            let (Some(bc), Some(ca)) = (edges.get(&(b, c)), edges.get(&(c, a))) else {
                continue;
            };
            if loops.len() == MAX_LOOPS {
                return (loops, true);
            }
            loops.push(Loop {
                frames: [a, b, c],
                edges: [*ab, *bc, *ca],
            });
        }
    }
    (loops, false)
}

/// The residual of a closed loop over that of three calibrations.
fn sigmas(closure: &Isometry3<f64>, limits: &Limits) -> f64 {
    let (angle_deg, distance_m) = (closure.rotation.angle().to_degrees(), closure.translation.vector.norm());
    (angle_deg / limits.edge_deg).max(distance_m / limits.edge_m) / 3_f64.sqrt()
}

/// The error that one of the three has, as a sentence.
fn wrong(culprit: &Statement, relation: Relation) -> String {
    match relation {
        Relation::Inverse => format!(
            "{} is inverted: the numbers take points in the opposite direction.",
            culprit.who
        ),
        _ => format!("Error in {}: {}", culprit.who, relation.describe()),
    }
}

/// What to do about the errors that would each close the loop.
fn help(culprits: &[(&Statement, Relation)], is_reversed: bool) -> String {
    match culprits {
        _ if is_reversed => "look up in which direction the program that wrote the file means its keys:\n(1) opposite to the direction that is read here: nothing is wrong\n(2) as read here: the numbers of all keys are inverted: invert them, or exchange the two frames in the name of each key".to_owned(),
        [] => "calibrate the three transforms together, or find the wrong one and calibrate that one again".to_owned(),
        [(culprit, Relation::Inverse)] => format!(
            "invert the numbers of {0}, or exchange the two frames in the name of {0} if the numbers are right; calibrate again only if the loop does not close then",
            culprit.who
        ),
        [(culprit, _)] => format!("correct that error in {}; calibrate again only if the loop does not close then", culprit.who),
        _ => "find out which of these errors was made, and correct that error; calibrate again only if the loop does not close then".to_owned(),
    }
}

impl Loop<'_> {
    /// What an edge would have to be for the loop to close.
    fn expected(&self, index: usize) -> Isometry3<f64> {
        let [next, last] = [(index + 1) % 3, (index + 2) % 3].map(|at| self.edges.get(at).map(|edge| edge.0));
        (next.unwrap_or_default() * last.unwrap_or_default()).inverse()
    }

    /// Whether it closes if all statements mean the other direction that only keys of files state, if there are several.
    fn closes_reversed(&self, limits: &Limits) -> bool {
        let keys = self.edges.iter().filter(|(_, one)| one.key.is_some()).count();
        let pose = |(pose, one): &(Isometry3<f64>, &Statement)| if one.key.is_some() { pose.inverse() } else { *pose };
        let closure = self
            .edges
            .iter()
            .fold(Isometry3::identity(), |sum, edge| sum * pose(edge));
        keys > 1 && sigmas(&closure, limits) <= limits.warn_sigmas
    }

    fn judge(&self, whose: &str, limits: &Limits, out: &mut Judge) {
        let [a, b, c] = self.frames;
        let subject = format!("loop of `{a}`, `{b}` and `{c}` in {whose}");
        let closure = self.edges.iter().fold(Isometry3::identity(), |sum, edge| sum * edge.0);
        let (angle_deg, distance_m) = (closure.rotation.angle().to_degrees(), closure.translation.vector.norm());
        let sigmas = sigmas(&closure, limits);
        let measured = [
            Measured::new("residual rotation of the loop", angle_deg, "deg").turn(),
            Measured::new("residual distance of the loop", distance_m, "m"),
            Measured::new("residual / expected error of three calibrations", sigmas, "1").limit(limits.warn_sigmas),
        ];
        if sigmas <= limits.warn_sigmas {
            return out.pass(subject, measured);
        }
        let Some((_, first)) = self.edges.first() else { return };
        let tolerance = Tolerance {
            has_quaternion: self.edges.iter().any(|(_, one)| one.is_quaternion()),
            ..Tolerance::default()
        };
        let culprits: Vec<(&Statement, Relation)> = (0..3)
            .filter_map(|index| {
                let (held, statement) = self.edges.get(index)?;
                let relation = classify(&self.expected(index), held, &tolerance).error()?;
                Some((*statement, relation))
            })
            .collect();
        let is_reversed = self.closes_reversed(limits);
        let message = match culprits.as_slice() {
            [(culprit, Relation::Inverse)] if !is_reversed => format!(
                "{} is inverted: the loop of three frames is off by {angle_deg:.2} deg and {distance_m:.3} m",
                culprit.who
            ),
            _ => format!("`{a}`, `{b}` and `{c}` do not close a loop: off by {angle_deg:.2} deg and {distance_m:.3} m"),
        };
        let (detail, place, relation) = match culprits.as_slice() {
            [(culprit, relation)] => (
                format!(
                    "{} The loop of `{a}`, `{b}` and `{c}` closes if that is corrected.",
                    wrong(culprit, *relation)
                ),
                culprit.place.clone(),
                Some(relation.word()),
            ),
            [] => (String::new(), first.place.clone(), None),
            several => {
                let named: Vec<String> = several
                    .iter()
                    .map(|(culprit, relation)| format!("{} ({})", culprit.who, relation.word()))
                    .collect();
                let detail = format!(
                    "The loop closes if one of these errors is corrected: {}.",
                    named.join(", ")
                );
                (detail, first.place.clone(), None)
            }
        };
        let finding = if sigmas > limits.error_sigmas {
            Finding::error(subject, message, place)
        } else {
            Finding::warning(subject, message, place)
        };
        let reading = self.edges.iter().map(|(_, statement)| statement.reading).min();
        let mut finding = finding.likely().detail(detail).help(help(&culprits, is_reversed));
        if let Some(reading) = reading {
            finding = finding.confidence(reading);
        }
        if is_reversed {
            let detail =
                "The loop closes if all keys of the file are meant in the opposite direction; then nothing is wrong.";
            finding = finding.hint().detail(detail);
        }
        // That two files mean the same sensor by `lidar` is a guess; within one file it is certain.
        let first = first.place.source;
        let is_of_several = self.edges.iter().any(|(_, one)| one.place.source != first);
        if is_of_several && self.edges.iter().any(|(_, one)| one.is_guess()) {
            finding = finding.hint();
        }
        if let Some(relation) = relation {
            finding = finding.relation(relation);
        }
        // A transform that contradicts another source on its own two frames opens the loop.
        finding = culprits.iter().fold(finding, |finding, (culprit, _)| {
            finding.unless_about(codes::CROSS02, culprit.who.clone())
        });
        for (_, one) in &self.edges {
            finding = finding.unless_about(codes::CROSS02, format!("{} has the transform of ", one.who));
        }
        for frame in self.frames {
            finding = finding.unless_about(codes::CROSS07, format!("`{frame}` has the transform of the robot's `"));
        }
        if culprits.is_empty() {
            finding = finding.unless(codes::CROSS01);
        }
        finding = settled_by_user(finding, self.edges.iter().map(|(_, one)| (*one, None)));
        let at = finding.places.first().map(|label| label.place.clone());
        for (_, statement) in &self.edges {
            finding = if Some(&statement.place) == at.as_ref() {
                finding.label(statement.who.clone())
            } else {
                finding.related(statement.place.clone(), statement.who.clone())
            };
        }
        out.fail(finding.measured(measured));
    }
}
