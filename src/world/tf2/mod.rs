//! A buffer of transforms that answers as tf2 does: what it drops, what it keeps, how it interpolates, and how it fails.
//!
//! Owns the semantics of geometry2 (tf2/src/{buffer_core,cache,static_cache}.cpp as of ROS 2 Jazzy). Knows nothing of
//! recordings, except that `fill` takes their evidence. Must not judge.
//!
//! Where the generations differ, ROS 2 is followed: ROS 1 (0.7.6) drops every further transform with the stamp of another
//! one, prunes after the insertion and not before, and keeps a child static or moving as it was at first. In one thing ROS 1
//! is followed: it drops quaternions that are far from unit length, where ROS 2 normalises all but zeros.
//!
//! Two things differ on purpose. Quaternions are normalised when they come in (ROS 1 uses them as
//! received, so that a quaternion within its tolerance may stretch a vector by one percent). Infinite translations are
//! refused (tf2 checks for NaN only, and returns infinities).

mod errors;
mod fill;
mod history;
#[cfg(test)]
mod tests;
mod walk;

use std::collections::HashMap;

use nalgebra::Isometry3;

use super::claim::Pose;
use super::frame::FrameId;

pub use errors::{Extrapolation, LookupError, Rejection};
pub use fill::{namespace, namespaces};
use history::{History, Sample};

/// What `tf2_ros::Buffer` keeps by default (`TIMECACHE_DEFAULT`, tf2/buffer_core.h): nanoseconds.
pub const DEFAULT_CACHE_NS: i64 = 10_000_000_000;

/// tf2 drops a transform whose quaternion has `| |q|² - 1 |` of this or more (`QUATERNION_NORMALIZATION_TOLERANCE`).
pub const NORM_TOLERANCE: f64 = 10e-3;

/// Frames that a walk passes before tf2 calls the tree a loop (`MAX_GRAPH_DEPTH`).
pub const MAX_DEPTH: usize = 1000;

/// A frame, by its place in the list.
type FrameIndex = usize;

/// A transform on its way in, as published.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncomingTransform<'a> {
    /// `header.frame_id` as spelled.
    pub parent: &'a str,
    /// `child_frame_id` as spelled.
    pub child: &'a str,
    /// Header stamp, nanoseconds.
    pub stamp_ns: i64,
    /// `[x, y, z]` of `parent_from_child`, metres.
    pub translation_m: [f64; 3],
    /// `[x, y, z, w]` of `parent_from_child`.
    pub rotation_xyzw: [f64; 4],
    /// Whether it is valid at all times (`/tf_static`).
    pub is_static: bool,
    /// A tag of the caller, returned in [`Factor::tags`].
    pub tag: usize,
}

/// The answer to a look-up.
#[derive(Clone, Debug, PartialEq)]
pub struct Lookup {
    /// The requested transform.
    pub target_from_source: Isometry3<f64>,
    /// Its stamp: the requested one, or the latest common one. Zero where everything is static.
    pub stamp_ns: i64,
    /// Its factors from left to right: `target_from_a * a_from_b * ... * z_from_source`. Up from the target to the common
    /// ancestor against the edges' own direction, then down to the source along it.
    pub factors: Vec<Factor>,
}

/// One factor of an answer: an edge `parent_from_child` at the stamp of the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Parent of the edge.
    pub parent: FrameId,
    /// Child of the edge.
    pub child: FrameId,
    /// Whether the factor is the edge itself; else its inverse `child_from_parent`.
    pub is_forward: bool,
    /// The edge, interpolated.
    pub parent_from_child: Isometry3<f64>,
    /// The samples that it was made from.
    pub made_from: SampleOrigin,
    /// Tags of the sample before and, where it was interpolated, of the one after.
    pub tags: (usize, Option<usize>),
}

/// The samples that an edge's value was made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleOrigin {
    /// A static transform, valid at all times.
    Static,
    /// One sample with this stamp, nanoseconds: the requested stamp, or an older one where the parent changes after it.
    Sample(i64),
    /// Interpolated between the samples with these stamps, nanoseconds.
    Between(i64, i64),
}

impl Factor {
    /// The factor in the product.
    pub fn value(&self) -> Isometry3<f64> {
        if self.is_forward {
            self.parent_from_child
        } else {
            self.parent_from_child.inverse()
        }
    }

    /// Target and source of the factor in the product.
    pub fn frames(&self) -> (&FrameId, &FrameId) {
        if self.is_forward {
            (&self.parent, &self.child)
        } else {
            (&self.child, &self.parent)
        }
    }
}

struct Frame {
    name: FrameId,
    /// `None` for a frame that was only named as a parent.
    history: Option<History>,
}

/// The buffer.
pub struct Buffer {
    cache_ns: Option<i64>,
    numbers: HashMap<FrameId, FrameIndex>,
    frames: Vec<Frame>,
}

