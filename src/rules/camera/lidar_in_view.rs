//! CAMERA05: whether a camera looks at what the lidar sees, and is upright.

use crate::analysis::camera::in_view::{Views, cameras};
use crate::analysis::camera::looks::{Fault, Limits, ViewEstimate};
use crate::analysis::camera::views::{Attitude, Mistake};
use crate::analysis::{camera::published::RecordedCamera, places::of_numbers};
use crate::rules::prelude::*;
use crate::world::{FrameId, World};

pub(crate) struct LidarInView;

impl Rule for LidarInView {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let views = Views::of(world);
        for (key, camera) in cameras(world) {
            let subject = format!("what lidars show of `{}` in {}", key.1, world.path(camera.bag.source));
            match views.0.get(&key) {
                Some(Ok(shown)) => judge_shown(world, &camera, &key.1, shown, subject, limits, out),
                Some(Err((reason, why))) => out.not_evaluated(subject, *reason, why),
                None => {}
            }
        }
    }
}

fn judge_shown(
    world: &World,
    camera: &RecordedCamera,
    frame: &FrameId,
    shown: &ViewEstimate,
    subject: String,
    limits: &Limits,
    out: &mut Judge,
) {
    let Attitude {
        pitch_deg,
        roll_deg,
        height_m,
    } = shown.attitude;
    let share_of = |what: &str, value: f64| Measured::new(what, value, "1");
    let measured = [
        Measured::new("roll of the image over the ground", roll_deg, "deg").limit(limits.max_roll_deg),
        Measured::new("pitch of the optical axis over the ground", pitch_deg, "deg").samples(shown.clouds as u64),
        Measured::new("height of the camera over the ground", height_m, "m"),
        share_of("share of the lidar's points in the image", shown.share)
            .at_least(limits.blind * shown.most)
            .samples(shown.points as u64),
        share_of("largest such share of a level camera at the same place", shown.most),
    ];
    let fault = match &shown.judged {
        Err((reason, why)) => return out.not_evaluated(subject, *reason, why),
        Ok(None) => return out.pass(subject, measured),
        Ok(Some(fault)) => fault,
    };
    let mut edges = world.graph().edges_to(frame);
    let edge = edges.find_map(|edge| of_numbers(world, edge));
    let place = edge.unwrap_or_else(|| camera.place());
    let (topic, base) = (&shown.topic, &shown.base);
    let finding = match fault {
        Fault::UpsideDown => Finding::warning(
            subject,
            format!("`{frame}` is upside down over the ground on `{topic}`: y (down in the image) points up"),
            place,
        )
        .hint()
        .relation("upside-down")
        .help("if the camera is mounted upright, or its driver rotates the images, rotate the frame by 180 deg about z of the frame"),
        Fault::Under => {
            let message = format!("`{frame}` is {:.2} m below the ground on `{topic}`", -height_m);
            Finding::error(subject, message, place)
                .likely()
                .detail(format!("The ground is below `{base}`."))
                .relation("translation-negated")
                .help("correct the sign of z, or invert the transform")
        }
        Fault::Mistaken(mistakes, share) => {
            let Some(first) = mistakes.first() else { return };
            let looks = if pitch_deg.abs() > limits.max_pitch_deg {
                let side = if pitch_deg > 0.0 { "up" } else { "down" };
                format!("looks {:.0} deg {side}", pitch_deg.abs())
            } else if roll_deg.abs() > limits.max_roll_deg {
                format!("image rolled by {roll_deg:+.0} deg")
            } else {
                "looks away from the points".to_owned()
            };
            let message = format!("`{base}` -> `{frame}`: {} ({looks})", first.text());
            let is_blind = shown.share < limits.blind * shown.most;
            let severity = if is_blind { Severity::Error } else { Severity::Warning };
            let mut finding = Finding::new(severity, subject, message, place).likely();
            if height_m < 0.0 {
                finding = finding.detail(format!("As published, the camera is {:.2} m below the ground.", -height_m));
            }
            finding = finding.detail(format!(
                "With this mistake corrected, the image is upright, the camera is above the ground, and {:.1} % of the points on `{topic}` are in the image.",
                100.0 * share
            ));
            if mistakes.len() > 1 {
                let others: Vec<&str> = mistakes.iter().skip(1).map(|other| other.text()).collect();
                finding = finding.detail(format!("Equally possible: {}.", others.join(", ")));
            }
            finding.relation(first.word()).help(help(mistakes))
        }
    };
    let finding = finding.label("transform of the frame").measured(measured);
    out.fail(finding.related(camera.place(), "the camera"));
}

/// What to do about the one mistake that explains it, or about each of several.
fn help(mistakes: &[Mistake]) -> String {
    if let [only] = mistakes {
        return only.help().to_owned();
    }
    let each = mistakes.iter().zip(1..);
    let each = each.map(|(mistake, number)| format!("\n({number}) {}: {}", mistake.text(), mistake.help()));
    format!("correct the mistake that was made:{}", each.collect::<String>())
}
