//! `convert`: every dialect that is written is read again as what was written.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use std::fs;

use frames_lint::convert::{ConvertRequest, feather_from_csv};
use frames_lint::tables::{FileTemplate, Tables, writings};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use crate::support::dialects::{converted, frames, plain, read, to, written};

/// Turned about all axes, so that no two conventions agree.
fn poses() -> [Isometry3<f64>; 3] {
    [
        (0.3, -0.7, 1.9, [0.11, -2.03, 0.57]),
        (-2.9, 0.4, -1.1, [-12.25, 0.004, 3.5]),
        // Pitch at its pole, where roll and yaw are one.
        (0.2, std::f64::consts::FRAC_PI_2, 0.0, [1.0, 2.0, -3.0]),
    ]
    .map(|(roll, pitch, yaw, [x, y, z])| {
        Isometry3::from_parts(
            Translation3::new(x, y, z),
            UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        )
    })
}

/// What the first line of numbers of `--to quaternion` is.
/// The numbers of the first line that is no comment.
fn numbers_of(text: &str) -> Vec<f64> {
    let line = text.lines().find(|line| !line.starts_with('#')).unwrap();
    line.split(' ').map(|word| word.parse().unwrap()).collect()
}

fn pose_of(text: &str) -> Isometry3<f64> {
    let v = numbers_of(text);
    Isometry3::from_parts(
        Translation3::new(v[0], v[1], v[2]),
        UnitQuaternion::from_quaternion(Quaternion::new(v[6], v[3], v[4], v[5])),
    )
}

fn is_near(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    (a.translation.vector - b.translation.vector).norm() < 1e-9 && a.rotation.angle_to(&b.rotation) < 1e-9
}

fn assert_near(a: &Isometry3<f64>, b: &Isometry3<f64>, what: &str) {
    assert!(is_near(a, b), "{what}: {a} {b}");
}

