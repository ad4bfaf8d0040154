//! The table: its lines, what is counted in each, and how it is printed.

use std::cell::LazyCell;
use std::fmt::Write;
use std::ops::Range;

use frames_lint::engine::Rules;
use frames_lint::verdict::Finding;
use rayon::prelude::*;

use crate::answers::{self, Answer};
use crate::cloud_worlds::{self, DriveCache};
use crate::drives::Kind;
use crate::faults::Fault;
use crate::support::deference;
use crate::support::drive::description::{Gnss, Grade, Motion, Vehicle};
use crate::{frame_worlds, place_lines};

/// Share of wrong answers that a rule may have in a group of lines.
pub const MOST_WRONG: f64 = 0.005;
/// Share of healthy drives on which a contradiction may be found that no named error explains.
const MOST_UNEXPLAINED: f64 = 0.001;
/// A drive up to this is short, seconds.
const SHORT_S: u32 = 10;
/// Wrong answers of a line that are kept to be printed.
const KEPT: usize = 2;

/// One question: a rule, its subjects, and where the answer is counted.
#[derive(Clone, Copy, Debug)]
struct Question {
    line: usize,
    /// `all` for what all rules say together.
    rule: &'static str,
    subject: &'static str,
}

/// One world of every seed, and what is asked of it.
#[derive(Debug)]
struct Cell {
    fault: Fault,
    questions: Vec<Question>,
}

/// The worlds of one kind of drive.
#[derive(Debug)]
struct Drives {
    kind: Kind,
    cells: Vec<Cell>,
}

/// What a simulation that others made has for a line.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// Share of right answers.
    pub right: f64,
    /// Of how many trials.
    pub trials: u32,
    /// How it is written there.
    pub words: &'static str,
}

/// A line.
#[derive(Debug)]
pub struct Line {
    pub group: &'static str,
    pub rule: &'static str,
    what: String,
    drive: String,
    pub reference: Option<Reference>,
    /// Whether not one wrong answer is allowed.
    pub is_strict: bool,
    pub right: usize,
    pub wrong: usize,
    pub not_evaluated: usize,
    examples: Vec<String>,
    reasons: Vec<String>,
}

/// All lines.
#[derive(Debug, Default)]
pub struct Table {
    pub lines: Vec<Line>,
    drives: Vec<Drives>,
    /// Reasons that point at silent rules, on the worlds of the first seed.
    pub silent: Vec<String>,
    /// Healthy drives that were judged.
    healthy: usize,
    /// Contradictions found on them that no named error explains.
    unexplained: Vec<String>,
}

/// What came of one drive.
#[derive(Default)]
struct DriveResult {
    answers: Vec<(usize, Answer)>,
    silent: Vec<String>,
    healthy: usize,
    unexplained: Vec<String>,
}

fn is_unexplained(finding: &Finding) -> bool {
    [Some("unexplained"), Some("scale")].contains(&finding.relation.as_deref())
}

/// Where an answer is counted.
#[derive(Clone, Debug)]
pub struct AnswerKey {
    pub group: &'static str,
    pub rule: &'static str,
    pub subject: &'static str,
    pub fault: Fault,
    /// What the line calls the fault, where it stands for several.
    pub called: Option<&'static str>,
    /// Whether the line stands for all vehicles.
    pub pooled: bool,
    pub reference: Option<Reference>,
}

impl Table {
    /// Asks a question of a kind of drive.
    pub fn ask(&mut self, kind: Kind, asked: &AnswerKey) {
        let drive = if asked.pooled {
            format!("{:<8}{:<9}{:>4} s  various", "all", motion(kind.motion), kind.seconds)
        } else {
            words(kind)
        };
        let what = asked.called.unwrap_or(asked.fault.words()).to_owned();
        let is_there =
            |line: &Line| (line.group, line.rule, &line.what, &line.drive) == (asked.group, asked.rule, &what, &drive);
        let line = self.lines.iter().position(is_there).unwrap_or_else(|| {
            self.lines.push(Line {
                group: asked.group,
                rule: asked.rule,
                what,
                drive,
                reference: asked.reference,
                is_strict: matches!(kind.motion, Motion::Straight | Motion::Still) || kind.seconds <= SHORT_S,
                right: 0,
                wrong: 0,
                not_evaluated: 0,
                examples: Vec::new(),
                reasons: Vec::new(),
            });
            self.lines.len() - 1
        });
        let drives = position_or(
            &mut self.drives,
            |drives| drives.kind == kind,
            || Drives {
                kind,
                cells: Vec::new(),
            },
        );
        let cell = position_or(
            &mut drives.cells,
            |cell| cell.fault == asked.fault,
            || Cell {
                fault: asked.fault,
                questions: Vec::new(),
            },
        );
        cell.questions.push(Question {
            line,
            rule: asked.rule,
            subject: asked.subject,
        });
    }

