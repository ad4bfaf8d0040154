//! Frames of claims: from keys that state them, from nesting, and from names of keys; and declared chains.

use super::*;
use crate::source::Confidence::{self, Certain, Hint, Likely};
use crate::world::{ClaimKind, FrameRole};

const POSE: &str = "{x: 1, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}";
const FLAT: &str = "[1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]";

fn check(text: &str, expected: &str, reading: Confidence, role: FrameRole) {
    let (source, facts) = yaml(text);
    assert_eq!(facts.claims.len(), 1, "{text}\n{:?}", source.problems);
    let claim = &facts.claims[0];
    assert_eq!((frames(claim).as_str(), claim.reading), (expected, reading), "{text}");
    assert!(
        facts.frames.iter().all(|f| f.role == role) && facts.frames.len() == 2,
        "{text}\n{:?}",
        facts.frames
    );
}

#[test]
fn autoware_nesting_states_parent_and_child() {
    let text = "sensor_kit_base_link:\n  camera0/camera_link:\n    x: 0.1\n    y: 0.2\n    z: 0.3\n    roll: 0.0\n    pitch: 0.1\n    yaw: -1.5\n";
    let claim = one(text);
    assert_eq!(frames(&claim), "sensor_kit_base_link<-camera0/camera_link");
    assert_eq!(claim.label, "sensor_kit_base_link/camera0/camera_link");
    assert_eq!(
        claim.kind,
        ClaimKind::File {
            dialect: "autoware".to_owned(),
            roles: false,
        }
    );
    assert_eq!(claim.reading, Certain);
    assert_eq!(
        claim.spelling,
        Spelling::Rpy {
            xyz: [0.1, 0.2, 0.3],
            rpy: [0.0, 0.1, -1.5]
        }
    );
    assert_eq!(at(text, claim.place.span().unwrap()), (2, 3));
    assert_eq!(at(text, claim.target_place.as_ref().unwrap().span().unwrap()), (1, 1));
    assert_eq!(at(text, claim.source_place.as_ref().unwrap().span().unwrap()), (2, 3));
    assert_eq!(at(text, claim.rotation_literals[2].span), (8, 10));
    check(
        text,
        "sensor_kit_base_link<-camera0/camera_link",
        Certain,
        FrameRole::Calibration,
    );
    check(
        &format!("/**:\n  ros__parameters:\n    base_link: {{lidar: {POSE}}}\n"),
        "base_link<-lidar",
        Certain,
        FrameRole::Calibration,
    );
}

#[test]
fn nesting_under_a_key_that_is_no_frame_names_no_frames() {
    let claim = one(&format!("kinematics:\n  shoulder: {POSE}\n"));
    assert_eq!((frames(&claim).as_str(), claim.reading), ("-", Hint));
}

#[test]
fn keys_that_state_frames_are_certain() {
    let role = FrameRole::Calibration;
    let q = "rotation: {x: 0, y: 0, z: 0, w: 1}, translation: {x: 0, y: 0, z: 1}";
    for (text, expected, reading) in [
        (format!("header: {{frame_id: velodyne}}\nchild_frame_id: camera\ntransform: {{{q}}}\n"), "velodyne<-camera", Certain),
        (format!("frame_id: a\nchild_frame_id: b\n{}\n", q.replace("}, ", "}\n")), "a<-b", Certain),
        (format!("list:\n- {{frame_id: a, child_frame_id: b, transform: {FLAT}}}\n"), "a<-b", Certain),
        (format!("- {{parent: a, child: b, pose: {POSE}}}\n"), "a<-b", Certain),
        (format!("x: {{parent_frame: a, child_frame: b, matrix: {FLAT}}}\n"), "a<-b", Certain),
        (
            "transforms: [{source_frame: sn, destination_frame: world, p_x: 1, p_y: 2, p_z: 3, q_w: 1, q_x: 0, q_y: 0, q_z: 0}]\n".to_owned(),
            "world<-sn",
            Certain,
        ),
        (format!("x: {{from: a, to: b, transform: {FLAT}}}\n"), "b<-a", Hint),
        ("t: {frame_id: a, child_frame_id: b, transform: [0, 0, 0, 0, 0, 0, 1]}\n".to_owned(), "a<-b", Likely),
    ] {
        check(&text, expected, reading, role);
    }
}

#[test]
fn names_of_keys_give_frames_with_less_certainty() {
    let role = FrameRole::CalibrationLabel;
    for (text, expected, reading) in [
        (format!("imu_from_lidar: {FLAT}\n"), "imu<-lidar", Certain),
        (format!("body_T_cam0: {FLAT}\n"), "body<-cam0", Likely),
        (format!("T_imu_lidar: {FLAT}\n"), "imu<-lidar", Likely),
        (format!("lidar_to_imu: {FLAT}\n"), "imu<-lidar", Hint),
        (format!("T_XY: {{rows: 4, cols: 4, data: {FLAT}}}\n"), "X<-Y", Hint),
        (format!("IMU.T_b_d1: {FLAT}\n"), "b<-d1", Hint),
        (format!("Tbc: {FLAT}\n"), "b<-c", Hint),
        (format!("cam0: {{T_cam_imu: {FLAT}}}\n"), "cam0<-imu", Likely),
        (format!("cam1: {{T_imu_cam: {FLAT}}}\n"), "imu<-cam1", Likely),
        (format!("cam1: {{T_cn_cnm1: {FLAT}}}\n"), "cam1<-cam0", Likely),
        (
            format!("lidar-to-camera-extrinsic: {{param: {{sensor_calib: {{rows: 4, cols: 4, data: {FLAT}}}}}}}\n"),
            "camera<-lidar",
            Hint,
        ),
        (
            "T_a_b: {translation: [1, 2, 3], rotation: {x: 0, y: 0, z: 0, w: 1}}\n".to_owned(),
            "a<-b",
            Hint,
        ),
        (
            "R_imu_cam: [0, -1, 0, 1, 0, 0, 0, 0, 1]\n".to_owned(),
            "imu<-cam",
            Likely,
        ),
    ] {
        check(&text, expected, reading, role);
    }
}

