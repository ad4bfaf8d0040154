//! ROT07: a sensor with an identity mounting transform, or with that of another sensor.

use nalgebra::Isometry3;

use crate::advice::tally::Tally;
use crate::analysis::rot::sensors::{Copies, Mounting, mountings};
use crate::rules::prelude::*;
use crate::world::World;

pub(crate) struct IdentityOrPlaceholder;

impl Rule for IdentityOrPlaceholder {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut right = Tally::new("sensor mountings");
        let all = mountings(world);
        // Only the earlier ones: of a pair of copies the later one is reported.
        let mut earlier = Copies::default();
        for mounting in &all {
            let copied_from = (!mounting.is_identity()).then(|| earlier.copied(mounting)).flatten();
            if mounting.is_identity() {
                out.fail(identity(world, mounting));
            } else if let Some(original) = copied_from {
                out.fail(copy(world, mounting, original));
            } else {
                right.pass(mounting.place.source, measured(&mounting.parent_from_sensor));
            }
        }
        right.report(world, out);
    }
}

fn measured(parent_from_sensor: &Isometry3<f64>) -> Measured {
    Measured::new(
        "distance of the sensor from its parent",
        parent_from_sensor.translation.vector.norm(),
        "m",
    )
}

fn identity(world: &World, mounting: &Mounting) -> Finding {
    let how = if mounting.is_unstated {
        "it has no `<origin>`, which means identity"
    } else {
        "the transform is the identity"
    };
    let message = format!(
        "`{}` is mounted exactly at `{}`: {how}",
        mounting.sensor, mounting.parent
    );
    Finding::warning(subject(world, mounting), message, mounting.place.clone())
        .hint()
        .label("identity")
        .help(format!(
            "write the measured mounting transform; if the two frames coincide by design, accept it in frames-lint.yaml: \
             `waivers: [{{rule: {}, subject: '*{}*', reason: ...}}]`",
            codes::ROT07, mounting.sensor
        ))
        .measured(measured(&mounting.parent_from_sensor))
}

fn copy(world: &World, mounting: &Mounting, original: &Mounting) -> Finding {
    let message = format!(
        "`{}` is mounted on `{}` exactly where `{}` is",
        mounting.sensor, mounting.parent, original.sensor
    );
    Finding::warning(subject(world, mounting), message, mounting.place.clone())
        .hint()
        .label("a copy?")
        .detail("Two sensors of one kind cannot be in the same place: the numbers were probably copied.")
        .help("write the measured mounting transform of this sensor")
        .related(original.place.clone(), "the same numbers")
        .measured(measured(&mounting.parent_from_sensor))
}

fn subject(world: &World, mounting: &Mounting) -> String {
    format!(
        "`{}` from `{}` of {}",
        mounting.parent,
        mounting.sensor,
        world.path(mounting.place.source)
    )
}
