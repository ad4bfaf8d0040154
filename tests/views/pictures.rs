//! What the pictures of README show. `FRAMES_LINT_PICTURES` names a folder that the views are written to; `docs/pictures/make` draws
//! them from there.

use std::path::{Path, PathBuf};

use crate::{program, root, support};

/// Views with a name, what they are of, and the rule whose finding they open on; none where the robot is sound.
struct Picture {
    name: &'static str,
    of: PictureSource,
    rule: Option<&'static str>,
}

enum PictureSource {
    Folder(&'static str),
    Recipe(&'static str),
}

const PICTURES: [Picture; 8] = [
    Picture {
        name: "sources",
        of: PictureSource::Folder("fixtures/first-finding"),
        rule: Some("CROSS02"),
    },
    Picture {
        name: "robot",
        of: PictureSource::Folder("fixtures/robots/arm"),
        rule: None,
    },
    Picture {
        name: "ground",
        of: PictureSource::Recipe(
            "duration_s: 16
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /tf_static, transforms: [{parent: base_footprint, child: velodyne, xyz: [0, 0, 1.8]}]}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_footprint}
  - {topic: /tf, rate_hz: 20, transforms: [{parent: odom, child: base_footprint, from_drive: odometry}]}
  - {topic: /points, from_drive: lidar, rate_hz: 2, frame_id: velodyne, xyz: [0, 0, 1.8], rpy_deg: [0, 6, 0], lidar: {beams: 24, columns: 360, driver: velodyne}}
",
        ),
        rule: Some("AXES09"),
    },
    Picture {
        name: "direction",
        of: PictureSource::Recipe(
            "duration_s: 30
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: velodyne, xyz: [0, -1.5, -1.8], rpy_deg: [0, 0, 90]}]}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
  - {topic: /tf, rate_hz: 20, transforms: [{parent: odom, child: base_link, from_drive: odometry}]}
  - {topic: /points, from_drive: lidar, rate_hz: 10, frame_id: velodyne, xyz: [1.5, 0, 1.8], rpy_deg: [0, 0, -90], lidar: {beams: 8, columns: 360, driver: velodyne}}
",
        ),
        rule: Some("CROSS04"),
    },
    Picture {
        name: "tracks",
        of: PictureSource::Recipe(
            "duration_s: 120
drive: {vehicle: car, motion: turning, seed: 5}
topics:
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link, errors: [swap_xy]}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps}
",
        ),
        rule: Some("AXES07"),
    },
    Picture {
        name: "ouster",
        of: PictureSource::Recipe(
            "duration_s: 2
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: os_sensor, xyz: [0, 0, 1.8]}, {parent: os_sensor, child: os_lidar, xyz: [0, 0, 0.036], quaternion: [0, 0, 1, 0]}]}
  - {topic: /ouster/points, from_drive: lidar, rate_hz: 10, frame_id: os_sensor, xyz: [0, 0, 1.8], lidar: {beams: 16, columns: 256, driver: ouster, turned_deg: 180}}
",
        ),
        rule: Some("SENSOR01"),
    },
    Picture {
        name: "lag",
        of: PictureSource::Recipe(
            "duration_s: 90
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: base_link}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link, late_s: 0.1}
",
        ),
        rule: Some("TIME09"),
    },
    Picture {
        name: "camera",
        of: PictureSource::Recipe(
            "duration_s: 2
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: velodyne, xyz: [0, 0, 1.8]}
      - {parent: base_link, child: front_optical_frame, xyz: [1.5, 0, 1.2], rpy_deg: [0, 10, 0]}
  - {topic: /front/camera_info, type: sensor_msgs/msg/CameraInfo, rate_hz: 4, frame_id: front_optical_frame, camera: {size: [640, 480], k: [400, 400, 320, 240], d: [0, 0, 0, 0, 0]}}
  - {topic: /points, from_drive: lidar, rate_hz: 4, frame_id: velodyne, xyz: [0, 0, 1.8], lidar: {beams: 24, columns: 360, driver: velodyne}}
",
        ),
        rule: Some("CAMERA05"),
    },
];

fn laid_out(of: &PictureSource, folder: &Path) -> PathBuf {
    match of {
        PictureSource::Folder(known) => {
            support::copy_platform(&root().join(known), folder);
            folder.to_path_buf()
        }
        PictureSource::Recipe(recipe) => {
            let file = folder.join("drive.mcap");
            support::write(recipe, &file);
            file
        }
    }
}

#[test]
fn each_picture_is_of_the_finding_that_it_is_made_for() {
    let folder = tempfile::tempdir().unwrap();
    let out = std::env::var_os("FRAMES_LINT_PICTURES").map_or_else(|| folder.path().to_path_buf(), PathBuf::from);
    std::fs::create_dir_all(&out).unwrap();
    let mut faults = Vec::new();
    for picture in PICTURES {
        let own = tempfile::tempdir().unwrap();
        let input = laid_out(&picture.of, own.path());
        let run = support::checked(&input);
        let worst = run.verdict.findings.first();
        if worst.map(|finding| finding.rule.as_str()) != picture.rule {
            faults.push(format!("{} is of {worst:?}", picture.name));
        }
        let file = out.join(format!("{}.rrd", picture.name));
        let ran = program(&["view", &input.to_string_lossy(), "-o", &file.to_string_lossy()]);
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        assert!(std::fs::metadata(&file).unwrap().len() > 10_000, "{}", picture.name);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