#[test]
fn the_first_camera_of_a_chain_has_no_camera_before_it() {
    assert_eq!(frames(&one(&format!("cam0: {{T_cn_cnm1: {FLAT}}}\n"))), "-");
}

#[test]
fn one_name_for_several_things_names_none_of_them() {
    let (_, facts) = yaml(&format!("sensors:\n- {{T_XY: {FLAT}}}\n- {{T_XY: {FLAT}}}\n"));
    assert_eq!(facts.claims.iter().map(frames).collect::<Vec<_>>(), ["-", "-"]);
    assert!(facts.frames.is_empty());
    // Numbered cameras distinguish them.
    let (_, facts) = yaml(&format!("cam0: {{T_cam_imu: {FLAT}}}\ncam1: {{T_cam_imu: {FLAT}}}\n"));
    assert_eq!(
        facts.claims.iter().map(frames).collect::<Vec<_>>(),
        ["cam0<-imu", "cam1<-imu"]
    );
    let imu = facts.frames.iter().find(|f| f.frame.as_str() == "imu").unwrap();
    assert_eq!(imu.count, 2);
}

#[test]
fn declared_chains_are_kept_with_the_places_of_their_factors() {
    let text = "é: 1\nchain: world_T_map * map_T_odom\n";
    let (source, facts) = yaml(text);
    assert_eq!((source.status, source.detail), (ReadStatus::Read, None));
    let chain = &facts.chains[0];
    assert_eq!(chain.text, "world_T_map * map_T_odom");
    assert_eq!(at(text, chain.place.span().unwrap()), (2, 8));
    let factors: Vec<_> = chain
        .factors
        .iter()
        .map(|(n, s)| (n.target.as_str(), n.source.as_str(), at(text, *s)))
        .collect();
    assert_eq!(factors, [("world", "map", (2, 8)), ("map", "odom", (2, 22))]);
    assert_eq!(chain.result, None);

    let (_, facts) = yaml("chains:\n- \"a_T_c = a_T_b * b_T_c\"\n- a_T_b * what\n");
    assert_eq!(facts.chains.len(), 2);
    let (result, span) = facts.chains[0].result.clone().unwrap();
    assert_eq!(
        (result.target.as_str(), result.source.as_str(), span.start),
        ("a", "c", 11)
    );
    assert_eq!(facts.chains[1].not_understood.as_deref(), Some("what"));

    let (_, facts) = yaml("chains:\n  a_T_c: a_T_b * b_T_c\n");
    assert_eq!(
        facts.chains[0].result.as_ref().map(|(n, _)| n.source.as_str()),
        Some("c")
    );
}

#[test]
fn mountings_stand_in_the_base_frame_that_the_file_states() {
    let stated = one("base_frame: base_link\nextrinsics:\n  lidar: {xyz: [0.9, 0.1, 1.8], rpy: [0, 0, 0.2]}\n");
    assert_eq!((frames(&stated).as_str(), stated.reading), ("base_link<-lidar", Likely));
    assert_eq!(stated.label, "extrinsics/lidar");
    let own = one("extrinsics:\n- {parent: base_link, frame_id: os_lidar, xyz: [0.9, 0.1, 1.8], rpy: [0, 0, 0.2]}\n");
    assert_eq!(frames(&own), "base_link<-os_lidar");
    // Without one it is in the base, which is no name of a frame.
    let guessed = one("extrinsics:\n  lidar:\n    xyz: [0.9, 0.1, 1.8]\n    rpy: [0, 0, 0.2]\n");
    assert_eq!((frames(&guessed).as_str(), guessed.reading), ("base<-lidar", Hint));
    assert!(matches!(guessed.kind, ClaimKind::File { roles: true, .. }));
    // The direction of a matrix is unknown.
    let matrix = one("base_frame: base_link\nextrinsics: {lidar: [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3]}\n");
    assert_eq!(frames(&matrix), "-");
}

#[test]
fn names_in_a_key_stand_for_the_frames_stated_beside_it() {
    let stated = "parent_frame: base_link\nchild_frame: lidar_top\n";
    for key in ["ego_T_lidar", "T_ego_lidar", "base_from_lidar"] {
        let claim = one(&format!("{stated}{key}: {FLAT}\n"));
        assert_eq!(
            (frames(&claim).as_str(), claim.reading),
            ("base_link<-lidar_top", Certain),
            "{key}"
        );
    }
    let (source, facts) = yaml(&format!("{stated}lidar_T_ego: {FLAT}\n"));
    assert_eq!(source.status, ReadStatus::Read);
    let said: Vec<(String, Confidence)> = facts
        .claims
        .iter()
        .map(|claim| (frames(claim), claim.reading))
        .collect();
    assert_eq!(
        said,
        [
            ("base_link<-lidar_top".to_owned(), Certain),
            ("lidar_top<-base_link".to_owned(), Likely)
        ]
    );
    // Other frames than those next to it.
    let (_, facts) = yaml(&format!("{stated}cam_T_imu: {FLAT}\n"));
    assert_eq!(frames(&facts.claims[0]), "cam<-imu");
}
