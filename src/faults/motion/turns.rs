//! What messages with an orientation have in common, and mistakes that all of them can have.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::math::constants::{flu_frd, ned_enu};
use crate::math::rotation::{from_rpy, to_rpy};

/// Shorter quaternions are none.
const LEAST_NORM: f64 = 1e-6;

/// A message with an orientation `world_from_body`.
pub trait Oriented {
    /// The four slots `x y z w` of its orientation.
    fn orientation(&mut self) -> &mut [f64; 4];

    /// Expresses it in another world.
    fn change_world(&mut self, new_from_old: &Rotation3<f64>);

    /// Expresses it for another body: `old_from_new` is the orientation of the new body in the old one.
    fn change_body(&mut self, old_from_new: &Rotation3<f64>);

    /// Negates y of world and body: what is on the left is on the right.
    fn mirror(&mut self);

    /// Changes the orientation alone; zeros stay what they are, and a mean of quaternions keeps its length.
    fn turn(&mut self, change: impl FnOnce(UnitQuaternion<f64>) -> UnitQuaternion<f64>)
    where
        Self: Sized,
    {
        let slots = self.orientation();
        *slots = turned(*slots, change);
    }
}

/// The slots of a changed rotation.
pub(super) fn turned(
    [x, y, z, w]: [f64; 4],
    change: impl FnOnce(UnitQuaternion<f64>) -> UnitQuaternion<f64>,
) -> [f64; 4] {
    match UnitQuaternion::try_new_and_get(Quaternion::new(w, x, y, z), LEAST_NORM) {
        Some((unit, norm)) => (change(unit).into_inner() * norm).coords.into(),
        None => [x, y, z, w],
    }
}

/// The rotation in the four slots `x y z w`; the identity where they hold none.
pub(super) fn rotation([x, y, z, w]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::try_new(Quaternion::new(w, x, y, z), LEAST_NORM).unwrap_or_else(UnitQuaternion::identity)
}

/// A turn to the left about z by this many quarters.
pub(super) fn quarters(count: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), count * FRAC_PI_2)
}

/// A matrix that multiplies each axis.
pub(super) fn diagonal(x: f64, y: f64, z: f64) -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(x, y, z))
}

/// The matrix that swaps x and y.
pub(super) fn xy_swap() -> Matrix3<f64> {
    Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
}

/// Distance of two positions, metres.
pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (Vector3::from(a) - Vector3::from(b)).norm()
}

/// All of it in north, east, down, of a body forward, right, down.
pub(super) fn ned_frd(message: &mut impl Oriented) {
    message.change_world(&ned_enu());
    message.change_body(&flu_frd());
}

/// The world north, east, down; the body as it should be.
pub(super) fn ned_world(message: &mut impl Oriented) {
    message.change_world(&ned_enu());
}

/// The quaternion alone in north, east, down, of a body forward, right, down.
pub(super) fn ned_orientation(message: &mut impl Oriented) {
    message.turn(|stated| UnitQuaternion::from(ned_enu()) * stated * UnitQuaternion::from(flu_frd()));
}

/// The inverse quaternion.
pub(super) fn conjugate(message: &mut impl Oriented) {
    message.turn(|stated| stated.inverse());
}

/// `w x y z` in the slots of `x y z w`.
pub(super) fn wxyz(message: &mut impl Oriented) {
    let slots = message.orientation();
    let [x, y, z, w] = *slots;
    *slots = [w, x, y, z];
}

/// The inverse quaternion, in the order `w x y z`.
pub(super) fn wxyz_conjugate(message: &mut impl Oriented) {
    conjugate(message);
    wxyz(message);
}

/// The heading, clockwise from north, as the yaw.
pub(super) fn compass_yaw(message: &mut impl Oriented) {
    message.turn(|stated| {
        let (roll, pitch, yaw) = to_rpy(&stated);
        from_rpy(roll, pitch, FRAC_PI_2 - yaw)
    });
}

/// A yaw that is zero in the north, towards the west.
pub(super) fn zero_north(message: &mut impl Oriented) {
    message.turn(|stated| UnitQuaternion::from(quarters(-1.0)) * stated);
}

/// Roll, pitch and yaw put together as `Rx Ry Rz`.
pub(super) fn euler_xyz(message: &mut impl Oriented) {
    message.turn(|stated| {
        let (roll, pitch, yaw) = to_rpy(&stated);
        from_rpy(roll, 0.0, 0.0) * from_rpy(0.0, pitch, 0.0) * from_rpy(0.0, 0.0, yaw)
    });
}

/// Degrees taken for radians where roll, pitch and yaw become a quaternion.
pub(super) fn angles_in_degrees(message: &mut impl Oriented) {
    message.turn(|stated| {
        let (roll, pitch, yaw) = to_rpy(&stated);
        from_rpy(roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees())
    });
}

/// The slots of an orientation seen in a mirror that negates y.
pub(super) fn mirrored([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [-x, y, -z, w]
}

/// Whether two orientations are the same, whatever the sign of their quaternions.
pub(super) fn is_same_orientation(a: [f64; 4], b: [f64; 4]) -> bool {
    let apart = |sign: f64| {
        let apart = a.iter().zip(b).map(|(a, b)| (a - sign * b).abs());
        apart.fold(0.0, f64::max)
    };
    apart(1.0).min(apart(-1.0)) < 1e-6
}

/// Whether two vectors are the same, to the precision of their numbers. Numbers that are not finite are the same as any other.
pub(super) fn is_same_vector<const N: usize>(a: [f64; N], b: [f64; N]) -> bool {
    let length = |numbers: [f64; N]| numbers.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let within = 1e-9 * length(a).max(length(b));
    !a.iter().zip(b).any(|(a, b)| (a - b).abs() > within)
}
