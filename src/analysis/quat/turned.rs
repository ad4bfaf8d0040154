//! Whether an orientation is the integral of its gyro.

use crate::analysis::quat::by_gyro::{GyroOrder, Margins, ordered};
use crate::analysis::quat::ways::{GyroAgreement, Limits, WindowScores};
use crate::analysis::{axes::causes::Turn, look::Estimate, motion::Imu};
use crate::verdict::NotEvaluated;

/// The rotation of the orientation compared with the gyro.
pub(crate) fn look(imu: &Imu, limits: &Limits) -> Estimate<GyroAgreement> {
    if let Some(why) = imu.no_orientation {
        return Err((NotEvaluated::NotApplicable, why.to_owned()));
    }
    let little = |reason: String| Err((NotEvaluated::TooLittleEvidence, reason));
    let Some(fast) = imu.inertial.turns.as_ref().and_then(WindowScores::of) else {
        return little("no gap-free second with both orientation and angular velocity".to_owned());
    };
    if fast.turns.step_s > limits.max_step_s {
        return little(format!(
            "one message every {:.2} s is too slow to integrate a gyro, {} s are needed",
            fast.turns.step_s, limits.max_step_s
        ));
    }
    // A gyro in another unit is reported by AXES02; it hides whether the senses agree.
    let gain = fast.as_published.gain.abs().max(fast.inverse.gain.abs());
    if !(0.5..=2.0).contains(&gain) && fast.follows() > 0.9 {
        return little(format!(
            "the orientation rotates {gain:.3} times as far as its gyro, so the gyro is in another unit"
        ));
    }
    let slow = imu.inertial.slow_turns.as_ref().and_then(WindowScores::of);
    let turns_enough = |ways: &WindowScores| ways.rotation_deg() >= limits.min_rotation_deg;
    let order = turns_enough(&fast).then(|| fast_order(imu, &fast, limits)).flatten();
    if let Some(order) = order.as_ref().filter(|order| fast.are_worse(order.residual, limits)) {
        return Ok(GyroAgreement {
            ordered: Some(order.clone()),
            ..fast.found(Turn::Ordered, None, limits)
        });
    }
    let by_ratio = Some(&fast).filter(|ways| turns_enough(ways)).and_then(|ways| {
        let class = ways.by_ratio(limits)?;
        let axis = fast.axis(class, limits).ok()?;
        Some(GyroAgreement {
            // A simpler fault takes precedence over an order of angles.
            ordered: order.filter(|_| matches!(class, Turn::Agree | Turn::Tilting)),
            ..ways.found(class, axis, limits)
        })
    });
    let by_gap = || {
        let ways = slow.as_ref().filter(|ways| turns_enough(ways))?;
        let class = ways.by_gap(limits)?;
        // With as much noise as rotation in short windows, the result of two or three long ones may be chance.
        if ways.covers_little(limits) && fast.explains(class) > limits.slow_short {
            return None;
        }
        // Noise in short windows proves nothing about an axis.
        let axis = fast.axis(class, limits).ok()?;
        axis.is_none().then(|| ways.found(class, None, limits))
    };
    if let Some(turned) = by_ratio.or_else(by_gap) {
        return Ok(turned);
    }
    if !turns_enough(&fast) && !slow.as_ref().is_some_and(turns_enough) {
        return little(format!(
            "it rotates by only {:.1} deg while the gyro is recorded, {} deg are needed",
            fast.rotation_deg(),
            limits.min_rotation_deg
        ));
    }
    let is_unexplained = || slow.as_ref().is_some_and(|slow| fast.is_unexplained(slow, limits));
    if fast.is_unrelated(slow.as_ref(), limits) || is_unexplained() {
        return Ok(fast.found(Turn::Unrelated, None, limits));
    }
    little(fast.unclear(limits))
}

/// An orientation that hardly rotates although its gyro does; for a gyro that something else confirms.
pub(crate) fn still(imu: &Imu, limits: &Limits) -> Option<GyroAgreement> {
    let fast = imu.inertial.turns.as_ref().and_then(WindowScores::of)?;
    let is_still = imu.no_orientation.is_none() && fast.is_still(limits);
    is_still.then(|| fast.found(Turn::Unrelated, None, limits))
}

/// The order of the angles behind the orientation, if it is another one. The search is expensive and reliable, so it runs only when
/// something indicates a fault.
pub(crate) fn fast_order(imu: &Imu, fast: &WindowScores, limits: &Limits) -> Option<GyroOrder> {
    let own = fast.as_published.residual;
    let margins = Margins {
        agrees: limits.agrees,
        ratio: limits.ratio,
        noise: limits.noise,
    };
    let is_odd = own > limits.unrelated || fast.has_odd_axis(limits);
    (is_odd && !fast.is_simpler(limits))
        .then(|| ordered(imu, own, &margins))
        .flatten()
}
