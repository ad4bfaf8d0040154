//! The cost of the rules of motion: CPU time of reading, of judging with them and with all others, and memory.
//!
//! Four recordings of drives with consistent sensors: a short one with images and clouds, sampled as by default; one of motion
//! only, an hour long (`FRAMES_LINT_BENCH_HOURS`), read completely; and two with three hundred streams, on a drive with turns
//! and standing still, where the data determine nothing and every pair is tried. They are kept in
//! `FRAMES_LINT_BENCH_DIR` (`target/bench`); `FRAMES_LINT_BENCH_ONLY` selects recordings by a word of their names.
//!
//! Each is read and judged in a separate process, to measure its memory. Times are user plus system, the best of three runs.

#![allow(
    clippy::print_stdout,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    unreachable_pub,
    missing_docs
)]

#[path = "../tests/support/mod.rs"]
mod support;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use fastrand::Rng;
use frames_lint::engine::{self, Extent, Options, Rules};
use frames_lint::rules::RULES;
use frames_lint::run::Run;
use frames_lint::verdict::Outcome;
use frames_lint::world::World;
use nix::sys::resource::{UsageWho, getrusage};
use support::encode::{Body, Endian, Header};
use support::schemas;

/// The rules of motion: families, and rules of other families.
const MOTION: [&str; 17] = [
    "AXES", "QUAT", "GEO02", "GEO03", "GEO04", "GEO05", "GEO06", "GEO07", "TIME09", "COV02", "COV04", "COV05",
    "SENSOR05", "SENSOR06", "SENSOR08", "SENSOR09", "TREE16",
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["measure", how, file] => measure(how, Path::new(file)),
        ["rules", how, file] => each_rule(how, Path::new(file)),
        ["write", recipe, images, file] => write(recipe, *images == "images", Path::new(file)),
        _ => compare(),
    }
}

fn compare() {
    let folder = std::env::var_os("FRAMES_LINT_BENCH_DIR").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("target/bench"),
        PathBuf::from,
    );
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    let only = std::env::var("FRAMES_LINT_BENCH_ONLY").unwrap_or_default();
    let hours = std::env::var("FRAMES_LINT_BENCH_HOURS").map_or(1.0, |text| text.parse::<f64>().expect("a number"));
    let drives: [(&str, &str, String, bool); 4] = [
        ("images and clouds, sampled", "sampled", drive(300.0), true),
        ("motion only, read completely", "full", drive(hours * 3600.0), false),
        ("three hundred streams, turning", "full", many("turning"), false),
        ("three hundred streams, standing still", "full", many("still"), false),
    ];
    for (what, how, recipe, has_images) in drives {
        if !what.contains(&only) {
            continue;
        }
        let mark = recipe
            .bytes()
            .fold(0_u32, |mark, byte| mark.wrapping_mul(31).wrapping_add(byte.into()));
        let path = folder.join(format!("motion-{mark:08x}.mcap"));
        let itself = std::env::current_exe().expect("this program has a path");
        if !path.exists() {
            println!("writing {}", path.display());
            // In another process: the peak of memory is inherited by processes started later.
            let images = if has_images { "images" } else { "" };
            let status = Command::new(&itself)
                .args(["write", &recipe, images])
                .arg(&path)
                .status();
            assert!(status.is_ok_and(|status| status.success()));
        }
        println!(
            "\n{what}, {:.2} GB",
            path.metadata().expect("the drive is there").len() as f64 / 1e9
        );
        let run = |mode| {
            Command::new(&itself)
                .args([mode, how])
                .arg(&path)
                .output()
                .expect("it runs")
        };
        let runs: Vec<Vec<f64>> = (0..3)
            .map(|_| {
                let output = String::from_utf8(run("measure").stdout).expect("text");
                output
                    .split_whitespace()
                    .map(|word| word.parse().expect("a number"))
                    .collect()
            })
            .collect();
        let best = |at: usize| runs.iter().map(|run| run[at]).fold(f64::INFINITY, f64::min);
        let [read, motion, others, all] = [0, 1, 2, 3].map(best);
        println!("  reading                {read:8.3} s");
        println!(
            "  the other rules        {others:8.3} s, {:5.1} % of reading",
            100.0 * others / read
        );
        println!(
            "  the rules of motion    {motion:8.3} s, {:5.1} % of reading",
            100.0 * motion / read
        );
        println!(
            "  all rules              {all:8.3} s, {:5.1} % of reading",
            100.0 * all / read
        );
        println!("  memory {:.0} MB after reading, {:.0} MB at most", best(4), best(5));
        print!("{}", String::from_utf8(run("rules").stdout).expect("text"));
    }
}

