//! The cost of the program in instructions, which does not depend on the load. Every case is compared with `baseline.tsv`; 3 % more fails.
//!
//! ```text
//! packaging/build
//! cargo test --locked --test instructions            # counts, and compares
//! UPDATE=1 cargo test --locked --test instructions   # writes a new baseline: give the reason in the commit
//! ```
//!
//! The growth with the size of the input is checked as well: four times the input may cost six times as much.
//!
//! Counted by Valgrind's callgrind, with one thread. The baseline is of the program in the packages: in a build with many
//! codegen units the counts of unchanged code differ by up to 20 %, because a moved module changes what is inlined.
//! Counts depend on the compiler and on AVX2: if these differ from the baseline's, nothing is compared, and the test
//! reports that. The growth is counted in the program that `cargo test` builds.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    unreachable_pub,
    missing_docs
)]

#[path = "../../tests/support/mod.rs"]
mod support;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use frames_lint::rules::RULES;
use rayon::prelude::*;
use support::left_out;

/// This much more than the baseline fails; this much less requires a new one.
const MORE: f64 = 0.03;
const LESS: f64 = 0.10;

/// One call of the program.
struct Case {
    name: String,
    arguments: Vec<String>,
}

fn case(name: &str, arguments: &[&str]) -> Case {
    let arguments = ["check", "--format", "json"].iter().chain(arguments);
    Case {
        name: name.to_owned(),
        arguments: arguments.map(|argument| (*argument).to_owned()).collect(),
    }
}

/// A chain of arms with this many links, with shapes and inertias.
fn robot(links: usize) -> String {
    let mut text = "<robot name=\"r\">\n<link name=\"base_link\"/>\n".to_owned();
    for link in 1..links {
        let parent = if link < 8 {
            "base_link".to_owned()
        } else {
            format!("link_{}", link - 7)
        };
        let _ = write!(
            text,
            "<link name=\"link_{link}\">\n<inertial><origin xyz=\"0 0 0.1\"/><mass value=\"1.5\"/>\
             <inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial>\n\
             <visual><origin xyz=\"0 0 0.1\" rpy=\"0 0 0\"/><geometry><box size=\"0.1 0.1 0.2\"/></geometry></visual>\n\
             <collision><geometry><cylinder radius=\"0.05\" length=\"0.2\"/></geometry></collision>\n</link>\n\
             <joint name=\"joint_{link}\" type=\"revolute\">\n<parent link=\"{parent}\"/><child link=\"link_{link}\"/>\n\
             <origin xyz=\"0 0.01 0.2\" rpy=\"0 {} 0\"/><axis xyz=\"0 0 1\"/>\n\
             <limit lower=\"-1.5\" upper=\"1.5\" effort=\"10\" velocity=\"2\"/>\n</joint>\n",
            0.1 + 0.001 * (link % 7) as f64
        );
    }
    text + "</robot>\n"
}

/// A car with an inertial sensor, a receiver and a lidar.
const DRIVE: &str = "\
duration_s: 20
drive: {vehicle: car, motion: turning, seed: 3}
chunk_size_bytes: 200000
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: imu_link, xyz: [0.1, 0.05, 0.3]}
      - {parent: base_link, child: gps, xyz: [-0.1, 0, 0.8]}
      - {parent: base_link, child: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30]}
  - {topic: /tf, rate_hz: 20, transforms: [{parent: odom, child: base_link, from_drive: odometry}]}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, xyz: [-0.1, 0, 0.8]}
  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu_link, xyz: [0.1, 0.05, 0.3]}
";

const CLOUDS: &str = "  - {topic: /points, from_drive: lidar, rate_hz: 1, frame_id: velodyne, xyz: [0.6, 0.1, 1.8], rpy_deg: [0, 0, 30], \
                      lidar: {driver: velodyne, table: vlp16, beams: 16, columns: 90}}\n";

const CALIBRATION: &str = "\
base_link:
  velodyne:
    translation: [0.6, 0.1, 1.8]
    rotation: [0.0, 0.0, 0.25881904510252074, 0.9659258262890683]
  imu_link:
    translation: [0.1, 0.05, 0.3]
    rotation: [0.0, 0.0, 0.0, 1.0]
