//! The frames of the platform that a calibration means with names of its own.

use nalgebra::Isometry3;

use crate::analysis::names::{self, has_word, has_word_of};
use crate::math::relation::{Classification, Tolerance, classify};
use crate::world::{FrameId, graph::FrameGraph};

use super::exact;

/// A pair of the platform's frames that may be meant, and how a transform that is stated differs from theirs.
pub(crate) struct Candidate<'g> {
    pub(crate) target: &'g FrameId,
    pub(crate) source: &'g FrameId,
    /// `target_from_source` of the platform.
    pub(crate) pose: Isometry3<f64>,
    pub(crate) off_deg: f64,
    pub(crate) off_m: f64,
    /// The convention error that explains the difference.
    pub(crate) found: Classification,
}

impl<'g> Candidate<'g> {
    /// The pairs whose names are of the right kinds. Where none of them has the transform to the last digits, as it is or with a
    /// convention error, and others have, those.
    pub(crate) fn all(
        graph: &'g FrameGraph,
        (target, source): (&FrameId, &FrameId),
        stated: &Isometry3<f64>,
        exact: &exact::Limits,
    ) -> Vec<Self> {
        let by_names = by_names(graph, target, source, stated);
        if by_names.iter().any(|candidate| candidate.is_met(exact)) {
            return by_names;
        }
        let by_numbers = by_numbers(graph, target, source, stated, exact);
        if by_numbers.is_empty() { by_names } else { by_numbers }
    }

    fn new(target: &'g FrameId, source: &'g FrameId, pose: Isometry3<f64>, stated: &Isometry3<f64>) -> Self {
        let difference = pose.inv_mul(stated);
        Self {
            target,
            source,
            off_deg: difference.rotation.angle().to_degrees(),
            off_m: difference.translation.vector.norm(),
            found: classify(&pose, stated, &Tolerance::default()),
            pose,
        }
    }

    /// Whether the transform stated is that of this pair.
    pub(crate) fn is_within(&self, deg: f64, m: f64) -> bool {
        self.off_deg <= deg && self.off_m <= m
    }

    /// Whether it is, or is with a convention error, to the last digits.
    fn is_met(&self, exact: &exact::Limits) -> bool {
        let is_related = self.found.error().is_some() && exact.fits(&self.pose, &self.found);
        self.is_within(exact.exact_deg, exact.exact_m) || is_related
    }
}

/// Every pair of the platform's frames of these kinds with a rigid transform between them.
fn by_names<'g>(
    graph: &'g FrameGraph,
    target: &FrameId,
    source: &FrameId,
    stated: &Isometry3<f64>,
) -> Vec<Candidate<'g>> {
    let (targets, sources) = (meant(graph, target), meant(graph, source));
    let pairs = targets.iter().flat_map(|a| sources.iter().map(|b| (*a, *b)));
    let found = pairs.filter(|(a, b)| a != b).filter_map(|(a, b)| {
        let (pose, _) = graph.chain(a, b, |edge| edge.is_rigid)?;
        Some(Candidate::new(a, b, pose, stated))
    });
    found.collect()
}

/// Pairs of which one frame is of the right kind, and the other is called anything, whose transform is met to the last digits and not by
/// chance. One frame has to be of its kind: of two strangers nothing tells the direction.
fn by_numbers<'g>(
    graph: &'g FrameGraph,
    target: &FrameId,
    source: &FrameId,
    stated: &Isometry3<f64>,
    exact: &exact::Limits,
) -> Vec<Candidate<'g>> {
    let length_m = stated.translation.vector.norm();
    let mut found: Vec<Candidate<'g>> = Vec::new();
    let mut look = |target: &'g FrameId, source: &'g FrameId| {
        let Some((pose, _)) = graph.chain(target, source, |edge| edge.is_rigid) else {
            return;
        };
        // What every convention error leaves as it is, comes first: it is cheap.
        let is_near = (pose.translation.vector.norm() - length_m).abs() <= exact.exact_m;
        if target == source || !is_near || !exact.tells_alone(&pose) {
            return;
        }
        // Frames in one place are one candidate.
        let is_known = found.iter().any(|one| {
            let apart = one.pose.inv_mul(&pose);
            apart.rotation.angle().to_degrees() <= exact.exact_deg && apart.translation.vector.norm() <= exact.exact_m
        });
        let candidate = Candidate::new(target, source, pose, stated);
        if !is_known && candidate.is_met(exact) {
            found.push(candidate);
        }
    };
    for target in meant(graph, target) {
        graph.frames.iter().for_each(|source| look(target, source));
    }
    for source in meant(graph, source) {
        graph.frames.iter().for_each(|target| look(target, source));
    }
    found
}

/// The platform's frames that a program's word for a sensor may mean.
fn meant<'g>(graph: &'g FrameGraph, role: &FrameId) -> Vec<&'g FrameId> {
    if let Some(own) = graph.frames.get(&role.canonical()) {
        return vec![own];
    }
    let of = |test: &dyn Fn(&FrameId) -> bool| graph.frames.iter().filter(|frame| test(frame)).collect::<Vec<_>>();
    let lidars: &[&[&str]] = &[names::LIDARS, names::LIDAR_MAKERS, &["velo", "os", "pandar"]];
    if has_word(role, names::CAMERAS) {
        let all = of(&|frame| has_word(frame, names::CAMERAS) || names::optical_stem(frame).is_some());
        // Programs that look through cameras mean the axes of images.
        let optical: Vec<&FrameId> = all
            .iter()
            .copied()
            .filter(|frame| names::optical_stem(frame).is_some())
            .collect();
        let cameras = if optical.is_empty() { all } else { optical };
        let numbered: Vec<&FrameId> = cameras
            .iter()
            .copied()
            .filter(|frame| number(frame) == number(role))
            .collect();
        return if numbered.is_empty() { cameras } else { numbered };
    }
    if has_word_of(role, lidars) {
        return of(&|frame| has_word_of(frame, lidars));
    }
    if has_word(role, &["imu", "body"]) {
        return of(&|frame| has_word(frame, names::IMUS));
    }
    if has_word(role, &["base", "ego", "egovehicle", "vehicle", "robot"]) {
        return of(&names::is_base);
    }
    Vec::new()
}

/// The number in a name, `0` and none alike.
fn number(frame: &FrameId) -> u32 {
    let digits = frame.tokens().into_iter().find_map(|token| {
        let start = token.find(|letter: char| letter.is_ascii_digit())?;
        token.get(start..)?.parse().ok()
    });
    digits.unwrap_or(0)
}
