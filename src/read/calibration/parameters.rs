//! Frames that the parameters of ROS nodes name: `robot_base_frame: base_footprint`.

use crate::source::{Place, SourceId};
use crate::world::{FrameId, FrameRole, FrameUse};

use super::document::{Kind, Node};
use super::frames::frame_name;

/// The key that holds the parameters of a node in ROS 2.
const PARAMETERS: &str = "ros__parameters";
/// Parameters that name a frame, whatever node has them: those of nav2 and the navigation stack, AMCL, robot_localization, slam_toolbox,
/// Cartographer, LIO-SAM, hdl_localization, KISS-ICP and GLIM. ROS 1 does not mark a file of parameters.
const NAMES: &[&str] = &[
    "base_footprint_frame",
    "base_frame",
    "base_frame_id",
    "base_link_frame",
    "base_link_frame_id",
    "baselinkFrame",
    "global_frame",
    "global_frame_id",
    "gnss_frame",
    "gnss_frame_id",
    "imu_frame",
    "imu_frame_id",
    "laser_frame",
    "laser_frame_id",
    "lidarFrame",
    "lidar_frame",
    "lidar_frame_id",
    "lidar_odom_frame",
    "mapFrame",
    "map_frame",
    "map_frame_id",
    "odom_child_frame_id",
    "odom_frame",
    "odom_frame_id",
    "odometryFrame",
    "published_frame",
    "robot_base_frame",
    "robot_odom_frame_id",
    "tracking_frame",
    "world_frame",
];
/// Ends of the names of parameters that name a frame, in the parameters of a node.
const ENDS: &[&str] = &["_frame", "frame_id", "frame_name", "Frame", "FrameId"];
/// Parameters with such an end and another meaning: a convention of MAVLink, and images that a program keeps.
const OTHERS: &[&str] = &["mav_frame", "key_frame", "keyframe", "keyFrame", "KeyFrame"];

/// The frames of a document's parameters, each at its first place.
pub(super) fn collect(root: &Node, source: SourceId) -> Vec<FrameUse> {
    let mut found: Vec<FrameUse> = Vec::new();
    let mut stack = vec![(root, false)];
    while let Some((node, is_of_a_node)) = stack.pop() {
        match &node.kind {
            Kind::Mapping(pairs) => {
                for (key, value) in pairs {
                    let text = key.text().unwrap_or_default();
                    if names_a_frame(text, is_of_a_node)
                        && let Some(name) = frame_name(value).filter(|name| is_frame(name))
                    {
                        found.push(FrameUse {
                            frame: FrameId::new(name),
                            role: FrameRole::Calibration,
                            place: Place::text(source, value.span),
                            count: 1,
                        });
                    }
                    stack.push((value, is_of_a_node || text == PARAMETERS));
                }
            }
            Kind::Sequence(items) => stack.extend(items.iter().map(|item| (item, is_of_a_node))),
            Kind::Scalar { .. } => {}
        }
    }
    found.sort();
    found.dedup_by(|next, first| {
        let is_same = next.frame == first.frame;
        first.count += u64::from(is_same);
        is_same
    });
    found
}

/// Whether a parameter names a frame; groups are written with dots, too (`local_costmap.robot_base_frame`).
fn names_a_frame(key: &str, is_of_a_node: bool) -> bool {
    let last = key.rsplit(['.', '/']).next().unwrap_or_default();
    let ends = || ENDS.iter().any(|end| last.ends_with(end)) && !OTHERS.iter().any(|other| last.contains(other));
    NAMES.contains(&last) || is_of_a_node && ends()
}

/// Whether a text can be the name of a frame: no switch, and no placeholder that another program fills in.
fn is_frame(name: &str) -> bool {
    !matches!(name.to_lowercase().as_str(), "true" | "false" | "none" | "null" | "~")
        && !name.contains(['<', '>', '%', '*'])
}
