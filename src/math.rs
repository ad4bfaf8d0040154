//! The ground floor: pure functions of rotations, transforms and numbers.
//!
//! It knows no frame names, no files, no rules, and uses nothing of the rest of the crate. Radians and metres
//! throughout. A transform `target_from_source` maps `p_target = target_from_source * p_source`.

pub mod constants;
pub mod relation;
pub mod rotation;
pub mod stats;

#[cfg(test)]
mod tests_constants;
#[cfg(test)]
mod tests_rotation;
#[cfg(test)]
pub(crate) mod tests_support;
