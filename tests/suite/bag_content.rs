//! What messages say beyond their header: motion, writers, fixes, covariances, inertial messages, metadata.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::float_cmp)]

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::support;
use crate::support::encode::{Body, Endian, Header, Transform};
use crate::support::raw::{Layout, RawChannel, in_memory};
use crate::support::{bag, edge, evidence};
use frames_lint::world::FrameId;
use frames_lint::world::content::{CovarianceEvidence, StepEvidence};

fn steps(transform: &str) -> StepEvidence {
    let bag = evidence(&format!(
        "topics: [{{topic: /tf, rate_hz: 50, transforms: [{{parent: odom, child: base, {transform}}}]}}]"
    ));
    edge(&bag, "odom", "base").steps.clone()
}

#[test]
fn a_straight_drive_has_equal_steps_and_no_surprise() {
    let steps = steps("velocity: [2, 0, 0]");
    assert_eq!((steps.count, steps.moving, steps.undone), (499, 499, 0));
    assert_eq!(steps.sample.len(), 499);
    assert!(steps.sample[0].surprise_m.is_nan() && steps.sample[0].surprise_rad.is_nan());
    for step in &steps.sample[1..] {
        assert_eq!(step.dt_ns, 20_000_000);
        assert!((step.distance_m - 0.04).abs() < 1e-9 && step.angle_rad < 1e-9);
        assert!(step.surprise_m < 1e-9 && step.surprise_rad < 1e-9, "{step:?}");
    }
    assert_eq!(steps.farthest.len(), 16);
    assert!(steps.widest.is_empty() && steps.first_undone.is_none());
}

#[test]
fn turning_steps_have_the_angle_of_the_yaw_rate() {
    let steps = steps("rpy_deg: [10, -20, 30], yaw_rate_deg_s: 25");
    assert_eq!((steps.count, steps.moving), (499, 499));
    for step in &steps.sample[1..] {
        assert!((step.angle_rad.to_degrees() - 0.5).abs() < 1e-9, "{step:?}");
        assert!(step.surprise_rad < 1e-9, "{step:?}");
    }
}

#[test]
fn a_jump_is_the_farthest_the_widest_and_the_most_surprising_step() {
    let steps = steps("velocity: [1, 0, 0], jumps: [{at_s: 5, by: [0, 3, 0], yaw_deg: 40}]");
    for list in [&steps.farthest, &steps.widest, &steps.most_surprising] {
        assert_eq!(list[0].before.at.index, 249, "{:?}", list[0]);
        assert_eq!(list[0].after.at.index, 250);
    }
    assert!((steps.farthest[0].step.distance_m - 3.0_f64.hypot(0.02)).abs() < 1e-9);
    assert!((steps.widest[0].step.angle_rad.to_degrees() - 40.0).abs() < 1e-9);
    assert!((steps.most_surprising[0].step.surprise_m - 3.0).abs() < 1e-9);
    assert!(
        steps
            .farthest
            .windows(2)
            .all(|pair| pair[0].step.distance_m >= pair[1].step.distance_m)
    );
    assert_eq!(steps.undone, 0);
}

#[test]
fn two_writers_in_turn_undo_each_others_steps() {
    let shifted = steps("velocity: [1, 0, 0], alternate: {by: [0, 0.5, 0]}");
    assert_eq!((shifted.count, shifted.undone), (499, 498));
    let first = shifted.first_undone.unwrap();
    assert_eq!((first.before.at.index, first.after.at.index), (0, 1));
    assert!((first.step.distance_m - 0.5_f64.hypot(0.02)).abs() < 1e-9);
    let turned = steps("alternate: {yaw_deg: 1}");
    assert_eq!(turned.undone, 498);
    assert_eq!(steps("wobble_m: 0.5, wobble_hz: 1").undone, 0);
}

#[test]
fn an_edge_at_rest_has_steps_that_do_not_move() {
    let steps = steps("xyz: [1, 2, 3]");
    assert_eq!((steps.count, steps.moving), (499, 0));
    assert!(steps.farthest.is_empty() && steps.most_surprising.is_empty());
}