";

/// The counted cases, with their files in `folder`.
fn cases(folder: &Path) -> Vec<Case> {
    let mut cases = vec![case("nothing to read", &["none"])];
    fs::create_dir(folder.join("none")).unwrap();
    for (name, links) in [("small", 4), ("median", 40), ("large", 1500)] {
        let file = format!("{name}.urdf");
        fs::write(folder.join(&file), robot(links)).unwrap();
        cases.push(case(&format!("urdf, {links} links"), &[&file]));
    }
    fs::create_dir(folder.join("files")).unwrap();
    for file in 0..60 {
        fs::write(folder.join(format!("files/{file:02}.yaml")), CALIBRATION).unwrap();
    }
    cases.push(case("60 calibrations", &["files"]));
    for (name, compression) in [("zstd", "zstd"), ("lz4", "lz4"), ("plain", "none")] {
        let file = format!("{name}.mcap");
        support::write(&format!("compression: {compression}\n{DRIVE}"), &folder.join(&file));
        cases.push(case(&format!("mcap {name}"), &["--full", &file]));
    }
    support::write(&format!("{DRIVE}{CLOUDS}"), &folder.join("clouds.mcap"));
    cases.push(case("mcap with clouds", &["clouds.mcap"]));
    fs::create_dir(folder.join("copies")).unwrap();
    for copy in 0..20 {
        fs::copy(folder.join("zstd.mcap"), folder.join(format!("copies/{copy:02}.mcap"))).unwrap();
    }
    cases.push(case("20 recordings", &["--windows", "2", "copies"]));
    // The rules on saved evidence.
    fs::create_dir(folder.join("car")).unwrap();
    fs::copy(folder.join("clouds.mcap"), folder.join("car/drive.mcap")).unwrap();
    fs::write(folder.join("car/lidar.yaml"), CALIBRATION).unwrap();
    let saved = support::program::run(folder, ["collect", "car", "-o", "evidence.json"]);
    assert_eq!(saved.code, 0, "{}", saved.err);
    let families: BTreeSet<&str> = RULES.iter().map(|entry| entry.page.family()).collect();
    for family in families.into_iter().filter(|family| *family != "GATE") {
        let arguments = ["--evidence", "evidence.json", "--select", family];
        cases.push(case(&format!("rules {family}"), &arguments));
    }
    cases
}

/// Makes files with a number of items: names and paths with their texts.
type FileMaker = fn(usize) -> Vec<(String, String)>;

/// Inputs that can be of any size, most of them with a mistake in each part: the search for the intended name must not grow quadratically.
const SIZED: &[(&str, FileMaker)] = &[
    ("faulty links", |count| {
        vec![("robot.urdf".to_owned(), faulty_robot(count))]
    }),
    ("calibrations in a file", |count| {
        vec![("chain.yaml".to_owned(), cameras(count))]
    }),
    ("calibrations in as many files", |count| {
        let text = |number| {
            let text = CALIBRATION.replace("velodyne", &format!("lidar_{number}"));
            text.replace("imu_link", &format!("imu_{number}"))
        };
        let file = |number| (format!("{number}.yaml"), text(number));
        (0..count).map(file).collect()
    }),
    ("files of one pair of frames that agree", |count| {
        (0..count)
            .map(|number| (format!("{number}.yaml"), CALIBRATION.to_owned()))
            .collect()
    }),
    ("files of one pair of frames that differ", |count| {
        let text = |number| CALIBRATION.replace("translation: [", &format!("translation: [{number}"));
        (0..count)
            .map(|number| (format!("{number}.yaml"), text(number)))
            .collect()
    }),
    ("statements of one pair of frames in one file", |count| {
        let line = |number| {
            format!("k{number}: {{parent: base, child: lidar, x: 0.{number}, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}}\n")
        };
        vec![("mounts.yaml".to_owned(), (0..count).map(line).collect())]
    }),
    ("links with comments", |count| {
        let link =
            |number| format!("<link name=\"l{number}\"/> <!-- frames-lint: allow TREE06 a part on the bench -->\n");
        robot_of(&(0..count).map(link).collect::<String>())
    }),
    ("a ring of links", |count| {
        let link = |number: usize| {
            let next = (number + 1) % count;
            format!(
                "<link name=\"l{number}\"/><joint name=\"j{number}\" type=\"fixed\"><parent link=\"l{number}\"/><child link=\"l{next}\"/></joint>\n"
            )
        };
        robot_of(&(0..count).map(link).collect::<String>())
    }),
    ("static transforms of a launch file", |count| {
        let node = |number: usize| {
            format!(
                "<node pkg=\"tf2_ros\" exec=\"static_transform_publisher\" name=\"s{number}\" args=\"1 2 3 0 0 0 base_link lidar{number}\"/>\n"
            )
        };
        let nodes: String = (0..count).map(node).collect();
        vec![("bringup.launch.xml".to_owned(), format!("<launch>\n{nodes}</launch>\n"))]
    }),
];

