//! A lidar's points in the image of a camera: where they project with its mounting transform, and with likely wrong ones.
//!
//! Owns the geometry of a view over the ground that a lidar sees, and the mountings that are tried. Must not judge.

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::analysis::ground::{Ground, sensor_in_cloud};
use crate::analysis::lidar::Clouds;
use crate::math::{constants::AxisTurn, lens::Lens};
use crate::world::{World, camera::CameraModel};

/// Clouds of which points are projected.
const CLOUDS: usize = 10;
/// Points of each that are.
const POINTS: usize = 300;
/// Level views that are tried, evenly in yaw.
const VIEWS: u32 = 24;

/// The image that points are projected into.
pub(crate) struct Image {
    lens: Lens,
    /// Left, top, right, bottom, pixels.
    edges: [f64; 4],
}

impl Image {
    /// The raw image of a calibration, of which a region may be read out. `None` where its model or its size cannot be used.
    pub(crate) fn of(calibration: &CameraModel) -> Option<Self> {
        let lens = Lens::new(&calibration.k, &calibration.model, &calibration.d)?;
        let [width, height] = calibration.size.map(f64::from);
        let [left, top, roi_width, roi_height] = calibration.roi.map(f64::from);
        let edges = if roi_width > 0.0 && roi_height > 0.0 {
            [left, top, left + roi_width, top + roi_height]
        } else {
            [0.0, 0.0, width, height]
        };
        (width > 0.0 && height > 0.0).then_some(Self { lens, edges })
    }

    fn has(&self, point: &Vector3<f64>) -> bool {
        let [left, top, right, bottom] = self.edges;
        self.lens
            .project(point)
            .is_some_and(|[u, v]| (left..right).contains(&u) && (top..bottom).contains(&v))
    }
}

/// What a lidar sees around a platform, in the axes that mountings are expressed in: the base, or the lidar itself.
pub(crate) struct Scene {
    points: Vec<Vector3<f64>>,
    /// The normal of the ground, upwards.
    pub(crate) up: Vector3<f64>,
    /// The ground is where `up * p + height_m` is zero.
    height_m: f64,
    /// Clouds that show the ground.
    pub(crate) clouds: usize,
}

impl Scene {
    /// That of clouds by their grounds on one side, between two ranges, metres.
    pub(crate) fn new(
        world: &World,
        clouds: &Clouds,
        base_from_lidar: &Isometry3<f64>,
        grounds: &[&Ground],
        [near_m, far_m]: [f64; 2],
    ) -> Option<Self> {
        let at = sensor_in_cloud(world, clouds).unwrap_or_else(Vector3::zeros);
        let sum: Vector3<f64> = grounds.iter().map(|ground| ground.plane.normal).sum();
        let normal = sum.try_normalize(1e-6)?;
        let sensor_m = grounds.iter().map(|ground| ground.plane.height_m).sum::<f64>() / grounds.len() as f64;
        let up = base_from_lidar.rotation * normal;
        let sensor = base_from_lidar.rotation * at + base_from_lidar.translation.vector;
        let samples = &clouds.evidence.samples;
        let step = samples.len().div_ceil(CLOUDS).max(1);
        let mut points = Vec::new();
        for sample in samples.iter().step_by(step) {
            let in_reach = |point: &Vector3<f64>| (near_m..=far_m).contains(&(point - at).norm());
            let all: Vec<Vector3<f64>> = sample
                .points
                .iter()
                .map(|point| Vector3::from(point.xyz))
                .filter(in_reach)
                .collect();
            let step = all.len().div_ceil(POINTS).max(1);
            let thinned = all.iter().step_by(step);
            points.extend(thinned.map(|point| base_from_lidar.rotation * point + base_from_lidar.translation.vector));
        }
        Some(Self {
            points,
            up,
            height_m: sensor_m - up.dot(&sensor),
            clouds: grounds.len(),
        })
    }

    /// Points that are projected.
    pub(crate) fn points(&self) -> usize {
        self.points.len()
    }

    /// Share of the points that a mounting `base_from_camera` puts into the image.
    pub(crate) fn share(&self, image: &Image, base_from_camera: &Isometry3<f64>) -> f64 {
        let camera_from_base = base_from_camera.inverse();
        let seen = self
            .points
            .iter()
            .filter(|point| image.has(&(camera_from_base.rotation * **point + camera_from_base.translation.vector)));
        seen.count() as f64 / self.points.len().max(1) as f64
    }

