//! Inertial messages, and mistakes in them.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::faults::{Change, Family, Subject};
use crate::math::stats::median;
use crate::world::World;
use crate::world::content::{ContentEvidence, CovarianceEvidence, ImuEvidence};
use crate::world::motion::{InertialRow, Series};

use super::covariances::{change_covariances, is_stated, rotate};
use super::streams::Stream;
use super::turns::{Oriented, is_same_orientation, is_same_vector, mirrored, rotation, turned};

/// Standard gravity, m/s².
pub const GRAVITY: f64 = 9.806_65;

/// A magnitude of the acceleration within this share of gravity contains it.
const GRAVITY_SHARE: f64 = 0.12;
/// Rows of a stream that two mistakes are compared on.
const COMPARED_ROWS: usize = 32;
/// The fields with covariances, in the order of [`ImuMessage`].
const COVARIANCES: [&str; 3] = [
    "orientation_covariance",
    "angular_velocity_covariance",
    "linear_acceleration_covariance",
];

/// What an inertial message states (`sensor_msgs/Imu`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuMessage {
    /// The four slots `x y z w` of `world_from_sensor`; zeros where there is none.
    pub orientation: [f64; 4],
    /// rad/s, in the sensor's axes.
    pub gyro: [f64; 3],
    /// Specific force, m/s², in the sensor's axes.
    pub acceleration: [f64; 3],
    /// rad², row-major.
    pub orientation_covariance: [f64; 9],
    /// rad²/s², row-major.
    pub gyro_covariance: [f64; 9],
    /// m²/s⁴, row-major.
    pub acceleration_covariance: [f64; 9],
}

impl ImuMessage {
    /// A message that states these covariances alone.
    fn of_covariance(values: [f64; 9]) -> Self {
        Self {
            orientation: [0.0, 0.0, 0.0, 1.0],
            gyro: [0.0; 3],
            acceleration: [0.0; 3],
            orientation_covariance: values,
            gyro_covariance: values,
            acceleration_covariance: values,
        }
    }

    fn of_row(row: &InertialRow) -> Self {
        Self {
            orientation: row.orientation,
            gyro: row.angular_velocity,
            acceleration: row.linear_acceleration,
            ..Self::of_covariance([0.0; 9])
        }
    }

    /// The gyro in other axes or units.
    pub(super) fn change_gyro(&mut self, new_from_old: &Matrix3<f64>) {
        self.gyro = (new_from_old * Vector3::from(self.gyro)).into();
        rotate(&mut self.gyro_covariance, new_from_old);
    }

    /// The acceleration in other axes or units.
    pub(super) fn change_acceleration(&mut self, new_from_old: &Matrix3<f64>) {
        self.acceleration = (new_from_old * Vector3::from(self.acceleration)).into();
        rotate(&mut self.acceleration_covariance, new_from_old);
    }

    /// Gyro and acceleration in other axes.
    pub(super) fn change_vectors(&mut self, new_from_old: &Matrix3<f64>) {
        self.change_gyro(new_from_old);
        self.change_acceleration(new_from_old);
    }

    /// Takes gravity off the acceleration: along the vertical of the orientation, without one along z.
    pub(super) fn remove_gravity(&mut self) {
        let up = rotation(self.orientation).inverse() * Vector3::z() * GRAVITY;
        self.acceleration = (Vector3::from(self.acceleration) - up).into();
    }

    /// Whether two messages state the same.
    fn is_same(&self, other: &Self) -> bool {
        is_same_orientation(self.orientation, other.orientation)
            && is_same_vector(self.gyro, other.gyro)
            && is_same_vector(self.acceleration, other.acceleration)
    }
}

impl Oriented for ImuMessage {
    fn orientation(&mut self) -> &mut [f64; 4] {
        &mut self.orientation
    }

    fn change_world(&mut self, new_from_old: &Rotation3<f64>) {
        self.orientation = turned(self.orientation, |stated| UnitQuaternion::from(*new_from_old) * stated);
        rotate(&mut self.orientation_covariance, new_from_old.matrix());
    }

    fn change_body(&mut self, old_from_new: &Rotation3<f64>) {
        self.orientation = turned(self.orientation, |stated| stated * UnitQuaternion::from(*old_from_new));
        self.change_vectors(old_from_new.inverse().matrix());
    }

    fn mirror(&mut self) {
        self.orientation = mirrored(self.orientation);
        self.change_gyro(&super::turns::diagonal(-1.0, 1.0, -1.0));
        self.change_acceleration(&super::turns::diagonal(1.0, -1.0, 1.0));
    }
}

/// What the messages must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ImuNeed {
    /// Nothing.
    Anything,
    /// An orientation that changes.
    Orientation,
    /// Gravity in the acceleration.
    Gravity,
    /// A covariance of the orientation.
    Covariance,
}

