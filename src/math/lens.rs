//! Lenses: the pixel at which a point is imaged.
//!
//! Owns the whole path from a point in optical axes (x right, y down, z forward, metres) to a pixel of the raw image, for the models of
//! ROS and OpenCV. Must not know messages. Sources: OpenCV, Camera Calibration and 3D Reconstruction (radial, tangential, thin
//! prism, tilted sensor; `cvProjectPoints2`) and Fisheye camera model (Kannala and Brandt 2006; `fisheye::projectPoints`).

use nalgebra::{Matrix3, Vector3};

use super::distortion::{RadialModel, Reach};

/// A camera with its distortion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Row-major fx, skew, cx, fy, cy, pixels.
    k: [f64; 5],
    radial: RadialModel,
    /// p1, p2.
    tangential: [f64; 2],
    /// s1 to s4.
    prism: [f64; 4],
    /// Turn of a tilted sensor, as a projective map of the normalised image.
    tilt: Matrix3<f64>,
    /// Angle from the axis from which on the model folds back, radians.
    widest_rad: f64,
}

/// Farther from the axis than this a lens without fisheye sees nothing, radians: the tangent has grown to 57.
const WIDEST_PERSPECTIVE_RAD: f64 = 1.553;

impl Lens {
    /// The lens of row-major intrinsics (pixels), a model (`plumb_bob`, `rational_polynomial`, `equidistant`, `fisheye`) and its
    /// coefficients in OpenCV's order. No coefficients are no distortion. `None` for other models, counts, or focal lengths that
    /// are not positive.
    pub fn new(k: &[f64; 9], model: &str, d: &[f64]) -> Option<Self> {
        let [fx, skew, cx, _, fy, cy, ..] = *k;
        if ![fx, skew, cx, fy, cy].iter().chain(d).all(|value| value.is_finite()) || fx <= 0.0 || fy <= 0.0 {
            return None;
        }
        let mut lens = Self {
            k: [fx, skew, cx, fy, cy],
            radial: RadialModel::PlumbBob([0.0; 3]),
            tangential: [0.0; 2],
            prism: [0.0; 4],
            tilt: Matrix3::identity(),
            widest_rad: WIDEST_PERSPECTIVE_RAD,
        };
        match (model, d) {
            ("equidistant" | "fisheye", []) => lens.radial = RadialModel::Fisheye([0.0; 4]),
            ("equidistant" | "fisheye", [k1, k2, k3, k4]) => lens.radial = RadialModel::Fisheye([*k1, *k2, *k3, *k4]),
            ("" | "plumb_bob" | "rational_polynomial", []) => {}
            ("plumb_bob", [k1, k2, p1, p2]) => {
                lens.radial = RadialModel::PlumbBob([*k1, *k2, 0.0]);
                lens.tangential = [*p1, *p2];
            }
            ("plumb_bob", [k1, k2, p1, p2, k3]) => {
                lens.radial = RadialModel::PlumbBob([*k1, *k2, *k3]);
                lens.tangential = [*p1, *p2];
            }
            ("rational_polynomial", [k1, k2, p1, p2, k3, k4, k5, k6, rest @ ..]) => {
                lens.radial = RadialModel::Rational([*k1, *k2, *k3, *k4, *k5, *k6]);
                lens.tangential = [*p1, *p2];
                match rest {
                    [] => {}
                    [s1, s2, s3, s4] => lens.prism = [*s1, *s2, *s3, *s4],
                    [s1, s2, s3, s4, tau_x, tau_y] => {
                        lens.prism = [*s1, *s2, *s3, *s4];
                        lens.tilt = tilt(*tau_x, *tau_y);
                    }
                    _ => return None,
                }
            }
            _ => return None,
        }
        // How far it can be used: any radius that no image has.
        if let Some(Reach::Folds { angle_rad, .. }) = lens.radial.reach(1e6) {
            let is_fisheye = matches!(lens.radial, RadialModel::Fisheye(_));
            let most = if is_fisheye {
                std::f64::consts::PI
            } else {
                WIDEST_PERSPECTIVE_RAD
            };
            lens.widest_rad = angle_rad.min(most);
        }
        Some(lens)
    }

