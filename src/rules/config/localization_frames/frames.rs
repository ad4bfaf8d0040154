//! The frames of a filter of `robot_localization`, and what it rejects.

use crate::rules::prelude::*;
use crate::world::launch::LocalizationSettings;

/// The frames of a filter, with defaults.
pub(super) struct Frames {
    pub(super) map: String,
    pub(super) odom: String,
    base: String,
    pub(super) world: String,
    pub(super) place: Place,
}

impl Frames {
    /// `None` if no frame is set: then it is no filter, or has defaults only.
    pub(super) fn of(settings: &LocalizationSettings) -> Option<Self> {
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
    pub(super) fn published_child(&self) -> &str {
        if self.world == self.map { &self.odom } else { &self.base }
    }

    pub(super) fn fault(&self, settings: &LocalizationSettings, subject: &str) -> Option<Finding> {
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
