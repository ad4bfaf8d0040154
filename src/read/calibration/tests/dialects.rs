//! Dialects: one physical extrinsic in the words of each, and how a file is recognised.

use nalgebra::{Isometry3, Matrix4, Translation3, UnitQuaternion, Vector3};

use super::*;
use crate::source::Confidence;
use crate::world::ClaimKind;

/// `body_from_sensor` of no symmetry at all: no inverse, transpose or order of it is near it.
fn truth() -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(0.31, -0.12, 0.47),
        UnitQuaternion::from_euler_angles(0.4, -0.7, 1.9),
    )
}

fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    let words: Vec<String> = numbers.into_iter().map(|number| format!("{number:?}")).collect();
    format!("[{}]", words.join(", "))
}

fn rows(matrix: &Matrix4<f64>) -> Vec<f64> {
    matrix.transpose().iter().copied().collect()
}

/// Sixteen numbers, row by row.
fn flat(pose: &Isometry3<f64>) -> String {
    list(rows(&pose.to_homogeneous()))
}

fn nested(pose: &Isometry3<f64>) -> String {
    let numbers = rows(&pose.to_homogeneous());
    let rows: Vec<String> = numbers.chunks(4).map(|row| list(row.iter().copied())).collect();
    format!("[{}]", rows.join(", "))
}

fn rotation(pose: &Isometry3<f64>) -> String {
    list(pose.rotation.to_rotation_matrix().matrix().transpose().iter().copied())
}

fn place(pose: &Isometry3<f64>) -> String {
    list(pose.translation.vector.iter().copied())
}

fn opencv(rows: usize, cols: usize, data: &str) -> String {
    format!("!!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n   data: {data}")
}

fn xyzw(pose: &Isometry3<f64>) -> [f64; 4] {
    let q = pose.rotation.coords;
    [q.x, q.y, q.z, q.w]
}

struct Example {
    dialect: &'static str,
    text: String,
    /// `target<-source` that comes out. What carries the sensor is the target, or, behind `!`, the source.
    frames: &'static str,
    is_json: bool,
}

