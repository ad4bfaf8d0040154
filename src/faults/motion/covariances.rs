//! Covariance matrices of messages: other axes, orders and units, and the evidence of them.

use nalgebra::{DMatrix, Matrix3, Matrix6, SMatrix, SymmetricEigen};

use crate::world::content::{ContentEvidence, CovarianceAt, CovarianceEvidence};

/// Moments at which a constant matrix is repeated at most.
const SPREAD: usize = 48;

/// Row-major numbers of a matrix.
fn row_major<const N: usize, const M: usize>(matrix: &SMatrix<f64, N, N>) -> [f64; M] {
    let mut numbers = [0.0; M];
    for (number, value) in numbers.iter_mut().zip(matrix.transpose().iter()) {
        *number = *value;
    }
    numbers
}

/// A covariance of three axes in other axes.
pub(super) fn rotate(covariance: &mut [f64; 9], new_from_old: &Matrix3<f64>) {
    *covariance = row_major(&(new_from_old * Matrix3::from_row_slice(covariance) * new_from_old.transpose()));
}

/// A covariance of positions and rotations in other axes.
pub(super) fn rotate6(covariance: &mut [f64; 36], linear: &Matrix3<f64>, angular: &Matrix3<f64>) {
    let mut both = Matrix6::zeros();
    both.fixed_view_mut::<3, 3>(0, 0).copy_from(linear);
    both.fixed_view_mut::<3, 3>(3, 3).copy_from(angular);
    *covariance = row_major(&(both * Matrix6::from_row_slice(covariance) * both.transpose()));
}

/// Positions and rotations in other units: how many of the new unit are one metre, and one radian.
pub(super) fn rescale6(covariance: &mut [f64; 36], linear: f64, angular: f64) {
    rotate6(
        covariance,
        &(Matrix3::identity() * linear),
        &(Matrix3::identity() * angular),
    );
}

/// Rotations before positions.
pub(super) fn rotation_first(covariance: &mut [f64; 36]) {
    let matrix = Matrix6::from_row_slice(covariance);
    let mut swapped = Matrix6::zeros();
    for (from, to) in [(0, 3), (3, 0)] {
        for (from_column, to_column) in [(0, 3), (3, 0)] {
            let block = matrix.fixed_view::<3, 3>(from, from_column);
            swapped.fixed_view_mut::<3, 3>(to, to_column).copy_from(&block);
        }
    }
    *covariance = row_major(&swapped);
}

/// Standard deviations in place of variances: the root of each number, with its sign.
pub(super) fn deviations(covariance: &mut [f64]) {
    for value in covariance {
        *value = value.abs().sqrt().copysign(*value);
    }
}

/// Whether a field is filled in in some message.
pub(super) fn is_stated(content: &ContentEvidence, field: &str) -> bool {
    let stated = content.covariances.get(field);
    stated.is_some_and(|one| one.all_zero < one.count && one.minus_one < one.count)
}

/// Changes the matrices of `N` numbers of a field. Those that mark the field as not provided (-1) stay.
pub fn change_covariances<const N: usize>(
    content: &mut ContentEvidence,
    field: &str,
    mut change: impl FnMut(&CovarianceAt, [f64; N]) -> [f64; N],
) {
    let Some(evidence) = content.covariances.get_mut(field) else {
        return;
    };
    let worst = [&mut evidence.most_asymmetric, &mut evidence.least_positive];
    let worst = worst.into_iter().flatten().map(|(_, sample)| sample);
    for sample in evidence.samples.iter_mut().chain(worst) {
        if let Ok(values) = <[f64; N]>::try_from(sample.values.as_slice())
            && values.first() != Some(&-1.0)
        {
            sample.values = change(sample, values).to_vec();
        }
    }
    measure(evidence);
}

/// Repeats a matrix that is the same in all messages at some of the moments of a stream: with other numbers at each it would be kept at
/// each. The moments are messages, by stamp and log time in nanoseconds. Gives the one matrix.
pub(super) fn spread_constant(
    content: &mut ContentEvidence,
    field: &str,
    moments: impl ExactSizeIterator<Item = [i64; 2]>,
) -> Option<CovarianceAt> {
    let evidence = content.covariances.get_mut(field)?;
    let [only] = evidence.samples.as_slice() else {
        return None;
    };
    let only = only.clone();
    let step = moments.len().div_ceil(SPREAD).max(1);
    let spread = moments.step_by(step).map(|[stamp_ns, log_ns]| {
        let mut sample = only.clone();
        (sample.count, sample.at.log_ns) = (1, log_ns);
        sample.at.stamp_ns = sample.at.stamp_ns.map(|_| stamp_ns);
        sample
    });
    let spread: Vec<CovarianceAt> = spread.collect();
    if spread.is_empty() {
        return None;
    }
    evidence.samples = spread;
    Some(only)
}

/// Makes the matrices of [`spread_constant`] one again, where they are still the same.
pub(super) fn join_constant(content: &mut ContentEvidence, field: &str, only: CovarianceAt) {
    let Some(evidence) = content.covariances.get_mut(field) else {
        return;
    };
    let Some((first, others)) = evidence.samples.split_first() else {
        return;
    };
    if others.iter().all(|other| other.values == first.values) {
        let values = first.values.clone();
        evidence.samples = vec![CovarianceAt { values, ..only }];
    }
}

/// Measures anew how far from valid the worst of the matrices are.
fn measure(evidence: &mut CovarianceEvidence) {
    let kept = [&evidence.most_asymmetric, &evidence.least_positive];
    let kept = kept.into_iter().flatten().map(|(_, sample)| sample);
    let all = evidence.samples.iter().chain(kept);
    let measured: Vec<([f64; 2], CovarianceAt)> = all
        .filter_map(|sample| Some((validity(&sample.values)?, sample.clone())))
        .collect();
    let asymmetric = measured.iter().max_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    evidence.most_asymmetric = asymmetric.map(|([asymmetry, _], sample)| (*asymmetry, sample.clone()));
    let positive = measured.iter().min_by(|a, b| a.0[1].total_cmp(&b.0[1]));
    evidence.least_positive = positive.map(|([_, least], sample)| (*least, sample.clone()));
}

/// The asymmetry of a matrix and its smallest eigenvalue, both over its largest number; `None` where it states nothing.
fn validity(values: &[f64]) -> Option<[f64; 2]> {
    let size = match values.len() {
        9 => 3,
        36 => 6,
        _ => return None,
    };
    let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let is_finite = values.iter().all(|value| value.is_finite());
    if !is_finite || largest == 0.0 || values.first() == Some(&-1.0) {
        return None;
    }
    let matrix = DMatrix::from_row_slice(size, size, values) / largest;
    let asymmetry = (&matrix - matrix.transpose()).amax();
    let symmetric = (&matrix + matrix.transpose()) / 2.0;
    Some([asymmetry, SymmetricEigen::new(symmetric).eigenvalues.min()])
}
