//! Intrinsics in files: those of camera_info_manager, and saved messages sensor_msgs/CameraInfo.
//!
//! Owns their keys. Source: camera_calibration_parsers (parse_yml.cpp); CameraInfo.msg of ROS 1 and ROS 2. Must not know whether they match a camera.

use crate::source::{Place, SourceId, Span};
use crate::world::camera::{CameraFile, CameraModel};

use super::document::Node;
use super::numbers;

/// The keys of one form.
struct Form {
    width: &'static str,
    height: &'static str,
    k: &'static str,
    d: &'static str,
    r: &'static str,
    p: &'static str,
}

/// camera_info_manager's, and those of the message in ROS 2 and ROS 1.
const FORMS: [Form; 3] = [
    Form {
        width: "image_width",
        height: "image_height",
        k: "camera_matrix",
        d: "distortion_coefficients",
        r: "rectification_matrix",
        p: "projection_matrix",
    },
    Form {
        width: "width",
        height: "height",
        k: "k",
        d: "d",
        r: "r",
        p: "p",
    },
    Form {
        width: "width",
        height: "height",
        k: "K",
        d: "D",
        r: "R",
        p: "P",
    },
];

/// The camera of a document. A matrix with a wrong number of values is a fault of the file.
pub(super) fn collect(root: &Node, source: SourceId, text: &str) -> (Option<CameraFile>, Vec<(Span, String)>) {
    let is_in = |form: &&Form| {
        let keys = [form.width, form.height, form.k, form.d];
        keys.iter().all(|key| root.get(key).is_some())
    };
    let Some(form) = FORMS.iter().find(is_in) else {
        return (None, Vec::new());
    };
    let values = |key: &str| numbers::numbers(root.get(key)?, text).map(|found| numbers::values(found.literals()));
    let matrices = [(form.k, 9), (form.r, 9), (form.p, 12)];
    let miscounted = matrices.iter().filter_map(|(key, count)| {
        let node = root.get(key)?;
        let found = values(key)?.len();
        (found != *count && found > 0)
            .then(|| (node.span, format!("`{key}` has {found} numbers; {count} are required")))
    });
    let faults: Vec<(Span, String)> = miscounted.collect();
    let pixels = |node: &Node, key: &str| node.get(key)?.text()?.trim().parse().ok();
    let words = |node: Option<&Node>| Some(node?.text()?.trim().to_owned()).filter(|text| !text.is_empty());
    let made = || {
        let matrix = root.get(form.k)?;
        let frame = || root.get("header").and_then(|header| words(header.get("frame_id")));
        let name = words(root.get("camera_name")).or_else(frame);
        let region = |key: &str| root.get("roi").and_then(|roi| pixels(roi, key)).unwrap_or_default();
        Some(CameraFile {
            name: name.unwrap_or_else(|| "camera".to_owned()),
            place: Place::text(source, matrix.get("data").unwrap_or(matrix).span),
            camera: CameraModel {
                size: [pixels(root, form.width)?, pixels(root, form.height)?],
                model: words(root.get("distortion_model")).unwrap_or_default(),
                d: values(form.d).unwrap_or_default(),
                k: values(form.k)?.try_into().ok()?,
                // All zeros: not filled in.
                r: values(form.r).and_then(|r| r.try_into().ok()).unwrap_or_default(),
                p: values(form.p).and_then(|p| p.try_into().ok()).unwrap_or_default(),
                binning: ["binning_x", "binning_y"].map(|key| pixels(root, key).unwrap_or_default()),
                roi: ["x_offset", "y_offset", "width", "height"].map(region),
            },
        })
    };
    (made(), faults)
}
