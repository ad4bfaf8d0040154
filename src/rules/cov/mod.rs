//! COV: covariances as published, and against the motion that they belong to.

pub mod cov_frame;
mod cov_frame_pairs;
pub mod cov_order;
pub mod cov_psd;
pub mod cov_units;
pub mod cov_unknown_marking;
mod declared;
mod fit;
mod noise;
