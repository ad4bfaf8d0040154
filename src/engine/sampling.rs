//! How much of a recording is read: at first what the rules need, and more if that does not suffice.
//!
//! Owns the parameters of sampling and the decision to widen it. Does not read.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::read::bag::{RunExtension, Sampling};
use crate::rules::SampleSize;
use crate::source::Source;
use crate::verdict::{NotEvaluated, Row, Verdict};
use crate::world::World;

use super::enabled::EnabledRule;

/// Bytes of messages in the first sample of a recording. A smaller recording is read completely. Zstandard decompresses about a gigabyte
/// per second: a tenth of a second for every recording of any length.
const FIRST_BYTES: u64 = 80 << 20;
/// Number of windows that are extended for large scans, and bytes of each: two seconds of a lidar with 128 beams and 2048 columns at 10 Hz,
/// 48 bytes per point.
const CARRIED: RunExtension = RunExtension {
    runs: 10,
    bytes: 256 << 20,
};
/// The factor for the bytes and for the length of the windows of one widening: what lacks evidence lacks a turn or a stop, not a place.
const WIDENING: u32 = 4;
/// Bytes of recordings that may be read in all rounds if no time limit is given. Not a time: results do not depend on the load of the
/// machine.
const WORK_BYTES: u64 = 2 << 30;

/// The user's options of sampling.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extent {
    /// Read everything.
    pub full: bool,
    /// Number of windows, instead of what the rules need; the sampling is not widened then.
    pub windows: Option<u32>,
    /// Time limit of widening.
    pub budget: Option<Duration>,
    /// Bytes of messages in the first sample of a recording, instead of the default.
    pub bytes: Option<u64>,
}

/// The sampling of one run, wider from round to round.
pub(super) struct Plan {
    asked: Extent,
    current: Option<Sampling>,
    begin: Instant,
    /// Bytes that were read in the rounds so far.
    read_bytes: u64,
    /// Rows that lacked evidence in the round before.
    lacking: Option<usize>,
    /// The time limit that ended the reading while rules lacked evidence.
    cut: Option<Duration>,
}

impl Plan {
    /// The sampling that the enabled rules need at first.
    pub(super) fn new(asked: Extent, rules: &[&EnabledRule]) -> Self {
        let needed = rules
            .iter()
            .map(|rule| rule.entry.sample)
            .fold(SampleSize::LEAST, SampleSize::max);
        let first = Sampling {
            windows: asked.windows.unwrap_or(needed.windows).max(1),
            seconds: needed.seconds,
            bytes: asked.bytes.unwrap_or(FIRST_BYTES),
            carried: Some(CARRIED),
        };
        Self {
            asked,
            current: (!asked.full).then_some(first),
            begin: Instant::now(),
            read_bytes: 0,
            lacking: None,
            cut: None,
        }
    }

    /// What is read in this round; `None`: everything.
    pub(super) fn sampling(&self) -> Option<Sampling> {
        self.current
    }

    /// Whether another round is useful: a rule lacked evidence that a recording still contains, the previous round improved something, and
    /// the time or the bytes suffice.
    pub(super) fn widen(&mut self, worlds: &[World], verdicts: &[(usize, Verdict)]) -> bool {
        let Some(sampling) = &mut self.current else {
            return false;
        };
        let lacking: usize = worlds
            .iter()
            .zip(verdicts)
            .map(|(world, (_, verdict))| lacking(world, verdict))
            .sum();
        let bytes = read_bytes(worlds);
        self.read_bytes += bytes;
        // A time limit of the user is used fully.
        let is_stuck = self.asked.budget.is_none() && self.lacking.is_some_and(|before| lacking >= before);
        // The next round reads more by this factor.
        let left = match self.asked.budget {
            Some(budget) => {
                let spent = self.begin.elapsed();
                spent.saturating_mul(WIDENING) < budget.saturating_sub(spent)
            }
            None => bytes.saturating_mul(u64::from(WIDENING)) <= WORK_BYTES.saturating_sub(self.read_bytes),
        };
        if lacking == 0 || is_stuck || !left || self.asked.windows.is_some() {
            self.cut = self.asked.budget.filter(|_| lacking > 0 && !left);
            return false;
        }
        self.lacking = Some(lacking);
        sampling.seconds *= f64::from(WIDENING);
        sampling.bytes = sampling.bytes.saturating_mul(u64::from(WIDENING));
        true
    }
}

impl Plan {
    /// Notes on recordings that the time limit ended their reading: another machine or load may give other results.
    pub(super) fn note(&self, sources: &mut [Arc<Source>]) {
        let Some(budget) = self.cut else { return };
        let budget = humantime::format_duration(budget);
        let is_cut = |source: &&mut Arc<Source>| source.examined.windows.is_some();
        for source in sources.iter_mut().filter(is_cut) {
            Arc::make_mut(source).notes.push(format!(
                "reading stopped after --budget {budget} although checks still lacked evidence; read everything with --full"
            ));
        }
    }
}

