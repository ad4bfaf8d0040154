//! The frames of the robot that a calibration means by its own names.

use std::cell::{Cell, OnceCell};
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Isometry3;

use crate::analysis::names::{self, has_word, has_word_of};
use crate::math::relation::{Classification, Tolerance, classify};
use crate::world::{FrameId, World, graph::FrameGraph};

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

/// A transform that a calibration states between frames with names of its own: `target_from_source`.
#[derive(Clone, Copy)]
pub(crate) struct StatedTransform<'c> {
    pub(crate) target: &'c FrameId,
    pub(crate) source: &'c FrameId,
    pub(crate) pose: Isometry3<f64>,
    /// Whether it is written as a quaternion.
    pub(crate) is_quaternion: bool,
}

impl<'g> Candidate<'g> {
    fn new(
        world: &World,
        (target, source, pose): (&'g FrameId, &'g FrameId, Isometry3<f64>),
        stated: &StatedTransform,
    ) -> Self {
        let difference = pose.inv_mul(&stated.pose);
        // What TF states is a quaternion, too.
        let tolerance = Tolerance {
            has_quaternion: stated.is_quaternion || world.bags.iter().any(|bag| !bag.tf.is_empty()),
            ..Tolerance::default()
        };
        Self {
            target,
            source,
            off_deg: difference.rotation.angle().to_degrees(),
            off_m: difference.translation.vector.norm(),
            found: classify(&pose, &stated.pose, &tolerance),
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

/// All transforms that a file states, by their frames.
#[derive(Default)]
pub(crate) struct FileTransforms<'s> {
    by_target: BTreeMap<&'s FrameId, Vec<StatedTransform<'s>>>,
    by_source: BTreeMap<&'s FrameId, Vec<StatedTransform<'s>>>,
}

impl<'s> FileTransforms<'s> {
    pub(crate) fn add(&mut self, stated: StatedTransform<'s>) {
        self.by_target.entry(stated.target).or_default().push(stated);
        self.by_source.entry(stated.source).or_default().push(stated);
    }

    /// Those that have one of the two frames of `stated` in the same place.
    fn sharing<'a>(&'a self, stated: &'a StatedTransform) -> impl Iterator<Item = &'a StatedTransform<'s>> {
        let targets = self.by_target.get(stated.target).into_iter().flatten();
        let sources = self.by_source.get(stated.source).into_iter().flatten();
        let targets = targets.filter(|other| other.source != stated.source);
        targets.chain(sources.filter(|other| other.target != stated.target))
    }
}

/// Looks for the frames of a platform that transforms of calibrations are meant for.
pub(crate) struct Search<'g> {
    world: &'g World,
    exact: &'g exact::Limits,
    kinds: OnceCell<Kinds<'g>>,
    /// Pairs of frames that were tried.
    looked: Cell<usize>,
}

/// Most pairs of frames that are tried for all transforms of calibrations: a hundred transforms on a robot of two hundred frames.
const MOST_PAIRS: usize = 4_000_000;

impl<'g> Search<'g> {
    pub(crate) fn new(world: &'g World, exact: &'g exact::Limits) -> Self {
        Self {
            world,
            exact,
            kinds: OnceCell::new(),
            looked: Cell::new(0),
        }
    }

    /// Whether the most pairs were tried: what was found may be incomplete.
    pub(crate) fn is_spent(&self) -> bool {
        self.looked.get() > MOST_PAIRS
    }

    /// Counts a pair that is tried. Whether it may be.
    fn look(&self) -> bool {
        self.looked.set(self.looked.get() + 1);
        !self.is_spent()
    }

