//! Numbers of rotations and translations as written in files.

pub(crate) mod angles;
pub(crate) mod parts;
pub(crate) mod quaternions;
pub(crate) mod sensors;
pub(crate) mod short_pi;
pub(crate) mod translations;
pub(crate) mod urdf_numbers;