#[test]
fn long_series_are_sampled_and_their_extremes_are_exact() {
    let bag = evidence(
        "{duration_s: 100, topics: [{topic: /tf, rate_hz: 50, transforms: [
            {parent: odom, child: base, velocity: [1, 0, 0], jumps: [{at_s: 77.7, by: [9, 0, 0]}]}]}]}",
    );
    let steps = &edge(&bag, "odom", "base").steps;
    assert_eq!((steps.count, steps.sample.len()), (4999, 1024));
    assert!((steps.farthest[0].step.distance_m - 9.02).abs() < 1e-9);
    assert_eq!(steps.farthest[0].after.at.index, 3885);
}

/// Evidence of one edge with these stamps (ms) and positions along x.
fn stamped(poses: &[(i64, f64)]) -> StepEvidence {
    let bytes = in_memory(Layout::default(), |out| {
        let tf = out.channel(&RawChannel {
            topic: "/tf",
            message_type: "tf2_msgs/msg/TFMessage",
            ..RawChannel::default()
        });
        for (tick, (stamp_ms, x)) in (0..).zip(poses) {
            let transform = Transform {
                header: Header {
                    stamp_ns: stamp_ms * 1_000_000,
                    frame_id: "odom",
                },
                child: "base",
                translation: [*x, 0.0, 0.0],
                rotation: [0.0, 0.0, 0.0, 1.0],
            };
            out.message(tf, tick, &Body::Tf(&[transform]).encode(Endian::Little));
        }
    });
    let (_, collected) = support::collected(&bytes);
    edge(bag(&collected), "odom", "base").steps.clone()
}

#[test]
fn poses_whose_stamp_does_not_grow_are_passed_over() {
    let steps = stamped(&[(100, 0.0), (200, 1.0), (200, 50.0), (150, 70.0), (0, 90.0), (300, 2.0)]);
    let taken: Vec<(i64, f64)> = steps.sample.iter().map(|step| (step.dt_ns, step.distance_m)).collect();
    assert_eq!(taken, [(100_000_000, 1.0), (100_000_000, 1.0)]);
    assert_eq!(steps.sample[1].surprise_m, 0.0);
    // A clock that starts anew: no step across, and no velocity to be surprised by.
    let anew = stamped(&[(100_000, 0.0), (100_100, 1.0), (100, 80.0), (200, 81.0)]);
    assert_eq!(anew.count, 2);
    assert!(anew.sample[1].surprise_m.is_nan());
    // The velocity counts, not the step: twice the time, twice the way.
    let uneven = stamped(&[(100, 0.0), (200, 1.0), (400, 3.0)]);
    assert!(uneven.sample[1].surprise_m < 1e-12);
}

#[test]
fn huge_numbers_overflow_nothing() {
    let steps = stamped(&[(100, 1e308), (200, -1e308), (300, 1e308), (400, 0.0)]);
    assert_eq!(steps.count, 3);
    let all = steps.sample.iter().chain(steps.farthest.iter().map(|at| &at.step));
    for step in all.skip(1) {
        assert!(
            step.distance_m.is_finite() && !step.surprise_m.is_infinite(),
            "{step:?}"
        );
    }
}

#[test]
fn writers_of_edges_and_topics_are_told_apart() {
    let bag = evidence(
        "
        topics:
          - {topic: /tf, writer: /ekf, rate_hz: 10, transforms: [{parent: odom, child: base}]}
          - {topic: /tf, writer: /wheels, rate_hz: 5, transforms: [{parent: odom, child: base}]}
          - {topic: /scan, type: sensor_msgs/msg/LaserScan, rate_hz: 1}
        ",
    );
    let both = BTreeMap::from([("/ekf".to_owned(), 100), ("/wheels".to_owned(), 50)]);
    assert_eq!(edge(&bag, "odom", "base").writers, both);
    assert_eq!(bag.topics["/tf"].writers, both);
    assert!(bag.topics["/scan"].writers.is_empty());
}

