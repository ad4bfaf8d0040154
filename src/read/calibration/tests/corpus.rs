//! Real published files, where a folder of them is available.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::{Matrix3, UnitQuaternion};

use super::*;
use crate::read::at_hand::corpus;

/// Rotations of left cameras in their body frames: EuRoC (the dataset's `cam0/sensor.yaml`) and TUM-VI (the dataset's
/// camchain, transposed). Many projects publish the same nine numbers.
const GOLDEN: [(&str, [f64; 9]); 2] = [
    (
        "EuRoC",
        [
            0.014_865_542_981_8,
            -0.999_880_929_698,
            0.004_140_296_794_22, //
            0.999_557_249_008,
            0.014_967_213_324_7,
            0.025_715_529_948, //
            -0.025_774_436_697_4,
            0.003_756_188_357_97,
            0.999_660_727_178,
        ],
    ),
    (
        "TUM-VI",
        [
            -0.999_525_037_869_674_3,
            0.007_501_918_507_405_2,
            -0.029_890_130_316_433_09, //
            0.029_615_343_885_863_2,
            -0.034_397_360_613_931_44,
            -0.998_969_345_370_175, //
            -0.008_522_328_211_654_7,
            -0.999_380_079_249_882_9,
            0.034_158_851_273_856_16,
        ],
    ),
];

/// Every YAML and JSON file of the corpus, read.
pub(super) fn read_all(folder: &Path) -> Vec<(String, Source, Facts)> {
    let mut files = Vec::new();
    let mut todo = vec![folder.to_path_buf()];
    while let Some(next) = todo.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                todo.push(path);
            } else if path
                .extension()
                .is_some_and(|e| e == "yaml" || e == "yml" || e == "json")
            {
                files.push(path);
            }
        }
    }
    files.sort();
    files
        .into_iter()
        .map(|path| {
            let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
            let (source, facts) = if path.extension().is_some_and(|e| e == "json") {
                json(&text)
            } else {
                yaml(&text)
            };
            (path.strip_prefix(folder).unwrap().display().to_string(), source, facts)
        })
        .collect()
}

/// How a claim relates to a golden rotation, if it holds the same nine numbers.
fn relation(claim: &Claim) -> Option<(&'static str, &'static str)> {
    let rotation = claim.pose?.isometry().rotation;
    GOLDEN.iter().find_map(|(dataset, numbers)| {
        let golden = UnitQuaternion::from_matrix(&Matrix3::from_row_slice(numbers));
        let near = |other: UnitQuaternion<f64>| rotation.angle_to(&other) < 1e-3;
        let word = near(golden)
            .then_some("SAME")
            .or(near(golden.inverse()).then_some("TRANSPOSE"))?;
        Some((*dataset, word))
    })
}

/// Every file that holds one of these rotations states it as body from camera; only `T_cam_imu` is camera from body.
#[test]
fn directions_agree_across_projects() {
    let Some(folder) = corpus() else { return };
    let mut said = BTreeMap::<String, usize>::new();
    for (path, _, facts) in read_all(&folder) {
        for claim in &facts.claims {
            let Some((dataset, relation)) = relation(claim) else {
                continue;
            };
            let name = claim.label.rsplit('/').next().unwrap();
            *said
                .entry(format!("{dataset} {relation} {name} {}", frames(claim)))
                .or_default() += 1;
            let expected = if name == "T_cam_imu" { "TRANSPOSE" } else { "SAME" };
            assert_eq!(relation, expected, "{path} {}", claim.label);
            if let Some((target, source)) = &claim.frames {
                let (body, camera) = if relation == "SAME" {
                    (target, source)
                } else {
                    (source, target)
                };
                assert!(["imu", "body"].contains(&body.as_str()), "{path} {}", frames(claim));
                let is_camera = camera.as_str().starts_with("cam") || camera.as_str() == "sensor";
                assert!(is_camera, "{path} {}", frames(claim));
            } else {
                panic!("{path} {name}: no direction");
            }
        }
    }
    for known in [
        "EuRoC SAME IMU.T_b_c1 body<-cam1",
        "EuRoC SAME T_BS body<-sensor",
        "EuRoC SAME T_imu_cam imu<-cam0",
        "EuRoC SAME extrinsic imu<-cam0",
        "TUM-VI SAME IMU.T_b_c1 body<-cam1",
        "TUM-VI TRANSPOSE T_cam_imu cam0<-imu",
    ] {
        assert!(said.contains_key(known), "{known} is missing in {said:#?}");
    }
}

/// Published calibrations are rotations: what is not, is a false recognition, but for three files that are wrong.
#[test]
fn matrices_of_the_corpus_are_rotations() {
    let Some(folder) = corpus() else { return };
    let known = [
        "p64-to-qt-extrinsic.json",
        "radar-to-center_camera-extrinsic.json",
        "front_center_camera-to-car_center-extrinsic.json",
    ];
    let (mut matrices, mut claims, mut unread) = (0, 0, Vec::new());
    for (path, source, facts) in read_all(&folder) {
        claims += facts.claims.len();
        if source.status != ReadStatus::Read {
            unread.push(path.clone());
        }
        for claim in &facts.claims {
            let Spelling::Matrix { cols, values, .. } = &claim.spelling else {
                continue;
            };
            matrices += 1;
            let m = super::super::numbers::upper_left(*cols, values).unwrap();
            let error = (m.transpose() * m - Matrix3::identity()).norm();
            let wrong = error > 1e-3 || m.determinant() < 0.0;
            assert!(
                !wrong || known.iter().any(|name| path.ends_with(name)),
                "{path} {} {error}",
                claim.label
            );
        }
        for claim in &facts.claims {
            if claim.rotation_literals.iter().all(|l| l.text.parse::<f64>().is_ok()) {
                literals_stand_where_they_say(&source.text, claim);
            }
        }
    }
    assert!(claims > 700 && matrices > 500, "{claims} claims, {matrices} matrices");
    // Two files are templates.
    assert!(unread.iter().all(|path| path.contains("templates")), "{unread:?}");
}