/// The extrinsic in each dialect, each in its own direction; `frames` names the sensor and what carries it.
#[expect(clippy::too_many_lines, reason = "a table")]
fn files() -> Vec<Example> {
    let (body_from_sensor, sensor_from_body) = (truth(), truth().inverse());
    let (roll, pitch, yaw) = body_from_sensor.rotation.euler_angles();
    let (inverse_roll, inverse_pitch, inverse_yaw) = sensor_from_body.rotation.euler_angles();
    let t = body_from_sensor.translation.vector;
    let it = sensor_from_body.translation.vector;
    let [qx, qy, qz, qw] = xyzw(&body_from_sensor);
    let seven = list([it.x, it.y, it.z].into_iter().chain(xyzw(&sensor_from_body)));
    let yaml = |dialect, frames, text: String| Example {
        dialect,
        text,
        frames,
        is_json: false,
    };
    let json = |dialect, frames, text: String| Example {
        dialect,
        text,
        frames,
        is_json: true,
    };
    let flat_b = flat(&body_from_sensor);
    let (rotation_b, rotation_s) = (rotation(&body_from_sensor), rotation(&sensor_from_body));
    let (place_b, place_s) = (place(&body_from_sensor), place(&sensor_from_body));
    let mut mm = rows(&body_from_sensor.to_homogeneous());
    for index in [3, 7, 11] {
        mm[index] *= 1000.0;
    }
    let mm = list(mm);
    vec![
        yaml(
            "autoware",
            "base_link<-lidar",
            format!(
                "base_link: {{lidar: {{x: {:?}, y: {:?}, z: {:?}, roll: {roll:?}, pitch: {pitch:?}, yaw: {yaw:?}}}}}\n",
                t.x, t.y, t.z
            ),
        ),
        yaml(
            "kalibr",
            "!cam0<-imu",
            format!(
                "cam0:\n  camera_model: pinhole\n  T_cam_imu: {}\n",
                nested(&sensor_from_body)
            ),
        ),
        yaml(
            "openvins",
            "imu<-cam0",
            format!("%YAML:1.0\ncam0:\n  T_imu_cam: {}\n", nested(&body_from_sensor)),
        ),
        yaml(
            "openvins",
            "!cam0<-imu",
            format!("%YAML:1.0\ncam0:\n  T_cam_imu: {}\n", nested(&sensor_from_body)),
        ),
        yaml(
            "vikit",
            "!cam0<-body",
            format!(
                "cam0:\n  T_cam_body: {{qx: {:?}, qy: {:?}, qz: {:?}, qw: {:?}, x: {:?}, y: {:?}, z: {:?}}}\n",
                xyzw(&sensor_from_body)[0],
                xyzw(&sensor_from_body)[1],
                xyzw(&sensor_from_body)[2],
                xyzw(&sensor_from_body)[3],
                it.x,
                it.y,
                it.z
            ),
        ),
        yaml(
            "maplab",
            "body<-cam0",
            format!("cameras:\n- camera: {{label: cam0}}\n  T_B_C: {{rows: 4, cols: 4, data: {flat_b}}}\n"),
        ),
        yaml(
            "maplab",
            "body<-lidar7",
            format!(
                "extrinsics:\n- sensor_id: lidar7\n  T_B_S: {}\n",
                nested(&body_from_sensor)
            ),
        ),
        yaml(
            "okvis",
            "imu<-cam0",
            format!("cameras:\n - {{T_SC: {flat_b}, image_dimension: [752, 480]}}\n"),
        ),
        yaml(
            "airslam",
            "body<-cam0",
            format!("cam0:\n  T_type: 0\n  T: {}\n", nested(&body_from_sensor)),
        ),
        yaml(
            "airslam-kalibr",
            "!cam0<-body",
            format!("cam0:\n  T_type: 1\n  T: {}\n", nested(&sensor_from_body)),
        ),
        yaml(
            "r-vio",
            "imu<-cam0",
            format!("%YAML:1.0\nT_BC0: {}\n", opencv(4, 4, &flat_b)),
        ),
        yaml(
            "vins-fusion",
            "body<-cam0",
            format!("%YAML:1.0\nbody_T_cam0: {}\n", opencv(4, 4, &flat_b)),
        ),
        yaml(
            "vins-mono",
            "imu<-cam0",
            format!(
                "%YAML:1.0\nextrinsicRotation: {}\nextrinsicTranslation: {}\n",
                opencv(3, 3, &rotation_b),
                opencv(3, 1, &place_b)
            ),
        ),
        yaml(
            "orb-slam3",
            "body<-cam1",
            format!("%YAML:1.0\nIMU.T_b_c1: {}\n", opencv(4, 4, &flat_b)),
        ),
        yaml(
            "orb-slam3",
            "body<-cam1",
            format!("%YAML:1.0\nCamera.fx: 458.0\nTbc: {}\n", opencv(4, 4, &flat_b)),
        ),
        yaml(
            "euroc",
            "body<-sensor",
            format!("sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: {flat_b}\nrate_hz: 20\n"),
        ),
        yaml(
            "fast-lio",
            "imu<-lidar",
            format!("mapping:\n  extrinsic_T: {place_b}\n  extrinsic_R: {rotation_b}\n"),
        ),
        yaml(
            "fast-livo",
            "!camera<-lidar",
            format!("camera:\n  Rcl: {rotation_s}\n  Pcl: {place_s}\n"),
        ),
        yaml(
            "lio-sam",
            "!lidar<-imu",
            format!("lio_sam:\n  extrinsicTrans: {place_s}\n  extrinsicRot: {rotation_s}\n"),
        ),
        yaml(
            "lvi-sam-camera",
            "!cam0<-lidar",
            format!(
                "%YAML:1.0\nlidar_to_cam_tx: {:?}\nlidar_to_cam_ty: {:?}\nlidar_to_cam_tz: {:?}\nlidar_to_cam_rx: {inverse_roll:?}\nlidar_to_cam_ry: {inverse_pitch:?}\nlidar_to_cam_rz: {inverse_yaw:?}\n",
                it.x, it.y, it.z
            ),
        ),
        yaml(
            "r3live",
            "imu<-camera",
            format!("r3live_vio:\n  camera_ext_R: {rotation_b}\n  camera_ext_t: {place_b}\n"),
        ),
        yaml(
            "sr-livo",
            "imu<-camera",
            format!("extrinsic_R_imu_camera: {rotation_b}\nextrinsic_t_imu_camera: {place_b}\n"),
        ),
        yaml(
            "dlio",
            "base_link<-imu",
            format!(
                "dlio:\n  extrinsics:\n    baselink2imu:\n      t: {place_b}\n      R: {rotation_b}\n    baselink2lidar: {{}}\n"
            ),
        ),
        json(
            "glim",
            "!lidar<-imu",
            format!("/* GLIM */ {{\"sensors\": {{ // TUM\n\"T_lidar_imu\": {seven} }} }}"),
        ),
        json(
            "nuscenes",
            "ego_vehicle<-s1",
            format!(
                "[{{\"token\": \"a\", \"sensor_token\": \"s1\", \"translation\": {place_b}, \"rotation\": {}}}]",
                list([qw, qx, qy, qz])
            ),
        ),
        json(
            "basalt",
            "imu<-cam0",
            format!(
                "{{\"value0\": {{\"T_imu_cam\": [{{\"px\": {:?}, \"py\": {:?}, \"pz\": {:?}, \"qx\": {qx:?}, \"qy\": {qy:?}, \"qz\": {qz:?}, \"qw\": {qw:?}}}]}}}}",
                t.x, t.y, t.z
            ),
        ),
        yaml(
            "apollo",
            "novatel<-velodyne64",
            format!(
                "header: {{seq: 0, frame_id: novatel}}\nchild_frame_id: velodyne64\ntransform:\n  rotation: {{x: {qx:?}, y: {qy:?}, z: {qz:?}, w: {qw:?}}}\n  translation: {{x: {:?}, y: {:?}, z: {:?}}}\n",
                t.x, t.y, t.z
            ),
        ),
        yaml(
            "hilti",
            "!lidar0<-imu0",
            format!("lidar0:\n  T_here_imu0: {}\n", nested(&sensor_from_body)),
        ),
        yaml(
            "easy-handeye",
            "tool0<-camera_optical",
            format!(
                "parameters: {{eye_on_hand: true, robot_effector_frame: tool0, robot_base_frame: base, tracking_base_frame: camera_optical}}\ntransformation: {{x: {:?}, y: {:?}, z: {:?}, qx: {qx:?}, qy: {qy:?}, qz: {qz:?}, qw: {qw:?}}}\n",
                t.x, t.y, t.z
            ),
        ),
        yaml(
            "easy-handeye",
            "base<-camera_optical",
            format!(
                "parameters: {{calibration_type: eye_on_base, robot_effector_frame: tool0, robot_base_frame: base, tracking_base_frame: camera_optical}}\ntransform:\n  translation: {{x: {:?}, y: {:?}, z: {:?}}}\n  rotation: {{x: {qx:?}, y: {qy:?}, z: {qz:?}, w: {qw:?}}}\n",
                t.x, t.y, t.z
            ),
        ),
        json(
            "ouster",
            "sensor<-lidar",
            format!("{{\"lidar_to_sensor_transform\": {mm}}}"),
        ),
        json(
            "ouster-extrinsics",
            "car<-992",
            format!(
                "{{\"transforms\": [{{\"source_frame\": \"992\", \"destination_frame\": \"car\", \"p_x\": {:?}, \"p_y\": {:?}, \"p_z\": {:?}, \"q_x\": {qx:?}, \"q_y\": {qy:?}, \"q_z\": {qz:?}, \"q_w\": {qw:?}}}]}}",
                t.x, t.y, t.z
            ),
        ),
        json(
            "livox",
            "livox_frame<-livox0",
            format!(
                "{{\"lidar_configs\": [{{\"ip\": \"1\", \"extrinsic_parameter\": {{\"roll\": {:?}, \"pitch\": {:?}, \"yaw\": {:?}, \"x\": {:?}, \"y\": {:?}, \"z\": {:?}}}}}]}}",
                roll.to_degrees(),
                pitch.to_degrees(),
                yaw.to_degrees(),
                t.x * 1e3,
                t.y * 1e3,
                t.z * 1e3
            ),
        ),
        json(
            "carla",
            "ego_vehicle<-lidar",
            format!(
                "{{\"objects\": [{{\"id\": \"car\", \"sensors\": [{{\"id\": \"lidar\", \"spawn_point\": {{\"x\": {:?}, \"y\": {:?}, \"z\": {:?}, \"roll\": {:?}, \"pitch\": {:?}, \"yaw\": {:?}}}}}]}}]}}",
                t.x,
                t.y,
                t.z,
                roll.to_degrees(),
                pitch.to_degrees(),
                yaw.to_degrees()
            ),
        ),
    ]
}