    /// The largest share of a camera at this position that looks level, over all yaws.
    pub(crate) fn most(&self, image: &Image, base_from_camera: &Isometry3<f64>) -> f64 {
        let Some(aside) = [Vector3::x(), Vector3::y()]
            .into_iter()
            .find_map(|axis| self.up.cross(&axis).try_normalize(0.5))
        else {
            return 0.0;
        };
        let level = Matrix3::from_columns(&[aside, -self.up, aside.cross(&-self.up)]);
        let level = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(level));
        let shares = (0..VIEWS).map(|view| {
            let yaw = std::f64::consts::TAU * f64::from(view) / f64::from(VIEWS);
            let turn = UnitQuaternion::from_scaled_axis(self.up * yaw);
            let looks = Isometry3::from_parts(base_from_camera.translation, turn * level);
            self.share(image, &looks)
        });
        shares.fold(0.0, f64::max)
    }

    /// The attitude of a camera over the ground.
    pub(crate) fn attitude(&self, base_from_camera: &Isometry3<f64>) -> Attitude {
        let up = base_from_camera.rotation.inverse() * self.up;
        Attitude {
            pitch_deg: up.z.clamp(-1.0, 1.0).asin().to_degrees(),
            roll_deg: up.x.atan2(-up.y).to_degrees(),
            height_m: self.up.dot(&base_from_camera.translation.vector) + self.height_m,
        }
    }
}

/// The attitude and height of a camera over the ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attitude {
    /// Over the horizon.
    pub(crate) pitch_deg: f64,
    /// How far the image's up is rotated to its right; 180 is upside down.
    pub(crate) roll_deg: f64,
    /// Of the camera, over the ground.
    pub(crate) height_m: f64,
}

/// An error of a mounting transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mistake {
    NotTurned,
    Inverse,
    Transposed,
    TurnedTwice,
    Reversed,
}

impl Mistake {
    pub(crate) const ALL: [Self; 5] = [
        Self::NotTurned,
        Self::Inverse,
        Self::Transposed,
        Self::TurnedTwice,
        Self::Reversed,
    ];

    /// The right mounting, if this error was made.
    pub(crate) fn corrected(self, stated: &Isometry3<f64>) -> Isometry3<f64> {
        let turned = |by: UnitQuaternion<f64>| Isometry3::from_parts(stated.translation, stated.rotation * by);
        match self {
            Self::NotTurned => turned(AxisTurn::Optical.quaternion()),
            Self::Inverse => stated.inverse(),
            Self::Transposed => Isometry3::from_parts(stated.translation, stated.rotation.inverse()),
            Self::TurnedTwice => turned(AxisTurn::OpticalInverse.quaternion()),
            Self::Reversed => turned(AxisTurn::Y180.quaternion()),
        }
    }

    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::NotTurned => "optical",
            Self::Inverse => "inverse",
            Self::Transposed => "transposed",
            Self::TurnedTwice => "optical-inverse",
            Self::Reversed => "reversed",
        }
    }

    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::NotTurned => "the rotation to optical axes is missing",
            Self::Inverse => "the transform is inverted",
            Self::Transposed => "the rotation is transposed",
            Self::TurnedTwice => "the rotation to optical axes is applied twice",
            Self::Reversed => "the optical axis points backward",
        }
    }

    pub(crate) fn help(self) -> &'static str {
        match self {
            Self::NotTurned => {
                "multiply the rotation of the transform by RPY(-pi/2, 0, -pi/2) from the right; or keep the transform for a body frame, and publish the optical frame as the child of that frame with this RPY (z forward, x right, y down: REP-103)"
            }
            Self::Inverse => {
                "publish the inverse: TF holds the pose of the child in the parent, calibration files often hold the inverse"
            }
            Self::Transposed => {
                "transpose the rotation: row-major and column-major were exchanged, or a JPL quaternion was read as Hamilton"
            }
            Self::TurnedTwice => "remove one of the two rotations RPY(-pi/2, 0, -pi/2) from the chain",
            Self::Reversed => {
                "rotate the optical frame by 180 deg about y of the optical frame: z is the direction of view"
            }
        }
    }
}
