//! Frames of images, and their orientation.
//!
//! Must not judge.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::analysis::{names, names::has_word, suffix::off_deg};
use crate::math::constants::AxisTurn;
use crate::source::{MessageRef, Place};
use crate::world::{BagEvidence, FrameId, World};

const CAMERA_WORDS: &[&str] = &[
    "camera",
    "cam",
    "image",
    "img",
    "rgb",
    "rgbd",
    "color",
    "colour",
    "depth",
    "infra",
    "stereo",
    "realsense",
    "zed",
    "oak",
    "oakd",
    "kinect",
    "astra",
    "webcam",
    "fisheye",
    "thermal",
];

/// The messages of one camera frame.
pub(crate) struct Camera<'a> {
    /// The topic that names it first, by name.
    pub(crate) topic: &'a str,
    /// Its first message.
    pub(crate) first: &'a MessageRef,
    /// Messages of all its topics.
    pub(crate) count: u64,
    /// Whether a calibration is among them.
    pub(crate) is_calibrated: bool,
}

impl Camera<'_> {
    /// Whether the frame is a camera's: lidars publish images too.
    pub(crate) fn is_camera(&self, frame: &FrameId) -> bool {
        self.is_calibrated || has_word(frame, CAMERA_WORDS)
    }
}

/// The frames of images and camera calibrations, canonical. World-like and empty names are other rules' business.
pub(crate) fn cameras(bag: &BagEvidence) -> BTreeMap<FrameId, Camera<'_>> {
    let mut cameras: BTreeMap<FrameId, Camera> = BTreeMap::new();
    for topic in bag.topics.values() {
        let kind = topic.type_name();
        let is_calibration = matches!(kind, "CameraInfo" | "CameraCalibration");
        if !is_calibration && !matches!(kind, "Image" | "CompressedImage" | "RawImage") {
            continue;
        }
        for (frame, used) in &topic.header_frames {
            let frame = frame.canonical();
            if frame.as_str().is_empty() || names::is_world(&frame) {
                continue;
            }
            let camera = cameras.entry(frame).or_insert(Camera {
                topic: &topic.topic,
                first: &used.first,
                count: 0,
                is_calibrated: false,
            });
            camera.count = camera.count.saturating_add(used.count);
            camera.is_calibrated |= is_calibration;
        }
    }
    cameras
}

/// The optical frame of the same camera, rigid to `frame` and rotated from it as from a link with x forward.
pub(crate) fn optical_beside<'a>(
    world: &'a World,
    frame: &FrameId,
    max_deg: f64,
) -> Option<(&'a FrameId, Option<Place>)> {
    let graph = world.graph();
    let stem = names::without_ending(frame.tokens());
    let of_camera = |other: &&FrameId| names::optical_stem(other).is_some_and(|words| words == stem);
    let optical = graph.frames.iter().filter(of_camera).find(|optical| {
        let turn = graph.chain(frame, optical, |edge| edge.is_rigid);
        turn.is_some_and(|(turn, _)| off_deg(Some(AxisTurn::Optical), &turn.rotation) <= max_deg)
    })?;
    let stated = graph
        .edges_to(optical)
        .next()
        .and_then(|edge| crate::analysis::places::of_edge(world, edge));
    Some((optical, stated))
}

/// The vertical component of the z axis in the platform's base frame, which carries it rigidly.
pub(crate) fn up<'a>(world: &'a World, frame: &FrameId) -> Option<(&'a FrameId, f64)> {
    let graph = world.graph();
    let is_base = |base: &&FrameId| {
        names::is_base(base) && !names::is_device(base) && !has_word(base, &["ned", "frd"]) && *base != frame
    };
    let mut bases: Vec<&FrameId> = graph.frames.iter().filter(is_base).collect();
    bases.sort_by_key(|base| names::standard(base).is_none());
    bases.into_iter().find_map(|base| {
        let (base_from_frame, _) = graph.chain(base, frame, |edge| edge.is_rigid)?;
        Some((base, (base_from_frame.rotation * Vector3::z()).z))
    })
}
