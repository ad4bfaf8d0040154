//! CAMERA04: a rectification that is no rotation, or a projection that does not fit the camera.

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
        return out.missing(subject, "R is all zeros: it was not filled in");
    }
    let (error, determinant) = (orthogonality_error(&r), r.determinant());
    let measured = [
        Measured::new("largest entry of R R^T - I", error, "1").limit(limits.orthonormal),
        Measured::new("determinant of R", determinant, "1").limit(1.0),
    ];
    if error <= limits.orthonormal && determinant > 0.0 {
        return out.pass(subject, measured);
    }
    let message = format!(
        "R {} is no rotation: R R^T differs from the identity by {error:.2e}, its determinant is {determinant:.6}",
        published.whose
    );
    let finding = Finding::error(subject, message, published.place.clone());
    let finding = if determinant < 0.0 {
        finding.relation("mirrored")
    } else {
        finding
    };
    let finding =
        finding.help("of one camera R is the identity; of a stereo pair it comes from the calibration of both");
    out.fail(finding.measured(measured));
}

fn judge_p(published: &Intrinsics, subject: String, limits: &Limits, out: &mut Judge) {
    let p = &published.calibration.p;
    if p.iter().all(|value| *value == 0.0) {
        return out.missing(subject, "P is all zeros: the rectified image is not calibrated");
    }
    let [fx, fy, ..] = published.pinhole();
    let [px, _, pcx, tx, py0, py, pcy, ty, p20, p21, p22, _] = *p;
    let is = |value: f64, wanted: f64| (value - wanted).abs() <= limits.exact;
    let fault = if p.iter().any(|value| !value.is_finite()) || px <= 0.0 || py <= 0.0 {
        Some((
            format!("has the focal lengths {px} and {py}"),
            "focal-length",
            "P begins with fx' > 0, and its sixth number is fy' > 0",
        ))
    } else if !(is(py0, 0.0) && is(p20, 0.0) && is(p21, 0.0) && is(p22, 1.0)) {
        let words = "is not fx', s, cx', Tx, 0, fy', cy', Ty, 0, 0, 1, 0".to_owned();
        Some((words, "not-a-projection", "write P row by row, three rows of four"))
    } else if tx > limits.exact {
        let words = format!("has Tx = {tx:.3}: positive, as of a camera to the left of the left one");
        Some((
            words,
            "baseline-sign",
            "of the right camera Tx is -fx' B; if this is the left one its Tx is 0: look whether the two are swapped",
        ))
    } else if ![px / fx, py / fy]
        .iter()
        .all(|zoom| (limits.least_zoom..=limits.most_zoom).contains(zoom))
    {
        let words = format!("has the focal lengths {px:.1} and {py:.1}, and K has {fx:.1} and {fy:.1}");
        Some((
            words,
            "zoom",
            "P belongs to the rectified image of the same size: calibrate both together",
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
            let finding = Finding::error(subject, format!("P {} {words}", published.whose), published.place.clone());
            let finding = finding.likely().relation(relation).help(help);
            out.fail(finding.measured(measured));
        }
    }
}
