//! ROT03: a 4x4 matrix whose bottom row is not 0 0 0 1.

use nalgebra::Matrix3;

use crate::advice::literal::{rewrite, with_fix};
use crate::advice::tally::Tally;
use crate::analysis::rot::parts::Parts;
use crate::math::rotation::orthogonality_error;
use crate::rules::prelude::*;
use crate::verdict::{Edit, Safety};
use crate::world::World;

pub(crate) struct HomogeneousLayout;

impl Rule for HomogeneousLayout {
    const NEEDS: &'static [Need] = &[Need::Matrices];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut right = Tally::new("4x4 matrices");
        for parts in Parts::all(world) {
            if parts.by_columns {
                out.fail(by_columns(world, &parts));
                continue;
            }
            let Some(row) = parts.bottom_row() else {
                out.not_applicable(parts.subject(world), "not a 4x4 matrix, so it has no bottom row");
                continue;
            };
            let measured = deviation(row);
            if parts.has_unit_bottom_row() == Some(true) {
                right.pass(parts.source(), measured);
            } else if parts.transposed {
                out.fail(transposed(world, &parts, measured));
            } else {
                out.fail(wrong_row(world, &parts, row, measured));
            }
        }
        right.report(world, out);
    }
}

fn deviation([a, b, c, d]: [f64; 4]) -> Measured {
    let worst = [a, b, c, d - 1.0].iter().fold(0.0_f64, |worst, entry| {
        if entry.is_nan() {
            f64::NAN
        } else {
            worst.max(entry.abs())
        }
    });
    Measured::new("largest deviation of the bottom row", worst, "1").limit(1e-9)
}

fn transposed(world: &World, parts: &Parts, measured: Measured) -> Finding {
    let message = format!(
        "matrix `{}` is stored transposed: the translation is in its bottom row",
        parts.claim.label
    );
    let finding = Finding::error(parts.subject(world), message, parts.claim.place.clone())
        .label("translation in the bottom row")
        .help(
            "write the matrix row by row with the translation in the last column: readers of this file get the inverse \
               rotation and no translation",
        )
        .measured(measured)
        .relation("transposed");
    with_fix(
        finding,
        "transpose the matrix",
        Safety::Safe,
        transposing_edits(world, parts),
    )
}

/// A 3x4 matrix whose twelve numbers are a rotation and a translation column by column.
fn by_columns(world: &World, parts: &Parts) -> Finding {
    let message = format!(
        "3x4 matrix `{}` is stored column by column: row by row it holds no rotation",
        parts.claim.label
    );
    let error = orthogonality_error(&Matrix3::from_fn(|row, col| {
        parts.values.get(row * 4 + col).copied().unwrap_or(f64::NAN)
    }));
    let finding = Finding::error(parts.subject(world), message, parts.claim.place.clone())
        .likely()
        .label("column-major")
        .help("write the matrix row by row, as KITTI, OpenCV and NumPy read it; Eigen's data() and OpenGL give columns")
        .measured(Measured::new(
            "orthogonality error row by row (Frobenius norm of R^T R - I)",
            error,
            "1",
        ))
        .relation("transposed");
    let edits = || {
        let mut edits = Vec::new();
        for row in 0..3 {
            for col in 0..4 {
                let from = col * 3 + row;
                let (here, there) = (parts.literal(row, col)?, parts.literal(from / 4, from % 4)?);
                if here.text != there.text {
                    edits.push(rewrite(world, parts.source(), here, there.text.clone())?);
                }
            }
        }
        Some(edits)
    };
    with_fix(
        finding,
        "write the matrix row by row",
        Safety::ChangesBehaviour,
        edits(),
    )
}

/// Every literal takes the text of its transposed entry.
fn transposing_edits(world: &World, parts: &Parts) -> Option<Vec<Edit>> {
    let mut edits = Vec::new();
    for row in 0..4 {
        for col in (0..4).filter(|col| *col != row) {
            let (here, there) = (parts.literal(row, col)?, parts.literal(col, row)?);
            if here.text != there.text {
                edits.push(rewrite(world, parts.source(), here, there.text.clone())?);
            }
        }
    }
    Some(edits)
}

fn wrong_row(world: &World, parts: &Parts, [a, b, c, d]: [f64; 4], measured: Measured) -> Finding {
    let message = format!(
        "the bottom row of matrix `{}` is {a} {b} {c} {d}, not 0 0 0 1",
        parts.claim.label
    );
    let is_zero = [a, b, c, d].iter().all(|entry| *entry == 0.0);
    let (from, label) = if is_zero { (3, "must be 1") } else { (0, "bottom row") };
    let place = parts.literal(3, from).zip(parts.literal(3, 3)).map_or_else(
        || parts.claim.place.clone(),
        |(first, last)| crate::source::Place::text(parts.source(), first.span.cover(last.span)),
    );
    let finding = if is_zero {
        // SLICT and SVO-Pro ship such matrices: their readers use the upper three rows only.
        Finding::note(parts.subject(world), message, place).help(
            "write 1 as the last number of the row: a program that multiplies by the whole matrix gets only zeros there",
        )
    } else {
        Finding::error(parts.subject(world), message, place)
            .help("write 0 0 0 1 as the bottom row, or look for a lost number or another layout")
    };
    finding.label(label).measured(measured)
}