#[test]
fn every_dialect_is_read_again_as_it_was_written() {
    let mut wrong = Vec::new();
    for writing in writings() {
        for transform in &writing.transforms {
            let (target, source) = frames(writing, transform);
            for (index, pose) in poses().into_iter().enumerate() {
                for is_turned in [false, true] {
                    let what = format!("{} {} pose {index} turned {is_turned}", writing.dialect, transform.key);
                    let folder = tempfile::tempdir().unwrap();
                    // Stated as the dialect has it, or the other way round.
                    let link = if is_turned {
                        (source.as_str(), target.as_str(), pose.inverse())
                    } else {
                        (target.as_str(), source.as_str(), pose)
                    };
                    let run = read(&plain(folder.path(), &[link]));
                    let wish = ConvertRequest {
                        to: writing.dialect.clone(),
                        frames: Some((target.clone(), source.clone())),
                        key: Some(transform.key.clone()),
                        ..ConvertRequest::default()
                    };
                    let converted = to(&run, &wish).unwrap_or_else(|why| panic!("{what}: {why}"));
                    assert!(
                        converted.notes.contains(&format!("{target}_from_{source} = ")),
                        "{what}: {}",
                        converted.notes
                    );
                    let again = tempfile::tempdir().unwrap();
                    let path = written(again.path(), writing, transform, &converted.text);
                    let run = read(&path);
                    let wish = ConvertRequest {
                        to: "quaternion".to_owned(),
                        frames: Some((target.clone(), source.clone())),
                        ..ConvertRequest::default()
                    };
                    match to(&run, &wish) {
                        Ok(back) if is_near(&pose_of(&back.text), &pose) => {}
                        other => wrong.push(format!("{what}: {other:?}\n{}", converted.text)),
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_dialect_is_recognised_by_what_is_written() {
    // Without intrinsics a camchain is a chain of OpenVINS, which means the same; so are an IMU's and a camera's file of others.
    // Autoware's is told by its nesting, and has no words of its own.
    let known = ["kalibr", "autoware"];
    let mut wrong: Vec<String> = Vec::new();
    for writing in writings()
        .iter()
        .filter(|writing| !known.contains(&writing.dialect.as_str()))
    {
        let transform = &writing.transforms[0];
        let text = converted(writing, transform, poses()[0]).text;
        let again = tempfile::tempdir().unwrap();
        let run = read(&written(again.path(), writing, transform, &text));
        let says = run.sources[0].detail.clone().unwrap_or_default();
        let tables = Tables::default();
        let mut rows = tables.dialects().iter().filter(|row| row.name == writing.dialect);
        if !rows.any(|row| says.starts_with(&row.says)) {
            wrong.push(format!("{}: {says}", writing.dialect));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn any_dialect_becomes_any_other_and_comes_back() {
    // Those that hold an IMU and a camera, by whatever names.
    let holds = |writing: &&FileTemplate| {
        [
            "kalibr",
            "openvins",
            "okvis",
            "vins-fusion",
            "vins-mono",
            "orb-slam3",
            "r-vio",
            "airslam",
            "basalt",
            "r3live",
            "rovio",
            "sr-livo",
        ]
        .contains(&writing.dialect.as_str())
    };
    let all: Vec<&FileTemplate> = writings().iter().filter(holds).collect();
    assert_eq!(all.len(), 12);
    let pose = poses()[0];
    for one in &all {
        let folder = tempfile::tempdir().unwrap();
        let run = read(&plain(folder.path(), &[("imu", "cam0", pose)]));
        let first = to(
            &run,
            &ConvertRequest {
                to: one.dialect.clone(),
                ..ConvertRequest::default()
            },
        )
        .unwrap();
        let path = written(folder.path(), one, &one.transforms[0], &first.text);
        let run = read(&path);
        for other in &all {
            let what = format!("{} to {}", one.dialect, other.dialect);
            let second = to(
                &run,
                &ConvertRequest {
                    to: other.dialect.clone(),
                    ..ConvertRequest::default()
                },
            )
            .unwrap_or_else(|why| panic!("{what}: {why}"));
            let again = tempfile::tempdir().unwrap();
            let run = read(&written(again.path(), other, &other.transforms[0], &second.text));
            // Back to names of its own: R-VIO's direction.
            let third = to(
                &run,
                &ConvertRequest {
                    to: "r-vio".to_owned(),
                    ..ConvertRequest::default()
                },
            )
            .unwrap_or_else(|why| panic!("{what}: {why}"));
            let last = again.path().join("last.yaml");
            fs::write(&last, third.text).unwrap();
            let back = to(
                &read(&last),
                &ConvertRequest {
                    to: "quaternion".to_owned(),
                    frames: Some(("imu".to_owned(), "cam0".to_owned())),
                    ..ConvertRequest::default()
                },
            )
            .unwrap();
            assert_near(&pose_of(&back.text), &pose, &what);
        }
    }
}

#[test]
fn chains_lead_over_several_files_and_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b, _] = poses();
    let path = plain(folder.path(), &[("base", "imu", a), ("lidar", "imu", b)]);
    let run = read(&path);
    let wish = |form: &str| ConvertRequest {
        to: form.to_owned(),
        frames: Some(("base".to_owned(), "lidar".to_owned())),
        ..ConvertRequest::default()
    };
    let expected = a * b.inverse();
    let quaternion = to(&run, &wish("quaternion")).unwrap();
    assert_near(&pose_of(&quaternion.text), &expected, "quaternion");
    assert!(
        quaternion
            .notes
            .starts_with("base_from_lidar = base_from_imu * inverse(lidar_from_imu)\n"),
        "{}",
        quaternion.notes
    );
    assert!(
        quaternion.notes.contains("plain.yaml:3") && quaternion.notes.contains("plain.yaml:7"),
        "{}",
        quaternion.notes
    );
    // The other forms say the same.
    let urdf = folder.path().join("joint.urdf");
    let joint = to(&run, &wish("urdf")).unwrap().text;
    fs::write(
        &urdf,
        format!("<robot name=\"r\"><link name=\"base\"/><link name=\"lidar\"/>{joint}</robot>"),
    )
    .unwrap();
    let launch = folder.path().join("tf.sh");
    fs::write(&launch, to(&run, &wish("tf")).unwrap().text).unwrap();
    for path in [urdf, launch] {
        let back = to(&read(&path), &wish("quaternion")).unwrap();
        assert_near(&pose_of(&back.text), &expected, &path.display().to_string());
    }
    let matrix = to(&run, &wish("matrix")).unwrap().text;
    let first = numbers_of(&matrix);
    let row = expected.to_homogeneous().row(0).iter().copied().collect::<Vec<f64>>();
    assert!(first.iter().zip(row).all(|(a, b)| (a - b).abs() < 1e-12), "{matrix}");
    let rpy = to(&run, &wish("rpy")).unwrap().text;
    let numbers = numbers_of(&rpy);
    let rotation = UnitQuaternion::from_euler_angles(numbers[3], numbers[4], numbers[5]);
    assert!(rotation.angle_to(&expected.rotation) < 1e-9, "{rpy}");
}

#[test]
fn a_table_of_argoverse_becomes_a_feather_file() {
    let folder = tempfile::tempdir().unwrap();
    let pose = poses()[1];
    let run = read(&plain(folder.path(), &[("egovehicle", "up_lidar", pose)]));
    let converted = to(
        &run,
        &ConvertRequest {
            to: "argoverse2".to_owned(),
            ..ConvertRequest::default()
        },
    )
    .unwrap();
    assert!(converted.is_table);
    let path = folder.path().join("egovehicle_SE3_sensor.feather");
    fs::write(&path, feather_from_csv(&converted.text).unwrap()).unwrap();
    let run = read(&path);
    assert_eq!(run.sources[0].detail.as_deref(), Some("extrinsics of Argoverse 2"));
    let back = to(
        &run,
        &ConvertRequest {
            to: "quaternion".to_owned(),
            ..ConvertRequest::default()
        },
    )
    .unwrap();
    assert_near(&pose_of(&back.text), &pose, "feather");
}

#[test]
fn transforms_under_one_key_are_put_together() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b, _] = poses();
    let links = [("base_link", "lidar", a), ("base_link", "camera", b)];
    let run = read(&plain(folder.path(), &links));
    let wish = |to: &str| ConvertRequest {
        to: to.to_owned(),
        ..ConvertRequest::default()
    };
    let text = to(&run, &wish("autoware")).unwrap().text;
    assert_eq!(text.matches("base_link:").count(), 1, "{text}");
    let path = folder.path().join("sensor_kit_calibration.yaml");
    fs::write(&path, text).unwrap();
    let run = read(&path);
    for (target, source, pose) in links {
        let asked = ConvertRequest {
            frames: Some((target.to_owned(), source.to_owned())),
            ..wish("quaternion")
        };
        assert_near(&pose_of(&to(&run, &asked).unwrap().text), &pose, source);
    }
}

#[test]
fn what_cannot_be_converted_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let run = read(&plain(folder.path(), &[("base", "imu", poses()[0])]));
    let why = |wish: ConvertRequest| to(&run, &wish).unwrap_err();
    let frames = |target: &str, source: &str| Some((target.to_owned(), source.to_owned()));
    let unknown = why(ConvertRequest {
        to: "urdf".to_owned(),
        frames: frames("base", "radar"),
        ..ConvertRequest::default()
    });
    assert!(
        unknown.contains("no chain of transforms leads") && unknown.contains("base, imu"),
        "{unknown}"
    );
    let nothing = why(ConvertRequest {
        to: "orb-slam3".to_owned(),
        ..ConvertRequest::default()
    });
    assert!(nothing.contains("--frames"), "{nothing}");
    let many = why(ConvertRequest {
        to: "orb-slam3".to_owned(),
        frames: frames("base", "imu"),
        ..ConvertRequest::default()
    });
    assert!(many.contains("--key") && many.contains("IMU.T_b_c1"), "{many}");
    // A statement without frames is converted once the user says what it is.
    let path = folder.path().join("open.yaml");
    fs::write(&path, "extrinsic: [1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]\n").unwrap();
    let run = read(&path);
    let wish = ConvertRequest {
        to: "quaternion".to_owned(),
        ..ConvertRequest::default()
    };
    assert!(to(&run, &wish).unwrap_err().contains("--is"));
    let told = to(
        &run,
        &ConvertRequest {
            is: frames("imu", "lidar"),
            ..wish
        },
    )
    .unwrap();
    assert!(told.text.contains("imu_from_lidar"), "{}", told.text);
}
