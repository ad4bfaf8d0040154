//! `check --for`: whether a recording is fit for a calibration, on drives whose motion is known.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::program::{CallResult, is_sound, run};
use crate::support::recipe::Recipe;

/// A car on a road: it rotates about z.
const PLANAR: &str =
    "{vehicle: car, motion: turning, seed: 1, tilt_deg: 1, imu: perfect, gnss: perfect, odometry: perfect}";
/// Carried by somebody who tilts it.
const TILTED: &str =
    "{vehicle: walker, motion: turning, seed: 1, tilt_deg: 30, imu: perfect, gnss: perfect, odometry: perfect}";

const MOUNTS: &str = "  - {topic: /tf_static, transforms: [{parent: base_link, child: imu}, {parent: base_link, child: lidar, xyz: [1, 0, 1.8]}]}\n";
const LIDAR: &str = "  - {topic: /points, from_drive: lidar, rate_hz: 10, frame_id: lidar, xyz: [1, 0, 1.8], lidar: {beams: 8, columns: 90, driver: velodyne}}\n";
const IMU: &str = "  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu}\n";
const POSES: &str = "  - {topic: /pose_a, from_drive: pose, rate_hz: 20, frame_id: map}\n  - {topic: /pose_b, from_drive: pose, rate_hz: 20, \
                     frame_id: map, xyz: [0.4, 0.1, 0.2], rpy_deg: [0, 20, 90]}\n";
const IMAGES: &str = "  - {topic: /front/image_raw, type: sensor_msgs/msg/Image, rate_hz: 10, frame_id: front_optical, camera: {size: [640, 480]}}\n";
const CAMERA_INFO: &str = "  - {topic: /front/camera_info, type: sensor_msgs/msg/CameraInfo, rate_hz: 10, frame_id: front_optical, camera: {size: \
                           [640, 480], k: [500, 500, 320, 240]}}\n";

fn recording(drive: &str, seconds: u32, topics: &[&str]) -> Vec<u8> {
    Recipe::parse(&format!(
        "duration_s: {seconds}\ndrive: {drive}\ntopics:\n{}",
        topics.concat()
    ))
    .to_mcap()
}

fn ask(folder: &Path, kind: &str, more: &[&str]) -> CallResult {
    let ran = run(folder, ["check", ".", "--for", kind].iter().chain(more));
    is_sound(&ran, kind);
    ran
}

/// The exit code and the fitness of one recording.
fn told(kind: &str, bytes: &[u8]) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("drive.mcap"), bytes).unwrap();
    // What the rules find does not matter here.
    let ran = ask(folder.path(), kind, &["--format", "json", "--fail-on", "never"]);
    let mut report = ran.report();
    let fitness = report["fitness"].as_array_mut().unwrap();
    assert_eq!(fitness.len(), 1, "{fitness:#?}");
    let fitness = fitness.remove(0);
    let is_fit = fitness["verdict"] == "fit";
    let required = report["required"].as_array().unwrap();
    assert_eq!(required.iter().any(|one| one["rule"] == kind), !is_fit, "{required:#?}");
    assert!(is_fit || ran.code == 3, "{fitness:#}");
    (ran.code, fitness)
}

fn condition<'f>(fitness: &'f Value, name: &str) -> &'f Value {
    let conditions = fitness["conditions"].as_array().unwrap();
    let found = conditions.iter().find(|condition| condition["name"] == name);
    found.unwrap_or_else(|| panic!("no condition `{name}` in {fitness:#}"))
}

/// That this recording is not fit because of this condition, whose reason or record has these words.
fn is_unfit(kind: &str, bytes: &[u8], name: &str, words: &str) -> Value {
    let (_, fitness) = told(kind, bytes);
    assert_eq!(fitness["verdict"], "not fit", "{fitness:#}");
    let condition = condition(&fitness, name);
    assert_eq!(condition["state"], "not met", "{fitness:#}");
    assert!(condition["reason"].as_str().unwrap().contains(words), "{condition:#}");
    fitness
}

#[test]
fn a_lidar_and_an_imu_that_are_tilted_about_all_axes_are_fit() {
    let (code, fitness) = told("lidar-imu", &recording(TILTED, 40, &[MOUNTS, LIDAR, IMU]));
    assert_eq!((code, &fitness["verdict"]), (0, &Value::from("fit")), "{fitness:#}");
    for condition in fitness["conditions"].as_array().unwrap() {
        assert_eq!(condition["state"], "met", "{condition:#}");
        assert!(
            condition["reason"].is_null() && condition["record"].is_null(),
            "{condition:#}"
        );
    }
    assert_eq!(fitness["subject"], "topic `/points` and topic `/imu`");
}

