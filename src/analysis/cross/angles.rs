//! Whether the three angles of one statement give the rotation of the other when they are composed in another order.
//!
//! Owns the search and its margins. Must not word a finding: CROSS01 and CROSS02 defer to QUAT03 for such a pair.

use nalgebra::{Isometry3, UnitQuaternion};
use serde::Deserialize;

use crate::analysis::cross::blame::either_way;
use crate::analysis::cross::pair::{Direction, Pair, Statement};
use crate::math::relation::{Relation, Tolerance};
use crate::math::{euler::Order, rotation::rotation_angle_between};

/// The limits of the search, from QUAT03's page.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Rotations within this are equal, degrees.
    pub(crate) equal_deg: f64,
    /// Largest residual of an order, degrees.
    pub(crate) left_deg: f64,
    /// ... and as a share of the difference.
    pub(crate) left_share: f64,
    /// How far from multiples of 90 degrees an angle counts, degrees.
    pub(crate) off_axis_deg: f64,
}

/// The unit of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unit {
    /// As they were read.
    Right,
    /// Degrees that were read as radians.
    Degrees,
    /// Radians that were read as degrees.
    Radians,
}

impl Unit {
    /// Radians, of an angle that was read as radians.
    fn radians(self, angle: f64) -> f64 {
        match self {
            Self::Right => angle,
            Self::Degrees => angle.to_radians(),
            Self::Radians => angle.to_degrees(),
        }
    }
}

/// An order that explains a difference.
#[derive(Clone, Debug)]
pub(crate) struct OrderMatch {
    /// The simplest that fits.
    pub(crate) order: Order,
    pub(crate) unit: Unit,
    /// Others that give the same rotation.
    pub(crate) alike: Vec<Order>,
    /// Its residual, degrees.
    pub(crate) left_deg: f64,
    /// The difference as stated, degrees.
    pub(crate) apart_deg: f64,
    /// Whether the angles are those of the pair's other statement, not of its reference.
    pub(crate) of_other: bool,
    /// The angles as read.
    pub(crate) rpy: [f64; 3],
    /// The rotation of the statement that has no such angles, in the direction of these.
    pub(crate) meant: UnitQuaternion<f64>,
}

/// The order of the angles that explains the difference of a pair, where one does and nothing simpler does.
pub(crate) fn explained(pair: &Pair, limits: &Limits) -> Option<OrderMatch> {
    let found = [true, false].into_iter().find_map(|of_other| {
        let (angles, against) = if of_other {
            (&pair.other, &pair.reference)
        } else {
            (&pair.reference, &pair.other)
        };
        let (own, meant) = both(pair, angles, against)?;
        search(angles.rpy?, &own, &meant, limits).map(|found| OrderMatch { of_other, ..found })
    })?;
    // Where a simpler relation fits as well, the pair stays with CROSS02.
    let word = either_way(pair).map_or_else(|| pair.classify(), |either| either.classification);
    let is_order = |relation| matches!(relation, Relation::RpyRotating | Relation::RpyFixed | Relation::Ypr);
    let simpler = word.error().is_some_and(|relation| !is_order(relation))
        && word.residual_angle_rad.to_degrees() <= limits.left_deg;
    (!simpler).then_some(found)
}

/// Both transforms in the direction in which the angles are stated, where they differ in rotation alone.
fn both(pair: &Pair, angles: &Statement, against: &Statement) -> Option<(Isometry3<f64>, Isometry3<f64>)> {
    angles.rpy?;
    if !angles.has_rotation || !against.has_rotation {
        return None;
    }
    // The other statement was brought to the reference's direction.
    let turn = |pose: Isometry3<f64>| match angles.direction {
        Direction::TurnedRound => pose.inverse(),
        Direction::AsStated => pose,
    };
    let (own, meant) = (turn(angles.pose), turn(against.pose));
    let tolerance = Tolerance::default();
    let (a, b) = (own.translation.vector, meant.translation.vector);
    let allowed_m = tolerance.distance_m + tolerance.relative_distance * a.norm().max(b.norm());
    let halves = !(pair.reference.has_translation && pair.other.has_translation);
    (halves || (a - b).norm() <= allowed_m).then_some((own, meant))
}

/// Whether an angle, radians, is away from every multiple of 90 degrees.
fn is_off_axis(angle: f64, limits: &Limits) -> bool {
    let degrees = angle.to_degrees();
    (degrees - 90.0 * (degrees / 90.0).round()).abs() > limits.off_axis_deg
}

/// Whether another order of these angles would show: two of them are off the axes.
pub(crate) fn is_distinctive(rpy: [f64; 3], limits: &Limits) -> bool {
    rpy.iter().filter(|angle| is_off_axis(**angle, limits)).count() >= 2
}

fn search(rpy: [f64; 3], own: &Isometry3<f64>, meant: &Isometry3<f64>, limits: &Limits) -> Option<OrderMatch> {
    let apart_deg = rotation_angle_between(&own.rotation, &meant.rotation).to_degrees();
    if apart_deg.is_nan() || apart_deg <= limits.equal_deg {
        return None;
    }
    [Unit::Right, Unit::Degrees, Unit::Radians]
        .into_iter()
        .find_map(|unit| {
            let numbers = rpy.map(|angle| unit.radians(angle));
            if !is_distinctive(numbers, limits) {
                return None;
            }
            let left = |order: &Order| rotation_angle_between(&order.compose(numbers), &meant.rotation).to_degrees();
            let allowed = limits.left_deg.min(limits.left_share * apart_deg);
            let fits: Vec<(Order, f64)> = Order::all()
                .into_iter()
                .map(|order| (order, left(&order)))
                .filter(|(_, left)| *left <= allowed)
                .collect();
            let (first, others) = fits.split_first()?;
            // The order of ROS in another unit is CROSS02's.
            (first.0 != Order::ROS).then(|| OrderMatch {
                order: first.0,
                unit,
                alike: others.iter().map(|(order, _)| *order).collect(),
                left_deg: first.1,
                apart_deg,
                of_other: false,
                rpy,
                meant: meant.rotation,
            })
        })
}
