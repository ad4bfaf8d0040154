//! Every form of a transform that is recognised, and the near misses that must not be.

use super::*;

const ROT90: &str = "0, -1, 0, 1, 0, 0, 0, 0, 1";

fn translation(claim: &Claim) -> String {
    format!("{:?}", claim.pose.unwrap().translation_m)
}

#[test]
fn a_nested_4x4_keeps_its_numbers_and_their_places() {
    let text = "# Kamera größer: é\ncam0:\n  T_cam_imu:\n  - [0.0, -1.0, 0.0, 0.5]\n  - [1.0, 0.0, 0.0, -0.25]\n  - [0.0, 0.0, 1.0, 2e-1]\n  - [0.0, 0.0, 0.0, 1.0]\n";
    let claim = one(text);
    assert_eq!(claim.label, "cam0/T_cam_imu");
    assert_eq!(
        matrix(&claim),
        (
            4,
            4,
            vec![0., -1., 0., 0.5, 1., 0., 0., -0.25, 0., 0., 1., 0.2, 0., 0., 0., 1.]
        )
    );
    let pose = claim.pose.unwrap();
    assert_eq!(
        pose.translation_m.map(f64::to_bits),
        [0.5f64, -0.25, 0.2].map(f64::to_bits)
    );
    let [x, y, z, w] = pose.rotation_xyzw;
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert!(x.abs() < 1e-12 && y.abs() < 1e-12 && (z - half).abs() < 1e-12 && (w - half).abs() < 1e-12);
    literals_stand_where_they_say(text, &claim);
    assert_eq!(claim.rotation_literals.len(), 16);
    assert_eq!(at(text, claim.translation_literals[2].span), (6, 21));
    assert_eq!(at(text, claim.place.span().unwrap()), (3, 3));
}

#[test]
fn columns_count_characters_after_text_that_is_not_ascii() {
    let text = "größe: {ä: 1, T_é_ü: [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3.5]]}\n";
    let claim = one(text);
    assert_eq!((claim.label.as_str(), frames(&claim).as_str()), ("größe/T_é_ü", "é<-ü"));
    assert_eq!(matrix(&claim).0, 3);
    literals_stand_where_they_say(text, &claim);
    let column = text.chars().position(|c| c == '5').unwrap() - 1;
    assert_eq!(at(text, claim.translation_literals[2].span), (1, column));
}

#[test]
fn flat_lists_and_declared_matrices_are_row_major() {
    for text in [
        "T_a_b: [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]\n",
        "T_a_b:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, 1,\n         1, 0, 0, 2,\n         0, 0, 1, 3,\n         0, 0, 0, 1]\n",
        "T_a_b:\n  rows: 4\n  cols: 4\n  data: [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]\n",
        "%YAML:1.0\nT_a_b: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n   data: [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]\n",
        "T_a_b: \"0 -1 0 1  1 0 0 2  0 0 1 3  0 0 0 1\"\n",
        "T_a_b: [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3]\n",
    ] {
        let claim = one(text);
        assert_eq!(translation(&claim), "[1.0, 2.0, 3.0]", "{text}");
        literals_stand_where_they_say(text, &claim);
    }
}

#[test]
fn a_broken_rotation_under_a_telling_key_is_still_a_claim() {
    for (key, numbers) in [
        ("T_a_b", "1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1"),
        ("extrinsic", "2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1"),
        ("a_T_b", "1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1"),
        ("rotation", "1, 0, 0, 0, 1, 0, 0, 0, -1"),
        ("extrinsic_R", "1, 0.9, 0, 0, 1, 0, 0, 0, 1"),
    ] {
        let claim = one(&format!("{key}: [{numbers}]\n"));
        assert!(claim.pose.is_none() && claim.has_rotation, "{key}");
    }
}

#[test]
fn numbers_speak_for_themselves_under_an_unknown_key() {
    let claim = one(&format!("something: [{ROT90}]\n"));
    assert_eq!((claim.frames.clone(), claim.has_translation), (None, false));
    // Three by four in a list of twelve.
    one("else: [0.36, 0.48, -0.8, 1, -0.8, 0.6, 0, 2, 0.48, 0.64, 0.6, 3]\n");
}

