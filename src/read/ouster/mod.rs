//! Ouster's UDP packets decoded into returns, by the metadata of the sensor that sent them.
//!
//! Frames, as Ouster's user manual has them. Lidar frame: x towards the connector (encoder angle 0), z up. Sensor frame: x
//! away from the connector, y left, z up, origin at the bottom of the sensor; it is what Ouster's ROS driver publishes.
//! Source: ouster-sdk, `ouster_core/src` (46b7bcee).

mod beams;
mod error;
mod imu;
mod known;
mod metadata;
pub mod osf;
mod packet;
mod profiles;
mod scan;

#[cfg(test)]
pub(crate) mod tests;

pub use beams::Axes;
pub use error::OusterError;
pub use imu::{Imu, imu, may_be_imu};
pub use known::{KnownSensors, Origin};
pub use metadata::{Matrix, Metadata};
pub use packet::{Column, Header, Layout};
pub use profiles::{Bits, Echo, Profile};
pub use scan::{Return, Scan, decode, frame_id};

pub(crate) use beams::Beams;
pub(crate) use scan::Builder;
