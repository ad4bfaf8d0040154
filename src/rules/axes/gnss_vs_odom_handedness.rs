//! AXES07: an odometry track that is the mirror image of the GNSS track.

mod scale;

use std::cell::OnceCell;

use crate::advice::diagnosis::swapped_track;
use crate::analysis::axes::hand::{exchanged_track, min_minor_m};
use crate::analysis::axes::handedness::{Limits, Votes};
use crate::analysis::motion::{Motion, Stream, Track};
use crate::analysis::{axes::plots, axes::worlds::Worlds};
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
                let mut cause: Option<String> = None;
                let mut scales = Vec::new();
                for poses in &bag.poses {
                    let subject = format!("{} against {}", poses.subject, fixes.subject);
                    if poses.is_earth_centred() {
                        let why = "the poses are Earth-centred (ECEF), so x and y are not horizontal";
                        out.not_applicable(subject, why);
                        continue;
                    }
                    let votes = Votes::of(world, &satellites, &poses.track(), minor_m, limits);
                    let is_mirrored = votes.majority(limits) == Some(true);
                    out.plot(&subject, || plot(poses, fixes, &satellites, &votes, limits));
                    let swapped = swapped(world, poses, fixes, exchanged, &votes, minor_m, limits);
                    // With z down every track is mirrored; and a simulator's poses may be left-handed.
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
                        Some(finding) => {
                            // The fault is of the fixes: it is reported once, whatever they are compared with.
                            let finding = cause.iter().fold(finding, Finding::same_cause_as);
                            cause.get_or_insert_with(|| subject.clone());
                            out.fail(better(Finding { subject, ..finding }));
                        }
                        None => judge_votes(
                            &subject,
                            (poses, fixes, &mut scales),
                            (&votes, better),
                            minor_m,
                            limits,
                            out,
                        ),
                    }
                }
            }
        }
    }
}

/// The GNSS track with the odometry fitted to it; also mirrored, if that may fit better.
fn plot(
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    satellites: &Track,
    votes: &Votes,
    limits: &Limits,
) -> Option<Plot> {
    let title = format!("Track of {} fitted to that of {}", poses.subject, fixes.subject);
    let aligned = votes.aligned_over(satellites, &poses.track(), limits);
    plots::tracks(title, aligned, votes.majority(limits) != Some(false))
}

fn judge_votes(
    subject: &str,
    (poses, fixes, scales): (&Stream<PoseRow>, &Stream<FixRow>, &mut Vec<scale::WrongScale>),
    (votes, better): (&Votes, impl FnOnce(Finding) -> Finding),
    minor_m: f64,
    limits: &Limits,
    out: &mut Judge,
) {
    let [turned, mirrored] = votes.says;
    let all = turned + mirrored;
    if votes.windows == 0 {
        let why = format!(
            "while both are recorded, the odometry spreads only {:.1} m sideways over {:.0} m, {minor_m:.1} m are needed: record a turn",
            votes.widest_m, votes.longest_m
        );
        return out.too_little(subject, why);
    }
    let agreement = votes.agreement();
    let Some(is_mirrored) = votes.majority(limits) else {
        // The pose may be of another body.
        if let Some(least) = votes.unexplained(limits).filter(|_| scale::is_of_platform(poses)) {
            let finding = unexplained(subject, poses, fixes, (least, limits.unexplained, votes.windows));
            return out.fail(better(finding));
        }
        let why = format!(
            "of {} windows {turned} fit rotated and {mirrored} fit mirrored, so the tracks differ in another way",
            votes.windows
        );
        return out.too_little(subject, why);
    };
    let [rms_turned, rms_mirrored] = votes.rms_m;
    let only_rotated =
        Measured::new("deviation from the GNSS track, only rotated (rms)", rms_turned, "m").samples(all as u64);
    let measured = [
        if is_mirrored {
            only_rotated.limit(limits.min_ratio * rms_mirrored)
        } else {
            only_rotated
        },
        Measured::new("deviation from the GNSS track, mirrored (rms)", rms_mirrored, "m").samples(all as u64),
        Measured::new("share of the parts of the track with this result", agreement, "1")
            .at_least(limits.min_agreement),
    ];
    if !is_mirrored {
        out.pass(subject, measured);
        return scale::judge(poses, fixes, scales, votes, limits, out);
    }
    if let Some(part) = votes.loosely(limits) {
        let finding = unexplained(subject, poses, fixes, (part, limits.mirror_leaves, all));
        return out.fail(better(finding.measured(measured)));
    }
    let (from, to) = votes.span_s();
    let (name, fix) = (poses.subject.trim_start_matches("topic "), &fixes.topic);
    let message = format!(
        "{name}: track is the mirror image of the GNSS track on `{fix}` ({rms_turned:.2} m off, {rms_mirrored:.2} m if mirrored)"
    );
    let finding = Finding::error(subject, message, poses.place())
        .likely()
        .relation("mirrored")
        .detail(format!(
            "Compared from {from:.0} to {to:.0} s of the recording. The limit is {} times the deviation of the mirrored track.",
            limits.min_ratio
        ))
        .related(fixes.place(), "GNSS track")
        .help(format!(
            "plot both tracks on a map to see which track is mirrored, then correct that one:\n\
             (1) {name} in NED (north, east, down): publish the position (x, y, z) as (y, x, -z), and the orientation in ENU\n\
             (2) {name} with y to the right: negate y of the position\n\
             (3) `{fix}` with latitude and longitude swapped: swap them back"
        ));
    out.fail(better(poses.expressed_in.annotate(finding).measured(measured)));
}

