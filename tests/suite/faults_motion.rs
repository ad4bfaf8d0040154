//! Mistakes that the catalogue puts into evidence are judged as the same mistakes in messages are.
//!
//! The drives write the mistakes into messages by formulas of their own: what is collected of them is the truth.

#![allow(clippy::unwrap_used, clippy::print_stderr, clippy::indexing_slicing)]

use std::collections::BTreeSet;

use frames_lint::assure::TrialOutcome;
use frames_lint::engine::{self, Extent, Options, Rules};
use frames_lint::faults::motion::{Stream, change_imu};
use frames_lint::faults::{self, Family, Fault, Selection, Subject};
use frames_lint::world::{Facts, World};

use crate::support;

/// A drive; `@` and a word stand where a mistake of that stream is put in.
pub(crate) const DRIVE: &str = "
duration_s: 60
drive: {vehicle: car, motion: turning, seed: 2, tilt_deg: 3, place: {latitude: 48, longitude: 11.5, altitude: 500}}
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: imu, xyz: [0.3, 0, 0.4]}
      - {parent: base_link, child: gps, xyz: [0, 0, 1.5]}
  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu, xyz: [0.3, 0, 0.4]@imu}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link@odom}
  - {topic: /pose, from_drive: pose, type: geometry_msgs/msg/PoseWithCovarianceStamped, rate_hz: 10, frame_id: map@pose}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_link, from_drive: odometry@odom}
      - {parent: map, child: odom, from_drive: map_odom@map}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, xyz: [0, 0, 1.5]@fix}
  - {topic: /nmea, from_drive: nmea, rate_hz: 5, frame_id: gps, xyz: [0, 0, 1.5], sentences: [GGA, RMC]}
";

/// Mistakes: the name in the catalogue, the stream, what makes it in a recipe, and the topic.
const MADE: &[(&str, &str, &str)] = &[
    ("imu-ned-frd", "imu", "errors: [ned_frd]"),
    ("imu-ned-orientation", "imu", "errors: [ned_orientation]"),
    ("imu-ned-world", "imu", "errors: [ned_world]"),
    ("imu-conjugate", "imu", "errors: [conjugate]"),
    ("imu-wxyz", "imu", "errors: [wxyz]"),
    ("imu-wxyz-conjugate", "imu", "errors: [conjugate, wxyz]"),
    ("imu-compass-yaw", "imu", "errors: [compass_yaw]"),
    ("imu-zero-north", "imu", "errors: [zero_north]"),
    ("imu-euler-xyz", "imu", "errors: [euler_xyz]"),
    ("imu-degrees", "imu", "errors: [angles_in_degrees]"),
    ("imu-sensor-frd", "imu", "errors: [frd]"),
    ("imu-gyro-negated", "imu", "errors: [gyro_negated]"),
    ("imu-gyro-deg", "imu", "errors: [deg_s]"),
    ("imu-accel-negated", "imu", "errors: [gravity_sign]"),
    ("imu-accel-g", "imu", "errors: [g]"),
    ("imu-accel-cm", "imu", "errors: [cm_s2]"),
    ("imu-gravity-removed", "imu", "errors: [gravity_removed]"),
    ("imu-left-handed", "imu", "errors: [left_handed]"),
    ("imu-mounted-yaw-90", "imu", "errors: [yaw_90]"),
    ("imu-mounted-backward", "imu", "errors: [backward]"),
    ("imu-y-forward", "imu", "errors: [y_forward]"),
    ("imu-upside-down", "imu", "errors: [inverted]"),
    ("imu-covariance-degrees", "imu", "errors: [covariance_degrees]"),
    ("imu-covariance-deviations", "imu", "errors: [covariance_std]"),
    ("pose-xy-swapped", "odom", "errors: [swap_xy]"),
    ("pose-x-negated", "odom", "errors: [x_negated]"),
    ("pose-y-negated", "odom", "errors: [y_negated]"),
    ("pose-z-negated", "pose", "errors: [z_negated]"),
    ("pose-wxyz", "odom", "errors: [wxyz]"),
    ("pose-orientation-inverse", "odom", "errors: [conjugate]"),
    ("pose-compass-yaw", "odom", "errors: [compass_yaw]"),
    ("pose-ned-frd", "odom", "errors: [ned_frd]"),
    ("pose-z-down", "odom", "errors: [ned_world]"),
    ("pose-left-handed", "odom", "errors: [left_handed]"),
    ("pose-base-frd", "odom", "errors: [inverted]"),
    ("pose-base-y-forward", "odom", "errors: [y_forward]"),
    ("pose-base-backward", "odom", "errors: [backward]"),
    ("pose-twist-in-world", "odom", "errors: [twist_in_world]"),
    ("pose-twist-reversed", "odom", "errors: [twist_reversed]"),
    ("pose-twist-xy-swapped", "odom", "errors: [twist_swapped]"),
    ("pose-yaw-rate-negated", "odom", "errors: [twist_yaw_negated]"),
    ("pose-covariance-degrees", "pose", "errors: [covariance_degrees]"),
    (
        "pose-covariance-centimetres",
        "pose",
        "errors: [covariance_centimetres]",
    ),
    ("pose-covariance-deviations", "pose", "errors: [covariance_std]"),
    (
        "pose-covariance-rotation-first",
        "pose",
        "errors: [covariance_rotation_first]",
    ),
    ("pose-covariance-in-body", "pose", "errors: [covariance_not_rotated]"),
    (
        "pose-twist-covariance-in-world",
        "odom",
        "errors: [twist_covariance_in_world]",
    ),
    ("pose-utm-grid", "pose", "errors: [utm_grid]"),
    ("pose-utm", "pose", "errors: [utm]"),
    ("pose-ecef", "pose", "errors: [ecef]"),
    ("pose-degrees", "pose", "errors: [lat_lon_degrees]"),
    ("pose-altitude-as-z", "pose", "errors: [altitude_as_z]"),
    ("fix-swapped", "fix", "errors: [swapped]"),
    ("fix-radians", "fix", "errors: [radians]"),
    ("fix-e7", "fix", "errors: [e7]"),
    ("fix-msl-altitude", "fix", "errors: [msl]"),
    ("stamps-gps-time", "imu", "stamp_offset_s: 18"),
    ("stamps-tai", "imu", "stamp_offset_s: 37"),
    ("stamps-gps-epoch", "imu", "stamp_offset_s: -315964782"),
    ("stamps-time-zone", "fix", "stamp_offset_s: 3600"),
    ("stamps-zero", "imu", "stamp_s: 0"),
    ("stamps-later", "imu", "late_s: 0.3"),
    ("stamps-ahead", "fix", "stamp_offset_s: 0.3"),
    ("stamps-behind", "imu", "stamp_offset_s: -0.3"),
];

