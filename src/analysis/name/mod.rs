//! What names of frames say.

pub(crate) mod alike;
pub(crate) mod cameras;
pub(crate) mod image_frame;
pub(crate) mod optical;
