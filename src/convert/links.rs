//! The transforms that were read, as links between frames, and chains of them.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use nalgebra::Isometry3;

use crate::math::rotation;
use crate::run::Run;
use crate::source::{Confidence, LineIndex, Place, SourcePart};
use crate::world::{Claim, World};

use super::ConvertRequest;

/// One transform with its two frames.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub(super) target: String,
    pub(super) source: String,
    pub(super) pose: Isometry3<f64>,
    /// The key it is stated under.
    pub(super) label: String,
    /// File and line.
    pub(super) place: String,
    pub(super) reading: Confidence,
}

/// All of them.
pub(super) struct Links {
    pub(super) all: Vec<Link>,
}

impl Links {
    /// The rigid transforms of a run: of files, of fixed joints and of latched TF; a rotation and a translation of one pair that are stated
    /// apart are combined.
    pub(super) fn of(run: &Run, wish: &ConvertRequest) -> Result<Self, String> {
        let mut all = Vec::new();
        for world in &run.worlds {
            let mut halves: Vec<(&Claim, (String, String))> = Vec::new();
            for claim in world.claims.iter().filter(|claim| claim.is_rigid()) {
                let Some(frames) = frames_of(claim, wish) else { continue };
                let Some(pose) = &claim.pose else { continue };
                if claim.has_rotation && claim.has_translation {
                    all.push(link(run, claim, frames, pose.isometry()));
                } else {
                    halves.push((claim, frames));
                }
            }
            all.extend(joined(run, &halves));
            all.extend(latched(run, world));
        }
        let open = run
            .worlds
            .iter()
            .flat_map(|world| &world.claims)
            .filter(|claim| claim.frames.is_none());
        let open: Vec<&Claim> = open
            .filter(|claim| claim.has_rotation && claim.has_translation)
            .collect();
        if wish.is.is_some() && wish.key.is_none() && open.len() > 1 {
            let labels: Vec<&str> = open.iter().map(|claim| claim.label.as_str()).collect();
            return Err(format!(
                "--is names the frames of one transform, and {} have none: choose one with --key: {}",
                open.len(),
                labels.join(", ")
            ));
        }
        if all.is_empty() {
            return Err(match open.first() {
                Some(claim) => format!(
                    "`{}` does not state its frames: name them with --is \"TARGET from SOURCE\"",
                    claim.label
                ),
                None => "the inputs state no transform".to_owned(),
            });
        }
        Ok(Self { all })
    }

    /// The names of all frames, sorted.
    pub(super) fn frames(&self) -> Vec<String> {
        let names: BTreeSet<&String> = self.all.iter().flat_map(|link| [&link.target, &link.source]).collect();
        names.into_iter().cloned().collect()
    }

    /// A shortest chain `target_from_source`: links, and whether each is taken as it is. Of several between two frames the first counts.
    pub(super) fn chain(&self, target: &str, source: &str) -> Option<Vec<(&Link, bool)>> {
        let knows = |frame: &str| self.all.iter().any(|link| link.target == frame || link.source == frame);
        if !knows(target) || !knows(source) {
            return None;
        }
        let mut from: BTreeMap<&str, (&str, &Link, bool)> = BTreeMap::new();
        let mut queue = VecDeque::from([target]);
        while let Some(frame) = queue.pop_front() {
            for link in &self.all {
                let (next, is_forward) = if link.target == frame {
                    (link.source.as_str(), true)
                } else if link.source == frame {
                    (link.target.as_str(), false)
                } else {
                    continue;
                };
                if next != target && !from.contains_key(next) {
                    from.insert(next, (frame, link, is_forward));
                    queue.push_back(next);
                }
            }
        }
        let mut steps = Vec::new();
        let mut at = source;
        while at != target {
            let (before, link, is_forward) = *from.get(at)?;
            steps.push((link, is_forward));
            at = before;
        }
        steps.reverse();
        Some(steps)
    }
}

/// The frames that a statement names, or that the user gives for it.
fn frames_of(claim: &Claim, wish: &ConvertRequest) -> Option<(String, String)> {
    let is_meant = wish.key.as_deref() == Some(claim.label.as_str());
    let is_open = claim.frames.is_none() && (is_meant || wish.key.is_none());
    if let Some(said) = wish.is.as_ref().filter(|_| is_meant || is_open) {
        return Some(said.clone());
    }
    let (target, source) = claim.frames.as_ref()?;
    Some((
        target.canonical().as_str().to_owned(),
        source.canonical().as_str().to_owned(),
    ))
}

fn link(run: &Run, claim: &Claim, (target, source): (String, String), pose: Isometry3<f64>) -> Link {
    Link {
        target,
        source,
        pose,
        label: claim.label.clone(),
        place: place(run, &claim.place),
        reading: claim.reading,
    }
}

/// A rotation and a translation of one pair, perhaps one of them stated as the inverse.
fn joined(run: &Run, halves: &[(&Claim, (String, String))]) -> Vec<Link> {
    let mut links = Vec::new();
    for (claim, (target, source)) in halves.iter().filter(|(claim, _)| claim.has_rotation) {
        let Some(turn) = claim.pose.map(|pose| pose.isometry().rotation) else {
            continue;
        };
        let other = halves.iter().find(|(other, (a, b))| {
            let is_pair = (a, b) == (target, source) || (b, a) == (target, source);
            is_pair && other.has_translation && other.place.source == claim.place.source
        });
        let Some((other, (a, _))) = other else { continue };
        let Some(shift) = other.pose.map(|pose| pose.isometry().translation) else {
            continue;
        };
        let pose = rotation::pose_of_halves(turn, shift, a != target);
        let mut whole = link(run, claim, (target.clone(), source.clone()), pose);
        whole.label = format!("{}` and `{}", claim.label, other.label);
        whole.reading = claim.reading.min(other.reading);
        links.push(whole);
    }
    links
}

fn latched(run: &Run, world: &World) -> Vec<Link> {
    let edges = world
        .bags
        .iter()
        .flat_map(|bag| bag.tf.iter().map(move |edge| (bag, edge)));
    edges
        .filter(|(_, edge)| edge.is_static)
        .filter_map(|(bag, edge)| {
            let sample = edge.first()?;
            Some(Link {
                target: edge.parent.canonical().as_str().to_owned(),
                source: edge.child.canonical().as_str().to_owned(),
                pose: sample.pose.isometry(),
                label: edge.topic.clone(),
                place: place(run, &Place::message(bag.source, sample.at.clone())),
                reading: Confidence::Certain,
            })
        })
        .collect()
}

/// `file:line`, or the file.
fn place(run: &Run, place: &Place) -> String {
    let Some(source) = run.sources.get(place.source.0 as usize) else {
        return "?".to_owned();
    };
    match &place.at {
        SourcePart::Text(span) => {
            let line = LineIndex::new(&source.text).locate(&source.text, span.start).line;
            format!("{}:{line}", source.path)
        }
        _ => source.path.clone(),
    }
}
