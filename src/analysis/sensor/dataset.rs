//! Rotations that a dataset has by convention.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::Deserialize;

use crate::tables::Axes;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) max_off_deg: f64,
    pub(crate) max_up_deg: f64,
    pub(crate) min_force_m_s2: f64,
    pub(crate) max_force_m_s2: f64,
}

/// The axes as a rotation: columns are x, y and z in forward, left, up.
pub(crate) fn rotation(axes: &Axes) -> UnitQuaternion<f64> {
    let columns = axes.vectors.map(Vector3::from);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Matrix3::from_columns(&columns)))
}
