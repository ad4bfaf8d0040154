//! PREC03: coordinates far from zero, where a local origin is missing.

use nalgebra::Vector3;

use crate::analysis::geo::kinds::single_precision_step_m;
use crate::analysis::lidar::Clouds;
use crate::rules::prelude::*;

pub(crate) struct LocalOrigin;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    far_m: f64,
}

/// Proposed origins are multiples of this, metres.
const TILE_M: f64 = 1000.0;

impl Rule for LocalOrigin {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for clouds in Clouds::published(world) {
            judge_clouds(&clouds, limits, out);
        }
    }
}

fn judge_clouds(clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("origin of the points");
    let points = || clouds.evidence.samples.iter().flat_map(|sample| &sample.points);
    let Some((_, farthest_m)) = clouds.evidence.farthest.as_ref().filter(|_| points().next().is_some()) else {
        return out.too_little(subject, "no cloud has a point");
    };
    let measured = Measured::new("largest coordinate", *farthest_m, "m").limit(limits.far_m);
    if *farthest_m <= limits.far_m {
        return out.pass(subject, [measured]);
    }
    let count = points().count() as f64;
    let middle = points().map(|point| Vector3::from(point.xyz)).sum::<Vector3<f64>>() / count;
    let origin = middle.map(|value| (value / TILE_M).round() * TILE_M);
    let message = format!(
        "`{}`: points have coordinates up to {:.1} km, where float32 steps by {:.2} m",
        clouds.topic.topic,
        farthest_m / 1e3,
        single_precision_step_m(*farthest_m)
    );
    let frame = clouds
        .frame()
        .map_or_else(|| "map".to_owned(), |frame| frame.to_string());
    out.fail(
        Finding::note(subject, message, clouds.place())
            .help(format!(
                "subtract ({:.0}, {:.0}, {:.0}) m before the conversion to float32, name the frame of the points `{frame}_local`, and publish `{frame}` -> `{frame}_local` with that translation",
                origin.x, origin.y, origin.z
            ))
            .measured(measured),
    );
}
