//! TIME03: stamps of one stream run backwards, repeat, or leave gaps.

mod gaps;

use crate::analysis::time::streams::{Stream, StreamSource, streams};
use crate::rules::prelude::*;
use crate::rules::time::stamp_monotonic::gaps::{Limits, judge_gaps};
use crate::source::MessageRef;

pub(crate) struct StampMonotonic;

impl Rule for StampMonotonic {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            let streams = streams(bag);
            let reused = world.limits::<crate::analysis::time::streams::Limits>();
            let is_reused = |stream: &Stream<'_>| stream.is_reused(&reused);
            let judged: Vec<&Stream<'_>> = streams.iter().filter(|stream| is_judged(stream, limits, out)).collect();
            let with_gap = judge_gaps(&judged, limits, out);
            for stream in judged {
                let has_gap = with_gap.contains(&stream.subject);
                judge_order(stream, has_gap, is_reused(stream), limits, out);
            }
        }
    }
}

fn is_judged(stream: &Stream<'_>, limits: &Limits, out: &mut Judge) -> bool {
    let subject = stream.subject.clone();
    let stamps = stream.stamps;
    if stamps.count < limits.min_messages {
        out.too_little(
            subject,
            format!("{} stamped messages, {} are needed", stamps.count, limits.min_messages),
        );
        return false;
    }
    if stamps.zero == stamps.count {
        out.not_applicable(subject, "every stamp is zero");
        return false;
    }
    true
}

fn judge_order(stream: &Stream<'_>, has_gap: bool, is_reused: bool, limits: &Limits, out: &mut Judge) {
    let stamps = stream.stamps;
    let mut repeated = repeated(stream, limits);
    if is_reused {
        repeated = repeated.map(|finding| finding.unless(codes::TIME10));
    }
    let findings = [backward(stream, limits), repeated, contradicting(stream, limits)];
    let mut sound = !has_gap;
    for finding in findings.into_iter().flatten() {
        sound = false;
        out.fail(finding);
    }
    if sound && is_reused {
        out.not_applicable(stream.subject.clone(), "nearly all messages repeat a stamp");
    } else if sound {
        let back_s = stamps.largest_backward.as_ref().map_or(0.0, |(ns, _)| *ns as f64 / 1e9);
        out.pass(
            stream.subject.clone(),
            [Measured::new("largest step back", back_s, "s")
                .limit(limits.jump_back_s)
                .samples(stamps.count)],
        );
    }
}

fn at(stream: &Stream<'_>, message: &MessageRef) -> Place {
    Place::message(stream.source, message.clone())
}

/// Small steps back are normal where several publishers share a topic; the stamps of one publisher only grow.
fn backward(stream: &Stream<'_>, limits: &Limits) -> Option<Finding> {
    let (step_ns, message) = stream.stamps.largest_backward.as_ref()?;
    let step_s = *step_ns as f64 / 1e9;
    let jump = step_s >= limits.jump_back_s;
    if !jump && !stream.single_frame {
        return None;
    }
    let severity = if jump && stream.single_frame {
        Severity::Error
    } else {
        Severity::Warning
    };
    let times = match stream.stamps.backward {
        1 => "once, by".to_owned(),
        times => format!("{times} times, by up to"),
    };
    let what = format!("{}: stamps run backwards {times} {step_s:.3} s", stream.subject);
    let finding = Finding::new(severity, stream.subject.clone(), what, at(stream, message))
        .help(if jump {
            "look for a clock that was set back, a joined or looped recording, or two publishers on one topic"
        } else {
            "look for two publishers on one topic, or messages that are sent out of order"
        })
        .measured(
            Measured::new("largest step back", step_s, "s")
                .limit(limits.jump_back_s)
                .samples(stream.stamps.count),
        )
        .measured(Measured::new("steps back", stream.stamps.backward as f64, "count"));
    Some(if jump { finding } else { finding.likely() })
}

/// Of two transforms with one stamp tf2 keeps the first; a replay or another node may get the other.
fn contradicting(stream: &Stream<'_>, limits: &Limits) -> Option<Finding> {
    let StreamSource::Edge(edge) = stream.of else {
        return None;
    };
    let found = edge.contradictions.as_ref()?;
    let angle_deg = found.angle_rad.to_degrees();
    if found.distance_m <= limits.contradicts_m && angle_deg <= limits.contradicts_deg {
        return None;
    }
    let what = format!(
        "{}: two poses at one stamp, up to {:.2} m and {angle_deg:.1} deg apart",
        stream.subject, found.distance_m
    );
    let finding = Finding::warning(stream.subject.clone(), what, at(stream, &found.worst))
        .detail("tf2 keeps the first transform of a stamp and drops the others.")
        .help("publish this transform from one node only, once for each stamp")
        .measured(Measured::new("largest difference at one stamp", found.distance_m, "m").limit(limits.contradicts_m))
        .measured(Measured::new("largest rotation at one stamp", angle_deg, "deg").limit(limits.contradicts_deg))
        .measured(Measured::new("contradictions", found.count as f64, "count").samples(stream.stamps.count));
    Some(finding)
}

fn repeated(stream: &Stream<'_>, limits: &Limits) -> Option<Finding> {
    let stamps = stream.stamps;
    let share = stamps.repeated as f64 / stamps.count as f64;
    let message = stamps.first_repeated.as_ref()?;
    if share <= limits.repeated_share || !stream.single_frame {
        return None;
    }
    let what = format!(
        "{}: {} of {} stamps repeat the previous stamp",
        stream.subject, stamps.repeated, stamps.count
    );
    Some(
        Finding::note(stream.subject.clone(), what, at(stream, message))
            .detail(if matches!(stream.of, StreamSource::Edge(_)) {
                "tf2 ignores a transform with a repeated stamp."
            } else {
                "Filters divide by a time step of zero."
            })
            .help("stamp each message with the time of its measurement; publish data that do not change (a calibration) once, latched")
            .measured(
                Measured::new("share of repeated stamps", share, "1")
                    .limit(limits.repeated_share)
                    .samples(stamps.count),
            ),
    )
}
