//! Mistakes of what moves: inertial sensors, poses, fixes, and the stamps of their messages.
//!
//! A mistake is a function of one message. It is put into the rows of a stream, which are means of messages number by number, so that
//! orders, signs and units of the numbers commute with them; and into whatever else of the messages is kept.

mod covariances;
mod fixes;
mod hidden;
mod imu;
mod origins;
mod pace;
mod places;
mod poses;
mod stamps;
mod streams;
mod table;
mod turns;

pub use covariances::change_covariances;
pub use hidden::{HiddenDirection, Rotations};
pub use imu::{GRAVITY, ImuMessage, change_imu};
pub use pace::pace;
pub use poses::{PoseMessage, change_poses};
pub use streams::{MovingFrame, Stream, StreamPlace};
pub use turns::Oriented;

pub(super) use fixes::FixChange;
pub(super) use poses::ScaleChange;
pub(super) use stamps::StampChange;

use super::Fault;

/// The mistakes of each kind.
pub(super) fn tables() -> impl Iterator<Item = &'static [Fault]> {
    table::all().into_iter()
}
