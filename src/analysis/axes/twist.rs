//! Possible readings of odometry's velocity, and how well each explains the motion of the pose.
//!
//! Must not judge.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;

use crate::analysis::motion::{Stream, TimedRow};
use crate::world::motion::{PoseRow, Twist};

/// A reading of a velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    /// In the child frame, as `nav_msgs/Odometry` defines it.
    Body,
    /// In the header's frame.
    World,
    /// In the child frame, negated.
    Backwards,
    /// In the child frame, y to the right.
    RightHand,
    /// In the child frame, z down.
    Down,
    /// In the child frame, x and y swapped.
    Swapped,
    /// In the child frame, with the inverse orientation.
    Inverse,
    /// In the child frame, with y of the position negated.
    PositionY,
    /// In the child frame, with x of the position negated.
    PositionX,
    /// In the child frame, with x and y of the position swapped.
    PositionSwapped,
}

const READINGS: [Reading; 10] = [
    Reading::Body,
    Reading::World,
    Reading::Backwards,
    Reading::RightHand,
    Reading::Down,
    Reading::Swapped,
    Reading::Inverse,
    Reading::PositionY,
    Reading::PositionX,
    Reading::PositionSwapped,
];

impl Reading {
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Body => "child-frame",
            Self::World => "header-frame",
            Self::Backwards => "negated",
            Self::RightHand => "y-negated",
            Self::Down => "z-negated",
            Self::Swapped => "xy-swapped",
            Self::Inverse => "inverse",
            Self::PositionY | Self::PositionX | Self::PositionSwapped => "mirrored",
        }
    }

    /// Whether it reads the pose in another way, not the velocity.
    pub(crate) fn is_of_pose(self) -> bool {
        matches!(
            self,
            Self::Inverse | Self::PositionY | Self::PositionX | Self::PositionSwapped
        )
    }

    /// The fault, with the frame of the header and that of the child.
    pub(crate) fn words(self, [header, child]: &[String; 2]) -> String {
        match self {
            Self::Body => format!("velocity is expressed in {child}"),
            Self::World => format!("velocity is expressed in {header}, not in {child}"),
            Self::Backwards => "velocity is opposite to the motion of the pose (x and y negated)".to_owned(),
            Self::RightHand => format!("velocity has y to the right in {child}"),
            Self::Down => format!("velocity has z down in {child}"),
            Self::Swapped => format!("velocity has x and y swapped in {child}"),
            Self::Inverse => "orientation is inverted (child_from_header, or JPL)".to_owned(),
            Self::PositionY => "position is mirrored (y negated)".to_owned(),
            Self::PositionX => "position is mirrored (x negated)".to_owned(),
            Self::PositionSwapped => "position is mirrored (x and y swapped)".to_owned(),
        }
    }

    pub(crate) fn help(self) -> &'static str {
        match self {
            Self::Body | Self::World => {
                "rotate the velocity into the child frame before publishing: v_child = R(q)^T * v_header (nav_msgs/Odometry)"
            }
            Self::Backwards => {
                "drive forward, which is along x (REP-103):\n(1) if `twist.linear.x` is negative, negate the velocity\n(2) if \
                 `twist.linear.x` is positive, add 180 deg to the yaw of the pose"
            }
            Self::RightHand => "negate y of the velocity: y points to the left (REP-103)",
            Self::Down => "negate z of the velocity: z points up (REP-103)",
            Self::Swapped => {
                "drive forward, which is along x (REP-103):\n(1) if `twist.linear.y` is the larger part, swap x and y of the \
                 velocity\n(2) if `twist.linear.x` is the larger part, correct the yaw of the pose by 90 deg"
            }
            Self::Inverse => "conjugate the quaternion (negate x, y and z)",
            Self::PositionY => "negate y of the position",
            Self::PositionX => "negate x of the position",
            Self::PositionSwapped => "swap x and y of the position; NED positions become ENU as (y, x, -z)",
        }
    }

    /// The velocity in the header's frame.
    fn apply(self, orientation: &UnitQuaternion<f64>, v: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Body => orientation * v,
            Self::World => *v,
            Self::Backwards => -(orientation * v),
            Self::RightHand => orientation * Vector3::new(v.x, -v.y, v.z),
            Self::Down => orientation * Vector3::new(v.x, v.y, -v.z),
            Self::Swapped => orientation * Vector3::new(v.y, v.x, v.z),
            Self::Inverse => orientation.inverse() * v,
            Self::PositionY => (orientation * v).component_mul(&Vector3::new(1.0, -1.0, 1.0)),
            Self::PositionX => (orientation * v).component_mul(&Vector3::new(-1.0, 1.0, 1.0)),
            Self::PositionSwapped => {
                let v = orientation * v;
                Vector3::new(v.y, v.x, v.z)
            }
        }
    }
}

