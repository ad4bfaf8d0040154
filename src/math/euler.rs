//! Three angles about coordinate axes, combined in any order.
//!
//! Owns the 72 ways to make a rotation from three numbers, their names, and the inverse. Must not know which of them a
//! file means. Radians throughout. Source: Diebel 2006, Representing Attitude,
//! section 5 (the twelve sequences); URDF specification, `origin` (fixed axes x, y, z).

use nalgebra::{Unit, UnitQuaternion, Vector3};

/// A way to make a rotation from three numbers: `R = R_axis0(number) * R_axis1(number) * R_axis2(number)`.
///
/// Read from left to right the turns are about rotating (intrinsic) axes, from right to left about fixed (extrinsic)
/// ones: both readings of a sequence are in the list, as two sequences.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Order {
    /// The axes of the three factors: 0, 1, 2 for x, y, z. Neighbours differ.
    axes: [u8; 3],
    /// Which of the three numbers turns about each of them. A permutation.
    numbers: [u8; 3],
}

/// The twelve sequences of axes: that of ROS first, then its reverse, the other ones of three axes, those of two.
const SEQUENCES: [[u8; 3]; 12] = [
    [2, 1, 0],
    [0, 1, 2],
    [2, 0, 1],
    [1, 0, 2],
    [0, 2, 1],
    [1, 2, 0],
    [2, 0, 2],
    [2, 1, 2],
    [0, 1, 0],
    [0, 2, 0],
    [1, 0, 1],
    [1, 2, 1],
];

/// The six orders of three numbers.
const PERMUTATIONS: [[u8; 3]; 6] = [[0, 1, 2], [2, 1, 0], [1, 0, 2], [0, 2, 1], [1, 2, 0], [2, 0, 1]];

impl Order {
    /// Roll, pitch, yaw as ROS and URDF have them: `Rz(third) * Ry(second) * Rx(first)`.
    pub const ROS: Order = Order {
        axes: [2, 1, 0],
        numbers: [2, 1, 0],
    };

    /// All 72, the likeliest error first: each number about its own axis in another sequence, then the sequence of ROS
    /// with its numbers exchanged, then both, then sequences of two axes. [`Order::ROS`] is the first.
    pub fn all() -> Vec<Order> {
        let (three, two) = SEQUENCES.split_at(6);
        let mut all: Vec<Order> = three.iter().map(|&axes| Order { axes, numbers: axes }).collect();
        let named = PERMUTATIONS.iter().map(|&exchanged| Order::ROS.exchanged(exchanged));
        let every = three
            .iter()
            .chain(two)
            .flat_map(|&axes| PERMUTATIONS.iter().map(move |&numbers| Order { axes, numbers }));
        for order in named.chain(every) {
            if !all.contains(&order) {
                all.push(order);
            }
        }
        all
    }

    /// This sequence with the numbers in another order in the list.
    fn exchanged(self, order: [u8; 3]) -> Order {
        let take = |number: u8| order.get(usize::from(number)).copied().unwrap_or(number);
        Order {
            numbers: self.numbers.map(take),
            ..self
        }
    }

    /// The rotation that the numbers make, radians.
    pub fn compose(self, numbers: [f64; 3]) -> UnitQuaternion<f64> {
        let factor = |(axis, number): (&u8, &u8)| {
            let angle = numbers.get(usize::from(*number)).copied().unwrap_or(f64::NAN);
            UnitQuaternion::from_axis_angle(&unit(*axis), angle)
        };
        let factors = self.axes.iter().zip(&self.numbers).map(factor);
        factors.fold(UnitQuaternion::identity(), |product, factor| product * factor)
    }

    /// The numbers that make a rotation; the one about the middle axis is within a quarter turn. `None` for sequences
    /// of two axes. Where the middle one is a quarter turn, the last one is 0.
    pub fn numbers_of(self, rotation: &UnitQuaternion<f64>) -> Option<[f64; 3]> {
        let [a, b, c] = self.axes.map(usize::from);
        if a == c {
            return None;
        }
        let matrix = rotation.to_rotation_matrix();
        let entry = |row: usize, column: usize| matrix.matrix().get((row, column)).copied().unwrap_or(f64::NAN);
        // 1 where the axes are in the order x, y, z, x, ...
        let sign = if (b + 3 - a) % 3 == 1 { 1.0 } else { -1.0 };
        let cosine = entry(a, a).hypot(entry(a, b));
        let middle = (sign * entry(a, c)).atan2(cosine);
        // Below this the entries that hold the other two are rounding noise, as in `to_rpy`.
        let angles = if cosine < 1e-9 {
            [(sign * entry(c, b)).atan2(entry(b, b)), middle, 0.0]
        } else {
            [
                (-sign * entry(b, c)).atan2(entry(c, c)),
                middle,
                (-sign * entry(a, b)).atan2(entry(a, a)),
            ]
        };
        let mut numbers = [0.0; 3];
        for (number, angle) in self.numbers.iter().zip(angles) {
            if let Some(slot) = numbers.get_mut(usize::from(*number)) {
                *slot = angle;
            }
        }
        Some(numbers)
    }