#[test]
fn a_car_on_a_road_cannot_show_the_height_of_its_sensors() {
    let fitness = is_unfit(
        "lidar-imu",
        &recording(PLANAR, 40, &[MOUNTS, LIDAR, IMU]),
        "two axes",
        "this motion cannot show a translation along z of `base_link`",
    );
    assert_eq!(condition(&fitness, "rotations")["state"], "met", "{fitness:#}");
}

#[test]
fn each_fault_of_a_recording_has_its_condition() {
    let late = "  - {topic: /points, from_drive: lidar, rate_hz: 10, from_s: 22, frame_id: lidar, lidar: {beams: 8, columns: 90, driver: velodyne}}\n";
    let early = "  - {topic: /imu, from_drive: imu, rate_hz: 100, until_s: 20, frame_id: imu}\n";
    let slow = "  - {topic: /imu, from_drive: imu, rate_hz: 10, frame_id: imu}\n";
    let still = "  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}\n";
    let degrees = "  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu, errors: [deg_s]}\n";
    let timeless = "  - {topic: /points, from_drive: lidar, rate_hz: 10, frame_id: lidar, xyz: [1, 0, 1.8], lidar: {beams: 8, columns: 90, driver: \
                    velodyne, times: missing}}\n";
    for (seconds, topics, name, words) in [
        (10, [MOUNTS, LIDAR, IMU], "time together", "recorded together for 9.9 s"),
        (42, [MOUNTS, late, early], "time together", "do not overlap"),
        (30, [MOUNTS, LIDAR, slow], "rate", "topic `/imu` has 10.0 Hz"),
        (30, [MOUNTS, LIDAR, still], "streams", "no angular velocities"),
        (30, [MOUNTS, LIDAR, degrees], "units", "the gyro is in deg/s"),
        (30, [MOUNTS, timeless, IMU], "times of points", "`/points`"),
        (30, [MOUNTS, IMU, ""], "streams", "no clouds of a lidar"),
        (30, [MOUNTS, LIDAR, ""], "streams", "no inertial sensor"),
    ] {
        let fitness = told("lidar-imu", &recording(TILTED, seconds, &topics)).1;
        let conditions = fitness["conditions"].as_array().unwrap();
        let is_it = |condition: &&Value| {
            let reason = condition["reason"].as_str().unwrap_or_default();
            condition["name"] == name && condition["state"] == "not met" && reason.contains(words)
        };
        assert!(
            conditions.iter().any(|condition| is_it(&condition)),
            "{name}, {words}: {fitness:#}"
        );
        assert_eq!(fitness["verdict"], "not fit", "{fitness:#}");
    }
}

#[test]
fn hand_eye_needs_two_axes_and_one_rigid_body() {
    let (code, fitness) = told("hand-eye", &recording(TILTED, 40, &[POSES]));
    assert_eq!((code, &fitness["verdict"]), (0, &Value::from("fit")), "{fitness:#}");
    is_unfit(
        "hand-eye",
        &recording(PLANAR, 40, &[POSES]),
        "two axes",
        "translation along z of the body of topic `/pose_a`",
    );
    let free = "  - {topic: /pose_c, type: geometry_msgs/msg/PoseStamped, rate_hz: 20, frame_id: map, velocity: [1, 0, 0], yaw_rate_deg_s: 40}\n";
    let alone = POSES.split_inclusive('\n').next().unwrap();
    is_unfit(
        "hand-eye",
        &recording(TILTED, 40, &[alone, free]),
        "rigid",
        "they move to each other",
    );
    is_unfit(
        "hand-eye",
        &recording(TILTED, 40, &[alone]),
        "streams",
        "those of a second body are missing",
    );
    let one_body = "  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}\n  - {topic: /tf, rate_hz: 20, \
                    transforms: [{parent: odom, child: base_link, from_drive: odometry}]}\n";
    is_unfit(
        "hand-eye",
        &recording(TILTED, 40, &[one_body]),
        "streams",
        "all of the same body",
    );
}

