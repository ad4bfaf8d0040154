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
    let fault = if determinant < 0.0 {
        format!("is mirrored (determinant {determinant:.6}, must be 1)")
    } else {
        format!("is no rotation (R R^T differs from the identity by {error:.2e})")
    };
    let message = format!("R {} {fault}", published.whose);
    let finding = Finding::error(subject, message, published.place.clone());
    let finding = if determinant < 0.0 {
        finding.relation("mirrored")
    } else {
        finding
    };
    let finding = finding.help(
        "write the identity into R for a camera without rectification, and the result of the stereo calibration for a pair",
    );
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
            String::new(),
            "focal-length",
            "write positive focal lengths in pixels as the first (fx') and the sixth (fy') number of P",
        ))
    } else if !(is(py0, 0.0) && is(p20, 0.0) && is(p21, 0.0) && is(p22, 1.0)) {
        let words = "is not fx', s, cx', Tx, 0, fy', cy', Ty, 0, 0, 1, 0".to_owned();
        let help = "write P row by row, three rows of four numbers";
        Some((words, String::new(), "not-a-projection", help))
    } else if tx > limits.exact {
        Some((
            format!("has Tx = {tx:+.3} px m, which must not be positive"),
            "Tx is -fx' * baseline: 0 for the left camera of a pair, negative for the right camera.".to_owned(),
            "baseline-sign",
            "negate Tx; or, if left and right were exchanged in the calibration, calibrate the pair again in the right order",
        ))
    } else if !zooms.iter().all(|zoom| accepted.contains(zoom)) {
        Some((
            format!(
                "has fx, fy = {px:.1}, {py:.1} px, {:.2} and {:.2} times those of K",
                px / fx,
                py / fy
            ),
            format!(
                "K has fx, fy = {fx:.1}, {fy:.1} px. Rectified images of the same size have similar focal lengths: K and P are probably of different \
                 calibrations or image sizes."
            ),
            "zoom",
            "take K and P from one calibration for this image size; for a camera without rectification, copy fx, cx, fy and cy of K into P",
        ))
    } else {
        None
    };
    let zoom = |of: &str, ratio: f64| {
        let measured = Measured::new(format!("{of} of P / {of} of K"), ratio, "1");
        if ratio < limits.least_zoom {
            measured.at_least(limits.least_zoom)
        } else {
            measured.limit(limits.most_zoom)
        }
    };
    let baseline = Measured::new("Tx", tx, "px m").limit(0.0);
    match fault {
        None => out.pass(
            subject,
            [
                zoom("fx", px / fx),
                baseline,
                Measured::new("Ty", ty, "px m"),
                Measured::new("cx of P", pcx, "px"),
                Measured::new("cy of P", pcy, "px"),
            ],
        ),
        Some((words, detail, relation, help)) => {
            let message = format!("P {} {words}", published.whose);
            let finding = Finding::error(subject, message, published.place.clone());
            let finding = finding.likely().relation(relation).detail(detail).help(help);
            out.fail(if relation == "baseline-sign" {
                finding.measured(baseline)
            } else {
                finding.measured([zoom("fx", px / fx), zoom("fy", py / fy)])
            });
        }
    }
}
