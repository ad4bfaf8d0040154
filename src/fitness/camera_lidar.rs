//! A camera and a lidar, by a target that both see. Pixels are not read, so whether they see one is not evaluated.

use crate::analysis::Estimates;
use crate::analysis::camera::published::{RecordedCamera, namespace};
use crate::analysis::lidar::Clouds;
use crate::math::stats::median;
use crate::rules::codes;
use crate::verdict::{Measured, Severity, Verdict};
use crate::world::bag::TopicEvidence;
use crate::world::{BagEvidence, FrameId};

use super::conditions::{Absence, absent, by_rules, clocks, initial_guess, lidars, rate, together};
use super::stamped::Stamped;
use super::{Condition, Pair, best};

/// Time that both must be recorded, seconds.
const LEAST_S: f64 = 5.0;
const LEAST_HZ: f64 = 1.0;
/// Median distance of a cloud's stamp from the next image, seconds: a hand with a target moves by 5 cm.
const MAX_APART_S: f64 = 0.1;
/// Last parts of the topics of image_transport.
const TRANSPORTS: [&str; 4] = ["compressed", "theora", "ffmpeg", "zstd"];

pub(super) fn all(world: &Estimates, verdict: &Verdict) -> Vec<Pair> {
    let topics = world
        .bags
        .iter()
        .flat_map(|bag| bag.topics.values().map(move |topic| (bag, topic)));
    let images: Vec<(&BagEvidence, &TopicEvidence)> = topics.filter(|(_, topic)| is_of_a_camera(topic)).collect();
    let no_images = Absence {
        lacks: "no images in the recording".to_owned(),
        is_sure: true,
    };
    let clouds = match lidars(world) {
        Ok(clouds) if !images.is_empty() => clouds,
        other => {
            let absence = other.err().unwrap_or(no_images);
            let asks = "images of a camera, and clouds of a lidar";
            let record = "record the images with their camera_info, and the driver's clouds (sensor_msgs/PointCloud2)";
            return vec![absent(world, asks, &absence, record)];
        }
    };
    let each = images
        .iter()
        .filter_map(|image| best(clouds.iter().map(|clouds| pair(world, verdict, *image, clouds))));
    each.collect()
}

/// Whether a topic has images that show a target: depths do not.
fn is_of_a_camera(topic: &TopicEvidence) -> bool {
    let is_depth = FrameId::new(&topic.topic).tokens().iter().any(|word| word == "depth");
    let forms = topic.content.images.iter().flat_map(|images| &images.forms);
    !is_depth && forms.into_iter().any(|form| form.encoding != "32FC1")
}

fn pair(world: &Estimates, verdict: &Verdict, (bag, image): (&BagEvidence, &TopicEvidence), clouds: &Clouds) -> Pair {
    let [seen, points] = [image, clouds.topic].map(Stamped::of);
    let frame = |topic: &TopicEvidence| {
        let mut frames = topic.header_frames.keys().map(FrameId::canonical);
        frames.find(|frame| !frame.as_str().is_empty())
    };
    let target = Condition::open(
        "target",
        "a target that camera and lidar see, at several distinct positions and tilts",
        "pixels are not read",
    )
    .record("look at the images: hold the target still for a second at ten or more positions and tilts, near and far, in all parts of the image");
    let conditions = vec![
        together([&seen, &points], LEAST_S),
        rate(&seen, LEAST_HZ),
        rate(&points, LEAST_HZ),
        clocks(
            verdict,
            &[codes::TIME02, codes::TIME03, codes::TIME04],
            &[&seen, &points],
        ),
        near(image, clouds.topic),
        intrinsics(world, verdict, bag, image),
        target,
        initial_guess(world, [frame(image).as_ref(), frame(clouds.topic).as_ref()]),
    ];
    (format!("{} and {}", seen.subject, points.subject), conditions)
}

/// Whether clouds have images of about the same time.
fn near(image: &TopicEvidence, clouds: &TopicEvidence) -> Condition {
    let (name, asks) = (
        "same time",
        format!("an image within {MAX_APART_S} s of a cloud, by their stamps (median)"),
    );
    let is_whole = |topic: &TopicEvidence| topic.stamps.samples.len() as u64 == topic.stamps.count;
    if image.stamps.zero > 0 || clouds.stamps.zero > 0 {
        return Condition::open(name, asks, "stamps are zero").record("stamp both at the time of measurement");
    }
    if !is_whole(image) || !is_whole(clouds) {
        return Condition::open(name, asks, "too many stamps: only samples of them are kept").beside();
    }
    let mut stamps: Vec<i64> = image.stamps.samples.iter().map(|(stamp, _)| *stamp).collect();
    stamps.sort_unstable();
    let apart = |stamp: i64| {
        let after = stamps.partition_point(|other| *other < stamp);
        let around = [after.checked_sub(1), Some(after)].into_iter().flatten();
        around
            .filter_map(|at| Some(stamps.get(at)?.abs_diff(stamp) as f64 * 1e-9))
            .reduce(f64::min)
    };
    let apart: Vec<f64> = clouds
        .stamps
        .samples
        .iter()
        .filter_map(|(stamp, _)| apart(*stamp))
        .collect();
    let Some(middle) = median(&apart) else {
        return Condition::open(name, asks, "no stamps").record("stamp both at the time of measurement");
    };
    let measured = Measured::new("time between a cloud and the next image", middle, "s").limit(MAX_APART_S);
    Condition::judged(name, asks, middle <= MAX_APART_S)
        .measured(measured.samples(apart.len() as u64))
        .because(format!("the next image is {middle:.2} s from a cloud"))
        .record("record faster, with the clocks of both synchronised")
}

/// Whether the camera's intrinsics are stated, and agree with its images.
fn intrinsics(world: &Estimates, verdict: &Verdict, bag: &BagEvidence, image: &TopicEvidence) -> Condition {
    let (name, asks) = ("intrinsics", "camera_info with a calibration of this image size");
    let space = namespace(&image.topic);
    let is_transport = TRANSPORTS.iter().any(|name| image.topic.ends_with(&format!("/{name}")));
    let space = if is_transport { namespace(space) } else { space };
    let mut own =
        RecordedCamera::all(world).filter(|camera| camera.bag.source == bag.source && camera.namespace() == space);
    let record = "calibrate the camera first, and record its camera_info in the namespace of the images";
    let Some(camera) = own.next() else {
        return match world.cameras.first() {
            Some(file) => {
                let why = format!(
                    "no camera_info beside `{}`; that the calibration of `{}` is its own is not known",
                    image.topic, file.name
                );
                Condition::open(name, asks, why)
            }
            None => Condition::judged(name, asks, false)
                .because(format!("no camera_info in the namespace of `{}`", image.topic)),
        }
        .record(record);
    };
    if camera.is_uncalibrated() {
        let why = format!("K on `{}` is all zeros: the camera is not calibrated", camera.topic);
        return Condition::judged(name, asks, false).because(why).record(record);
    }
    let subjects = [
        format!("calibration on topic `{}`", camera.topic),
        format!("size of `{}`", image.topic),
    ];
    by_rules(
        verdict,
        (name, asks),
        (&[codes::CAMERA02], Severity::Warning),
        &subjects.each_ref().map(String::as_str),
    )
    .record(record)
}
