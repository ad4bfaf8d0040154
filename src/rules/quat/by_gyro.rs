//! The order of angles behind a quaternion, found by the gyro: taken apart in the right order, and put together as ROS does,
//! the orientation is the integral of the gyro.
//!
//! Owns the search. Must not word a finding.

use crate::math::euler::Order;
use crate::math::readings::Reading;
use crate::math::turns::{Options, Row, Turns, turns};
use crate::rules::motion::Imu;

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

/// How much better an order must be than what was published, and than the orders that are not the same.
pub(super) struct Margins {
    /// A residual up to this is an agreement.
    pub(super) agrees: f64,
    pub(super) ratio: f64,
    /// Residuals below are not compared.
    pub(super) noise: f64,
}

/// Length of the windows, seconds; as for QUAT01.
const WINDOW_S: f64 = 0.5;
/// Two orders whose residuals differ by less than this factor cannot be told apart.
const ALIKE: f64 = 1.5;

/// The order of angles that the quaternions of a sensor were made in, if the gyro shows one.
pub(super) fn ordered(imu: &Imu, as_published: f64, margins: &Margins) -> Option<Ordered> {
    let mut tried: Vec<(Order, Turns, f64)> = candidates()
        .filter_map(|order| {
            let turns = turns(&mended(imu, order), &Options::new(WINDOW_S))?;
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

/// The rows of a sensor with the orientation that it would have, had its angles been put together as ROS does.
fn mended(imu: &Imu, order: Order) -> Vec<Vec<Row>> {
    let slots = |published: [f64; 4]| -> [f64; 4] {
        let mended = Reading::Xyzw
            .world_from_body(published)
            .and_then(|rotation| order.numbers_of(&rotation))
            .map(|numbers| Order::ROS.compose(numbers).coords);
        mended.map_or([f64::NAN; 4], |q| [q.x, q.y, q.z, q.w])
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
