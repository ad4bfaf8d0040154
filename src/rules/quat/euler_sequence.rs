//! QUAT03: Euler angles that match another source's rotation, or the gyro, only when composed in another order.

use nalgebra::{Isometry3, UnitQuaternion};

use crate::advice::{literal::with_fix, restate::restated};
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::cross::angles::{Limits, OrderMatch, Unit};
use crate::analysis::cross::pair::{Pair, Statement};
use crate::analysis::motion::{Imu, Motion};
use crate::analysis::{axes::causes::Turn, cross::angles, cross::statements::pairs, quat::by_gyro::GyroOrder};
use crate::math::euler::Order;
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::verdict::Safety;
use crate::world::{Claim, World};

pub(crate) struct EulerSequence;

impl Rule for EulerSequence {
    const NEEDS: &'static [Need] = &[Need::TransformsOrBag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for pair in pairs(world, out) {
            if pair.reference.rpy.is_some() || pair.other.rpy.is_some() {
                judge_pair(world, &pair, limits, out);
            }
        }
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            judge_sensor(imu, sensor, out);
        }
    }
}

fn judge_pair(world: &World, pair: &Pair, limits: &Limits, out: &mut Judge) {
    let subject = format!("angles of {}", pair.subject(world));
    if let Some(why) = &pair.repeats {
        return out.not_applicable(subject, why);
    }
    if !pair.reference.has_rotation || !pair.other.has_rotation {
        return out.not_applicable(subject, "one of the two states no rotation");
    }
    let apart_deg = pair.classify().angle_rad.to_degrees();
    if apart_deg <= limits.equal_deg {
        let measured = Measured::new("rotation difference", apart_deg, "deg")
            .turn()
            .limit(limits.equal_deg);
        return out.pass(subject, [measured]);
    }
    if let Some(found) = angles::explained(pair, limits) {
        let finding = finding(world, pair, subject, &found, limits);
        return out.fail(pair.point_at_all(finding));
    }
    let stated = [pair.reference.rpy, pair.other.rpy];
    if !stated
        .into_iter()
        .flatten()
        .any(|rpy| angles::is_distinctive(rpy, limits))
    {
        let why = format!(
            "fewer than two of the angles are more than {} deg off the axes, so another order cannot be distinguished from a rotation by \
             90 deg",
            limits.off_axis_deg
        );
        return out.too_little(subject, why);
    }
    let why = format!("the rotations differ by {apart_deg:.2} deg, and no other order of the angles explains that");
    out.not_applicable(subject, why);
}

fn finding(world: &World, pair: &Pair, subject: String, found: &OrderMatch, limits: &Limits) -> Finding {
    let (angles, against): (&Statement, &Statement) = if found.of_other {
        (&pair.other, &pair.reference)
    } else {
        (&pair.reference, &pair.other)
    };
    let unit = match found.unit {
        Unit::Right => "",
        Unit::Degrees => " and in degrees",
        Unit::Radians => " and in radians",
    };
    let relation = word(found);
    let message = if relation == "ypr" {
        format!(
            "{} and {} have roll and yaw exchanged ({:.2} deg apart)",
            angles.who, against.who, found.apart_deg
        )
    } else {
        format!(
            "Euler angles of {} match {} only in another order ({:.2} deg apart)",
            angles.who, against.who, found.apart_deg
        )
    };
    let [roll, pitch, yaw] = found.rpy;
    let detail = format!(
        "Of {}, ROS reads roll {roll:.6}, pitch {pitch:.6}, yaw {yaw:.6} rad and composes {}. Composed as {}{unit}, the angles match {} to \
         {:.3} deg.{}",
        angles.who,
        Order::ROS.product(),
        found.order.product(),
        against.who,
        found.left_deg,
        also(&found.alike),
    );
    let claim = angles.claim(world);
    let change = format!("write {}", written(world, angles, &found.meant));
    let as_read = Order::ROS.compose(found.rpy);
    let help = if found.unit == Unit::Right {
        let as_stated = if against.direction == angles.direction {
            as_read
        } else {
            as_read.inverse()
        };
        format!(
            "change the wrong one of the two:\n(1) if {} is right, {change}\n(2) if {} is right, write {}",
            against.who,
            angles.who,
            written(world, against, &as_stated)
        )
    } else {
        change
    };
    let is_sure = found.alike.is_empty() && pair.reading() >= Confidence::Certain;
    let edits = claim.filter(|claim| is_sure && claim.is_published()).and_then(|claim| {
        let translation = claim.pose?.isometry().translation;
        restated(world, claim, &Isometry3::from_parts(translation, found.meant))
    });
    let finding = Finding::error(subject, message, pair.other.place.clone());
    with_fix(
        finding,
        &format!("make {} agree with {}, if the latter is right", angles.who, against.who),
        Safety::ChangesBehaviour,
        edits,
    )
    .detail(detail)
    .help(help)
    .relation(relation)
    .measured(
        Measured::new("rotation difference", found.apart_deg, "deg")
            .turn()
            .limit(limits.equal_deg),
    )
    .measured(
        Measured::new(
            "rotation difference left in the other order",
            rounded(found.left_deg),
            "deg",
        )
        .limit(limits.left_deg),
    )
}

