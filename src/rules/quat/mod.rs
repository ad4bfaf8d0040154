//! QUAT: the order and the algebra of quaternions, and the angles that they are made of.

mod by_gyro;
pub mod euler_sequence;
pub(crate) mod level_order;
mod listed;

pub mod jpl_provenance;
pub mod left_vs_right_multiplication;
mod oriented;
pub mod quaternion_convention;
pub mod quaternion_order_static;
mod ways;
