//! The order of angles behind a quaternion, found by the gyro: taken apart in the right order, and put together as ROS does,
//! the orientation is the integral of the gyro, and gravity does not contradict it.
//!
//! Owns the search. Must not word a finding.

use nalgebra::{UnitQuaternion, Vector3};

use crate::analysis::motion::Imu;
use crate::math::turns::{Options, Row, Turns, turns};
use crate::math::{euler::Order, readings::Reading};

/// An order that was found.
#[derive(Clone, Debug)]
pub(crate) struct Ordered {
    pub(crate) order: Order,
    /// Orders that fit as well.
    pub(crate) alike: Vec<Order>,
    /// Residual of the orientation as published.
    pub(crate) as_published: f64,
    /// ... taken apart in this order.
    pub(crate) residual: f64,
    /// ... in the best order that does not fit as well.
    pub(crate) next: f64,
    pub(crate) windows: u64,
}

/// How much better an order must be than the published one, and than the orders that are not the same.
pub(crate) struct Margins {
    /// A residual up to this is an agreement.
    pub(crate) agrees: f64,
    pub(crate) ratio: f64,
    /// Residuals below are not compared.
    pub(crate) noise: f64,
}

/// Length of the windows, seconds; as for QUAT01.
const WINDOW_S: f64 = 0.5;
/// Two orders whose residuals differ by less than this factor cannot be told apart.
const ALIKE: f64 = 1.5;
/// Mean cosine from the vertical beneath which an axis points down, steadily.
const DOWN: f64 = -0.5;

/// The order of angles that the quaternions of a sensor were made in, if the gyro shows one.
pub(crate) fn ordered(imu: &Imu, as_published: f64, margins: &Margins) -> Option<Ordered> {
    let mut tried: Vec<(Order, Turns, f64)> = candidates()
        .filter(|order| !contradicts_gravity(oriented(imu, *order)))
        .filter_map(|order| {
            let turns = turns(&corrected(imu, order), &Options::new(WINDOW_S))?;
            let residual = turns.score(Reading::Xyzw)?.residual;
            residual.is_finite().then_some((order, turns, residual))
        })
        .collect();
    // Stable: of orders that fit alike the likelier one stays first.
    tried.sort_by(|a, b| a.2.total_cmp(&b.2));
    let best = tried.first()?.2;
    let floor = best.max(margins.noise);
    if best > margins.agrees || as_published < margins.ratio * floor {
        return None;
    }
    let fit: Vec<Order> = Order::all()
        .into_iter()
        .filter(|order| {
            tried
                .iter()
                .any(|(tried, _, residual)| tried == order && *residual <= ALIKE * floor)
        })
        .collect();
    let next = tried
        .iter()
        .map(|tried| tried.2)
        .find(|residual| *residual > ALIKE * floor);
    let next = next.unwrap_or(as_published);
    let (order, alike) = fit.split_first()?;
    if next < margins.ratio * floor {
        return None;
    }
    let (_, turns, residual) = tried.iter().find(|tried| tried.0 == *order)?;
    Some(Ordered {
        order: *order,
        alike: alike.to_vec(),
        as_published,
        residual: *residual,
        next,
        windows: turns.active as u64,
    })
}

/// The orders of three axes whose middle angle is not the yaw: that one goes all round, and is lost as a middle one.
fn candidates() -> impl Iterator<Item = Order> {
    const YAW: u8 = 2;
    let of_three = |order: &Order| order.numbers_of(&nalgebra::UnitQuaternion::identity()).is_some();
    Order::all()
        .into_iter()
        .skip(1)
        .filter(move |order| order.middle() != YAW && of_three(order))
}

/// The rotation that four numbers would be, had their angles been put together as ROS does.
fn in_order_of_ros(published: [f64; 4], order: Order) -> Option<UnitQuaternion<f64>> {
    let rotation = Reading::Xyzw.world_from_body(published)?;
    Some(Order::ROS.compose(order.numbers_of(&rotation)?))
}

/// Those rotations of a sensor, with the acceleration.
fn oriented(imu: &Imu, order: Order) -> impl Iterator<Item = (UnitQuaternion<f64>, Vector3<f64>)> + '_ {
    imu.stream.rows().filter_map(move |timed| {
        let rotation = in_order_of_ros(timed.row.orientation, order)?;
        Some((rotation, Vector3::from(timed.row.linear_acceleration)))
    })
}

/// Whether a body would stand on its head by its orientation, and the acceleration does not say so. An orientation whose body
/// alone is forward, right, down looks like another order of angles on flat ground: its roll of half a turn changes places with
/// its yaw.
fn contradicts_gravity(oriented: impl Iterator<Item = (UnitQuaternion<f64>, Vector3<f64>)>) -> bool {
    let (mut rows, mut body_up, mut force_up, mut force) = (0.0, 0.0, 0.0, 0.0);
    for (world_from_body, acceleration) in oriented.filter(|(_, force)| force.norm().is_finite()) {
        rows += 1.0;
        body_up += (world_from_body * Vector3::z()).z;
        force_up += (world_from_body * acceleration).z;
        force += acceleration.norm();
    }
    // Hanging upside down, the force at rest points up in the world all the same.
    body_up < DOWN * rows && force_up <= -DOWN * force
}

/// The rows of a sensor with the orientation that it would have, had its angles been put together as ROS does.
fn corrected(imu: &Imu, order: Order) -> Vec<Vec<Row>> {
    let slots = |published: [f64; 4]| -> [f64; 4] {
        in_order_of_ros(published, order).map_or([f64::NAN; 4], |q| [q.coords.x, q.coords.y, q.coords.z, q.coords.w])
    };
    let stretches = imu.stream.stretches.iter();
    stretches
        .map(|stretch| {
            let rows = stretch.iter().map(|timed| Row {
                t_s: timed.t_s,
                slots: slots(timed.row.orientation),
                rate_rad_s: timed.row.angular_velocity,
            });
            rows.collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive in circles, level, by an orientation that stands this way up, with this acceleration in the body.
    fn turning(roll_rad: f64, up_m_s2: f64) -> impl Iterator<Item = (UnitQuaternion<f64>, Vector3<f64>)> {
        (0..100).map(move |row| {
            let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.1 * f64::from(row));
            let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll_rad);
            (yaw * roll, Vector3::new(0.3, -0.2, up_m_s2))
        })
    }

    #[test]
    fn only_an_orientation_on_its_head_that_gravity_does_not_see_is_contradicted() {
        let half_turn = std::f64::consts::PI;
        assert!(contradicts_gravity(turning(half_turn, 9.81)), "a body in FRD alone");
        assert!(contradicts_gravity(turning(half_turn, 0.0)), "no gravity to confirm it");
        assert!(!contradicts_gravity(turning(half_turn, -9.81)), "hangs upside down");
        assert!(!contradicts_gravity(turning(0.1, 9.81)), "level");
        assert!(!contradicts_gravity(turning(0.1, -9.81)), "all of it in NED and FRD");
    }
}
