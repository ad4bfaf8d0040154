//! Bad input through the real program: it ends with the right exit code, says what is wrong with which file and where,
//! never panics, never takes much memory, and says the same twice.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::ffi::OsString;
use std::fs::{self, File};
use std::os::unix::ffi::OsStringExt;
use std::os::unix::fs::{PermissionsExt, symlink};

use crate::support;
use crate::support::damage::{cut, first_chunk, patched};
use crate::support::left_out;
use crate::support::program::{check, check_all};
use crate::support::reading::folder;
use crate::support::recipe::DRIVE;
use frames_lint::run::FailOn;

const ROBOT: &str = "<robot name=\"ä\"><link name=\"base_link\"/></robot>\n";
const EXTRINSIC: &str = "# ä\nlidar_from_imu:\n  translation: [1.0, 2.0, 3.0]\n  rotation: [0.0, 0.0, 0.0, 1.0]\n";

const KINDS: [&str; 5] = ["urdf", "xacro", "yaml", "json", "mcap"];

#[test]
fn empty_files_and_blanks() {
    for kind in KINDS {
        check(&format!("empty.{kind}"), "", 3, &["the file is empty"]);
        let why = if kind == "mcap" {
            "not an MCAP: the magic bytes at byte 0 are missing"
        } else {
            "the file contains only whitespace"
        };
        check(&format!("blanks.{kind}"), " \n\t\r\n  ", 3, &[why]);
    }
}

#[test]
fn a_program_under_another_name() {
    let program = fs::read(env!("CARGO_BIN_EXE_frames-lint")).unwrap();
    for kind in ["urdf", "xacro", "yaml", "json"] {
        check(
            &format!("program.{kind}"),
            &program[..200_000],
            3,
            &["not a text file", "the first at byte 4"],
        );
    }
    check(
        "program.mcap",
        &program[..200_000],
        3,
        &["the magic bytes at byte 0 are missing"],
    );
    check(
        "program",
        &program[..200_000],
        3,
        &["not a format that frames-lint reads"],
    );
}

#[test]
fn folders_and_paths_that_hold_nothing() {
    let folder = folder();
    fs::create_dir(folder.path().join("empty")).unwrap();
    fs::create_dir(folder.path().join("x.urdf")).unwrap();
    fs::create_dir(folder.path().join("photos")).unwrap();
    fs::write(folder.path().join("photos/a.png"), "x").unwrap();
    for name in ["empty", "x.urdf", "photos"] {
        let report = check_all(
            folder.path(),
            &[name],
            3,
            &["the folder contains no file that frames-lint reads"],
        );
        assert_eq!(report["inputs"][0]["path"], name);
    }
    // A good file beside it does not hide it.
    fs::write(folder.path().join("car.urdf"), ROBOT).unwrap();
    check_all(folder.path(), &["car.urdf", "empty"], 3, &["empty"]);
    let report = check_all(
        folder.path(),
        &["no/such.urdf"],
        3,
        &["no/such.urdf", "cannot be opened: No such file"],
    );
    assert_eq!(report["inputs"][0]["status"], "unreadable");
}

#[test]
fn pipes_devices_and_rings_of_links_are_refused() {
    let folder = folder();
    symlink("ring.urdf", folder.path().join("ring.urdf")).unwrap();
    check_all(folder.path(), &["ring.urdf"], 3, &["cannot be opened: Too many levels"]);
    symlink("/dev/zero", folder.path().join("zero.yaml")).unwrap();
    check_all(folder.path(), &["zero.yaml"], 3, &["zero.yaml", "not a regular file"]);
    let pipe = folder.path().join("pipe.mcap");
    if std::process::Command::new("mkfifo")
        .arg(&pipe)
        .status()
        .is_ok_and(|status| status.success())
    {
        check_all(folder.path(), &["pipe.mcap"], 3, &["pipe.mcap", "not a regular file"]);
        check_all(folder.path(), &["."], 3, &["pipe.mcap", "not a regular file"]);
    }
}

#[test]
fn links_in_a_folder_are_followed_to_files_only() {
    let folder = folder();
    fs::create_dir_all(folder.path().join("robot/config")).unwrap();
    fs::write(folder.path().join("car.urdf"), ROBOT).unwrap();
    symlink("../car.urdf", folder.path().join("robot/car.urdf")).unwrap();
    symlink("..", folder.path().join("robot/config/up")).unwrap();
    let report = check_all(folder.path(), &["robot"], 0, &[]);
    assert_eq!(report["inputs"].as_array().unwrap().len(), 1);
    symlink("gone.yaml", folder.path().join("robot/lidar.yaml")).unwrap();
    check_all(folder.path(), &["robot"], 3, &["robot/lidar.yaml", "cannot be opened"]);
}

#[test]
fn a_file_that_may_not_be_read() {
    let folder = folder();
    let path = folder.path().join("secret.urdf");
    fs::write(&path, ROBOT).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o000)).unwrap();
    if File::open(&path).is_ok() {
        left_out("the user may read every file");
        return;
    }
    check_all(
        folder.path(),
        &["secret.urdf"],
        3,
        &["secret.urdf", "cannot be opened: Permission denied"],
    );
}

