//! Views: what is to be seen of a run, and that there is something to be seen for every rule with evidence in space or time.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use frames_lint::engine::{self, Options, Retention, VerdictScope};
use frames_lint::page::Page;
use frames_lint::run::Run;
use frames_lint::source::SourceKind;
use frames_lint::tables::views;
use frames_lint::verdict::Finding;
use frames_lint::view::scene as scene_of;
use frames_lint::view::scene::{self, Body, Content, Item, Scene};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::support;

pub(crate) fn looked_at(folder: &Path, verdicts: VerdictScope) -> Run {
    engine::check(&Options {
        paths: vec![folder.to_path_buf()],
        verdicts,
        sights: Retention::Everything,
        ..Options::default()
    })
    .unwrap()
}

/// The entities of a path and beneath it.
fn path(words: &str) -> scene::Path {
    let mut names = words.split('/');
    let top = scene::Path::top(names.next().unwrap());
    names.fold(top, |path, name| path.then(name))
}

fn of_files(files: &[(&str, &str)]) -> (Run, Scene) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let run = looked_at(folder.path(), VerdictScope::One);
    let scene = scene_of(&run);
    (run, scene)
}

/// Where an entity stands in the world by all poses above it that hold always.
fn pose(scene: &Scene, of: &scene::Path) -> Isometry3<f64> {
    let mut at = scene::Path::top(of.names()[0].clone());
    let mut pose = Isometry3::identity();
    for name in std::iter::once(None).chain(of.names()[1..].iter().map(Some)) {
        if let Some(name) = name {
            at = at.then(name.clone());
        }
        let own = scene.items.iter().find_map(|item| match &item.what {
            Content::Pose(pose) if item.path == at && item.stamp_ns.is_none() => Some(*pose),
            _ => None,
        });
        pose *= own.unwrap_or_else(Isometry3::identity);
    }
    pose
}

fn labels(scene: &Scene) -> Vec<&str> {
    let labels = scene.items.iter().flat_map(|item| match &item.what {
        Content::Points(points) => points.labels.as_slice(),
        Content::Lines(lines) => lines.labels.as_slice(),
        _ => &[],
    });
    labels.map(String::as_str).collect()
}

/// What is missing in the view of a bad case of a page, where the page says what is to be seen.
pub(crate) fn unseen(page: &Page, title: &str, run: &Run) -> Option<String> {
    let code = page.code;
    let Some(row) = views::of(page.view) else {
        return Some(format!("{code}: `{}` is no row of the table of views", page.view));
    };
    // Points of files are not drawn.
    if run.sources.iter().all(|source| source.kind == SourceKind::Points) {
        return None;
    }
    let see = row.see.as_ref()?;
    let scene = scene_of(run);
    let told = scene.items.iter().any(|item| {
        let is_log = item.path.is_in(&path("findings/log"));
        is_log && item.path.names().last().is_some_and(|name| name.ends_with(code))
    });
    let entity = path(see);
    let is_named = |item: &Item| item.path.names().iter().any(|name| name.contains(&row.named));
    let mut items = scene.items.iter();
    let is_there = items.any(|item| item.path.is_in(&entity) && is_named(item));
    let missing = || {
        format!(
            "{code}: {title}: nothing beneath `{see}` named `{}`, or no word of it ({told})",
            row.named
        )
    };
    // No transform makes a scale right.
    let is_scale = |finding: &Finding| finding.rule == code && finding.relation.as_deref() == Some("scale");
    let has_no_entity = page.view == "preferred" && run.verdict.findings.iter().any(is_scale);
    (!is_there && !has_no_entity || !told).then(missing)
}

const CAR: &str = r#"<robot name="car">
  <link name="base_link"><visual><origin xyz="0 0 0.5"/><geometry><box size="4 1.8 1"/></geometry></visual></link>
  <link name="lidar"/>
  <joint name="lidar_joint" type="fixed">
    <parent link="base_link"/><child link="lidar"/><origin xyz="1.2 0.1 1.8" rpy="0.01 0.02 0.35"/>
  </joint>
  <link name="island"/>
</robot>
"#;

