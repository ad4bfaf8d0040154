//! TIME08: at which moment of a scan its header is stamped.

use crate::analysis::lidar::Clouds;
use crate::analysis::time::header::{Limits, points_after_header_s};
use crate::analysis::time::known_offsets::{Explanation, KnownOffset, Tolerance, explain};
use crate::analysis::time::streams::log_start_s;
use crate::rules::prelude::*;
use crate::world::cloud::{CloudSample, PointTimes};

pub(crate) struct PointTimeReference;

/// The moment of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Moment {
    Start,
    Middle,
    End,
    Elsewhere,
}

impl Moment {
    fn words(self) -> &'static str {
        match self {
            Self::Start => "at the start",
            Self::Middle => "in the middle",
            Self::End => "at the end",
            Self::Elsewhere => "outside of it",
        }
    }
}

/// A scan against its header.
struct ScanTiming<'w> {
    sample: &'w CloudSample,
    moment: Moment,
    /// From the header's stamp to the first point and to the last, seconds.
    from_header_s: [f64; 2],
}

impl Rule for PointTimeReference {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "times of the points", out);
        for clouds in Clouds::published(world).filter(|clouds| clouds.timed().next().is_some()) {
            judge_clouds(&clouds, limits, out);
        }
    }
}

fn judge_clouds(clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("header against the times of the points");
    let timings: Vec<ScanTiming> = clouds
        .timed()
        .filter_map(|(sample, times)| scan_timing(clouds, sample, times, limits))
        .collect();
    if timings.len() < limits.min_clouds {
        let why = format!(
            "in {} clouds the times of the points can be compared with the header stamp (unit and origin are known); {} are needed",
            timings.len(),
            limits.min_clouds
        );
        return out.too_little(subject, why);
    }
    let count = |moment: Moment| timings.iter().filter(|timing| timing.moment == moment).count();
    let moments = [Moment::Start, Moment::Middle, Moment::End, Moment::Elsewhere];
    let most = moments
        .into_iter()
        .max_by_key(|moment| count(*moment))
        .unwrap_or(Moment::Start);
    let mean = |index: usize| {
        let of = timings.iter().filter_map(|timing| timing.from_header_s.get(index));
        of.sum::<f64>() / timings.len() as f64
    };
    let measured = [
        Measured::new("time of the first point minus header stamp", mean(0), "s").samples(timings.len() as u64),
        Measured::new("time of the last point minus header stamp", mean(1), "s").samples(timings.len() as u64),
    ];
    let place = |timing: &ScanTiming| Place::message(clouds.bag.source, timing.sample.at.clone());
    if most == Moment::Elsewhere {
        let (middle_s, topic) = (f64::midpoint(mean(0), mean(1)), &clouds.topic.topic);
        let (size_s, way) = (middle_s.abs(), if middle_s > 0.0 { "ahead of" } else { "behind" });
        let (message, help) = match cause(clouds, middle_s) {
            Some(known) => (
                format!("`{topic}`: points are {size_s:.1} s {way} the header: {}", known.what),
                format!(
                    "change the times of the points by {:+} s, or stamp header and points with one clock",
                    -known.offset_s
                ),
            ),
            None => (
                format!("`{topic}`: header stamp is outside of the scan: points are {size_s:.3} s {way} the header"),
                "stamp header and points with one clock, the header at the first or the last point of the scan"
                    .to_owned(),
            ),
        };
        let finding = Finding::warning(subject, message, clouds.place())
            .likely()
            .relation("elsewhere")
            .help(help);
        return out.fail(finding.measured(measured));
    }
    let other = timings.iter().find(|timing| timing.moment != most);
    if let Some(other) = other.filter(|_| count(most) < timings.len() - 1) {
        let message = format!(
            "`{}`: header stamp is {} of the scan in {} of {} clouds, {} in others",
            clouds.topic.topic,
            most.words(),
            count(most),
            timings.len(),
            other.moment.words()
        );
        let finding = Finding::error(subject, message, place(other))
            .likely()
            .relation("changes")
            .help(
                "stamp every scan at the same moment, which deskewing needs; usual causes are lost packets, and a clock that is set while \
                 recording",
            );
        return out.fail(finding.measured(measured));
    }
    out.pass(subject, measured);
}

/// The known cause of the time from the header to the middle of its scan.
fn cause(clouds: &Clouds, middle_s: f64) -> Option<KnownOffset> {
    let period_s = clouds.period_s().unwrap_or(0.0);
    let tolerance = Tolerance {
        usual_s: period_s,
        fine_s: period_s,
    };
    match explain(middle_s, tolerance, log_start_s(clouds.bag)) {
        Explanation::One(known) => Some(known),
        _ => None,
    }
}

/// When the points of a cloud were measured, relative to the header stamp; `None` where unit, period or origin of their times are unknown.
fn scan_timing<'w>(
    clouds: &Clouds,
    sample: &'w CloudSample,
    times: &PointTimes,
    limits: &Limits,
) -> Option<ScanTiming<'w>> {
    let (period_s, from_header_s) = (
        clouds.period_s()?,
        points_after_header_s(clouds, sample, times, limits)?,
    );
    let [first, last] = from_header_s.map(|after_s| after_s / period_s);
    let near = |value: f64| value.abs() <= limits.near;
    let moment = if near(first) {
        Moment::Start
    } else if near(last) {
        Moment::End
    } else if near(first + last) {
        Moment::Middle
    } else if first > limits.beside || last < -limits.beside {
        Moment::Elsewhere
    } else if first.abs() <= last.abs() {
        Moment::Start
    } else {
        Moment::End
    };
    Some(ScanTiming {
        sample,
        moment,
        from_header_s,
    })
}
