//! Cameras: their field of view as a frustum, and the points of lidars projected into their images.

use nalgebra::{Isometry3, Point3};

use crate::world::FrameId;
use crate::world::bag::TopicEvidence;
use crate::world::camera::CameraModel;
use crate::world::tf2::Buffer;

use super::placed::FrameEntities;
use super::scene::{Content, Path, Points, Scene};

/// Points nearer than this to the camera are not projected, metres.
const NEAR_M: f64 = 0.3;
/// Distance at which the colour of a projected point no longer changes, metres.
const FAR_M: f64 = 40.0;

/// Every calibrated camera of a world, with the clouds projected into its image. Returns the cameras with such clouds.
pub(super) fn cameras(placed: &FrameEntities, scene: &mut Scene) -> Vec<Path> {
    let mut images = Vec::new();
    let world = placed.world();
    let buffer = placed.buffer();
    for bag in &world.bags {
        for topic in bag.topics.values() {
            let calibrations = topic
                .content
                .calibrations
                .iter()
                .flat_map(|known| &known.calibrations)
                .map(|known| &known.camera);
            let Some(frame) = topic.header_frames.keys().next() else {
                continue;
            };
            let Some(path) = placed.path(frame) else { continue };
            for calibration in calibrations.filter(|calibration| is_calibrated(calibration)).take(1) {
                let own = path.then(format!("camera of {}", topic.topic));
                let narrow = calibration.k.map(|value| value as f32);
                scene.always(
                    &own,
                    Content::Camera(narrow, calibration.size.map(|pixels| pixels as f32)),
                );
                let mut has_points = false;
                for cloud in bag.topics.values() {
                    has_points |= projected((cloud, frame, calibration), buffer, &own, scene);
                }
                images.extend(has_points.then_some(own));
            }
        }
    }
    images
}

fn is_calibrated(calibration: &CameraModel) -> bool {
    calibration.k[0] > 0.0 && calibration.k[4] > 0.0 && calibration.size.iter().all(|pixels| *pixels > 0)
}

/// Projects the points of a topic into the image: those in front of the camera, without distortion. Returns whether any is in it.
fn projected(
    (topic, camera, calibration): (&TopicEvidence, &FrameId, &CameraModel),
    buffer: &Buffer,
    path: &Path,
    scene: &mut Scene,
) -> bool {
    let (Some(clouds), Some(frame)) = (&topic.content.clouds, topic.header_frames.keys().next()) else {
        return false;
    };
    let mut has_any = false;
    let own = path.then(format!("points of {}", topic.topic));
    for sample in &clouds.samples {
        let stamp_ns = sample.at.stamp_ns.unwrap_or(sample.at.log_ns);
        let found = buffer.lookup(camera.canonical().as_str(), frame.canonical().as_str(), stamp_ns);
        let Ok(found) = found else { continue };
        let seen: Vec<(f64, [f32; 3])> = sample
            .points
            .iter()
            .filter_map(|point| pixel(&found.target_from_source, &Point3::from(point.xyz), calibration))
            .collect();
        if !seen.is_empty() {
            has_any = true;
            scene.at(
                &own,
                stamp_ns,
                Content::Pixels(Points {
                    xyz_m: seen.iter().map(|(_, pixel)| *pixel).collect(),
                    colors: seen.iter().map(|(depth_m, _)| by_depth(*depth_m)).collect(),
                    radius: -1.5,
                    labels: Vec::new(),
                }),
            );
        }
    }
    has_any
}

/// Depth and pixel of a point, if it is in the image.
fn pixel(
    camera_from_cloud: &Isometry3<f64>,
    point: &Point3<f64>,
    calibration: &CameraModel,
) -> Option<(f64, [f32; 3])> {
    let at = camera_from_cloud * point;
    let [fx, _, cx, _, fy, cy, ..] = calibration.k;
    let (u, v) = (fx * at.x / at.z + cx, fy * at.y / at.z + cy);
    let [width, height] = calibration.size.map(f64::from);
    let is_seen = at.z > NEAR_M && (0.0..width).contains(&u) && (0.0..height).contains(&v);
    is_seen.then_some((at.z, [u as f32, v as f32, 0.0]))
}

/// Near is red, far is blue.
fn by_depth(depth_m: f64) -> [u8; 3] {
    let share = (depth_m / FAR_M).clamp(0.0, 1.0);
    let far = (share * 200.0) as u8;
    [240 - far, 60, 40 + far]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn calibration() -> CameraModel {
        CameraModel {
            size: [640, 480],
            model: "plumb_bob".to_owned(),
            d: Vec::new(),
            k: [500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0],
            r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            p: [0.0; 12],
            binning: [0, 0],
            roi: [0; 4],
        }
    }

    #[test]
    fn points_fall_where_the_pinhole_says() {
        let seen = |x, y, z| pixel(&Isometry3::identity(), &Point3::new(x, y, z), &calibration());
        let (depth_m, at) = seen(1.0, 0.5, 5.0).unwrap();
        assert!((depth_m - 5.0).abs() < 1e-12);
        assert!(
            at.iter()
                .zip([420.0, 290.0, 0.0])
                .all(|(seen, right)| (seen - right).abs() < 1e-3),
            "{at:?}"
        );
        assert_eq!(seen(1.0, 0.5, -5.0), None, "behind the camera");
        assert_eq!(seen(9.0, 0.0, 5.0), None, "beside the image");
    }
}