    /// Only the lines whose group and rule hold one of these words; all where there are none.
    pub fn only(&mut self, words: &[String]) {
        let lines = &self.lines;
        let is_meant = |question: &Question| {
            let line = &lines[question.line];
            let name = format!("{} {} {} {}", line.group, line.rule, line.drive, line.what);
            let has = |word: &String| word.split('+').all(|part| name.contains(part));
            words.is_empty() || words.iter().any(has)
        };
        for cell in self.drives.iter_mut().flat_map(|drives| &mut drives.cells) {
            cell.questions.retain(is_meant);
        }
        for drives in &mut self.drives {
            drives.cells.retain(|cell| !cell.questions.is_empty());
        }
        self.drives.retain(|drives| !drives.cells.is_empty());
    }

    /// Answers every question for these seeds.
    pub fn fill(&mut self, seeds: Range<u64>) {
        let rules = Rules::select(&[
            "AXES", "QUAT", "GEO", "COV", "TIME09", "TREE16", "SENSOR05", "SENSOR06", "SENSOR08", "SENSOR09",
        ]);
        let rules = rules.unwrap();
        let sensing = Rules::select(&[
            "AXES", "QUAT", "TIME05", "TIME06", "TIME07", "TIME08", "TIME09", "TREE16", "SENSOR", "PREC", "CROSS04",
            "CROSS05",
        ]);
        let sensing = sensing.unwrap();
        // Whoever is through early takes the next of the long drives first.
        let mut tasks: Vec<(usize, u64)> = Vec::new();
        for drives in 0..self.drives.len() {
            tasks.extend(seeds.clone().map(|seed| (drives, seed)));
        }
        tasks.sort_by_key(|(drives, seed)| (std::cmp::Reverse(self.drives[*drives].kind.seconds), *drives, *seed));
        let first = seeds.start;
        let answered = |(drives, seed): &(usize, u64)| -> DriveResult {
            let Drives { kind, cells } = &self.drives[*drives];
            let drive: Vec<String> = words(*kind).split_whitespace().map(str::to_owned).collect();
            let messages = LazyCell::new(|| kind.messages(*seed));
            let mut answered = DriveResult::default();
            let shared = DriveCache::default();
            for cell in cells {
                let (rules, world, truth) = match cell.fault {
                    Fault::Cloud(name) => {
                        let world = cloud_worlds::world_named(name).world(&messages, &shared);
                        (&sensing, world, cell.fault)
                    }
                    Fault::Place(name) => (&rules, place_lines::scene(name).world(*kind, *seed), cell.fault),
                    fault => (&rules, messages.world(fault), frame_worlds::truth(&messages, fault)),
                };
                let verdict = rules.judge(&world);
                let of = |said: String| format!("seed {seed}, {}, {}: {said}", drive.join(" "), cell.fault.words());
                if *seed == first {
                    answered.silent.extend(deference::faults(&world).into_iter().map(of));
                }
                if cell.fault == Fault::Healthy {
                    answered.healthy += 1;
                    let found = verdict.findings.iter().filter(|finding| is_unexplained(finding));
                    let found = found.map(|finding| of(format!("{} {}", finding.rule, finding.message)));
                    answered.unexplained.extend(found);
                }
                for question in &cell.questions {
                    let answer = if question.rule == ALL {
                        answers::of_all(&verdict, truth)
                    } else {
                        answers::of_rule(&verdict, question.rule, question.subject, truth)
                    };
                    let answer = match answer {
                        Answer::Right => Answer::Right,
                        Answer::Wrong(said) => Answer::Wrong(of(said)),
                        Answer::NotEvaluated(why) => Answer::NotEvaluated(of(why)),
                    };
                    answered.answers.push((question.line, answer));
                }
            }
            answered
        };
        let all: Vec<_> = tasks.par_iter().map(answered).collect();
        for answered in all {
            for (line, answer) in answered.answers {
                self.lines[line].count(answer);
            }
            self.silent.extend(answered.silent);
            self.healthy += answered.healthy;
            self.unexplained.extend(answered.unexplained);
        }
    }

    /// The lines that something was counted in.
    pub fn counted(&self) -> impl Iterator<Item = &Line> {
        self.lines.iter().filter(|line| line.all() > 0)
    }

    /// The table as text.
    pub fn print(&self) -> String {
        let mut text = String::new();
        let mut group = "";
        for line in self.counted() {
            if line.group != group {
                group = line.group;
                let _ = writeln!(
                    text,
                    "\n{group}\n{:<9}{:<36}{:<39}{:>7}{:>7}{:>8}{:>7}  reference",
                    "rule", "fault", "drive", "right", "wrong", "not ev.", "n"
                );
            }
            let share = |count: usize| 100.0 * count as f64 / line.all() as f64;
            let reference = line.reference.map_or("", |reference| reference.words);
            let _ = writeln!(
                text,
                "{:<9}{:<36}{:<39}{:>7.1}{:>7.2}{:>8.1}{:>7}  {reference}{}",
                line.rule,
                line.what,
                line.drive,
                share(line.right),
                share(line.wrong),
                share(line.not_evaluated),
                line.all(),
                if line.is_short() { "  LESS" } else { "" }
            );
        }
        let _ = writeln!(
            text,
            "\n{} healthy drives, {} contradictions that no named error explains",
            self.healthy,
            self.unexplained.len()
        );
        for said in &self.unexplained {
            let _ = writeln!(text, "unexplained: {said}");
        }
        for line in self.counted() {
            for example in &line.examples {
                let _ = writeln!(text, "wrong: {} | {example}", line.rule);
            }
        }
        text
    }

