//! Claims: one source's statement of a transform, as it was spelled.

use compact_str::CompactString;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

use crate::source::{Confidence, Place, Span};

use super::conventions::{Convention, QuaternionAlgebra, QuaternionOrder};
use super::frame::FrameId;

/// A rigid transform `target_from_source` in plain numbers: metres and a unit quaternion `[x, y, z, w]` (Hamilton).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position of the source frame's origin in the target frame, metres.
    #[serde(with = "super::number::array")]
    pub translation_m: [f64; 3],
    /// Rotation of the source frame's axes into the target frame, `[x, y, z, w]`, unit norm.
    #[serde(with = "super::number::array")]
    pub rotation_xyzw: [f64; 4],
}

impl Pose {
    /// The identity.
    pub const IDENTITY: Self = Self {
        translation_m: [0.0; 3],
        rotation_xyzw: [0.0, 0.0, 0.0, 1.0],
    };

    /// A pose from raw numbers; the quaternion is normalised. `None` for non-finite numbers or a zero quaternion.
    pub fn from_raw(translation_m: [f64; 3], xyzw: [f64; 4]) -> Option<Self> {
        let norm = xyzw.iter().map(|v| v * v).sum::<f64>().sqrt();
        let finite = translation_m.iter().chain(&xyzw).all(|v| v.is_finite());
        (finite && norm > 1e-9 && norm.is_finite()).then(|| Self {
            translation_m,
            rotation_xyzw: xyzw.map(|v| v / norm),
        })
    }

    /// As nalgebra's isometry.
    pub fn isometry(&self) -> Isometry3<f64> {
        let [x, y, z, w] = self.rotation_xyzw;
        let [tx, ty, tz] = self.translation_m;
        Isometry3::from_parts(
            Translation3::new(tx, ty, tz),
            UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)),
        )
    }

    /// From nalgebra's isometry.
    pub fn from_isometry(target_from_source: &Isometry3<f64>) -> Self {
        let t = target_from_source.translation.vector;
        let q = target_from_source.rotation.coords;
        Self {
            translation_m: [t.x, t.y, t.z],
            rotation_xyzw: [q.x, q.y, q.z, q.w],
        }
    }
}

/// A number as it was spelled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Literal {
    /// The text, for example `1.57` or `-0.0`.
    pub text: CompactString,
    /// Its value; NaN if the text is not a number.
    #[serde(with = "super::number")]
    pub value: f64,
    /// Its place in the source's text.
    pub span: Span,
}

/// How the numbers of a claim were written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spelling {
    /// Translation and fixed-axis roll, pitch, yaw (`R = Rz(yaw) Ry(pitch) Rx(roll)`), radians as declared.
    Rpy {
        /// Metres.
        #[serde(with = "super::number::array")]
        xyz: [f64; 3],
        /// Radians, as the format declares them.
        #[serde(with = "super::number::array")]
        rpy: [f64; 3],
    },
    /// Translation and quaternion.
    Quaternion {
        /// Metres.
        #[serde(with = "super::number::array")]
        xyz: [f64; 3],
        /// As read: `[x, y, z, w]`, not normalised.
        #[serde(with = "super::number::array")]
        xyzw: [f64; 4],
        /// Whether keys or the format fix the order; false for a bare list of four.
        order_known: bool,
    },
    /// A matrix, row-major as written. 3x3 (rotation), 3x4 or 4x4 (homogeneous).
    Matrix {
        /// Rows.
        rows: usize,
        /// Columns.
        cols: usize,
        /// `rows * cols` numbers in the order of the file.
        #[serde(with = "super::number::list")]
        values: Vec<f64>,
    },
    /// A bare translation.
    Translation {
        /// Metres.
        #[serde(with = "super::number::array")]
        xyz: [f64; 3],
    },
}

/// Where a claim comes from.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimKind {
    /// The origin of a URDF joint.
    Joint {
        /// Name of the joint.
        joint: String,
        /// Whether the joint is `fixed`; other joints state the transform at their zero position.
        fixed: bool,
        /// Whether the joint has an `<origin>` element at all.
        has_origin: bool,
    },
    /// A calibration or configuration file.
    File {
        /// The dialect it was read as (`generic`, `autoware`, ...).
        dialect: String,
        /// Whether its frames are the dialect's words for sensors (`lidar`, `imu`), not names of the platform's frames.
        #[serde(default)]
        roles: bool,
    },
}

/// What a dialect leaves open, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Doubt {
    /// The direction.
    Direction(String),
    /// The algebra of a quaternion.
    Algebra(String),
}

