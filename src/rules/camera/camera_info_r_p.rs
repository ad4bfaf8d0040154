//! CAMERA04: a rectification that is no rotation, or a projection that contradicts the camera matrix.

use nalgebra::Matrix3;

use crate::analysis::camera::published::Intrinsics;
use crate::math::rotation::orthogonality_error;
use crate::rules::prelude::*;

pub(crate) struct CameraInfoRP;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    orthonormal: f64,
    exact: f64,
    least_zoom: f64,
    most_zoom: f64,
}

impl Rule for CameraInfoRP {
    const NEEDS: &'static [Need] = &[Need::CameraInfo];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for published in Intrinsics::all(world) {
            let subject = format!("rectification of {}", published.subject);
            // That of a file is a matrix of the file: ROT01 and ROT02.
            if published.is_published() && published.is_usable(&subject, out) {
                judge_r(&published, subject, limits, out);
            }
            let subject = format!("projection of {}", published.subject);
            if published.is_usable(&subject, out) {
                judge_p(&published, subject, limits, out);
            }
        }
    }
}

fn judge_r(published: &Intrinsics, subject: String, limits: &Limits, out: &mut Judge) {
    let r = Matrix3::from_row_slice(&published.calibration.r);
    if r == Matrix3::zeros() {
        let why = "R is all zeros: it was not filled in; publish a calibrated camera_info";
        return out.missing(subject, why);
    }
    let (error, determinant) = (orthogonality_error(&r), r.determinant());
    let measured = [
        Measured::new("largest entry of R R^T - I", error, "1").limit(limits.orthonormal),
        Measured::new("determinant of R", determinant, "1").expected(1.0),
    ];
    if error <= limits.orthonormal && determinant > 0.0 {
        return out.pass(subject, measured);
    }
    let message = format!(
        "R {} is no rotation: R R^T - I is {error:.2e}, the determinant {determinant:.6}",
        published.whose
    );
    let finding = Finding::error(subject, message, published.place.clone());
    let finding = if determinant < 0.0 {
        finding.relation("mirrored")
    } else {
        finding
    };
    let finding =
        finding.help("write the identity for a single camera, and the result of the stereo calibration for a pair");
    out.fail(finding.measured(measured));
}

fn judge_p(published: &Intrinsics, subject: String, limits: &Limits, out: &mut Judge) {
    let p = &published.calibration.p;
    if p.iter().all(|value| *value == 0.0) {
        let why = "P is all zeros: the rectified image is not calibrated; publish a calibrated camera_info";
        return out.missing(subject, why);
    }
    let [fx, fy, ..] = published.pinhole();
    let [px, _, pcx, tx, py0, py, pcy, ty, p20, p21, p22, _] = *p;
    let is = |value: f64, wanted: f64| (value - wanted).abs() <= limits.exact;
    let (zooms, accepted) = ([px / fx, py / fy], limits.least_zoom..=limits.most_zoom);
    let fault = if p.iter().any(|value| !value.is_finite()) || px <= 0.0 || py <= 0.0 {
        Some((
            format!("has invalid focal lengths: {px} and {py}"),
            "focal-length",
            "write positive focal lengths: P begins with fx', its sixth number is fy'",
        ))
    } else if !(is(py0, 0.0) && is(p20, 0.0) && is(p21, 0.0) && is(p22, 1.0)) {
        let words = "is not fx', s, cx', Tx, 0, fy', cy', Ty, 0, 0, 1, 0".to_owned();
        Some((words, "not-a-projection", "write P row by row, three rows of four"))
    } else if tx > limits.exact {
        let words = format!("has a positive Tx = {tx:.3}, as for a camera to the left of the left one");
        Some((
            words,
            "baseline-sign",
            "check whether the two cameras are swapped: Tx is -fx' B for the right camera and 0 for the left one",
        ))
    } else if !zooms.iter().all(|zoom| accepted.contains(zoom)) {
        let words = format!("has focal lengths {px:.1} and {py:.1}, but K has {fx:.1} and {fy:.1}");
        Some((
            words,
            "zoom",
            "calibrate K and P together: P belongs to the rectified image of the same size",
        ))
    } else {
        None
    };
    let measured = [
        Measured::new("fx of P over that of K", px / fx, "1").limit(limits.most_zoom),
        Measured::new("Tx", tx, "px m").limit(0.0),
        Measured::new("Ty", ty, "px m"),
        Measured::new("cx of P", pcx, "px"),
        Measured::new("cy of P", pcy, "px"),
    ];
    match fault {
        None => out.pass(subject, measured),
        Some((words, relation, help)) => {
            let message = format!("P {} {words}", published.whose);
            let finding = Finding::error(subject, message, published.place.clone());
            let finding = finding.likely().relation(relation).help(help);
            out.fail(finding.measured(measured));
        }
    }
}