/// Bytes read of the recordings of these worlds.
fn read_bytes(worlds: &[World]) -> u64 {
    let read = worlds.iter().flat_map(|world| {
        let sources = world
            .bags
            .iter()
            .filter_map(|bag| world.sources.get(bag.source.0 as usize));
        sources.map(|source| (source.id, source.examined.bytes))
    });
    read.collect::<BTreeMap<_, _>>().values().sum()
}

/// Rows that lacked evidence which a recording of the world still contains.
fn lacking(world: &World, verdict: &Verdict) -> usize {
    let lacks = |row: &&Row| row.why_not() == Some(NotEvaluated::TooLittleEvidence);
    let rows = verdict.rows.iter().filter(lacks);
    rows.filter(|row| world.holds_more_about(&row.subject)).count()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::indexing_slicing)]
    use super::*;
    use crate::source::{Source, SourceId, SourceKind};
    use crate::verdict::Outcome;
    use crate::world::BagEvidence;
    use crate::world::bag::TopicEvidence;
    use std::sync::Arc;

    fn row(subject: &str, why: NotEvaluated) -> Row {
        Row {
            rule: "TEST01".into(),
            name: "test".into(),
            subject: subject.to_owned(),
            outcome: Outcome::NotEvaluated,
            reason: Some(format!("{}: 3 messages", why.word())),
            measured: Vec::new(),
            plots: Vec::new(),
            planes: Vec::new(),
        }
    }

    /// A sampled recording: of `/imu` more can be read, `/gps` was read completely.
    fn world() -> World {
        let mut bag = BagEvidence::new(SourceId(0));
        bag.share.whole = false;
        for (name, count, total) in [("/imu", 3, 100), ("/gps", 3, 3)] {
            let topic = TopicEvidence {
                topic: name.to_owned(),
                count,
                total: Some(total),
                ..TopicEvidence::default()
            };
            bag.topics.insert(name.to_owned(), topic);
        }
        let mut world = World::default();
        world.bags.push(bag);
        world
    }

    fn widens(rows: Vec<Row>, world: World) -> bool {
        let mut plan = Plan::new(Extent::default(), &[]);
        let verdict = Verdict {
            rows,
            ..Verdict::default()
        };
        plan.widen(&[world], &[(0, verdict)])
    }

    #[test]
    fn more_is_read_where_a_rule_lacks_what_the_recording_holds() {
        let lacking = |subject| vec![row(subject, NotEvaluated::TooLittleEvidence)];
        assert!(widens(lacking("topic `/imu`"), world()));
        assert!(widens(lacking("platform"), world()));
        assert!(!widens(lacking("topic `/gps`"), world()), "read up");
        assert!(!widens(vec![row("topic `/imu`", NotEvaluated::MissingInput)], world()));
        let mut whole = world();
        whole.bags[0].share.whole = true;
        assert!(!widens(lacking("topic `/imu`"), whole));
    }

    #[test]
    fn it_ends_where_a_round_brought_nothing() {
        let mut plan = Plan::new(Extent::default(), &[]);
        let verdict = Verdict {
            rows: vec![row("platform", NotEvaluated::TooLittleEvidence)],
            ..Verdict::default()
        };
        let verdicts = [(0, verdict)];
        let before = plan.sampling().unwrap();
        assert!(plan.widen(&[world()], &verdicts));
        // Longer windows, not more of them: what lacks evidence lacks a turn.
        let after = plan.sampling().unwrap();
        assert_eq!(after.bytes, before.bytes * u64::from(WIDENING));
        assert_eq!(after.windows, before.windows);
        assert!((after.seconds - before.seconds * f64::from(WIDENING)).abs() < 1e-9);
        assert!(!plan.widen(&[world()], &verdicts));
    }

    #[test]
    fn time_that_is_given_is_used() {
        let asked = Extent {
            budget: Some(Duration::from_secs(3600)),
            ..Extent::default()
        };
        let mut plan = Plan::new(asked, &[]);
        let verdict = Verdict {
            rows: vec![row("platform", NotEvaluated::TooLittleEvidence)],
            ..Verdict::default()
        };
        let verdicts = [(0, verdict)];
        for _ in 0..3 {
            assert!(plan.widen(&[world()], &verdicts));
        }
    }

    #[test]
    fn work_is_counted_in_bytes() {
        let widens = |bytes: u64| {
            let mut source = Source::new(SourceId(0), "drive.mcap", SourceKind::Urdf);
            source.examined.bytes = bytes;
            let mut world = world();
            world.sources = Arc::new(vec![Arc::new(source)]);
            let verdict = Verdict {
                rows: vec![row("platform", NotEvaluated::TooLittleEvidence)],
                ..Verdict::default()
            };
            Plan::new(Extent::default(), &[]).widen(&[world], &[(0, verdict)])
        };
        assert!(widens(FIRST_BYTES));
        assert!(!widens(WORK_BYTES / 4), "this round, and four times as much");
    }

    #[test]
    fn nothing_is_wider_than_everything() {
        let full = Extent {
            full: true,
            ..Extent::default()
        };
        let mut plan = Plan::new(full, &[]);
        assert!(plan.sampling().is_none());
        assert!(!plan.widen(&[], &[]));
    }
}
