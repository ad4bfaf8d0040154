//! QUAT: the order and the algebra of quaternions.

mod listed;

pub mod quaternion_convention;
pub mod quaternion_order_static;
mod ways;
