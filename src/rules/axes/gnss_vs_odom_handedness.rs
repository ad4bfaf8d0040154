//! AXES07: a track of odometry that is the mirror image of the satellites' one.

use std::cell::OnceCell;

use crate::analysis::axes::hand::{exchanged_track, min_minor_m};
use crate::analysis::axes::handedness::{Limits, Votes};
use crate::analysis::motion::{Motion, Stream, Track};
use crate::analysis::{axes::plots, axes::worlds::Worlds, names};
use crate::rules::prelude::*;
use crate::verdict::{Plot, UNEXPLAINED};
use crate::world::motion::{FixRow, PoseRow};

pub(crate) struct GnssVsOdomHandedness;

impl Rule for GnssVsOdomHandedness {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let worlds = Worlds::of(world);
        for (index, bag) in Motion::of(world).bags.iter().enumerate() {
            for fixes in &bag.fixes {
                let (satellites, minor_m) = (fixes.track(), min_minor_m(fixes, limits));
                let exchanged = OnceCell::new();
                let exchanged = || exchanged.get_or_init(|| exchanged_track(fixes)).as_deref();
                for poses in &bag.poses {
                    let subject = format!("{} against {}", poses.subject, fixes.subject);
                    if poses.is_earth_centred() {
                        let why = "the poses are metres from the Earth's centre: x and y lie in no level plane";
                        out.not_applicable(subject, why);
                        continue;
                    }
                    let votes = Votes::of(&satellites, &poses.track(), minor_m, limits);
                    let is_mirrored = votes.majority(limits) == Some(true);
                    out.plot(&subject, || plot(poses, fixes, &satellites, &votes, limits));
                    let swapped = swapped(poses, fixes, exchanged, &votes, minor_m, limits);
                    // Seen from beneath every track is mirrored; and a simulator's poses may have the other hand.
                    let frame = poses.frame.as_ref().filter(|frame| worlds.is_off(index, Some(frame)));
                    let better = |finding: Finding| {
                        let finding = match frame {
                            Some(frame) => finding.unless_about(codes::AXES14, format!("`{frame}`")),
                            None => finding,
                        };
                        if is_mirrored && bag.simulator.is_some() {
                            finding.unless(codes::SENSOR09)
                        } else {
                            finding
                        }
                    };
                    match swapped {
                        Some(finding) => out.fail(better(Finding { subject, ..finding })),
                        None => judge_votes(&subject, poses, fixes, (&votes, better), minor_m, limits, out),
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

fn judge_votes(
    subject: &str,
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    (votes, better): (&Votes, impl FnOnce(Finding) -> Finding),
    minor_m: f64,
    limits: &Limits,
    out: &mut Judge,
) {
    let [turned, mirrored] = votes.says;
    let all = turned + mirrored;
    if votes.windows == 0 {
        let why = format!(
            "the odometry spreads {:.1} m to the side of its way while both are there ({:.0} m long), {minor_m:.1} m are needed",
            votes.widest_m, votes.longest_m
        );
        return out.too_little(subject, why);
    }
    let agreement = votes.agreement();
    let Some(is_mirrored) = votes.majority(limits) else {
        // What is tracked may be another body.
        let is_of_platform = poses.is_way() && poses.child.as_ref().is_some_and(names::is_base);
        if let Some(least) = votes.unexplained(limits).filter(|_| is_of_platform) {
            let finding = unexplained(subject, poses, fixes, (least, limits.unexplained, votes.windows));
            return out.fail(better(finding));
        }
        let why = format!(
            "of {} windows {turned} say turned and {mirrored} mirrored: the tracks differ by more than that",
            votes.windows
        );
        return out.too_little(subject, why);
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
    if let Some(part) = votes.loosely(limits) {
        let finding = unexplained(subject, poses, fixes, (part, limits.mirror_leaves, all));
        return out.fail(better(finding.measured(measured)));
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
    out.fail(better(poses.expressed_in.tell(finding).measured(measured)));
}

/// A finding on two tracks of which neither is the other, turned or mirrored.
fn unexplained(
    subject: &str,
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    (part, limit, windows): (f64, f64, usize),
) -> Finding {
    let message = format!(
        "the tracks on {} and {} contradict each other: in {windows} window(s) the better of the two fits, turned and mirrored, leaves {:.0} % of the \
         satellites' spread, with the scale and an even drift of the heading free",
        poses.topic,
        fixes.topic,
        100.0 * part
    );
    let finding = Finding::error(subject, message, poses.place())
        .likely()
        .relation(UNEXPLAINED)
        .related(fixes.place(), "the satellites' track")
        .unless(codes::TIME01)
        .unless(codes::TIME02)
        .unless(codes::TIME04)
        .help("compare both with a map of the drive: one of them is not where the platform was, or not when");
    finding.measured(
        Measured::new("part that the better fit leaves", part, "1")
            .limit(limit)
            .samples(windows as u64),
    )
}

/// A finding, where the tracks fit once latitude and longitude are exchanged, and as published neither turned nor, by far, mirrored.
/// A track of exchanged coordinates is mirrored, and stretched besides: away from the equator neither fit meets it.
pub(crate) fn swapped<'t>(
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
        "latitude and longitude on {} are exchanged: so read the track on {} fits the satellites' within {rms_m:.2} m, as published it does \
         not",
        fixes.topic, poses.topic
    );
    let finding = Finding::error("", message, fixes.place()).likely().relation("swapped");
    let finding = finding
        .related(poses.place(), "the other track")
        .help("latitude comes first in NavSatFix; GeoJSON, KML and shapes of maps have longitude first");
    Some(finding.measured(Measured::new("residual, exchanged", rms_m, "m").samples(all as u64)))
}
