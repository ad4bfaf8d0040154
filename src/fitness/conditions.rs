//! Conditions of all kinds of calibration: made, measured on two streams, or taken from what the rules say.

use nalgebra::Vector3;

use crate::analysis::Estimates;
use crate::analysis::lidar::Clouds;
use crate::source::Confidence;
use crate::verdict::{Judge, Measured, NotEvaluated, Outcome, Row, RuleCode, Severity, Verdict};
use crate::world::{BagEvidence, FrameId};

use super::stamped::Stamped;
use super::{Condition, ConditionState, Pair};

/// Numbers of rules that are shown with a condition.
const MAX_MEASURED: usize = 4;

/// Types of messages whose absence matters, if they could not be read.
const READ: [&str; 12] = [
    "PointCloud2",
    "Imu",
    "Image",
    "CompressedImage",
    "CameraInfo",
    "Odometry",
    "PoseStamped",
    "PoseWithCovarianceStamped",
    "TransformStamped",
    "TFMessage",
    "tfMessage",
    "Path",
];

impl Condition {
    fn of(name: &'static str, asks: impl Into<String>, state: ConditionState) -> Self {
        Self {
            name,
            asks: asks.into(),
            state,
            reason: None,
            record: None,
            measured: Vec::new(),
            is_needed: true,
        }
    }

    /// One that was evaluated.
    pub(super) fn judged(name: &'static str, asks: impl Into<String>, is_met: bool) -> Self {
        let state = if is_met {
            ConditionState::Met
        } else {
            ConditionState::NotMet
        };
        Self::of(name, asks, state)
    }

    /// One that was not evaluated, and why.
    pub(super) fn open(name: &'static str, asks: impl Into<String>, why: impl Into<String>) -> Self {
        Self {
            reason: Some(why.into()),
            ..Self::of(name, asks, ConditionState::NotEvaluated)
        }
    }

    pub(super) fn measured(mut self, measured: impl IntoIterator<Item = Measured>) -> Self {
        self.measured.extend(measured);
        self
    }

    /// With the reason, unless it is met.
    pub(super) fn because(mut self, reason: impl Into<String>) -> Self {
        if self.state != ConditionState::Met {
            self.reason = Some(reason.into());
        }
        self
    }

    /// With what to record or add, unless it is met.
    pub(super) fn record(mut self, record: impl Into<String>) -> Self {
        if self.state != ConditionState::Met {
            self.record = Some(record.into());
        }
        self
    }

    /// Worth knowing; the calibration is possible without it.
    pub(super) fn beside(mut self) -> Self {
        self.is_needed = false;
        self
    }

    /// What was not found in a part of a recording may be in the rest: then it was not evaluated.
    pub(super) fn unless_partly_read(mut self, bag: &BagEvidence) -> Self {
        if let Some(share) = bag.share_of_messages()
            && self.state == ConditionState::NotMet
        {
            self.state = ConditionState::NotEvaluated;
            self.reason = Some(format!("only {:.0} % of the messages were read", 100.0 * share));
            self.record = Some("read everything: leave out --windows and --budget, or collect with --full".to_owned());
        }
        self
    }
}

/// The condition that streams are there, which are not: not evaluated if something of the recordings was not read.
pub(super) fn absent(world: &Estimates, asks: &str, absence: &Absence, record: &str) -> Pair {
    let lacks = &absence.lacks;
    let condition = match world.bags.iter().find_map(unread) {
        Some(why) => Condition::open("streams", asks, format!("{lacks}; {why}")),
        None if absence.is_sure => Condition::judged("streams", asks, false).because(lacks),
        None => Condition::open("streams", asks, lacks),
    };
    ("the recording".to_owned(), vec![condition.record(record)])
}

/// What was not read of a recording.
fn unread(bag: &BagEvidence) -> Option<String> {
    let is_unread = |topic: &&crate::world::bag::TopicEvidence| {
        let nothing = topic.count == 0 && topic.has_more();
        let broken = topic.unread.is_some() || (topic.malformed > 0 && topic.malformed == topic.count);
        READ.contains(&topic.type_name()) && (nothing || broken)
    };
    if let Some(topic) = bag.topics.values().find(is_unread) {
        let why = topic.unread.as_deref().unwrap_or("no message of it was read");
        return Some(format!("`{}` could not be read: {why}", topic.topic));
    }
    if bag.truncated {
        return Some("the end of the recording could not be read".to_owned());
    }
    bag.share_of_messages()
        .map(|share| format!("only {:.0} % of the messages were read", 100.0 * share))
}