    /// The robot's frames that a program's name for a sensor may mean: by their names, else by what is published in them.
    fn meant(&self, role: &FrameId) -> Vec<&'g FrameId> {
        let kinds = self.kinds.get_or_init(|| Kinds::new(self.world.graph()));
        let named = kinds.named(self.world.graph(), role);
        if named.is_empty() {
            published(self.world, role)
        } else {
            named
        }
    }

    /// The pairs whose names are of the right kinds. If none of them has the transform to the last digits (as stated or with a
    /// convention error), but other pairs have, those. `of_file` is all that the file states.
    pub(crate) fn candidates(&self, stated: &StatedTransform, of_file: &FileTransforms) -> Vec<Candidate<'g>> {
        if self.is_spent() {
            return Vec::new();
        }
        let by_names = self.by_names(stated);
        if by_names.iter().any(|candidate| candidate.is_met(self.exact)) {
            return by_names;
        }
        let mut by_numbers = self.by_numbers(stated);
        if by_numbers.is_empty() {
            by_numbers = self.by_shared_frame(stated, of_file);
        }
        if by_numbers.is_empty() { by_names } else { by_numbers }
    }

    /// Every pair of the platform's frames of these kinds with a rigid transform between them.
    fn by_names(&self, stated: &StatedTransform) -> Vec<Candidate<'g>> {
        let (targets, sources) = (self.meant(stated.target), self.meant(stated.source));
        let pairs = targets.iter().flat_map(|a| sources.iter().map(|b| (*a, *b)));
        let found = pairs.filter(|(a, b)| a != b).filter_map(|(a, b)| {
            let pose = self.world.graph().rigid().between(a, b).filter(|_| self.look())?;
            Some(Candidate::new(self.world, (a, b, pose), stated))
        });
        found.collect()
    }

    /// Pairs with one frame of the right kind and the other of any name, whose transform is equal to the last digits and hardly by
    /// chance.
    fn by_numbers(&self, stated: &StatedTransform) -> Vec<Candidate<'g>> {
        let rigid = self.world.graph().rigid();
        let mut found: Vec<Candidate<'g>> = Vec::new();
        let sides = [(stated.target, true), (stated.source, false)];
        for (side, is_target) in sides {
            for frame in self.meant(side) {
                for (other, _) in rigid.cluster(frame).iter().take_while(|_| self.look()) {
                    let (target, source) = if is_target { (frame, other) } else { (other, frame) };
                    if let Some(pose) = rigid.between(target, source) {
                        self.add(&mut found, (target, source, pose), stated, exact::Limits::is_unique);
                    }
                }
            }
        }
        found
    }

    /// Pairs of frames of any name. One pair alone does not determine the direction; where a file states several transforms of one
    /// frame (`body` of each camera), the robot's frame that all of them share does.
    fn by_shared_frame(&self, stated: &StatedTransform, of_file: &FileTransforms) -> Vec<Candidate<'g>> {
        let mut others = of_file.sharing(stated).peekable();
        let mut own = if others.peek().is_none() {
            Vec::new()
        } else {
            self.specific_pairs(stated)
        };
        if own.is_empty() {
            return own;
        }
        let others = others.map(|other| (other.target == stated.target, self.specific_pairs(other)));
        let others: Vec<(bool, Vec<Candidate>)> = others.collect();
        own.retain(|candidate| {
            others.iter().any(|(is_target, others)| {
                others.iter().any(|other| {
                    let (same_target, same_source) =
                        (candidate.target == other.target, candidate.source == other.source);
                    let shares = if *is_target {
                        same_target && !same_source
                    } else {
                        same_source && !same_target
                    };
                    shares && candidate.found.error() == other.found.error()
                })
            })
        });
        own
    }

    /// The pairs of all frames whose transform is equal to the last digits, and specific.
    fn specific_pairs(&self, stated: &StatedTransform) -> Vec<Candidate<'g>> {
        let mut found = Vec::new();
        for cluster in &self.world.graph().rigid().clusters {
            for (target, at_target) in cluster {
                for (source, at_source) in cluster.iter().take_while(|_| self.look()) {
                    let pair = (target, source, at_target.inv_mul(at_source));
                    self.add(&mut found, pair, stated, exact::Limits::is_distinctive);
                }
            }
        }
        found
    }

    /// Adds a pair whose transform is specific and equal to the last digits. Coincident frames are one candidate.
    fn add(
        &self,
        found: &mut Vec<Candidate<'g>>,
        (target, source, pose): (&'g FrameId, &'g FrameId, Isometry3<f64>),
        stated: &StatedTransform,
        is_specific: fn(&exact::Limits, &Isometry3<f64>) -> bool,
    ) {
        let (exact, length) = (self.exact, |pose: &Isometry3<f64>| pose.translation.vector.norm());
        // The length first: it is cheap, and every convention error keeps it.
        let is_near = (length(&pose) - length(&stated.pose)).abs() <= exact.exact_m;
        if target == source || !is_near || !is_specific(exact, &pose) {
            return;
        }
        let is_known = found.iter().any(|one| {
            let apart = one.pose.inv_mul(&pose);
            apart.rotation.angle().to_degrees() <= exact.exact_deg && length(&apart) <= exact.exact_m
        });
        let candidate = Candidate::new(self.world, (target, source, pose), stated);
        if !is_known && candidate.is_met(exact) {
            found.push(candidate);
        }
    }
}

