//! Intrinsics that files of camera_info_manager hold: `camera_matrix`, `distortion_coefficients`, `rectification_matrix`, `projection_matrix`.
//!
//! Owns their keys. Source: camera_calibration_parsers (parse_yml.cpp). Must not know whether they fit a camera.

use crate::source::{Place, SourceId, Span};
use crate::world::camera::{CameraFile, CameraModel};

use super::document::Node;
use super::numbers;

/// The keys of the matrices, and how many numbers each holds.
const MATRICES: [(&str, usize); 3] = [
    ("camera_matrix", 9),
    ("rectification_matrix", 9),
    ("projection_matrix", 12),
];

/// The camera of a document. A matrix with another count of numbers is a fault of the file.
pub(super) fn collect(root: &Node, source: SourceId, text: &str) -> (Option<CameraFile>, Vec<(Span, String)>) {
    let is_one = [
        "image_width",
        "image_height",
        "camera_matrix",
        "distortion_coefficients",
    ]
    .iter()
    .all(|key| root.get(key).is_some());
    if !is_one {
        return (None, Vec::new());
    }
    let values = |key: &str| numbers::numbers(root.get(key)?, text).map(|found| numbers::values(found.literals()));
    let miscounted = MATRICES.iter().filter_map(|(key, count)| {
        let node = root.get(key)?;
        let found = values(key)?.len();
        (found != *count && found > 0).then(|| (node.span, format!("`{key}` holds {found} numbers; it has {count}")))
    });
    let faults: Vec<(Span, String)> = miscounted.collect();
    let pixels = |key: &str| root.get(key)?.text()?.trim().parse().ok();
    let made = || {
        let matrix = root.get("camera_matrix")?;
        Some(CameraFile {
            name: root
                .get("camera_name")
                .and_then(Node::text)
                .filter(|name| !name.trim().is_empty())
                .unwrap_or("camera")
                .to_owned(),
            place: Place::text(source, matrix.get("data").unwrap_or(matrix).span),
            camera: CameraModel {
                size: [pixels("image_width")?, pixels("image_height")?],
                model: root
                    .get("distortion_model")
                    .and_then(Node::text)
                    .unwrap_or_default()
                    .to_owned(),
                d: values("distortion_coefficients").unwrap_or_default(),
                k: values("camera_matrix")?.try_into().ok()?,
                // All zeros is what was not filled in.
                r: values("rectification_matrix")
                    .and_then(|r| r.try_into().ok())
                    .unwrap_or_default(),
                p: values("projection_matrix")
                    .and_then(|p| p.try_into().ok())
                    .unwrap_or_default(),
                binning: [0; 2],
                roi: [0; 4],
            },
        })
    };
    (made(), faults)
}