/// A relation, and what the mistake of that name does to a message.
pub(super) type KnownImuMistake = (&'static str, fn(&mut ImuMessage));

/// A mistake in inertial messages.
pub(super) struct ImuChange {
    /// What the messages must have.
    pub(super) needs: ImuNeed,
    /// What it does to a message. Rows are means of messages, number by number.
    pub(super) change: fn(&mut ImuMessage),
    /// Mistakes that may change the same messages in the same way.
    pub(super) known: &'static [KnownImuMistake],
}

impl Change for ImuChange {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        Stream::subjects(world, Family::Imu)
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let Some(stream) = Stream::of(subject) else {
            return false;
        };
        self.needs.is_met(world, stream) && change_imu(world, stream, self.change)
    }

    fn same_as(&self, world: &World, subject: &Subject) -> Vec<&'static str> {
        let rows = Stream::of(subject)
            .map(|stream| compared(world, stream))
            .unwrap_or_default();
        let is_same = |other: &fn(&mut ImuMessage)| {
            rows.iter().all(|(row, has_orientation)| {
                changed(row, *has_orientation, self.change).is_same(&changed(row, *has_orientation, other))
            })
        };
        let changes_nothing: fn(&mut ImuMessage) = |_| {};
        if is_same(&changes_nothing) {
            return Vec::new();
        }
        let same = self.known.iter().filter(|(_, other)| is_same(other));
        same.map(|(relation, _)| *relation).collect()
    }
}

impl ImuNeed {
    fn is_met(self, world: &World, stream: &Stream) -> bool {
        stream.contents(world).into_iter().any(|content| match self {
            Self::Anything => true,
            Self::Orientation => has_orientation(content),
            Self::Gravity => {
                let rows = content.motion.inertial.iter().flat_map(Series::rows);
                let lengths: Vec<f64> = rows
                    .map(|row| Vector3::from(row.linear_acceleration).norm())
                    .filter(|length| length.is_finite())
                    .collect();
                median(&lengths).is_some_and(|length| (length / GRAVITY - 1.0).abs() < GRAVITY_SHARE)
            }
            Self::Covariance => COVARIANCES.first().is_some_and(|field| is_stated(content, field)),
        })
    }
}

/// Whether the messages state an orientation: one that is always the same, or declared as not measured, is none.
fn has_orientation(content: &ContentEvidence) -> bool {
    let covariance = content.covariances.get("orientation_covariance");
    if covariance.is_some_and(CovarianceEvidence::is_declared_absent) {
        return false;
    }
    let mut rows = content.motion.inertial.iter().flat_map(Series::rows);
    let first = rows.next().map(|row| row.orientation.map(f64::to_bits));
    rows.any(|row| Some(row.orientation.map(f64::to_bits)) != first)
}

/// A message with a mistake: where there is no orientation, none appears.
fn changed(message: &ImuMessage, has_orientation: bool, change: impl Fn(&mut ImuMessage)) -> ImuMessage {
    let mut altered = *message;
    change(&mut altered);
    if !has_orientation {
        altered.orientation = message.orientation;
    }
    altered
}

/// Some rows of a stream, each with whether there is an orientation.
fn compared(world: &World, stream: &Stream) -> Vec<(ImuMessage, bool)> {
    let contents = stream.contents(world).into_iter();
    let of_content = |content: &ContentEvidence| {
        let has_orientation = has_orientation(content);
        let rows = || content.motion.inertial.iter().flat_map(Series::rows);
        let step = rows().count().div_ceil(COMPARED_ROWS).max(1);
        let rows = rows()
            .step_by(step)
            .map(|row| (ImuMessage::of_row(row), has_orientation));
        rows.collect::<Vec<_>>()
    };
    contents.flat_map(of_content).collect()
}

/// Changes the inertial messages of a stream, as far as evidence has them. False if none of them changes.
pub fn change_imu(world: &mut World, stream: &Stream, change: impl Fn(&mut ImuMessage)) -> bool {
    let mut is_changed = false;
    stream.change_contents(world, |content| {
        let has_orientation = has_orientation(content);
        let (mut before, mut after) = (0.0, 0.0);
        let series = content.motion.inertial.iter_mut();
        for row in series.flat_map(|series| series.stretches.iter_mut().flatten()) {
            let message = ImuMessage::of_row(row);
            let altered = changed(&message, has_orientation, &change);
            is_changed |= !altered.is_same(&message);
            let square = |gyro: [f64; 3]| Some(Vector3::from(gyro).norm_squared()).filter(|square| square.is_finite());
            before += square(message.gyro).unwrap_or_default();
            after += square(altered.gyro).unwrap_or_default();
            row.orientation = altered.orientation;
            (row.angular_velocity, row.linear_acceleration) = (altered.gyro, altered.acceleration);
        }
        let scale = if before > 0.0 { (after / before).sqrt() } else { 1.0 };
        if let Some(imu) = &mut content.imu {
            change_counts(imu, scale, has_orientation, &change);
        }
        for (field, covariance_of) in COVARIANCES.into_iter().zip([
            (|altered: ImuMessage| altered.orientation_covariance) as fn(ImuMessage) -> [f64; 9],
            |altered| altered.gyro_covariance,
            |altered| altered.acceleration_covariance,
        ]) {
            change_covariances::<9>(content, field, |_, values| {
                let mut message = ImuMessage::of_covariance(values);
                change(&mut message);
                let new = covariance_of(message);
                is_changed |= !is_same_vector(new, values);
                new
            });
        }
    });
    is_changed
}

/// Changes what was counted of all messages; the gyro is this many times as large.
fn change_counts(imu: &mut ImuEvidence, scale: f64, has_orientation: bool, change: impl Fn(&mut ImuMessage)) {
    imu.angular_velocity_rms *= scale;
    imu.turned_rad *= scale;
    let identity = ImuMessage::of_covariance([0.0; 9]);
    let altered = changed(&identity, has_orientation, change);
    if !is_same_orientation(altered.orientation, identity.orientation) {
        imu.identity = 0;
    }
}