    /// The number that turns about the middle axis: 0, 1 or 2.
    pub fn middle(self) -> u8 {
        let [_, middle, _] = self.numbers;
        middle
    }

    /// As a product: `Rz(yaw) Ry(pitch) Rx(roll)`, the numbers being called roll, pitch and yaw by their place.
    pub fn product(self) -> String {
        let factor = |(axis, number): (&u8, &u8)| format!("R{}({})", letter(*axis), name(*number));
        let factors: Vec<String> = self.axes.iter().zip(&self.numbers).map(factor).collect();
        factors.join(" ")
    }

    /// A stable word: `euler-xyz` where each number turns about its own axis, else `euler-zyx-roll-pitch-yaw` with the
    /// numbers in the order of the axes.
    pub fn word(self) -> String {
        let axes: String = self.axes.iter().map(|axis| letter(*axis)).collect();
        if self.axes == self.numbers {
            return format!("euler-{axes}");
        }
        let numbers: Vec<&str> = self.numbers.iter().map(|number| name(*number)).collect();
        format!("euler-{axes}-{}", numbers.join("-"))
    }
}

fn unit(axis: u8) -> Unit<Vector3<f64>> {
    match axis {
        0 => Vector3::x_axis(),
        1 => Vector3::y_axis(),
        _ => Vector3::z_axis(),
    }
}

fn letter(axis: u8) -> char {
    match axis {
        0 => 'x',
        1 => 'y',
        _ => 'z',
    }
}

fn name(number: u8) -> &'static str {
    match number {
        0 => "roll",
        1 => "pitch",
        _ => "yaw",
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::rotation::from_rpy;
    use std::collections::BTreeSet;
    use std::f64::consts::FRAC_PI_2;

    const ANGLES: [f64; 3] = [0.4, -0.7, 1.9];

    #[test]
    fn there_are_72_ways_and_the_first_is_that_of_ros() {
        let all = Order::all();
        assert_eq!((all.len(), all.first()), (72, Some(&Order::ROS)));
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), 72);
        assert_eq!(all.iter().map(|order| order.word()).collect::<BTreeSet<_>>().len(), 72);
        let [r, p, y] = ANGLES;
        assert!(Order::ROS.compose(ANGLES).angle_to(&from_rpy(r, p, y)) < 1e-12);
        let different = |a: &Order, b: &Order| a == b || a.compose(ANGLES).angle_to(&b.compose(ANGLES)) > 0.01;
        assert!(all.iter().all(|a| all.iter().all(|b| different(a, b))));
    }

    #[test]
    fn rotating_axes_from_the_left_are_fixed_axes_from_the_right() {
        // Open3D `get_rotation_matrix_from_xyz`: Rx(a) Ry(b) Rz(c), its documentation.
        let xyz = Order::all()
            .into_iter()
            .find(|order| order.word() == "euler-xyz")
            .unwrap();
        let [a, b, c] = ANGLES;
        let turn = |axis: Unit<Vector3<f64>>, angle| UnitQuaternion::from_axis_angle(&axis, angle);
        let intrinsic = turn(Vector3::x_axis(), a) * turn(Vector3::y_axis(), b) * turn(Vector3::z_axis(), c);
        assert!(xyz.compose(ANGLES).angle_to(&intrinsic) < 1e-12);
        assert_eq!(xyz.product(), "Rx(roll) Ry(pitch) Rz(yaw)");
        // Its inverse is the sequence of ROS with negated angles.
        assert!(xyz.compose(ANGLES).inverse().angle_to(&from_rpy(-a, -b, -c)) < 1e-12);
    }

    #[test]
    fn a_quarter_turn_each_gives_the_axes_of_the_closed_form() {
        // Rz(90) Rx(90): x goes to y, y to z, z to x.
        let zxz = Order {
            axes: [2, 0, 2],
            numbers: [0, 1, 2],
        };
        let turned = zxz.compose([FRAC_PI_2, FRAC_PI_2, 0.0]);
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| turned * axis);
        let expected = [Vector3::y(), Vector3::z(), Vector3::x()];
        assert!(axes.iter().zip(&expected).all(|(a, b)| (a - b).norm() < 1e-12));
    }

    #[test]
    fn the_numbers_are_found_again() {
        for order in Order::all() {
            let Some(numbers) = order.numbers_of(&order.compose([0.4, -0.7, 1.2])) else {
                let [a, _, c] = order.axes;
                assert_eq!(a, c);
                continue;
            };
            let wrong = numbers.iter().zip([0.4, -0.7, 1.2]).map(|(a, b)| (a - b).abs());
            assert!(wrong.fold(0.0, f64::max) < 1e-9, "{}", order.word());
        }
        let flipped = Order::ROS.compose([0.2, FRAC_PI_2, 0.5]);
        let again = Order::ROS.compose(Order::ROS.numbers_of(&flipped).unwrap());
        assert!(again.angle_to(&flipped) < 1e-6);
    }
}