/// The raw clouds of lidars; or what is there instead, and whether that shows that there are none.
pub(super) fn lidars<'w>(world: &'w Estimates) -> Result<Vec<Clouds<'w>>, Absence> {
    let clouds: Vec<Clouds> = Clouds::all(world).filter(Clouds::is_of_a_lidar).collect();
    if !clouds.is_empty() {
        return Ok(clouds);
    }
    if let Some(other) = Clouds::all(world).next() {
        let topic = &other.topic.topic;
        let lacks = format!("`{topic}` is not recognised as raw points of a lidar by its fields, topic or frame");
        return Err(Absence { lacks, is_sure: false });
    }
    let mut out = Judge::default();
    Clouds::say_packets(world, "clouds", &mut out);
    // Packets can be converted to clouds, which may suit.
    if let Some(packets) = out.judged.into_iter().next().and_then(|judged| judged.reason) {
        return Err(Absence {
            lacks: packets.replacen(&format!("{}: ", NotEvaluated::MissingInput.word()), "", 1),
            is_sure: false,
        });
    }
    let lacks = match Clouds::lasers(world).next() {
        Some(laser) => format!(
            "no clouds of a lidar in the recording: `{}` has planar scans",
            laser.topic.topic
        ),
        None => "no clouds of a lidar in the recording".to_owned(),
    };
    Err(Absence { lacks, is_sure: true })
}

/// What is missing.
pub(super) struct Absence {
    /// In words.
    pub(super) lacks: String,
    /// Whether it is known to be missing.
    pub(super) is_sure: bool,
}

/// Whether two streams last long enough together.
pub(super) fn together([a, b]: [&Stamped; 2], least_s: f64) -> Condition {
    let (name, asks) = (
        "time together",
        format!("both at the same time for at least {least_s} s"),
    );
    let Some(seconds) = a.together_s(b) else {
        return Condition::open(name, asks, "a stream has no log times");
    };
    let reason = if seconds > 0.0 {
        format!(
            "{} and {} are recorded together for {seconds:.1} s",
            a.subject, b.subject
        )
    } else {
        format!(
            "{} and {} do not overlap: {:.1} s lie between them",
            a.subject, b.subject, -seconds
        )
    };
    Condition::judged(name, asks, seconds >= least_s)
        .measured(Measured::new("time together", seconds.max(0.0), "s").at_least(least_s))
        .because(reason)
        .record(format!("record both together for {least_s} s or more"))
}

/// Whether a stream is fast enough.
pub(super) fn rate(stream: &Stamped, least_hz: f64) -> Condition {
    let (name, asks) = ("rate", format!("{} at {least_hz} Hz or more", stream.subject));
    let Some(hz) = stream.hz else {
        return Condition::open(name, asks, format!("{} has too few messages", stream.subject))
            .record(format!("record {} for longer", stream.subject));
    };
    // A rate of 49.9 Hz is one of 50 Hz.
    Condition::judged(name, asks, hz >= 0.98 * least_hz)
        .measured(Measured::new(format!("rate of {}", stream.subject), hz, "Hz").at_least(least_hz))
        .because(format!("{} has {hz:.1} Hz", stream.subject))
        .record(format!(
            "publish and record {} at {least_hz} Hz or more",
            stream.subject
        ))
}

/// Whether the stamps of streams are in order, and of the recorder's clock.
pub(super) fn clocks(verdict: &Verdict, rules: &[RuleCode], streams: &[&Stamped]) -> Condition {
    let subjects: Vec<&str> = streams.iter().map(|stream| stream.stamps.as_str()).collect();
    by_rules(
        verdict,
        ("clocks", "stamps in order and of one clock"),
        (rules, Severity::Warning),
        &subjects,
    )
}

