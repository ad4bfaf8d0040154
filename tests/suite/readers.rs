//! With no real data at hand: every reader reads a file made for it, through the real program. The dialects of calibrations are
//! tried each in `dialects`.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;

use frames_lint::convert::feather_from_csv;
use serde_json::Value;

use crate::support::program;
use crate::support::reading::folder;
use crate::support::recipe::DRIVE;
use crate::support::rosbag1::{Connection, Layout, Rosbag1};
use crate::support::rosbag2::{Db3, Drive, Yaml, write_parts};
use crate::support::schemas::definition;

const ROBOT: &str = "<robot name=\"r\"><link name=\"base_link\"/><link name=\"lidar\"/><joint name=\"j\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"lidar\"/><origin xyz=\"1 0 1\"/></joint></robot>\n";
/// A part for other files needs no expansion.
const PART: &str = "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:macro name=\"mast\" params=\"p\"><link name=\"${p}_mast\"/></xacro:macro></robot>\n";
const LAUNCH: &str = "<launch><node pkg=\"tf2_ros\" type=\"static_transform_publisher\" name=\"n\" args=\"1 0 1 0 0 0 1 base_link lidar\"/></launch>\n";
const PYTHON: &str = "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n    return LaunchDescription([Node(package='tf2_ros', executable='static_transform_publisher', arguments=['--x', '1', '--frame-id', 'base_link', '--child-frame-id', 'lidar'])])\n";
const OUSTER: &str = r#"{"prod_line": "OS-1-16-A0", "build_rev": "v1.13.0", "image_rev": "ousteros-image-prod-aries-v1.13.0",
"beam_altitude_angles": [14.9, 4.9], "beam_azimuth_angles": [3.1, -3.1], "lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1]}"#;
const MATRIX: &str = "1 0 0 1\n0 1 0 0\n0 0 1 1\n0 0 0 1\n";

#[test]
fn every_reader_reads_a_file_made_for_it() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    for (name, text) in [
        ("robot.urdf", ROBOT),
        ("mast.xacro", PART),
        ("sensors.launch", LAUNCH),
        ("sensors.launch.py", PYTHON),
        ("os.json", OUSTER),
        ("T_base_link_lidar.txt", MATRIX),
        (
            "calibration.yaml",
            "base_link_from_lidar: [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1]\n",
        ),
        ("product.py", "a = T_base_lidar @ T_lidar_camera\n"),
    ] {
        fs::write(path(name), text).unwrap();
    }
    let table = "sensor_name,qw,qx,qy,qz,tx_m,ty_m,tz_m\nup_lidar,1.0,0.0,0.0,0.0,1.0,0.0,1.0\n";
    fs::write(path("egovehicle_SE3_sensor.feather"), feather_from_csv(table).unwrap()).unwrap();
    let drive = Drive::of(DRIVE);
    drive.write_mcap(&path("drive.mcap"));
    drive.write_db3(&path("drive.db3"), Db3::default());
    fs::create_dir(path("parts")).unwrap();
    Yaml::of(&write_parts(&drive.split(2), &path("parts"), "mcap")).write(&drive, &path("parts"));
    let mut bag = Rosbag1::new(Layout::default());
    let number = bag.connection(&Connection {
        topic: "/tf",
        message_type: "tf2_msgs/TFMessage",
        // A header of ROS 1 has a number, and a time that is a type of its own.
        definition: &definition("tf2_msgs/msg/TFMessage")
            .replace("builtin_interfaces/Time stamp", "uint32 seq\ntime stamp"),
        ..Connection::default()
    });
    bag.message(number, 1_500_000_000_000_000_000, &[0; 4]);
    fs::write(path("drive.bag"), bag.finish().bytes).unwrap();

    let report = |verb, path| program::run(folder.path(), [verb, "--format", "json", path]).report();
    let reports = [report("check", "."), report("chain", "product.py")];
    let inputs = reports.iter().flat_map(|report| report["inputs"].as_array().unwrap());
    let found: BTreeMap<&str, &Value> = inputs.map(|input| (input["path"].as_str().unwrap(), input)).collect();
    for (name, kind) in [
        ("robot.urdf", "urdf"),
        ("mast.xacro", "xacro"),
        ("sensors.launch", "launch"),
        ("sensors.launch.py", "launch"),
        ("os.json", "json"),
        ("T_base_link_lidar.txt", "text"),
        ("calibration.yaml", "yaml"),
        ("egovehicle_SE3_sensor.feather", "text"),
        ("drive.mcap", "mcap"),
        ("drive.db3", "sqlite"),
        ("drive.bag", "rosbag1"),
        ("parts/metadata.yaml", "rosbag2"),
        ("product.py", "code"),
    ] {
        let input = found
            .get(name)
            .unwrap_or_else(|| panic!("{name} is no input: {:?}", found.keys()));
        assert_eq!(
            (input["kind"].as_str(), input["status"].as_str()),
            (Some(kind), Some("read")),
            "{input:#}"
        );
    }
}
