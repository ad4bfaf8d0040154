//! The wheels of a robot and the ground of its `base_footprint`.

use crate::analysis::tree::footprint::{Limits, mounts};
use crate::analysis::tree::wheels::standing;
use crate::rules::prelude::*;
use crate::world::{FrameId, World};

/// Compares the lowest points of the wheels with the ground of the footprint.
pub(super) fn judge(
    world: &World,
    footprint: &FrameId,
    base: &FrameId,
    limits: &Limits,
    measured: &mut Vec<Measured>,
    findings: &mut Vec<Finding>,
) {
    let wheels = standing(world, footprint, limits.same_wheels_m);
    let Some(lowest) = wheels.first() else { return };
    let (low_m, mount) = (lowest.lowest_m(), mounts(world, footprint, base).into_iter().next());
    let height = Measured::new(
        "height of the lowest point of the wheels above the footprint",
        low_m,
        "m",
    )
    .limit(limits.max_ground_m)
    .samples(wheels.len() as u64);
    measured.push(height.clone());
    if low_m.abs() <= limits.max_ground_m {
        return;
    }
    let side = if low_m < 0.0 { "below" } else { "above" };
    let message = format!(
        "the wheels end {:.3} m {side} `{footprint}`, which is on the ground",
        low_m.abs()
    );
    let names: Vec<String> = wheels
        .iter()
        .map(|wheel| format!("`{}`", wheel.link.name.value))
        .collect();
    let place = mount.as_ref().map_or(&lowest.link.place, |mount| &mount.place);
    let mut finding = Finding::warning(super::subject(footprint), message, place.clone())
        .likely()
        .detail(format!("Measured at {}, with all joints at zero.", names.join(", ")))
        .measured(height);
    let wheel_is_wrong = "if the height of the base is right, correct the radius or z of the wheels";
    if let Some(mount) = mount {
        let base_m = -mount.below_m - low_m;
        finding = finding
            .related(lowest.link.place.clone(), "the lowest wheel")
            .help(format!(
                "measure the height of the wheels' axis, then:\n\
             (1) if the wheels are right, set z of `{base}` in `{footprint}` to {base_m:.3}\n(2) {wheel_is_wrong}"
            ));
    } else {
        finding = finding.help(wheel_is_wrong);
    }
    findings.push(finding);
}
