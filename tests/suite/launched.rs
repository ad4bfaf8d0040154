//! What launch files publish: edges of the tree that they start.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fs;
use std::path::Path;

use crate::support;
use crate::support::program::run;

const ROBOT: &str = r#"<robot name="car">
  <link name="base_link"/>
  <link name="lidar"/>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/><child link="lidar"/><origin xyz="0.95 0.12 1.85" rpy="0.004 0.021 0.35"/>
  </joint>
</robot>
"#;

fn launch(arguments: &str) -> String {
    format!(
        "<launch>\n  <node pkg=\"tf2_ros\" type=\"static_transform_publisher\" name=\"lidar_tf\" args=\"{arguments}\"/>\n</launch>\n"
    )
}

fn platform(arguments: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.urdf"), ROBOT).unwrap();
    fs::write(folder.path().join("bringup.launch"), launch(arguments)).unwrap();
    folder
}

fn launched(folder: &Path) -> String {
    fs::read_to_string(folder.join("bringup.launch")).unwrap()
}

/// A call that the check finds wrong, saying these words, and that the fix writes right.
fn is_corrected(wrong: &str, says: &[&str], right: &str) {
    let folder = platform(wrong);
    let before = run(folder.path(), ["check", "."]);
    assert_eq!(before.code, 1, "{}", before.text());
    for words in says {
        assert!(before.text().contains(words), "{words}: {}", before.text());
    }
    let after = run(folder.path(), ["check", "--unsafe-fixes", "."]);
    assert_eq!(launched(folder.path()), launch(right));
    assert_eq!(after.code, 0, "{}", after.text());
}

#[test]
fn exchanged_frames_are_exchanged_by_the_fix_and_the_numbers_stay() {
    is_corrected(
        "0.95 0.12 1.85 0.35 0.021 0.004 lidar base_link",
        &["TREE03", "CROSS02"],
        "0.95 0.12 1.85 0.35 0.021 0.004 base_link lidar",
    );
}

#[test]
fn exchanged_frames_are_seen_where_the_numbers_allow_other_names_for_it() {
    // Without a turn the inverse is the negated translation; half a turn is its own inverse; over few centimetres much fits.
    for (xyz, [roll, yaw]) in [
        ("0.4123 0.0832 1.3127", ["0", "0"]),
        ("0.0412 0 0.1927", ["0", "3.14159265"]),
        ("-0.0412 0.0032 0.1927", ["0", "1.5707963267948966"]),
    ] {
        let folder = platform(&format!("{xyz} {yaw} 0 {roll} lidar base_link"));
        let robot = ROBOT
            .replace("0.95 0.12 1.85", xyz)
            .replace("0.004 0.021 0.35", &format!("{roll} 0 {yaw}"));
        fs::write(folder.path().join("robot.urdf"), robot).unwrap();
        let before = run(folder.path(), ["check", "--format", "json", "."]);
        assert!(before.text().contains("\"relation\": \"inverse\""), "{}", before.text());
        let after = run(folder.path(), ["check", "--unsafe-fixes", "."]);
        assert_eq!(
            launched(folder.path()),
            launch(&format!("{xyz} {yaw} 0 {roll} base_link lidar"))
        );
        assert_eq!(after.code, 0, "{}", after.text());
    }
}

#[test]
fn six_arguments_hold_no_quaternion() {
    let folder = platform("0.95 0.12 1.85 0 0 1.5707963267948966 base_link lidar");
    let robot = ROBOT.replace("0.004 0.021 0.35", "0 0 1.5707963267948966");
    fs::write(folder.path().join("robot.urdf"), robot).unwrap();
    let before = run(folder.path(), ["check", "--format", "json", "."]);
    assert!(before.text().contains("\"relation\": \"ypr\""), "{}", before.text());
    run(folder.path(), ["check", "--unsafe-fixes", "."]);
    assert_eq!(
        launched(folder.path()),
        launch("0.95 0.12 1.85 1.570796326795 0 0 base_link lidar")
    );
}

#[test]
fn angles_in_the_order_of_a_description_are_put_in_that_of_the_publisher() {
    is_corrected(
        "0.95 0.12 1.85 0.004 0.021 0.35 base_link lidar",
        &["yaw pitch roll parent child"],
        "0.95 0.12 1.85 0.35 0.021 0.004 base_link lidar",
    );
}

#[test]
fn angles_that_a_calibration_tells_in_another_order_are_put_in_that_of_the_publisher() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("bringup.launch"),
        launch("-0.2 0.1 0.4 0.05 -0.1 0.7 base_link imu_link"),
    )
    .unwrap();
    let calibration = "parent_frame: base_link\nchild_frame: imu_link\ntranslation: [-0.2, 0.1, 0.4]\n\
                       rotation_xyzw: [0.040584918, -0.038373557, 0.343535863, 0.937477171]\n";
    fs::write(folder.path().join("imu.yaml"), calibration).unwrap();
    let before = run(folder.path(), ["check", "."]);
    assert!(before.text().contains("QUAT03"), "{}", before.text());
    assert!(
        before.text().contains("yaw, pitch, roll 0.700000 -0.100000 0.050000"),
        "{}",
        before.text()
    );
    let after = run(folder.path(), ["check", "--unsafe-fixes", "."]);
    assert_eq!(after.code, 0, "{}", after.text());
}