#[test]
fn odometry_says_where_it_was_and_how_fast_it_claims_to_be() {
    let bag = evidence(
        "
        topics:
          - {topic: /odom, type: nav_msgs/msg/Odometry, rate_hz: 20, velocity: [1.5, 0, 0], yaw_rate_deg_s: 30}
          - {topic: /still, type: nav_msgs/msg/Odometry, rate_hz: 20, twist: {linear: [3, 0, 4], angular: [0, .nan, 0]}}
        ",
    );
    let odometry = bag.topics["/odom"].content.odometry.as_ref().unwrap();
    assert_eq!(odometry.samples.len(), 200);
    assert_eq!(odometry.samples[199].at.index, 199);
    assert_eq!(odometry.steps.count, 199);
    assert!((odometry.largest_speed_m_s - 1.5).abs() < 1e-12);
    assert!((odometry.largest_turn_rad_s - 30_f64.to_radians()).abs() < 1e-12);
    let still = bag.topics["/still"].content.odometry.as_ref().unwrap();
    assert_eq!((still.largest_speed_m_s, still.steps.moving), (5.0, 0));
    assert!(still.largest_turn_rad_s.is_nan());
}

#[test]
fn inertial_messages_say_whether_they_carry_an_orientation() {
    let imu = |knobs: &str| {
        let bag = evidence(&format!(
            "topics: [{{topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, {knobs}}}]"
        ));
        bag.topics["/imu"].content.imu.clone().unwrap()
    };
    let turning = imu("angular_velocity: [0, 3, 4]");
    assert_eq!(
        (turning.count, turning.identity, turning.zero, turning.same_as_first),
        (1000, 1000, 0, 1000)
    );
    assert!((turning.angular_velocity_rms - 5.0).abs() < 1e-12);
    assert!((turning.turned_rad - 5.0 * 9.99).abs() < 1e-6, "{}", turning.turned_rad);
    let empty = imu("orientation: [0, 0, 0, 0], angular_velocity: [.nan, 0, 0]");
    assert_eq!((empty.identity, empty.zero), (0, 1000));
    assert!(empty.angular_velocity_rms.is_nan() && empty.turned_rad == 0.0);
}

#[test]
fn fixes_are_sorted_by_what_is_wrong_with_them() {
    let bag = evidence(
        "
        topics:
          - {topic: /good, type: sensor_msgs/msg/NavSatFix, rate_hz: 10, latitude: 60, north_velocity: 10, east_velocity: 10}
          - {topic: /lost, type: sensor_msgs/msg/NavSatFix, rate_hz: 10, nan_from_s: 4}
          - {topic: /none, type: sensor_msgs/msg/NavSatFix, rate_hz: 10, status: -1, latitude: 0, longitude: 0}
          - {topic: /null, type: sensor_msgs/msg/NavSatFix, rate_hz: 10, latitude: 0, longitude: 0}
          - {topic: /swapped, type: sensor_msgs/msg/NavSatFix, rate_hz: 10, latitude: 120, longitude: 30}
        ",
    );
    let fixes = |topic: &str| bag.topics[topic].content.fixes.clone().unwrap();
    let good = fixes("/good");
    assert_eq!((good.count, good.no_fix, good.samples.len()), (100, 0, 100));
    // 99 m to the north and to the east at 60°: 111.4 km and 55.8 km a degree.
    let last = &good.samples[99];
    assert!((last.latitude_deg - 60.0 - 99.0 / 111_412.0).abs() < 1e-7, "{last:?}");
    assert!((last.longitude_deg - 11.0 - 99.0 / 55_800.0).abs() < 1e-6, "{last:?}");
    let lost = fixes("/lost");
    assert_eq!((lost.non_finite.0, lost.non_finite.1.len()), (60, 8));
    assert_eq!(lost.non_finite.1[0].at.index, 40);
    assert_eq!((fixes("/none").no_fix, fixes("/none").null_island.0), (100, 0));
    assert_eq!((fixes("/null").null_island.0, fixes("/null").out_of_range.0), (100, 0));
    assert_eq!(fixes("/swapped").out_of_range.0, 100);
}