    /// Why rules did not judge: some reasons of each line.
    pub fn reasons(&self) -> String {
        let mut text = String::new();
        for line in self.counted() {
            for reason in &line.reasons {
                let _ = writeln!(text, "not evaluated: {} | {reason}", line.rule);
            }
        }
        text
    }

    /// What the table shows that must not be.
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        let mut sums: Vec<((&str, &str), [usize; 2])> = Vec::new();
        for line in self.counted() {
            let (_, sum) = position_or(
                &mut sums,
                |(key, _)| *key == (line.group, line.rule),
                || ((line.group, line.rule), [0, 0]),
            );
            sum[0] += line.wrong;
            sum[1] += line.all();
            let name = format!("{} {} {} {}", line.group, line.rule, line.what, line.drive);
            if line.is_strict && line.wrong > 0 {
                faults.push(format!("{name}: {} wrong where none may be", line.wrong));
            }
            if line.is_short() {
                faults.push(format!("{name}: {} of {} right", line.right, line.all()));
            }
        }
        for ((group, rule), [wrong, all]) in sums {
            let share = wrong as f64 / all as f64;
            if share >= MOST_WRONG {
                faults.push(format!("{group} {rule}: {:.2} % wrong", 100.0 * share));
            }
        }
        let (unexplained, healthy) = (self.unexplained.len(), self.healthy);
        if unexplained as f64 > MOST_UNEXPLAINED * healthy as f64 {
            faults.push(format!(
                "{unexplained} contradictions unexplained on {healthy} healthy drives"
            ));
        }
        faults
    }
}

/// What all rules say together.
pub const ALL: &str = "all";

impl Line {
    fn count(&mut self, answer: Answer) {
        match answer {
            Answer::Right => self.right += 1,
            Answer::NotEvaluated(why) => {
                self.not_evaluated += 1;
                if self.reasons.len() < KEPT {
                    self.reasons.push(why);
                }
            }
            Answer::Wrong(said) => {
                self.wrong += 1;
                if self.examples.len() < KEPT {
                    self.examples.push(said);
                }
            }
        }
    }

    fn all(&self) -> usize {
        self.right + self.wrong + self.not_evaluated
    }

    /// Whether there is less than the reference, by more than chance explains: Newcombe's interval of the difference at two
    /// deviations (Interval estimation for the difference between independent proportions, Stat Med 1998, method 10) is
    /// all under 0. The reference is a simulation too, of so many trials.
    fn is_short(&self) -> bool {
        self.reference.is_some_and(|reference| {
            let (n, trials) = (self.all() as f64, f64::from(reference.trials));
            let ours = self.right as f64 / n;
            let (_, our_upper) = wilson(ours, n);
            let (their_lower, _) = wilson(reference.right, trials);
            let beyond = (our_upper - ours).hypot(reference.right - their_lower);
            ours - reference.right + beyond < -1e-9
        })
    }
}

/// Wilson's interval of a share of `n` at two deviations.
fn wilson(share: f64, n: f64) -> (f64, f64) {
    let z = 2.0_f64;
    let middle = share + z * z / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    let whole = 1.0 + z * z / n;
    ((middle - half) / whole, (middle + half) / whole)
}

fn words(kind: Kind) -> String {
    let vehicle = match kind.vehicle {
        Vehicle::Car => "car",
        Vehicle::Walker => "walker",
        Vehicle::Drone => "drone",
        Vehicle::Robot => "robot",
    };
    let imu = match kind.imu {
        Grade::Tactical => "tactical",
        Grade::Mems => "MEMS",
        Grade::Perfect => "perfect",
    };
    let gnss = match kind.gnss {
        Gnss::Rtk => "RTK",
        Gnss::Single => "SPS",
        Gnss::Perfect => "perfect",
    };
    format!(
        "{vehicle:<8}{:<9}{:>4} s  {imu:<9}{gnss}",
        motion(kind.motion),
        kind.seconds
    )
}

fn motion(motion: Motion) -> &'static str {
    match motion {
        Motion::Turning => "turning",
        Motion::Straight => "straight",
        Motion::Still => "still",
        Motion::Circles => "circles",
        Motion::OutAndBack => "out-back",
    }
}

/// The element that fits, made where there is none.
fn position_or<T>(all: &mut Vec<T>, is_it: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> &mut T {
    let at = all.iter().position(is_it).unwrap_or_else(|| {
        all.push(make());
        all.len() - 1
    });
    &mut all[at]
}