/// The numbers that a statement needs for a rotation, in its own form.
fn written(world: &World, statement: &Statement, turn: &UnitQuaternion<f64>) -> String {
    let (who, q) = (&statement.who, turn.coords);
    match Order::ROS.numbers_of(turn).filter(|_| statement.rpy.is_some()) {
        Some([roll, pitch, yaw]) if statement.claim(world).is_some_and(Claim::is_published) => format!(
            "yaw, pitch, roll {yaw:.6} {pitch:.6} {roll:.6} rad for {who} (the argument order of static_transform_publisher)"
        ),
        Some([roll, pitch, yaw]) => format!("roll, pitch, yaw {roll:.6} {pitch:.6} {yaw:.6} rad for {who}"),
        None => format!(
            "the rotation x y z w = {:.6} {:.6} {:.6} {:.6} for {who}",
            q.x, q.y, q.z, q.w
        ),
    }
}

/// The word of the relation dictionary, if it has one for this order.
fn word(found: &OrderMatch) -> String {
    let word = found.order.word();
    let own = match (word.as_str(), found.of_other) {
        ("euler-xyz", true) => "rpy-fixed".to_owned(),
        ("euler-xyz", false) => "rpy-rotating".to_owned(),
        ("euler-zyx-roll-pitch-yaw", _) => "ypr".to_owned(),
        _ => word,
    };
    match found.unit {
        Unit::Right => own,
        Unit::Degrees => format!("{own}-degrees"),
        Unit::Radians => format!("{own}-radians"),
    }
}

/// Some of the orders that cannot be distinguished from the named one.
fn also(alike: &[Order]) -> String {
    let products: Vec<String> = alike.iter().take(2).map(|order| order.product()).collect();
    match alike.len() {
        0 => String::new(),
        more if more > products.len() => {
            let rest = more - products.len();
            format!(" Indistinguishable here: {} and {rest} more.", products.join(", "))
        }
        _ => format!(" Indistinguishable here: {}.", products.join(", ")),
    }
}

/// Rounds to zero what differs between machines.
fn rounded(left_deg: f64) -> f64 {
    if left_deg < 1e-6 { 0.0 } else { left_deg }
}

fn judge_sensor(imu: &Imu, sensor: &Sensor, out: &mut Judge) {
    let subject = format!("angles behind the orientation of {}", imu.stream.subject);
    let turned = match &sensor.turn {
        Ok(turned) => turned,
        Err((why, reason)) => return out.not_evaluated(subject, *why, reason),
    };
    match (&turned.ordered, turned.class) {
        (Some(ordered), _) => out.fail(of_sensor(imu, subject, ordered)),
        (None, Turn::Agree | Turn::Tilting) if turned.shows_order() => {
            let [x, y, z] = turned.correlations().map(|value| value.unwrap_or(f64::NAN));
            let least = x.min(y).min(z);
            let measured = Measured::new("lowest correlation of an axis with the gyro", least, "1");
            out.pass(subject, [measured]);
        }
        (None, Turn::Agree | Turn::Tilting) => {
            let [x, y, z] = turned.rates_deg_s();
            let why = format!(
                "it rotates about one axis alone ({x:.1}, {y:.1} and {z:.1} deg/s about x, y and z), so another order of its angles would \
                 not show"
            );
            out.too_little(subject, why);
        }
        (None, _) => {
            out.not_applicable(
                subject,
                "it does not follow the gyro, and no order of its angles explains that",
            );
        }
    }
}

fn of_sensor(imu: &Imu, subject: String, ordered: &GyroOrder) -> Finding {
    let product = ordered.order.product();
    let message = format!(
        "`{}`: quaternion is composed as {product}, {:.0} % off the gyro",
        imu.stream.topic,
        100.0 * ordered.as_published
    );
    let detail = format!(
        "As published, the rotation differs from the gyro's by {:.1} % of it; recomposed as {}, by {:.1} %.{}",
        100.0 * ordered.as_published,
        Order::ROS.product(),
        100.0 * ordered.residual,
        also(&ordered.alike),
    );
    let help = format!(
        "compose the quaternion as {} in the driver (tf2 `setRPY(roll, pitch, yaw)`; scipy `from_euler('ZYX', [yaw, pitch, roll])`)",
        Order::ROS.product()
    );
    let error = |how: &str, share| {
        Measured::new(
            format!("error of the rotation / rotation of the gyro, {how}"),
            share,
            "1",
        )
    };
    Finding::error(subject, message, imu.stream.place())
        .likely()
        .detail(detail)
        .help(help)
        .relation(ordered.order.word())
        .measured(error("as published", ordered.as_published).samples(ordered.windows))
        .measured(error("in the order of ROS", ordered.residual).samples(ordered.windows))
        .measured(error("in the next best order", ordered.next))
}
