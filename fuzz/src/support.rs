//! The writers of recordings, as in the tests.

#![allow(dead_code, missing_docs)]

#[path = "../../tests/support/encode.rs"]
pub mod encode;
#[path = "../../tests/support/raw.rs"]
pub mod raw;
#[path = "../../tests/support/ros1.rs"]
pub mod ros1;
#[path = "../../tests/support/rosbag1.rs"]
pub mod rosbag1;
#[path = "../../tests/support/rosbag2.rs"]
pub mod rosbag2;
