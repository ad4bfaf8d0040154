//! CONFIG03: frames of `robot_localization` that its filters reject, or with which they publish nothing.

mod controllers;
mod frames;

use std::collections::BTreeMap;

use crate::rules::prelude::*;
use crate::source::SourceId;

use frames::Frames;

pub(crate) struct LocalizationFrames;

impl Rule for LocalizationFrames {
    const NEEDS: &'static [Need] = &[];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut publishers: BTreeMap<(SourceId, String, String), (&str, Place)> = BTreeMap::new();
        for settings in &world.localizations {
            let Some(frames) = Frames::of(settings) else { continue };
            let source = frames.place.source;
            let subject = format!("frames of `{}` of {}", settings.node, world.path(source));
            if let Some(finding) = frames.fault(settings, &subject) {
                out.fail(finding.measured(Measured::count("contradictory settings", 1).limit(0.0)));
                continue;
            }
            let is_off = settings.switch("publish_tf") == Some(false);
            let edge = (source, frames.world.clone(), frames.published_child().to_owned());
            if let Some((other, place)) = publishers.get(&edge).filter(|_| !is_off) {
                let message = format!(
                    "filters `{other}` and `{}` both publish `{}` -> `{}`",
                    settings.node, edge.1, edge.2
                );
                let (free, what) = if frames.world == frames.map {
                    (&frames.odom, "continuous odometry")
                } else {
                    (&frames.map, "absolute positions")
                };
                let finding = Finding::error(subject, message, frames.place.clone())
                    .likely()
                    .label(format!("`{}`", settings.node))
                    .related(place.clone(), format!("`{other}`"))
                    .detail("Listeners receive both estimates in turn, so the transform jumps between them.")
                    .help(format!(
                        "set `world_frame: {free}` for the filter with {what}, or `publish_tf: false` for one of the two filters"
                    ));
                out.fail(finding.measured(Measured::count("filters for one transform", 2).limit(1.0)));
                continue;
            }
            if let Some(drive) = controllers::second_publisher(world, settings, &frames).filter(|_| !is_off) {
                out.fail(controllers::driven(settings, &frames, drive, subject));
                continue;
            }
            if !is_off {
                publishers.insert(edge, (&settings.node, frames.place.clone()));
            }
            out.pass(subject, [Measured::count("contradictory settings", 0).limit(0.0)]);
        }
    }
}