#[test]
fn a_path_given_twice_is_read_once() {
    let folder = folder();
    let joint = "<link name=\"lidar\"/><joint name=\"j\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"lidar\"/></joint>";
    let robot = ROBOT.replace("</robot>", &format!("{joint}</robot>"));
    fs::create_dir(folder.path().join("robot")).unwrap();
    fs::write(folder.path().join("robot/car.urdf"), robot).unwrap();
    fs::write(folder.path().join("robot/lidar.yaml"), EXTRINSIC).unwrap();
    symlink("robot/car.urdf", folder.path().join("link.urdf")).unwrap();
    for names in [
        vec!["robot/car.urdf", "robot/car.urdf", "./robot/car.urdf"],
        vec!["robot/car.urdf", "link.urdf", "robot/../robot/car.urdf"],
    ] {
        assert_eq!(
            check_all(folder.path(), &names, 0, &[])["inputs"]
                .as_array()
                .unwrap()
                .len(),
            1
        );
    }
    // A file named beside its folder stays with the folder: still one platform of two files.
    for names in [
        vec!["robot/car.urdf", "robot"],
        vec!["robot", "robot/", "robot/car.urdf"],
    ] {
        let report = check_all(folder.path(), &names, 0, &[]);
        assert_eq!(report["inputs"].as_array().unwrap().len(), 2);
        let subjects = report["outcomes"].to_string();
        assert!(
            !subjects.contains("car.urdf: "),
            "one platform needs no label: {subjects}"
        );
    }
}

#[test]
fn a_name_that_is_no_utf8() {
    let folder = folder();
    let name = OsString::from_vec(b"caf\xe9.urdf".to_vec());
    fs::write(folder.path().join(&name), ROBOT).unwrap();
    let report = check_all(folder.path(), &[&name], 0, &[]);
    assert_eq!(report["inputs"][0]["path"], "caf\\xe9.urdf");
    fs::write(folder.path().join(&name), "<robot").unwrap();
    check_all(folder.path(), &[name], 3, &["xe9.urdf", "not well-formed XML"]);
}

#[test]
fn encodings() {
    let wide = |text: &str, bytes: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    let latin = |text: &str| {
        text.chars()
            .map(|c| u8::try_from(u32::from(c)).unwrap())
            .collect::<Vec<u8>>()
    };
    for (name, text) in [("car.urdf", ROBOT), ("imu.yaml", EXTRINSIC)] {
        let marked = format!("\u{feff}{text}");
        for bytes in [
            wide(&marked, u16::to_le_bytes),
            wide(&marked, u16::to_be_bytes),
            wide(text, u16::to_le_bytes),
            wide(text, u16::to_be_bytes),
        ] {
            let report = check(name, bytes, 0, &[]);
            assert_eq!(report["inputs"][0]["detail"], "read as UTF-16", "{name}");
        }
        let report = check(name, latin(text), 0, &[]);
        let byte = text.find('ä').unwrap();
        let expected = format!("not UTF-8 (byte {byte}); read as Latin-1");
        assert_eq!(report["inputs"][0]["detail"], expected.as_str());
        let mut half = wide(&marked, u16::to_le_bytes);
        half.pop();
        check(name, half, 3, &["half a character"]);
        let utf32: Vec<u8> = marked.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        check(name, utf32, 3, &["UTF-32"]);
    }
    check("nul.yaml", "a: 1\nb: \0\n", 3, &["a NUL character at byte 8"]);
}

/// The drive in small chunks.
fn drive() -> Vec<u8> {
    support::build(&format!("chunk_size_bytes: 4000{DRIVE}"))
}

#[test]
fn a_recording_cut_anywhere_is_never_clean() {
    let bytes = drive();
    let folder = folder();
    let path = folder.path().join("drive.mcap");
    for percent in 0..100 {
        fs::write(&path, cut(&bytes, percent)).unwrap();
        let run = support::checked(&path);
        assert_eq!(
            run.exit_code(FailOn::Error),
            3,
            "cut at {percent} %: {:?}",
            run.verdict.findings
        );
        let problem = &run.sources[0].problems[0].message;
        assert!(percent == 0 || problem.contains("byte"), "{problem}");
    }
    for percent in [1, 25, 50, 99] {
        check(
            "drive.mcap",
            cut(&bytes, percent),
            3,
            &["read up to byte ", "the file ends"],
        );
    }
    check("drive.mcap", &bytes, 0, &[]);
}

#[test]
fn a_recording_that_claims_too_much() {
    let bytes = drive();
    let chunk = first_chunk(&bytes);
    // The length of the record, then what the chunk claims to hold.
    for (at, why) in [
        (
            chunk + 1,
            "a chunk record of 4611686018427387904 bytes reaches into the next chunk",
        ),
        (chunk + 25, "a chunk claims 4611686018427387904 bytes"),
    ] {
        let lying = patched(&bytes, at, &u64::to_le_bytes(1 << 62));
        check("lying.mcap", lying, 3, &["1 chunk is damaged, at byte ", why]);
    }
}