#[test]
fn counts_alone_do_not_make_a_transform() {
    for text in [
        "camera_matrix: {rows: 3, cols: 3, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\n",
        "K: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n",
        "LEFT.K: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n",
        "projection_matrix: {rows: 3, cols: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}\n",
        "P: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\n",
        "orientation_covariance: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n",
        "imu0: {Tw: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], Ta: [[0, 1, 0], [1, 0, 0], [0, 0, -1]]}\n",
        "accel: {sm: [0.999, 0.03, 0, -0.03, 0.999, 0, 0, 0, 1]}\n",
        "imu_intrinsic: [0, -1, 0, 1, 0, 0, 0, 0, 1]\n",
        "mask: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nweird: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n",
        "gains: [0, -1, 0, 1, 0, 0, 0, 0, 1]\n",
        "Q: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nR: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n",
        "R: [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01]\n",
        "table: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]\n",
        "initial_pose: {x: 1, y: 2, z: 0, roll: 0, pitch: 0, yaw: 0}\n",
        "translation: [1, 2, 3]\n",
        "max_velocity: [0.5, 0, 1]\nq: [0.1, 0.1, 0.1, 0.1]\n",
        "gains: {roll: 1, pitch: 2, yaw: 3}\n",
        "attitude_rpy: [180.0, 0, 0]\n",
        "point: {x: 1, y: 2, z: 3}\n",
        "T_a_b: 3\nR_a_b: [1, 2]\n",
    ] {
        none(text);
    }
}

#[test]
fn quaternions_under_keys_know_their_order() {
    let text = "T_cam_body: {qx: 0, qy: 0, qz: 0.6, qw: 0.8, tx: 1, ty: 2, tz: 3}\n";
    let claim = one(text);
    let expected = Spelling::Quaternion {
        xyz: [1., 2., 3.],
        xyzw: [0., 0., 0.6, 0.8],
        order_known: true,
    };
    assert_eq!(claim.spelling, expected);
    literals_stand_where_they_say(text, &claim);
    for text in [
        "T_a_b: {px: 1, py: 2, pz: 3, qx: 0, qy: 0, qz: 0.6, qw: 0.8}\n",
        "transform: {translation: {x: 1, y: 2, z: 3}, rotation: {w: 0.8, x: 0, y: 0, z: 0.6}}\n",
        "pose: {position: [1, 2, 3], orientation: {x: 0, y: 0, z: 0.6, w: 0.8}}\n",
        "pose: {position: [1, 2, 3], orientation_wxyz: [0.8, 0, 0, 0.6]}\n",
        "T_a_b_t_xyz_q_xyzw: [1, 2, 3, 0, 0, 0.6, 0.8]\n",
        "token: ab\ntranslation: [1, 2, 3]\nrotation: [0.8, 0, 0, 0.6]\n",
    ] {
        assert_eq!(one(text).spelling, expected, "{text}");
    }
}

#[test]
fn bare_lists_of_four_and_seven_leave_the_order_open() {
    let claim = one("extrinsic: {translation: [1, 2, 3], rotation: [0.8, 0, 0, 0.6]}\n");
    let expected = Spelling::Quaternion {
        xyz: [1., 2., 3.],
        xyzw: [0.8, 0., 0., 0.6],
        order_known: false,
    };
    assert_eq!(claim.spelling, expected);
    let claim = one("T_lidar_imu: [1, 2, 3, 0, 0, 0.6, 0.8]\n");
    let expected = Spelling::Quaternion {
        xyz: [1., 2., 3.],
        xyzw: [0., 0., 0.6, 0.8],
        order_known: false,
    };
    assert_eq!(claim.spelling, expected);
    assert_eq!(claim.rotation_literals.len(), 4);
    // A quaternion far from unit is still one where the key says so.
    let claim = one("T_a_b: {qx: 0, qy: 0, qz: 3, qw: 4, x: 0, y: 0, z: 0}\n");
    assert!(claim.pose.is_some());
    let claim = one("lidar_to_imu: {rotation: [0, 0, 0, 0], translation: [0, 0, 0]}\n");
    assert!(claim.pose.is_none());
}

