//! The constant rotations of the field: `P` (NED/ENU), `F` (FLU/FRD), `O` (optical), `Z` (180 deg about z), and the plain quarter and half turns.
//!
//! Owns their exact matrices, quaternions and names. Must not know which frame uses which: that is in tables.
//! All are proper rotations; their matrices hold only 0, 1 and -1, exactly.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion};

/// A constant rotation between two common axis conventions.
///
/// Read each as `new_from_old` or `old_from_new`: except for the quarter turns and [`AxisTurn::Optical`] with
/// [`AxisTurn::OpticalInverse`], each is its own inverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AxisTurn {
    /// `Z`: half a turn about z, diag(-1, -1, 1). The two frames of an Ouster lidar differ by it (and a height).
    Z180,
    /// A quarter turn about z: x goes to y.
    Z90,
    /// A quarter turn about z the other way: y goes to x.
    ZMinus90,
    /// `F`: forward-left-up to forward-right-down and back, diag(1, -1, -1) = half a turn about x.
    FluFrd,
    /// `P`: east-north-up to north-east-down and back: x and y change places, z changes sign. It is half a turn about
    /// (1, 1, 0)/sqrt 2 = RPY(pi, 0, pi/2) (mavros `ftf_frame_conversions.cpp`), and not a turn about east.
    NedEnu,
    /// `O` = `link_from_optical`: optical axes (x right, y down, z forward) to body axes (x forward, y left, z up),
    /// RPY(-pi/2, 0, -pi/2) (REP-103; realsense-ros `tfs.cpp`): 120 degrees about (-1, 1, -1)/sqrt 3.
    Optical,
    /// `O` transposed = `optical_from_link`.
    OpticalInverse,
    /// Half a turn about y, diag(-1, 1, -1).
    Y180,
    /// A quarter turn about x: y goes to z.
    X90,
    /// A quarter turn about x the other way: z goes to y.
    XMinus90,
    /// A quarter turn about y: z goes to x.
    Y90,
    /// A quarter turn about y the other way: x goes to z.
    YMinus90,
}

impl AxisTurn {
    /// Every turn, each once.
    pub fn all() -> &'static [AxisTurn] {
        &[
            AxisTurn::Z180,
            AxisTurn::Z90,
            AxisTurn::ZMinus90,
            AxisTurn::FluFrd,
            AxisTurn::NedEnu,
            AxisTurn::Optical,
            AxisTurn::OpticalInverse,
            AxisTurn::Y180,
            AxisTurn::X90,
            AxisTurn::XMinus90,
            AxisTurn::Y90,
            AxisTurn::YMinus90,
        ]
    }

    /// The stable word of this turn, as used in reports.
    pub fn word(self) -> &'static str {
        match self {
            AxisTurn::Z180 => "z180",
            AxisTurn::Z90 => "z90",
            AxisTurn::ZMinus90 => "z-90",
            AxisTurn::FluFrd => "flu-frd",
            AxisTurn::NedEnu => "ned-enu",
            AxisTurn::Optical => "optical",
            AxisTurn::OpticalInverse => "optical-inverse",
            AxisTurn::Y180 => "y180",
            AxisTurn::X90 => "x90",
            AxisTurn::XMinus90 => "x-90",
            AxisTurn::Y90 => "y90",
            AxisTurn::YMinus90 => "y-90",
        }
    }

    /// The turn as a rotation matrix: entries exactly 0, 1 or -1. Dimensionless.
    pub fn rotation(self) -> Rotation3<f64> {
        let m = match self {
            AxisTurn::Z180 => [[-1, 0, 0], [0, -1, 0], [0, 0, 1]],
            AxisTurn::Z90 => [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
            AxisTurn::ZMinus90 => [[0, 1, 0], [-1, 0, 0], [0, 0, 1]],
            AxisTurn::FluFrd => [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
            AxisTurn::NedEnu => [[0, 1, 0], [1, 0, 0], [0, 0, -1]],
            AxisTurn::Optical => [[0, 0, 1], [-1, 0, 0], [0, -1, 0]],
            AxisTurn::OpticalInverse => [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
            AxisTurn::Y180 => [[-1, 0, 0], [0, 1, 0], [0, 0, -1]],
            AxisTurn::X90 => [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
            AxisTurn::XMinus90 => [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
            AxisTurn::Y90 => [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
            AxisTurn::YMinus90 => [[0, 0, -1], [0, 1, 0], [1, 0, 0]],
        };
        let [[a, b, c], [d, e, f], [g, h, i]] = m.map(|row| row.map(f64::from));
        Rotation3::from_matrix_unchecked(Matrix3::new(a, b, c, d, e, f, g, h, i))
    }

    /// The turn as a unit quaternion; components are 0, 1, +-1/2 or +-1/sqrt 2, correctly rounded. Dimensionless.
    pub fn quaternion(self) -> UnitQuaternion<f64> {
        let s = FRAC_1_SQRT_2;
        let [x, y, z, w] = match self {
            AxisTurn::Z180 => [0.0, 0.0, 1.0, 0.0],
            AxisTurn::Z90 => [0.0, 0.0, s, s],
            AxisTurn::ZMinus90 => [0.0, 0.0, -s, s],
            AxisTurn::FluFrd => [1.0, 0.0, 0.0, 0.0],
            AxisTurn::NedEnu => [s, s, 0.0, 0.0],
            AxisTurn::Optical => [-0.5, 0.5, -0.5, 0.5],
            AxisTurn::OpticalInverse => [0.5, -0.5, 0.5, 0.5],
            AxisTurn::Y180 => [0.0, 1.0, 0.0, 0.0],
            AxisTurn::X90 => [s, 0.0, 0.0, s],
            AxisTurn::XMinus90 => [-s, 0.0, 0.0, s],
            AxisTurn::Y90 => [0.0, s, 0.0, s],
            AxisTurn::YMinus90 => [0.0, -s, 0.0, s],
        };
        UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
    }
}

/// `P`: both `enu_from_ned` and `ned_from_enu`. See [`AxisTurn::NedEnu`].
pub fn ned_enu() -> Rotation3<f64> {
    AxisTurn::NedEnu.rotation()
}

/// `F`: both `flu_from_frd` and `frd_from_flu`. See [`AxisTurn::FluFrd`].
pub fn flu_frd() -> Rotation3<f64> {
    AxisTurn::FluFrd.rotation()
}

/// `O`: `link_from_optical`. See [`AxisTurn::Optical`].
pub fn optical() -> Rotation3<f64> {
    AxisTurn::Optical.rotation()
}

/// `O` transposed: `optical_from_link`. See [`AxisTurn::OpticalInverse`].
pub fn optical_inverse() -> Rotation3<f64> {
    AxisTurn::OpticalInverse.rotation()
}

/// `Z`: half a turn about z. See [`AxisTurn::Z180`].
pub fn z180() -> Rotation3<f64> {
    AxisTurn::Z180.rotation()
}
