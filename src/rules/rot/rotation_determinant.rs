//! ROT01: a rotation matrix that mirrors (determinant -1).

use nalgebra::Rotation3;

use crate::advice::tally::Tally;
use crate::analysis::{pairs::Pairs, rot::parts::Parts};
use crate::math::rotation::{Diagnosis, Flip, allowed_orthogonality_error, det, diagnose};
use crate::rules::prelude::*;
use crate::world::World;

pub(crate) struct RotationDeterminant;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Largest `|det - 1|` of a rotation.
    pub proper: f64,
    /// Largest `|det + 1|` that is called a reflection.
    pub reflection: f64,
}

impl Rule for RotationDeterminant {
    const NEEDS: &'static [Need] = &[Need::Matrices];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let pairs = Pairs::new(world);
        let mut right = Tally::new("matrices");
        for parts in Parts::all(world) {
            let determinant = det(&parts.rotation);
            let measured = Measured::new("determinant of the rotation minus 1", determinant - 1.0, "1");
            if !parts.is_finite() {
                out.not_evaluated(
                    parts.subject(world),
                    NotEvaluated::InputBroken,
                    "an entry is not finite",
                );
            } else if (determinant - 1.0).abs() <= limits.proper {
                right.pass(parts.source(), measured.limit(limits.proper));
            } else if (determinant + 1.0).abs() <= limits.reflection {
                out.fail(reflection(world, &parts, determinant, &pairs));
            } else {
                out.not_evaluated(
                    parts.subject(world),
                    NotEvaluated::InputBroken,
                    format!("the determinant {determinant:.4} is neither near 1 nor near -1: it is no rotation matrix"),
                );
            }
        }
        right.report(world, out);
    }
}

fn reflection(world: &World, parts: &Parts, determinant: f64, pairs: &Pairs) -> Finding {
    let reference = parts.claim.frames.as_ref().and_then(|(target, source)| {
        pairs
            .others(target, source, parts.source())
            .into_iter()
            .find(|other| other.has_rotation)
    });
    let against = reference
        .as_ref()
        .map_or_else(Rotation3::identity, |other| other.pose.rotation.to_rotation_matrix());
    let allowed = allowed_orthogonality_error(&parts.rotation);
    let flip = match diagnose(&parts.rotation, allowed, &against) {
        Diagnosis::Reflection { flip, .. } => Some(flip),
        _ => None,
    };
    let explanation = match (flip, &reference) {
        (None, _) => String::new(),
        (Some(flip), None) => format!("The simplest explanation: {}.", flip.describe()),
        (Some(flip), Some(other)) => {
            format!("Compared with {}: {}.", world.path(other.source), flip.describe())
        }
    };
    let message = format!(
        "matrix `{}` is mirrored: its determinant is {determinant:.4}, not 1",
        parts.claim.label
    );
    let mut finding = Finding::error(parts.subject(world), message, parts.claim.place.clone())
        .label("left-handed axes")
        .detail(explanation)
        .help(
            "correct the sign or the order of the axes where the matrix is computed; do not replace it by the nearest rotation, which hides the error",
        )
        .measured(Measured::new("determinant", determinant, "1").expected(1.0));
    if let Some(flip) = flip {
        finding = finding.relation(word(flip));
    }
    match reference {
        Some(other) => finding.related(other.place, "the same pair of frames, as a rotation"),
        None => finding,
    }
}

/// The word of the relation for an error that mirrors.
fn word(flip: Flip) -> &'static str {
    match flip {
        Flip::ColumnX | Flip::RowX => "mirrored-x",
        Flip::ColumnY | Flip::RowY => "mirrored-y",
        Flip::ColumnZ | Flip::RowZ => "mirrored-z",
        Flip::SwapXY => "swapped-xy",
        Flip::SwapYZ => "swapped-yz",
        Flip::SwapZX => "swapped-zx",
    }
}
