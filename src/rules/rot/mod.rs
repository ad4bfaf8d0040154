//! ROT: rotations, translations and the numbers that state them.

mod angles;
mod parts;
mod quaternions;
mod sensors;
mod short_pi;
mod translations;
mod urdf_numbers;

pub mod angle_unit;
pub mod homogeneous_layout;
pub mod identity_or_placeholder;
pub mod non_finite_or_zero;
pub mod quaternion_norm;
pub mod rotation_determinant;
pub mod rotation_error_budget;
pub mod rotation_orthogonality;
pub mod translation_units;
pub mod truncated_literal;
