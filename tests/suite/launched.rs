//! What launch files publish: edges of the tree that they start.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

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

#[test]
fn exchanged_frames_are_exchanged_by_the_fix_and_the_numbers_stay() {
    let folder = platform("0.95 0.12 1.85 0.35 0.021 0.004 lidar base_link");
    let before = run(folder.path(), ["check", "."]);
    assert_eq!(before.code, 1, "{}", before.text());
    assert!(
        before.text().contains("TREE03") && before.text().contains("CROSS02"),
        "{}",
        before.text()
    );
    let after = run(folder.path(), ["check", "--unsafe-fixes", "."]);
    assert_eq!(
        launched(folder.path()),
        launch("0.95 0.12 1.85 0.35 0.021 0.004 base_link lidar")
    );
    assert_eq!(after.code, 0, "{}", after.text());
}

#[test]
fn angles_in_the_order_of_a_description_are_put_in_that_of_the_publisher() {
    let folder = platform("0.95 0.12 1.85 0.004 0.021 0.35 base_link lidar");
    let before = run(folder.path(), ["check", "."]);
    assert!(
        before.text().contains("yaw pitch roll parent child"),
        "{}",
        before.text()
    );
    let after = run(folder.path(), ["check", "--unsafe-fixes", "."]);
    assert_eq!(
        launched(folder.path()),
        launch("0.95 0.12 1.85 0.35 0.021 0.004 base_link lidar")
    );
    assert_eq!(after.code, 0, "{}", after.text());
}

#[test]
fn the_tree_shows_what_is_published_as_edges() {
    let folder = platform("0 0 0.1 0 0 0 lidar lidar_optics");
    let tree = run(folder.path(), ["tree", "."]).text();
    assert!(tree.contains("└─ lidar_optics  xyz 0 0 0.1 m, rpy 0 0 0 deg"), "{tree}");
    assert!(tree.contains("bringup.launch:2 lidar_tf (published)"), "{tree}");
    assert!(!tree.contains("not an edge of the tree"), "{tree}");
}