/// One source's statement of a transform between two frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// `(target, source)` of `target_from_source`; for TF words: `(parent, child)`. `None` if the file does not state them.
    pub frames: Option<(FrameId, FrameId)>,
    /// The name of the statement in its source: the joint's name, or the path of keys (`cam0/T_cam_imu`).
    pub label: String,
    /// The transform, if the numbers are one. Rotation-only claims have zero translation, and vice versa:
    /// see `has_translation` and `has_rotation`.
    pub pose: Option<Pose>,
    /// Whether a rotation was stated.
    pub has_rotation: bool,
    /// Whether a translation was stated.
    pub has_translation: bool,
    /// The numbers as written.
    pub spelling: Spelling,
    /// Literals of the translation (up to three), in order; empty if there is no text.
    pub translation_literals: Vec<Literal>,
    /// Literals of the rotation, or of the whole matrix; empty if there is no text.
    pub rotation_literals: Vec<Literal>,
    /// The kind of source that states it.
    pub kind: ClaimKind,
    /// How sure the reading of frames and direction is.
    pub reading: Confidence,
    /// What is in doubt, if its dialect is ambiguous and the user does not declare it.
    #[serde(default)]
    pub doubt: Option<Doubt>,
    /// The place of the statement.
    pub place: Place,
    /// Where the target (parent) frame is named, if it is.
    pub target_place: Option<Place>,
    /// Where the source (child) frame is named, if it is.
    pub source_place: Option<Place>,
}

impl Claim {
    /// The target (parent) frame.
    pub fn target(&self) -> Option<&FrameId> {
        self.frames.as_ref().map(|(target, _)| target)
    }

    /// The source (child) frame.
    pub fn source_frame(&self) -> Option<&FrameId> {
        self.frames.as_ref().map(|(_, source)| source)
    }

    /// Whether a launch file or a script publishes it.
    pub fn is_published(&self) -> bool {
        matches!(&self.kind, ClaimKind::File { dialect, .. } if dialect == super::launch::PROGRAM)
    }

    /// Whether it is a row of a table of sensors, for one of perhaps many cars: nuScenes' `calibrated_sensor.json`.
    pub fn is_row(&self) -> bool {
        matches!(&self.kind, ClaimKind::File { dialect, .. } if dialect == "nuscenes")
    }

    /// Whether only a key of no known program states which of its frames is the target: it may mean the other direction.
    pub fn is_of_a_key(&self) -> bool {
        let is_generic = matches!(&self.kind, ClaimKind::File { dialect, .. } if dialect == "generic");
        is_generic && self.reading < Confidence::Certain
    }

    /// Whether the claim is valid at all times: not the zero position of a moving joint.
    pub fn is_rigid(&self) -> bool {
        !matches!(self.kind, ClaimKind::Joint { fixed: false, .. })
    }

    /// A short name for messages: `` `parent` from `child` `` or the label.
    pub fn name(&self) -> String {
        match &self.frames {
            Some((target, source)) => format!("`{target}` from `{source}`"),
            None => format!("`{}`", self.label),
        }
    }

    /// Sets the frames and direction to those that the user declares.
    pub(super) fn declare_frames(&mut self, target: &FrameId, source: &FrameId) {
        self.frames = Some((target.clone(), source.clone()));
        self.reading = Confidence::Certain;
        if matches!(self.doubt, Some(Doubt::Direction(_))) {
            self.doubt = None;
        }
        if let ClaimKind::File { roles, .. } = &mut self.kind {
            *roles = false;
        }
    }

    /// Replaces names by the platform's names that the user declares for them. Returns whether both are known.
    pub(super) fn rename(&mut self, platform_name: impl Fn(&FrameId) -> Option<FrameId>) -> bool {
        let Some((target, source)) = &mut self.frames else {
            return false;
        };
        let new = (platform_name(target), platform_name(source));
        let is_known = new.0.is_some() && new.1.is_some();
        if let Some(name) = new.0 {
            *target = name;
        }
        if let Some(name) = new.1 {
            *source = name;
        }
        if let (true, ClaimKind::File { roles, .. }) = (is_known, &mut self.kind) {
            *roles = false;
        }
        is_known
    }

    /// Applies a declared convention to a quaternion. An order that keys or the format fix stays.
    pub(super) fn declare(&mut self, convention: Convention) {
        let Spelling::Quaternion { xyz, xyzw, order_known } = &mut self.spelling else {
            return;
        };
        if let (Some(order), false) = (convention.order, *order_known) {
            if order == QuaternionOrder::Wxyz {
                xyzw.rotate_left(1);
            }
            *order_known = true;
        }
        if convention.algebra == Some(QuaternionAlgebra::Jpl) {
            let [x, y, z, _] = xyzw;
            (*x, *y, *z) = (-*x, -*y, -*z);
        }
        self.pose = Pose::from_raw(*xyz, *xyzw);
    }

    /// The bottom row of a homogeneous matrix, if the claim was spelled as one.
    pub fn matrix(&self) -> Option<(usize, usize, &[f64])> {
        match &self.spelling {
            Spelling::Matrix { rows, cols, values } => Some((*rows, *cols, values)),
            _ => None,
        }
    }
}
