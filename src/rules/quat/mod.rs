//! QUAT: the order and the algebra of quaternions.

mod listed;

pub mod left_vs_right_multiplication;
mod oriented;
pub mod quaternion_convention;
pub mod quaternion_order_static;
