//! Evidence of the content of messages beyond their header: motion, fixes, covariances. Bounded measurements, no messages.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::source::MessageRef;

use super::camera::{CalibrationEvidence, ImageEvidence};
use super::claim::Pose;
use super::cloud::CloudEvidence;
use super::laser::LaserEvidence;
use super::motion::MotionEvidence;
use super::projection::GridEvidence;
use super::radar::RadarEvidence;

/// A pose at a message.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseAt {
    /// The message.
    pub at: MessageRef,
    /// `parent_from_child`.
    pub pose: Pose,
}

/// The step between two neighbouring poses of one stream. Steps across a seam of sampling are not taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Stamp of the later pose minus that of the earlier, nanoseconds; positive.
    pub dt_ns: i64,
    /// Distance between the two origins, metres.
    #[serde(with = "super::number")]
    pub distance_m: f64,
    /// Angle between the two orientations, radians.
    #[serde(with = "super::number")]
    pub angle_rad: f64,
    /// Distance between the later origin and the one that the velocity of the step before predicts, metres; NaN where
    /// there was no step before.
    #[serde(with = "super::number")]
    pub surprise_m: f64,
    /// Angle between the later orientation and the one that the angular velocity of the step before predicts, radians.
    #[serde(with = "super::number")]
    pub surprise_rad: f64,
}

/// A conspicuous step, with the poses before and after it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepAt {
    /// The step.
    pub step: Step,
    /// The pose before.
    pub before: PoseAt,
    /// The pose after.
    pub after: PoseAt,
}

/// How a stream of poses moves from one to the next, in recording order. Poses whose stamp is zero or does not increase are
/// skipped; a stamp that jumps back by more than a second is a restarted clock, treated like a seam.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepEvidence {
    /// Steps taken.
    pub count: u64,
    /// Steps that change the pose at all (more than 1e-9 m or rad).
    pub moving: u64,
    /// A random sample of the steps, with the same chance for each; all of them while they are few.
    pub sample: Vec<Step>,
    /// The steps that are largest by distance, the largest first.
    pub farthest: Vec<StepAt>,
    /// The steps that are largest by angle, the largest first.
    pub widest: Vec<StepAt>,
    /// The steps with the largest `surprise_m`, the largest first.
    pub most_surprising: Vec<StepAt>,
    /// Steps by more than 1 mm or 0.05° that the next step undoes to within a fifth: two writers that alternate.
    pub undone: u64,
    /// The first of them.
    pub first_undone: Option<StepAt>,
}

/// One `sensor_msgs/msg/NavSatFix` or equal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FixAt {
    /// The message.
    pub at: MessageRef,
    /// Latitude, degrees as published.
    #[serde(with = "super::number")]
    pub latitude_deg: f64,
    /// Longitude, degrees as published.
    #[serde(with = "super::number")]
    pub longitude_deg: f64,
    /// Altitude above the ellipsoid, metres as published.
    #[serde(with = "super::number")]
    pub altitude_m: f64,
    /// `NavSatStatus.status`: -1 no fix, 0 fix, 1 SBAS, 2 GBAS.
    pub status: i8,
}

/// Fixes of one topic.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FixEvidence {
    /// Messages.
    pub count: u64,
    /// Messages whose status is "no fix".
    pub no_fix: u64,
    /// Evenly thinned fixes, the first and last among them.
    pub samples: Vec<FixAt>,
    /// Messages with a fix whose latitude or longitude is not finite, and the first few.
    pub non_finite: (u64, Vec<FixAt>),
    /// Messages with a fix whose latitude is beyond 90 or longitude beyond 180 degrees, and the first few.
    pub out_of_range: (u64, Vec<FixAt>),
    /// Messages with a fix at latitude 0 and longitude 0 exactly, and the first few.
    pub null_island: (u64, Vec<FixAt>),
}