#[test]
fn statements_of_one_pair_stand_side_by_side_with_their_difference_and_what_a_rule_prefers() {
    // The inverse of the robot's.
    let told = Isometry3::from_parts(
        Translation3::new(1.2, 0.1, 1.8),
        UnitQuaternion::from_euler_angles(0.01, 0.02, 0.35),
    );
    let inverse = told.inverse();
    let (t, (roll, pitch, yaw)) = (inverse.translation.vector, inverse.rotation.euler_angles());
    let yaml = format!(
        "base_link_from_lidar:\n  translation: [{}, {}, {}]\n  rpy: [{roll}, {pitch}, {yaw}]\n",
        t.x, t.y, t.z
    );
    let (run, scene) = of_files(&[("car.urdf", CAR), ("lidar.yaml", &yaml)]);
    assert_eq!(run.verdict.findings[0].rule, "CROSS02");
    let is_at = |words: &str, right: &Isometry3<f64>| {
        let seen = pose(&scene, &path(words));
        let off = seen.inverse() * right;
        assert!(
            off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-7,
            "{words}: {seen} is not {right}"
        );
    };
    is_at("world/base_link/lidar", &told);
    is_at("world/base_link/lidar by lidar.yaml", &inverse);
    is_at("world/base_link/lidar as CROSS02 corrects it", &told);
    assert!(
        labels(&scene).iter().any(|label| label.ends_with("m apart")),
        "{:?}",
        labels(&scene)
    );
    assert!(labels(&scene).contains(&"lidar (car.urdf)"), "{:?}", labels(&scene));
    // The marker of the finding, the body of the robot, and what is not connected.
    assert!(scene.has(&path("world/base_link/lidar/finding 1")));
    let body = scene.items.iter().find_map(|item| match &item.what {
        Content::Body(Body::Box(sides)) => Some((item.path.words(), *sides)),
        _ => None,
    });
    assert_eq!(body, Some(("world/base_link/body 1".to_owned(), [4.0, 1.8, 1.0])));
    let apart = pose(&scene, &path("world/island")).translation.vector;
    assert!(apart.y > 1.0, "{apart}");
    assert!(
        labels(&scene)
            .iter()
            .any(|label| label.starts_with("island (") && label.contains("not connected"))
    );
    assert_eq!(scene.views[0].name, "Frames");
}

#[test]
fn sources_that_agree_have_no_difference_to_be_seen() {
    let yaml = "base_link_from_lidar:\n  translation: [1.2, 0.1, 1.8]\n  rpy: [0.01, 0.02, 0.35]\n";
    let (_, scene) = of_files(&[("car.urdf", CAR), ("lidar.yaml", yaml)]);
    assert!(
        labels(&scene).iter().all(|label| !label.ends_with("apart")),
        "{:?}",
        labels(&scene)
    );
    assert!(scene.has(&path("world/base_link/lidar by lidar.yaml")));
}

#[test]
fn trees_are_seen_the_right_way_up() {
    let robot = |root: &str| {
        format!(
            "<robot name='r'><link name='{root}'/><link name='tip'/><joint name='j' type='fixed'><parent link='{root}'/>\
             <child link='tip'/><origin xyz='1 2 3'/></joint></robot>"
        )
    };
    let seen = |files: &[(&str, &str)], root: &str| {
        let (_, scene) = of_files(files);
        pose(&scene, &path(&format!("world/{root}/tip"))).translation.vector
    };
    let near = |seen: Vector3<f64>, right: [f64; 3]| assert!((seen - Vector3::from(right)).norm() < 1e-9, "{seen}");
    near(seen(&[("r.urdf", &robot("base_link"))], "base_link"), [1.0, 2.0, 3.0]);
    // x north, y east, z down: seen as east, north, up.
    near(seen(&[("r.urdf", &robot("map_ned"))], "map_ned"), [2.0, 1.0, -3.0]);
    // x right, y down, z forward: seen as forward, left, up.
    near(
        seen(&[("r.urdf", &robot("camera_optical_frame"))], "camera_optical_frame"),
        [3.0, -1.0, -2.0],
    );
    // What is declared counts more than a name.
    let declared = "conventions:\n  - {frame: base_link, body: frd}\n";
    near(
        seen(
            &[("r.urdf", &robot("base_link")), ("frames-lint.yaml", declared)],
            "base_link",
        ),
        [1.0, -2.0, -3.0],
    );
    let declared = "conventions:\n  - {frame: map, world: ned}\n";
    near(
        seen(&[("r.urdf", &robot("map")), ("frames-lint.yaml", declared)], "map"),
        [2.0, 1.0, -3.0],
    );
}

