//! Time offsets between a camera and an IMU, as Kalibr, OpenVINS and VINS state them: `t_imu = t_cam + offset` in all of them.

use crate::source::{Place, SourceId};
use crate::world::camera::StatedDelay;

use super::document::{Kind, Node};
use super::numbers;

/// Keys whose value is the offset; `td` only beside `estimate_td`.
const KEYS: [&str; 3] = ["timeshift_cam_imu", "calib_camimu_dt", "td"];

/// The offsets of a document.
pub(super) fn collect(root: &Node, source: SourceId) -> Vec<StatedDelay> {
    let mut found = Vec::new();
    // VINS and OpenVINS state one offset, that of the first camera.
    let mut stack = vec![(root, 0_u32)];
    while let Some((node, camera)) = stack.pop() {
        match &node.kind {
            Kind::Mapping(pairs) => {
                for (key, value) in pairs {
                    let name = key.text().unwrap_or_default();
                    let is_vins = || node.get("estimate_td").is_some();
                    if KEYS.contains(&name)
                        && (name != "td" || is_vins())
                        && let Some(number) = numbers::literal(value).filter(|number| number.value.is_finite())
                    {
                        found.push(StatedDelay {
                            key: name.to_owned(),
                            camera,
                            offset_s: number.value,
                            place: Place::text(source, number.span),
                        });
                    }
                    let own = name.strip_prefix("cam").and_then(|digits| digits.parse().ok());
                    stack.push((value, own.unwrap_or(camera)));
                }
            }
            Kind::Sequence(items) => stack.extend(items.iter().map(|item| (item, camera))),
            Kind::Scalar { .. } => {}
        }
    }
    found.sort_by_key(|delay| delay.camera);
    found
}
