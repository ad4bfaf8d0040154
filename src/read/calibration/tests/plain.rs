//! Calibrations in plain text.

use super::*;
use crate::read::calibration::plain::{Form, form};
use crate::read::calibration::read_plain;
use crate::source::Place;

/// Reads a text as a file of this name.
pub(super) fn plain(name: &str, text: &str) -> (Source, Facts) {
    let mut source = Source::new(SourceId(0), name, SourceKind::Text);
    text.clone_into(&mut source.text);
    let facts = read_plain(&mut source, Tables::default().dialects());
    (source, facts)
}

/// Label and frames of every claim.
fn said(name: &str, text: &str) -> Vec<(String, String)> {
    let (source, facts) = plain(name, text);
    assert_eq!(source.status, ReadStatus::Read, "{:?}", source.problems);
    for claim in &facts.claims {
        literals_stand_where_they_say(text, claim);
    }
    let of = |claim: &Claim| (claim.label.clone(), frames(claim));
    facts.claims.iter().map(of).collect()
}

fn pairs(expected: &[(&str, &str)]) -> Vec<(String, String)> {
    let owned = expected.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned()));
    owned.collect()
}

const TURN: &str = "0 -1 0 1 0 0 0 0 1";
const ROWS: &str = "0 -1 0 0.1 1 0 0 0.2 0 0 1 0.3";

#[test]
fn files_of_kitti_say_their_direction_by_name_or_key() {
    let raw = format!("calib_time: 09-Jan-2012 13:57:47\nR: {TURN}\nT: 0.1 0.2 0.3\ndelta_f: 0 0\n");
    assert_eq!(
        said("calib_velo_to_cam.txt", &raw),
        pairs(&[("calib_velo_to_cam", "cam0<-velo")])
    );
    assert_eq!(
        said("a/calib_imu_to_velo.txt", &raw),
        pairs(&[("calib_imu_to_velo", "velo<-imu")])
    );
    let cameras = format!(
        "R_00: 1 0 0 0 1 0 0 0 1\nT_00: 0 0 0\nR_rect_00: {TURN}\nP_rect_00: {ROWS}\nR_01: {TURN}\nT_01: -0.5 0 0\n"
    );
    let found = said("calib_cam_to_cam.txt", &cameras);
    assert!(
        found.contains(&(
            "calib_cam_to_cam/R_rect_00".to_owned(),
            "cam0_rectified<-cam0".to_owned()
        )),
        "{found:?}"
    );
    let (_, facts) = plain("calib_cam_to_cam.txt", &cameras);
    let pair = facts.claims.iter().find(|claim| frames(claim) == "cam1<-cam0").unwrap();
    assert!(pair.has_rotation && pair.has_translation);
    assert_eq!(
        pair.pose.unwrap().isometry().translation.vector,
        nalgebra::Vector3::new(-0.5, 0.0, 0.0)
    );
    let object =
        format!("P0: 7 0 6 0 0 7 1 0 0 0 1 0\nR0_rect: {TURN}\nTr_velo_to_cam: {ROWS}\nTr_imu_to_velo: {ROWS}\n");
    let tracking = object
        .replace("R0_rect:", "R_rect")
        .replace("_to_", "_")
        .replace("Tr_velo_cam:", "Tr_velo_cam");
    for text in [object, tracking] {
        let found: Vec<String> = said("000000.txt", &text)
            .into_iter()
            .map(|(_, frames)| frames)
            .collect();
        assert_eq!(found, ["cam0_rectified<-cam0", "cam0<-velo", "velo<-imu"], "{text}");
    }
}

#[test]
fn a_matrix_is_called_by_the_name_of_its_file() {
    let text = "0.000000000000000000e+00 -1.0 0 3.559999999999999970e-02\n1 0 0 0\n0 0 1 0\n0 0 0 1\n";
    assert_eq!(
        said("T_applanix_lidar.txt", text),
        pairs(&[("T_applanix_lidar", "applanix<-lidar")])
    );
}

