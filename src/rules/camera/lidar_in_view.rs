//! CAMERA05: whether a camera looks at what the lidar sees, and the right way up.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Deserialize;

use crate::rules::ground::Planes;
use crate::rules::{Evidence, Judge, Need, Rule, limits_of, places};
use crate::verdict::{Finding, Measured};
use crate::world::{FrameId, World};

use super::Published;
use super::looks::{Fault, Shown, Why, look};
use super::views::Attitude;

/// CAMERA05.
pub struct LidarInView;

/// Limits of CAMERA05.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    pub(super) min_clouds: usize,
    pub(super) near_m: f64,
    pub(super) far_m: f64,
    pub(super) min_points: usize,
    pub(super) min_most: f64,
    pub(super) blind: f64,
    pub(super) seeing: f64,
    pub(super) max_pitch_deg: f64,
    pub(super) max_roll_deg: f64,
    pub(super) mended_roll_deg: f64,
    pub(super) mended_pitch_deg: f64,
    pub(super) max_lean_deg: f64,
    pub(super) max_away_m: f64,
    pub(super) under_m: f64,
    pub(super) ahead_deg: f64,
}

/// What lidars show of every camera of a world: by recording and frame.
pub(super) struct Views(BTreeMap<(usize, FrameId), Result<Shown, Why>>);

impl Views {
    /// Worked out once.
    fn of(world: &World) -> Arc<Self> {
        // What it rests on is made first: a derivation must not ask for another.
        let planes = Planes::of(world);
        world.derived(|world| {
            let limits = limits_of::<LidarInView>();
            let views = cameras(world).into_iter().filter_map(|(key, camera)| {
                let shown = look(world, &planes, &camera, &key.1, limits.as_ref()?);
                Some((key, shown))
            });
            Self(views.collect())
        })
    }
}

/// Whether this rule has a finding on a camera's frame.
pub(super) fn reports(world: &World, frame: &FrameId) -> bool {
    let views = Views::of(world);
    let of_frame = |(key, shown): (&(usize, FrameId), &Result<Shown, Why>)| {
        key.1 == *frame && shown.as_ref().is_ok_and(|shown| matches!(shown.judged, Ok(Some(_))))
    };
    views.0.iter().any(of_frame)
}

/// The first calibration of every camera's frame.
fn cameras(world: &World) -> BTreeMap<(usize, FrameId), Published<'_>> {
    let mut cameras = BTreeMap::new();
    for published in Published::all(world) {
        let index = world.bags.iter().position(|bag| bag.source == published.bag.source);
        if let (Some(index), Some(frame)) = (index, published.frame()) {
            cameras.entry((index, frame)).or_insert(published);
        }
    }
    cameras
}

impl Rule for LidarInView {
    const PAGE: &'static str = include_str!("../../../rules/camera/lidar-in-view.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
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
    camera: &Published,
    frame: &FrameId,
    shown: &Shown,
    subject: String,
    limits: &Limits,
    out: &mut Judge,
) {
    let Attitude {
        pitch_deg,
        roll_deg,
        height_m,
    } = shown.attitude;
    let measured = [
        Measured::new("share of the lidar's points in the image", shown.share, "1")
            .limit(limits.blind * shown.most)
            .samples(shown.points as u64),
        Measured::new("the largest share of a level camera there", shown.most, "1"),
        Measured::new("angle of the view over the ground's horizon", pitch_deg, "deg").samples(shown.clouds as u64),
        Measured::new("roll of the image against the ground", roll_deg, "deg").limit(limits.max_roll_deg),
        Measured::new("height over the ground", height_m, "m"),
    ];
    let fault = match &shown.judged {
        Err((reason, why)) => return out.not_evaluated(subject, *reason, why),
        Ok(None) => return out.pass(subject, measured),
        Ok(Some(fault)) => fault,
    };
    let edge = world
        .graph()
        .edges_to(frame)
        .find_map(|edge| places::of_numbers(world, edge));
    let place = edge.unwrap_or_else(|| camera.place());
    let (topic, base) = (&shown.topic, &shown.base);
    let finding = match fault {
        Fault::UpsideDown => Finding::warning(
            subject,
            format!("`{frame}` is upside down over the ground that `{topic}` shows: its y axis, the image's down, points up"),
            place,
        )
        .hint()
        .relation("upside-down")
        .help("right for a camera that hangs on its head and whose images are not turned; else turn the frame by 180 deg about its z"),
        Fault::Under => Finding::error(
            subject,
            format!("`{frame}` lies {:.2} m under the ground that `{topic}` shows under `{base}`", -height_m),
            place,
        )
        .likely()
        .relation("translation-negated")
        .help("look at the sign of its z, and whether the transform is told the wrong way round"),
        Fault::Mistaken(mistakes, share) => {
            let Some(first) = mistakes.first() else { return };
            let others: Vec<&str> = mistakes.iter().skip(1).map(|other| other.word()).collect();
            let others = if others.is_empty() {
                String::new()
            } else {
                format!(" (indistinguishable here: {})", others.join(", "))
            };
            let looks = if pitch_deg.abs() > limits.max_pitch_deg {
                format!("looks {pitch_deg:+.0} deg over the horizon")
            } else if roll_deg.abs() > limits.max_roll_deg {
                format!("lies on its side ({roll_deg:+.0} deg)")
            } else {
                "looks away".to_owned()
            };
            let message = format!(
                "`{frame}` {looks} over the ground that `{topic}` shows, with {:.1} % of the points in its image: {}{others}; without that {:.1} % are, \
                 and the image is upright",
                100.0 * shown.share,
                first.text(),
                100.0 * share
            );
            let finding = if shown.share < limits.blind * shown.most {
                Finding::error(subject, message, place)
            } else {
                Finding::warning(subject, message, place)
            };
            finding.likely().relation(first.word()).help(first.help())
        }
    };
    let finding = finding
        .related(camera.place(), "the camera")
        .label("where the frame is told");
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}
