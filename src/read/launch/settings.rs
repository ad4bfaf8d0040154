//! Which settings of `robot_localization` are kept: those about frames and headings.

use std::collections::BTreeMap;

use crate::source::SourceValue;
use crate::world::launch::LocalizationSettings;

/// Settings of its filters and of `navsat_transform_node`.
const KEPT: [&str; 11] = [
    "map_frame",
    "odom_frame",
    "base_link_frame",
    "world_frame",
    "publish_tf",
    "magnetic_declination_radians",
    "yaw_offset",
    "datum",
    "use_odometry_yaw",
    "wait_for_datum",
    "zero_altitude",
];

/// The settings of a node; `None` where none of them is kept.
pub(super) fn of(
    node: String,
    values: impl IntoIterator<Item = (String, SourceValue<String>)>,
) -> Option<LocalizationSettings> {
    let kept = |key: &String| KEPT.contains(&key.as_str());
    let values: BTreeMap<_, _> = values.into_iter().filter(|(key, _)| kept(key)).collect();
    (!values.is_empty()).then_some(LocalizationSettings { node, values })
}