/// A finding on two tracks that match neither rotated nor mirrored.
fn unexplained(
    subject: &str,
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    (part, limit, windows): (f64, f64, usize),
) -> Finding {
    let message = format!(
        "`{}`: track has another shape than the GNSS track on `{}` (deviation of {:.0} % of the track's extent)",
        poses.topic,
        fixes.topic,
        100.0 * part
    );
    let finding = Finding::error(subject, message, poses.place())
        .likely()
        .relation(UNEXPLAINED)
        .detail(format!(
            "{windows} part(s) of the track were compared, rotated and mirrored, with a free scale factor and a constant drift of the heading: \
             neither matches."
        ))
        .related(fixes.place(), "GNSS track")
        .unless(codes::TIME01)
        .unless(codes::TIME02)
        .unless(codes::TIME04)
        .help("plot both tracks on a map, and correct the positions or the timestamps of the track that is wrong");
    finding.measured(
        Measured::new("deviation of the better fit / extent of the GNSS track", part, "1")
            .limit(limit)
            .samples(windows as u64),
    )
}

/// A finding, if the tracks match once latitude and longitude are swapped back, and as published match neither rotated nor, by far,
/// mirrored. A track with swapped coordinates is mirrored and stretched: away from the equator neither fit matches it.
pub(crate) fn swapped<'t>(
    world: &Estimates,
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    exchanged: impl FnOnce() -> Option<&'t Track>,
    votes: &Votes,
    minor_m: f64,
    limits: &Limits,
) -> Option<Finding> {
    // As published the tracks must not fit rotated, and in the same windows fit mirrored clearly worse than the swapped ones do.
    if votes.windows == 0 || votes.majority(limits) == Some(false) {
        return None;
    }
    let votes = Votes::of(world, exchanged()?, &poses.track(), minor_m, limits);
    if votes.majority(limits) != Some(false) {
        return None;
    }
    let as_published_m = votes.better_m(&fixes.track(), &poses.track(), limits)?;
    let ([rms_m, _], [all, _]) = (votes.rms_m, votes.says);
    // A straight track stays nearly straight when it is mirrored and stretched: this needs the squared ratio.
    if rms_m * limits.min_ratio.powi(2) > as_published_m {
        return None;
    }
    let message = format!(
        "{} (swapped back, `{}` fits to {rms_m:.2} m)",
        swapped_track(&format!("`{}`", fixes.topic)),
        poses.topic
    );
    let finding = Finding::error("", message, fixes.place()).likely().relation("swapped");
    let finding = finding
        .detail(format!(
            "As published, the tracks deviate by {as_published_m:.2} m (rms) at best, rotated or mirrored."
        ))
        .related(poses.place(), "compared with this track")
        .help("swap latitude and longitude: NavSatFix has latitude first, while GeoJSON, KML and map shapefiles have longitude first");
    let measured = Measured::new("deviation of the tracks, swapped back (rms)", rms_m, "m").samples(all as u64);
    Some(finding.measured(measured))
}
