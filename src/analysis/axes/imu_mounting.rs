//! The rotation of an inertial sensor's mounting, by the turns of its gyro and those of poses of the platform.
//!
//! Turns about two axes determine it; about one, only where that axis is. Must not judge.

use nalgebra::{Matrix3, UnitQuaternion};
use serde::Deserialize;

use crate::analysis::estimates::{Estimates, hash_numbers};
use crate::analysis::motion::{BagMotion, Imu, Orientations};
use crate::math::readings::Reading;
use crate::math::rotation::nearest_rotation;
use crate::math::turns::{Options, Row, turns};
use crate::source::Place;
use crate::verdict::NotEvaluated;
use crate::world::FrameId;

/// Longest step between two poses, seconds.
const MAX_STEP_S: f64 = 0.25;
/// Poses may be late or early by up to this, in these steps, seconds.
const MAX_LAG_S: f64 = 0.3;
const LAG_STEP_S: f64 = 0.02;
/// Parts of the recording, each of which is left out once.
const PARTS: usize = 8;

/// Relations of a stated mounting to the measured one that leave nothing else to explain: what other rules measure of the sensor follows.
pub(crate) const EXACT: [&str; 2] = ["exchanged", "inverse"];

/// The mounting as stated, and as the turns show it.
pub(crate) struct ImuMounting {
    /// The frame that the poses move.
    pub(crate) body: FrameId,
    /// Name of the poses in reports, and their place.
    pub(crate) poses: (String, Place),
    /// `body_from_imu`, by the transforms.
    pub(crate) stated: UnitQuaternion<f64>,
    /// The same, by the turns.
    pub(crate) fitted: UnitQuaternion<f64>,
    /// Standard error of `fitted`, radians: that of its least certain axis.
    pub(crate) sigma_rad: f64,
    /// Unexplained share of the turns with the stated and with the fitted rotation.
    pub(crate) residuals: [f64; 2],
    /// Rotation of the gyro over that of the poses.
    pub(crate) gain: f64,
    /// Windows with turns.
    pub(crate) windows: usize,
}

/// Sums over the windows of a part.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// sum d g^T: d by the poses in the body's axes, g by the gyro in its own.
    cross: Matrix3<f64>,
    gyro_power: f64,
    pose_power: f64,
    windows: usize,
}

impl Sums {
    fn and(self, other: &Self) -> Self {
        Self {
            cross: self.cross + other.cross,
            gyro_power: self.gyro_power + other.gyro_power,
            pose_power: self.pose_power + other.pose_power,
            windows: self.windows + other.windows,
        }
    }

    fn rotation(&self) -> Option<UnitQuaternion<f64>> {
        Some(UnitQuaternion::from_rotation_matrix(
            &nearest_rotation(&self.cross)?.rotation,
        ))
    }

    fn residual(&self, body_from_imu: &UnitQuaternion<f64>) -> f64 {
        let explained = (body_from_imu.to_rotation_matrix().matrix().transpose() * self.cross).trace();
        ((self.pose_power + self.gyro_power - 2.0 * explained).max(0.0) / self.pose_power).sqrt()
    }
}

impl ImuMounting {
    /// By the poses that determine it best; or why none do.
    pub(crate) fn of(
        world: &Estimates,
        bag: &BagMotion,
        imu: &Imu,
        limits: &Limits,
    ) -> Result<Self, (NotEvaluated, String)> {
        let missing = |why: &str| (NotEvaluated::MissingInput, why.to_owned());
        let frame = imu.stream.frame.as_ref();
        let frame = frame.ok_or_else(|| missing("the messages have no `frame_id`"))?;
        let mut best: Option<Self> = None;
        let mut why = missing("no poses with orientations of a frame that TF ties to the sensor");
        for poses in bag.ways() {
            let Some(body) = poses.child.clone() else { continue };
            let Some((body_from_imu, _)) = world.graph().chain(&body, frame, |edge| edge.is_rigid) else {
                continue;
            };
            let oriented = Orientations::of(poses);
            let parts = world.shared(
                |hasher| {
                    hash_numbers(hasher, oriented.numbers());
                    let rows = imu.stream.rows();
                    hash_numbers(
                        hasher,
                        rows.flat_map(|timed| [timed.t_s].into_iter().chain(timed.row.angular_velocity)),
                    );
                },
                || parts(imu, &oriented),
            );
            let stated = body_from_imu.rotation;
            let seen = (body, (poses.subject.clone(), poses.place()), stated);
            match Self::fitted(seen, &parts, limits) {
                Ok(found) if best.as_ref().is_none_or(|best| found.sigma_rad < best.sigma_rad) => best = Some(found),
                Ok(_) => {}
                Err(lacks) => why = (NotEvaluated::TooLittleEvidence, lacks),
            }
        }
        best.ok_or(why)
    }

