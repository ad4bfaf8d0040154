//! Covariances of the rows, and what goes wrong with them.

use nalgebra::{Matrix3, Matrix6, Rotation3, SMatrix, Vector3};

use super::errors::Error;

/// Row-major numbers of a matrix.
pub fn row_major<const N: usize, const M: usize>(matrix: &SMatrix<f64, N, N>) -> [f64; M] {
    let mut numbers = [0.0; M];
    for (number, value) in numbers.iter_mut().zip(matrix.transpose().iter()) {
        *number = *value;
    }
    numbers
}

/// Independent errors of the three axes, from their deviations.
pub fn diagonal(deviations: Vector3<f64>) -> [f64; 9] {
    row_major(&Matrix3::from_diagonal(&deviations.component_mul(&deviations)))
}

/// Independent errors of positions and rotations, from their deviations.
pub fn diagonal6(linear: Vector3<f64>, angular: Vector3<f64>) -> [f64; 36] {
    let mut matrix = Matrix6::zeros();
    for axis in 0..3 {
        matrix[(axis, axis)] = linear[axis].powi(2);
        matrix[(axis + 3, axis + 3)] = angular[axis].powi(2);
    }
    row_major(&matrix)
}

/// A covariance of three axes in other axes.
pub fn rotate(covariance: &mut [f64; 9], new_from_old: &Rotation3<f64>) {
    let turned = new_from_old.matrix() * Matrix3::from_row_slice(covariance) * new_from_old.matrix().transpose();
    *covariance = row_major(&turned);
}

/// A covariance of positions and rotations in other axes; the rotations may be left where they are.
pub fn rotate6(covariance: &mut [f64; 36], linear: &Rotation3<f64>, angular: &Rotation3<f64>) {
    let mut both = Matrix6::zeros();
    both.fixed_view_mut::<3, 3>(0, 0).copy_from(linear.matrix());
    both.fixed_view_mut::<3, 3>(3, 3).copy_from(angular.matrix());
    *covariance = row_major(&(both * Matrix6::from_row_slice(covariance) * both.transpose()));
}

/// Applies an error of a 3x3 covariance; false where it is none.
pub fn apply(covariance: &mut [f64; 9], error: Error) -> bool {
    match error {
        Error::CovarianceStd => covariance.iter_mut().for_each(root),
        Error::CovarianceUpFirst => covariance.reverse(),
        Error::CovarianceCentimetres => *covariance = covariance.map(|value| value * 1e4),
        _ => return false,
    }
    true
}

/// Applies an error of a 6x6 covariance; false where it is none.
pub fn apply6(covariance: &mut [f64; 36], error: Error) -> bool {
    let matrix = Matrix6::from_row_slice(covariance);
    match error {
        Error::CovarianceStd => covariance.iter_mut().for_each(root),
        Error::CovarianceRotationFirst => {
            let swapped = Matrix6::from_fn(|row, column| matrix[((row + 3) % 6, (column + 3) % 6)]);
            *covariance = row_major(&swapped);
        }
        Error::CovarianceDegrees | Error::CovarianceCentimetres | Error::CovarianceMillimetres => {
            let units = match error {
                Error::CovarianceDegrees => [1.0, 1.0_f64.to_degrees()],
                Error::CovarianceCentimetres => [100.0, 1.0],
                _ => [1000.0, 1.0],
            };
            let unit = |axis: usize| units[axis / 3];
            let scaled = Matrix6::from_fn(|row, column| matrix[(row, column)] * unit(row) * unit(column));
            *covariance = row_major(&scaled);
        }
        _ => return false,
    }
    true
}

fn root(value: &mut f64) {
    *value = value.abs().sqrt().copysign(*value);
}
