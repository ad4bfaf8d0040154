//! Cameras: optical frames of real transforms, and what a camera there would say, staged rightly and then wrong.

use frames_lint::faults::Family;
use frames_lint::world::bag::TopicEvidence;
use frames_lint::world::camera::{Calibration, CalibrationEvidence, CameraModel, ImageEvidence, ImageForm};
use frames_lint::world::{FrameId, World};
use nalgebra::{Isometry3, Translation3};

use crate::stages::{Stage, message, put_topic};
use crate::streams::Stream;
use crate::support::drive::errors::{rotation, slots};

/// Width and height, pixels, and the focal length.
const SIZE: [u32; 2] = [1280, 720];
const FOCAL_PX: f64 = 900.0;

/// A camera with its images.
pub static CAMERA: Stage = Stage {
    family: Family::Camera,
    words: &["`/camera/camera_info`", "`/camera/image_raw`"],
    put: |world, stream| {
        let frame = optical(stream);
        put_camera(world, stream, "/camera", &frame, 0.0);
        true
    },
};

/// A pair of cameras, of which the left is this one.
pub static STEREO: Stage = Stage {
    family: Family::Camera,
    words: &["`/stereo/right/camera_info`"],
    put: |world, stream| put_pair(world, stream, false),
};

/// Takes the two of a pair for each other.
pub fn swap_pair(world: &mut World, stream: &Stream) {
    put_pair(world, stream, true);
}

/// Images are half as large as what was calibrated.
pub fn shrink(world: &mut World, stream: &Stream) {
    let topic = world.bags[stream.bag].topics.get_mut("/camera/image_raw").unwrap();
    for form in topic.content.images.iter_mut().flat_map(|images| &mut images.forms) {
        form.size = SIZE.map(|pixels| pixels / 2);
    }
}

/// Turns an optical frame otherwise: `parent_from_optical` of the one that is told.
pub fn turn(world: &mut World, stream: &Stream, change: fn(Isometry3<f64>) -> Isometry3<f64>) {
    for edge in stream.edges_mut(world) {
        let extreme = edge.extreme.iter_mut().map(|(at, ..)| at);
        for at in edge.samples.iter_mut().chain(extreme) {
            let told = Isometry3::from_parts(Translation3::identity(), rotation(at.pose.rotation_xyzw));
            at.pose.rotation_xyzw = slots(change(told).rotation);
        }
    }
}

/// The optical frame of a stream.
fn optical(stream: &Stream) -> String {
    let mut frames = stream.frames.iter().filter(|frame| frame.contains("optical"));
    frames.next().unwrap().clone()
}

fn put_pair(world: &mut World, stream: &Stream, is_swapped: bool) -> bool {
    let left = optical(stream);
    if !left.contains("left") {
        return false;
    }
    let right = left.replace("left", "right");
    let tf = &world.bags[stream.bag].tf;
    let place = |name: &str| {
        let edge = tf.iter().find(|edge| edge.child.canonical().as_str() == name)?;
        Some((edge.parent.canonical().as_str().to_owned(), edge.samples[0].pose))
    };
    let (Some((left_parent, _)), Some(_)) = (place(&left), place(&right)) else {
        return false;
    };
    // Both optical frames sit at their cameras, which sit in one frame.
    let (Some((_, of_left)), Some((_, of_right))) = (place(&left_parent), place(&left_parent.replace("left", "right")))
    else {
        return false;
    };
    let [a, b] = [of_left, of_right].map(|pose| nalgebra::Vector3::from(pose.translation_m));
    let baseline_m = (a - b).norm();
    let frames = if is_swapped { [&right, &left] } else { [&left, &right] };
    put_camera(world, stream, "/stereo/left", frames[0], 0.0);
    put_camera(world, stream, "/stereo/right", frames[1], baseline_m);
    true
}

fn put_camera(world: &mut World, stream: &Stream, name: &str, frame: &str, baseline_m: f64) {
    let start_ns = world.bags[stream.bag].start_ns.unwrap_or_default();
    let [width, height] = SIZE.map(f64::from);
    let (fx, cx, cy) = (FOCAL_PX, width / 2.0 + 1.5, height / 2.0 - 2.0);
    let info = format!("{name}/camera_info");
    let calibration = Calibration {
        at: message(&info, start_ns),
        count: 10,
        camera: CameraModel {
            size: SIZE,
            model: "plumb_bob".to_owned(),
            d: vec![-0.1, 0.02, 3e-4, -2e-4, 0.0],
            k: [fx, 0.0, cx, 0.0, fx, cy, 0.0, 0.0, 1.0],
            r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            p: [fx, 0.0, cx, -fx * baseline_m, 0.0, fx, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
            binning: [0, 0],
            roi: [0; 4],
        },
    };
    let topic: &mut TopicEvidence = put_topic(world, stream, &info, "sensor_msgs/msg/CameraInfo", frame);
    topic.content.calibrations = Some(CalibrationEvidence {
        count: 10,
        calibrations: vec![calibration],
        others: 0,
    });
    let images = format!("{name}/image_raw");
    let form = ImageForm {
        at: message(&images, start_ns),
        count: 10,
        size: SIZE,
        encoding: "rgb8".to_owned(),
    };
    let topic = put_topic(world, stream, &images, "sensor_msgs/msg/Image", frame);
    topic.content.images = Some(ImageEvidence {
        count: 10,
        forms: vec![form],
        others: 0,
    });
}

/// Whether a frame is a camera's optical one by its name.
pub fn is_optical(frame: &FrameId) -> bool {
    let name = frame.canonical();
    name.as_str().ends_with("optical_frame") || name.as_str().ends_with("optical")
}
