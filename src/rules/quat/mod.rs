//! QUAT: the order and the algebra of quaternions.

pub mod quaternion_order_static;
