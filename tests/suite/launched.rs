//! What launch files publish: edges of the tree that they start.

#![allow(clippy::unwrap_used)]

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
fn angles_in_the_order_of_a_description_are_put_in_that_of_the_publisher() {
    is_corrected(
        "0.95 0.12 1.85 0.004 0.021 0.35 base_link lidar",
        &["yaw pitch roll parent child"],
        "0.95 0.12 1.85 0.35 0.021 0.004 base_link lidar",
    );
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
    assert!(!text.contains("say otherwise"), "{text}");
    // A joint and recorded TF go before what is published; of two launch files, one is started.
    fs::write(
        folder.path().join("other.launch"),
        launch("0 0 0.4 0 0 0 lidar lidar_optics"),
    )
    .unwrap();
    let text = chain().text();
    assert!(
        text.contains("of `lidar_optics`, launch files publish 1 more, which say otherwise"),
        "{text}"
    );
    fs::write(
        folder.path().join("other.launch"),
        launch("0 0 9 0 0 0 base_link lidar"),
    )
    .unwrap();
    let text = chain().text();
    assert!(
        text.contains("joint lidar_joint (fixed)") && !text.contains("say otherwise"),
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
