//! `frames-lint tree` with `--at` and `--chain`, and as SVG, on a recording and a URDF.

#![allow(clippy::unwrap_used)]

use std::ffi::OsString;
use std::path::Path;

use crate::support;
use frames_lint::cli::{Answer, Surroundings, run};
use frames_lint::report::Style;

const DRIVE: &str = "
start_s: 1700000000
duration_s: 20
topics:
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_link, velocity: [2, 0, 0]}
  - topic: /tf
    rate_hz: 1
    until_s: 10
    transforms:
      - {parent: map, child: odom, xyz: [100, 0, 0], rpy_deg: [0, 0, 90]}
  - topic: /tf
    rate_hz: 10
    transforms:
      - {parent: base_link, child: cart, xyz: [-1, 0, 0], until_s: 8}
      - {parent: odom, child: cart, from_s: 8}
";

const ROBOT: &str = "<robot name=\"cart\">
  <link name=\"base_link\"/>
  <link name=\"os_lidar\"/>
  <joint name=\"lidar_joint\" type=\"fixed\">
    <parent link=\"base_link\"/>
    <child link=\"os_lidar\"/>
    <origin xyz=\"0.3 0 1.2\" rpy=\"0 0 0\"/>
  </joint>
</robot>
";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.urdf"), ROBOT).unwrap();
    support::write(DRIVE, &folder.path().join("drive.mcap"));
    folder
}

fn tree(folder: &Path, options: &[&str]) -> Answer {
    let mut arguments: Vec<OsString> = vec!["frames-lint".into(), "tree".into(), folder.into()];
    arguments.extend(options.iter().map(OsString::from));
    let surroundings = Surroundings {
        style: Style::PLAIN,
        progress: false,
        is_program: false,
    };
    run(arguments, &mut std::io::empty(), surroundings)
}

#[test]
fn a_chain_is_shown_with_its_factors_their_sources_and_ages() {
    let folder = folder();
    let answer = tree(folder.path(), &["--chain", "map", "os_lidar", "--at", "1700000005.26"]);
    assert_eq!(answer.err, "");
    assert_eq!(
        answer.out,
        "\
map_from_os_lidar = map_from_odom * odom_from_base_link * base_link_from_os_lidar at 2023-11-14 22:13:25.260 UTC \
(1700000005.26 s)
  map_from_odom            xyz 100 0 0 m, rpy 0 0 90 deg   drive.mcap /tf, 0.26 s after a sample, 0.74 s before the next
  odom_from_base_link      xyz 10.52 0 0 m, rpy 0 0 0 deg  drive.mcap /tf, 0.01 s after a sample, 0.04 s before the next
  base_link_from_os_lidar  xyz 0.3 0 1.2 m, rpy 0 0 0 deg  robot.urdf:7 joint lidar_joint (fixed), static
  map_from_os_lidar        xyz 100 10.82 1.2 m, rpy 0 0 90 deg
"
    );
    assert_eq!(answer.code, 0);
    let back = tree(
        folder.path(),
        &["--chain", "base_link", "map", "--at", "2023-11-14T22:13:25Z"],
    );
    assert_eq!(
        back.out,
        "\
base_link_from_map = base_link_from_odom * odom_from_map at 2023-11-14 22:13:25.000 UTC (1700000005 s)
  base_link_from_odom  xyz -10 0 0 m, rpy 0 0 0 deg    drive.mcap /tf, a sample at this timestamp, inverted
  odom_from_map        xyz 0 100 0 m, rpy 0 0 -90 deg  drive.mcap /tf, a sample at this timestamp, inverted
  base_link_from_map   xyz -10 100 0 m, rpy 0 0 -90 deg
"
    );
    // Without a stamp: the latest that all edges have, here that of the slowest.
    let latest = tree(folder.path(), &["--chain", "map", "base_link"]);
    assert!(latest.out.contains("at 2023-11-14 22:13:29.000 UTC"), "{}", latest.out);
    let mounted = tree(folder.path(), &["--chain", "base_link", "os_lidar"]);
    assert!(
        mounted
            .out
            .starts_with("base_link_from_os_lidar = base_link_from_os_lidar at any time\n"),
        "{}",
        mounted.out
    );
}

