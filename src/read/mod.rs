//! Readers: files become facts with a place. One reader for each format; each fills its source's status and problems.
//!
//! Must not know rules, reports or the engine.

pub mod text;
pub mod urdf;
pub mod xacro;