    /// The pixel (u to the right, v down) at which a point in optical axes is imaged. `None` behind a lens without fisheye, beyond
    /// where the model folds, and for points at the centre or not finite.
    pub fn project(&self, point: &Vector3<f64>) -> Option<[f64; 2]> {
        let aside = point.xy().norm();
        let angle_rad = aside.atan2(point.z);
        if !(angle_rad.is_finite() && point.norm() > 1e-9) || angle_rad > self.widest_rad {
            return None;
        }
        let [x, y] = if let RadialModel::Fisheye(_) = self.radial {
            let scale = if aside > 1e-12 {
                self.radial.distorted(angle_rad) / aside
            } else {
                0.0
            };
            [point.x * scale, point.y * scale]
        } else {
            self.perspective(point.x / point.z, point.y / point.z)?
        };
        let [fx, skew, cx, fy, cy] = self.k;
        let pixel = [fx * x + skew * y + cx, fy * y + cy];
        pixel.iter().all(|value| value.is_finite()).then_some(pixel)
    }

    /// Distorts a point of the normalised image.
    fn perspective(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        let r2 = x * x + y * y;
        let r = r2.sqrt();
        let scale = if r > 1e-12 {
            self.radial.distorted(r.atan()) / r
        } else {
            1.0
        };
        let ([p1, p2], [s1, s2, s3, s4]) = (self.tangential, self.prism);
        let xd = x * scale + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + s1 * r2 + s2 * r2 * r2;
        let yd = y * scale + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + s3 * r2 + s4 * r2 * r2;
        let tilted = self.tilt * Vector3::new(xd, yd, 1.0);
        (tilted.z.abs() > 1e-12).then(|| [tilted.x / tilted.z, tilted.y / tilted.z])
    }
}