/// A covariance matrix that a topic publishes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CovarianceAt {
    /// The first message that carries it.
    pub at: MessageRef,
    /// How many messages carry exactly these numbers, as far as counted.
    pub count: u64,
    /// Row-major: 9 or 36 numbers.
    #[serde(with = "super::number::list")]
    pub values: Vec<f64>,
}

/// The covariances of one field of a topic (`pose.covariance`, `orientation_covariance`).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CovarianceEvidence {
    /// Messages that carry the field.
    pub count: u64,
    /// Different matrices: the first few, and then evenly thinned ones; of two that alternate, each is counted.
    pub samples: Vec<CovarianceAt>,
    /// Messages whose matrix has a number that is not finite, and the first.
    pub non_finite: (u64, Option<CovarianceAt>),
    /// Messages whose matrix is all zeros.
    pub all_zero: u64,
    /// Messages whose first number is -1: the field is declared as not provided (`sensor_msgs/Imu`).
    pub minus_one: u64,
    /// Of the finite matrices that are not all zeros, and not declared as not provided by a -1: the one with
    /// the largest asymmetry `max |a_ij - a_ji| / max |a|`, and that asymmetry.
    pub most_asymmetric: Option<(f64, CovarianceAt)>,
    /// Of the same matrices the one with the smallest `smallest eigenvalue of (C + Cᵀ)/2, over max |a|`, and that ratio.
    pub least_positive: Option<(f64, CovarianceAt)>,
}

impl CovarianceEvidence {
    /// Whether every message declares the field as not provided.
    pub fn is_declared_absent(&self) -> bool {
        self.count > 0 && self.minus_one == self.count
    }
}

/// The content of inertial messages: enough to know whether they carry an orientation at all.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImuEvidence {
    /// Messages.
    pub count: u64,
    /// Messages whose orientation is the identity exactly.
    pub identity: u64,
    /// Messages whose orientation is all zeros.
    pub zero: u64,
    /// Messages whose orientation equals that of the first message exactly.
    pub same_as_first: u64,
    /// The first message.
    pub first: Option<MessageRef>,
    /// Root mean square of the angular velocity, rad/s as published; NaN if no message has a finite one.
    #[serde(with = "super::number")]
    pub angular_velocity_rms: f64,
    /// Integral of the angular speed over the messages, radians as published. Steps across seams and of more than a
    /// second are skipped.
    #[serde(with = "super::number")]
    pub turned_rad: f64,
}

/// The content of odometry messages.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OdometryEvidence {
    /// Evenly thinned poses `header.frame_id from child_frame_id`, the first and last among them.
    pub samples: Vec<PoseAt>,
    /// How the pose moves.
    pub steps: StepEvidence,
    /// Largest speed that the twist claims, m/s; NaN if it has none.
    #[serde(with = "super::number")]
    pub largest_speed_m_s: f64,
    /// Largest turning speed that the twist claims, rad/s.
    #[serde(with = "super::number")]
    pub largest_turn_rad_s: f64,
}

/// The content of the messages of one topic beyond their header.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContentEvidence {
    /// Satellite fixes.
    pub fixes: Option<FixEvidence>,
    /// Covariances, by field.
    pub covariances: BTreeMap<String, CovarianceEvidence>,
    /// Inertial messages.
    pub imu: Option<ImuEvidence>,
    /// Odometry.
    pub odometry: Option<OdometryEvidence>,
    /// Calibrations of a camera.
    #[serde(default)]
    pub calibrations: Option<CalibrationEvidence>,
    /// Images.
    #[serde(default)]
    pub images: Option<ImageEvidence>,
    /// Clouds of points.
    #[serde(default)]
    pub clouds: Option<CloudEvidence>,
    /// Grids.
    #[serde(default)]
    pub grids: Option<GridEvidence>,
    /// Scans of a plane.
    #[serde(default)]
    pub lasers: Option<Box<LaserEvidence>>,
    /// Detections of a radar; also those of a cloud whose points have a speed.
    #[serde(default)]
    pub radar: Option<Box<RadarEvidence>>,
    /// Motion, row by row.
    #[serde(default)]
    pub motion: MotionEvidence,
}
