//! TREE: the structure of the frame tree.

pub mod base_footprint;
mod footprint;
mod latched;
mod latched_across;
pub mod message_frame_unresolved;
pub mod multiple_parents;
pub mod orphan_subtree;
pub mod rep105_order;
pub mod self_or_empty_transform;
pub mod static_dynamic_conflict;
pub mod static_transform_changes;
pub mod tf_cycle;
pub mod tf_static_missing_or_late;
mod undefined_links;
pub mod urdf_structure;