#[test]
fn one_extrinsic_in_every_dialect_is_one_extrinsic() {
    for Example {
        dialect,
        text,
        frames: expected,
        is_json,
    } in files()
    {
        let (source, facts) = if is_json { json(&text) } else { yaml(&text) };
        assert_eq!(
            source.status,
            ReadStatus::Read,
            "{dialect}: {:?}\n{text}",
            source.problems
        );
        let [claim] = &facts.claims[..] else {
            panic!("{dialect}: {} claims of\n{text}", facts.claims.len());
        };
        literals_stand_where_they_say(&text, claim);
        let stated = claim.pose.unwrap().isometry();
        let (expected, body_from_sensor) = match expected.strip_prefix('!') {
            Some(expected) => (expected, stated.inverse()),
            None => (expected, stated),
        };
        assert_eq!(frames(claim), expected, "{dialect}");
        let off = body_from_sensor.inv_mul(&truth());
        assert!(
            off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-9,
            "{dialect}: {off}\n{text}"
        );
        let known = if matches!(dialect, "apollo" | "ouster-extrinsics") {
            "generic"
        } else {
            dialect
        };
        assert!(
            matches!(&claim.kind, ClaimKind::File { dialect, .. } if dialect == known),
            "{dialect}: {:?}",
            claim.kind
        );
        let detail = source.detail.unwrap_or_default();
        assert_eq!(detail.is_empty(), dialect == "autoware", "{dialect}: {detail}");
    }
}

