//! Positions on the Earth.

pub(crate) mod antenna;
pub(crate) mod apart;
pub(crate) mod columns;
pub(crate) mod curvature;
pub(crate) mod earth;
pub(crate) mod fixes;
pub(crate) mod grid;
pub(crate) mod heights;
pub(crate) mod kinds;
pub(crate) mod level;
pub(crate) mod origins;
pub(crate) mod overlay;
pub(crate) mod plane;
