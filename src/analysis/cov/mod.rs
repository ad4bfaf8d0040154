//! Covariances as stated, and the scatter of the data.

pub(crate) mod declared;
pub(crate) mod fit;
pub(crate) mod noise;
