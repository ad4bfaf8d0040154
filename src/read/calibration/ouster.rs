//! Metadata of Ouster sensors: what they state besides transforms.
//!
//! Owns their keys. Firmware up to 2.x writes them side by side ("legacy"), later ones in parts (`beam_intrinsics`,
//! `sensor_info`, ...); a key means the same in both. Sources: ouster-sdk metadata.cpp; `lidar_frame_azimuth_offset` in millidegrees,
//! 0 to 360000 (its Python binding and its bounds).

use crate::source::{Place, SourceId};
use crate::world::OusterMetadata;
use crate::world::ouster::{Angles, PlacedNumber};

use super::document::Node;

/// Keys that only such metadata have.
const OWN: &[&str] = &[
    "lidar_to_sensor_transform",
    "imu_to_sensor_transform",
    "lidar_origin_to_beam_origin_mm",
    "beam_to_lidar_transform",
    "beam_altitude_angles",
];
/// How deep the parts may be nested.
const MAX_DEPTH: usize = 4;

/// Whether a text may be such metadata: published texts of other kinds are not parsed.
pub fn may_be_ouster(text: &str) -> bool {
    text.trim_start().starts_with('{') && OWN.iter().any(|key| text.contains(key))
}

/// The content of a document, if it is metadata of an Ouster.
pub(super) fn collect(root: &Node, source: SourceId) -> Option<OusterMetadata> {
    if !OWN.iter().any(|key| find(root, key, MAX_DEPTH).is_some()) {
        return None;
    }
    let text = |key: &str| {
        let text = find(root, key, MAX_DEPTH)?.text()?.trim();
        (!text.is_empty()).then(|| text.to_owned())
    };
    let stated = |key: &str| {
        let node = find(root, key, MAX_DEPTH)?;
        let value = node.text()?.trim().parse().ok()?;
        Some(PlacedNumber {
            value,
            place: Place::text(source, node.span),
        })
    };
    let count = |key: &str| find(root, key, MAX_DEPTH)?.text()?.trim().parse().ok();
    let angles = |key: &str| {
        let node = find(root, key, MAX_DEPTH)?;
        Some(angles(node, node.items()?, source))
    };
    Some(OusterMetadata {
        place: Place::text(source, root.span),
        product: text("prod_line"),
        image: text("image_rev"),
        firmware: text("build_rev"),
        serial: text("prod_sn"),
        beam_origin_mm: stated("lidar_origin_to_beam_origin_mm"),
        azimuth_offset_mdeg: stated("lidar_frame_azimuth_offset"),
        columns: count("columns_per_frame"),
        rows: count("pixels_per_column"),
        azimuths: angles("beam_azimuth_angles"),
        altitudes: angles("beam_altitude_angles"),
    })
}

fn angles(node: &Node, items: &[Node], source: SourceId) -> Angles {
    let values: Vec<f64> = items
        .iter()
        .filter_map(|item| item.text()?.trim().parse().ok())
        .filter(|value: &f64| value.is_finite())
        .collect();
    let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Angles {
        count: number(items.len()),
        broken: number(items.len() - values.len()),
        range_deg: [low, high],
        place: Place::text(source, node.span),
    }
}

/// The value under a key, the nearest to the root.
fn find<'n>(node: &'n Node, key: &str, depth: usize) -> Option<&'n Node> {
    if let Some(value) = node.get(key) {
        return Some(value);
    }
    let deeper = depth.checked_sub(1)?;
    node.pairs().iter().find_map(|(_, value)| find(value, key, deeper))
}