#[test]
fn what_stands_inside_messages_is_evidence_of_its_own() {
    let bag = evidence(
        "
        drive: {motion: turning}
        topics:
          - {topic: /vectornav, from_drive: ins, rate_hz: 40, frame_id: imu1_frame}
          - {topic: /gps, from_drive: custom_gps, rate_hz: 5, frame_id: gps}
        ",
    );
    let ins = &bag.topics["/vectornav"];
    assert_eq!((&ins.content.imu, &ins.content.motion.inertial), (&None, &None));
    assert_eq!(ins.members.keys().collect::<Vec<_>>(), ["imu"]);
    let member = &ins.members["imu"];
    // Its own header is empty: the message's counts.
    let frames: Vec<&str> = member.header_frames.keys().map(FrameId::as_str).collect();
    assert_eq!((frames, member.guessed), (vec!["imu1_frame"], false));
    let first = member.first.as_ref().unwrap();
    assert_eq!((first.field.as_deref(), first.index), (Some("imu"), 0));
    assert_eq!(first.stamp_ns, ins.stamps.first.as_ref().unwrap().stamp_ns);
    assert_eq!(member.content.imu.as_ref().unwrap().count, 400);
    assert_eq!(member.content.motion.inertial.as_ref().unwrap().count, 400);
    let covariance = &member.content.covariances["orientation_covariance"];
    assert_eq!(covariance.samples[0].at.field.as_deref(), Some("imu"));

    let gps = &bag.topics["/gps"].members;
    assert_eq!(gps.keys().collect::<Vec<_>>(), ["latitude, longitude, altitude"]);
    let member = &gps["latitude, longitude, altitude"];
    let fixes = member.content.fixes.as_ref().unwrap();
    assert!(member.guessed && (fixes.samples[0].altitude_m - 500.0).abs() < 30.0);
    assert_eq!(member.content.motion.fixes.as_ref().unwrap().rows().count(), 50);
    // The topic itself, and the one member.
    let said: Vec<String> = bag.topics["/gps"].contents().map(|said| said.subject()).collect();
    assert_eq!(
        said,
        ["topic `/gps`", "topic `/gps` (field `latitude, longitude, altitude`)"]
    );
}

#[test]
fn receivers_say_velocities_headings_and_sentences() {
    let bag = evidence(
        "
        drive: {motion: turning, gnss: perfect}
        topics:
          - {topic: /gps, from_drive: gps_fix, rate_hz: 5, frame_id: gps}
          - {topic: /heading, from_drive: heading, rate_hz: 5, frame_id: gps}
          - {topic: /nmea, from_drive: nmea, rate_hz: 5, frame_id: gps, sentences: [GGA, RMC, HDT]}
        ",
    );
    let motion = |topic: &str| bag.topics[topic].content.motion.clone();
    let gps = motion("/gps");
    let (fixes, twists) = (gps.fixes.unwrap(), gps.twists.unwrap());
    let nmea = motion("/nmea").nmea.unwrap();
    let headings = motion("/heading").orientations.unwrap();
    // The three sentences of a tick are one row.
    assert_eq!(
        (nmea.count, nmea.rows().count(), headings.rows().count()),
        (150, 50, 50)
    );
    for (((nmea, fix), twist), heading) in nmea.rows().zip(fixes.rows()).zip(twists.rows()).zip(headings.rows()) {
        assert!((nmea.latitude_deg - fix.latitude_deg).abs() < 1e-6, "{nmea:?} {fix:?}");
        let height = nmea.altitude_m + nmea.geoid_separation_m;
        assert!((height - fix.altitude_m).abs() < 0.01 && (nmea.geoid_separation_m - 46.0).abs() < 1e-9);
        let [east, north, _] = twist.twist.linear;
        assert!((east.hypot(north) - nmea.speed_m_s).abs() < 0.01, "{nmea:?} {twist:?}");
        assert!(twist.twist.angular[0].is_nan() && nmea.magnetic_heading_deg.is_nan());
        let [_, _, z, w] = heading.orientation;
        let yaw = 2.0 * z.atan2(w).to_degrees();
        let apart = (90.0 - yaw - nmea.true_heading_deg + 540.0).rem_euclid(360.0) - 180.0;
        assert!(apart.abs() < 0.01, "{yaw} {nmea:?}");
        assert_eq!(nmea.quality, Some(4));
    }
}

