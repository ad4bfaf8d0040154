//! CROSS: what several sources say of the same pair of frames.

pub(crate) mod angles;
mod blame;
pub mod calibration_loop;
pub mod extrinsic_consistency;
pub mod extrinsic_direction;
pub mod extrinsic_relation;
mod fold;
pub mod frame_aliases;
mod halves;
pub mod hand_eye;
mod roles;
pub(crate) mod statements;
pub mod urdf_tf_topology;
