//! Evidence with numbers that no recording has: no rule may crash on them, or take long.
//!
//! Every number of the evidence of a drive is altered, by its kind: in the first row, in one within and in all, to what is no
//! number, is too large, or is nothing; and lists are emptied, cut and turned round. By default each kind gets a part of
//! the alterations, `FRAMES_LINT_ALTERATIONS=all` tries them all.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic, clippy::print_stderr)]

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::time::{Duration, Instant};

use crate::support;
use frames_lint::engine::{self, Options, Rules, evidence};
use frames_lint::verdict::Outcome;
use serde_json::{Value, json};

/// All that the rules of motion look at, in one drive.
const DRIVE: &str = "
duration_s: 45
drive: {vehicle: car, motion: turning, seed: 2}
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: imu, xyz: [0.3, 0, 0.4]}
      - {parent: base_link, child: gps, xyz: [0, 0, 1.5]}
      - {parent: earth, child: map, from_drive: earth}
  - {topic: /imu, from_drive: imu, rate_hz: 5, frame_id: imu, xyz: [0.3, 0, 0.4], errors: [ned_frd]}
  - {topic: /ins, from_drive: ins, rate_hz: 5, frame_id: imu, late_s: 0.3}
  - {topic: /odom, from_drive: odometry, rate_hz: 5, frame_id: odom, child_frame_id: base_link, errors: [twist_in_world]}
  - {topic: /pose, from_drive: pose, type: geometry_msgs/msg/PoseWithCovarianceStamped, rate_hz: 5, frame_id: map}
  - {topic: /utm, from_drive: pose, rate_hz: 5, frame_id: utm, errors: [utm]}
  - topic: /tf
    rate_hz: 5
    transforms:
      - {parent: odom, child: base_link, from_drive: odometry}
      - {parent: map, child: odom, from_drive: map_odom}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, xyz: [0, 0, 1.5]}
  - {topic: /gps, from_drive: gps_fix, rate_hz: 5, frame_id: gps, xyz: [0, 0, 1.5], errors: [msl]}
  - {topic: /vel, from_drive: gnss_velocity, type: geometry_msgs/msg/TwistWithCovarianceStamped, rate_hz: 5, frame_id: gps}
  - {topic: /heading, from_drive: heading, rate_hz: 5, frame_id: base_link, errors: [compass_yaw]}
  - {topic: /scan, from_drive: laser, rate_hz: 5, frame_id: base_link, laser: {rays: 61}, until_s: 4}
  - {topic: /radar, from_drive: radar, rate_hz: 10, frame_id: base_link, radar: {}, until_s: 5}
  - {topic: /nmea, from_drive: nmea, rate_hz: 5, frame_id: gps, xyz: [0, 0, 1.5], sentences: [GGA, RMC, HDT]}
";

/// A step from a value into it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Step {
    Key(String),
    Each,
}

/// Where values of one kind stand: keys, and any place of a list.
type Kind = Vec<Step>;

/// Every kind of number and list in a value, as far as lists of one kind go together.
fn kinds(value: &Value, at: &mut Kind, found: &mut [BTreeSet<Kind>; 3]) {
    let [whole, real, lists] = found;
    match value {
        Value::Number(number) if number.is_f64() => drop(real.insert(at.clone())),
        Value::Number(_) => drop(whole.insert(at.clone())),
        Value::Array(all) => {
            lists.insert(at.clone());
            at.push(Step::Each);
            for inner in all {
                kinds(inner, at, found);
            }
            at.pop();
        }
        Value::Object(fields) => {
            for (key, inner) in fields {
                at.push(Step::Key(key.clone()));
                kinds(inner, at, found);
                at.pop();
            }
        }
        _ => {}
    }
}