fn options(how: &str, path: &Path) -> Options {
    let extent = Extent {
        full: how == "full",
        // One round: widening costs both the same.
        windows: (how != "full").then_some(10),
        ..Extent::default()
    };
    Options {
        paths: vec![path.to_owned()],
        extent,
        ..Options::default()
    }
}

/// CPU time of this process, seconds, and its peak of memory, MB.
fn used() -> (f64, f64) {
    let usage = getrusage(UsageWho::RUSAGE_SELF).expect("getrusage");
    let time = |t: nix::sys::time::TimeVal| {
        Duration::from_secs(t.tv_sec().unsigned_abs()) + Duration::from_micros(t.tv_usec().unsigned_abs())
    };
    let cpu = time(usage.user_time()) + time(usage.system_time());
    (cpu.as_secs_f64(), usage.max_rss() as f64 / 1024.0)
}

/// CPU time of judging with these rules, seconds. A copy has no cached estimates.
fn judged(world: &World, select: &[&str]) -> f64 {
    let rules = Rules::select(select).expect("rules of that name");
    let world = world.clone();
    let (before, _) = used();
    let verdict = rules.judge(&world);
    let spent = used().0 - before;
    assert_eq!(verdict.count(Outcome::Crashed), 0);
    spent
}

/// Prints the times of reading, of the rules of motion, of all others and of all together, and memory.
fn measure(how: &str, path: &Path) {
    let (before, _) = used();
    let (run, after) = if how == "full" {
        let run = engine::read(&options(how, path)).expect("a sound call");
        (run, used())
    } else {
        let run = engine::collect(&options(how, path)).expect("a sound call");
        (run, used())
    };
    let world = world(&run);
    let codes: Vec<&str> = RULES.iter().map(|entry| entry.page.code).collect();
    let is_other = |code: &&str| !MOTION.iter().any(|word| code.starts_with(word));
    let others: Vec<&str> = codes.into_iter().filter(is_other).collect();
    let [motion, others, all] = [&MOTION[..], &others, &[]].map(|select| judged(world, select));
    let judged = if how == "full" { 0.0 } else { all };
    println!(
        "{} {motion} {others} {all} {} {}",
        after.0 - before - judged,
        after.1,
        used().1
    );
}

fn world(run: &Run) -> &World {
    let [world] = run.worlds.as_slice() else {
        panic!("one world")
    };
    assert!(!world.bags.is_empty());
    world
}

/// Prints the times of the most expensive rules, one by one; shared work is counted with each.
fn each_rule(how: &str, path: &Path) {
    let run = engine::collect(&options(how, path)).expect("a sound call");
    let world = world(&run);
    let codes = RULES.iter().map(|entry| entry.page.code);
    let mut times: Vec<(f64, &str)> = codes.map(|code| (judged(world, &[code]), code)).collect();
    times.sort_by(|a, b| b.0.total_cmp(&a.0));
    let words: Vec<String> = times
        .iter()
        .take(12)
        .map(|(s, code)| format!("{code} {:.0}", s * 1e3))
        .collect();
    println!("  most expensive, each alone, ms: {}", words.join(", "));
}

/// A car with two inertial sensors, odometry, a filter, a receiver of two kinds, and TF.
fn drive(seconds: f64) -> String {
    format!(
        "
duration_s: {seconds}
chunk_size_bytes: 786432
drive: {{vehicle: car, motion: turning, seed: 5}}
topics:
  - topic: /tf_static
    transforms:
      - {{parent: base_link, child: imu_link, xyz: [0.3, 0, 0.4]}}
      - {{parent: base_link, child: gps, xyz: [0, 0, 1.5]}}
      - {{parent: base_link, child: lidar, xyz: [0.3, 0, 1.8]}}
      - {{parent: base_link, child: camera_optical_frame, xyz: [1, 0, 1.4], quaternion: [-0.5, 0.5, -0.5, 0.5]}}
  - {{topic: /imu, from_drive: imu, rate_hz: 200, frame_id: imu_link, xyz: [0.3, 0, 0.4]}}
  - {{topic: /ins, from_drive: ins, rate_hz: 100, frame_id: imu_link, xyz: [0.3, 0, 0.4]}}
  - {{topic: /odom, from_drive: odometry, rate_hz: 50, frame_id: odom, child_frame_id: base_link}}
  - {{topic: /pose, from_drive: pose, type: geometry_msgs/msg/PoseWithCovarianceStamped, rate_hz: 20, frame_id: map}}
  - topic: /tf
    rate_hz: 50
    transforms:
      - {{parent: odom, child: base_link, from_drive: odometry}}
      - {{parent: map, child: odom, from_drive: map_odom}}
  - {{topic: /fix, from_drive: fix, rate_hz: 10, frame_id: gps, xyz: [0, 0, 1.5]}}
  - {{topic: /vel, from_drive: gnss_velocity, rate_hz: 10, frame_id: gps, xyz: [0, 0, 1.5]}}
  - {{topic: /heading, from_drive: heading, rate_hz: 10, frame_id: base_link}}
  - {{topic: /nmea, from_drive: nmea, rate_hz: 10, frame_id: gps, xyz: [0, 0, 1.5], sentences: [GGA, RMC, HDT]}}
"
    )
}