/// A file of a robot with these elements.
fn robot_of(elements: &str) -> Vec<(String, String)> {
    vec![(
        "robot.urdf".to_owned(),
        format!("<robot name=\"r\">\n{elements}</robot>\n"),
    )]
}

/// A robot whose every sixth link has one mistake of six.
fn faulty_robot(count: usize) -> String {
    let mut text = "<robot name=\"r\">\n<link name=\"base_link\"/>\n".to_owned();
    for number in 0..count {
        let (child, used) = match number % 6 {
            0 => (format!("Lidar{number}"), format!("lidar{number}")),
            1 => (
                format!("camera{number}_optical_frame"),
                format!("camera{number}_optical_frame"),
            ),
            2 => (format!("imu{number}_ned"), format!("imu{number}_ned")),
            3 => (format!("wheel{number}"), format!("wheel{number}x")),
            4 => (format!("gps{number}"), format!("gps{number} ")),
            _ => (format!("imu{}", number - 3), format!("imu{}", number - 3)),
        };
        let kind = if number % 6 == 3 { "fixd" } else { "fixed" };
        let _ = write!(
            text,
            "<link name=\"{child}\"/>\n<joint name=\"joint{number}\" type=\"{kind}\"><parent link=\"base_link\"/>\
             <child link=\"{used}\"/><origin xyz=\"0 0.1 0.{number}\" rpy=\"0 0 90\"/></joint>\n"
        );
    }
    text + "</robot>\n"
}

/// Cameras of Kalibr, each with its transform to an inertial sensor.
fn cameras(count: usize) -> String {
    let camera = |number: usize| {
        format!(
            "cam{number}:\n  T_cam_imu:\n  - [1, 0, 0, 0.{number}]\n  - [0, 1, 0, 2]\n  - [0, 0, 1, 3]\n  - [0, 0, 0, 1]\n  camera_model: pinhole\n\
             \x20 intrinsics: [400, 400, 300, 200]\n  resolution: [640, 480]\n  rostopic: /cam{number}\n"
        )
    };
    (0..count).map(camera).collect()
}

