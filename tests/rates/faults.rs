//! The faults that are put into streams, and what a finding must say to have named one.

use std::f64::consts::FRAC_PI_2;

use frames_lint::verdict::Finding;
use nalgebra::{Rotation3, Vector3};

use crate::support::drive::errors::{Error, OrientedRow};
use crate::support::drive::rows::{FixRow, ImuRow, OdometryRow};
use crate::{cloud_worlds, frame_worlds, place_lines};

/// What is wrong with a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// Nothing.
    Healthy,
    /// The inertial sensor, by its name in [`IMU`].
    Imu(&'static str),
    /// Odometry, by its name in [`ODOMETRY`].
    Odometry(&'static str),
    /// The satellite receiver, by its name in [`FIX`].
    Fix(&'static str),
    /// Other streams, with or without a fault, by their name in [`frame_worlds::MADE`].
    FrameWorld(&'static str),
    /// A scene of its own, by its name in [`place_lines::SCENES`]; some of them are healthy.
    Place(&'static str),
    /// What a lidar sees, by its name in [`crate::cloud_scenes::SEEN`]; some of it is healthy.
    Cloud(&'static str),
}

/// What names a fault: words of relations, and texts of messages where several faults fit and are told.
pub type Names = (&'static [&'static str], &'static [&'static str]);

/// A fault: its name, the errors of the stream, and what names it.
type FaultSpec = (&'static str, &'static [Error], Names);

/// A sensor on its side that TF does not know of; the drives have no error of that name.
const SIDE: &str = "on its side";

/// What a sensor's finding says of a track that may be wrong instead.
pub const MIRRORED: &str = "the track that the IMU is compared with is mirrored";

/// What a finding on a velocity says of the position that may be wrong instead.
const POSITION: &str = "the position or the orientation of the pose is wrong";

/// What a finding on two orientations says of a mounting.
pub const CONSTANT: &str = "is constant in the axes of the body";

/// Odometry that is stamped on arrival.
const LATE: &str = "odom 0.1 s late";
/// By how much, seconds.
const LATE_S: f64 = 0.1;

/// Faults of inertial sensors.
pub const IMU: &[FaultSpec] = &[
    (
        "NED/FRD",
        &[Error::NedFrd],
        (&["ned-frd"], &["all of its data are expressed in NED/FRD"]),
    ),
    (
        "orientation NED/FRD",
        &[Error::NedOrientation],
        (&["ned-orientation"], &["the orientation alone is expressed in NED/FRD"]),
    ),
    (
        "world NED",
        &[Error::NedWorld],
        (&["ned-world"], &["the world of the orientation is NED"]),
    ),
    (
        "conjugate",
        &[Error::Conjugate],
        (&["inverse"], &["the orientation is inverted"]),
    ),
    ("wxyz", &[Error::Wxyz], (&["wxyz"], &["in the order w, x, y, z"])),
    (
        "conjugate, wxyz",
        &[Error::Conjugate, Error::Wxyz],
        (
            &["wxyz-inverse"],
            &[
                "in the order w, x, y, z, and inverted",
                "the inverse would be as level",
                "read as the inverse",
            ],
        ),
    ),
    (
        "compass yaw",
        &[Error::CompassYaw],
        (
            &["compass-yaw"],
            &[
                "the yaw is a compass heading",
                "yaw increases clockwise, opposite to the course of topic `/odom`",
                "does not follow its gyro about z",
            ],
        ),
    ),
    (
        "zero north",
        &[Error::ZeroNorth],
        (&[], &["a yaw that is zero in the north"]),
    ),
    (
        "y forward",
        &[Error::YForward],
        (
            &["turned-mount", "z-90"],
            &["its y axis points forward", "whose y axis points forward", CONSTANT],
        ),
    ),
    (
        "mounted backward",
        &[Error::Backward],
        (
            &["turned-mount", "z180"],
            &["mounted with a yaw", "a sensor mounted backwards", CONSTANT],
        ),
    ),
    (
        "mounted at 90 deg",
        &[Error::Yaw90],
        (
            &["turned-mount", "z90"],
            &["mounted with a yaw", "a sensor rotated to the left", CONSTANT],
        ),
    ),
    (
        "upside down",
        &[Error::Inverted],
        (&["upside-down"], &["the sensor is mounted upside down", CONSTANT]),
    ),
    (
        SIDE,
        &[],
        (&["on-its-side"], &["the sensor is mounted on its side", CONSTANT]),
    ),
    ("Euler XYZ", &[Error::EulerXyz], (&[], &["is composed as"])),
    (
        "left-handed",
        &[Error::LeftHanded],
        (&["mirrored"], &["all of its data are expressed in left-handed axes"]),
    ),
    (
        "gyro, accel FRD",
        &[Error::Frd],
        (&["sensor-frd"], &["gyro and accelerometer are expressed in FRD"]),
    ),
    (
        "gyro negated",
        &[Error::GyroNegated],
        (&["gyro-negated"], &["the angular velocity has the opposite sign"]),
    ),
    ("deg/s", &[Error::DegS], (&[], &["the gyro is in deg/s"])),
    ("in g", &[Error::G], (&[], &["the unit is g"])),
    ("cm/s2", &[Error::CmS2], (&[], &["the unit is cm/s2"])),
    (
        "accel negated",
        &[Error::GravitySign],
        (&["gravity-sign"], &["the accelerometer has the opposite sign"]),
    ),
    (
        "gravity removed",
        &[Error::GravityRemoved],
        (&[], &["gravity is removed"]),
    ),
];

/// Faults of odometry.
pub const ODOMETRY: &[FaultSpec] = &[
    ("odom swapped", &[Error::SwapXy], (&["mirrored"], &[MIRRORED, POSITION])),
    (
        "odom -x",
        &[Error::XNegated],
        (&["mirrored"], &[MIRRORED, POSITION, "moves backwards"]),
    ),
    ("odom -y", &[Error::YNegated], (&["mirrored"], &[MIRRORED, POSITION])),
    (
        "odom left-handed",
        &[Error::LeftHanded],
        (&["mirrored"], &[MIRRORED, POSITION]),
    ),
    (
        "odom NED/FRD",
        &[Error::NedFrd],
        (&["mirrored", "z-down"], &[MIRRORED, POSITION]),
    ),
    ("twist in world", &[Error::TwistInWorld], (&["header-frame"], &[])),
    ("twist reversed", &[Error::TwistReversed], (&["negated"], &[])),
    ("twist -y", &[Error::TwistYNegated], (&["y-negated"], &[])),
    ("twist swapped", &[Error::TwistSwapped], (&["xy-swapped"], &[])),
    (LATE, &[], (&[], &["is stamped 0."])),
    (
        "yaw rate negated",
        &[Error::TwistYawNegated],
        (&[], &["yaw rate has the opposite sign"]),
    ),
];

/// Faults of satellite receivers.
pub const FIX: &[FaultSpec] = &[(
    "lat/lon swapped",
    &[Error::Swapped],
    (&["swapped", "mirrored"], &[MIRRORED, POSITION]),
)];

impl Fault {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Healthy => "healthy",
            Self::Imu(name)
            | Self::Odometry(name)
            | Self::Fix(name)
            | Self::FrameWorld(name)
            | Self::Place(name)
            | Self::Cloud(name) => name,
        }
    }

    fn known(self) -> Option<&'static FaultSpec> {
        let (of, name) = match self {
            Self::Healthy | Self::FrameWorld(_) | Self::Place(_) | Self::Cloud(_) => return None,
            Self::Imu(name) => (IMU, name),
            Self::Odometry(name) => (ODOMETRY, name),
            Self::Fix(name) => (FIX, name),
        };
        let known = of.iter().find(|known| known.0 == name);
        Some(known.unwrap_or_else(|| panic!("no fault is called `{name}`")))
    }

    /// Whether nothing is wrong.
    pub fn is_healthy(self) -> bool {
        match self {
            Self::Place(name) => place_lines::scene(name).is_healthy,
            Self::Cloud(name) => cloud_worlds::world_named(name).is_healthy,
            _ => self.names().is_none(),
        }
    }

    /// What names it; nothing names what is healthy.
    fn names(self) -> Option<Names> {
        match self {
            Self::FrameWorld(name) => frame_worlds::made(name).names,
            _ => Some(self.known()?.2),
        }
    }

    /// The messages of an inertial sensor with the fault.
    pub fn imu(self, healthy: &[ImuRow], gravity: f64) -> Option<Vec<ImuRow>> {
        let Self::Imu(name) = self else { return None };
        let (_, errors, _) = self.known()?;
        let side = Rotation3::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
        let mut rows = healthy.to_vec();
        for row in &mut rows {
            for error in *errors {
                row.apply(*error, gravity);
            }
            if name == SIDE {
                row.change_body(&side);
            }
        }
        Some(rows)
    }

    /// The messages of odometry with the fault.
    pub fn odometry(self, healthy: &[OdometryRow]) -> Option<Vec<OdometryRow>> {
        let Self::Odometry(name) = self else { return None };
        let (_, errors, _) = self.known()?;
        let mut rows = healthy.to_vec();
        for row in &mut rows {
            errors.iter().for_each(|error| row.apply(*error));
            if name == LATE {
                row.pose.t_s += LATE_S;
            }
        }
        Some(rows)
    }

    /// The messages of a receiver with the fault.
    pub fn fixes(self, healthy: &[FixRow], undulation_m: f64) -> Option<Vec<FixRow>> {
        let Self::Fix(_) = self else { return None };
        let (_, errors, _) = self.known()?;
        let mut rows = healthy.to_vec();
        for row in &mut rows {
            errors.iter().for_each(|error| row.apply(*error, undulation_m));
        }
        Some(rows)
    }

    /// Whether a finding names it, alone or among those that it says fit as well.
    pub fn is_named_by(self, finding: &Finding) -> bool {
        if let Self::Place(name) = self {
            return place_lines::scene(name).is_named_by(finding.relation.as_deref(), &finding.text());
        }
        if let Self::Cloud(name) = self {
            return cloud_worlds::world_named(name).is_named_by(finding);
        }
        self.names().is_some_and(|(words, texts)| {
            let relation = finding.relation.as_deref();
            relation.is_some_and(|word| words.contains(&word)) || texts.iter().any(|text| finding.says(text))
        })
    }
}