/// Without those that another topic has had before, motion left aside.
fn of_one_topic(kinds: &BTreeSet<Kind>) -> Vec<&Kind> {
    let is_key = |step: &Step, name: &str| matches!(step, Step::Key(key) if key == name);
    let mut seen = BTreeSet::new();
    let is_new = |at: &&Kind| {
        let topic = at
            .iter()
            .position(|step| is_key(step, "topics"))
            .map_or(0, |topics| topics + 2);
        at.iter().any(|step| is_key(step, "motion")) || seen.insert(at[topic..].to_vec())
    };
    kinds.iter().filter(is_new).collect()
}

/// Which values of a kind are altered.
#[derive(Clone, Copy, Debug)]
enum ValueChoice {
    First,
    Within,
    All,
}

/// Alters the values of a kind.
fn alter(value: &mut Value, at: &[Step], which: ValueChoice, make: &dyn Fn(&Value) -> Value) {
    match (at.split_first(), value) {
        (None, value) => *value = make(value),
        (Some((Step::Key(key), rest)), Value::Object(fields)) => {
            if let Some(inner) = fields.get_mut(key) {
                alter(inner, rest, which, make);
            }
        }
        (Some((Step::Each, rest)), Value::Array(all)) => {
            let count = all.len();
            for (index, inner) in all.iter_mut().enumerate() {
                let is_meant = match which {
                    ValueChoice::First => index == 0,
                    ValueChoice::Within => index == count / 2,
                    ValueChoice::All => true,
                };
                if is_meant {
                    alter(inner, rest, which, make);
                }
            }
        }
        _ => {}
    }
}

/// Whether a whole number is of a clock.
fn is_stamp(value: &Value) -> bool {
    value.as_i64().is_some_and(|value| value > 1 << 50)
}

/// A list made anew; those that have a length of their own (a vector, a quaternion, a pair) and what is no list stay.
fn relisted(value: &Value, make: impl Fn(&[Value]) -> Vec<Value>) -> Value {
    let is_tuple = |all: &[Value]| (1..=4).contains(&all.len()) && all.iter().all(Value::is_number);
    match value {
        Value::Array(all) if !is_tuple(all) => Value::Array(make(all)),
        other => other.clone(),
    }
}

fn name(at: &[Step]) -> String {
    let part = |step: &Step| match step {
        Step::Key(key) => key.clone(),
        Step::Each => "*".to_owned(),
    };
    at.iter().map(part).collect::<Vec<_>>().join(".")
}

/// Collects the drive as saved evidence.
fn drive() -> Value {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("drive.mcap");
    support::write(DRIVE, &bag);
    let run = engine::collect(&Options {
        paths: vec![bag],
        ..Options::default()
    })
    .unwrap();
    serde_json::from_str(&evidence::write(&run).unwrap()).unwrap()
}

/// A way to alter a value.
type Alteration = fn(&Value) -> Value;

/// Stamps, which may be negative, and counts.
const WHOLE: [Alteration; 5] = [
    |_| json!(0),
    |_| json!(i64::MAX),
    |value| {
        if is_stamp(value) {
            json!(i64::MIN)
        } else {
            json!(u64::MAX)
        }
    },
    |value| if is_stamp(value) { json!(-1) } else { json!(1) },
    |value| {
        if is_stamp(value) {
            json!(i64::MIN + 1)
        } else {
            json!(u64::MAX / 2)
        }
    },
];

/// Numbers with a point.
const REAL: [Alteration; 7] = [
    |_| json!("nan"),
    |_| json!("inf"),
    |_| json!("-inf"),
    |_| json!(1e300),
    |_| json!(-1e300),
    |_| json!(0.0),
    |_| json!(1e-310),
];

/// Lists.
const LIST: [Alteration; 4] = [
    |value| relisted(value, |_| Vec::new()),
    |value| relisted(value, |all| all.iter().take(1).cloned().collect()),
    |value| relisted(value, |all| all.iter().rev().cloned().collect()),
    |value| {
        relisted(value, |all| {
            all.iter().flat_map(|one| [one.clone(), one.clone()]).collect()
        })
    },
];

