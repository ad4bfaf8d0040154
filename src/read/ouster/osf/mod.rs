//! Ouster's OSF files, version 2: recordings of lidar scans, with the metadata of the sensors.
//!
//! A file is a header, chunks of messages, and an index at the end. Each of them is a flatbuffer with its size before and
//! its CRC-32 behind. Source: ouster-sdk, `ouster_osf/fb` and `ouster_osf/src` (46b7bcee).

mod error;
mod file;
mod flat;
mod image;
mod index;
mod message;

#[cfg(test)]
mod tests;

pub use error::OsfError;
pub use file::{Chunk, Message, Osf};
pub use index::{Index, Indexed, Sensor, Stream};
pub use message::{LidarScan, stored};
