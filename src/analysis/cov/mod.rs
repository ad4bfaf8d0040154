//! Covariances as declared and as the data scatter.

pub(crate) mod declared;
pub(crate) mod fit;
pub(crate) mod noise;
