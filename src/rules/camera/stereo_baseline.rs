//! CAMERA07: a stereo pair whose baseline in TF contradicts its calibration.

use std::collections::BTreeMap;

use crate::analysis::camera::published::RecordedCamera;
use crate::rules::prelude::*;
use crate::world::{World, camera::CameraModel};

pub(crate) struct StereoBaseline;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    warning: f64,
    error: f64,
    least_m: f64,
    aside: f64,
}

/// Parts of names that distinguish the two cameras of a pair, left and right.
const SIDES: [[&str; 2]; 3] = [["left", "right"], ["infra1", "infra2"], ["cam0", "cam1"]];

impl Rule for StereoBaseline {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let all: Vec<RecordedCamera> = RecordedCamera::all(world)
            .filter(|published| !published.is_uncalibrated())
            .collect();
        let mut first: BTreeMap<(usize, &str), &RecordedCamera> = BTreeMap::new();
        for published in &all {
            first.entry((published.index, published.topic)).or_insert(published);
        }
        for right in &all {
            let lefts = left_topics(right.topic);
            let left = lefts.iter().find_map(|topic| first.get(&(right.index, topic.as_str())));
            if let Some(left) = left {
                judge_pair(world, left, right, limits, out);
            }
        }
    }
}

/// The topic of the left camera, for each way to say left and right that this topic of a right one follows.
fn left_topics(right: &str) -> Vec<String> {
    let mut found = Vec::new();
    for [left_word, right_word] in SIDES {
        let parts: Vec<&str> = right.split('/').collect();
        for (index, part) in parts.iter().enumerate() {
            if part.split('_').any(|word| word == right_word) {
                let mut parts: Vec<String> = parts.iter().map(|part| (*part).to_owned()).collect();
                if let Some(part) = parts.get_mut(index) {
                    let words: Vec<&str> = part
                        .split('_')
                        .map(|word| if word == right_word { left_word } else { word })
                        .collect();
                    *part = words.join("_");
                }
                found.push(parts.join("/"));
            }
        }
    }
    found
}

/// How far the right camera is to the right of the left one, metres, by the projection of the right one.
fn baseline(calibration: &CameraModel) -> Option<f64> {
    let [fx, _, _, tx, ..] = calibration.p;
    (fx > 0.0 && tx.is_finite()).then_some(-tx / fx)
}

fn judge_pair(world: &World, left: &RecordedCamera, right: &RecordedCamera, limits: &Limits, out: &mut Judge) {
    let subject = format!("baseline of `{}` and `{}`", left.topic, right.topic);
    let missing = |out: &mut Judge, why: &str| out.missing(&subject, why);
    let (Some(of_left), Some(by_p)) = (baseline(left.calibration), baseline(right.calibration)) else {
        return missing(
            out,
            "P of one of the two has no focal length: publish a calibrated camera_info",
        );
    };
    if of_left.abs() < limits.least_m && by_p.abs() < limits.least_m {
        return missing(out, "neither P has a Tx: calibrate the two as a stereo pair");
    }
    let (Some(left_frame), Some(right_frame)) = (left.frame(), right.frame()) else {
        return missing(out, "one of the two has no frame_id: fill it in");
    };
    if left_frame == right_frame {
        return missing(
            out,
            "both have the same frame_id, so TF has no transform between them: give each camera its own frame",
        );
    }
    let Some((left_from_right, _)) = world.graph().chain(&left_frame, &right_frame, |edge| edge.is_rigid) else {
        return missing(
            out,
            &format!("no rigid transform connects `{right_frame}` and `{left_frame}`: publish it on /tf_static"),
        );
    };
    // Where the left camera is the reference its own Tx is 0.
    let by_p = by_p - of_left;
    let by_tf = left_from_right.translation.vector;
    let differs = (by_p - by_tf.x).abs() / by_tf.norm().max(limits.least_m);
    let measured = [
        Measured::new("baseline by P of the two cameras", by_p, "m"),
        Measured::new("x of the right camera in the frame of the left camera", by_tf.x, "m"),
        Measured::new(
            "difference of the baselines / distance of the cameras in TF",
            differs,
            "1",
        )
        .limit(limits.warning),
    ];
    if differs <= limits.warning {
        return out.pass(subject, measured);
    }
    let is_aside = by_tf.x.abs() < limits.aside * by_tf.norm();
    let (words, relation, help) = if is_aside {
        (
            "The right camera is not along x of the left camera: the frames are probably not optical.",
            "not-optical",
            "use the optical frames in both calibrations (x right, z forward)".to_owned(),
        )
    } else if by_p * by_tf.x < 0.0 {
        (
            "The signs differ: left and right are swapped, either in the two topics or in TF.",
            "swapped",
            format!(
                "cover the left lens:\n(1) if the images of the right camera go dark, swap the two topics\n(2) if the images of the left camera go \
                 dark, swap `{left_frame}` and `{right_frame}` in TF"
            ),
        )
    } else {
        (
            "One of the two baselines is wrong.",
            "other-length",
            "measure the distance of the two lenses, and correct the baseline that differs (depth has the same relative error)".to_owned(),
        )
    };
    let severity = if differs > limits.error {
        Severity::Error
    } else {
        Severity::Warning
    };
    let message = format!(
        "the stereo baseline is {by_p:+.4} m on `{}`, but {:+.4} m along x in TF",
        right.topic, by_tf.x
    );
    let finding = Finding::new(severity, &subject, message, right.place())
        .likely()
        .detail(format!(
            "In TF, `{right_frame}` is {:.4} m from `{left_frame}`. {words}",
            by_tf.norm()
        ));
    let finding = finding
        .relation(relation)
        .related(left.place(), "the left camera")
        .help(help);
    out.fail(finding.measured(measured));
}

#[cfg(test)]
mod tests {
    use super::left_topics;

    #[test]
    fn a_right_camera_has_a_left_one() {
        assert_eq!(left_topics("/stereo/right/camera_info"), ["/stereo/left/camera_info"]);
        assert_eq!(left_topics("/cam_right/camera_info"), ["/cam_left/camera_info"]);
        assert_eq!(left_topics("/d435/infra2/camera_info"), ["/d435/infra1/camera_info"]);
        assert!(left_topics("/brightness/camera_info").is_empty());
        assert!(left_topics("/left/camera_info").is_empty());
    }
}
