//! URDF: what is written in a robot description, and what a consumer makes of it.

mod moments;
mod scaled;
mod subject;

pub mod consumer_disagrees;
pub mod duplicate_name;
pub mod ignored_name;
pub mod inertia_invalid;
pub mod joint_axis;
pub mod joint_limits;
pub mod malformed_number;
pub mod mesh_missing;
pub mod mesh_scale;
pub mod missing_mimic;
pub mod repeated_element;
pub mod self_joint;
pub mod unknown_joint_type;
