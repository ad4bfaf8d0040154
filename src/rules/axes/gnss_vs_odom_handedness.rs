//! AXES07: a track of odometry that is the mirror image of the satellites' one.

use std::cell::OnceCell;

use serde::Deserialize;

use crate::math::stats::median;
use crate::rules::motion::{Motion, Stream, Track};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated, Plot};
use crate::world::World;
use crate::world::motion::{FixRow, PoseRow};

use super::handedness::Votes;
use super::plots;
use super::worlds::Worlds;

/// AXES07.
pub struct GnssVsOdomHandedness;

/// Limits of AXES07.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    pub(super) window_s: f64,
    pub(super) longest_window_s: f64,
    pub(super) min_points: usize,
    min_minor_m: f64,
    minor_of_sigma: f64,
    least_sigma_m: f64,
    pub(super) min_ratio: f64,
    pub(super) max_residual: f64,
    pub(super) min_agreement: f64,
    pub(super) drift_deg_s: f64,
}

impl Rule for GnssVsOdomHandedness {
    const PAGE: &'static str = include_str!("../../../rules/axes/gnss-vs-odom-handedness.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let worlds = Worlds::of(world);
        for (index, bag) in Motion::of(world).bags.iter().enumerate() {
            for fixes in &bag.fixes {
                let (satellites, minor_m) = (fixes.track(), min_minor_m(fixes, limits));
                let exchanged = OnceCell::new();
                let exchanged = || exchanged.get_or_init(|| exchanged_track(fixes)).as_ref();
                for poses in &bag.poses {
                    let subject = format!("{} against {}", poses.subject, fixes.subject);
                    if poses.is_earth_centred() {
                        let why = "the poses are metres from the Earth's centre: x and y lie in no level plane (GEO03)";
                        out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
                        continue;
                    }
                    let votes = Votes::of(&satellites, &poses.track(), minor_m, limits);
                    let is_mirrored = votes.majority(limits) == Some(true);
                    out.plot(&subject, || plot(poses, fixes, &satellites, &votes, limits));
                    let swapped = swapped(poses, fixes, exchanged, &votes, minor_m, limits);
                    if (is_mirrored || swapped.is_some()) && worlds.is_off(index, poses.frame.as_ref()) {
                        let why = "mirrored: part of what AXES14 reports of the frame, whose z does not point up";
                        out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
                        continue;
                    }
                    if let Some(finding) = swapped {
                        out.fail(Finding { subject, ..finding });
                        continue;
                    }
                    if is_mirrored && bag.simulator.is_some() {
                        let why = "it is mirrored, and the poses are a simulator's: SENSOR09 reports it";
                        out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
                    } else {
                        judge_votes(&subject, poses, fixes, &votes, minor_m, limits, out);
                    }
                }
            }
        }
    }
}

/// The satellites' track with the odometry laid over it; mirrored besides, where that may fit better.
fn plot(
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    satellites: &Track,
    votes: &Votes,
    limits: &Limits,
) -> Option<Plot> {
    let title = format!("Track of {} laid over that of {}", poses.subject, fixes.subject);
    let laid = votes.laid_over(satellites, &poses.track(), limits);
    plots::tracks(title, laid, votes.majority(limits) != Some(false))
}

/// What one pair of tracks says.
pub(crate) struct Hand {
    /// Whether it is mirrored.
    pub(crate) is_mirrored: bool,
    /// Share of the windows that agree.
    pub(crate) measured: Measured,
}

/// Whether a track is the mirror image of the satellites'; `None` where the two do not tell.
pub(crate) fn hand(fixes: &Stream<FixRow>, track: &Track, limits: &Limits) -> Option<Hand> {
    let votes = Votes::of(&fixes.track(), track, min_minor_m(fixes, limits), limits);
    Some(Hand {
        is_mirrored: votes.majority(limits)?,
        measured: Measured::new("agreement of windows", votes.agreement(), "1").limit(limits.min_agreement),
    })
}

