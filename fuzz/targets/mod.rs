//! What is fuzzed: each target takes any bytes, and panics where a promise is broken.
//!
//! The program of the fuzzers runs them on what libFuzzer makes, the tests on every input that is kept in `fuzz/seeds`.

mod cdr;
mod choices;
mod code;
mod config;
mod db3;
mod definition;
mod evidence;
mod feather;
mod foxglove;
mod json;
mod launch;
mod made_bag;
mod made_calibration;
mod made_urdf;
mod mcap;
mod metadata;
mod plain;
mod rosbag1;
mod urdf;
mod yaml;

/// A target.
pub type Target = fn(&[u8]);

/// Every target by its name, which is the name of the folder of its seeds.
pub const TARGETS: &[(&str, Target)] = &[
    ("cdr", cdr::run),
    ("code", code::run),
    ("config", config::run),
    ("db3", db3::run),
    ("definition", definition::run),
    ("evidence", evidence::run),
    ("feather", feather::run),
    ("foxglove", foxglove::run),
    ("json", json::run),
    ("launch", launch::run),
    ("made_bag", made_bag::run),
    ("made_calibration", made_calibration::run),
    ("made_urdf", made_urdf::run),
    ("mcap", mcap::run),
    ("metadata", metadata::run),
    ("plain", plain::run),
    ("rosbag1", rosbag1::run),
    ("urdf", urdf::run),
    ("yaml", yaml::run),
];
