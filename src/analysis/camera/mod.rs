//! Cameras as calibrations, images and names show them.

pub(crate) mod declared;
pub(crate) mod fault;
pub(crate) mod grids;
pub(crate) mod in_view;
pub(crate) mod looks;
pub(crate) mod published;
pub(crate) mod range_images;
pub(crate) mod views;
