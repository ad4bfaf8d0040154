//! Projections that known formats declare: the maps of map_server, the sensors of RangeNet++, the metadata of Ouster.
//!
//! Owns which keys make one. Sources: nav2_map_server and map_server (map_io.cpp: `resolution`, `origin`, `negate`, thresholds);
//! RangeNet++ and SalsaNext (`fov_up`, `fov_down`, `img_prop`); ouster-sdk (metadata.cpp, flat and nested).

use crate::source::{Place, SourceId};
use crate::world::Projection;
use crate::world::projection::{Axis, Cell, Form, Grid, RangeImage, Seam, Sense};

use super::document::Node;
use super::numbers;

/// All projections of a document, in its order.
pub(super) fn collect(root: &Node, source: SourceId) -> Vec<Projection> {
    let mut found = Vec::new();
    let mut stack = vec![(root, String::new())];
    while let Some((node, label)) = stack.pop() {
        if let Some((format, form)) = map_server(node).or_else(|| rangenet(node)).or_else(|| ouster(node)) {
            found.push(Projection {
                format: format.to_owned(),
                label: label.clone(),
                topic: None,
                place: Place::text(source, node.span),
                form,
            });
        }
        for (key, value) in node.pairs().iter().filter(|(_, value)| value.is_mapping()) {
            let key = key.text().unwrap_or("?");
            let path = if label.is_empty() {
                key.to_owned()
            } else {
                format!("{label}/{key}")
            };
            stack.push((value, path));
        }
    }
    found.sort_by(|a, b| a.place.cmp(&b.place));
    found
}

fn number(node: Option<&Node>) -> Option<f64> {
    numbers::number(node?.text()?)
}

fn list(node: Option<&Node>) -> Vec<f64> {
    let items = node.and_then(Node::items).unwrap_or_default();
    items
        .iter()
        .map(|item| number(Some(item)).unwrap_or(f64::NAN))
        .collect()
}

fn whole(node: Option<&Node>) -> Option<u32> {
    node?.text()?.parse().ok()
}

/// A map's file: the columns of its image go along x, the rows, from the lowest up, along y; the origin is the lower left corner.
fn map_server(node: &Node) -> Option<(&'static str, Form)> {
    let has = |key: &str| node.get(key).is_some();
    if !(has("image") && (has("occupied_thresh") || has("free_thresh") || has("negate"))) {
        return None;
    }
    let thresholds = [node.get("occupied_thresh"), node.get("free_thresh")].map(number);
    let grid = Grid {
        resolution_m: number(node.get("resolution")),
        origin: list(node.get("origin")),
        cell: Some(Cell::Corner),
        columns: Some(Axis::PlusX),
        rows: Some(Axis::PlusY),
        thresholds: match thresholds {
            [Some(occupied), Some(free)] => vec![occupied, free],
            _ => Vec::new(),
        },
        ..Grid::default()
    };
    Some(("map_server", Form::Grid(grid)))
}

/// `u = 0.5 (yaw / pi + 1) W` with `yaw = -atan2(y, x)`, limited to the image.
fn rangenet(node: &Node) -> Option<(&'static str, Form)> {
    let (up, down) = (number(node.get("fov_up")), number(node.get("fov_down")));
    if up.is_none() && down.is_none() {
        return None;
    }
    let size = node.get("img_prop").unwrap_or(node);
    let image = RangeImage {
        width: whole(size.get("width")),
        height: whole(size.get("height")),
        fov_up_deg: up,
        fov_down_deg: down,
        azimuth: Some(Sense::Clockwise),
        seam: Some(Seam::Clamp),
        beam_offset_mm: None,
    };
    Some(("rangenet", Form::RangeImage(image)))
}

