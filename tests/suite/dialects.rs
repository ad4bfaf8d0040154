//! Dialects as a whole: errors in a file of each beside a healthy description, and the files of the corpus.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use std::fs;

use frames_lint::engine;
use frames_lint::math::relation::{Relation, Tolerance, classify};
use frames_lint::math::rotation::to_rpy;
use frames_lint::run::Run;
use frames_lint::source::{Confidence, ReadStatus};
use frames_lint::tables::{FileTemplate, TransformTemplate, writings};
use frames_lint::verdict::{Finding, Outcome};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::support::at_hand;
use crate::support::dialects::{converted, frames, written};

/// Turned about all axes, and small enough for a robot.
pub(crate) fn truth() -> Isometry3<f64> {
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
pub(crate) fn folder_of(
    writing: &FileTemplate,
    transform: &TransformTemplate,
    held: Isometry3<f64>,
) -> tempfile::TempDir {
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
    folder
}

/// What is said of [`folder_of`], and the text of the file.
fn judged(writing: &FileTemplate, transform: &TransformTemplate, held: Isometry3<f64>) -> (Run, String) {
    let folder = folder_of(writing, transform, held);
    let text = converted(writing, transform, held).text;
    let run = engine::check(&engine::Options {
        paths: vec![folder.path().to_path_buf()],
        select: RULES.map(str::to_owned).to_vec(),
        ..engine::Options::default()
    })
    .unwrap();
    (run, text)
}

fn statements(run: &Run) -> Vec<String> {
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
            let is_read = run.sources.iter().all(|source| source.status == ReadStatus::Read);
            if !run.verdict.findings.is_empty() || !compared || !is_read {
                wrong.push(format!(
                    "{} {}: read {is_read}, compared {compared}, {:?}\n{text}",
                    writing.dialect,
                    transform.key,
                    statements(&run)
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
                    in_class && (word == error.word() || finding.text().contains(error.word()))
                };
                if !run.verdict.findings.iter().any(names) {
                    wrong.push(format!(
                        "{} {} {}: {:?}\n{text}",
                        writing.dialect,
                        transform.key,
                        error.word(),
                        statements(&run)
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {count}\n{}", wrong.len(), wrong.join("\n"));
}

/// Files of these hold one pair of sensors under different names.
const PARTNERS: [&[&str]; 2] = [
    &[
        "kalibr",
        "vins-fusion",
        "vins-mono",
        "okvis",
        "orb-slam3",
        "r-vio",
        "airslam",
        "basalt",
        "rovio",
        "r3live",
    ],
    &["fast-lio", "lio-sam", "glim", "kitti"],
];

#[test]
fn errors_beside_a_healthy_file_of_another_dialect_are_named() {
    let errors = [
        None,
        Some(Relation::Inverse),
        Some(Relation::Transposed),
        Some(Relation::Wxyz),
        Some(Relation::Millimetres),
        Some(Relation::MirroredY),
    ];
    let mut wrong = Vec::new();
    for group in PARTNERS {
        let of = |name: &str| {
            let writing = writings().iter().find(|writing| writing.dialect == name).unwrap();
            let wanted = if name == "kitti" {
                "Tr_imu_to_velo"
            } else {
                writing.transforms[0].key.as_str()
            };
            let transform = writing
                .transforms
                .iter()
                .find(|transform| transform.key == wanted)
                .unwrap();
            (writing, transform)
        };
        for (index, name) in group.iter().enumerate() {
            // The next one of the group is healthy.
            let partner = group[(index + 1) % group.len()];
            for error in errors {
                let folder = tempfile::tempdir().unwrap();
                for (name, error) in [(*name, error), (partner, None)] {
                    let (writing, transform) = of(name);
                    // The truth takes points of the sensor to the IMU, whatever the dialect has.
                    let (target, _) = frames(writing, transform);
                    let is_turned = ["cam", "camera", "lidar", "velo"]
                        .iter()
                        .any(|word| target.starts_with(word));
                    let truth = if is_turned { truth().inverse() } else { truth() };
                    let held = error.map_or(truth, |error| error.apply(&truth).unwrap());
                    let text = converted(writing, transform, held).text;
                    fs::write(folder.path().join(format!("{name}.{}", writing.ending)), text).unwrap();
                }
                let run = engine::check(&engine::Options {
                    paths: vec![folder.path().to_path_buf()],
                    select: vec!["CROSS01".to_owned(), "CROSS02".to_owned()],
                    ..engine::Options::default()
                })
                .unwrap();
                let compared = run
                    .verdict
                    .rows
                    .iter()
                    .any(|row| row.rule == "CROSS01" && row.subject.contains(partner));
                // Neither file is the reference: the error may be told of the other one, as its counterpart.
                let words = match error {
                    None => vec![""],
                    Some(Relation::Wxyz) => vec!["wxyz", "xyzw"],
                    Some(Relation::Millimetres) => vec!["millimetres", "metres"],
                    Some(error) => vec![error.word()],
                };
                let names = |finding: &Finding| words.contains(&finding.relation.as_deref().unwrap_or_default());
                let is_right = match error {
                    None => run.verdict.findings.is_empty(),
                    // Seen from the file with the error, an inverse is one as well.
                    Some(_) => run.verdict.findings.iter().any(names),
                };
                if !compared || !is_right {
                    wrong.push(format!(
                        "{name} beside {partner}, {error:?}: compared {compared}, {:?}",
                        statements(&run)
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn errors_in_the_arguments_of_a_static_transform_publisher_are_named_for_sure() {
    let healthy = truth();
    let errors = [
        Relation::Inverse,
        Relation::Transposed,
        Relation::Wxyz,
        Relation::Xyzw,
        Relation::Millimetres,
        Relation::MirroredY,
    ];
    for error in [None].into_iter().chain(errors.map(Some)) {
        let held = error.map_or(healthy, |error| error.apply(&healthy).unwrap());
        let folder = tempfile::tempdir().unwrap();
        let (t, q) = (held.translation.vector, held.rotation.coords);
        let launch = format!(
            "<launch>\n<node pkg=\"tf2_ros\" type=\"static_transform_publisher\" name=\"n\" args=\"{} {} {} {} {} {} {} base_link lidar\"/>\n</launch>\n",
            t.x, t.y, t.z, q.x, q.y, q.z, q.w
        );
        fs::create_dir(folder.path().join("launch")).unwrap();
        fs::write(folder.path().join("launch/sensors.launch"), launch).unwrap();
        let (roll, pitch, yaw) = to_rpy(&healthy.rotation);
        let h = healthy.translation.vector;
        let urdf = format!(
            "<robot name=\"r\">\n<link name=\"base_link\"/>\n<link name=\"lidar\"/>\n<joint name=\"j\" type=\"fixed\">\n<parent link=\"base_link\"/>\n<child link=\"lidar\"/>\n<origin xyz=\"{:?} {:?} {:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>\n</joint>\n</robot>\n",
            h.x, h.y, h.z
        );
        fs::write(folder.path().join("robot.urdf"), urdf).unwrap();
        let run = engine::check(&engine::Options {
            paths: vec![folder.path().to_path_buf()],
            select: vec!["cross".to_owned()],
            ..engine::Options::default()
        })
        .unwrap();
        let found: Vec<(Option<&str>, Confidence)> = run
            .verdict
            .findings
            .iter()
            .map(|finding| (finding.relation.as_deref(), finding.confidence))
            .collect();
        let expected: Vec<_> = error
            .iter()
            .map(|error| (Some(error.word()), Confidence::Certain))
            .collect();
        assert_eq!(found, expected, "{error:?}: {:?}", statements(&run));
    }
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
    ("ouster_meta", &["metadata of an Ouster", "Ouster metadata"]),
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
    let Some(corpus) = at_hand::corpus() else { return };
    let mut wrong = Vec::new();
    let mut count = 0;
    for (folder, known) in KNOWN {
        let path = corpus.join(folder);
        if !path.is_dir() {
            at_hand::left_out(&format!("no {folder} among the real calibrations"));
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

/// What CROSS01 and CROSS02 say of files beside a URDF with the truth, in which the frames are `base_link` and `lidar`; and whether they were compared.
fn beside_the_truth(name: &str, text: &str) -> (Vec<String>, bool) {
    let pose = truth();
    let (roll, pitch, yaw) = to_rpy(&pose.rotation);
    let t = pose.translation.vector;
    let folder = tempfile::tempdir().unwrap();
    let urdf = format!(
        "<robot name=\"r\">\n<link name=\"base_link\"/>\n<link name=\"lidar\"/>\n<joint name=\"j\" type=\"fixed\">\n<parent link=\"base_link\"/>\n<child link=\"lidar\"/>\n<origin xyz=\"{:?} {:?} {:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>\n</joint>\n</robot>\n",
        t.x, t.y, t.z
    );
    fs::write(folder.path().join("robot.urdf"), urdf).unwrap();
    fs::write(folder.path().join(name), text).unwrap();
    let run = engine::check(&engine::Options {
        paths: vec![folder.path().to_path_buf()],
        select: ["CROSS01", "CROSS02", "CROSS07"].map(str::to_owned).to_vec(),
        ..engine::Options::default()
    })
    .unwrap();
    let relations = run
        .verdict
        .findings
        .iter()
        .filter_map(|finding| finding.relation.clone());
    let judged = run.verdict.rows.iter().any(|row| {
        row.rule != "CROSS02" && row.subject.contains("lidar") && !matches!(row.outcome, Outcome::NotEvaluated)
    });
    (relations.collect(), judged)
}

/// A pose as `xyz` and `rpy`, and as sixteen numbers.
fn spelled(pose: &Isometry3<f64>) -> (String, String) {
    let (t, (roll, pitch, yaw)) = (pose.translation.vector, to_rpy(&pose.rotation));
    let rows: Vec<String> = pose
        .to_homogeneous()
        .transpose()
        .iter()
        .map(|value| format!("{value:?}"))
        .collect();
    (
        format!(
            "xyz: [{:?}, {:?}, {:?}], rpy: [{roll:?}, {pitch:?}, {yaw:?}]",
            t.x, t.y, t.z
        ),
        format!("[{}]", rows.join(", ")),
    )
}

#[test]
fn mountings_and_matrices_with_names_beside_them_are_held_against_the_description() {
    for (pose, expected) in [(truth(), vec![]), (truth().inverse(), vec!["inverse".to_owned()])] {
        let (six, matrix) = spelled(&pose);
        for text in [
            format!("base_frame: base_link\nextrinsics: {{lidar: {{{six}}}}}\n"),
            format!("extrinsics: {{lidar: {{{six}}}}}\n"),
            format!("parent_frame: base_link\nchild_frame: lidar\nego_T_velodyne: {matrix}\n"),
        ] {
            let (relations, judged) = beside_the_truth("mounts.yaml", &text);
            assert!(judged, "{text}");
            assert_eq!(relations, expected, "{text}");
        }
    }
    // The file contradicts itself.
    let (_, matrix) = spelled(&truth());
    let text = format!("parent_frame: base_link\nchild_frame: lidar\nlidar_T_ego: {matrix}\n");
    let (relations, _) = beside_the_truth("mounts.yaml", &text);
    assert!(relations.contains(&"inverse".to_owned()), "{relations:?}");
}