/// The twists of a stream compared with its poses.
#[derive(Debug)]
pub(crate) struct Twists {
    /// Windows taken.
    pub(crate) windows: u64,
    /// Distance that the pose moves over the windows, metres.
    pub(crate) distance_m: f64,
    /// Whether z of the child points down in the header's frame, by the orientation.
    pub(crate) is_upside_down: bool,
    /// Whether every velocity is zero.
    pub(crate) is_zero: bool,
    /// The part of the motion that is to the side of the child frame, by the velocity.
    pub(crate) aside: f64,
    /// Residual of each reading, the best first: the part of the motion that it does not explain (root of the ratio of squares).
    pub(crate) residuals: Vec<(Reading, f64)>,
    /// The divisor of the velocity in the child frame that explains most, and its residual.
    pub(crate) scale: (f64, f64),
    /// The yaw rate.
    pub(crate) turning: Turning,
}

/// The yaw rate compared with the rotation of the pose.
#[derive(Debug, Default)]
pub(crate) struct Turning {
    /// Windows taken.
    pub(crate) windows: u64,
    /// Rotation of the pose about its z axis over the windows, without sign, radians.
    pub(crate) turned_rad: f64,
    /// Integral of the yaw rate over the rotation of the pose, by least squares.
    pub(crate) slope: f64,
    /// Their correlation.
    pub(crate) correlation: f64,
}

impl Twists {
    pub(crate) fn of(stream: &Stream<PoseRow>, limits: &Limits) -> Self {
        let mut sums = [0.0; READINGS.len()];
        let (mut windows, mut distance_m, mut squares, mut is_zero) = (0, 0.0, 0.0, true);
        let (mut apart, mut up) = (0.0, 0.0);
        let (mut along, mut predicted) = (0.0, 0.0);
        let (mut turned_rad, mut crossed, mut poses, mut rates) = (0.0, 0.0, 0.0, 0.0);
        for window in stream.windows(limits.window_s, limits.max_step_s) {
            let Some(moved) = WindowMotion::of(window) else {
                continue;
            };
            windows += 1;
            distance_m += moved.shift.norm();
            squares += moved.shift.norm_squared();
            is_zero &= moved.is_zero;
            for (sum, predicted) in sums.iter_mut().zip(&moved.predicted) {
                *sum += (predicted - moved.shift).norm_squared();
            }
            let [as_defined, _, _, right_hand, ..] = moved.predicted;
            up += moved.up;
            along += as_defined.dot(&moved.shift);
            predicted += as_defined.norm_squared();
            apart += (right_hand - as_defined).norm_squared();
            turned_rad += moved.turned.abs();
            crossed += moved.turned * moved.rated;
            poses += moved.turned * moved.turned;
            rates += moved.rated * moved.rated;
        }
        let mut residuals: Vec<(Reading, f64)> = READINGS
            .into_iter()
            .zip(sums)
            .map(|(reading, sum)| (reading, (sum / squares).sqrt()))
            .collect();
        residuals.sort_by(|a, b| a.1.total_cmp(&b.1));
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        Self {
            windows,
            distance_m,
            is_upside_down: up < 0.0,
            is_zero,
            // Negating y moves the prediction by twice the sideways part.
            aside: ratio(apart, squares).sqrt() / 2.0,
            residuals,
            scale: (
                ratio(predicted, along),
                (1.0 - ratio(along, (predicted * squares).sqrt()).powi(2))
                    .max(0.0)
                    .sqrt(),
            ),
            turning: Turning {
                windows,
                turned_rad,
                slope: ratio(crossed, poses),
                correlation: ratio(crossed, (poses * rates).sqrt()),
            },
        }
    }

