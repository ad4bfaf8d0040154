//! Intrinsics in files: those of camera_info_manager, saved messages sensor_msgs/CameraInfo, and pinhole cameras of Kalibr.
//!
//! Owns their keys. Source: camera_calibration_parsers (parse_yml.cpp); CameraInfo.msg of ROS 1 and ROS 2; Kalibr's wiki, "yaml formats" (also
//! `sensor.yaml` of EuRoC). Must not know whether they match a camera.

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

/// The cameras of a document. A matrix with a wrong number of values is a fault of the file.
pub(super) fn collect(root: &Node, source: SourceId, text: &str) -> (Vec<CameraFile>, Vec<(Span, String)>) {
    let (published, faults) = of_message(root, source, text);
    let below = root.pairs().iter().filter_map(|(key, node)| Some((key.text()?, node)));
    let of_kalibr = [("camera", root)].into_iter().chain(below);
    let of_kalibr = of_kalibr.filter_map(|(name, node)| of_kalibr_camera(name, node, source, text));
    (published.into_iter().chain(of_kalibr).collect(), faults)
}

/// `intrinsics: [fx, fy, cx, cy]` beside `resolution: [width, height]`.
fn of_kalibr_camera(name: &str, camera: &Node, source: SourceId, text: &str) -> Option<CameraFile> {
    let word = |key: &str| camera.get(key).and_then(Node::text).map(str::trim);
    if word("camera_model").is_some_and(|model| model != "pinhole") {
        return None;
    }
    let values = |key: &str| Some(numbers::values(numbers::numbers(camera.get(key)?, text)?.literals()));
    let [fx, fy, cx, cy]: [f64; 4] = values("intrinsics")?.try_into().ok()?;
    let sides = camera.get("resolution")?.items()?.iter();
    let size: Vec<u32> = sides.filter_map(|side| side.text()?.trim().parse().ok()).collect();
    let coefficients = ["distortion_coeffs", "distortion_coefficients"]
        .into_iter()
        .find_map(values);
    Some(CameraFile {
        name: name.to_owned(),
        place: Place::text(source, camera.get("intrinsics")?.span),
        camera: CameraModel {
            size: size.try_into().ok()?,
            model: match word("distortion_model").unwrap_or_default() {
                "radtan" | "radial-tangential" => "plumb_bob",
                "equi" => "equidistant",
                other => other,
            }
            .to_owned(),
            d: coefficients.unwrap_or_default(),
            k: [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
            r: [0.0; 9],
            p: [0.0; 12],
            binning: [0; 2],
            roi: [0; 4],
        },
    })
}

fn of_message(root: &Node, source: SourceId, text: &str) -> (Option<CameraFile>, Vec<(Span, String)>) {
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