#[test]
fn four_times_the_input_costs_no_more_than_six_times() {
    const PARTS: usize = 80;
    let folder = tempfile::tempdir().unwrap();
    let sizes = [PARTS, 4 * PARTS];
    let calls: Vec<(&str, usize, Case)> = SIZED
        .iter()
        .flat_map(|(name, files)| sizes.map(|size| (*name, size, files(size))))
        .map(|(name, size, files)| {
            let place = format!("{name} {size}").replace(' ', "_");
            fs::create_dir(folder.path().join(&place)).unwrap();
            for (file, text) in files {
                fs::write(folder.path().join(&place).join(file), text).unwrap();
            }
            (name, size, case(name, &[&place]))
        })
        .collect();
    let counts: Option<Vec<(&str, usize, u64)>> = calls
        .par_iter()
        .map(|(name, size, case)| Some((*name, *size, counted(Path::new(TESTED), folder.path(), case)?)))
        .collect();
    let Some(counts) = counts else {
        return left_out("no valgrind, which counts instructions");
    };
    let of = |name: &str, size: usize| counts.iter().find(|one| (one.0, one.1) == (name, size)).unwrap().2;
    let mut faults = Vec::new();
    for (name, _) in SIZED {
        let [less, more] = sizes.map(|size| of(name, size) as f64);
        let line = format!(
            "{name}: {:.1} M instructions, {:.2} times for four times as many",
            less / 1e6,
            more / less
        );
        println!("{line}");
        if more > 6.0 * less {
            faults.push(line);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The program that `cargo test` builds.
const TESTED: &str = env!("CARGO_BIN_EXE_frames-lint");

/// The program that `packaging/build` builds, or why it is not counted.
fn packaged() -> Result<PathBuf, &'static str> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = root.join("target/x86_64-unknown-linux-gnu/release/frames-lint");
    let modified = |path: &Path| path.metadata().and_then(|data| data.modified());
    let Ok(built) = modified(&program) else {
        return Err("no packages, whose program is counted: packaging/build builds them");
    };
    let folders = ["src", "rules"]
        .into_iter()
        .flat_map(|folder| support::files(&root.join(folder), ""));
    let mut sources = folders.chain(["Cargo.lock", "Cargo.toml"].map(|name| root.join(name)));
    if sources.any(|source| modified(&source).is_ok_and(|time| time > built)) {
        return Err("the program in the packages is older than its sources: packaging/build builds it");
    }
    Ok(program)
}

/// Instructions of one call; `None` without Valgrind.
fn counted(program: &Path, folder: &Path, case: &Case) -> Option<u64> {
    let ran = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(&case.arguments)
        .current_dir(folder)
        .env_clear()
        .env("PATH", std::env::var_os("PATH").unwrap_or_default())
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .ok()?;
    let said = String::from_utf8_lossy(&ran.stderr).into_owned();
    let count = said.lines().find_map(|line| line.split("Collected :").nth(1));
    let count = count.and_then(|count| count.trim().parse().ok());
    Some(count.unwrap_or_else(|| panic!("{}: {said}", case.name)))
}

/// What the counts depend on: the compiler's version, and the processor's features.
fn machine() -> String {
    let ran = Command::new("rustc").arg("--version").output().unwrap();
    let compiler = String::from_utf8(ran.stdout).unwrap().trim().to_owned();
    let processor = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let avx2 = if processor.contains(" avx2 ") {
        "AVX2"
    } else {
        "no AVX2"
    };
    format!("{compiler}, {}, {avx2}", std::env::consts::ARCH)
}

#[test]
fn no_case_costs_more_than_its_baseline() {
    let program = match packaged() {
        Ok(program) => program,
        Err(reason) => return left_out(reason),
    };
    let folder = tempfile::tempdir().unwrap();
    let cases = cases(folder.path());
    let counts: Option<Vec<(&str, u64)>> = cases
        .par_iter()
        .map(|case| Some((case.name.as_str(), counted(&program, folder.path(), case)?)))
        .collect();
    let Some(counts) = counts else {
        return left_out("no valgrind, which counts instructions");
    };
    let place = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("benches/instructions/baseline.tsv");
    if std::env::var_os("UPDATE").is_some() {
        let mut text = format!("# instructions, {}\n", machine());
        for (name, count) in &counts {
            let _ = writeln!(text, "{name}\t{count}");
        }
        return fs::write(place, text).unwrap();
    }
    let text = fs::read_to_string(place).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    let rows = rows.lines().filter_map(|line| line.split_once('\t'));
    let baseline: BTreeMap<&str, f64> = rows.map(|(name, count)| (name, count.parse().unwrap())).collect();
    let mut faults = Vec::new();
    for (name, count) in &counts {
        let millions = *count as f64 / 1e6;
        let Some(before) = baseline.get(name) else {
            faults.push(format!("{name}: {millions:.2} M, but missing in the baseline"));
            continue;
        };
        let grown = *count as f64 / before - 1.0;
        let line = format!("{name}: {millions:.2} M instructions, {:+.1} %", 100.0 * grown);
        println!("{line}");
        if !(-LESS..=MORE).contains(&grown) {
            faults.push(line);
        }
    }
    if !head.ends_with(&machine()) {
        return left_out("the baseline of instructions is of another compiler or processor");
    }
    let advice = "UPDATE=1 writes a new baseline; give the reason in the commit";
    assert!(faults.is_empty(), "{}\n{advice}", faults.join("\n"));
}