#[test]
fn every_dialect_of_transforms_is_tried() {
    let tried: Vec<&str> = files().iter().map(|said| said.dialect).collect();
    // Their direction is not known, or other tests hold them.
    let others = [
        "slict",
        "pandaset",
        "opencalib",
        "argoverse1",
        "camera-info",
        "kalibr-imu",
        // Plain text.
        "kitti-raw",
        "kitti",
        "boreas",
        "mrpt",
        "rovio",
        "argoverse2",
        "colmap",
        "m2dgr",
        "m2dgr-plus",
        "urbannav",
    ];
    for row in Tables::default().dialects().iter() {
        let name = row.name.as_str();
        assert!(
            row.transforms.is_empty() || tried.contains(&name) || others.contains(&name),
            "{name}"
        );
    }
}

#[test]
fn what_is_doubtful_is_a_hint_and_what_was_verified_is_likely() {
    let rotation = "[0, -1, 0, 1, 0, 0, 0, 0, 1]";
    let text = format!(
        "camera: {{Rcl: {rotation}, Pcl: [0, 0, 0]}}\nmapping: {{extrinsic_R: {rotation}, extrinsic_T: [1, 2, 3]}}\n"
    );
    let (_, facts) = yaml(&text);
    let readings: Vec<(String, Confidence)> = facts
        .claims
        .iter()
        .map(|claim| (frames(claim), claim.reading))
        .collect();
    assert_eq!(
        readings,
        [
            ("camera<-lidar".to_owned(), Confidence::Likely),
            ("imu<-lidar".to_owned(), Confidence::Hint)
        ]
    );
    // Roles are no names of frames.
    assert!(facts.frames.is_empty(), "{:?}", facts.frames);
}

#[test]
fn parameters_of_ros_2_are_known_in_every_spelling() {
    let rotation = "[0, -1, 0, 1, 0, 0, 0, 0, 1]";
    for text in [
        format!(
            "/**:\n  ros__parameters:\n    mapping:\n      extrinsic_T: [1, 2, 3]\n      extrinsic_R: {rotation}\n"
        ),
        format!(
            "/laserMapping:\n  ros__parameters:\n    mapping.extrinsic_T: [1, 2, 3]\n    mapping.extrinsic_R: {rotation}\n"
        ),
        format!("mapping/extrinsic_T: [1, 2, 3]\nmapping/extrinsic_R: {rotation}\n"),
    ] {
        assert_eq!(frames(&one(&text)), "imu<-lidar", "{text}");
    }
}

#[test]
fn cameras_of_a_chain_have_their_numbers() {
    let identity = "[[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]";
    let text = format!(
        "cam0:\n  camera_model: pinhole\n  T_cam_imu: {identity}\ncam1:\n  camera_model: pinhole\n  T_cam_imu: {identity}\n  T_cn_cnm1: {identity}\n"
    );
    let (_, facts) = yaml(&text);
    let said: Vec<String> = facts.claims.iter().map(frames).collect();
    assert_eq!(said, ["cam0<-imu", "cam1<-imu", "cam1<-cam0"]);
    let claim = one(&format!(
        "value0:\n  T_imu_cam:\n  - {{px: 0, py: 0, pz: {}, qx: 0, qy: 0, qz: 0, qw: 1}}\n",
        Vector3::new(0.0, 0.0, 1.0).z
    ));
    assert_eq!(frames(&claim), "imu<-cam0");
}
