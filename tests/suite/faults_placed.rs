//! Mistakes of the catalogue, put into evidence and into files: both must be judged alike; and those that the evidence shows must be
//! named.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stderr,
    clippy::indexing_slicing,
    clippy::assigning_clones
)]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use frames_lint::engine::{self, Options, Rules};
use frames_lint::faults::{Fault, Subject, catalogue};
use frames_lint::verdict::{Finding, Verdict};
use frames_lint::world::World;
use nalgebra::{Isometry3, Matrix4, Translation3, UnitQuaternion};

use crate::support;

/// A platform as its files tell it: a description, a calibration and a recording.
#[derive(Clone)]
pub(crate) struct Platform {
    seconds: u32,
    /// `base_link_from_os_sensor`, in the description and in the recording.
    lidar: Isometry3<f64>,
    /// `camera_link_from_camera_optical_frame`, in both.
    optical: Isometry3<f64>,
    /// Roll, pitch and yaw of the joint of the camera, as written.
    camera_rpy: String,
    /// Joints of the description that follow, and names of those that are missing.
    joints: String,
    without_joint: &'static str,
    /// Static transforms that follow, and those that are not published: parent and child.
    transforms: String,
    without_transform: &'static str,
    /// The quaternion of the inertial sensor on TF, as published.
    imu_quaternion: String,
    lidar_frame: String,
    lidar_options: String,
    camera_frame: String,
    camera_k: String,
    camera_size: [u32; 2],
    image_size: [u32; 2],
    right_tx: f64,
    frames_of_pair: [&'static str; 2],
    /// `imu_from_lidar` of the calibration, row by row.
    matrix: Matrix4<f64>,
    /// Its quaternion of `base_link_from_gps`, x, y, z, w.
    quaternion: [f64; 4],
}

fn pose(xyz: [f64; 3], rpy_deg: [f64; 3]) -> Isometry3<f64> {
    let [roll, pitch, yaw] = rpy_deg.map(f64::to_radians);
    Isometry3::from_parts(
        Translation3::from(xyz),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

/// Where the lidar is in truth.
fn lidar_mount() -> Isometry3<f64> {
    pose([0.4, 0.1, 1.7], [0.0, 0.0, 30.0])
}

impl Platform {
    pub(crate) fn healthy(seconds: u32) -> Self {
        let imu_from_lidar = pose([-0.31, 0.08, 1.25], [2.0, -3.0, 40.0]);
        Self {
            seconds,
            lidar: lidar_mount(),
            optical: pose([0.0; 3], [-90.0, 0.0, -90.0]),
            camera_rpy: "0 0.1 0.5".to_owned(),
            joints: String::new(),
            without_joint: "",
            transforms: String::new(),
            without_transform: "",
            imu_quaternion: "[0, 0, 0, 1]".to_owned(),
            lidar_frame: "os_sensor".to_owned(),
            lidar_options: String::new(),
            camera_frame: "camera_optical_frame".to_owned(),
            camera_k: "[900, 900, 643, 357]".to_owned(),
            camera_size: [1280, 720],
            image_size: [1280, 720],
            right_tx: -108.0,
            frames_of_pair: ["left_optical_frame", "right_optical_frame"],
            matrix: imu_from_lidar.to_homogeneous(),
            quaternion: [0.0, 0.0, 0.0, 1.0],
        }
    }

    fn urdf(&self) -> String {
        let mut text = "<robot name=\"rover\">\n".to_owned();
        for link in [
            "base_link",
            "os_sensor",
            "imu_link",
            "camera_link",
            "camera_optical_frame",
        ] {
            let _ = writeln!(text, "  <link name=\"{link}\"/>");
        }
        let (roll, pitch, yaw) = self.lidar.rotation.euler_angles();
        let t = self.lidar.translation;
        let lidar = format!("xyz=\"{} {} {}\" rpy=\"{roll} {pitch} {yaw}\"", t.x, t.y, t.z);
        let (roll, pitch, yaw) = self.optical.rotation.euler_angles();
        let optical = format!("xyz=\"0 0 0\" rpy=\"{roll} {pitch} {yaw}\"");
        let camera = format!("xyz=\"0.6 0 1.2\" rpy=\"{}\"", self.camera_rpy);
        for (parent, child, origin) in [
            ("base_link", "os_sensor", lidar.as_str()),
            ("base_link", "imu_link", "xyz=\"0.2 0 0.4\" rpy=\"0 0 0\""),
            ("base_link", "camera_link", camera.as_str()),
            ("camera_link", "camera_optical_frame", optical.as_str()),
        ] {
            if child != self.without_joint {
                text.push_str(&joint(&format!("{child}_joint"), parent, child, origin));
            }
        }
        text + &self.joints + "</robot>\n"
    }

    fn calibration(&self) -> String {
        let rows = self.matrix.row_iter().map(|row| {
            let row: Vec<String> = row.iter().map(|value| format!("{value:.9}")).collect();
            format!("  - [{}]\n", row.join(", "))
        });
        let [x, y, z, w] = self.quaternion;
        format!(
            "T_tag_board:\n{}gps:\n  parent: base_link\n  child: gps\n  translation: {{x: 0.1, y: 0.0, z: 1.5}}\n  rotation: {{x: {x}, y: {y}, z: {z}, w: {w}}}\n",
            rows.collect::<String>()
        )
    }

    fn recipe(&self) -> String {
        let mut edges = String::new();
        let camera = pose([0.6, 0.0, 1.2], [0.0, 0.1_f64.to_degrees(), 0.5_f64.to_degrees()]);
        let optical = pose([0.0; 3], [-90.0, 0.0, -90.0]);
        let side = |y: f64| pose([0.7, y, 1.0], [0.0; 3]) * optical;
        for (parent, child, pose) in [
            ("base_link", "os_sensor", self.lidar),
            ("base_link", "camera_link", camera),
            ("camera_link", "camera_optical_frame", self.optical),
            ("base_link", "left_optical_frame", side(0.06)),
            ("base_link", "right_optical_frame", side(-0.06)),
            ("base_link", "gps", pose([0.1, 0.0, 1.5], [0.0; 3])),
            ("base_link", "base_footprint", Isometry3::identity()),
        ] {
            if child != self.without_transform {
                edges.push_str(&transform(parent, child, &pose));
            }
        }
        if self.without_transform != "imu_link" {
            let _ = writeln!(
                edges,
                "      - {{parent: base_link, child: imu_link, xyz: [0.2, 0, 0.4], quaternion: {}}}",
                self.imu_quaternion
            );
        }
        edges.push_str(&self.transforms);
        let size = |[width, height]: [u32; 2]| format!("size: [{width}, {height}]");
        let (calibrated, image) = (size(self.camera_size), size(self.image_size));
        let [left, right] = self.frames_of_pair;
        let t = lidar_mount().translation;
        format!(
            "duration_s: {}
drive: {{vehicle: car, motion: turning, seed: 3}}
topics:
  - topic: /tf_static
    transforms:
{edges}
  - topic: /tf
    rate_hz: 20
    transforms: [{{parent: odom, child: base_link, from_drive: odometry}}]
  - {{topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}}
  - {{topic: /imu, from_drive: imu, rate_hz: 50, frame_id: imu_link, xyz: [0.2, 0, 0.4]}}
  - {{topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, xyz: [0.1, 0, 1.5]}}
  - {{topic: /points, from_drive: lidar, rate_hz: 10, frame_id: '{}', xyz: [{}, {}, {}], rpy_deg: [0, 0, 30], lidar: {{driver: ouster, table: os1, beams: 16, columns: 256{}}}}}
  - {{topic: /camera/camera_info, type: sensor_msgs/msg/CameraInfo, rate_hz: 10, frame_id: {}, camera: {{{calibrated}, k: {}, d: [-0.1, 0.02, 0.0003, -0.0002, 0]}}}}
  - {{topic: /camera/image_raw, type: sensor_msgs/msg/Image, rate_hz: 10, frame_id: {}, camera: {{{image}}}}}
  - {{topic: /left/camera_info, type: sensor_msgs/msg/CameraInfo, rate_hz: 10, frame_id: {left}, camera: {{size: [1280, 720], k: [900, 900, 640, 360]}}}}
  - {{topic: /right/camera_info, type: sensor_msgs/msg/CameraInfo, rate_hz: 10, frame_id: {right}, camera: {{size: [1280, 720], k: [900, 900, 640, 360], p: [900, 900, 640, 360, {}]}}}}
",
            self.seconds,
            self.lidar_frame,
            t.x,
            t.y,
            t.z,
            self.lidar_options,
            self.camera_frame,
            self.camera_k,
            self.camera_frame,
            self.right_tx,
        )
    }

    /// The world that is read of its files.
    pub(crate) fn world(&self) -> World {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("rover.urdf"), self.urdf()).unwrap();
        fs::write(folder.path().join("calibration.yaml"), self.calibration()).unwrap();
        support::write(&self.recipe(), &folder.path().join("drive.mcap"));
        platform(folder.path())
    }
}

/// The one platform of a folder.
pub(crate) fn platform(folder: &Path) -> World {
    let run = engine::collect(&Options {
        paths: vec![folder.to_owned()],
        ..Options::default()
    });
    let mut run = run.unwrap();
    assert_eq!(run.worlds.len(), 1, "one platform");
    let mut world = run.worlds.remove(0);
    world.sources = Arc::new(run.sources);
    world
}

fn joint(name: &str, parent: &str, child: &str, origin: &str) -> String {
    format!(
        "  <joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/><origin {origin}/></joint>\n"
    )
}

fn transform(parent: &str, child: &str, pose: &Isometry3<f64>) -> String {
    let (t, q) = (pose.translation, pose.rotation.coords);
    format!(
        "      - {{parent: {parent}, child: {child}, xyz: [{:?}, {:?}, {:?}], quaternion: [{:?}, {:?}, {:?}, {:?}]}}\n",
        t.x, t.y, t.z, q.x, q.y, q.z, q.w
    )
}

/// A mistake of the catalogue, what has it, and the same mistake in the files.
struct Case {
    fault: &'static str,
    /// A part of the name of what has it.
    subject: &'static str,
    written: fn(&mut Platform),
}

const LIDAR: &str = "mounting `base_link` from `os_sensor`";
const OPTICAL: &str = "`camera_optical_frame`";
const CAMERA: &str = "topic `/camera/camera_info`";
const CLOUD: &str = "topic `/points`";

macro_rules! case {
    ($fault:literal, $subject:expr, $written:expr) => {
        Case {
            fault: $fault,
            subject: $subject,
            written: $written,
        }
    };
}

fn turned(platform: &mut Platform, rpy_deg: [f64; 3]) {
    platform.lidar *= pose([0.0; 3], rpy_deg);
}

const CASES: &[Case] = &[
    case!("mounting-inverse", LIDAR, |it| it.lidar = it.lidar.inverse()),
    case!("mounting-upside-down", LIDAR, |it| turned(it, [180.0, 0.0, 0.0])),
    case!("mounting-z-forward", LIDAR, |it| turned(it, [-90.0, 0.0, -90.0])),
    case!("mounting-yaw-90", LIDAR, |it| turned(it, [0.0, 0.0, 90.0])),
    case!("mounting-yaw-180", LIDAR, |it| turned(it, [0.0, 0.0, 180.0])),
    case!("mounting-rotation-lost", LIDAR, |it| it.lidar.rotation =
        UnitQuaternion::identity()),
    case!("mounting-translation-negated", LIDAR, |it| it.lidar.translation =
        it.lidar.translation.inverse()),
    case!("mounting-height-lost", LIDAR, |it| it.lidar.translation.z = 0.0),
    case!("mounting-millimetres", LIDAR, |it| it.lidar.translation.vector *=
        1000.0),
    case!("cloud-mirrored", CLOUD, |it| it.lidar_options =
        ", mirrored: true".to_owned()),
    case!("cloud-z-down", CLOUD, |it| it.lidar_options =
        ", mirrored: true, z_negated: true".to_owned()),
    case!("cloud-ouster-half-turn", CLOUD, |it| it.lidar_options =
        ", turned_deg: 180".to_owned()),
    case!("cloud-yaw-90", CLOUD, |it| it.lidar_options =
        ", turned_deg: -90".to_owned()),
    case!("cloud-times-missing", CLOUD, |it| it.lidar_options =
        ", times: missing".to_owned()),
    case!("cloud-times-constant", CLOUD, |it| it.lidar_options =
        ", times: constant".to_owned()),
    case!("cloud-times-unit", CLOUD, |it| it.lidar_options =
        ", time_scale: 0.001".to_owned()),
    case!("cloud-times-reversed", CLOUD, |it| it.lidar_options =
        ", times: reversed".to_owned()),
    case!("optical-not-rotated", OPTICAL, |it| it.optical = Isometry3::identity()),
    case!("optical-reversed", OPTICAL, |it| it.optical = it.optical.inverse()),
    case!("optical-upside-down", OPTICAL, |it| it.optical *=
        pose([0.0; 3], [0.0, 0.0, 180.0])),
    case!("camera-link-named", CAMERA, |it| it.camera_frame =
        "camera_link".to_owned()),
    case!("camera-k-not-rescaled", CAMERA, |it| {
        it.camera_size = [640, 360];
        it.image_size = [640, 360];
    }),
    case!("camera-images-shrunk", CAMERA, |it| it.image_size = [640, 360]),
    case!("camera-centre-swapped", CAMERA, |it| it.camera_k =
        "[900, 900, 357, 643]".to_owned()),
    case!("stereo-swapped", "topic `/right/camera_info`", |it| it
        .frames_of_pair
        .reverse()),
    case!("stereo-tx-sign", "topic `/right/camera_info`", |it| it.right_tx = 108.0),
    case!("frame-typo", CLOUD, |it| it.lidar_frame = "os_snsor".to_owned()),
    case!("frame-case", CLOUD, |it| it.lidar_frame = "Os_Sensor".to_owned()),
    case!("frame-slash", CLOUD, |it| it.lidar_frame = "/os_sensor".to_owned()),
    case!("frame-blank", CLOUD, |it| it.lidar_frame = "os_sensor ".to_owned()),
    case!("frame-empty", CLOUD, |it| it.lidar_frame = String::new()),
    case!("frame-orphan", "`base_link` from `os_sensor` on /tf_static", |it| it
        .without_transform =
        "os_sensor"),
    case!(
        "frame-second-parent",
        "`base_link` from `os_sensor` on /tf_static",
        |it| it.transforms = transform("odom", "os_sensor", &it.lidar)
    ),
    case!("frame-loop", "`base_link` from `os_sensor` on /tf_static", |it| it
        .transforms =
        transform("os_sensor", "odom", &it.lidar)),
    case!(
        "frame-parent-child",
        "`base_link` from `os_sensor` on /tf_static",
        |it| {
            it.without_transform = "os_sensor";
            it.transforms = transform("os_sensor", "base_link", &it.lidar);
        }
    ),
    case!("frame-self", "`base_link` from `os_sensor` on /tf_static", |it| {
        it.without_transform = "os_sensor";
        it.transforms = transform("os_sensor", "os_sensor", &it.lidar);
    }),
    case!("camera-focal-millimetres", CAMERA, |it| it.camera_k =
        "[3.6, 3.6, 643, 357]".to_owned()),
    case!("camera-distortion-model", CAMERA, |it| it.camera_k =
        "[900, 900, 643, 357], model: rational_polynomial".to_owned()),
    case!("stereo-baseline-millimetres", "topic `/right/camera_info`", |it| it
        .right_tx =
        -108_000.0),
    case!("mounting-translation-lost", LIDAR, |it| it.lidar.translation =
        Translation3::identity()),
    case!("joint-missing", "joint `camera_link_joint`", |it| it.without_joint =
        "camera_link"),
    case!("joint-second-parent", "joint `camera_optical_frame_joint`", |it| it
        .joints =
        joint(
            "camera_optical_frame_joint_too",
            "base_link",
            "camera_optical_frame",
            "xyz=\"0 0 0\" rpy=\"-1.5707963 0 -1.5707963\""
        )),
    case!("joint-loop", "joint `camera_optical_frame_joint`", |it| it.joints =
        joint(
            "camera_optical_frame_joint_too",
            "camera_optical_frame",
            "base_link",
            "xyz=\"0 0 0\" rpy=\"-1.5707963 0 -1.5707963\""
        )),
    case!("matrix-transposed", "T_tag_board", |it| it.matrix =
        it.matrix.transpose()),
    case!("matrix-mirrored", "T_tag_board", |it| {
        for value in it.matrix.fixed_view_mut::<1, 3>(1, 0).iter_mut() {
            *value = -*value;
        }
    }),
    case!("matrix-bottom-row", "T_tag_board", |it| it.matrix.row_mut(3).fill(1.0)),
    case!("stated-degrees", "joint `camera_link_joint`", |it| it.camera_rpy =
        "0 5.729578 28.647890".to_owned()),
    case!("quaternion-not-normalised", "`gps`", |it| it.quaternion =
        [0.0, 0.0, 0.0, 1.01]),
    case!("quaternion-zero", "`gps`", |it| it.quaternion = [0.0; 4]),
    case!(
        "quaternion-not-normalised",
        "`base_link` from `imu_link` on /tf_static",
        |it| it.imu_quaternion = "[0, 0, 0, 1.01]".to_owned()
    ),
    case!("quaternion-zero", "`base_link` from `imu_link` on /tf_static", |it| {
        it.imu_quaternion = "[0, 0, 0, 0]".to_owned();
    }),
];

fn fault(name: &str) -> &'static Fault {
    let mut known = catalogue().filter(|fault| fault.name == name);
    known.next().unwrap_or_else(|| panic!("no mistake is called `{name}`"))
}

fn subject_of(fault: &Fault, world: &World, part: &str) -> Subject {
    let subjects = fault.change.subjects(world);
    let names: Vec<&str> = subjects.iter().map(|subject| subject.name.as_str()).collect();
    let found = subjects.iter().find(|subject| subject.name.contains(part));
    found
        .cloned()
        .unwrap_or_else(|| panic!("{}: {part} is not among {names:?}", fault.name))
}

/// How often each rule says the same of the same; the folder of the files is another each time.
fn said(verdict: &Verdict, world: &World) -> BTreeMap<String, usize> {
    let mut counted = BTreeMap::new();
    let folder = world
        .path(world.members[0])
        .rsplit_once('/')
        .map_or("", |(folder, _)| folder)
        .to_owned();
    for finding in &verdict.findings {
        let relation = finding.relation.as_deref().unwrap_or("-");
        let said = format!("{} {relation}: {}", finding.rule, finding.subject);
        *counted.entry(said.replace(&folder, "")).or_default() += 1;
    }
    counted
}

fn with(world: &World, case: &Case) -> (World, Subject) {
    let fault = fault(case.fault);
    let subject = subject_of(fault, world, case.subject);
    let mut world = world.clone();
    assert!(
        fault.change.apply(&mut world, &subject),
        "{} changes nothing",
        case.fault
    );
    world.forget();
    (world, subject)
}

#[test]
fn a_mistake_in_the_evidence_is_judged_as_the_same_mistake_in_the_files() {
    let rules = Rules::select(&[]).unwrap();
    // What clouds show takes some seconds.
    let healthy = [1, 6].map(|seconds| {
        let platform = Platform::healthy(seconds);
        let world = platform.world();
        let before = said(&rules.judge(&world), &world);
        (platform, world, before)
    });
    let mut apart = Vec::new();
    for case in CASES {
        let (platform, healthy, before) = &healthy[usize::from([LIDAR, CLOUD].contains(&case.subject))];
        let mut written = platform.clone();
        (case.written)(&mut written);
        let written = written.world();
        let (placed, _) = with(healthy, case);
        let (written, placed) = (
            said(&rules.judge(&written), &written),
            said(&rules.judge(&placed), &placed),
        );
        let only = |a: &BTreeMap<String, usize>, b: &BTreeMap<String, usize>| -> Vec<String> {
            a.iter()
                .filter(|(said, count)| b.get(*said) != Some(count))
                .map(|(said, _)| said.clone())
                .collect()
        };
        let new = only(&placed, before);
        let (of_file, of_evidence) = (only(&written, &placed), only(&placed, &written));
        eprintln!("{} of {}: {new:?}", case.fault, case.subject);
        if !of_file.is_empty() || !of_evidence.is_empty() {
            apart.push(format!(
                "{} of {}: in files {of_file:#?}, in evidence {of_evidence:#?}",
                case.fault, case.subject
            ));
        }
    }
    eprintln!("{} of {} agree", CASES.len() - apart.len(), CASES.len());
    assert!(apart.is_empty(), "{}", apart.join("\n"));
}

#[test]
fn what_a_platform_shows_is_named() {
    let rules = Rules::select(&[]).unwrap();
    let healthy = Platform::healthy(30).world();
    let before = rules.judge(&healthy);
    let mut missed = Vec::new();
    for case in CASES {
        let fault = fault(case.fault);
        let (world, subject) = with(&healthy, case);
        let same = fault.change.same_as(&healthy, &subject);
        let codes: Vec<&str> = fault.seen_by.codes().collect();
        let verdict = Rules::select(&codes).unwrap().judge(&world);
        let is_new = |finding: &&Finding| {
            let key = |finding: &Finding| (finding.rule.clone(), finding.subject.clone(), finding.relation.clone());
            !before.findings.iter().any(|known| key(known) == key(finding))
        };
        let new: Vec<&Finding> = verdict.findings.iter().filter(is_new).collect();
        let words: Vec<String> = new
            .iter()
            .map(|finding| {
                format!(
                    "{} {:?} {:?} {}",
                    finding.rule, finding.confidence, finding.relation, finding.message
                )
            })
            .collect();
        if !new.iter().any(|finding| fault.is_named_by(finding, &same)) {
            missed.push(format!("{} of {}: {words:#?}", case.fault, case.subject));
        }
    }
    assert!(
        missed.is_empty(),
        "{} are not named:\n{}",
        missed.len(),
        missed.join("\n")
    );
}