    /// The readings that the velocity can distinguish, the best first: motion along x alone has no sign of y, and most motion none of z.
    pub(crate) fn readings(&self, least_aside: f64) -> Vec<(Reading, f64)> {
        let as_defined = self.residual(Reading::Body);
        let has_sign = |(reading, residual): &&(Reading, f64)| match reading {
            Reading::RightHand => self.aside >= least_aside,
            // Negating z moves the prediction by twice the vertical part.
            Reading::Down => as_defined - residual >= least_aside,
            _ => true,
        };
        let of_twist = |(reading, _): &&(Reading, f64)| !reading.is_of_pose();
        self.residuals
            .iter()
            .filter(of_twist)
            .filter(has_sign)
            .copied()
            .collect()
    }

    /// The readings of a wrong pose beside a right velocity, the best first. In a plane the inverse orientation looks like a mirrored
    /// position: the sign of the yaw rate distinguishes them.
    pub(crate) fn readings_of_pose(&self) -> Vec<(Reading, f64)> {
        let turns_back = self.turning.slope < 0.0;
        let fits = |(reading, _): &&(Reading, f64)| match reading {
            Reading::Inverse => turns_back || self.turning.slope == 0.0,
            reading => reading.is_of_pose() && !turns_back,
        };
        self.residuals.iter().filter(fits).copied().collect()
    }

    /// Residual of a reading.
    pub(crate) fn residual(&self, reading: Reading) -> f64 {
        let found = self.residuals.iter().find(|(known, _)| *known == reading);
        found.map_or(f64::NAN, |(_, residual)| *residual)
    }
}

/// The motion in one window.
struct WindowMotion {
    /// Of the pose in the header's frame, metres.
    shift: Vector3<f64>,
    /// Prediction of each reading of the velocity.
    predicted: [Vector3<f64>; READINGS.len()],
    /// Rotation of the pose about its own z axis, radians.
    turned: f64,
    /// Integral of the yaw rate, radians.
    rated: f64,
    /// z of the child's z axis in the header's frame, at the first pose.
    up: f64,
    is_zero: bool,
}

impl WindowMotion {
    /// `None` if a number is not finite or an orientation is invalid.
    fn of(window: &[TimedRow<PoseRow>]) -> Option<Self> {
        let (first, last) = (window.first()?, window.last()?);
        let mut moved = Self {
            shift: Vector3::from(last.row.position) - Vector3::from(first.row.position),
            predicted: [Vector3::zeros(); READINGS.len()],
            turned: 0.0,
            rated: 0.0,
            up: (orientation(&first.row)? * Vector3::z()).z,
            is_zero: true,
        };
        for pair in window.windows(2) {
            let [a, b] = pair else { continue };
            let (Twist { linear, angular }, twist) = (a.row.twist?, b.row.twist?);
            let dt = b.t_s - a.t_s;
            let [from, to] = [orientation(&a.row)?, orientation(&b.row)?];
            let v = (Vector3::from(linear) + Vector3::from(twist.linear)) / 2.0;
            // In the child frame's own axes.
            let turn = (from.inverse() * to).scaled_axis();
            let between = from * UnitQuaternion::from_scaled_axis(turn / 2.0);
            for (predicted, reading) in moved.predicted.iter_mut().zip(READINGS) {
                *predicted += reading.apply(&between, &v) * dt;
            }
            moved.turned += turn.z;
            moved.rated += dt * (angular[2] + twist.angular[2]) / 2.0;
            moved.is_zero &= v == Vector3::zeros();
        }
        let is_finite = moved.shift.iter().all(|value| value.is_finite())
            && moved.predicted.iter().flatten().all(|value| value.is_finite());
        (is_finite && moved.turned.is_finite() && moved.rated.is_finite()).then_some(moved)
    }
}

/// The orientation of a row; `None` if it is invalid.
fn orientation(row: &PoseRow) -> Option<UnitQuaternion<f64>> {
    let [x, y, z, w] = row.orientation;
    UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 0.5)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Length of the windows that the velocity is integrated over, seconds.
    pub(crate) window_s: f64,
    /// Longest step between two messages inside a window, seconds.
    pub(crate) max_step_s: f64,
    pub(crate) min_distance_m: f64,
    pub(crate) max_residual: f64,
    pub(crate) min_ratio: f64,
    pub(crate) least_aside: f64,
    pub(crate) min_turn_deg: f64,
    pub(crate) turn_agrees: f64,
}

impl Limits {
    /// Correlation below which a yaw rate is unrelated to the rotation of the pose.
    pub(crate) fn max_correlation(&self) -> f64 {
        1.0 - self.max_residual
    }
}
