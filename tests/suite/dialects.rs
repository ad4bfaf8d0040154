//! Dialects as a whole: errors in a file of each beside a healthy description, and the files of the corpus.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use std::fs;
use std::path::PathBuf;

use frames_lint::engine;
use frames_lint::math::relation::{Relation, Tolerance, classify};
use frames_lint::math::rotation::to_rpy;
use frames_lint::run::Run;
use frames_lint::tables::{Writing, WrittenTransform, writings};
use frames_lint::verdict::Finding;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::support::dialects::{converted, frames, written};

/// Turned about all axes, and small enough for a robot.
fn truth() -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(0.42, -0.27, 0.61),
        UnitQuaternion::from_euler_angles(0.5, -0.35, 1.2),
    )
}

/// The rules that hold two sources against each other, or name what one holds.
const RULES: [&str; 8] = [
    "CROSS01", "CROSS02", "QUAT03", "ROT01", "ROT02", "ROT03", "ROT06", "ROT08",
];

/// A URDF with the truth beside a file of the dialect with something else.
fn judged(writing: &Writing, transform: &WrittenTransform, held: Isometry3<f64>) -> (Run, String) {
    let (target, source) = frames(writing, transform);
    let folder = tempfile::tempdir().unwrap();
    let pose = truth();
    let (roll, pitch, yaw) = to_rpy(&pose.rotation);
    let t = pose.translation.vector;
    let urdf = format!(
        "<robot name=\"r\">\n<link name=\"{target}\"/>\n<link name=\"{source}\"/>\n<joint name=\"j\" type=\"fixed\">\n<parent link=\"{target}\"/>\n<child link=\"{source}\"/>\n<origin xyz=\"{:?} {:?} {:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>\n</joint>\n</robot>\n",
        t.x, t.y, t.z
    );
    fs::write(folder.path().join("robot.urdf"), urdf).unwrap();
    let text = converted(writing, transform, held).text;
    written(folder.path(), writing, transform, &text);
    let run = engine::check(&engine::Options {
        paths: vec![folder.path().to_path_buf()],
        select: RULES.map(str::to_owned).to_vec(),
        ..engine::Options::default()
    })
    .unwrap();
    (run, text)
}

fn told(run: &Run) -> Vec<String> {
    let of = |finding: &Finding| format!("{} {:?}: {}", finding.rule, finding.relation, finding.message);
    run.verdict.findings.iter().map(of).collect()
}

