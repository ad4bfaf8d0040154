//! Gaps in streams that are otherwise regular: a part of TIME03.

use crate::source::Place;
use crate::verdict::Judge;
use crate::verdict::{Finding, Measured};
use serde::Deserialize;

use crate::advice::together::report_once;
use crate::analysis::time::streams::Stream;

/// A gap of one stream.
struct Gap {
    /// When it was, in log time: nanoseconds.
    from_ns: i64,
    until_ns: i64,
    finding: Finding,
}

/// Reports the gaps of a recording's streams; gaps at the same time make one finding. Returns the subjects that have one.
pub(crate) fn judge_gaps(streams: &[&Stream<'_>], limits: &Limits, out: &mut Judge) -> Vec<String> {
    let mut gaps: Vec<Gap> = streams.iter().filter_map(|stream| gap(stream, limits)).collect();
    let subjects = gaps.iter().map(|gap| gap.finding.subject.clone()).collect();
    // The order of streams decides which one makes the finding; the sort is stable.
    gaps.sort_by_key(|gap| gap.from_ns);
    let mut until_ns = i64::MIN;
    let mut together: Vec<Finding> = Vec::new();
    for gap in gaps {
        if gap.from_ns >= until_ns {
            report_once(std::mem::take(&mut together), "have a gap at that time too", out);
        }
        until_ns = until_ns.max(gap.until_ns);
        together.push(gap.finding);
    }
    report_once(together, "have a gap at that time too", out);
    subjects
}

/// Only a stream that is otherwise regular can have a gap.
fn gap(stream: &Stream<'_>, limits: &Limits) -> Option<Gap> {
    let stamps = stream.stamps;
    let (gap_ns, message) = stamps.largest_gap.as_ref()?;
    let (gap_s, step_s) = (*gap_ns as f64 / 1e9, stamps.median_step_ns? as f64 / 1e9);
    let few = stamps.long_gaps as f64 <= (limits.regular_share * stamps.count as f64).max(1.0) && step_s > 0.0;
    if !few || gap_s <= limits.gap_s || gap_s <= limits.gap_medians * step_s {
        return None;
    }
    // A latched first message is older than the recording.
    if stamps
        .first
        .as_ref()
        .is_some_and(|first| first.index + 1 == message.index)
    {
        return None;
    }
    // After a step back the stream returns to where it was: that is no gap.
    let back_s = stamps.largest_backward.as_ref().map_or(0.0, |(ns, _)| *ns as f64 / 1e9);
    if gap_s <= back_s + 3.0 * step_s {
        return None;
    }
    let what = format!(
        "{}: gap of {gap_s:.2} s in the stamps, otherwise {:.1} Hz",
        stream.subject,
        1.0 / step_s
    );
    let place = Place::message(stream.source, message.clone());
    let finding = Finding::warning(stream.subject.clone(), what, place)
        .likely()
        .label("first message after the gap")
        .help(
            "look for dropped messages, a stalled driver or machine, or a slow recorder. tf2 look-ups in the gap fail, or \
             interpolate across it",
        )
        .measured(Measured::new("largest gap", gap_s, "s").limit(limits.gap_s).samples(stamps.count))
        .measured(Measured::new("median step", step_s, "s"));
    Some(Gap {
        from_ns: message.log_ns.saturating_sub(*gap_ns),
        until_ns: message.log_ns,
        finding,
    })
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_messages: u64,
    pub(crate) jump_back_s: f64,
    pub(crate) repeated_share: f64,
    pub(crate) contradicts_m: f64,
    pub(crate) contradicts_deg: f64,
    pub(crate) gap_s: f64,
    pub(crate) gap_medians: f64,
    pub(crate) regular_share: f64,
}