#[test]
fn roll_pitch_yaw_is_radians_unless_the_key_says_degrees() {
    let turn = std::f64::consts::FRAC_PI_2;
    for (text, yaw) in [
        ("mount: {x: 1, y: 2, z: 3, roll: 0, pitch: 0, yaw: 0.5}\n", 0.5),
        ("mount: {xyz: [1, 2, 3], rpy: [0, 0, 0.5]}\n", 0.5),
        ("mount: {xyz: \"1 2 3\", rpy: \"0 0 0.5\"}\n", 0.5),
        ("originXYZ: [1, 2, 3]\noriginRPY: [0, 0, 0.5]\n", 0.5),
        ("mount: {xyz: [1, 2, 3], rpy_deg: [0, 0, 90]}\n", turn),
        (
            "mount: {x: 1, y: 2, z: 3, roll_deg: 0, pitch_deg: 0, yaw_deg: 90}\n",
            turn,
        ),
        ("mount_degrees: {x: 1, y: 2, z: 3, roll: 0, pitch: 0, yaw: 90}\n", turn),
        (
            "mount: {translation_mm: [1000, 2000, 3000], rotation_rpy: [0, 0, 0.5]}\n",
            0.5,
        ),
    ] {
        let claim = one(text);
        let Spelling::Rpy { xyz, rpy } = claim.spelling else {
            panic!("{text}")
        };
        assert!(
            xyz.iter().zip([1.0, 2.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-12),
            "{text}"
        );
        assert!((rpy[2] - yaw).abs() < 1e-12 && rpy[0] == 0.0, "{text}");
        literals_stand_where_they_say(text, &claim);
    }
    let claim = one("mount: {xyz: [1, 2, 3], rpy_deg: [0, 0, 90]}\n");
    assert_eq!(
        (
            claim.rotation_literals[2].text.as_str(),
            claim.rotation_literals[2].value
        ),
        ("90", 90.0)
    );
}

#[test]
fn halves_of_one_stem_become_one_claim() {
    let r = format!("[{ROT90}]");
    for (text, label) in [
        (
            format!("mapping:\n  extrinsic_T: [1, 2, 3]\n  extrinsic_R: {r}\n"),
            "mapping/extrinsic",
        ),
        (format!("extrinsicTrans: [1, 2, 3]\nextrinsicRot: {r}\n"), "extrinsic"),
        (
            format!(
                "extrinsicRotation: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n  data: {r}\nextrinsicTranslation: !!opencv-matrix\n  rows: 3\n  cols: 1\n  dt: d\n  data: [1, 2, 3]\n"
            ),
            "extrinsic",
        ),
        (
            format!("extrinsics/baselink2imu/t: [1, 2, 3]\nextrinsics/baselink2imu/R: {r}\n"),
            "extrinsics/baselink2imu",
        ),
        (format!("baselink2imu: {{t: [1, 2, 3], R: {r}}}\n"), "baselink2imu"),
        (format!("camera_ext_R: {r}\ncamera_ext_t: [1, 2, 3]\n"), "camera_ext"),
        (
            "poses: {R: [[0, -1, 0], [1, 0, 0], [0, 0, 1]], T: [1, 2, 3]}\n".to_owned(),
            "poses",
        ),
        (format!("Rcl: {r}\nPcl: [1, 2, 3]\n"), "Rcl"),
        (
            format!("extrinsic_R_imu_camera: {r}\nextrinsic_t_imu_camera: [1, 2, 3]\n"),
            "extrinsic_R_imu_camera",
        ),
    ] {
        let claim = one(&text);
        assert_eq!(claim.label, label, "{text}");
        assert!(claim.has_rotation && claim.has_translation);
        assert_eq!(translation(&claim), "[1.0, 2.0, 3.0]");
        assert_eq!((matrix(&claim).0, claim.rotation_literals.len()), (3, 9));
        literals_stand_where_they_say(&text, &claim);
    }
}

#[test]
fn a_second_rotation_of_a_stem_and_a_lone_half_stand_alone() {
    let (_, facts) = yaml(&format!(
        "lio_sam:\n  extrinsicTrans: [1, 2, 3]\n  extrinsicRot: [{ROT90}]\n  extrinsicRPY: [0, 1, 0, -1, 0, 0, 0, 0, 1]\n"
    ));
    let said: Vec<_> = facts
        .claims
        .iter()
        .map(|c| (c.label.as_str(), c.has_rotation, c.has_translation))
        .collect();
    assert_eq!(
        said,
        [("lio_sam/extrinsic", true, true), ("lio_sam/extrinsicRPY", true, false)]
    );
    let claim = one("extrinsic_T: [1, 2, 3]\n");
    assert_eq!(claim.spelling, Spelling::Translation { xyz: [1., 2., 3.] });
    assert!(!claim.has_rotation);
    let claim = one("LEFT.R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n");
    assert!(claim.has_rotation && !claim.has_translation);
}

#[test]
fn camera_info_states_one_rotation() {
    let claim = one(
        "image_width: 640\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n\
         distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, 0]\n\
         rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n\
         projection_matrix:\n  rows: 3\n  cols: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\n",
    );
    assert_eq!(
        (claim.label.as_str(), frames(&claim).as_str()),
        ("rectification_matrix", "camera_rectified<-camera")
    );
    assert!(claim.has_rotation && !claim.has_translation);
}

#[test]
fn dialects_settle_units_and_meaning() {
    let text = r#"{"lidar_intrinsics": {"lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1]}}"#;
    let (source, facts) = json(text);
    assert_eq!(source.status, ReadStatus::Read);
    let claim = &facts.claims[0];
    assert_eq!(frames(claim), "sensor<-lidar");
    let pose = claim.pose.unwrap();
    assert!((pose.translation_m[2] - 0.03618).abs() < 1e-12);
    assert!((matrix(claim).2[11] - 0.03618).abs() < 1e-12);
    assert_eq!(claim.translation_literals[2].text, "36.18");
    literals_stand_where_they_say(text, claim);

    let (_, facts) = json(r#"{"extrinsic_parameter": {"roll": 90, "pitch": 0, "yaw": 0, "x": 1000, "y": 0, "z": 0}}"#);
    let Spelling::Rpy { xyz, rpy } = &facts.claims[0].spelling else {
        panic!()
    };
    assert!((xyz[0] - 1.0).abs() < 1e-12 && (rpy[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);

    let (_, facts) = json(
        r#"{"sensors": [{"type": "lidar", "spawn_point": {"x": 2, "y": 0, "z": 2, "roll": 0, "pitch": 20, "yaw": 0}}]}"#,
    );
    let Spelling::Rpy { rpy, .. } = &facts.claims[0].spelling else {
        panic!()
    };
    assert!((rpy[1] - 20f64.to_radians()).abs() < 1e-12);

    // The last row of SLICT's blocks carries a flag.
    let block = "1, 0, 0, -0.05, 0, 1, 0, 0, 0, 0, 1, 0.055, 0, 0, 0, 0";
    let (source, facts) = yaml(&format!("lidar_extr: [{block}, {block}]\n"));
    assert_eq!(source.status, ReadStatus::Read);
    assert_eq!(facts.claims.len(), 2);
    assert_eq!(facts.claims[1].label, "lidar_extr/1");
    assert_eq!(matrix(&facts.claims[1]).0, 3);
    assert!(facts.claims[1].pose.is_some());
}

#[test]
fn halves_nested_under_a_parent_and_a_child_have_their_frames() {
    let claim = one(
        "base_link:\n  lidar:\n    translation: {x: 0.9, y: 0.1, z: 1.8}\n    rotation: {x: 0, y: 0, z: 0, w: 1}\n",
    );
    assert_eq!(claim.frames, Some(("base_link".into(), "lidar".into())));
    assert_eq!(translation(&claim), "[0.9, 0.1, 1.8]");
    let claim = one("base_link:\n  lidar:\n    xyz: [0.9, 0.1, 1.8]\n    rpy: [0, 0, 0.2]\n");
    assert_eq!(claim.frames, Some(("base_link".into(), "lidar".into())));
}

#[test]
fn a_list_of_poses_with_times_is_no_mounting() {
    let pose = |time: u64| format!("{{timestamp: {time}, rotation: [1, 0, 0, 0], translation: [411.3, 2700.9, 0]}}");
    let (source, facts) = yaml(&format!(
        "[{}, {}]\n",
        pose(1_532_402_927_647_951),
        pose(1_532_402_927_664_178)
    ));
    assert!(facts.claims.is_empty());
    assert_eq!(
        source.detail.as_deref(),
        Some("poses over time (a trajectory), no mounting transforms")
    );
    // One time for all is when they were calibrated.
    let (_, facts) = yaml(&format!("[{}, {}]\n", pose(1_532_402_927), pose(1_532_402_927)));
    assert_eq!(facts.claims.len(), 2);
}
