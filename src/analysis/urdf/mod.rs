//! Inertia and meshes of robot descriptions.

pub(crate) mod called;
pub(crate) mod moments;
pub(crate) mod scaled;
