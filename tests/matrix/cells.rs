//! What the tool says of a stream with an error, held against what it says of it without.

use std::collections::BTreeMap;

use frames_lint::engine::Rules;
use frames_lint::verdict::{Finding, Outcome, Row, Verdict};
use frames_lint::world::{Facts, World};

use crate::errors::Error;
use crate::streams::{Stream, StreamPlace};
use crate::support::deference;

/// What became of an error.
#[derive(Clone, Debug)]
pub enum Cell {
    /// A finding gives it its name.
    Named,
    /// A finding names it among others that fit all that was measured.
    Among(String),
    /// A finding shows it, and gives no name.
    Part(String),
    /// No rule that could see it judged.
    NotEvaluated(String),
    /// A rule that should see it passes.
    Missed(String),
    /// A finding names something else.
    Wrong(String),
}

impl Cell {
    pub fn letter(&self) -> &'static str {
        match self {
            Self::Named => "N",
            Self::Among(_) => "n",
            Self::Part(_) => "p",
            Self::NotEvaluated(_) => "-",
            Self::Missed(_) => "M",
            Self::Wrong(_) => "W",
        }
    }

    pub fn said(&self) -> Option<&str> {
        match self {
            Self::Named => None,
            Self::Among(said)
            | Self::Part(said)
            | Self::NotEvaluated(said)
            | Self::Missed(said)
            | Self::Wrong(said) => Some(said),
        }
    }
}

/// What is said of a stream without an error.
pub struct Judged<'w> {
    world: &'w World,
    stream: &'w Stream,
    rules: &'w Rules,
    before: Verdict,
}

impl<'w> Judged<'w> {
    pub fn of(world: &'w World, stream: &'w Stream, rules: &'w Rules) -> Self {
        Self {
            world,
            stream,
            rules,
            before: rules.judge(world),
        }
    }

    /// What becomes of an error; `None` where the stream cannot have it.
    pub fn with(&self, error: Error) -> Option<Cell> {
        let mut world = self.world.clone();
        let mut staged = None;
        if let Some(stage) = error.stage {
            if stage.family != self.stream.family || !(stage.put)(&mut world, self.stream) {
                return None;
            }
            world.absorb(Facts::default());
            let before = self.rules.judge(&world);
            // Beside one edge of a tree, frames that are in none are reported, and edges that a description does not know: true, and
            // of the stage alone.
            let is_wrong = |finding: &&&Finding| !["TREE07", "AUTH03"].contains(&finding.rule.as_str());
            if let Some(wrong) = new(&self.before, &before).iter().find(is_wrong) {
                return Some(Cell::Wrong(format!("rightly staged, {}", said(wrong))));
            }
            staged = Some(before);
        }
        let same = error.same_as(&world, self.stream);
        if !error.inject(&mut world, self.stream) {
            return None;
        }
        world.absorb(Facts::default());
        let after = self.rules.judge(&world);
        if let Some(crashed) = after.rows.iter().find(|row| row.outcome == Outcome::Crashed) {
            return Some(Cell::Wrong(format!("{} crashed", crashed.rule)));
        }
        if let Some(fault) = deference::faults(&world).into_iter().next() {
            return Some(Cell::Wrong(fault));
        }
        let findings = new(staged.as_ref().unwrap_or(&self.before), &after);
        if let Some(wrong) = findings
            .iter()
            .find(|finding| !error.is_named_by(finding, &same) && !error.is_shown_by(finding))
        {
            return Some(Cell::Wrong(said(wrong)));
        }
        if let Some(named) = findings.iter().find(|finding| error.is_named_by(finding, &same)) {
            let is_one = !named.text().contains("cannot distinguish");
            return Some(if is_one { Cell::Named } else { Cell::Among(said(named)) });
        }
        if let Some(shown) = findings.first() {
            return Some(Cell::Part(said(shown)));
        }
        Some(self.unnoticed(&mut world, error))
    }

    /// What the rules that should see an error say of the stream, in a world without recordings that would be taken for it.
    fn unnoticed(&self, world: &mut World, error: Error) -> Cell {
        let source = world.bags[self.stream.bag].source;
        let topics: Vec<&str> = self.stream.places.iter().map(StreamPlace::topic).collect();
        let is_other = |topic: &&str, bag: &frames_lint::world::BagEvidence| bag.topics.contains_key(*topic);
        world
            .bags
            .retain(|bag| bag.source == source || !topics.iter().any(|topic| is_other(topic, bag)));
        world.absorb(Facts::default());
        let verdict = self.rules.judge(world);
        let mut words = self.stream.words();
        words.extend(
            error
                .stage
                .into_iter()
                .flat_map(|stage| stage.words.iter().map(ToString::to_string)),
        );
        let is_mine = |row: &&Row| {
            error.fault.is_seen_in(row)
                && (row.subject == "platform" || words.iter().any(|word| row.subject.contains(word)))
        };
        let rows: Vec<&Row> = verdict.rows.iter().filter(is_mine).collect();
        if let Some(pass) = rows.iter().find(|row| row.outcome == Outcome::Pass) {
            return Cell::Missed(format!("{} passes {}: {}", pass.rule, pass.subject, measured(pass)));
        }
        if let Some(fail) = rows.iter().find(|row| row.outcome == Outcome::Fail) {
            return Cell::Missed(format!("{} fails {} as without the error", fail.rule, fail.subject));
        }
        let mut reasons: Vec<String> = rows
            .iter()
            .map(|row| format!("{} {}", row.rule, row.reason.as_deref().unwrap_or_default()))
            .collect();
        reasons.dedup();
        if reasons.is_empty() {
            return Cell::Missed(format!("no row of {}", error.fault.seen_by.join(", ")));
        }
        Cell::NotEvaluated(reasons.join(" | "))
    }
}

fn measured(row: &Row) -> String {
    let numbers: Vec<String> = row
        .measured
        .iter()
        .map(|measured| format!("{} {:.3} {}", measured.what, measured.value, measured.unit))
        .collect();
    numbers.join(", ")
}

/// Findings that are not among those before, whatever their numbers.
fn new<'v>(before: &Verdict, after: &'v Verdict) -> Vec<&'v Finding> {
    let key = |finding: &Finding| {
        let text: String = finding
            .text()
            .chars()
            .filter(|c| !c.is_ascii_digit() && !"+-.".contains(*c))
            .collect();
        // What a tree lists, or a gap, changes with every number of its transforms.
        let text = if finding.rule.starts_with("TREE") || finding.rule == "TIME03" {
            String::new()
        } else {
            text
        };
        (
            finding.rule.clone(),
            finding.subject.clone(),
            finding.relation.clone(),
            text,
        )
    };
    let mut known: BTreeMap<_, usize> = BTreeMap::new();
    for finding in &before.findings {
        *known.entry(key(finding)).or_default() += 1;
    }
    let is_new = |finding: &&Finding| match known.get_mut(&key(finding)) {
        Some(count) if *count > 0 => {
            *count -= 1;
            false
        }
        _ => true,
    };
    // A correction that stayed as it was beside odometry that did not is no error of anybody, and what ROT10 works out of the angles of
    // others is none of its own.
    let is_left = |finding: &&Finding| ["TREE14", "ROT10"].contains(&finding.rule.as_str());
    after
        .findings
        .iter()
        .filter(|finding| !is_left(finding))
        .filter(is_new)
        .collect()
}

fn said(finding: &Finding) -> String {
    let relation = finding.relation.as_deref().unwrap_or("no relation");
    format!(
        "{} ({relation}, {:?} {:?}) {}: {}",
        finding.rule, finding.severity, finding.confidence, finding.subject, finding.message
    )
}
