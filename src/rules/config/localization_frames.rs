//! CONFIG03: frames of `robot_localization` that its filters reject, or with which they publish nothing.

use std::collections::BTreeMap;

use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::world::World;
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
            if let Some(drive) = second_publisher(world, settings, &frames).filter(|_| !is_off) {
                out.fail(driven(settings, &frames, drive, subject));
                continue;
            }
            if !is_off {
                publishers.insert(edge, (&settings.node, frames.place.clone()));
            }
            out.pass(subject, [Measured::count("contradictory settings", 0).limit(0.0)]);
        }
    }
}

/// A controller of ros_control that publishes the transform of a filter, too; none where another file turns one of the two off: they are variants.
fn second_publisher<'w>(
    world: &'w World,
    filter: &LocalizationSettings,
    frames: &Frames,
) -> Option<&'w LocalizationSettings> {
    let is_same = |drive: &&LocalizationSettings| {
        let or = |key: &str, default: &str| {
            let set = drive.text(key);
            set.map_or(default, |set| set.value.trim_start_matches('/')).to_owned()
        };
        let is_prefixed =
            drive.text("tf_frame_prefix").is_some() && drive.switch("tf_frame_prefix_enable") != Some(false);
        let (odom, base) = (or("odom_frame_id", "odom"), or("base_frame_id", "base_link"));
        !is_prefixed && odom == frames.world && base == frames.published_child()
    };
    let is_off = |one: &LocalizationSettings, of: &LocalizationSettings, key: &str| {
        one.node == of.node && one.switch(key) == Some(false)
    };
    let mut filters = world.localizations.iter();
    if filters.any(|other| is_off(other, filter, "publish_tf")) {
        return None;
    }
    world.drives.iter().filter(is_same).find(|drive| {
        let mut drives = world.drives.iter();
        !drives.any(|other| is_off(other, drive, "enable_odom_tf"))
    })
}

/// The finding of a filter and a controller that publish one transform.
fn driven(filter: &LocalizationSettings, frames: &Frames, drive: &LocalizationSettings, subject: String) -> Finding {
    let (odom, base) = (&frames.world, frames.published_child());
    let message = format!(
        "controller `{}` and filter `{}` both publish `{odom}` -> `{base}`",
        drive.node, filter.node
    );
    let switch = drive
        .values
        .get("enable_odom_tf")
        .or_else(|| drive.values.values().next());
    let place = switch.map_or(&frames.place, |value| &value.place).clone();
    let own = filter
        .values
        .get("publish_tf")
        .map_or(&frames.place, |value| &value.place)
        .clone();
    let default = match (filter.text("publish_tf"), drive.text("enable_odom_tf")) {
        (Some(_), Some(_)) => "",
        _ => " `publish_tf` and `enable_odom_tf` are true by default.",
    };
    let is_one_file = place.source == own.source;
    let severity = if is_one_file {
        Severity::Error
    } else {
        Severity::Warning
    };
    Finding::new(severity, subject, message, place)
        .likely()
        .label(format!("`{}`", drive.node))
        .related(own, format!("`{}`", filter.node))
        .detail(format!(
            "Listeners receive the odometry of the wheels and the estimate of the filter in turn, so the transform jumps between them.{default}"
        ))
        .help("set `enable_odom_tf: false` for the controller: the filter fuses its odometry from the topic")
        .measured(Measured::count("publishers of one transform", 2).limit(1.0))
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