    fn fitted(
        (body, poses, stated): (FrameId, (String, Place), UnitQuaternion<f64>),
        parts: &[Sums],
        limits: &Limits,
    ) -> Result<Self, String> {
        let whole = parts.iter().fold(Sums::default(), Sums::and);
        if whole.windows < limits.min_windows {
            return Err(format!(
                "gyro and poses turn together in {} windows of 1 s (at least {} needed)",
                whole.windows, limits.min_windows
            ));
        }
        let one_axis = || "the platform turns about one axis only: record roll or pitch, too".to_owned();
        let fitted = whole.rotation().ok_or_else(one_axis)?;
        // Jackknife: how far the rotation moves without one part after the other.
        let mut squares = 0.0;
        for left_out in 0..parts.len() {
            let others = parts.iter().enumerate().filter(|(part, _)| *part != left_out);
            let rest = others.fold(Sums::default(), |sums, (_, part)| sums.and(part));
            squares += fitted.angle_to(&rest.rotation().ok_or_else(one_axis)?).powi(2);
        }
        let count = parts.len() as f64;
        Ok(Self {
            body,
            poses,
            stated,
            fitted,
            sigma_rad: (squares * (count - 1.0) / count).sqrt(),
            residuals: [stated, fitted].map(|rotation| whole.residual(&rotation)),
            gain: (whole.gyro_power / whole.pose_power).sqrt(),
            windows: whole.windows,
        })
    }
}

/// The sums of each part of the recording.
fn parts(imu: &Imu, oriented: &Orientations) -> Vec<Sums> {
    let rows: Vec<Vec<Row>> = imu
        .stream
        .stretches
        .iter()
        .map(|stretch| {
            let row = |t_s: f64, rate_rad_s| {
                let slots = oriented.at(t_s, MAX_STEP_S)?.coords.into();
                Some(Row { t_s, slots, rate_rad_s })
            };
            stretch
                .iter()
                .filter_map(|timed| row(timed.t_s, timed.row.angular_velocity))
                .collect()
        })
        .collect();
    let size = rows.iter().map(Vec::len).sum::<usize>().div_ceil(PARTS).max(1);
    let mut cut: Vec<Vec<&[Row]>> = vec![Vec::new()];
    let mut left = size;
    for mut stretch in rows.iter().map(Vec::as_slice) {
        while !stretch.is_empty() {
            let (head, tail) = stretch.split_at(left.min(stretch.len()));
            cut.last_mut().into_iter().for_each(|part| part.push(head));
            (left, stretch) = (left - head.len(), tail);
            if left == 0 {
                cut.push(Vec::new());
                left = size;
            }
        }
    }
    let options = Options {
        max_lag_s: MAX_LAG_S,
        lag_step_s: LAG_STEP_S,
        ..Options::new(1.0)
    };
    let sums = |part: Vec<&[Row]>| {
        let turned = turns(&part, &options)?;
        let score = turned.score(Reading::Xyzw)?;
        Some(Sums {
            cross: score.cross.transpose(),
            gyro_power: score.gyro_power,
            pose_power: score.turn_power,
            windows: turned.active,
        })
    };
    cut.into_iter()
        .filter_map(sums)
        .filter(|sums| sums.windows > 0)
        .collect()
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Windows with turns that are needed.
    pub min_windows: usize,
    /// Difference that may be one of drawing and assembly, degrees.
    pub max_off_deg: f64,
    /// Standard errors that a difference must exceed.
    pub sigmas: f64,
    /// Unexplained share of the turns up to which the fitted rotation explains them.
    pub max_residual: f64,
    /// Factor between the rotation of the gyro and of the poses up to which they are the same.
    pub max_gain: f64,
}