/// The initial guess of the calibration: a chain of transforms between two frames.
pub(super) fn initial_guess(world: &Estimates, frames: [Option<&FrameId>; 2]) -> Condition {
    let (name, asks) = ("initial guess", "transforms connect the frames of both");
    let guess = match frames {
        [Some(a), Some(b)] if a == b => {
            let why = format!("both name the frame `{a}`, so nothing states where they are to each other");
            Condition::judged(name, asks, false).because(why)
        }
        [Some(a), Some(b)] => {
            let is_met = world.graph().chain(a, b, |edge| edge.is_rigid).is_some();
            Condition::judged(name, asks, is_met).because(format!("no rigid transforms connect `{a}` and `{b}`"))
        }
        _ => Condition::open(
            name,
            asks,
            "one of the two has no `frame_id`, or its poses name no body (`child_frame_id`)",
        ),
    };
    guess
        .record("measure the mounting roughly, and pass it to the calibration tool or publish it on /tf_static")
        .beside()
}

/// What rules say about subjects: not met if one has a finding of at least this severity, met if each subject passed at least one. A
/// finding that is less does not hinder; a hint says nothing.
pub(super) fn by_rules(
    verdict: &Verdict,
    (name, asks): (&'static str, &str),
    (rules, least): (&[RuleCode], Severity),
    subjects: &[&str],
) -> Condition {
    let is_of = |row: &&Row| rules.iter().any(|rule| *row.rule == *rule.as_str());
    let rows: Vec<&Row> = verdict.rows.iter().filter(is_of).collect();
    let about = |subject: &str| -> Vec<&Row> {
        let about = rows.iter().copied().filter(|row| row.subject.contains(subject));
        about.collect()
    };
    let findings = |row: &Row| {
        let (rule, subject) = (row.rule.clone(), row.subject.clone());
        let all = verdict.findings.iter().chain(&verdict.explained);
        all.filter(move |finding| {
            finding.rule == *rule && finding.subject == subject && finding.confidence > Confidence::Hint
        })
    };
    let finding = |row: &Row| findings(row).find(|finding| finding.severity >= least);
    let mut wrong = subjects.iter().flat_map(|subject| about(subject));
    if let Some(finding) = wrong.find_map(finding) {
        let condition = Condition::judged(name, asks, false).because(format!("{}: {}", finding.rule, finding.message));
        let help = Some(finding.help.as_str()).filter(|help| !help.is_empty());
        return condition
            .measured(finding.measured.iter().take(MAX_MEASURED).cloned())
            .record(help.map_or_else(|| format!("see `frames-lint explain {}`", finding.rule), str::to_owned));
    }
    let passes = |row: &&Row| row.outcome == Outcome::Pass || findings(row).next().is_some();
    for subject in subjects {
        if about(subject).iter().any(passes) {
            continue;
        }
        let reason = about(subject).iter().find_map(|row| row.reason.clone()).or_else(|| {
            let platform = rows.iter().find(|row| row.subject.ends_with("platform"));
            platform.and_then(|row| row.reason.clone())
        });
        let codes: Vec<&str> = rules.iter().map(|rule| rule.as_str()).collect();
        let why = reason.unwrap_or_else(|| {
            format!(
                "not judged by {} (left out by `select` or `ignore`, or nothing to compare)",
                codes.join(", ")
            )
        });
        return Condition::open(name, asks, format!("{subject}: {why}"));
    }
    let passed = subjects.iter().flat_map(|subject| about(subject)).filter(passes);
    let measured = passed
        .filter_map(|row| row.measured.first().cloned())
        .take(MAX_MEASURED);
    Condition::judged(name, asks, true).measured(measured)
}

/// An axis in words: ``z of `base_link` ``, or its numbers.
pub(super) fn axis_words(axis: &Vector3<f64>, frame: &str) -> String {
    /// Cosine of 15 degrees.
    const NEAR: f64 = 0.966;
    let named = axis.iter().zip(["x", "y", "z"]).find(|(value, _)| value.abs() > NEAR);
    if let Some((_, name)) = named {
        return format!("{name} of {frame}");
    }
    // The sign of an axis says nothing: the largest number is positive.
    let largest = axis.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let axis = axis * largest.unwrap_or(1.0).signum();
    format!("the axis ({:.2}, {:.2}, {:.2}) of {frame}", axis.x, axis.y, axis.z)
}
