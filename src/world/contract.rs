//! What recordings of a platform hold: topics with their types, rates and frames, and latched transforms. As declared, or as recorded.
//!
//! Owns the words. Must not judge, nor know how a declaration is written.

use std::collections::BTreeMap;

use nalgebra::Isometry3;

use crate::source::{Place, SourceId};

use super::frame::FrameId;

/// What recordings of a platform hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contract {
    /// Topics, by name.
    pub topics: BTreeMap<String, TopicTerms>,
    /// Transforms that do not change, by parent and child, canonical.
    pub transforms: BTreeMap<(FrameId, FrameId), TransformTerms>,
}

/// One topic. What is `None` or empty is open.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicTerms {
    /// Type of its messages.
    pub message_type: Option<String>,
    /// Messages per second.
    pub rate_hz: Option<f64>,
    /// How far a rate may be from that, per cent of it.
    pub tolerance_percent: Option<f64>,
    /// The only `header.frame_id` values, canonical.
    pub frames: Vec<FrameId>,
    /// The only `child_frame_id` values, canonical.
    pub child_frames: Vec<FrameId>,
    /// What its sensor gives.
    pub sensor: SensorTerms,
    /// Whether a recording may be without it.
    pub is_optional: bool,
    /// Where it is stated.
    pub place: Place,
}

/// What the sensor of a topic gives. What is `None` or empty is open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SensorTerms {
    /// Width and height of images, or of the images that a calibration is for, pixels.
    pub image: Option<[u32; 2]>,
    /// Rings of a lidar; rows of an organised cloud.
    pub rings: Option<u32>,
    /// Rays of a planar scan.
    pub rays: Option<u32>,
    /// Fields that points have, in any order.
    pub fields: Vec<String>,
}

impl SensorTerms {
    /// Whether it says nothing.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// One transform that does not change.
#[derive(Clone, Debug, PartialEq)]
pub struct TransformTerms {
    /// `parent_from_child`, metres.
    pub pose: Isometry3<f64>,
    /// How far the origin of the child may be from that, millimetres.
    pub tolerance_mm: Option<f64>,
    /// How far the child may be rotated from that, degrees.
    pub tolerance_deg: Option<f64>,
    /// Where it is stated.
    pub place: Place,
}

impl Contract {
    /// Whether it says nothing.
    pub fn is_empty(&self) -> bool {
        self.topics.is_empty() && self.transforms.is_empty()
    }

    /// Adds the terms of another one, whose places are those of this source; they override.
    pub fn overlay(&mut self, other: &Self, source: SourceId) {
        let at = |place: &Place| Place {
            source,
            ..place.clone()
        };
        self.topics.extend(other.topics.iter().map(|(name, terms)| {
            let place = at(&terms.place);
            (name.clone(), TopicTerms { place, ..terms.clone() })
        }));
        self.transforms.extend(other.transforms.iter().map(|(frames, terms)| {
            let place = at(&terms.place);
            (frames.clone(), TransformTerms { place, ..terms.clone() })
        }));
    }
}