#[cfg(not(feature = "rerun"))]
#[test]
fn a_program_without_views_says_how_to_get_them() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("car.urdf"), CAR).unwrap();
    for arguments in [
        ["view", "car.urdf", "-o", "out.rrd"],
        ["check", "car.urdf", "--rrd", "out.rrd"],
    ] {
        let ran = support::program::run(folder.path(), arguments);
        assert_eq!(ran.code, 2, "{arguments:?}");
        let words: Vec<&str> = ran.err.split_whitespace().collect();
        assert!(words.join(" ").contains("--features rerun"), "{}", ran.err);
        assert!(!folder.path().join("out.rrd").exists());
    }
}

/// Platforms of recordings that are made of recipes.
fn of_recipes(recipes: &[(&str, &str)], verdicts: VerdictScope) -> (Run, Scene) {
    let folder = tempfile::tempdir().unwrap();
    for (name, recipe) in recipes {
        support::write(recipe, &folder.path().join(name));
    }
    let run = looked_at(folder.path(), verdicts);
    let scene = scene_of(&run);
    (run, scene)
}

#[test]
fn a_root_that_was_measured_to_point_elsewhere_is_turned() {
    let down = "duration_s: 90
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /imu, from_drive: imu, rate_hz: 50, frame_id: base_link}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link, world_from_enu: {rpy_deg: [180, 0, 90]}}
  - {topic: /tf, rate_hz: 20, transforms: [{parent: odom, child: base_link, from_drive: odometry}]}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps}
";
    let optical = "duration_s: 60
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: imu}]}
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 50, frame_id: imu, orientation_covariance: [-1, 0, 0, 0, 0, 0, 0, 0, 0]}
  - topic: /tf
    rate_hz: 20
    transforms: [{parent: map, child: base_link, velocity: [1, 0, 0], rpy_deg: [90, -90, 0]}]
";
    let without_tf = down
        .lines()
        .filter(|line| !line.contains("/tf,"))
        .collect::<Vec<_>>()
        .join("\n");
    for (recipe, root, up) in [
        (down, "odom", -Vector3::z()),
        (without_tf.as_str(), "odom", -Vector3::z()),
        // Optical axes have y down.
        (optical, "map", -Vector3::y()),
    ] {
        let (run, scene) = of_recipes(&[("drive.mcap", recipe)], VerdictScope::One);
        let is_told = run.verdict.findings.iter().any(|finding| finding.rule == "AXES14");
        assert!(is_told, "{root}: {:?}", run.verdict.findings);
        let seen = pose(&scene, &path(&format!("world/{root}"))).rotation * up;
        assert!((seen.z - 1.0).abs() < 1e-9, "{root}: up is seen along {seen}");
    }
}

/// A lidar whose mounting is told the wrong way round.
const INVERSE: &str = "duration_s: 30
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: velodyne, xyz: [0, -1.5, -1.8], rpy_deg: [0, 0, 90]}]}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
  - {topic: /points, from_drive: lidar, rate_hz: 10, frame_id: velodyne, xyz: [1.5, 0, 1.8], rpy_deg: [0, 0, -90], lidar: {beams: 24, columns: 180, driver: velodyne}}
";