#[test]
fn a_healthy_file_of_any_dialect_agrees_with_the_description() {
    let mut wrong = Vec::new();
    for writing in writings() {
        for transform in &writing.transforms {
            let (run, text) = judged(writing, transform, truth());
            let compared = run
                .verdict
                .rows
                .iter()
                .any(|row| row.rule == "CROSS01" && row.subject.contains("robot.urdf"));
            if !run.verdict.findings.is_empty() || !compared {
                wrong.push(format!(
                    "{} {}: compared {compared}, {:?}\n{text}",
                    writing.dialect,
                    transform.key,
                    told(&run)
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_error_in_a_file_of_any_dialect_is_named_or_its_class_is() {
    let errors = [
        Relation::Inverse,
        // Of a matrix; of a quaternion it is the conjugate.
        Relation::Transposed,
        Relation::Wxyz,
        Relation::Xyzw,
        Relation::Degrees,
        Relation::Millimetres,
        Relation::MirroredY,
        Relation::MirroredZ,
        Relation::Optical,
        Relation::Z180,
        Relation::InverseTranslation,
        Relation::RotationLost,
    ];
    let mut wrong = Vec::new();
    let mut count = 0;
    for writing in writings() {
        for transform in &writing.transforms {
            for error in errors {
                count += 1;
                let held = error.apply(&truth()).unwrap();
                let class = classify(&truth(), &held, &Tolerance::default()).class;
                assert!(class.contains(&error), "{error:?} is in its own class");
                let (run, text) = judged(writing, transform, held);
                let names = |finding: &Finding| {
                    let word = finding.relation.as_deref().unwrap_or_default();
                    let in_class = class.iter().any(|relation| relation.word() == word);
                    in_class && (word == error.word() || finding.message.contains(error.word()))
                };
                if !run.verdict.findings.iter().any(names) {
                    wrong.push(format!(
                        "{} {} {}: {:?}\n{text}",
                        writing.dialect,
                        transform.key,
                        error.word(),
                        told(&run)
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {count}\n{}", wrong.len(), wrong.join("\n"));
}

/// What files of a folder of the corpus are known as; the first words of what is said of them.
const KNOWN: &[(&str, &[&str])] = &[
    ("argoverse2", &["extrinsics of Argoverse 2"]),
    ("boreas", &["an extrinsic of Boreas"]),
    ("camera_info", &["a camera_info file"]),
    ("carla_objects", &["objects of the CARLA"]),
    ("cartographer_lua", &["a configuration of Cartographer"]),
    (
        "euroc_TBS",
        &[
            "a sensor file of EuRoC",
            "cameras or sensors of maplab",
            "a configuration of OKVIS",
        ],
    ),
    (
        "fastlio",
        &["a configuration of FAST-LIO", "a configuration of FAST-LIVO"],
    ),
    (
        "kalibr_chain",
        &[
            "a camchain of Kalibr",
            "an IMU file of Kalibr",
            "a camera chain of OpenVINS",
            "a sensor file of EuRoC",
            "a calibration of Basalt",
        ],
    ),
    ("kitti", &["a calibration of KITTI"]),
    ("kitti_raw", &["a calibration of KITTI raw"]),
    (
        "liosam",
        &[
            "a configuration of LIO-SAM",
            "a configuration of DLIO",
            "a calibration of M2DGR-plus",
        ],
    ),
    ("mrpt_ini", &["a configuration of MRPT"]),
    (
        "opencv_vins",
        &[
            "a configuration of VINS-Mono",
            "a configuration of VINS-Fusion",
            "a camera file of LVI-SAM",
        ],
    ),
    ("orbslam", &["settings of ORB-SLAM", "cameras of AirSLAM"]),
    ("ouster_meta", &["metadata of an Ouster"]),
    (
        "robot_localization",
        &[
            "a configuration of robot_localization",
            "a configuration of navsat_transform",
        ],
    ),
    ("tum_traj", &["poses over time"]),
];
/// Files among them that are of no dialect: configurations without a transform, templates, launch files, a camera's intrinsics, texts.
const OTHERS: [&str; 11] = [
    "P_camera.txt",
    "/templates/",
    ".launch",
    "launch.xml",
    "aslam_footer.txt",
    "DM-VIO/",
    "oxford_spires_dataset/configs/sensor.yaml",
    "imu_heading.csv",
    "imu_filter_madgwick.yaml",
    "vectornav/params",
    "docking_params.yaml",
];

#[test]
fn files_of_known_dialects_are_recognised() {
    let corpus = match std::env::var_os("FRAMES_LINT_CORPUS") {
        Some(folder) => PathBuf::from(folder),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus"),
    };
    if !corpus.is_dir() {
        return;
    }
    let mut wrong = Vec::new();
    let mut count = 0;
    for (folder, known) in KNOWN {
        let path = corpus.join(folder);
        if !path.is_dir() {
            continue;
        }
        let run = engine::read(&engine::Options {
            paths: vec![path],
            ..engine::Options::default()
        })
        .unwrap();
        for source in &run.sources {
            let says = source.detail.clone().unwrap_or_default();
            if OTHERS.iter().any(|other| source.path.contains(other)) {
                continue;
            }
            count += 1;
            if !known.iter().any(|known| says.starts_with(known)) {
                wrong.push(format!("{}: {says}", source.path));
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {count}\n{}", wrong.len(), wrong.join("\n"));
}
