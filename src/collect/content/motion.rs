//! Motion, row by row: which numbers of which messages are kept, and as what.

use crate::read::messages::content::{Fix, Imu, Odometry, Twist};
use crate::world::motion::{FixRow, InertialRow, MotionEvidence, PoseRow, Series, TwistRow};
use crate::world::{Pose, motion};

use super::super::point::Point;
use super::super::series::{Room, Rows, Sample};

/// Poses without a velocity: position, orientation.
pub(in super::super) type Poses = Rows<7, 3>;

/// What one topic says of motion; nothing is set aside for what it does not.
pub(super) struct Motion {
    room: Room,
    /// Orientation, angular velocity, acceleration.
    inertial: Option<Box<Rows<10, 0>>>,
    /// Position, orientation, velocity, angular velocity.
    odometry: Option<Box<Rows<13, 3>>>,
    poses: Option<Box<Poses>>,
    /// Velocity, angular velocity.
    twists: Option<Box<Rows<6, 6>>>,
    /// Latitude, longitude, altitude, three variances, status.
    fixes: Option<Box<Rows<7, 7>>>,
}

/// The numbers that follow each other in `parts`.
fn joined<const N: usize>(parts: &[&[f64]]) -> [f64; N] {
    let mut values = [0.0; N];
    for (slot, value) in values.iter_mut().zip(parts.iter().copied().flatten()) {
        *slot = *value;
    }
    values
}

/// `L` numbers from the `at`-th on.
fn part<const N: usize, const L: usize>(values: &[f64; N], at: usize) -> [f64; L] {
    let rest = values.get(at..).and_then(|rest| rest.first_chunk());
    rest.copied().unwrap_or([f64::NAN; L])
}

impl Motion {
    pub(super) fn new(room: Room) -> Self {
        Self {
            room,
            inertial: None,
            odometry: None,
            poses: None,
            twists: None,
            fixes: None,
        }
    }

    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        fn end<const N: usize, const Q: usize>(rows: &mut Option<Box<Rows<N, Q>>>) {
            if let Some(rows) = rows {
                rows.seam();
            }
        }
        end(&mut self.inertial);
        end(&mut self.odometry);
        end(&mut self.poses);
        end(&mut self.twists);
        end(&mut self.fixes);
    }

    pub(super) fn imu(&mut self, point: Point, imu: &Imu) {
        let values = joined(&[&imu.orientation, &imu.angular_velocity, &imu.linear_acceleration]);
        push(&mut self.inertial, self.room, point, values);
    }

    pub(super) fn odometry(&mut self, point: Point, odometry: &Odometry<'_>) {
        let Odometry {
            position,
            orientation,
            linear,
            angular,
            ..
        } = odometry;
        let values = joined(&[position, orientation, linear, angular]);
        push(&mut self.odometry, self.room, point, values);
    }

    pub(super) fn pose(&mut self, point: Point, position: [f64; 3], orientation: [f64; 4]) {
        push(&mut self.poses, self.room, point, joined(&[&position, &orientation]));
    }

    pub(super) fn twist(&mut self, point: Point, twist: &Twist) {
        let values = joined(&[&twist.linear, &twist.angular]);
        push(&mut self.twists, self.room, point, values);
    }

    /// Takes in a fix; one that says that there is no fix, or has no finite position, is none.
    pub(super) fn fix(&mut self, point: Point, fix: &Fix) {
        if fix.status < 0 || !fix.latitude.is_finite() || !fix.longitude.is_finite() {
            return;
        }
        let [east, _, _, _, north, _, _, _, up] = fix.covariance;
        let position = [fix.latitude, fix.longitude, fix.altitude];
        let values = joined(&[&position, &[east, north, up], &[f64::from(fix.status)]]);
        push(&mut self.fixes, self.room, point, values);
    }

    pub(super) fn finish(self) -> MotionEvidence {
        let odometry = self.odometry.and_then(|rows| rows.finish(odometry_row));
        MotionEvidence {
            inertial: self.inertial.and_then(|rows| rows.finish(inertial_row)),
            poses: odometry.or_else(|| self.poses.and_then(|rows| finish_poses(*rows))),
            twists: self.twists.and_then(|rows| rows.finish(twist_row)),
            fixes: self.fixes.and_then(|rows| rows.finish(fix_row)),
        }
    }
}

fn push<const N: usize, const Q: usize>(
    rows: &mut Option<Box<Rows<N, Q>>>,
    room: Room,
    point: Point,
    values: [f64; N],
) {
    rows.get_or_insert_with(|| Box::new(Rows::new(room)))
        .push(point, values);
}

/// Takes in a valid pose.
pub(in super::super) fn push_pose(poses: &mut Poses, point: Point, pose: &Pose) {
    poses.push(point, joined(&[&pose.translation_m, &pose.rotation_xyzw]));
}

/// The rows of poses without a velocity.
pub(in super::super) fn finish_poses(poses: Poses) -> Option<Series<PoseRow>> {
    poses.finish(
        |Sample {
             stamp_ns,
             log_ns,
             values,
         }| PoseRow {
            stamp_ns,
            log_ns,
            position: part(&values, 0),
            orientation: part(&values, 3),
            twist: None,
        },
    )
}

fn inertial_row(
    Sample {
        stamp_ns,
        log_ns,
        values,
    }: Sample<10>,
) -> InertialRow {
    InertialRow {
        stamp_ns,
        log_ns,
        orientation: part(&values, 0),
        angular_velocity: part(&values, 4),
        linear_acceleration: part(&values, 7),
    }
}

fn odometry_row(
    Sample {
        stamp_ns,
        log_ns,
        values,
    }: Sample<13>,
) -> PoseRow {
    PoseRow {
        stamp_ns,
        log_ns,
        position: part(&values, 0),
        orientation: part(&values, 3),
        twist: Some(motion::Twist {
            linear: part(&values, 7),
            angular: part(&values, 10),
        }),
    }
}

fn twist_row(
    Sample {
        stamp_ns,
        log_ns,
        values,
    }: Sample<6>,
) -> TwistRow {
    TwistRow {
        stamp_ns,
        log_ns,
        twist: motion::Twist {
            linear: part(&values, 0),
            angular: part(&values, 3),
        },
    }
}

fn fix_row(
    Sample {
        stamp_ns,
        log_ns,
        values,
    }: Sample<7>,
) -> FixRow {
    let [latitude_deg, longitude_deg, altitude_m, east, north, up, status] = values;
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a mean of numbers that were an i8 each, not negative"
    )]
    let status = status.floor() as i8;
    FixRow {
        stamp_ns,
        log_ns,
        latitude_deg,
        longitude_deg,
        altitude_m,
        variance_m2: [east, north, up],
        status,
    }
}