impl Buffer {
    /// An empty buffer that keeps what is at most `cache_ns` older than the newest sample of its frame, or everything.
    pub fn new(cache_ns: Option<i64>) -> Self {
        Self {
            cache_ns,
            numbers: HashMap::new(),
            frames: Vec::new(),
        }
    }

    /// Takes in a transform. A child has one history for all of its parents; a change between static and moving
    /// restarts it.
    ///
    /// # Errors
    ///
    /// The reason for which tf2 drops the transform.
    pub fn insert(&mut self, incoming: &IncomingTransform<'_>) -> Result<(), Rejection> {
        let (parent, child) = (
            FrameId::new(incoming.parent).canonical(),
            FrameId::new(incoming.child).canonical(),
        );
        let pose = accepted(&parent, &child, incoming)?;
        let child = self.number(child);
        let parent = self.number(parent);
        let sample = Sample {
            stamp_ns: incoming.stamp_ns,
            parent,
            pose,
            tag: incoming.tag,
        };
        let cache_ns = self.cache_ns;
        let Some(frame) = self.frames.get_mut(child) else {
            return Ok(());
        };
        match &mut frame.history {
            Some(history) if history.is_static() == incoming.is_static => history.insert(sample, cache_ns),
            other => {
                *other = Some(History::new(sample, incoming.is_static));
                Ok(())
            }
        }
    }

    /// Every frame that any accepted transform named, in the order they came.
    pub fn frames(&self) -> impl Iterator<Item = &FrameId> {
        self.frames.iter().map(|frame| &frame.name)
    }

    /// Whether a frame of this name (without a leading slash) is known.
    pub fn knows(&self, frame: &FrameId) -> bool {
        self.numbers.contains_key(frame)
    }

    /// Every frame that has a parent at some time, with its edge at a stamp; zero requests the latest of each.
    pub fn edges_at(&self, stamp_ns: i64) -> Vec<(&FrameId, Result<Factor, Extrapolation>)> {
        let at = |frame: &Frame| Some(frame.history.as_ref()?.at(stamp_ns));
        let factor = |child: &FrameId, edge: history::Edge| Factor {
            parent: self.name(edge.parent),
            child: child.clone(),
            is_forward: true,
            parent_from_child: edge.parent_from_child,
            made_from: edge.made_from,
            tags: edge.tags,
        };
        self.frames
            .iter()
            .filter_map(|frame| Some((&frame.name, at(frame)?.map(|edge| factor(&frame.name, edge)))))
            .collect()
    }

    /// Every parent that the history of a frame names, each once, in the order of their stamps.
    pub fn parents_ever(&self, frame: &FrameId) -> Vec<&FrameId> {
        let mut parents: Vec<&FrameId> = Vec::new();
        let history = self.numbers.get(frame).and_then(|number| self.frames.get(*number));
        for number in history
            .and_then(|frame| frame.history.as_ref())
            .into_iter()
            .flat_map(History::parents)
        {
            if let Some(parent) = self.frames.get(number).map(|frame| &frame.name)
                && !parents.contains(&parent)
            {
                parents.push(parent);
            }
        }
        parents
    }

    /// Stamps of the earliest and latest sample of a frame; `None` for a static frame or one without a parent.
    pub fn span_ns(&self, frame: &FrameId) -> Option<(i64, i64)> {
        let frame = self.frames.get(*self.numbers.get(frame)?)?;
        frame.history.as_ref()?.span_ns()
    }

    fn number(&mut self, name: FrameId) -> FrameIndex {
        let next = self.frames.len();
        let number = *self.numbers.entry(name.clone()).or_insert(next);
        if number == next {
            self.frames.push(Frame { name, history: None });
        }
        number
    }

    fn history(&self, frame: FrameIndex) -> Option<&History> {
        self.frames.get(frame)?.history.as_ref()
    }

    fn name(&self, frame: FrameIndex) -> FrameId {
        self.frames
            .get(frame)
            .map_or_else(|| FrameId::new(""), |frame| frame.name.clone())
    }
}

/// The tests of `setTransformImpl`, in its order.
fn accepted(parent: &FrameId, child: &FrameId, incoming: &IncomingTransform<'_>) -> Result<Pose, Rejection> {
    if child.as_str().is_empty() {
        return Err(Rejection::NoChild);
    }
    if parent.as_str().is_empty() {
        return Err(Rejection::NoParent);
    }
    if parent == child {
        return Err(Rejection::SelfTransform);
    }
    let rotation = incoming.rotation_xyzw;
    if !incoming.translation_m.iter().chain(&rotation).all(|v| v.is_finite()) {
        return Err(Rejection::NotFinite);
    }
    let norm_squared: f64 = rotation.iter().map(|v| v * v).sum();
    Pose::from_raw(incoming.translation_m, rotation)
        .filter(|_| (norm_squared - 1.0).abs() < NORM_TOLERANCE)
        .ok_or(Rejection::Denormalized { norm_squared })
}