/// A sensor's metadata: its beams' elevations, and the columns of one revolution.
fn ouster(node: &Node) -> Option<(&'static str, Form)> {
    let beams = node.get("beam_intrinsics").unwrap_or(node);
    let angles = list(beams.get("beam_altitude_angles"));
    let format = ["lidar_data_format", "data_format"]
        .iter()
        .find_map(|key| node.get(key));
    // A sensor's nested metadata is found at the top: its part alone adds nothing.
    if angles.is_empty() || node.get("beam_intrinsics").is_none() && format.is_none() && node.get("prod_line").is_none()
    {
        return None;
    }
    let mode = |node: &Node| node.text()?.split('x').next()?.parse().ok();
    let in_config = || node.get("config_params")?.get("lidar_mode");
    let image = RangeImage {
        width: whole(format.and_then(|format| format.get("columns_per_frame")))
            .or_else(|| mode(node.get("lidar_mode").or_else(in_config)?)),
        height: whole(format.and_then(|format| format.get("pixels_per_column"))).or(u32::try_from(angles.len()).ok()),
        fov_up_deg: angles.iter().copied().reduce(f64::max),
        fov_down_deg: angles.iter().copied().reduce(f64::min),
        azimuth: Some(Sense::Clockwise),
        seam: Some(Seam::Wrap),
        beam_offset_mm: number(beams.get("lidar_origin_to_beam_origin_mm")),
    };
    Some(("ouster", Form::RangeImage(image)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::read::calibration::{read_json, read_yaml};
    use crate::source::{Source, SourceId, SourceKind};
    use crate::world::Projection;
    use crate::world::projection::Form;

    fn read(text: &str, kind: SourceKind) -> Vec<Projection> {
        let mut source = Source::new(SourceId(0), "f", kind);
        text.clone_into(&mut source.text);
        match kind {
            SourceKind::Json => read_json(&mut source, crate::tables::Tables::default().dialects()).projections,
            _ => read_yaml(&mut source, crate::tables::Tables::default().dialects()).projections,
        }
    }

    #[test]
    fn a_map_is_a_grid_from_its_lower_left_corner() {
        let text = "image: lab.pgm\nresolution: 0.050000\norigin: [-10.0, -12.2, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
        let found = read(text, SourceKind::Yaml);
        let [
            Projection {
                format,
                form: Form::Grid(grid),
                ..
            },
        ] = found.as_slice()
        else {
            panic!("{found:?}")
        };
        assert_eq!((format.as_str(), grid.resolution_m), ("map_server", Some(0.05)));
        assert_eq!(grid.origin, [-10.0, -12.2, 0.0]);
        assert_eq!(grid.thresholds, [0.65, 0.196]);
        assert!(read("resolution: [752, 480]\nT_BS: 1\n", SourceKind::Yaml).is_empty());
    }

    #[test]
    fn a_network_says_what_its_sensor_sees() {
        let text = "dataset:\n  sensor:\n    type: spherical\n    fov_up: 3\n    fov_down: -25\n    img_prop: {width: 2048, height: 64}\n";
        let found = read(text, SourceKind::Yaml);
        let [
            Projection {
                label,
                form: Form::RangeImage(image),
                ..
            },
        ] = found.as_slice()
        else {
            panic!("{found:?}")
        };
        assert_eq!(label, "dataset/sensor");
        assert_eq!(
            (image.width, image.height, image.fov_up_deg, image.fov_down_deg),
            (Some(2048), Some(64), Some(3.0), Some(-25.0))
        );
    }

    #[test]
    fn metadata_of_a_sensor_is_read_flat_and_nested() {
        let nested = r#"{"beam_intrinsics": {"beam_altitude_angles": [16.7, 0.1, -16.6], "lidar_origin_to_beam_origin_mm": 15.806},
            "lidar_data_format": {"columns_per_frame": 1024, "pixels_per_column": 3}}"#;
        let flat = r#"{"beam_altitude_angles": [16.7, 0.1, -16.6], "lidar_mode": "1024x10", "prod_line": "OS-1-64",
            "lidar_origin_to_beam_origin_mm": 15.806}"#;
        let [a, b] = [nested, flat].map(|text| read(text, SourceKind::Json));
        let ([a], [b]) = (a.as_slice(), b.as_slice()) else {
            panic!("{a:?} {b:?}")
        };
        assert_eq!(a.form, b.form);
        let Form::RangeImage(image) = &a.form else { panic!() };
        assert_eq!(
            (image.width, image.height, image.fov_up_deg),
            (Some(1024), Some(3), Some(16.7))
        );
        assert_eq!(image.beam_offset_mm, Some(15.806));
    }
}
