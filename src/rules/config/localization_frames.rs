//! CONFIG03: frames of `robot_localization` that its filters reject, or with which they publish nothing.

use std::collections::BTreeMap;

use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::world::launch::LocalizationSettings;

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
            let is_off = settings.text("publish_tf").is_some_and(|value| value.value == "false");
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
            if !is_off {
                publishers.insert(edge, (&settings.node, frames.place.clone()));
            }
            out.pass(subject, [Measured::count("contradictory settings", 0).limit(0.0)]);
        }
    }
}

/// The frames of a filter, with defaults.
struct Frames {
    map: String,
    odom: String,
    base: String,
    world: String,
    place: Place,
}

impl Frames {
    /// `None` if no frame is set: then it is no filter, or has defaults only.
    fn of(settings: &LocalizationSettings) -> Option<Self> {
        let keys = ["world_frame", "map_frame", "odom_frame", "base_link_frame"];
        let place = keys.iter().find_map(|key| Some(settings.text(key)?.place.clone()))?;
        let or = |key: &str, default: &str| {
            let set = settings.text(key);
            set.map_or(default, |set| set.value.trim_start_matches('/')).to_owned()
        };
        let odom = or("odom_frame", "odom");
        Some(Self {
            map: or("map_frame", "map"),
            base: or("base_link_frame", "base_link"),
            world: or("world_frame", &odom),
            odom,
            place,
        })
    }

    /// The frame that the filter publishes below its world frame.
    fn published_child(&self) -> &str {
        if self.world == self.map { &self.odom } else { &self.base }
    }

    fn fault(&self, settings: &LocalizationSettings, subject: &str) -> Option<Finding> {
        let place = |key: &str| settings.text(key).map_or(&self.place, |value| &value.place).clone();
        let pairs = [
            ("map_frame", &self.map, "odom_frame", &self.odom),
            ("odom_frame", &self.odom, "base_link_frame", &self.base),
            ("map_frame", &self.map, "base_link_frame", &self.base),
        ];
        if let Some((one, frame, other, _)) = pairs.iter().find(|(_, a, _, b)| a == b) {
            let message = format!(
                "`{one}` and `{other}` of `{}` are both `{frame}`: the filter does not start",
                settings.node
            );
            let finding = Finding::error(subject, message, place(other));
            return Some(finding.help("set three different frames for map, odom and base_link (REP-105)"));
        }
        if self.world != self.map && self.world != self.odom {
            let message = format!(
                "`world_frame` of `{}` is `{}`, neither its map frame nor its odom frame",
                settings.node, self.world
            );
            let detail = format!(
                "The map frame is `{}`, the odom frame `{}`. With another world frame the filter publishes no transform.",
                self.map, self.odom
            );
            return Some(Finding::error(subject, message, place("world_frame")).detail(detail).help(format!(
                "set `world_frame` to `{}` for a filter with continuous odometry, to `{}` for a filter with absolute positions",
                self.odom, self.map
            )));
        }
        None
    }
}
