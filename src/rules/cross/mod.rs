//! CROSS: what several sources say of the same pair of frames.

pub(crate) mod angles;
mod blame;
pub mod extrinsic_consistency;
pub mod extrinsic_relation;
mod fold;
pub(crate) mod statements;
pub mod urdf_tf_topology;
