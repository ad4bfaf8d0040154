//! NAME: what frames are called.

mod alike;
mod cameras;
pub mod flu_frd_suffix;
pub mod frame_case_mismatch;
pub mod frame_near_duplicate;
pub mod frame_whitespace_or_slash;
pub mod image_frame_not_optical;
pub mod ned_suffix;
pub mod optical_suffix;
pub mod transform_name_cancellation;
