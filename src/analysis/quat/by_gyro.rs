//! The order of the Euler angles behind a quaternion, by the gyro: decomposed in the right order and recomposed as in ROS, the
//! orientation is the integral of the gyro and does not contradict gravity.
//!
//! Owns the search. Must not word a finding.

use nalgebra::{UnitQuaternion, Vector3};

use crate::analysis::motion::Imu;
use crate::math::turns::{Options, Row, Turns, turns};
use crate::math::{euler::Order, readings::Reading};

/// An order that was found.
#[derive(Clone, Debug)]
pub(crate) struct GyroOrder {
    pub(crate) order: Order,
    /// Orders that fit as well.
    pub(crate) alike: Vec<Order>,
    /// Residual of the orientation as published.
    pub(crate) as_published: f64,
    /// Residual when it is decomposed in this order.
    pub(crate) residual: f64,
    /// Residual of the best order that does not fit as well.
    pub(crate) next: f64,
    pub(crate) windows: u64,
}

/// How much better an order must be than the published one, and than other orders.
pub(crate) struct Margins {
    /// A residual up to this is an agreement.
    pub(crate) agrees: f64,
    pub(crate) ratio: f64,
    /// Residuals below are not compared.
    pub(crate) noise: f64,
}

/// Length of the windows, seconds; as for QUAT01.
const WINDOW_S: f64 = 0.5;
/// Two orders whose residuals differ by less than this factor cannot be distinguished.
const ALIKE: f64 = 1.5;
/// Mean cosine to the vertical below which an axis steadily points down.
const DOWN: f64 = -0.5;

/// The order of angles that the quaternions of a sensor are composed in, if the gyro shows one.
pub(crate) fn ordered(imu: &Imu, as_published: f64, margins: &Margins) -> Option<GyroOrder> {
    let mut tried: Vec<(Order, Turns, f64)> = candidates()
        .filter_map(|order| {
            let rows = corrected(imu, order);
            if contradicts_gravity(oriented(imu, &rows)) {
                return None;
            }
            let turns = turns(&rows, &Options::new(WINDOW_S))?;
            let residual = turns.score(Reading::Xyzw)?.residual;
            residual.is_finite().then_some((order, turns, residual))
        })
        .collect();
    // Stable: of orders that fit equally well the likelier one stays first.
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
    Some(GyroOrder {
        order: *order,
        alike: alike.to_vec(),
        as_published,
        residual: *residual,
        next,
        windows: turns.active as u64,
    })
}

/// The orders of three axes whose middle angle is not the yaw: a middle angle is limited to half a turn.
fn candidates() -> impl Iterator<Item = Order> {
    const YAW: u8 = 2;
    let of_three = |order: &Order| order.numbers_of(&nalgebra::UnitQuaternion::identity()).is_some();
    Order::all()
        .into_iter()
        .skip(1)
        .filter(move |order| order.middle() != YAW && of_three(order))
}

/// The rotation of four numbers with their angles recomposed as in ROS.
fn in_order_of_ros(published: [f64; 4], order: Order) -> Option<UnitQuaternion<f64>> {
    let rotation = Reading::Xyzw.world_from_body(published)?;
    Some(Order::ROS.compose(order.numbers_of(&rotation)?))
}

/// Recomposed rotations of a sensor, with the acceleration.
fn oriented<'r>(imu: &'r Imu, rows: &'r [Vec<Row>]) -> impl Iterator<Item = (UnitQuaternion<f64>, Vector3<f64>)> + 'r {
    imu.stream.rows().zip(rows.iter().flatten()).filter_map(|(timed, row)| {
        let rotation = Reading::Xyzw.world_from_body(row.slots)?;
        Some((rotation, Vector3::from(timed.row.linear_acceleration)))
    })
}

/// Whether a body would be upside down by its orientation, but not by the acceleration. An orientation with only its body in FRD
/// looks like another order of angles on flat ground: its roll of 180 degrees swaps places with its yaw.
fn contradicts_gravity(oriented: impl Iterator<Item = (UnitQuaternion<f64>, Vector3<f64>)>) -> bool {
    let (mut rows, mut body_up, mut force_up, mut force) = (0.0, 0.0, 0.0, 0.0);
    for (world_from_body, acceleration) in oriented.filter(|(_, force)| force.norm().is_finite()) {
        rows += 1.0;
        body_up += (world_from_body * Vector3::z()).z;
        force_up += (world_from_body * acceleration).z;
        force += acceleration.norm();
    }
    // Upside down, the force at rest still points up in the world.
    body_up < DOWN * rows && force_up <= -DOWN * force
}

/// The rows of a sensor with recomposed orientations.
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

    /// A level drive in circles, with this roll of the orientation and this acceleration in the body.
    fn turning(roll_rad: f64, up_m_s2: f64) -> impl Iterator<Item = (UnitQuaternion<f64>, Vector3<f64>)> {
        (0..100).map(move |row| {
            let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.1 * f64::from(row));
            let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll_rad);
            (yaw * roll, Vector3::new(0.3, -0.2, up_m_s2))
        })
    }

    #[test]
    fn only_an_upside_down_orientation_without_matching_gravity_is_contradicted() {
        let half_turn = std::f64::consts::PI;
        assert!(contradicts_gravity(turning(half_turn, 9.81)), "a body in FRD alone");
        assert!(contradicts_gravity(turning(half_turn, 0.0)), "no gravity to confirm it");
        assert!(!contradicts_gravity(turning(half_turn, -9.81)), "mounted upside down");
        assert!(!contradicts_gravity(turning(0.1, 9.81)), "level");
        assert!(!contradicts_gravity(turning(0.1, -9.81)), "all of it in NED and FRD");
    }
}
