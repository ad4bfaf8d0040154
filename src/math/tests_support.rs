//! Test support: a seeded generator and random rotations. Only compiled for tests.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

/// Random geometry from a seed, the same on every platform.
pub(crate) struct Rng(fastrand::Rng);

impl Rng {
    pub(crate) fn new(seed: u64) -> Self {
        Rng(fastrand::Rng::with_seed(seed))
    }

    /// Uniform in 0..1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0.f64()
    }

    /// Uniform in low..high.
    pub(crate) fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Standard normal (Box-Muller).
    pub(crate) fn normal(&mut self) -> f64 {
        let u = 1.0 - self.unit();
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// A vector of three independent standard normals.
    pub(crate) fn normal3(&mut self) -> Vector3<f64> {
        Vector3::new(self.normal(), self.normal(), self.normal())
    }

    /// A direction, uniform on the sphere.
    pub(crate) fn direction(&mut self) -> Vector3<f64> {
        self.normal3().normalize()
    }

    /// A rotation, uniform on SO(3).
    pub(crate) fn rotation(&mut self) -> UnitQuaternion<f64> {
        let (v, w) = (self.normal3(), self.normal());
        UnitQuaternion::from_quaternion(Quaternion::new(w, v.x, v.y, v.z))
    }

    /// A point, uniform in the ball of this radius.
    pub(crate) fn in_ball(&mut self, radius: f64) -> Vector3<f64> {
        self.direction() * radius * self.unit().cbrt()
    }

    /// `t` with its rotation moved by `angle_rad` about a random axis and its translation by `sigma_m` per axis.
    pub(crate) fn misaligned(&mut self, t: &Isometry3<f64>, angle_rad: f64, sigma_m: f64) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_scaled_axis(self.direction() * angle_rad);
        let moved = t.translation.vector + self.normal3() * sigma_m;
        Isometry3::from_parts(Translation3::from(moved), turn * t.rotation)
    }

    /// `t` with noise: a rotation vector of `sigma_rad` per axis and `sigma_m` per axis.
    pub(crate) fn noisy(&mut self, t: &Isometry3<f64>, sigma_rad: f64, sigma_m: f64) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_scaled_axis(self.normal3() * sigma_rad);
        let moved = t.translation.vector + self.normal3() * sigma_m;
        Isometry3::from_parts(Translation3::from(moved), turn * t.rotation)
    }
}
