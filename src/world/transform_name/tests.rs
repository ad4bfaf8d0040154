//! Tests of the grammar of names.

use super::*;

fn read(key: &str) -> String {
    parse(key).map_or_else(
        || "-".to_owned(),
        |n| {
            let part = match n.part {
                NamePart::Whole => "",
                NamePart::Rotation => " R",
                NamePart::Translation => " t",
            };
            let ambiguous = if n.ambiguous { " ?" } else { "" };
            format!("{}<-{}{part}{ambiguous}", n.target, n.source)
        },
    )
}

#[test]
fn every_style_is_read_as_target_from_source() {
    for (key, expected) in [
        ("world_T_map", "world<-map"),
        ("base_link_T_os_lidar", "base_link<-os_lidar"),
        ("body_T_cam0", "body<-cam0"),
        ("egovehicle_SE3_sensor", "egovehicle<-sensor"),
        ("vehicle_SE3_camera_", "vehicle<-camera"),
        ("T_cam_imu", "cam<-imu"),
        ("IMU.T_b_c1", "b<-c1"),
        ("Stereo.T_c1_c2", "c1<-c2"),
        ("T_cn_cnm1", "cn<-cnm1"),
        ("T_base_lidar_t_xyz_q_xyzw", "base<-lidar"),
        ("imu_from_lidar", "imu<-lidar"),
        ("T_imu_from_lidar", "imu<-lidar"),
        ("lidar_to_imu", "imu<-lidar ?"),
        ("Tr_velo_to_cam", "cam<-velo ?"),
        ("lidar_to_sensor_transform", "sensor<-lidar ?"),
        (
            "top_center_lidar-to-center_camera-extrinsic",
            "center_camera<-top_center_lidar ?",
        ),
        ("lidar2cam", "cam<-lidar ?"),
        ("baselink2imu", "imu<-baselink ?"),
        ("lidarToCamera", "Camera<-lidar ?"),
        ("R_IMUtoACC", "ACC<-IMU R ?"),
        ("T_BS", "B<-S"),
        ("T_BC0", "B<-C0"),
        ("T_SC", "S<-C"),
        ("Tbc", "b<-c ?"),
        ("TAB", "A<-B ?"),
        ("TWC", "W<-C ?"),
        ("wTc", "w<-c ?"),
        ("Rcl", "c<-l R ?"),
        ("Pcl", "c<-l t ?"),
        ("R_a_b", "a<-b R"),
        ("imu_R_cam", "imu<-cam R"),
        ("imu_t_cam", "imu<-cam t"),
        ("extrinsic_R_imu_camera", "imu<-camera R"),
        ("extrinsic_t_imu_camera", "imu<-camera t"),
        ("lidar_to_imu_translation", "imu<-lidar t ?"),
        ("lidar_to_imu_rotation", "imu<-lidar R ?"),
        ("T_base_link_lidar", "base_link<-lidar ?"),
        ("T_base_rear_lidar", "base<-rear_lidar ?"),
        ("T_base_link_front_left_camera", "base_link<-front_left_camera ?"),
        ("T_camera_left_lidar", "camera_left<-lidar ?"),
        ("T_cam_left_imu", "cam_left<-imu ?"),
    ] {
        assert_eq!(read(key), expected, "{key}");
    }
}

#[test]
fn names_of_other_things_are_left_alone() {
    for key in [
        "",
        "T",
        "R",
        "T_",
        "_T_",
        "T_a",
        "Ta",
        "Tg",
        "T_a_a",
        "map2d",
        "rate",
        "camera_matrix",
        "T_a_b_c_d",
        "TCP",
        "Top",
        "Rot",
        "a_to_b_to_c",
        "T_1_2",
        "feature_map",
        "total",
        "history",
        "K",
        "a T b",
        "TTS",
    ] {
        assert_eq!(read(key), "-", "{key}");
    }
}

#[test]
fn an_inverse_swaps_the_frames() {
    let name = parse("a_T_b").unwrap().inverse();
    assert_eq!((name.target.as_str(), name.source.as_str()), ("b", "a"));
}

#[test]
fn any_text_is_survived() {
    for key in [
        "ä_T_ö", "T_ä_ö", "Tä", "2", "a2b2c", "é2é", "To", "aTo", "-_-_", "T__a__b",
    ] {
        let _ = parse(key);
    }
    assert_eq!(read("ä_T_ö"), "ä<-ö");
    assert_eq!(read("T__a__b"), "a<-b");
}
