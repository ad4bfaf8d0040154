//! Motion, row by row: which numbers of which messages are kept, and as what.

use crate::read::messages::content::{Fix, Imu, Nmea, Odometry, Pose, Twist};
use crate::world::motion::{
    self, FixRow, InertialRow, MotionEvidence, NmeaRow, OrientationRow, PoseRow, Series, TwistRow, VectorRow,
};

use super::super::point::Point;
use super::super::series::{RowBudget, Rows, Sample};
use super::path::Path;
use super::poses::{joined, pose_row};

/// No rate (rad/s, deg/s) and no acceleration (m/s^2, g, mg) is larger.
const MOST_READ: f64 = 1e6;

/// What one topic states of motion; nothing is allocated for the rest.
pub(super) struct Motion {
    room: RowBudget,
    /// Orientation, angular velocity, acceleration.
    inertial: LazyRows<10, 0>,
    /// Position, orientation, velocity, angular velocity.
    odometry: LazyRows<13, 3>,
    poses: LazyRows<7, 3>,
    path: Option<Box<Path>>,
    /// Velocity, angular velocity.
    twists: LazyRows<6, 6>,
    /// Latitude, longitude, altitude, three variances, status.
    fixes: LazyRows<7, 7>,
    orientations: LazyRows<4, 0>,
    vectors: LazyRows<3, 3>,
    /// In the order of [`NmeaRow`].
    nmea: LazyRows<11, 11>,
}

/// Rows for which nothing is allocated before the first.
struct LazyRows<const N: usize, const Q: usize>(Option<Box<Rows<N, Q>>>);

impl<const N: usize, const Q: usize> LazyRows<N, Q> {
    fn push(&mut self, room: RowBudget, point: Point, parts: &[&[f64]]) {
        let rows = self.0.get_or_insert_with(|| Box::new(Rows::new(room)));
        rows.push(point, joined(parts));
    }

    fn seam(&mut self) {
        if let Some(rows) = &mut self.0 {
            rows.seam();
        }
    }

    fn finish<T>(self, row: impl Fn(Sample<N>) -> T) -> Option<Series<T>> {
        self.0.and_then(|rows| rows.finish(row))
    }
}

impl Motion {
    pub(super) fn new(room: RowBudget) -> Self {
        Self {
            room,
            inertial: LazyRows(None),
            odometry: LazyRows(None),
            poses: LazyRows(None),
            path: None,
            twists: LazyRows(None),
            fixes: LazyRows(None),
            orientations: LazyRows(None),
            vectors: LazyRows(None),
            nmea: LazyRows(None),
        }
    }

    /// Messages were left out here. A path holds what was missed.
    pub(super) fn seam(&mut self) {
        self.inertial.seam();
        self.odometry.seam();
        self.poses.seam();
        self.twists.seam();
        self.fixes.seam();
        self.orientations.seam();
        self.vectors.seam();
        self.nmea.seam();
    }

    pub(super) fn imu(&mut self, point: Point, imu: &Imu) {
        // One damaged message of thousands would outweigh all others in a mean.
        let read = |value: f64| if value.abs() < MOST_READ { value } else { f64::NAN };
        let (rates, forces) = (imu.angular_velocity.map(read), imu.linear_acceleration.map(read));
        self.inertial
            .push(self.room, point, &[&imu.orientation, &rates, &forces]);
    }

    pub(super) fn odometry(&mut self, point: Point, odometry: &Odometry<'_>) {
        let Odometry {
            position,
            orientation,
            linear,
            angular,
            ..
        } = odometry;
        self.odometry
            .push(self.room, point, &[position, orientation, linear, angular]);
    }

    pub(super) fn pose(&mut self, point: Point, position: [f64; 3], orientation: [f64; 4]) {
        self.poses.push(self.room, point, &[&position, &orientation]);
    }

    pub(super) fn path(&mut self, point: Point, poses: &[(i64, Pose)]) {
        let room = self.room;
        self.path
            .get_or_insert_with(|| Box::new(Path::new(room)))
            .push(point, poses);
    }

    pub(super) fn twist(&mut self, point: Point, twist: &Twist) {
        self.twists.push(self.room, point, &[&twist.linear, &twist.angular]);
    }

    pub(super) fn orientation(&mut self, point: Point, orientation: [f64; 4]) {
        self.orientations.push(self.room, point, &[&orientation]);
    }

    pub(super) fn vector(&mut self, point: Point, vector: [f64; 3]) {
        self.vectors.push(self.room, point, &[&vector]);
    }