#[test]
fn whether_a_target_is_seen_is_never_told() {
    let (code, fitness) = told(
        "camera-lidar",
        &recording(PLANAR, 20, &[MOUNTS, LIDAR, IMAGES, CAMERA_INFO]),
    );
    assert_eq!(
        (code, &fitness["verdict"]),
        (3, &Value::from("cannot be told")),
        "{fitness:#}"
    );
    for condition in fitness["conditions"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|one| one["needed"] == true)
    {
        let expected = if condition["name"] == "target" {
            "not evaluated"
        } else {
            "met"
        };
        assert_eq!(condition["state"], expected, "{condition:#}");
    }
    let uncalibrated = CAMERA_INFO.replace("[500, 500, 320, 240]", "[0, 0, 0, 0, 0, 0, 0, 0, 0]");
    let other_size = CAMERA_INFO
        .replace("[640, 480]", "[1280, 960]")
        .replace("[500, 500, 320, 240]", "[1000, 1000, 640, 480]");
    for (camera, words) in [
        ("", "no camera_info"),
        (uncalibrated.as_str(), "not calibrated"),
        (other_size.as_str(), "640 x 480"),
    ] {
        is_unfit(
            "camera-lidar",
            &recording(PLANAR, 20, &[MOUNTS, LIDAR, IMAGES, camera]),
            "intrinsics",
            words,
        );
    }
}

#[test]
fn what_was_not_read_is_never_fit() {
    let whole = recording(TILTED, 40, &[MOUNTS, LIDAR, IMU]);
    for (what, bytes) in [
        ("empty", &[][..]),
        ("no recording", b"nothing"),
        ("cut", &whole[..whole.len() / 8]),
    ] {
        for kind in ["lidar-imu", "hand-eye", "camera-lidar"] {
            let (code, fitness) = told(kind, bytes);
            assert_eq!(code, 3, "{what}");
            assert_ne!(fitness["verdict"], "fit", "{what}: {fitness:#}");
            let is_told = fitness["verdict"] == "cannot be told";
            assert!(
                is_told || condition(&fitness, "time together")["state"] == "not met",
                "{what}: {fitness:#}"
            );
        }
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("r.urdf"),
        "<robot name='r'><link name='base_link'/></robot>",
    )
    .unwrap();
    let ran = ask(folder.path(), "lidar-imu,hand-eye", &["--format", "json"]);
    let report = ran.report();
    let verdicts: Vec<&Value> = report["fitness"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| &one["verdict"])
        .collect();
    assert_eq!(verdicts, ["cannot be told", "cannot be told"]);
    assert_eq!(ran.code, 3);
}

#[test]
fn each_recording_has_its_answer_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (name, drive) in [("fit.mcap", TILTED), ("flat.mcap", PLANAR)] {
        fs::write(path.join(name), recording(drive, 30, &[POSES])).unwrap();
    }
    let report = ask(path, "hand-eye", &["--format", "json"]).report();
    let fitness = report["fitness"].as_array().unwrap();
    let told: Vec<String> = fitness
        .iter()
        .map(|one| {
            format!(
                "{} {}",
                one["platform"].as_str().unwrap().rsplit('/').next().unwrap(),
                one["verdict"].as_str().unwrap()
            )
        })
        .collect();
    assert_eq!(told, ["fit.mcap fit", "flat.mcap not fit"]);
    let codes: Vec<i64> = report["recordings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["exit_code"].as_i64().unwrap())
        .collect();
    assert_eq!(codes, [0, 3]);
    assert_eq!(report["recordings"][1]["because"], "hand-eye calibration: not fit");
    for format in ["human", "markdown", "html", "json-lines", "junit"] {
        let ran = ask(path, "hand-eye", &["--format", format]);
        let text = ran.text();
        assert_eq!(ran.code, 3, "{format}");
        assert!(
            text.contains("this motion cannot show a translation along z of"),
            "{format}: {text}"
        );
        assert!(format == "junit" || text.contains("two axes"), "{format}: {text}");
    }
    let text = ask(path, "hand-eye", &[]).text();
    for words in [
        "fit.mcap: Fit for hand-eye calibration",
        "flat.mcap: Not fit for hand-eye calibration",
        "record or add: rotate the sensors",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let without = run(path, ["check", ".", "--format", "json"]);
    assert_eq!(
        (without.code, without.report()["fitness"].as_array().unwrap().len()),
        (0, 0)
    );
    assert_eq!(run(path, ["check", ".", "--for", "eye-hand"]).code, 2);
}