fn covariance(topics: &str, topic: &str, field: &str) -> CovarianceEvidence {
    let bag = evidence(&format!("topics: [{topics}]"));
    bag.topics[topic].content.covariances[field].clone()
}

/// A 6x6 matrix with these entries `(row, column, value)`.
fn six(entries: &[(usize, usize, &str)]) -> String {
    let mut text = "[".to_owned();
    for index in 0..36 {
        let entry = entries.iter().find(|(row, column, _)| row * 6 + column == index);
        write!(text, "{},", entry.map_or("0", |(_, _, value)| value)).unwrap();
    }
    text + "]"
}

#[test]
fn covariances_are_held_against_what_a_covariance_is() {
    let pose = |matrix: &str| {
        let topic = format!(
            "{{topic: /pose, type: geometry_msgs/msg/PoseWithCovarianceStamped, rate_hz: 2, covariance: {matrix}}}"
        );
        covariance(&topic, "/pose", "pose.covariance")
    };
    // Eigenvalues of [[2, 3], [3, 2]] are 5 and -1.
    let indefinite = pose(&six(&[(0, 0, "2"), (0, 1, "3"), (1, 0, "3"), (1, 1, "2"), (5, 5, "1")]));
    assert_eq!(indefinite.count, 20);
    assert_eq!(indefinite.samples.len(), 1);
    assert_eq!(indefinite.samples[0].count, 20);
    let (least, at) = indefinite.least_positive.unwrap();
    assert!((least - -1.0 / 3.0).abs() < 1e-12, "{least}");
    assert_eq!((at.at.index, at.values.len()), (0, 36));
    assert_eq!(indefinite.most_asymmetric.unwrap().0, 0.0);
    let asymmetric = pose(&six(&[(0, 0, "4"), (1, 1, "4"), (0, 1, "1")]));
    assert_eq!(asymmetric.most_asymmetric.unwrap().0, 0.25);
    let zero = pose(&six(&[]));
    assert_eq!((zero.all_zero, zero.least_positive.is_none()), (20, true));
    let nan = pose(&six(&[(3, 3, ".nan")]));
    assert_eq!((nan.non_finite.0, nan.least_positive.is_none()), (20, true));
    assert!(nan.non_finite.1.unwrap().values[21].is_nan());
    let huge = pose(&six(&[(0, 0, "1e308"), (1, 1, "1e308")]));
    assert!(huge.least_positive.unwrap().0.abs() < 1e-12);
}

#[test]
fn every_field_of_a_message_has_its_covariances() {
    let imu =
        "{topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 1, orientation_covariance: [-1, 0, 0, 0, 0, 0, 0, 0, 0],
        acceleration_covariance: [1, 0, 0, 0, 1, 0, 0, 0, 1]}";
    let orientation = covariance(imu, "/imu", "orientation_covariance");
    assert_eq!(
        (orientation.minus_one, orientation.least_positive.is_none()),
        (10, true)
    );
    assert_eq!(covariance(imu, "/imu", "angular_velocity_covariance").all_zero, 10);
    let acceleration = covariance(imu, "/imu", "linear_acceleration_covariance");
    assert!((acceleration.least_positive.unwrap().0 - 1.0).abs() < 1e-12);
    let odometry = "{topic: /o, type: nav_msgs/msg/Odometry, rate_hz: 1}";
    assert_eq!(covariance(odometry, "/o", "pose.covariance").all_zero, 10);
    assert_eq!(covariance(odometry, "/o", "twist.covariance").all_zero, 10);
    let fix = "{topic: /f, type: sensor_msgs/msg/NavSatFix, rate_hz: 1, covariance: [-1, 0, 0, 0, 1, 0, 0, 0, 1]}";
    assert!((covariance(fix, "/f", "position_covariance").least_positive.unwrap().0 - -1.0).abs() < 1e-12);
    let twist = "{topic: /t, type: geometry_msgs/msg/TwistWithCovarianceStamped, rate_hz: 1}";
    assert_eq!(covariance(twist, "/t", "twist.covariance").count, 10);
}

