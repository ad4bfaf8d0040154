//! What the names of frames state.

pub(crate) mod alike;
pub(crate) mod cameras;
pub(crate) mod image_frame;
pub(crate) mod optical;
pub(crate) mod sides;