/// A finding, where the tracks fit once latitude and longitude are exchanged, and as told neither turned nor, by far, mirrored.
/// A track of exchanged coordinates is mirrored, and stretched besides: away from the equator neither fit meets it.
fn swapped<'t>(
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    exchanged: impl FnOnce() -> Option<&'t Track>,
    votes: &Votes,
    minor_m: f64,
    limits: &Limits,
) -> Option<Finding> {
    // As told the tracks must not fit turned, and mirrored, in the same windows, clearly worse than the exchanged ones do.
    if votes.windows == 0 || votes.majority(limits) == Some(false) {
        return None;
    }
    let votes = Votes::of(exchanged()?, &poses.track(), minor_m, limits);
    if votes.majority(limits) != Some(false) {
        return None;
    }
    let as_told_m = votes.better_m(&fixes.track(), &poses.track(), limits)?;
    let ([rms_m, _], [all, _]) = (votes.rms_m, votes.says);
    // A straight way that is mirrored is nearly as straight once stretched: that takes the square of what tells a mirror.
    if rms_m * limits.min_ratio.powi(2) > as_told_m {
        return None;
    }
    let message = format!(
        "latitude and longitude on {} are exchanged: so read the track on {} fits the satellites' within {rms_m:.2} m, as told it does \
         not",
        fixes.topic, poses.topic
    );
    let finding = Finding::error("", message, fixes.place()).likely().relation("swapped");
    let finding = finding
        .related(poses.place(), "the other track")
        .help("latitude comes first in NavSatFix; GeoJSON, KML and shapes of maps have longitude first");
    Some(finding.measured(Measured::new("residual, exchanged", rms_m, "m").samples(all as u64)))
}

/// The track of a receiver with latitude and longitude exchanged; `None` where that is no place on the Earth.
fn exchanged_track(fixes: &Stream<FixRow>) -> Option<Track> {
    let mut exchanged = fixes.clone();
    for fix in exchanged.stretches.iter_mut().flatten() {
        std::mem::swap(&mut fix.row.latitude_deg, &mut fix.row.longitude_deg);
    }
    let is_place = exchanged.rows().all(|fix| fix.row.latitude_deg.abs() <= 90.0);
    is_place.then(|| Track::of_fixes(&exchanged))
}

/// How far odometry must spread to be told from its mirror image under this receiver's noise.
fn min_minor_m(fixes: &Stream<FixRow>, limits: &Limits) -> f64 {
    let sigmas: Vec<f64> = fixes.rows().filter_map(|timed| timed.row.horizontal_sd_m()).collect();
    median(&sigmas).map_or(limits.min_minor_m, |sigma| {
        limits.minor_of_sigma * sigma.max(limits.least_sigma_m)
    })
}

fn judge_votes<R, S>(
    subject: &str,
    poses: &Stream<R>,
    fixes: &Stream<S>,
    votes: &Votes,
    minor_m: f64,
    limits: &Limits,
    out: &mut Judge,
) where
    R: crate::world::motion::Row,
    S: crate::world::motion::Row,
{
    let [turned, mirrored] = votes.says;
    let all = turned + mirrored;
    if votes.windows == 0 {
        let why = format!(
            "the odometry spreads {:.1} m to the side of its way while both are there ({:.0} m long), {minor_m:.1} m are needed",
            votes.widest_m, votes.longest_m
        );
        return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
    }
    let agreement = votes.agreement();
    let Some(is_mirrored) = votes.majority(limits) else {
        let why = format!(
            "of {} windows {turned} say turned and {mirrored} mirrored: the tracks differ by more than that",
            votes.windows
        );
        return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
    };
    let [rms_turned, rms_mirrored] = votes.rms_m;
    let measured = [
        Measured::new("residual, turned", rms_turned, "m").samples(all as u64),
        Measured::new("residual, mirrored", rms_mirrored, "m").samples(all as u64),
        Measured::new("agreement of windows", agreement, "1").limit(limits.min_agreement),
    ];
    if !is_mirrored {
        return out.pass(subject, measured);
    }
    let (from, to) = votes.span_s();
    let message = format!(
        "the track on {} is the mirror image of the satellites' on {}: laid over it from {from:.0} to {to:.0} s it is {rms_mirrored:.2} m \
         off mirrored, {rms_turned:.2} m turned",
        poses.topic, fixes.topic
    );
    let finding = Finding::error(subject, message, poses.place())
        .likely()
        .relation("mirrored")
        .related(fixes.place(), "the satellites' track")
        .help(
            "one of the two has x and y changed (north and east taken for x and y), or one of them negated: NED positions \
             become ENU as (y, x, -z); latitude comes before longitude",
        );
    out.fail(
        measured
            .into_iter()
            .fold(poses.told_in.tell(finding), Finding::measured),
    );
}
