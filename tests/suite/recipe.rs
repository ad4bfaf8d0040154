//! The recipes of the other tests say what they mean: knobs, and unknown keys.

#![allow(clippy::indexing_slicing, clippy::float_cmp)]

use crate::support::recipe::Recipe;
use crate::support::{edge, evidence};
use frames_lint::world::Pose;

#[test]
fn unknown_keys_are_errors() {
    for wrong in [
        "{topic: /t, type: acme/msg/A, velocty: [1, 0, 0]}",
        "{topic: /tf, transforms: [{parent: a, child: b, velocty: [1, 0, 0]}]}",
        "{topic: /t, type: acme/msg/A, qos: {durabilty: volatile}}",
        "{topic: /t, type: acme/msg/A, jumps: [{at: 3}]}",
        "{topic: /tf, transforms: [{parent: a, child: b, alternate: {to: [1, 0, 0]}}]}",
    ] {
        let text = format!("topics: [{wrong}]");
        assert!(std::panic::catch_unwind(|| Recipe::parse(&text)).is_err(), "{wrong}");
    }
}

fn poses(transform: &str) -> Vec<Pose> {
    let bag = evidence(&format!(
        "topics: [{{topic: /tf, rate_hz: 1, transforms: [{{parent: odom, child: base, {transform}}}]}}]"
    ));
    edge(&bag, "odom", "base")
        .samples
        .iter()
        .map(|sample| sample.pose)
        .collect()
}

#[test]
fn a_jump_moves_the_rest_of_the_drive() {
    let poses = poses("velocity: [1, 0, 0], jumps: [{at_s: 3, by: [0, 5, 0]}, {at_s: 6, yaw_deg: 90}]");
    assert_eq!(poses[2].translation_m, [2.0, 0.0, 0.0]);
    assert_eq!(poses[3].translation_m, [3.0, 5.0, 0.0]);
    // Turned about where it stood at second 6, and driving on to the left.
    let [x, y, _] = poses[8].translation_m;
    assert!((x - 6.0).abs() < 1e-12 && (y - 7.0).abs() < 1e-12, "{:?}", poses[8]);
    let yaw = 2.0 * poses[8].rotation_xyzw[2].asin().to_degrees();
    assert!((yaw - 90.0).abs() < 1e-9, "{yaw}");
}

#[test]
fn two_writers_take_turns_and_noise_is_the_same_every_time() {
    let turns = poses("alternate: {by: [0, 0, 1], yaw_deg: 10}");
    assert_eq!(turns[0], Pose::IDENTITY);
    assert_eq!(turns[1].translation_m, [0.0, 0.0, 1.0]);
    assert_eq!(turns[2], Pose::IDENTITY);
    let noisy = poses("noise_m: 0.1");
    assert_eq!(noisy, poses("noise_m: 0.1"));
    assert!(noisy.windows(2).all(|pair| pair[0] != pair[1]));
    let wobble = poses("wobble_m: 2, wobble_hz: 0.25");
    assert!((wobble[1].translation_m[0] - 2.0).abs() < 1e-12);
}

#[test]
fn clocks_drift_scatter_and_repeat() {
    let stamps = |knobs: &str| {
        let bag = evidence(&format!(
            "{{start_s: 1000, topics: [{{topic: /t, type: acme/msg/A, rate_hz: 1, {knobs}}}]}}"
        ));
        let samples = bag.topics["/t"].stamps.samples.clone();
        samples.iter().map(|(stamp, log)| stamp - log).collect::<Vec<i64>>()
    };
    assert_eq!(stamps("stamp_drift_ppm: 100")[9], 900_000);
    assert_eq!(
        stamps("stamp_repeat: 3")[..6],
        [0, -1, -2, 0, -1, -2].map(|s| s * 1_000_000_000)
    );
    let jitter = stamps("stamp_jitter_s: 0.01");
    assert!(jitter.iter().all(|ns| ns.abs() <= 10_000_000) && jitter.iter().any(|ns| ns.abs() > 1_000_000));
    assert_eq!(stamps("from_s: 2, until_s: 5").len(), 3);
}

#[test]
fn durability_is_said_in_four_ways() {
    let bag = evidence(
        "
        topics:
          - {topic: /a, type: acme/msg/A, latched: true}
          - {topic: /b, type: acme/msg/A, qos: {durability: transient_local}}
          - {topic: /c, type: acme/msg/A, durability: transient_local}
          - {topic: /d, type: acme/msg/A}
        ",
    );
    let latched: Vec<bool> = bag.topics.values().map(|topic| topic.latched).collect();
    assert_eq!(latched, [true, true, true, false]);
}