#[test]
fn two_covariances_in_turn_are_two_and_many_are_thinned() {
    let topics: Vec<String> = (1..=2)
        .map(|value| {
            format!(
                "{{topic: /f, type: sensor_msgs/msg/NavSatFix, rate_hz: 10, covariance: [{value}, 0, 0, 0, 1, 0, 0, 0, 1]}}"
            )
        })
        .collect();
    let both = covariance(&topics.join(","), "/f", "position_covariance");
    let counts: Vec<u64> = both.samples.iter().map(|kept| kept.count).collect();
    assert_eq!(counts, [100, 100]);
    assert_eq!(both.least_positive.unwrap().0, 0.5);
    // Ever new ones: the one with the smallest eigenvalue is found among all of them.
    let mut topics = Vec::new();
    for tick in 0..300 {
        let variance = if tick == 217 { -0.5 } else { 1.0 + f64::from(tick) };
        topics.push(format!(
            "{{topic: /f, type: sensor_msgs/msg/NavSatFix, at_s: {tick}, covariance: [1000, 0, 0, 0, {variance}, 0, 0, 0, 9]}}"
        ));
    }
    let many = covariance(&topics.join(","), "/f", "position_covariance");
    assert_eq!(many.count, 300);
    assert!((8..=24).contains(&many.samples.len()), "{}", many.samples.len());
    let (least, at) = many.least_positive.unwrap();
    assert!((least - -0.0005).abs() < 1e-12 && at.at.index == 217, "{least} {at:?}");
}

#[test]
fn metadata_records_and_attachments_are_kept_by_name() {
    let bag =
        evidence("{metadata: {run: {driver: Ada, map: hall}, rosbag2: {}}, topics: [{topic: /a, type: acme/msg/A}]}");
    let run =
        BTreeMap::from([("driver", "Ada"), ("map", "hall")].map(|(key, value)| (key.to_owned(), value.to_owned())));
    assert_eq!(bag.annotations["run"], run);
    assert!(bag.annotations["rosbag2"].is_empty());
    let bytes = in_memory(Layout::default(), |out| {
        out.attachment("calibration.yaml", "application/yaml", &vec![7; 100_000]);
        out.metadata("large", &BTreeMap::from([("key".to_owned(), "x".repeat(2 << 20))]));
        for name in 0..30 {
            out.metadata(
                &format!("m{name}"),
                &BTreeMap::from([("key".to_owned(), "x".repeat(100_000))]),
            );
        }
    });
    let (source, collected) = support::collected(&bytes);
    let kept = &support::bag(&collected).annotations;
    assert_eq!(kept["attachments"]["calibration.yaml"], "application/yaml");
    assert!(!kept.contains_key("large"));
    let bytes: usize = kept.values().flat_map(BTreeMap::values).map(String::len).sum();
    assert!((900_000..=1 << 20).contains(&bytes), "{bytes}");
    assert!(
        source
            .problems
            .iter()
            .any(|problem| problem.message.contains("metadata records")),
        "{source:?}"
    );
}

#[test]
fn metadata_is_found_by_the_index_too() {
    use frames_lint::collect::{CollectOptions, collect};
    use frames_lint::read::bag::Sampling;
    use frames_lint::source::{Source, SourceId, SourceKind};

    let bytes = support::build(
        "{metadata: {run: {driver: Ada}}, chunk_size_bytes: 4000, topics: [{topic: /a, type: acme/msg/A, rate_hz: 100}]}",
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    std::fs::write(&path, bytes).unwrap();
    let sampling = Sampling {
        windows: 2,
        seconds: 0.1,
        bytes: 20_000,
        carried: None,
    };
    let mut source = Source::new(SourceId(0), "drive.mcap", SourceKind::Mcap);
    let collected = collect(
        &path,
        &CollectOptions {
            sampling: Some(sampling),
            ..CollectOptions::default()
        },
        &mut source,
        &|_, _| {},
    );
    let part = bag(&collected);
    assert!(!part.share.whole && part.messages < 1000, "{source:?}");
    assert_eq!(part.annotations["run"]["driver"], "Ada");
}