/// A drive of what scans.
const SCANNED: &str = "
duration_s: 40
drive: {vehicle: robot, motion: turning, seed: 6}
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: velodyne, xyz: [0, 0, 1.8]}
      - {parent: base_link, child: laser, xyz: [0.3, 0, 0.3]}
  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: base_link}
  - {topic: /points, from_drive: lidar, rate_hz: 10, frame_id: velodyne, xyz: [0, 0, 1.8]@points, lidar: {beams: 16, columns: 360, driver: velodyne@lidar}}
  - {topic: /scan, from_drive: laser, rate_hz: 10, frame_id: laser, xyz: [0.3, 0, 0.3]@scan, laser: {rays: 181}}
";

/// Mistakes of scans, as [`MADE`].
const MADE_IN_SCANS: &[(&str, &str, &str)] = &[
    ("stamps-late", "points", "late_s: 0.1"),
    ("stamps-later", "points", "late_s: 0.3"),
    ("stamps-later", "scan", "late_s: 0.3"),
    ("stamps-ahead", "points", "stamp_offset_s: 0.3"),
    ("stamps-behind", "scan", "stamp_offset_s: -0.3"),
    ("cloud-mirrored", "lidar", "mirrored: true"),
    ("cloud-z-down", "lidar", "mirrored: true, z_negated: true"),
    ("cloud-z-forward", "lidar", "optical: true"),
    ("cloud-yaw-90", "lidar", "turned_deg: -90"),
    ("cloud-millimetres", "lidar", "scale: 1000"),
    ("cloud-times-missing", "lidar", "times: missing"),
    ("cloud-times-constant", "lidar", "times: constant"),
    ("cloud-times-reversed", "lidar", "times: reversed"),
    ("cloud-times-unit", "lidar", "time_scale: 1000"),
];

/// Rule, subject and relation of a finding.
type FindingKey = (String, String, Option<String>);

/// What a drive with this made in a stream is collected as.
pub(crate) fn collected(recipe: &str, made: Option<(&str, &str)>) -> World {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    let mut recipe = recipe.to_owned();
    for stream in ["imu", "odom", "pose", "map", "fix", "points", "lidar", "scan"] {
        let knob = made.filter(|(of, _)| *of == stream);
        recipe = recipe.replace(
            &format!("@{stream}"),
            &knob.map_or_else(String::new, |(_, knob)| format!(", {knob}")),
        );
    }
    support::write(&recipe, &path);
    let mut run = engine::collect(&Options {
        paths: vec![path],
        assure: Some(Selection::default()),
        ..Options::default()
    })
    .unwrap();
    let mut world = run.worlds.remove(0);
    world.sources = run.sources.into();
    world
}

fn finding_keys(world: &World, rules: &Rules) -> BTreeSet<FindingKey> {
    let folder = world.path(world.bags.first().unwrap().source).to_owned();
    let findings = rules.judge(world).findings.into_iter();
    findings
        .map(|finding| {
            let subject = finding.subject.replace(&folder, "drive");
            (finding.rule.clone(), subject, finding.relation.clone())
        })
        .collect()
}

fn known(name: &str) -> &'static Fault {
    faults::catalogue().find(|fault| fault.name == name).unwrap()
}

