//! Controllers of ros_control that publish odometry, in files of parameters: differential, mecanum and steering drives.

use std::collections::BTreeMap;

use crate::read::calibration::document::Node;
use crate::source::{Place, SourceId, SourceValue};
use crate::world::launch::LocalizationSettings;

use super::yaml::{MAX_DEPTH, values_of};

/// The types whose `enable_odom_tf` is true by default.
const TYPES: [&str; 4] = [
    "diff_drive_controller/DiffDriveController",
    "mecanum_drive_controller/MecanumDriveController",
    "ackermann_steering_controller/AckermannSteeringController",
    "bicycle_steering_controller/BicycleSteeringController",
];
/// Settings of a controller's own block.
const OWN: [&str; 6] = [
    "left_wheel_names",
    "left_wheel",
    "wheel_separation",
    "wheel_radius",
    "wheelbase",
    "odom_frame_id",
];
/// The settings that are kept.
const KEPT: [&str; 6] = [
    "type",
    "enable_odom_tf",
    "odom_frame_id",
    "base_frame_id",
    "tf_frame_prefix",
    "tf_frame_prefix_enable",
];

/// The controllers of a document. ROS 2 states the type below the manager, and the other settings below the controller's own name.
pub(crate) fn collect(root: &Node, source: SourceId) -> Vec<LocalizationSettings> {
    let mut blocks = Vec::new();
    walk(root, "", &mut blocks, 0);
    let mut types: BTreeMap<&str, SourceValue<String>> = BTreeMap::new();
    for (name, node) in &blocks {
        if let Some((value, text)) = node.get("type").and_then(|value| Some((value, value.text()?)))
            && TYPES.contains(&text)
        {
            types.insert(
                *name,
                SourceValue::new(text.to_owned(), Place::text(source, value.span)),
            );
        }
    }
    let drives = blocks
        .into_iter()
        .filter_map(|(name, node)| drive(name, node, &types, source));
    drives.collect()
}

/// Each mapping with the name of its node.
fn walk<'n>(node: &'n Node, name: &'n str, blocks: &mut Vec<(&'n str, &'n Node)>, depth: usize) {
    if node.pairs().is_empty() || depth > MAX_DEPTH {
        return;
    }
    blocks.push((name, node));
    for (key, value) in node.pairs() {
        let name = match key.text() {
            Some("ros__parameters" | "/**") | None => name,
            Some(key) => key,
        };
        walk(value, name, blocks, depth + 1);
    }
}

/// The settings of a controller's own block.
fn drive(
    name: &str,
    node: &Node,
    types: &BTreeMap<&str, SourceValue<String>>,
    source: SourceId,
) -> Option<LocalizationSettings> {
    let is_own = OWN.iter().any(|key| node.get(key).is_some());
    let of_type = types.get(name).filter(|_| is_own);
    if of_type.is_none() && node.get("enable_odom_tf").is_none() {
        return None;
    }
    let written = values_of(node, source).into_iter();
    let mut values: BTreeMap<_, _> = written.filter(|(key, _)| KEPT.contains(&key.as_str())).collect();
    if let Some(stated) = of_type {
        values.entry("type".to_owned()).or_insert_with(|| stated.clone());
    }
    Some(LocalizationSettings {
        node: name.to_owned(),
        values,
    })
}