#[test]
fn a_chain_that_tf2_would_refuse_says_so() {
    let folder = folder();
    for (options, parts) in [
        (
            &["--chain", "Map", "os_lidar"][..],
            &[
                "LookupException: \"Map\" passed to lookupTransform argument target_frame does not exist.",
                "similar names: `map`",
            ][..],
        ),
        (
            &["--chain", "map", "/os_lidar"],
            &["InvalidArgumentException: ", "similar names: `os_lidar`"],
        ),
        (
            &["--chain", "map", "os_lidar", "--at", "1700000012"],
            &[
                "ExtrapolationException: Lookup would require extrapolation into the future.  Requested time 1700000012.000000000 \
                 but the latest data is at time 1700000009.000000000",
                "`map` from `odom` is known from 2023-11-14 22:13:20.000 UTC (1700000000 s) for 9 s",
            ],
        ),
        (&["--chain", "nobody", "nobody"], &["LookupException: \"nobody\""]),
    ] {
        let answer = tree(folder.path(), options);
        assert_eq!((answer.code, answer.out.as_str()), (1, ""), "{options:?}");
        for part in parts {
            assert!(answer.err.contains(part), "{options:?}: {}", answer.err);
        }
    }
}

#[test]
fn the_tree_at_a_stamp_is_that_of_its_time() {
    let folder = folder();
    let early = tree(folder.path(), &["--at", "1700000005"]);
    assert_eq!(
        early.out,
        "\
At 2023-11-14 22:13:25.000 UTC (1700000005 s)

map
└─ odom  xyz 100 0 0 m, rpy 0 0 90 deg  drive.mcap /tf, a sample at this timestamp
   └─ base_link  xyz 10 0 0 m, rpy 0 0 0 deg  drive.mcap /tf, a sample at this timestamp
      ├─ cart  xyz -1 0 0 m, rpy 0 0 0 deg  drive.mcap /tf, a sample at this timestamp; at other times under `odom`
      └─ os_lidar  xyz 0.3 0 1.2 m, rpy 0 0 0 deg  robot.urdf:7 joint lidar_joint (fixed), static
"
    );
    let late = tree(folder.path(), &["--at", "1700000012.01"]);
    assert_eq!(
        late.out,
        "\
At 2023-11-14 22:13:32.010 UTC (1700000012.01 s)

odom
├─ base_link  xyz 24.02 0 0 m, rpy 0 0 0 deg  drive.mcap /tf, 0.01 s after a sample, 0.04 s before the next
│  └─ os_lidar  xyz 0.3 0 1.2 m, rpy 0 0 0 deg  robot.urdf:7 joint lidar_joint (fixed), static
└─ cart  identity  drive.mcap /tf, 0.01 s after a sample, 0.09 s before the next; at other times under `base_link`

Without a parent at this time, but with one at other times
  odom  under `map`: ended 3.01 s before
"
    );
}

#[test]
fn wrong_stamps_and_forms_are_wrong_calls() {
    let folder = folder();
    for options in [
        &["--at", "yesterday"][..],
        &["--at", "0"],
        &["--at", "2023-14-11T00:00:00Z"],
        &["--chain", "map"],
        &["--chain", "map", "odom", "--format", "svg"],
        &["--at", "1700000005", "--format", "dot"],
    ] {
        let answer = tree(folder.path(), options);
        assert_eq!(
            (answer.code, answer.out.as_str()),
            (2, ""),
            "{options:?}: {}",
            answer.err
        );
    }
}

#[test]
fn a_drawing_is_well_formed_and_holds_every_frame() {
    let folder = folder();
    let svg = tree(folder.path(), &["--format", "svg"]).out;
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
    for frame in ["map", "odom", "base_link", "os_lidar", "cart"] {
        assert!(texts.contains(&frame), "{frame}: {texts:?}");
    }
    assert_eq!(svg, tree(folder.path(), &["--format", "svg"]).out);
    if let Some(file) = std::env::var_os("SVG") {
        std::fs::write(file, svg).unwrap();
    }
}