    /// Takes in a fix; one with the status of no fix, or without a finite position, is none.
    pub(super) fn fix(&mut self, point: Point, fix: &Fix) {
        if fix.status < 0 || !fix.latitude.is_finite() || !fix.longitude.is_finite() {
            return;
        }
        let [east, _, _, _, north, _, _, _, up] = fix.covariance;
        let position = [fix.latitude, fix.longitude, fix.altitude];
        let parts: [&[f64]; 3] = [&position, &[east, north, up], &[f64::from(fix.status)]];
        self.fixes.push(self.room, point, &parts);
        if let Some(velocity) = fix.velocity {
            self.twists.push(self.room, point, &[&velocity, &[f64::NAN; 3]]);
        }
    }

    /// Takes in a sentence. A position without a fix is none.
    pub(super) fn nmea(&mut self, point: Point, nmea: &Nmea) {
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let position = nmea.position.filter(|_| nmea.quality != Some(0));
        let [latitude, longitude] = position.unwrap_or([f64::NAN; 2]);
        let height = |value: Option<f64>| or_nan(value.filter(|_| position.is_some()));
        let values = [
            or_nan(nmea.time_s),
            latitude,
            longitude,
            height(nmea.altitude_m),
            height(nmea.geoid_separation_m),
            or_nan(nmea.speed_m_s),
            or_nan(nmea.course_deg),
            or_nan(nmea.true_heading_deg),
            or_nan(nmea.magnetic_heading_deg),
            or_nan(nmea.variation_deg),
            or_nan(nmea.quality.map(f64::from)),
        ];
        let room = self.room;
        let rows = self.nmea.0.get_or_insert_with(|| Box::new(Rows::filled(room)));
        rows.push(point, values);
    }

    pub(super) fn finish(self) -> MotionEvidence {
        let odometry = self.odometry.finish(|row| PoseRow {
            twist: Some(motion::Twist {
                linear: row.part(7),
                angular: row.part(10),
            }),
            ..pose_row(&row)
        });
        let poses = self.poses.finish(|row| pose_row(&row));
        MotionEvidence {
            inertial: self.inertial.finish(|row| InertialRow {
                stamp_ns: row.stamp_ns,
                log_ns: row.log_ns,
                orientation: row.part(0),
                angular_velocity: row.part(4),
                linear_acceleration: row.part(7),
            }),
            poses: odometry.or(poses).or_else(|| self.path?.finish()),
            twists: self.twists.finish(|row| TwistRow {
                stamp_ns: row.stamp_ns,
                log_ns: row.log_ns,
                twist: motion::Twist {
                    linear: row.part(0),
                    angular: row.part(3),
                },
            }),
            fixes: self.fixes.finish(fix_row),
            orientations: self.orientations.finish(|row| OrientationRow {
                stamp_ns: row.stamp_ns,
                log_ns: row.log_ns,
                orientation: row.values,
            }),
            vectors: self.vectors.finish(|row| VectorRow {
                stamp_ns: row.stamp_ns,
                log_ns: row.log_ns,
                vector: row.values,
            }),
            nmea: self.nmea.finish(nmea_row),
        }
    }
}

fn fix_row(row: Sample<7>) -> FixRow {
    let [latitude_deg, longitude_deg, altitude_m, east, north, up, status] = row.values;
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a mean of numbers that were an i8 each, not negative"
    )]
    let status = status.floor() as i8;
    FixRow {
        stamp_ns: row.stamp_ns,
        log_ns: row.log_ns,
        latitude_deg,
        longitude_deg,
        altitude_m,
        variance_m2: [east, north, up],
        status,
    }
}

fn nmea_row(row: Sample<11>) -> NmeaRow {
    let [
        time_s,
        latitude_deg,
        longitude_deg,
        altitude_m,
        geoid_separation_m,
        speed_m_s,
        course_deg,
        true_heading_deg,
        magnetic_heading_deg,
        variation_deg,
        quality,
    ] = row.values;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "NaN, or a number that was an u8"
    )]
    let quality = quality.is_finite().then_some(quality as u8);
    NmeaRow {
        stamp_ns: row.stamp_ns,
        log_ns: row.log_ns,
        time_s,
        latitude_deg,
        longitude_deg,
        altitude_m,
        geoid_separation_m,
        speed_m_s,
        course_deg,
        true_heading_deg,
        magnetic_heading_deg,
        variation_deg,
        quality,
    }
}