#[test]
fn a_sensor_of_mrpt_is_on_the_robot_in_degrees() {
    let text = "// sensors\n[LASER1]\ndriver = CHokuyoURG ; a comment\nsensorLabel = FRONT\npose_x = 0.5\npose_y = 0\npose_z = 0.2 // metres\npose_yaw = 90\npose_pitch = 0\npose_roll = 180\n";
    let (_, facts) = plain("robot.ini", text);
    let [claim] = &facts.claims[..] else {
        panic!("{:?}", facts.claims)
    };
    literals_stand_where_they_say(text, claim);
    assert_eq!(frames(claim), "robot<-FRONT");
    let turned = claim.pose.unwrap().isometry() * nalgebra::Point3::new(1.0, 1.0, 1.0);
    // Rolled by half a turn, then yawed by a quarter.
    assert!(
        (turned - nalgebra::Point3::new(1.5, 1.0, -0.8)).norm() < 1e-12,
        "{turned}"
    );
}

#[test]
fn a_camera_of_rovio_is_told_in_two_halves_of_two_directions() {
    let text = "; comment\nCommon\n{\n\tdepthType 1; Type\n}\nCamera0\n{\n\tCalibrationFile ;\n\tqCM_x 0; X\n\tqCM_y 0;\n\tqCM_z 0.6;\n\tqCM_w 0.8;\n\tMrMC_x 0.1;\n\tMrMC_y 0.2;\n\tMrMC_z 0.3;\n}\n";
    let (_, facts) = plain("rovio.info", text);
    let said: Vec<(String, bool)> = facts
        .claims
        .iter()
        .map(|claim| (frames(claim), claim.has_rotation))
        .collect();
    assert_eq!(
        said,
        [("camera0<-imu".to_owned(), true), ("imu<-camera0".to_owned(), false)]
    );
    assert!(
        facts
            .claims
            .iter()
            .all(|claim| claim.reading == crate::source::Confidence::Hint)
    );
}

#[test]
fn what_is_no_calibration_is_not_taken_for_one() {
    let lines = "1305031098.6659 1.3563 0.6305 1.6380 0.6132 0.5962 -0.3311 -0.3986\n".repeat(3);
    for (ending, text, expected) in [
        ("txt", lines.as_str(), Some(Form::Trajectory)),
        ("tum", "# nothing\n", Some(Form::Trajectory)),
        ("txt", "Readme\n\nThis is a text.\n", None),
        ("txt", "cmake_minimum_required(VERSION 3.5)\n", None),
        ("txt", "KEY:STRING=value 1 2 3\n", None),
        ("txt", "1 2 3\n4 5 6\n", None),
        ("txt", "", None),
        ("ini", "[a]\nb = 1\n", None),
        ("ini", "[a]\npose_x = 1\n", Some(Form::Ini)),
        ("info", "a 1\n", None),
        ("lua", "options = { tracking_frame = \"imu\" }", Some(Form::Lua)),
        ("lua", "print(1)", None),
        ("csv", "1,2,3", None),
    ] {
        assert_eq!(form(ending, text), expected, "{ending} {text}");
    }
    let (source, facts) = plain("poses.txt", &lines);
    assert!(facts.claims.is_empty() && source.status == ReadStatus::Read);
    assert_eq!(
        source.detail.as_deref(),
        Some("poses over time (a trajectory), no mounting transforms")
    );
}

#[test]
fn broken_texts_say_where() {
    for (name, text, at) in [
        ("a.info", "Camera0\n{\n qCM_x 1\n", (4, 1)),
        ("a.info", "}\nqCM_x 1\n", (1, 1)),
        ("a.tum", "1 2 3 4 5 6 7 8\n1 2 3 4 5 6 7\n", (2, 1)),
        ("a.tum", "1 2 3 4 5 6 7 8\n1 2 three 4 5 6 7 8\n", (2, 5)),
    ] {
        let (source, _) = plain(name, text);
        assert_ne!(source.status, ReadStatus::Read, "{text}");
        let place = &source.problems[0].place;
        let span = place.span().unwrap();
        assert_eq!(super::at(text, span), at, "{text}");
    }
    // The form is that of the beginning; a fault far after it is reported, and does not change the form.
    let long = format!("{}1 2 three 4 5 6 7 8\n", "1 2 3 4 5 6 7 8\n".repeat(1000));
    let (source, _) = plain("a.txt", &long);
    assert_eq!(super::at(&long, source.problems[0].place.span().unwrap()), (1001, 5));
    // Blocks without end.
    let deep = format!("qCM_x 1\n{}", "a\n{\n".repeat(5000));
    assert_ne!(plain("a.info", &deep).0.status, ReadStatus::Read);
}

