//! Estimates: what is computed from a world and the settings of a run, once, for every rule that reads it.
//!
//! Must not know rules, findings, files or reports.

pub(crate) mod auth;
pub(crate) mod axes;
pub(crate) mod beams;
pub(crate) mod camera;
pub(crate) mod contract;
pub(crate) mod cov;
pub(crate) mod cross;
mod estimates;
pub(crate) mod geo;
pub(crate) mod ground;
pub(crate) mod hand_eye;
pub(crate) mod landmarks;
pub(crate) mod lidar;
pub(crate) mod look;
pub(crate) mod motion;
pub(crate) mod name;
pub(crate) mod names;
pub(crate) mod near;
pub(crate) mod optical;
pub(crate) mod ouster;
pub(crate) mod pairs;
pub(crate) mod places;
pub(crate) mod point_files;
pub(crate) mod promised;
pub(crate) mod quat;
pub(crate) mod radar;
pub(crate) mod relate;
pub(crate) mod rot;
pub(crate) mod scan_motion;
pub(crate) mod sensor;
mod settings;
pub(crate) mod single_precision;
pub(crate) mod spelling;
pub(crate) mod suffix;
pub(crate) mod tf;
pub(crate) mod time;
pub(crate) mod tree;
pub(crate) mod urdf;

pub use estimates::{Estimates, KeptResults};
pub use settings::Settings;
