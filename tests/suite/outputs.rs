//! What the program writes: never over an input or over what is no report, whole or not at all, and nothing is left behind.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::formats::FORMS;
use crate::support::at_hand::left_out;
use crate::support::program;

const ROBOT: &str = r#"<robot name="car">
  <link name="base_link"/>
  <link name="lidar"/>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/><child link="lidar"/><origin xyz="0.95 0.12 1.85" rpy="0 0 0.35"/>
  </joint>
</robot>
"#;

const LIDAR: &str = "\
base_link_from_lidar:
  translation: [0.95, 0.12, 1.85]
  rotation: {x: 0.0, y: 0.0, z: 0.1741081, w: 0.9847265}
";

fn platform() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("car.urdf"), ROBOT).unwrap();
    fs::write(folder.path().join("lidar.yaml"), LIDAR).unwrap();
    folder
}

/// What stands in a folder, hidden files included.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn no_output_is_written_over_an_input() {
    let calls = [
        "check . -o car.urdf",
        "check . --force -o car.urdf",
        "check . --output json=lidar.yaml",
        "check . --output json-lines=lidar.yaml",
        "check . -o ./link",
        "check . -o twin",
        "check . --write-baseline car.urdf",
        "collect . -o car.urdf",
        "convert . --to tf -o car.urdf",
        "init . --force -o car.urdf",
        "chain lidar.py -o lidar.py",
    ];
    for call in calls {
        let folder = platform();
        let path = folder.path();
        fs::write(path.join("lidar.py"), "x = 1\n").unwrap();
        symlink("lidar.yaml", path.join("link")).unwrap();
        fs::hard_link(path.join("car.urdf"), path.join("twin")).unwrap();
        let ran = program::run(path, call.split(' '));
        assert_eq!(ran.code, 2, "{call}: {}{}", ran.text(), ran.err);
        assert!(ran.err.contains("it is the input"), "{call}: {}", ran.err);
        assert_eq!(fs::read_to_string(path.join("car.urdf")).unwrap(), ROBOT, "{call}");
        assert_eq!(fs::read_to_string(path.join("lidar.yaml")).unwrap(), LIDAR, "{call}");
    }
}

#[test]
fn a_file_that_is_no_report_is_replaced_by_force_alone() {
    // A word of ours in a file does not make it a report.
    let foreign = "# frames-lint: ignore CROSS02\nimu: {x: 1}\nerror[E0433]: no such thing\n";
    for output in ["notes", "json=notes", "json-lines=notes", "html=notes"] {
        let folder = platform();
        let notes = folder.path().join("notes");
        fs::write(&notes, foreign).unwrap();
        let ran = program::run(folder.path(), ["check", "car.urdf", "-o", output]);
        assert_eq!(ran.code, 2, "{}", ran.err);
        assert!(ran.err.contains("with --force"), "{}", ran.err);
        assert_eq!(fs::read_to_string(&notes).unwrap(), foreign);
        let ran = program::run(folder.path(), ["check", "car.urdf", "-o", output, "--force"]);
        assert_eq!(ran.code, 0, "{}", ran.err);
        assert_ne!(fs::read_to_string(&notes).unwrap(), foreign);
    }
}

#[test]
fn reports_evidence_and_baselines_are_replaced_by_new_ones() {
    let mut calls: Vec<String> = Vec::new();
    for form in FORMS.into_iter().chain(["human", "html"]) {
        // With findings, and without any.
        calls.push(format!("check . --output {form}=report"));
        calls.push(format!("check car.urdf --output {form}=report"));
        calls.push(format!("check . --quiet --output {form}=report"));
    }
    calls.extend(["collect . -o report", "check . --write-baseline report"].map(str::to_owned));
    for call in calls {
        let folder = platform();
        fs::write(folder.path().join("lidar.yaml"), LIDAR.replace("0.95", "-0.93")).unwrap();
        let first = program::run(folder.path(), call.split(' '));
        let again = program::run(folder.path(), call.split(' '));
        assert!([0, 1].contains(&first.code), "{call}: {}", first.err);
        assert_eq!(again.code, first.code, "{call}: {}", again.err);
    }
}