#[test]
fn tables_have_a_transform_in_each_row() {
    let text = "sensor_name,qw,qx,qy,qz,tx_m,ty_m,tz_m\nring_front_center,0.5,-0.5,0.5,-0.5,1.6,0.0,1.4\nup_lidar,1,0,0,0,1.35,0,1.64\n";
    assert_eq!(
        said("egovehicle_SE3_sensor.csv", text),
        pairs(&[
            ("egovehicle_SE3_sensor/0", "egovehicle<-ring_front_center"),
            ("egovehicle_SE3_sensor/1", "egovehicle<-up_lidar"),
        ])
    );
    let (source, facts) = plain("egovehicle_SE3_sensor.csv", text);
    assert_eq!(source.detail.as_deref(), Some("extrinsics of Argoverse 2"));
    // The camera looks along x: its z is the vehicle's x.
    let camera = facts.claims[0].pose.unwrap().isometry();
    let ahead = camera * nalgebra::Point3::new(0.0, 0.0, 2.0);
    assert!((ahead - nalgebra::Point3::new(3.6, 0.0, 1.4)).norm() < 1e-12, "{ahead}");
    // Semicolons and quotes; a time in each row makes it a drive.
    let other = "\"x\";\"y\";\"z\";\"roll\";\"pitch\";\"yaw\"\n1;2;3;0;0;1.5\n";
    assert_eq!(said("c.csv", other), pairs(&[("c/0", "-")]));
    assert_eq!(
        form("csv", "timestamp,tx,ty,tz,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n"),
        Some(Form::Moments)
    );
    assert_eq!(form("csv", "roll_offset_degree,roll_offset_rad\n1,2\n"), None);
    assert_eq!(form("csv", "Laser id,Elevation,Azimuth\n1,2,3\n"), Some(Form::Beams));
    assert_eq!(
        form("csv", "EEFF,1,1\nChannel,Elevation,Azimuth\n1,2,3\n"),
        Some(Form::Beams)
    );
    assert_eq!(form("csv", "Elevation,Azimuth\n2,3\n"), None);
    let surveyed = "parent,child,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\nbase,lidar,1,2,3,0,0,90\n";
    let (_, facts) = plain("survey.csv", surveyed);
    let pose = facts.claims[0].pose.unwrap().isometry();
    assert!((pose.rotation.angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    let arms = plain("arms.csv", "parent,child,x,y,z\nimu,antenna,-1,0.5,2\n").1.claims;
    assert_eq!(frames(&arms[0]), "imu<-antenna");
    assert!(arms[0].has_translation && !arms[0].has_rotation);
    // Comments before the names, and between the rows.
    let remarked = "# surveyed 2026-03-02, metres and radians\n\nparent,child,x,y,z,roll,pitch,yaw\n# the roof\nbase,lidar,1,2,3,0,0,1.5\n";
    assert_eq!(said("c.csv", remarked), pairs(&[("c/0", "base<-lidar")]));
    assert_eq!(
        form("csv", "# x,y,z,roll,pitch,yaw\n1,2,3,0,0,1.5\n"),
        Some(Form::Table)
    );
    assert_eq!(form("csv", "a,b\nx,y,z,roll,pitch,yaw\n1,2,3,0,0,1.5\n"), None);
    let (source, facts) = plain("c.csv", "x,y,z,roll,pitch,yaw\n1,2,3,0,0,1.5\n1,2,3\n");
    assert_eq!((source.status, facts.claims.len()), (ReadStatus::Partial, 1));
    assert!(
        source.problems[0]
            .message
            .contains("3 fields, but the line of names has 6"),
        "{:?}",
        source.problems
    );
}

#[test]
fn images_of_colmap_take_the_world_to_the_camera() {
    let head = "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n#   POINTS2D[] as (X, Y, POINT3D_ID)\n";
    let text = format!("{head}1 0.8 0 0 0.6 1 2 3 1 a.jpg\n10.5 20.5 -1 30.5 40.5 7\n2 1 0 0 0 4 5 6 1 b.jpg\n\n");
    assert_eq!(
        said("images.txt", &text),
        pairs(&[("images/0", "a.jpg<-world"), ("images/1", "b.jpg<-world")])
    );
    let (_, facts) = plain("images.txt", &text);
    let Spelling::Quaternion { xyz, xyzw, order_known } = facts.claims[0].spelling else {
        panic!("{:?}", facts.claims[0])
    };
    assert_eq!((xyz, xyzw, order_known), ([1.0, 2.0, 3.0], [0.0, 0.0, 0.6, 0.8], true));
    let (source, _) = plain("images.txt", &format!("{head}1 0.8 0 zero 0.6 1 2 3 1 a.jpg\n"));
    assert!(
        source.problems[0].message.contains("`zero` is not a number"),
        "{:?}",
        source.problems
    );
}

#[test]
fn blocks_under_titles_belong_to_their_sensor() {
    let text = "%% Dataset Calibration\n\n%% Cam-left 8823\n% Extrinsic  [to LIDAR], [opencv-matrix]\n%to be changed\ndata: [ 0., 0., 1., 0.24,\n        -1., 0., 0., 0.16,\n        0., -1., 0., -0.17,\n        0., 0., 0., 1. ]\n% Intrinsic, [opencv-matrix]\ndata: [ 540.6, 0., 626.4, \n 0., 539.8, 523.9, \n 0., 0., 1. ]\n";
    let (source, facts) = plain("calibration_results.txt", text);
    assert_eq!(source.detail.as_deref(), Some("a calibration of M2DGR"));
    let [claim] = &facts.claims[..] else {
        panic!("{:?}", facts.claims)
    };
    literals_stand_where_they_say(text, claim);
    assert_eq!(frames(claim), "lidar<-Cam-left");
    assert_eq!(claim.label, "Cam-left/Extrinsic [to LIDAR]");
    let (source, _) = plain(
        "calibration_results.txt",
        "%% A b\n% Extrinsic [to LIDAR]\ndata: [1, 2\n",
    );
    assert!(
        source.problems[0].message.contains("not closed"),
        "{:?}",
        source.problems
    );
}

#[test]
fn numbers_that_are_missing_are_told_with_their_place() {
    let text = "calib_time: 09-Jan-2012 13:57:47\nR: 0 -1 0 1 0 0 0 0\nT: 0.1 0.2 0.3\n";
    let (source, _) = plain("calib_velo_to_cam.txt", text);
    assert_eq!(source.status, ReadStatus::Partial);
    let problem = &source.problems[0];
    assert_eq!(
        problem.message,
        "`calib_velo_to_cam/R` has 8 numbers; a rotation has 9, a transform 7, 12 or 16"
    );
    let span = problem.place.span().unwrap();
    assert_eq!(&text[span.start..span.end], "0 -1 0 1 0 0 0 0");
}

#[test]
fn tables_of_beams_are_read_with_places() {
    let text = "EEFF,1,1\nLaser id,Elevation,Azimuth\n1,14.794,-1.042\n2,10.944,3.125\n3,x,0\n0c1f\n";
    let (source, facts) = plain("Pandar40P.csv", text);
    assert_eq!(source.status, ReadStatus::Read);
    let [beams] = &facts.beams[..] else {
        unreachable!("{facts:?}")
    };
    assert!(!beams.is_radians && beams.maker == "Hesai" && facts.claims.is_empty());
    let read: Vec<(u32, f64, f64)> = beams
        .beams
        .iter()
        .map(|beam| (beam.id, beam.elevation, beam.azimuth))
        .collect();
    assert_eq!(read, [(1, 14.794, -1.042), (2, 10.944, 3.125)]);
    let at = |text: &str, place: &Place| place.span().map(|span| text[span.start..span.end].to_owned());
    assert_eq!(at(text, &beams.beams[1].place).as_deref(), Some("2,10.944,3.125"));
    assert_eq!(
        beams.broken.as_ref().and_then(|place| at(text, place)).as_deref(),
        Some("3,x,0")
    );
}
