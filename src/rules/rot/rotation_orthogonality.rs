//! ROT02: a rotation matrix whose axes are not perpendicular or not of unit length.

use nalgebra::Rotation3;

use crate::advice::tally::Tally;
use crate::analysis::rot::parts::Parts;
use crate::math::rotation::{Diagnosis, allowed_orthogonality_error, diagnose, nearest_rotation, orthogonality_error};
use crate::rules::prelude::*;
use crate::verdict::Safety;
use crate::world::World;

pub(crate) struct RotationOrthogonality;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Error that no rounding excuses, as the Frobenius norm of `R^T R - I`.
    pub error: f64,
    /// The most that few printed digits may excuse.
    pub excused: f64,
    /// A fix is offered where it moves no axis by more than this, degrees.
    pub fix_deg: f64,
}

impl Rule for RotationOrthogonality {
    const NEEDS: &'static [Need] = &[Need::Matrices];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut right = Tally::new("matrices");
        for parts in Parts::all(world) {
            if !parts.is_finite() {
                out.not_evaluated(
                    parts.subject(world),
                    NotEvaluated::InputBroken,
                    "an entry is not finite",
                );
                continue;
            }
            let allowed = allowed_orthogonality_error(&parts.rotation).min(limits.excused);
            let error = orthogonality_error(&parts.rotation);
            if error <= allowed {
                right.pass(parts.source(), measured(error, allowed));
            } else {
                out.fail(finding(world, &parts, error, allowed, limits));
            }
        }
        right.report(world, out);
    }
}

fn measured(error: f64, allowed: f64) -> Measured {
    Measured::new("orthogonality error (Frobenius norm of R^T R - I)", error, "1").limit(allowed)
}

fn finding(world: &World, parts: &Parts, error: f64, allowed: f64, limits: &Limits) -> Finding {
    let severity = if error > limits.error {
        Severity::Error
    } else {
        Severity::Warning
    };
    let scale = match diagnose(&parts.rotation, allowed, &Rotation3::identity()) {
        Diagnosis::Scaled { factor } => Some(factor),
        _ => None,
    };
    let label = &parts.claim.label;
    let is_singular = scale.is_none() && parts.rotation.determinant().abs() < 0.5;
    let (message, detail) = match scale {
        Some(factor) => (
            format!("matrix `{label}` is not a pure rotation: it scales by {factor:.6}"),
            "All three axes have this length.".to_owned(),
        ),
        None if is_singular => (
            format!(
                "matrix `{label}` is not a rotation: its determinant is {:.3}, not 1",
                parts.rotation.determinant()
            ),
            "An entry is missing or in the wrong place: one axis is zero, or depends on the others.".to_owned(),
        ),
        None => (
            format!("matrix `{label}` is not an exact rotation: R^T R differs from the identity by {error:.1e}"),
            format!("Rounding of the written digits explains up to {allowed:.1e}."),
        ),
    };
    let help = match scale {
        _ if is_singular => "correct the missing or misplaced entry",
        Some(_) => "divide the rotation by the scale factor: an extrinsic is a rigid transform",
        None => "export the matrix again from its source, or correct the wrong entry",
    };
    let mut finding = Finding::new(severity, parts.subject(world), message, parts.claim.place.clone())
        .label("not orthonormal")
        .detail(detail)
        .help(help)
        .measured(measured(error, allowed));
    if let Some(factor) = scale {
        finding = finding
            .relation("scaled")
            .measured(Measured::new("common length of the axes", factor, "1"));
    }
    let Some(nearest) = nearest_rotation(&parts.rotation).filter(|_| !is_singular) else {
        return finding;
    };
    // The scale may be intended.
    let safety = scale.map_or(Safety::Safe, |_| Safety::ChangesBehaviour);
    let moved_deg = nearest.angle_moved_rad.to_degrees();
    finding = finding.measured(
        Measured::new(
            "angle to the nearest exact rotation (an automatic fix is offered up to the limit)",
            moved_deg,
            "deg",
        )
        .limit(limits.fix_deg),
    );
    match parts.replace_rotation(world, nearest.rotation.matrix()) {
        Some(edits) if moved_deg <= limits.fix_deg => finding.fix("replace it by the nearest rotation", safety, edits),
        _ => finding,
    }
}
