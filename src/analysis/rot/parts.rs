//! The parts of a matrix that states a transform: its rotation block, its translation, its bottom row, and whether it
//! was stored transposed.

use nalgebra::Matrix3;

use crate::math::rotation::orthogonality_error;
use crate::source::SourceId;
use crate::world::{Claim, Literal, World};

/// How far an entry of a bottom row may be from 0 or 1 and still be that number.
const EXACT: f64 = 1e-9;

/// A matrix further from a rotation than this is none (Frobenius norm of `R^T R - I`).
const FAR: f64 = 1e-2;
/// A matrix nearer than this is one, to a few printed digits.
const NEAR: f64 = 1e-3;

/// A matrix taken apart.
#[derive(Debug)]
pub(crate) struct Parts<'a> {
    /// The claim with this matrix.
    pub claim: &'a Claim,
    /// Columns as written.
    pub cols: usize,
    /// All numbers as written, row-major.
    pub values: &'a [f64],
    /// The rotation block, in the right orientation also for a matrix that was stored transposed.
    pub rotation: Matrix3<f64>,
    /// Whether the translation is in the bottom row.
    pub transposed: bool,
    /// Whether it is a 3x4 that is a rotation only when it is read column by column.
    pub by_columns: bool,
}

impl<'a> Parts<'a> {
    /// Takes a claim apart. `None` where it is no 3x3, 3x4 or 4x4 matrix.
    pub(crate) fn of(claim: &'a Claim) -> Option<Self> {
        let (rows, cols, values) = claim.matrix()?;
        if !matches!((rows, cols), (3, 3 | 4) | (4, 4)) || values.len() != rows * cols {
            return None;
        }
        let at = |row: usize, col: usize| values.get(row * cols + col).copied().unwrap_or(f64::NAN);
        let is_unit = |entries: [f64; 4]| {
            entries
                .iter()
                .zip([0.0, 0.0, 0.0, 1.0])
                .all(|(entry, unit)| (entry - unit).abs() <= EXACT)
        };
        let transposed = rows == 4
            && !is_unit([at(3, 0), at(3, 1), at(3, 2), at(3, 3)])
            && is_unit([at(0, 3), at(1, 3), at(2, 3), at(3, 3)]);
        let as_written = Matrix3::from_fn(|row, col| if transposed { at(col, row) } else { at(row, col) });
        let columns = Matrix3::from_fn(|row, col| values.get(col * 3 + row).copied().unwrap_or(f64::NAN));
        let by_columns = (rows, cols) == (3, 4)
            && orthogonality_error(&as_written) > FAR
            && orthogonality_error(&columns) <= NEAR
            && columns.determinant() > 0.0;
        let rotation = if by_columns { columns } else { as_written };
        Some(Self {
            claim,
            cols,
            values,
            rotation,
            transposed,
            by_columns,
        })
    }

    /// Every matrix of a world.
    pub(crate) fn all(world: &'a World) -> impl Iterator<Item = Self> {
        world.claims.iter().filter_map(Self::of)
    }

    /// The source of the matrix.
    pub(crate) fn source(&self) -> SourceId {
        self.claim.place.source
    }

    /// The name of the matrix in rows and messages.
    pub(crate) fn subject(&self, world: &World) -> String {
        format!("`{}` of {}", self.claim.label, world.path(self.source()))
    }

    /// Whether every number is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.values.iter().all(|value| value.is_finite())
    }

    /// The bottom row of a 4x4.
    pub(crate) fn bottom_row(&self) -> Option<[f64; 4]> {
        self.values.get(12..16).and_then(|row| <[f64; 4]>::try_from(row).ok())
    }

    /// Whether the bottom row is `0 0 0 1`; `None` where there is none.
    pub(crate) fn has_unit_bottom_row(&self) -> Option<bool> {
        self.bottom_row()
            .map(|[a, b, c, d]| [a, b, c, d - 1.0].iter().all(|entry| entry.abs() <= EXACT))
    }

    /// The literal of an entry as written, where the text of every entry is known.
    pub(crate) fn literal(&self, row: usize, col: usize) -> Option<&'a Literal> {
        let literals = &self.claim.rotation_literals;
        (literals.len() == self.values.len())
            .then(|| literals.get(row * self.cols + col))
            .flatten()
    }
}
