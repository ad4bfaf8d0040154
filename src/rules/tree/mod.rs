//! TREE: the structure of the frame tree.

pub mod base_footprint;
mod corrections;
mod footprint;
mod latched;
mod latched_across;
mod lookup_findings;
mod lookups;
pub mod map_odom_jump;
pub mod map_odom_not_applied;
pub mod message_frame_unresolved;
pub mod multiple_parents;
pub mod odom_discontinuity;
mod odometry;
pub mod orphan_subtree;
pub mod rep105_order;
pub mod self_or_empty_transform;
mod split_static;
pub mod static_dynamic_conflict;
pub mod static_transform_changes;
mod steps;
pub mod tf_cycle;
pub mod tf_lookup_coverage;
pub mod tf_static_missing_or_late;
mod undefined_links;
pub mod urdf_structure;
