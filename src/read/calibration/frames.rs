//! The frames of a statement, as the keys of a document state them or name them.

use std::cmp::Ordering;

use crate::source::{Confidence, Span};
use crate::world::FrameRole;

use super::document::{Kind, Node};
use super::{names, numbers};

/// Frames of a claim with where they are named.
#[derive(Clone, Debug)]
pub(super) struct NamedFrames {
    /// `(target, source)`.
    pub(super) frames: (String, String),
    /// Where each is named.
    pub(super) places: (Span, Span),
    /// How sure it is.
    pub(super) reading: Confidence,
    /// Whether keys state the frames (`frame_id`), or they were parsed from the name of a key.
    pub(super) role: FrameRole,
    /// Whether they are a program's words for its sensors, not names of the platform's frames.
    pub(super) is_role: bool,
    /// Whether keys next to the one that names the frames (`parent_frame`, `child_frame`) state the other direction.
    pub(super) is_contradicted: bool,
}

/// The frames of a statement, by its own keys and by its dialect, and whether they come from the dialect alone.
pub(super) fn settled(named: Option<&NamedFrames>, by_dialect: Option<NamedFrames>) -> Option<NamedFrames> {
    match (named.cloned(), by_dialect) {
        (Some(stated), _) if stated.role == FrameRole::Calibration => Some(stated),
        // A key may name the frames as the dialect does.
        (Some(named), Some(NamedFrames { frames, reading, .. })) if named.frames == frames => {
            Some(NamedFrames { reading, ..named })
        }
        (named, by_dialect) => by_dialect.or(named),
    }
}

/// The frames that a key names (`ego_T_lidar`), by what keys next to it state (`parent_frame: base_link`, `child_frame: lidar_top`): its
/// names are replaced by those. If the stated frames do not correspond to them, the key's own names are used.
pub(super) fn beside(named: NamedFrames, stated: Option<NamedFrames>) -> NamedFrames {
    let Some(stated) = stated else { return named };
    let alike = |a: &str, b: &str| names::alike(a, b);
    let ((target, source), (parent, child)) = (&named.frames, &stated.frames);
    let direct = alike(target, parent) + alike(source, child);
    let turned = alike(target, child) + alike(source, parent);
    match direct.cmp(&turned) {
        Ordering::Greater => stated,
        Ordering::Equal => named,
        Ordering::Less => {
            let ((parent, child), (parent_at, child_at)) = (stated.frames, stated.places);
            NamedFrames {
                frames: (child, parent),
                places: (child_at, parent_at),
                reading: named.reading,
                role: FrameRole::Calibration,
                is_role: false,
                is_contradicted: true,
            }
        }
    }
}

/// Keys under which a mounting names the frame of its sensor.
pub(super) const SENSOR_FRAMES: &[&str] = &["child_frame", "child_frame_id", "frame_id", "frame", "link"];
/// Keys by which a file states the frame in which its mountings are expressed.
pub(super) const BASE_FRAMES: &[&str] = &[
    "base_frame",
    "base_frame_id",
    "base_link_frame",
    "robot_base_frame",
    "vehicle_frame",
    "body_frame",
    "reference_frame",
    "parent_frame",
    "parent_frame_id",
    "parent",
];

/// Keys by which a mapping states its frames: `(target, source, how sure)`.
const STATED: &[(&str, &str, Confidence)] = &[
    ("frame_id", "child_frame_id", Confidence::Certain),
    ("parent", "child", Confidence::Certain),
    ("parent_frame", "child_frame", Confidence::Certain),
    ("parent_frame_id", "child_frame_id", Confidence::Certain),
    ("parent_link", "child_link", Confidence::Certain),
    // ouster-sdk `extrinsic_parameters.json`: source to destination.
    ("destination_frame", "source_frame", Confidence::Certain),
    ("target_frame", "source_frame", Confidence::Likely),
    // The direction of "to" is not agreed.
    ("to", "from", Confidence::Hint),
    ("to_frame", "from_frame", Confidence::Hint),
];

/// Keys by which a mapping states the frame in which it is expressed, without one for its own.
const PARENTS: &[&str] = &["parent", "parent_frame", "parent_frame_id", "parent_link"];

/// The frames of a mapping that states its parent and is named itself: by one of its keys (`frame`, `name`), or by its own key
/// (`camera_left_link: {parent: base_link, xyz: ..., rpy: ...}`).
pub(super) fn below_parent(node: &Node, key: Option<&Node>) -> Option<NamedFrames> {
    let parent = PARENTS.iter().find_map(|key| node.get(key))?;
    let by_frame = SENSOR_FRAMES.iter().find_map(|key| node.get(key));
    let child = by_frame.or_else(|| node.get("name")).or(key)?;
    Some(NamedFrames {
        frames: (frame_name(parent)?, frame_name(child)?),
        places: (parent.span, child.span),
        reading: Confidence::Likely,
        role: if by_frame.is_some() {
            FrameRole::Calibration
        } else {
            FrameRole::CalibrationLabel
        },
        is_role: false,
        is_contradicted: false,
    })
}

/// The name of a frame.
pub(super) fn frame_name(node: &Node) -> Option<String> {
    let text = node.text()?.trim();
    let plain = !text.is_empty() && !text.contains(char::is_whitespace) && !text.contains(['$', '{']);
    // A serial number is quoted.
    let is_name = matches!(node.kind, Kind::Scalar { quoted: true, .. }) || numbers::number(text).is_none();
    (plain && is_name).then(|| text.to_owned())
}

/// The frames that the keys of a mapping state.
pub(super) fn stated(node: &Node) -> Option<NamedFrames> {
    let child = || node.get("child_frame_id");
    let header = node.get("header").and_then(|header| header.get("frame_id"));
    let by_header = header
        .zip(child())
        .map(|(target, source)| (target, source, Confidence::Certain));
    let by_keys = STATED
        .iter()
        .find_map(|(target, source, reading)| Some((node.get(target)?, node.get(source)?, *reading)));
    let (target, source, reading) = by_keys.or(by_header)?;
    Some(NamedFrames {
        frames: (frame_name(target)?, frame_name(source)?),
        places: (target.span, source.span),
        reading,
        role: FrameRole::Calibration,
        is_role: false,
        is_contradicted: false,
    })
}
