//! The tests of the program, in one binary: what simulates robots and drives is built once.

#[path = "../support/mod.rs"]
mod support;
#[allow(
    unreachable_pub,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::float_cmp
)]
#[path = "../../fuzz/targets/mod.rs"]
mod targets;

mod altered_evidence;
mod assure;
mod bad_input;
mod bag;
mod bag_content;
mod bag_damage;
mod bag_faults;
mod bag_faults_seen;
mod bag_large;
mod bag_sampling;
mod bag_strange;
mod bag_tf;
mod cases;
mod completions;
mod config;
mod contract;
mod convert;
mod dialects;
mod diff;
mod drives;
mod evidence;
mod faults_motion;
mod faults_placed;
mod faults_shown;
mod fitness;
mod fixes;
mod formats;
mod foxglove;
mod holes;
mod hostile_input;
mod html;
mod integrations;
mod joining;
mod kept_inputs;
mod launched;
mod layers;
mod limits;
mod messages;
mod outputs;
mod packets;
mod packets_captured;
mod packets_captured_damage;
mod packets_drives;
mod packets_ouster;
mod packets_ouster_read;
mod packets_recorded;
mod pages;
mod points;
mod policy;
mod readers;
mod readme;
mod recipe;
mod recordings;
mod relations;
mod rigid;
mod robots;
mod rosbag1;
mod rosbag1_damage;
mod rosbag2;
mod rosbag2_damage;
mod rosbag2_folder;
mod rosbag2_sampling;
mod schema;
mod site;
mod smallest;
mod tf2_reference;
mod tree_moment;
mod urdf_faults;
mod views;
mod words;
mod xacro;
