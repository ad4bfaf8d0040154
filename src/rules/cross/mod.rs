//! CROSS: what several sources say of the same pair of frames.

mod blame;
pub mod extrinsic_consistency;
pub mod extrinsic_relation;
mod fold;
mod statements;
pub mod urdf_tf_topology;