/// The projective map of a sensor that is tilted by two angles about x and y, radians (OpenCV, `computeTiltProjectionMatrix`).
fn tilt(tau_x: f64, tau_y: f64) -> Matrix3<f64> {
    let ((sin_x, cos_x), (sin_y, cos_y)) = (tau_x.sin_cos(), tau_y.sin_cos());
    let about_x = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos_x, sin_x, 0.0, -sin_x, cos_x);
    let about_y = Matrix3::new(cos_y, 0.0, -sin_y, 0.0, 1.0, 0.0, sin_y, 0.0, cos_y);
    let turned = about_y * about_x;
    let [r02, r12, r22] = [turned.m13, turned.m23, turned.m33];
    Matrix3::new(r22, 0.0, -r02, 0.0, r22, -r12, 0.0, 0.0, 1.0) * turned
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const K: [f64; 9] = [600.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0];

    fn near(found: Option<[f64; 2]>, wanted: [f64; 2]) {
        let found = found.unwrap();
        assert!(
            (found[0] - wanted[0]).abs() < 1e-6 && (found[1] - wanted[1]).abs() < 1e-6,
            "{found:?} {wanted:?}"
        );
    }

    #[test]
    fn a_pinhole_divides_by_depth_and_sees_nothing_behind() {
        let lens = Lens::new(&K, "plumb_bob", &[0.0; 5]).unwrap();
        near(
            lens.project(&Vector3::new(1.0, -2.0, 4.0)),
            [320.0 + 150.0, 240.0 - 250.0],
        );
        assert_eq!(lens.project(&Vector3::new(1.0, -2.0, -4.0)), None);
        assert_eq!(lens.project(&Vector3::new(0.0, 0.0, 0.0)), None);
        assert_eq!(lens.project(&Vector3::new(f64::NAN, 0.0, 1.0)), None);
        assert_eq!(Lens::new(&K, "plumb_bob", &[]), Lens::new(&K, "", &[]));
    }

    #[test]
    fn brown_conrady_is_the_formula_of_opencv() {
        // Written out by hand: x = 0.5, y = -0.25, r2 = 0.3125.
        let (k1, k2, p1, p2, k3) = (-0.2, 0.05, 0.001, -0.002, 0.01);
        let lens = Lens::new(&K, "plumb_bob", &[k1, k2, p1, p2, k3]).unwrap();
        let (x, y, r2): (f64, f64, f64) = (0.5, -0.25, 0.3125);
        let radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
        let xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
        let yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
        near(
            lens.project(&Vector3::new(1.0, -0.5, 2.0)),
            [600.0 * xd + 320.0, 500.0 * yd + 240.0],
        );
    }

    #[test]
    fn thin_prisms_and_a_quotient_add_their_parts() {
        let d = [0.3, -0.2, 0.0, 0.0, 0.1, 0.3, -0.2, 0.1, 0.01, 0.002, -0.03, 0.004];
        let lens = Lens::new(&K, "rational_polynomial", &d).unwrap();
        // The quotient of equal polynomials is 1: only the prisms remain, at r2 = 0.25.
        let (xd, yd) = (0.5 + 0.01 * 0.25 + 0.002 * 0.0625, -0.03 * 0.25 + 0.004 * 0.0625);
        near(
            lens.project(&Vector3::new(1.0, 0.0, 2.0)),
            [600.0 * xd + 320.0, 500.0 * yd + 240.0],
        );
        assert_eq!(Lens::new(&K, "rational_polynomial", &d[..11]), None);
    }

    #[test]
    fn a_tilted_sensor_keeps_the_axis_and_is_a_homography_about_it() {
        let mut d = [0.0; 14];
        d[12] = 0.1;
        let lens = Lens::new(&K, "rational_polynomial", &d).unwrap();
        near(lens.project(&Vector3::new(0.0, 0.0, 1.0)), [320.0, 240.0]);
        // About x alone: y' = y / (cos - y sin) * cos... by the matrix: numerator y cos^2 + y sin^2 = y, denominator cos - y sin.
        let (sin, cos) = 0.1_f64.sin_cos();
        let (x, y) = (0.2, 0.3);
        let depth = cos - y * sin;
        near(
            lens.project(&Vector3::new(x, y, 1.0)),
            [600.0 * x * cos / depth + 320.0, 500.0 * y / depth + 240.0],
        );
    }

    #[test]
    fn a_fisheye_is_linear_in_the_angle_and_sees_behind() {
        let lens = Lens::new(&K, "equidistant", &[0.0; 4]).unwrap();
        let angle = 1.9_f64;
        near(
            lens.project(&Vector3::new(angle.sin(), 0.0, angle.cos())),
            [600.0 * angle + 320.0, 240.0],
        );
        let (k1, k2) = (-0.02, 0.003);
        let lens = Lens::new(&K, "fisheye", &[k1, k2, 0.0, 0.0]).unwrap();
        let angle = 0.8_f64;
        let radius = angle * (1.0 + k1 * angle.powi(2) + k2 * angle.powi(4));
        near(
            lens.project(&Vector3::new(0.0, angle.sin(), angle.cos())),
            [320.0, 500.0 * radius + 240.0],
        );
    }

    #[test]
    fn what_lies_beyond_the_fold_is_not_in_the_image() {
        // r (1 - 0.3 r^2) folds at r = 1.054.
        let lens = Lens::new(&K, "plumb_bob", &[-0.3, 0.0, 0.0, 0.0, 0.0]).unwrap();
        assert!(lens.project(&Vector3::new(1.0, 0.0, 1.0)).is_some());
        assert_eq!(lens.project(&Vector3::new(1.5, 0.0, 1.0)), None);
    }
}