/// The robot's frames that this name may mean, by what is published in them.
fn published<'g>(world: &'g World, role: &FrameId) -> Vec<&'g FrameId> {
    let types: &[&str] = if has_word(role, names::CAMERAS) {
        &["CameraInfo", "Image", "CompressedImage"]
    } else if has_word_of(role, LIDAR_WORDS) {
        &["PointCloud2", "PointCloud", "LaserScan", "MultiEchoLaserScan"]
    } else if has_word(role, &["imu", "body"]) {
        &["Imu"]
    } else {
        return Vec::new();
    };
    let topics = world.bags.iter().flat_map(|bag| bag.topics.values());
    let topics = topics.filter(|topic| types.contains(&topic.type_name()));
    let frames = topics.flat_map(|topic| topic.header_frames.keys());
    let known: BTreeSet<&FrameId> = frames
        .filter_map(|frame| world.graph().frames.get(&frame.canonical()))
        .collect();
    known.into_iter().collect()
}

const LIDAR_WORDS: &[&[&str]] = &[names::LIDARS, names::LIDAR_MAKERS, &["velo", "os", "pandar"]];

/// The robot's frames by the kinds in their names.
struct Kinds<'g> {
    /// With their numbers. Vision programs mean the axes of images: optical frames where there are any.
    cameras: Vec<(&'g FrameId, u32)>,
    lidars: Vec<&'g FrameId>,
    imus: Vec<&'g FrameId>,
    bases: Vec<&'g FrameId>,
}

impl<'g> Kinds<'g> {
    fn new(graph: &'g FrameGraph) -> Self {
        let of = |test: &dyn Fn(&FrameId) -> bool| graph.frames.iter().filter(|frame| test(frame)).collect::<Vec<_>>();
        let optical = of(&|frame| names::optical_stem(frame).is_some());
        let cameras = if optical.is_empty() {
            of(&|frame| has_word(frame, names::CAMERAS))
        } else {
            optical
        };
        Self {
            cameras: cameras.into_iter().map(|frame| (frame, number(frame))).collect(),
            lidars: of(&|frame| has_word_of(frame, LIDAR_WORDS)),
            imus: of(&|frame| has_word(frame, names::IMUS)),
            bases: of(&names::is_base),
        }
    }

    fn named(&self, graph: &'g FrameGraph, role: &FrameId) -> Vec<&'g FrameId> {
        if let Some(own) = graph.frames.get(&role.canonical()) {
            return vec![own];
        }
        if has_word(role, names::CAMERAS) {
            let all = self.cameras.iter();
            let of_role = number(role);
            let numbered = all
                .clone()
                .filter(|(_, number)| *number == of_role)
                .map(|(frame, _)| *frame);
            let numbered: Vec<&FrameId> = numbered.collect();
            return if numbered.is_empty() {
                all.map(|(frame, _)| *frame).collect()
            } else {
                numbered
            };
        }
        if has_word_of(role, LIDAR_WORDS) {
            return self.lidars.clone();
        }
        if has_word(role, &["imu", "body"]) {
            return self.imus.clone();
        }
        if has_word(role, &["base", "ego", "egovehicle", "vehicle", "robot"]) {
            return self.bases.clone();
        }
        Vec::new()
    }
}

/// The number in a name; 0 where there is none.
fn number(frame: &FrameId) -> u32 {
    let digits = frame.tokens().into_iter().find_map(|token| {
        let start = token.find(|letter: char| letter.is_ascii_digit())?;
        token.get(start..)?.parse().ok()
    });
    digits.unwrap_or(0)
}