#[test]
fn evidence_with_a_mistake_is_judged_as_messages_with_it() {
    let rules = Rules::select(&[]).unwrap();
    let (mut same, mut differences, mut named) = (0, Vec::new(), 0);
    let drone = DRIVE.replace("vehicle: car", "vehicle: drone");
    for (vehicle, recipe, made) in [
        ("car", DRIVE, MADE),
        ("drone", &drone, MADE),
        ("robot", SCANNED, MADE_IN_SCANS),
    ] {
        let healthy = collected(recipe, None);
        eprintln!("{vehicle}, healthy: {:?}", finding_keys(&healthy, &rules));
        for (name, stream, knob) in made {
            let fault = known(name);
            let word = format!("`/{}`", if *stream == "lidar" { "points" } else { stream });
            let subjects = fault.change.subjects(&healthy);
            let subject = subjects.iter().find(|subject| subject.is_in(&word)).unwrap();
            let mut altered = healthy.clone();
            let is_applied = fault.change.apply(&mut altered, subject);
            altered.absorb(Facts::default());
            let truth = collected(recipe, Some((stream, knob)));
            let (ours, theirs) = (finding_keys(&altered, &rules), finding_keys(&truth, &rules));
            let by_name = rules
                .judge(&truth)
                .findings
                .iter()
                .any(|finding| fault.is_named_by(finding, &fault.change.same_as(&healthy, subject)));
            named += usize::from(by_name);
            if ours == theirs {
                same += 1;
                eprintln!(
                    "{vehicle} {name}: same, applied {is_applied}, named {by_name}, {} findings",
                    ours.len()
                );
            } else {
                let extra: Vec<_> = ours.difference(&theirs).collect();
                let lacking: Vec<_> = theirs.difference(&ours).collect();
                differences.push(format!(
                    "{vehicle} {name} (applied {is_applied}): extra {extra:?}, lacking {lacking:?}"
                ));
            }
        }
    }
    eprintln!(
        "{same} of {} are judged alike, {named} are named",
        same + differences.len()
    );
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn without_an_orientation_mistakes_of_all_axes_are_one() {
    let mut world = collected(&DRIVE.replace("duration_s: 60", "duration_s: 5"), None);
    let stream = Stream::all(&world).find(|stream| stream.family == Family::Imu).unwrap();
    change_imu(&mut world, &stream, |message| message.orientation = [0.0; 4]);
    let subject = Subject::from(stream);
    let same = known("imu-ned-frd").change.same_as(&world, &subject);
    assert_eq!(same, ["ned-frd", "upside-down", "sensor-frd"]);
    assert!(!known("imu-conjugate").change.apply(&mut world, &subject));
    assert!(known("imu-ned-frd").change.apply(&mut world, &subject));
}

#[test]
fn what_a_camera_s_axes_make_of_clouds_is_collected() {
    let slices = |world: &World| -> Vec<Vec<[f64; 3]>> {
        let topic = &world.bags.first().unwrap().topics["/points"];
        let clouds = topic.content.clouds.as_ref().unwrap();
        let slices = clouds.runs.iter().flatten();
        slices.map(|slice| slice.points.clone()).collect()
    };
    let recipe = SCANNED.replace("duration_s: 40", "duration_s: 4");
    let fault = known("cloud-z-forward");
    let mut world = collected(&recipe, None);
    let subject = fault.change.subjects(&world).remove(0);
    assert!(fault.change.apply(&mut world, &subject));
    let truth = slices(&collected(&recipe, Some(("lidar", "optical: true"))));
    assert!(truth.len() > 20 && truth.iter().all(|points| points.len() > 10));
    assert_eq!(slices(&world), truth);
}

#[test]
fn what_only_the_unread_part_hides_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    let recipe = "
duration_s: 240
chunk_size_bytes: 20000
drive: {vehicle: car, motion: turning, seed: 2}
topics:
  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: base_link}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: base_link}
";
    support::write(recipe, &path);
    let tried = |extent: Extent| {
        let run = engine::check(&Options {
            paths: vec![path.clone()],
            assure: Some(Selection::of(&["fix-swapped"])),
            extent,
            ..Options::default()
        });
        let trials = run.unwrap().assurance.unwrap().trials;
        let trial = trials.first().unwrap();
        (trial.outcome, trial.miss.as_ref().map(|miss| miss.record.clone()))
    };
    let full = Extent {
        full: true,
        ..Extent::default()
    };
    assert_eq!(tried(full), (TrialOutcome::Named, None));
    let short = Extent {
        bytes: Some(200_000),
        windows: Some(5),
        ..Extent::default()
    };
    let (outcome, record) = tried(short);
    assert_eq!(outcome, TrialOutcome::Missed);
    let record = record.unwrap();
    assert!(
        record.starts_with("read the whole recording with --full, for AXES07 lacks evidence in the part that was read"),
        "{record}"
    );
    // Left to itself it reads on until the rule has what it needs.
    let enough = Extent {
        bytes: Some(200_000),
        ..Extent::default()
    };
    assert_eq!(tried(enough).0, TrialOutcome::Named);
}