/// What is altered: where, in which way, and how much of it.
type Job<'k> = (&'k Kind, usize, Alteration, ValueChoice);

/// Every alteration of every kind, or a part of them.
fn jobs(found: &[BTreeSet<Kind>; 3], all: bool) -> Vec<Job<'_>> {
    let makes: [&[Alteration]; 3] = [&WHOLE, &REAL, &LIST];
    let mut jobs: Vec<Job<'_>> = Vec::new();
    for (kinds, makes) in found.iter().zip(makes) {
        let ways: Vec<(usize, Alteration, ValueChoice)> = makes
            .iter()
            .enumerate()
            .flat_map(|(number, make)| {
                [ValueChoice::First, ValueChoice::Within, ValueChoice::All].map(|which| (number, *make, which))
            })
            .collect();
        let kinds: Vec<&Kind> = if all {
            kinds.iter().collect()
        } else {
            of_one_topic(kinds)
        };
        for (turn, at) in kinds.into_iter().enumerate() {
            // One of them for each kind, the next for the next.
            let chosen = if all {
                0..ways.len()
            } else {
                turn % ways.len()..turn % ways.len() + 1
            };
            jobs.extend(
                ways[chosen]
                    .iter()
                    .map(|(number, make, which)| (at, *number, *make, *which)),
            );
        }
    }
    jobs
}

#[test]
fn no_number_makes_a_rule_crash_or_run_on() {
    let good = drive();
    let mut found: [BTreeSet<Kind>; 3] = Default::default();
    kinds(&good["worlds"], &mut vec![Step::Key("worlds".to_owned())], &mut found);
    let all = std::env::var("FRAMES_LINT_ALTERATIONS").is_ok_and(|word| word == "all");
    let rules = Rules::select(&[]).unwrap();
    let (mut judged, mut refused) = (0, 0_usize);
    let mut slowest = (Duration::ZERO, String::new());
    let mut crashes = BTreeSet::new();
    let jobs = jobs(&found, all);
    // Those far apart in the document go together: of one stream only one is altered at a time.
    let rounds = if all { jobs.len() } else { jobs.len().div_ceil(12) };
    let round = |round: usize| jobs.iter().skip(round).step_by(rounds).collect::<Vec<_>>();
    let mut batches: Vec<Vec<&Job<'_>>> = (0..rounds).map(round).collect();
    while let Some(mut batch) = batches.pop() {
        let mut altered = good.clone();
        let mut what = String::new();
        for (at, number, make, which) in &batch {
            alter(&mut altered, at, *which, &|value| make(value));
            let _ = write!(what, "{} altered in way {number}, {which:?}; ", name(at));
        }
        let Ok(saved) = evidence::parse(altered.to_string().as_bytes()) else {
            // One of them no document can hold; the others stand for themselves.
            let count = batch.len();
            let half = batch.split_off(batch.len() / 2);
            refused += usize::from(batch.is_empty());
            batches.extend(
                [batch, half]
                    .into_iter()
                    .filter(|part| !part.is_empty() && part.len() < count),
            );
            continue;
        };
        judged += batch.len();
        let begin = Instant::now();
        for world in &saved.worlds {
            let verdict = rules.judge(world);
            let crashed = verdict.rows.iter().filter(|row| row.outcome == Outcome::Crashed);
            crashes.extend(crashed.map(|row| format!("{} {:?} by {what}", row.rule, row.reason)));
        }
        if begin.elapsed() > slowest.0 {
            slowest = (begin.elapsed(), what);
        }
    }
    eprintln!("{judged} judged, {refused} refused, the slowest {slowest:?}");
    assert!(crashes.is_empty(), "{crashes:#?}");
    assert!(judged > 2 * refused, "{judged}, {refused}");
    assert!(slowest.0 < Duration::from_secs(30), "{slowest:?}");
}
