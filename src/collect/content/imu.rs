//! IMU messages of one topic.

use crate::read::messages::content::Imu;
use crate::world::content::ImuEvidence;

use super::super::point::{Point, PointOwner};

/// The rotation between messages further apart than this is unknown, nanoseconds.
const LONGEST_STEP_NS: i64 = 1_000_000_000;

/// Takes in IMU messages in recording order.
#[derive(Default)]
pub(super) struct Inertial {
    count: u64,
    identity: u64,
    zero: u64,
    same_as_first: u64,
    first: Option<(Point, [f64; 4])>,
    /// Stamp and angular speed of the last message.
    last: Option<(i64, f64)>,
    /// Sum of the squares of the angular speed, and of how many messages.
    squares: (f64, u64),
    turned_rad: f64,
}

impl Inertial {
    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        self.last = None;
    }

    pub(super) fn push(&mut self, point: Point, imu: &Imu) {
        let orientation = imu.orientation;
        let (_, first) = self.first.get_or_insert((point, orientation));
        self.count += 1;
        self.identity += u64::from(is(orientation, [0.0, 0.0, 0.0, 1.0]));
        self.zero += u64::from(is(orientation, [0.0; 4]));
        self.same_as_first += u64::from(orientation.map(f64::to_bits) == first.map(f64::to_bits));
        let square: f64 = imu.angular_velocity.iter().map(|rate| rate * rate).sum();
        if !square.is_finite() {
            self.last = None;
            return;
        }
        self.squares = (self.squares.0 + square, self.squares.1 + 1);
        let (Some(stamp_ns), speed) = (point.stamp_ns, square.sqrt()) else {
            return;
        };
        if let Some((last_ns, last_speed)) = self.last.replace((stamp_ns, speed)) {
            let step_ns = stamp_ns.saturating_sub(last_ns);
            if (1..=LONGEST_STEP_NS).contains(&step_ns) {
                self.turned_rad += 0.5 * (last_speed + speed) * step_ns as f64 * 1e-9;
            }
        }
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> ImuEvidence {
        let (sum, count) = self.squares;
        ImuEvidence {
            count: self.count,
            identity: self.identity,
            zero: self.zero,
            same_as_first: self.same_as_first,
            first: self.first.map(|(point, _)| point.on(on)),
            angular_velocity_rms: if count == 0 {
                f64::NAN
            } else {
                (sum / count as f64).sqrt()
            },
            turned_rad: self.turned_rad,
        }
    }
}

/// Whether a quaternion is exactly this one.
#[allow(clippy::float_cmp)] // the comparison is exact on purpose
fn is(published: [f64; 4], xyzw: [f64; 4]) -> bool {
    published == xyzw
}
