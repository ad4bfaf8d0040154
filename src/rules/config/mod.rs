//! CONFIG: what launch files and parameters hand to programs that move frames.

pub mod localization_frames;
pub mod navsat_transform;
pub mod static_transform_arguments;
