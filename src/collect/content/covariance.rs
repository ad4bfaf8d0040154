//! Covariance matrices of one field: which ones there are, and how far from valid the worst are.
//!
//! Owns symmetry and eigenvalues of what is published. Must not know what the numbers are the covariance of.

use nalgebra::{SMatrix, SymmetricEigen};

use crate::world::content::{CovarianceAt, CovarianceEvidence};

use super::super::point::{Point, PointOwner};
use super::super::thin::{SampleBudget, ThinnedSeries};

/// Takes in `N`×`N` matrices, `L = N²` numbers each, row-major.
///
/// Each matrix that differs from the one before is looked at once: a constant covariance costs a comparison.
#[derive(Clone, Debug)]
pub(super) struct Covariances<const N: usize, const L: usize> {
    /// Whether a first number of -1 marks the field as not measured (`sensor_msgs/Imu`).
    may_be_absent: bool,
    bound: usize,
    count: u64,
    /// The first different ones.
    first: Vec<KeptMatrix<L>>,
    later: ThinnedSeries<KeptMatrix<L>>,
    /// The one that is being repeated, where it is not among the first.
    current: Option<KeptMatrix<L>>,
    kind: Kind,
    last: Option<[f64; L]>,
    /// The index of the last one among the first.
    place: Option<usize>,
    non_finite: (u64, Option<KeptMatrix<L>>),
    all_zero: u64,
    minus_one: u64,
    most_asymmetric: Option<(f64, KeptMatrix<L>)>,
    least_positive: Option<(f64, KeptMatrix<L>)>,
}

#[derive(Clone, Copy, Debug)]
struct KeptMatrix<const L: usize> {
    point: Point,
    count: u64,
    hash: u64,
    values: [f64; L],
}

/// The quick properties of a matrix.
#[derive(Clone, Copy, Debug, Default)]
struct Kind {
    is_finite: bool,
    is_zero: bool,
    is_absent: bool,
}

impl<const N: usize, const L: usize> Covariances<N, L> {
    pub(super) fn new(share: SampleBudget, may_be_absent: bool) -> Self {
        Self {
            may_be_absent,
            bound: share.matrices,
            count: 0,
            first: Vec::new(),
            later: ThinnedSeries::new(2 * share.matrices),
            current: None,
            kind: Kind::default(),
            last: None,
            place: None,
            non_finite: (0, None),
            all_zero: 0,
            minus_one: 0,
            most_asymmetric: None,
            least_positive: None,
        }
    }

    /// Takes in the matrix of one message.
    pub(super) fn push(&mut self, point: Point, values: &[f64; L]) {
        self.count += 1;
        if self.last.as_ref().is_none_or(|last| !same(last, values)) {
            self.last = Some(*values);
            self.change(KeptMatrix {
                point,
                count: 0,
                hash: hash(values),
                values: *values,
            });
        }
        let repeated = match self.place {
            Some(place) => self.first.get_mut(place),
            None => self.current.as_mut(),
        };
        if let Some(kept) = repeated {
            kept.count += 1;
        }
        self.non_finite.0 += u64::from(!self.kind.is_finite);
        self.all_zero += u64::from(self.kind.is_zero);
        self.minus_one += u64::from(self.kind.is_absent);
    }

    /// Another matrix than the one before.
    fn change(&mut self, kept: KeptMatrix<L>) {
        if let Some(current) = self.current.take() {
            self.later.push(current);
        }
        let known = |known: &KeptMatrix<L>| known.hash == kept.hash && same(&known.values, &kept.values);
        self.place = self.first.iter().position(known);
        let was_known = self.place.is_some();
        if !was_known && self.first.len() < self.bound {
            self.place = Some(self.first.len());
            // A vector that grows by itself has room for four at once: too much where there are thousands of topics.
            self.first.reserve_exact(1);
            self.first.push(kept);
        } else if !was_known {
            self.current = Some(kept);
        }
        self.kind = Kind {
            is_finite: kept.values.iter().all(|value| value.is_finite()),
            is_zero: kept.values.iter().all(|value| *value == 0.0),
            is_absent: kept.values.first() == Some(&-1.0),
        };
        if !was_known {
            self.look_at(kept);
        }
    }

    fn look_at(&mut self, kept: KeptMatrix<L>) {
        if !self.kind.is_finite {
            self.non_finite.1.get_or_insert(kept);
            return;
        }
        let largest = kept
            .values
            .iter()
            .fold(0.0, |largest: f64, value| largest.max(value.abs()));
        if largest == 0.0 || (self.kind.is_absent && self.may_be_absent) {
            return;
        }
        // Over its largest number, so that nothing overflows.
        let matrix = SMatrix::<f64, N, N>::from_row_slice(&kept.values) / largest;
        let asymmetry = (matrix - matrix.transpose()).amax();
        if self
            .most_asymmetric
            .as_ref()
            .is_none_or(|(known, _)| asymmetry > *known)
        {
            self.most_asymmetric = Some((asymmetry, kept));
        }
        let symmetric = matrix.symmetric_part();
        // A matrix that is positive definite after subtracting the least known eigenvalue has no smaller one.
        let can_be_less = |(known, _): &(f64, KeptMatrix<L>)| {
            (symmetric - SMatrix::<f64, N, N>::identity() * *known)
                .cholesky()
                .is_none()
        };
        if self.least_positive.as_ref().is_none_or(can_be_less) {
            let least = smallest_eigenvalue(symmetric);
            if self.least_positive.as_ref().is_none_or(|(known, _)| least < *known) {
                self.least_positive = Some((least, kept));
            }
        }
    }

    pub(super) fn finish(mut self, on: PointOwner<'_>) -> CovarianceEvidence {
        if let Some(current) = self.current.take() {
            self.later.push(current);
        }
        let at = |kept: KeptMatrix<L>| CovarianceAt {
            at: kept.point.on(on),
            count: kept.count.max(1),
            values: kept.values.to_vec(),
        };
        CovarianceEvidence {
            count: self.count,
            samples: self.first.into_iter().chain(self.later.finish()).map(at).collect(),
            non_finite: (self.non_finite.0, self.non_finite.1.map(at)),
            all_zero: self.all_zero,
            minus_one: self.minus_one,
            most_asymmetric: self.most_asymmetric.map(|(asymmetry, kept)| (asymmetry, at(kept))),
            least_positive: self.least_positive.map(|(least, kept)| (least, at(kept))),
        }
    }
}

/// The smallest eigenvalue of a symmetric matrix with finite numbers.
fn smallest_eigenvalue<const N: usize>(symmetric: SMatrix<f64, N, N>) -> f64 {
    // nalgebra wants the dimension as a type; a dynamic matrix of 6 by 6 is as good.
    let matrix = nalgebra::DMatrix::from_column_slice(N, N, symmetric.as_slice());
    SymmetricEigen::new(matrix).eigenvalues.min()
}

/// Whether two matrices are the same, bit for bit: a NaN is the same as itself.
fn same<const L: usize>(a: &[f64; L], b: &[f64; L]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// FNV-1a over words: only a filter before the comparison.
fn hash<const L: usize>(values: &[f64; L]) -> u64 {
    values.iter().fold(0xcbf2_9ce4_8422_2325, |hash, value| {
        (hash ^ value.to_bits()).wrapping_mul(0x0100_0000_01b3)
    })
}
