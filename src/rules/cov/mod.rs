//! COV: covariances as published.

pub mod cov_psd;
pub mod cov_unknown_marking;