#[test]
fn a_chain_goes_over_joints_recorded_tf_and_what_launch_files_publish() {
    let folder = platform("0 0 0.1 0 0 0 lidar lidar_optics");
    let drive = "topics:\n  - topic: /tf\n    rate_hz: 20\n    transforms: [{parent: odom, child: base_link, xyz: [5, 0, 0]}]\n";
    support::write(drive, &folder.path().join("drive.mcap"));
    let chain = || run(folder.path(), ["tree", "--chain", "odom", "lidar_optics", "."]);
    let ran = chain();
    assert_eq!(ran.code, 0, "{}", ran.text());
    let text = ran.text();
    let product = "odom_from_lidar_optics = odom_from_base_link * base_link_from_lidar * lidar_from_lidar_optics";
    for words in [
        product,
        "drive.mcap /tf",
        "joint lidar_joint (fixed)",
        "bringup.launch:2 lidar_tf (published), static",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(!text.contains("with other values"), "{text}");
    // A joint and recorded TF go before what is published; of two launch files, one is started.
    fs::write(
        folder.path().join("other.launch"),
        launch("0 0 0.4 0 0 0 lidar lidar_optics"),
    )
    .unwrap();
    let text = chain().text();
    assert!(
        text.contains("of `lidar_optics`, launch files publish 1 more with other values"),
        "{text}"
    );
    fs::write(
        folder.path().join("other.launch"),
        launch("0 0 9 0 0 0 base_link lidar"),
    )
    .unwrap();
    let text = chain().text();
    assert!(
        text.contains("joint lidar_joint (fixed)") && !text.contains("with other values"),
        "{text}"
    );
}

#[test]
fn the_tree_shows_what_is_published_as_edges() {
    let folder = platform("0 0 0.1 0 0 0 lidar lidar_optics");
    let tree = run(folder.path(), ["tree", "."]).text();
    assert!(tree.contains("└─ lidar_optics  xyz 0 0 0.1 m, rpy 0 0 0 deg"), "{tree}");
    assert!(tree.contains("bringup.launch:2 lidar_tf (published)"), "{tree}");
    assert!(!tree.contains("not an edge of the tree"), "{tree}");
}

#[test]
fn what_is_not_launched_by_default_is_said() {
    let folder = platform("0.95 0.12 1.85 0.35 0.021 0.004 base_link lidar");
    let launch = "<launch>\n  <arg name=\"gnss\" default=\"false\"/>\n  <group if=\"$(arg gnss)\">\n    \
                  <node pkg=\"tf2_ros\" type=\"static_transform_publisher\" name=\"gnss_tf\" args=\"0 0 1 0 0 0 base_link gnss\"/>\n  </group>\n</launch>\n";
    fs::write(folder.path().join("gnss.launch"), launch).unwrap();
    fs::write(folder.path().join("speed.yaml"), "speed: 3\n").unwrap();
    let text = run(folder.path(), ["check", "."]).text();
    let said = "gnss.launch: not judged, under a condition that is false by default: `gnss_tf` (line 4)";
    assert!(text.contains(said), "{text}");
    assert!(text.contains("nothing to check in speed.yaml"), "{text}");
}

/// The loop does not close because of what CROSS02 says.
#[test]
fn a_transform_that_is_inverted_is_one_finding_whatever_loops_it_is_in() {
    let folder = platform("0.95 0.12 1.85 0.35 0.021 0.004 base_link lidar");
    fs::remove_file(folder.path().join("bringup.launch")).unwrap();
    let imu = "<link name=\"imu\"/><joint name=\"imu_joint\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"imu\"/>\
               <origin xyz=\"0.2 0.1 0.4\" rpy=\"0 0 0.1\"/></joint></robot>";
    fs::write(folder.path().join("robot.urdf"), ROBOT.replace("</robot>", imu)).unwrap();
    let lidar = include_str!("../../fixtures/first-finding/lidar.yaml");
    fs::write(folder.path().join("lidar.yaml"), lidar).unwrap();
    let imu = "parent_frame: base_link\nchild_frame: imu\ntranslation: [0.2, 0.1, 0.4]\nrotation_xyzw: [0, 0, 0.049979169, 0.998750260]\n";
    fs::write(folder.path().join("imu.yaml"), imu).unwrap();
    let report = run(folder.path(), ["check", "--format", "json", "."]).report();
    let rules = |list: &str| -> Vec<String> {
        let findings = report[list].as_array().unwrap().iter();
        findings
            .map(|finding| finding["rule"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(rules("findings"), ["CROSS02"]);
    assert!(rules("explained").contains(&"CROSS03".to_owned()), "{report:#}");
}

#[test]
fn a_finding_points_to_the_publisher_and_not_to_the_arguments_that_it_uses() {
    let folder = platform("$(arg x) 0.12 1.85 0.35 0.021 0.004 lidar base_link");
    let text = launched(folder.path()).replace("<launch>\n", "<launch>\n  <arg name=\"x\" default=\"0.95\"/>\n");
    fs::write(folder.path().join("bringup.launch"), text).unwrap();
    let report = run(folder.path(), ["check", "--format", "json", "."]).report();
    let of = |finding: &&serde_json::Value| finding["rule"] == "CROSS02";
    let finding = report["findings"].as_array().unwrap().iter().find(of).unwrap();
    assert_eq!(finding["places"][0]["line"], 3, "{finding:#}");
}

#[test]
fn a_publisher_in_many_groups_is_read_and_what_lies_deeper_is_said() {
    let grouped = |depth: usize| {
        let node = "<node pkg=\"tf2_ros\" exec=\"static_transform_publisher\" args=\"0 0 1 0 0 0 a a\"/>";
        let text = format!(
            "<launch>{}{node}{}</launch>",
            "<group>".repeat(depth),
            "</group>".repeat(depth)
        );
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.launch.xml"), text).unwrap();
        run(folder.path(), ["check", "."])
    };
    let read = grouped(300);
    assert!(read.text().contains("TREE04"), "{}", read.text());
    let deep = grouped(1500);
    assert!(deep.code == 3 && !deep.text().contains("TREE04"), "{}", deep.text());
}
