//! The buffer against tf2 itself, by random scenes: same poses, same refusals, same exceptions.
//!
//! Ignored by default, for it needs tf2: `apt-get install python3-tf2` (Debian), then
//! `cargo test --test suite -- --ignored tf2_reference --nocapture`. That tf2 is of ROS 1; a program that speaks the same lines
//! (see tests/tools/tf2_reference.py) over the tf2 of ROS 2 can be named in `FRAMES_LINT_TF2`, and is then asked more.

#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::print_stderr,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap
)]

use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

use frames_lint::world::tf2::{Buffer, Extrapolation, IncomingTransform, LookupError};

const SECOND: i64 = 1_000_000_000;

/// What scenes are made of, from a seed.
struct Rng(fastrand::Rng);

impl Rng {
    fn below(&mut self, n: u64) -> u64 {
        self.0.u64(..n)
    }

    fn signed(&mut self) -> f64 {
        self.below(2_000_001) as f64 / 1e6 - 1.0
    }

    fn rotation(&mut self) -> [f64; 4] {
        loop {
            let q = [self.signed(), self.signed(), self.signed(), self.signed()];
            let norm = q.iter().map(|v| v * v).sum::<f64>().sqrt();
            if norm > 0.1 && norm < 1.0 {
                return q.map(|v| v / norm);
            }
        }
    }
}

/// Requests with our answers, line by line.
#[derive(Default)]
struct Script {
    requests: String,
    ours: Vec<String>,
}

fn word(name: &str) -> &str {
    if name.is_empty() { "<empty>" } else { name }
}

impl Script {
    fn new_buffer(&mut self, cache_ns: Option<i64>) -> Buffer {
        let length = cache_ns.map_or("max".to_owned(), |ns| ns.to_string());
        writeln!(self.requests, "new {length}").unwrap();
        self.ours.push("ok".to_owned());
        Buffer::new(cache_ns)
    }

    fn set(&mut self, buffer: &mut Buffer, sent: &IncomingTransform<'_>) {
        let numbers = sent.translation_m.iter().chain(&sent.rotation_xyzw);
        let numbers: Vec<String> = numbers.map(|v| format!("{v:?}")).collect();
        let (parent, child) = (word(sent.parent), word(sent.child));
        let (numbers, kind) = (numbers.join(" "), u8::from(sent.is_static));
        writeln!(self.requests, "set {parent} {child} {} {numbers} {kind}", sent.stamp_ns).unwrap();
        // ROS 2 takes no notice of a repetition, and says that all is well.
        let is_taken = match buffer.insert(sent) {
            Ok(()) | Err(frames_lint::world::tf2::Rejection::Repeated) => "ok",
            Err(_) => "refused",
        };
        self.ours.push(is_taken.to_owned());
    }

    fn get(&mut self, buffer: &Buffer, target: &str, source: &str, stamp_ns: i64) {
        writeln!(self.requests, "get {} {} {stamp_ns}", word(target), word(source)).unwrap();
        self.ours.push(match buffer.lookup(target, source, stamp_ns) {
            Ok(found) => {
                let (t, q) = (
                    found.target_from_source.translation.vector,
                    found.target_from_source.rotation.coords,
                );
                let stamp = found.stamp_ns;
                format!(
                    "pose {stamp} {:?} {:?} {:?} {:?} {:?} {:?} {:?}",
                    t.x, t.y, t.z, q.x, q.y, q.z, q.w
                )
            }
            Err(error) => {
                let kind = match &error {
                    LookupError::Extrapolation { what, .. } => match what {
                        Extrapolation::Past { .. } => "past",
                        Extrapolation::Future { .. } => "future",
                        Extrapolation::Single { .. } => "single",
                    },
                    _ => "-",
                };
                format!("fail {} {kind}", error.exception())
            }
        });
    }
}

/// Parent, child, stamp, translation, rotation, whether static.
type TransformRow = (String, String, i64, [f64; 3], [f64; 4], bool);

