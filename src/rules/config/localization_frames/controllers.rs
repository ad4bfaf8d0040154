//! Controllers of ros_control that publish what a filter publishes.

use crate::rules::prelude::*;
use crate::world::World;
use crate::world::launch::LocalizationSettings;

use super::frames::Frames;

/// A controller of ros_control that publishes the transform of a filter, too; none where another file turns one of the two off: they are variants.
pub(super) fn second_publisher<'w>(
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
pub(super) fn driven(
    filter: &LocalizationSettings,
    frames: &Frames,
    drive: &LocalizationSettings,
    subject: String,
) -> Finding {
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
