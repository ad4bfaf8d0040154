//! The ground floor: pure functions of rotations, transforms and numbers.
//!
//! It knows no frame names, no files, no rules, and uses nothing of the rest of the crate. Radians and metres
//! throughout. A transform `target_from_source` maps `p_target = target_from_source * p_source`.

pub mod axis_maps;
pub mod circular;
pub mod constants;
pub mod crispness;
pub mod distortion;
pub mod doppler;
pub mod drifting;
pub mod earth_turns;
pub mod effective;
pub mod euler;
pub mod excitation;
pub mod geodesy;
pub mod geoid;
pub mod gravity;
pub mod lag;
pub mod lens;
pub mod level;
pub mod magnetism;
pub mod noise;
pub mod planar_hand_eye;
pub mod readings;
pub mod regress;
pub mod relation;
pub mod relief;
pub mod rest;
pub mod rotation;
pub mod scan_match;
pub mod sides;
pub mod similarity2;
pub mod stats;
pub mod support_plane;
pub mod tilting;
pub mod turns;
pub mod utm;
pub mod yaw_search;

#[cfg(test)]
mod tests_constants;
#[cfg(test)]
mod tests_drifting;
#[cfg(test)]
pub(crate) mod tests_drive;
#[cfg(test)]
mod tests_earth_turns;
#[cfg(test)]
mod tests_geodesy;
#[cfg(test)]
mod tests_gravity;
#[cfg(test)]
mod tests_regress;
#[cfg(test)]
mod tests_rotation;
#[cfg(test)]
mod tests_similarity2;
#[cfg(test)]
pub(crate) mod tests_support;
