//! SENSOR05: an IMU whose data are expressed in the frame of a lidar's cloud.

use crate::analysis::names;
use crate::rules::prelude::*;
use crate::source::MessageRef;
use crate::world::bag::{TopicContent, TopicEvidence};
use crate::world::{BagEvidence, FrameId, World};

pub(crate) struct ImuSharesLidarFrame;

impl Rule for ImuSharesLidarFrame {
    const NEEDS: &'static [Need] = &[Need::Bag];
    const SAMPLE: SampleSize = SampleSize::LEAST;
    type Limits = NoLimits;

    fn judge(world: &Estimates, _: &NoLimits, out: &mut Judge) {
        for bag in &world.bags {
            let clouds: Vec<&TopicEvidence> = bag.topics.values().filter(|topic| is_cloud(topic)).collect();
            let said = bag.topics.values().flat_map(TopicEvidence::contents);
            for imu in said.filter(|said| said.content.imu.is_some()) {
                judge_imu(world, bag, &imu, &clouds, out);
            }
        }
    }
}

/// Whether the topic carries the points of a lidar in space.
fn is_cloud(topic: &TopicEvidence) -> bool {
    const TYPES: &[&str] = &["PointCloud2", "PointCloud", "CustomMsg", "PandarScan"];
    TYPES.contains(&topic.type_name()) && topic.count > 0
}

fn judge_imu(world: &World, bag: &BagEvidence, imu: &TopicContent<'_>, clouds: &[&TopicEvidence], out: &mut Judge) {
    let subject = format!("frame of {}", imu.subject());
    if clouds.is_empty() {
        return out.missing(subject, "no point cloud in the recording");
    }
    let frames = imu.header_frames.keys().map(FrameId::canonical);
    let named: Vec<FrameId> = frames.filter(|frame| !frame.as_str().is_empty()).collect();
    let shares = |cloud: &TopicEvidence| {
        let theirs: Vec<FrameId> = cloud.header_frames.keys().map(FrameId::canonical).collect();
        named.iter().find(|frame| theirs.contains(frame)).cloned()
    };
    let shared = clouds.iter().find_map(|cloud| Some((*cloud, shares(cloud)?)));
    let Some((cloud, frame)) = shared else {
        return out.pass(subject, [Measured::count("point clouds in other frames", clouds.len())]);
    };
    if names::is_base(&frame) || names::is_world(&frame) {
        let why = format!(
            "the cloud on `{}` is expressed in `{frame}`, which is not the frame of a sensor",
            cloud.topic
        );
        return out.not_applicable(subject, why);
    }
    out.fail(finding(world, bag, subject, imu, cloud, &frame));
}

fn finding(
    world: &World,
    bag: &BagEvidence,
    subject: String,
    imu: &TopicContent<'_>,
    cloud: &TopicEvidence,
    frame: &FrameId,
) -> Finding {
    let words = [imu.topic.words(), cloud.words()].concat();
    let place = |first: Option<&MessageRef>| Place::of(bag.source, first);
    let topic = &imu.topic.topic;
    let known = world.tables.lidar_imu(&words);
    let lever = known.as_ref().and_then(|known| known.lever_mm);
    let publish = format!(
        "set the frame_id of `{topic}` to a frame of the IMU alone, and publish the static transform `{frame}` -> that frame"
    );
    let (detail, help) = match (&known, lever) {
        (Some(known), Some([x, y, z])) => (
            format!(
                "In a {} the IMU is at ({x:.1}, {y:.1}, {z:.1}) mm in the frame of the cloud.",
                known.name
            ),
            format!(
                "{publish} with the translation ({:.4}, {:.4}, {:.4}) m",
                x / 1e3,
                y / 1e3,
                z / 1e3
            ),
        ),
        (Some(known), None) => (
            format!("In a {} the IMU and the cloud have different origins.", known.name),
            format!("{publish} from the data sheet"),
        ),
        (None, _) => (
            "One frame is right only if the IMU and the cloud have the same origin and axes.".to_owned(),
            format!("if origin or axes differ, {publish}"),
        ),
    };
    let norm_mm = lever.map(|[x, y, z]| (x * x + y * y + z * z).sqrt());
    let apart = norm_mm.map_or_else(String::new, |mm| format!(", {mm:.0} mm from the IMU"));
    let message = format!(
        "`{topic}` has the frame of the cloud on `{}`, `{frame}`{apart}",
        cloud.topic
    );
    let finding = Finding::warning(subject, message, place(imu.first))
        .related(place(cloud.stamps.first.as_ref()), "the cloud")
        .detail(detail)
        .help(help);
    let finding = if known.is_some() {
        finding.likely()
    } else {
        finding.hint()
    };
    match norm_mm {
        Some(mm) => finding.measured(Measured::new(
            "distance of the IMU from the origin of the cloud",
            mm,
            "mm",
        )),
        None => finding.measured(Measured::count("topics in that frame", 2)),
    }
}