/// Three hundred streams of some minutes.
fn many(motion: &str) -> String {
    let mut recipe = format!(
        "
duration_s: 110
chunk_size_bytes: 786432
drive: {{vehicle: robot, motion: {motion}, seed: 6}}
topics:
"
    );
    let mut topic = |number: u32, what: &str| writeln!(recipe, "  - {{topic: /s{number}, {what}}}").expect("a text");
    for number in 0..200 {
        topic(number, &format!("from_drive: imu, rate_hz: 20, frame_id: imu{number}"));
    }
    for number in 200..260 {
        let frames = format!("frame_id: odom, child_frame_id: base{number}");
        topic(number, &format!("from_drive: odometry, rate_hz: 20, {frames}"));
    }
    for number in 260..300 {
        topic(number, &format!("from_drive: fix, rate_hz: 10, frame_id: gps{number}"));
    }
    recipe
}

/// Writes a recipe's recording; optionally with images at 30 Hz and clouds at 10 Hz between its messages.
fn write(recipe: &str, has_images: bool, path: &Path) {
    let unfinished = path.with_extension("unfinished");
    let motion = support::build(recipe);
    if has_images {
        with_images(&motion, &unfinished);
    } else {
        std::fs::write(&unfinished, motion).expect("the drive can be written");
    }
    std::fs::rename(&unfinished, path).expect("the drive gets its name");
}

fn with_images(motion: &[u8], path: &Path) {
    let mut out = mcap::WriteOptions::new()
        .profile("ros2")
        .chunk_size(Some(786_432))
        .create(BufWriter::new(File::create(path).expect("the drive can be written")))
        .expect("a writer");
    let mut random = Rng::with_seed(7);
    let mut noise = |bytes: usize| {
        let mut data = vec![0; bytes];
        random.fill(&mut data);
        data
    };
    // Topic, type, frame, period in nanoseconds, data.
    let large = [
        (
            "/image",
            "sensor_msgs/msg/CompressedImage",
            "camera_optical_frame",
            33_333_333,
            noise(262_144),
        ),
        (
            "/points",
            "sensor_msgs/msg/PointCloud2",
            "lidar",
            100_000_000,
            noise(1 << 20),
        ),
    ];
    let mut channels: BTreeMap<String, u16> = BTreeMap::new();
    let mut put = |topic: &str, message_type: &str, definition: &[u8], time: u64, data: &[u8]| {
        let channel_id = *channels.entry(topic.to_owned()).or_insert_with(|| {
            let schema = out.add_schema(message_type, "ros2msg", definition).expect("a schema");
            out.add_channel(schema, topic, "cdr", &BTreeMap::new())
                .expect("a channel")
        });
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        out.write_to_known_channel(&header, data).expect("a message");
    };
    let mut next = [0, 0];
    for message in mcap::MessageStream::new(motion).expect("a sound recording") {
        let message = message.expect("a sound message");
        let now = message.log_time;
        for ((topic, message_type, frame_id, period, data), next) in large.iter().zip(&mut next) {
            if now >= *next {
                let stamp_ns = i64::try_from(now).expect("a time");
                let mut bytes = Body::Padded(Header { stamp_ns, frame_id }).encode(Endian::Little);
                bytes.extend_from_slice(data);
                put(
                    topic,
                    message_type,
                    schemas::definition(message_type).as_bytes(),
                    now,
                    &bytes,
                );
                *next = now + period;
            }
        }
        let schema = message.channel.schema.as_ref().expect("a schema");
        put(&message.channel.topic, &schema.name, &schema.data, now, &message.data);
    }
    out.finish().expect("the drive is written");
}
