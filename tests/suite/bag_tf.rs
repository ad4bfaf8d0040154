//! TF of recordings: faults, extremes, parents that change, names and thinning.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use crate::support;
use crate::support::{edge, evidence, names};
use frames_lint::world::FrameRole;

#[test]
fn faulty_numbers_are_counted_with_examples_and_kept_out_of_the_samples() {
    let bag = evidence(
        "
        duration_s: 1
        topics:
          - topic: /tf
            rate_hz: 20
            transforms:
              - {parent: odom, child: good, quaternion: [0, 0, 0, 1.004]}
              - {parent: odom, child: nan, xyz: [.nan, 0, 0]}
              - {parent: odom, child: inf, quaternion: [0, 0, .inf, 1]}
              - {parent: odom, child: zero, quaternion: [0, 0, 0, 0]}
              - {parent: odom, child: long, quaternion: [0, 0, 0.6, 1]}
        ",
    );
    let good = edge(&bag, "odom", "good");
    assert!((good.worst_norm_error - 0.004).abs() < 1e-12 && good.samples.len() == 20);
    for child in ["nan", "inf"] {
        let edge = edge(&bag, "odom", child);
        assert_eq!((edge.count, edge.samples.len()), (20, 0));
        assert_eq!((edge.non_finite.count, edge.non_finite.examples.len()), (20, 8));
        assert_eq!((edge.zero_quaternion.count, edge.denormalized.count), (0, 0));
    }
    let zero = edge(&bag, "odom", "zero");
    assert_eq!((zero.zero_quaternion.count, zero.denormalized.count), (20, 0));
    assert_eq!(
        zero.zero_quaternion.examples[0].at.field.as_deref(),
        Some("transforms[3]")
    );
    let long = edge(&bag, "odom", "long");
    assert_eq!(
        (long.denormalized.count, long.denormalized.examples[0].rotation),
        (20, [0.0, 0.0, 0.6, 1.0])
    );
}

#[test]
fn the_extreme_sees_a_shift_behind_a_small_turn() {
    let bag = evidence(
        "
        topics:
          - {topic: /tf_static, transforms: [{parent: a, child: b}]}
          - {topic: /tf_static, at_s: 2, transforms: [{parent: a, child: b, rpy_deg: [0, 0, 0.05]}]}
          - {topic: /tf_static, at_s: 4, transforms: [{parent: a, child: b, xyz: [0, 2, 0]}]}
          - {topic: /tf_static, at_s: 6, transforms: [{parent: a, child: b}]}
        ",
    );
    let edge = &bag.tf[0];
    let (sample, angle, distance) = edge.extreme.clone().unwrap();
    assert_eq!((edge.count, sample.at.index), (4, 2));
    assert!(angle < 1e-12 && (distance - 2.0).abs() < 1e-12);
    assert_eq!(bag.topics["/tf_static"].count, 4);
}

#[test]
fn parents_that_take_turns_are_counted() {
    let bag = evidence(
        "
        duration_s: 1
        topics:
          - {topic: /tf_static, transforms: [{parent: world, child: static_child}, {parent: world, child: still}]}
          - topic: /tf
            rate_hz: 10
            transforms:
              - {parent: odom, child: fought}
              - {parent: /map, child: /fought}
              - {parent: map, child: static_child}
              - {parent: odom, child: handed_over, until_s: 0.5}
              - {parent: map, child: handed_over, from_s: 0.5}
              - {parent: same, child: slashed, until_s: 0.5}
              - {parent: /same, child: slashed, from_s: 0.5}
              - {parent: odom, child: quiet, until_s: 0.5}
              - {parent: map, child: quiet, quaternion: [0, 0, 0, 0], from_s: 0.5}
          - {topic: /other/tf, rate_hz: 10, transforms: [{parent: other_world, child: still}]}
        ",
    );
    let switches: Vec<(&str, Vec<&str>, u64, u64)> = bag
        .parent_switches
        .iter()
        .map(|s| (s.child.as_str(), names(&s.parents), s.switches, s.at.index))
        .collect();
    let expected = [
        ("fought", vec!["odom", "map"], 19, 0),
        ("handed_over", vec!["odom", "map"], 1, 5),
        ("static_child", vec!["world", "map"], 1, 0),
    ];
    assert_eq!(switches, expected);
}

#[test]
fn empty_names_are_edges_but_no_frames() {
    let recipe = "
        topics:
          - {topic: /tf_static, transforms: [{parent: '', child: a}, {parent: a, child: ''}, {parent: a, child: a}]}
          - {topic: /imu, type: sensor_msgs/msg/Imu}
          - {topic: /odom, type: nav_msgs/msg/Odometry, frame_id: odom}
        ";
    let (_, collected) = support::collected(&support::build(recipe));
    let bag = &collected.facts.bags[0];
    assert_eq!(bag.tf.len(), 3);
    assert_eq!(names(bag.topics["/imu"].header_frames.keys()), [""]);
    assert_eq!(names(bag.topics["/odom"].child_frames.keys()), [""]);
    assert!(bag.parent_switches.is_empty());
    let uses: Vec<(&str, FrameRole)> = collected
        .facts
        .frames
        .iter()
        .map(|u| (u.frame.as_str(), u.role))
        .collect();
    assert_eq!(
        uses,
        [
            ("a", FrameRole::TfParent),
            ("a", FrameRole::TfChild),
            ("odom", FrameRole::Header)
        ]
    );
}

#[test]
fn long_series_are_thinned_evenly_and_counted_wholly() {
    let bag = evidence(
        "
        duration_s: 100
        topics:
          - {topic: /tf, rate_hz: 100, transforms: [{parent: a, child: b, velocity: [1, 0, 0]}]}
        ",
    );
    let edge = &bag.tf[0];
    assert_eq!((edge.count, edge.stamps.count), (10_000, 10_000));
    assert!((256..=512).contains(&edge.samples.len()), "{}", edge.samples.len());
    assert!((1024..=2048).contains(&edge.stamps.samples.len()));
    assert_eq!(
        (edge.samples[0].at.index, edge.samples.last().unwrap().at.index),
        (0, 9_999)
    );
    let stride = edge.samples[1].at.index;
    assert!(
        edge.samples
            .iter()
            .rev()
            .skip(1)
            .all(|sample| sample.at.index % stride == 0)
    );
    assert_eq!(
        (edge.stamps.median_step_ns, edge.stamps.first.as_ref().unwrap().index),
        (Some(10_000_000), 0)
    );
}