/// A scene: a random forest whose edges are published for a while with changes of parent, of kind, repetitions, faulty
/// numbers and, for ROS 2, late and equally stamped ones; and look-ups in between.
fn scene(rng: &mut Rng, script: &mut Script, is_ros2: bool) {
    // Long caches for ROS 1, which prunes after the insertion where ROS 2 does so before.
    let cache_ns = (is_ros2 && rng.below(2) == 0).then(|| SECOND * (1 + rng.below(10) as i64));
    let mut buffer = script.new_buffer(cache_ns);
    let names: Vec<String> = (0..3 + rng.below(6)).map(|n| format!("f{n}")).collect();
    // The Python binding of ROS 1 takes stamps through a double: near zero it keeps nanoseconds.
    let start = if is_ros2 { 1_700_000_000 } else { 1_000 } * SECOND;
    let pick = |rng: &mut Rng| names[rng.below(names.len() as u64) as usize].clone();
    // Loops are rare, for they hide everything else.
    let may_loop = rng.below(12) == 0;
    let is_static: Vec<bool> = names.iter().map(|_| rng.below(4) == 0).collect();
    let mut parents: Vec<usize> = (0..names.len()).map(|n| rng.below(n.max(1) as u64) as usize).collect();
    let mut last: Option<TransformRow> = None;
    for step in 0..200_i64 {
        let child = 1 + rng.below(names.len() as u64 - 1) as usize;
        if rng.below(25) == 0 {
            let bound = if may_loop { names.len() } else { child };
            parents[child] = rng.below(bound as u64) as usize;
        }
        let now = start + step * SECOND / 10;
        // A stamp that no other transform has, unless it is ROS 2 that is asked.
        let coarse = is_ros2 && rng.below(6) == 0;
        let jitter = rng.below(if coarse { 3 } else { 200_000_000 }) as i64 - if coarse { 1 } else { 100_000_000 };
        let late = if is_ros2 && rng.below(15) == 0 {
            SECOND * rng.below(15) as i64
        } else {
            0
        };
        let stamp_ns = now - late + if coarse { jitter * SECOND / 10 } else { jitter };
        let mut rotation = rng.rotation();
        let mut translation = [rng.signed() * 10.0, rng.signed(), rng.signed() * 1e-3];
        match rng.below(40) {
            0 => rotation = rotation.map(|v| v * 1.0049), // within the tolerance of 0.01 on the square
            1 => rotation = rotation.map(|v| v * 1.0051),
            2 => rotation = [0.0; 4],
            3 => translation[0] = f64::NAN,
            4 => rotation[1] = f64::NAN,
            _ => {}
        }
        let slash = |rng: &mut Rng, name: &str| {
            if rng.below(10) == 0 {
                format!("/{name}")
            } else {
                name.to_owned()
            }
        };
        let mut parent = slash(rng, &names[parents[child]]);
        let mut named = slash(rng, &names[child]);
        match rng.below(60) {
            0 => parent = String::new(),
            1 => "/".clone_into(&mut named),
            2 => parent.clone_from(&named),
            _ => {}
        }
        // In ROS 1 the first kind stays; in ROS 2 a change starts the history anew.
        let kind = is_static[child] != (is_ros2 && rng.below(30) == 0);
        let current = match &last {
            Some(last) if rng.below(12) == 0 => last.clone(),
            _ => (parent, named, stamp_ns, translation, rotation, kind),
        };
        let off_by = (rotation.iter().map(|v| v * v).sum::<f64>() - 1.0).abs();
        // ROS 1 computes with a quaternion as it came, within the tolerance; ROS 2 normalises on the way through a matrix,
        // so that none but zeros are ever refused.
        let is_our_own = (1e-9..0.01).contains(&off_by) || (is_ros2 && (1e-9..0.5).contains(&off_by));
        if is_our_own {
            continue;
        }
        script.set(
            &mut buffer,
            &IncomingTransform {
                parent: &current.0,
                child: &current.1,
                stamp_ns: current.2,
                translation_m: current.3,
                rotation_xyzw: current.4,
                is_static: current.5,
                tag: 0,
            },
        );
        last = Some(current);
        if step > 5 {
            let (mut target, source) = (pick(rng), pick(rng));
            if rng.below(50) == 0 {
                ["", "/f0", "nobody"][rng.below(3) as usize].clone_into(&mut target);
            }
            let stamp_ns = match rng.below(8) {
                0 => 0,
                1 => last.as_ref().unwrap().2,
                _ => now - (rng.below(12_000) as i64 - 200) * SECOND / 1000,
            };
            script.get(&buffer, &target, &source, stamp_ns);
        }
    }
}

/// Whether two answers agree; poses to 1e-9 (metres, and quaternions up to sign).
fn agree(ours: &str, theirs: &str) -> bool {
    let split = |line: &str| -> Vec<String> { line.split(' ').map(str::to_owned).collect() };
    let (a, b) = (split(ours), split(theirs));
    if theirs == "-" || ours == theirs {
        return true;
    }
    if a[0] != "pose" || b[0] != "pose" || a[1] != b[1] {
        return false;
    }
    let numbers = |words: &[String]| -> Vec<f64> { words[2..].iter().map(|word| word.parse().unwrap()).collect() };
    let (a, b) = (numbers(&a), numbers(&b));
    let off = |range: std::ops::Range<usize>, sign: f64| range.map(|i| (a[i] - sign * b[i]).abs()).fold(0.0, f64::max);
    off(0..3, 1.0) < 1e-9 * (1.0 + a[0].abs().max(a[1].abs())) && off(3..7, 1.0).min(off(3..7, -1.0)) < 1e-9
}

#[test]
#[ignore = "needs tf2: see the head of this file"]
fn answers_as_tf2_does() {
    let program = std::env::var("FRAMES_LINT_TF2").ok();
    let mut command = if let Some(program) = &program {
        Command::new(program)
    } else {
        let mut python = Command::new("/usr/bin/python3");
        python.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/tools/tf2_reference.py"));
        python
    };
    let mut rng = Rng(fastrand::Rng::with_seed(20_240_501));
    let mut script = Script::default();
    for _ in 0..100 {
        scene(&mut rng, &mut script, program.is_some());
    }
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let requests = script.requests.clone();
    let writer = std::thread::spawn(move || stdin.write_all(requests.as_bytes()));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    let theirs: Vec<String> = String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(str::to_owned)
        .collect();
    assert_eq!(theirs.len(), script.ours.len(), "one answer to each request");
    let mut counts = std::collections::BTreeMap::<String, usize>::new();
    let mut wrong = Vec::new();
    for ((request, ours), theirs) in script.requests.lines().zip(&script.ours).zip(&theirs) {
        let class: Vec<&str> = theirs
            .split(' ')
            .take(if theirs.starts_with("fail") { 3 } else { 1 })
            .collect();
        *counts.entry(class.join(" ")).or_default() += 1;
        if !agree(ours, theirs) {
            wrong.push(format!("{request}\n  ours   {ours}\n  theirs {theirs}"));
        }
    }
    eprintln!("{counts:#?}");
    assert!(
        wrong.is_empty(),
        "{} of {} differ:\n{}",
        wrong.len(),
        theirs.len(),
        wrong.iter().take(5).cloned().collect::<Vec<_>>().join("\n")
    );
    let lookups = script.requests.lines().filter(|line| line.starts_with("get")).count();
    assert!(lookups > 10_000, "{lookups} look-ups");
}