#[test]
fn a_cloud_is_there_as_it_is_told_and_hidden_as_a_rule_would_have_it() {
    let (run, scene) = of_recipes(&[("drive.mcap", INVERSE)], VerdictScope::One);
    assert_eq!(run.verdict.findings[0].rule, "CROSS04");
    let told = path("world/base_link/velodyne").then("points of /points");
    let better = path("world/base_link/velodyne as CROSS04 corrects it").then("points of /points");
    assert!(scene.has(&told) && scene.has(&better));
    assert_eq!(scene.views[0].hidden, std::slice::from_ref(&better));
    let place = pose(&scene, &better).translation.vector;
    assert!((place - Vector3::new(1.5, 0.0, 1.8)).norm() < 1e-9, "{place}");
    // The ground that AXES10 saw lies 1.8 m under the lidar; what is on it is green.
    let grounds = scene
        .items
        .iter()
        .filter(|item| item.path.names().last().is_some_and(|name| name == "ground in /points"));
    let feet: Vec<f32> = grounds
        .filter_map(|item| match &item.what {
            Content::Lines(lines) => Some(lines.strips_m[0][1][2]),
            _ => None,
        })
        .collect();
    assert!(
        feet.len() > 3 && feet.iter().all(|z| (z + 1.8).abs() < 0.05),
        "{feet:?}"
    );
    let cloud = scene.items.iter().find_map(|item| match &item.what {
        Content::Points(points) if item.path == told => Some(points),
        _ => None,
    });
    let cloud = cloud.unwrap();
    for (xyz, color) in cloud.xyz_m.iter().zip(&cloud.colors) {
        let is_green = color[1] > 180;
        assert_eq!(is_green, (xyz[2] + 1.8).abs() < 0.1, "{xyz:?} {color:?}");
    }
}

#[test]
fn the_view_opens_at_the_worst_finding() {
    let (run, scene) = of_recipes(&[("drive.mcap", INVERSE)], VerdictScope::One);
    let worst = &run.verdict.findings[0];
    let eye = scene.views[0].eye.unwrap();
    let lidar = pose(&scene, &path("world/base_link/velodyne")).translation.vector;
    let target = Vector3::from(eye.target_m.map(f64::from));
    assert!((target - lidar).norm() < 1e-6, "{eye:?}");
    assert!(eye.at_m[2] > eye.target_m[2], "from above");
    assert!(scene.at_ns.is_some(), "{worst:?}");
}

#[test]
fn several_recordings_have_a_space_each() {
    let drive = |x: f64| {
        format!(
            "topics:\n  - {{topic: /tf_static, transforms: [{{parent: base_link, child: lidar, xyz: [{x}, 0, 1]}}]}}\n  - {{topic: /imu, type: \
             sensor_msgs/msg/Imu, rate_hz: 50, frame_id: lidar}}\n"
        )
    };
    let (later, first) = (
        drive(1.5).replacen("topics:", "start_s: 1700003600\ntopics:", 1),
        drive(1.0),
    );
    let recipes = [("monday.mcap", first.as_str()), ("tuesday.mcap", later.as_str())];
    let (run, scene) = of_recipes(&recipes, VerdictScope::Each);
    assert_eq!((run.recordings.len(), run.seen.len()), (2, 2));
    let spaces: Vec<&str> = scene
        .views
        .iter()
        .filter(|view| view.kind == scene::Kind::Space)
        .map(|view| view.name.as_str())
        .collect();
    assert_eq!(spaces.len(), 2, "{spaces:?}");
    for (recording, x) in [("monday.mcap", 1.0), ("tuesday.mcap", 1.5)] {
        assert!(spaces.iter().any(|name| name.ends_with(recording)), "{spaces:?}");
        let label = &run
            .seen
            .iter()
            .find(|world| world.label.ends_with(recording))
            .unwrap()
            .label;
        let lidar = scene::Path::top("world")
            .then(label.as_str())
            .then("base_link")
            .then("lidar");
        let place = pose(&scene, &lidar).translation.vector;
        assert!(
            (place - Vector3::new(x, 0.0, 1.0)).norm() < 1e-9,
            "{recording}: {place}"
        );
    }
}

#[test]
fn clouds_stand_in_their_frames_at_their_stamps() {
    let car = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/robots/car");
    let folder = tempfile::tempdir().unwrap();
    support::copy_platform(&car, folder.path());
    let scene = scene_of(&looked_at(folder.path(), VerdictScope::One));
    let kinds: BTreeMap<&str, usize> = scene.items.iter().fold(BTreeMap::new(), |mut kinds, item| {
        *kinds.entry(item.path.names()[0].as_str()).or_default() += 1;
        kinds
    });
    assert!(kinds["world"] > 100 && kinds["time"] > 100, "{kinds:?}");
    let moving = scene
        .items
        .iter()
        .filter(|item| matches!(item.what, Content::Pose(_)) && item.stamp_ns.is_some());
    assert!(moving.count() > 50);
}