#[test]
fn the_last_report_is_no_input_of_the_next_run() {
    let folder = platform();
    let call = ["check", ".", "--output", "json=report.json"];
    let reports = [(); 2].map(|()| {
        assert_eq!(program::run(folder.path(), call).code, 0);
        fs::read_to_string(folder.path().join("report.json")).unwrap()
    });
    assert_eq!(reports[0], reports[1]);
    let ran = program::run(folder.path(), ["collect", "car.urdf", "-o", "evidence.json"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let ran = program::run(
        folder.path(),
        ["check", "--evidence", "evidence.json", "-o", "evidence.json"],
    );
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("it is the input"), "{}", ran.err);
}

#[test]
fn what_a_run_is_governed_by_is_not_replaced() {
    let folder = platform();
    let path = folder.path();
    fs::write(path.join("frames-lint.yaml"), "fail-on: warning\n").unwrap();
    let written = program::run(path, ["check", ".", "--write-baseline", "baseline.json"]);
    assert_eq!(written.code, 0, "{}", written.err);
    let accepted = fs::read_to_string(path.join("baseline.json")).unwrap();
    for call in [
        "check . --baseline baseline.json -o baseline.json",
        "check . --force -o frames-lint.yaml",
    ] {
        let ran = program::run(path, call.split(' '));
        assert_eq!(ran.code, 2, "{call}: {}", ran.text());
        assert!(ran.err.contains("it is the input"), "{call}: {}", ran.err);
    }
    assert_eq!(fs::read_to_string(path.join("baseline.json")).unwrap(), accepted);
    // A baseline is read and written anew.
    let call = "check . --baseline baseline.json --write-baseline baseline.json";
    assert_eq!(program::run(path, call.split(' ')).code, 0);
}

#[test]
fn each_output_has_its_own_file() {
    let folder = platform();
    fs::write(folder.path().join("report"), "").unwrap();
    symlink("report", folder.path().join("link")).unwrap();
    let ran = program::run(
        folder.path(),
        ["check", ".", "--output", "json=report", "--output", "html=link"],
    );
    assert_eq!(ran.code, 2);
    assert!(ran.err.contains("are the same file"), "{}", ran.err);
    let twice = ["check", ".", "--output", "json=new", "--output", "html=./new"];
    let ran = program::run(folder.path(), twice);
    assert!(ran.code == 2 && ran.err.contains("two outputs"), "{}", ran.err);
    let ran = program::run(
        folder.path(),
        ["check", ".", "--output", "json=/dev/null", "--output", "html=/dev/null"],
    );
    assert_eq!(ran.code, 0, "{}", ran.err);
}

#[test]
fn a_format_alone_is_no_file() {
    let folder = platform();
    for call in ["check . -o json", "check . --output sarif", "assure . -o html"] {
        let ran = program::run(folder.path(), call.split(' '));
        assert_eq!(ran.code, 2, "{call}: {}", ran.text());
        assert!(ran.err.contains("this is a format"), "{call}: {}", ran.err);
    }
    assert!(
        ["json", "sarif", "html"]
            .iter()
            .all(|name| !folder.path().join(name).exists())
    );
    let ran = program::run(folder.path(), ["assure", ".", "-o", "json=mistakes"]);
    assert!(
        fs::read_to_string(folder.path().join("mistakes"))
            .unwrap()
            .starts_with('{'),
        "{}",
        ran.err
    );
    // A file of that name can be written by its path.
    let ran = program::run(folder.path(), ["check", ".", "-o", "./json"]);
    assert!(ran.code == 0 && folder.path().join("json").exists(), "{}", ran.err);
}

#[test]
fn a_file_that_is_replaced_keeps_its_mode_its_links_and_its_attributes() {
    let folder = platform();
    let path = folder.path();
    let report = path.join("report.json");
    fs::write(&report, "").unwrap();
    fs::set_permissions(&report, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("report.json", path.join("link")).unwrap();
    let has_attributes = xattr::set(&report, "user.owner", b"survey").is_ok();
    let before = fs::metadata(&report).unwrap();
    let ran = program::run(path, ["check", ".", "--output", "json=link"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let after = fs::metadata(&report).unwrap();
    assert!(after.len() > 1000 && fs::symlink_metadata(path.join("link")).unwrap().is_symlink());
    assert_eq!(
        (after.mode(), after.uid(), after.gid()),
        (before.mode(), before.uid(), before.gid())
    );
    if has_attributes {
        assert_eq!(xattr::get(&report, "user.owner").unwrap().unwrap(), b"survey");
    } else {
        left_out("no extended attributes in the folder for temporary files");
    }
    // One that is new has the mode that the user's mask leaves.
    let ran = Command::new("sh")
        .args(["-c", "umask 027; exec \"$0\" check . --output json=new.json"])
        .arg(env!("CARGO_BIN_EXE_frames-lint"))
        .current_dir(path)
        .status();
    assert!(ran.unwrap().success());
    assert_eq!(fs::metadata(path.join("new.json")).unwrap().mode() & 0o777, 0o640);
    assert_eq!(
        names(path),
        ["car.urdf", "lidar.yaml", "link", "new.json", "report.json"]
    );
}

/// Puts such a file there.
type FileMaker<'a> = &'a dyn Fn(&Path);

/// A robot with a fix: an optical frame that is not turned.
const WITH_FIX: &str = r#"<robot name="car">
  <link name="camera_link"/>
  <link name="camera_optical_frame"/>
  <joint name="camera_optical_joint" type="fixed">
    <parent link="camera_link"/><child link="camera_optical_frame"/><origin xyz="0 0 0" rpy="0 0 0"/>
  </joint>
</robot>
"#;

#[test]
fn a_fix_replaces_what_was_meant_and_the_rest_by_force_alone() {
    let outside = tempfile::tempdir().unwrap();
    let other = outside.path().join("car.urdf");
    let cases: [(&str, FileMaker); 3] = [
        ("it is read-only", &|robot| {
            fs::write(robot, WITH_FIX).unwrap();
            fs::set_permissions(robot, fs::Permissions::from_mode(0o444)).unwrap();
        }),
        ("it has 2 names", &|robot| {
            fs::write(robot, WITH_FIX).unwrap();
            fs::hard_link(robot, robot.with_file_name("twin.txt")).unwrap();
        }),
        ("it is outside of the checked paths", &|robot| {
            fs::write(&other, WITH_FIX).unwrap();
            symlink(&other, robot).unwrap();
        }),
    ];
    for (why, make) in cases {
        let folder = tempfile::tempdir().unwrap();
        let robot = folder.path().join("car.urdf");
        make(&robot);
        let mode = fs::metadata(&robot).unwrap().mode();
        let ran = program::run(folder.path(), ["check", ".", "--fix", "--unsafe-fixes"]);
        assert!(ran.err.contains(why), "{why}: {}{}", ran.err, ran.text());
        assert_eq!(fs::read_to_string(&robot).unwrap(), WITH_FIX, "{why}");
        let ran = program::run(folder.path(), ["check", ".", "--fix", "--unsafe-fixes", "--force"]);
        assert!(!ran.err.contains(why), "{why}: {}", ran.err);
        assert!(
            fs::read_to_string(&robot).unwrap().contains("-1.57"),
            "{why}: {}",
            ran.err
        );
        assert_eq!(fs::metadata(&robot).unwrap().mode(), mode, "{why}");
    }
}

#[test]
fn a_report_that_finds_no_room_leaves_the_old_one() {
    for output in ["json=report", "json-lines=report", "html=report"] {
        let folder = platform();
        let call = ["check", ".", "--output", output];
        assert_eq!(program::run(folder.path(), call).code, 0);
        let old = fs::read(folder.path().join("report")).unwrap();
        // What is longer than a block cannot be written: the error of a full disk, on files of this program alone.
        let ran = Command::new("bash")
            .args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\""])
            .arg(env!("CARGO_BIN_EXE_frames-lint"))
            .args(call)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let err = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(2), "{output}: {err}");
        assert!(err.contains("cannot write `report`"), "{output}: {err}");
        assert!(fs::read(folder.path().join("report")).unwrap() == old, "{output}");
        assert_eq!(names(folder.path()), ["car.urdf", "lidar.yaml", "report"]);
    }
}

#[test]
fn a_folder_that_does_not_exist_is_an_error_before_anything_is_read() {
    let folder = platform();
    for call in [
        ["check", ".", "--output", "json=no/such/report.json"],
        ["assure", ".", "--output", "no/such/report.json"],
        ["collect", ".", "--output", "no/such/report.json"],
    ] {
        let ran = program::run(folder.path(), call);
        let why = "cannot write `no/such/report.json`: its folder does not exist";
        assert_eq!((ran.code, ran.text()), (2, String::new()), "{call:?}");
        assert!(ran.err.contains(why), "{call:?}: {}", ran.err);
    }
}

#[test]
fn nothing_is_left_by_a_program_that_is_told_to_end() {
    for signal in ["INT", "TERM", "HUP"] {
        let (folder, temporary) = (platform(), tempfile::tempdir().unwrap());
        // The baseline never comes.
        let pipe = folder.path().join("pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let call = [
            "check",
            "car.urdf",
            "--output",
            "json-lines=report",
            "--baseline",
            "pipe",
        ];
        let mut child = Command::new(env!("CARGO_BIN_EXE_frames-lint"))
            .args(call)
            .current_dir(folder.path())
            .env("TMPDIR", temporary.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begin = Instant::now();
        let is_begun = || {
            names(folder.path())
                .iter()
                .any(|name| name.starts_with(".frames-lint-"))
        };
        while !is_begun() {
            assert!(begin.elapsed() < Duration::from_secs(60), "it does not begin to write");
            std::thread::sleep(Duration::from_millis(5));
        }
        let id = child.id().to_string();
        assert!(
            Command::new("kill")
                .args(["-s", signal, &id])
                .status()
                .unwrap()
                .success()
        );
        let ended = child.wait().unwrap();
        assert!(!ended.success(), "{signal}");
        assert_eq!(names(folder.path()), ["car.urdf", "lidar.yaml", "pipe"], "{signal}");
        assert!(names(temporary.path()).is_empty(), "{signal}");
    }
}
