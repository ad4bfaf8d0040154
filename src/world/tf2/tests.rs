//! The documented behaviours of tf2, one by one, and the closed forms of interpolation. tests/tf2_reference.rs runs the
//! real one.

#![allow(clippy::float_cmp)] // sums of small whole numbers and halves are exact

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::{Buffer, DEFAULT_CACHE_NS, Extrapolation, IncomingTransform, Lookup, LookupError, Rejection, SampleOrigin};
use crate::world::claim::Pose;
use crate::world::frame::FrameId;

const S: i64 = 1_000_000_000;
const UPRIGHT: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// A transform along x at a second.
fn at<'a>(parent: &'a str, child: &'a str, second: i64, x: f64) -> IncomingTransform<'a> {
    IncomingTransform {
        parent,
        child,
        stamp_ns: second * S,
        translation_m: [x, 0.0, 0.0],
        rotation_xyzw: UPRIGHT,
        is_static: false,
        tag: 0,
    }
}

fn mount<'a>(parent: &'a str, child: &'a str, x: f64) -> IncomingTransform<'a> {
    IncomingTransform {
        is_static: true,
        ..at(parent, child, 0, x)
    }
}

fn filled<'a>(cache_ns: Option<i64>, transforms: impl IntoIterator<Item = IncomingTransform<'a>>) -> Buffer {
    let mut buffer = Buffer::new(cache_ns);
    for transform in transforms {
        buffer.insert(&transform).unwrap();
    }
    buffer
}

fn x(found: Result<Lookup, LookupError>) -> f64 {
    found.unwrap().target_from_source.translation.x
}

fn kind(found: Result<Lookup, LookupError>) -> String {
    match found {
        Ok(found) => format!("{}", found.target_from_source.translation.x),
        Err(LookupError::Extrapolation { what, .. }) => match what {
            Extrapolation::Past { .. } => "past".to_owned(),
            Extrapolation::Future { .. } => "future".to_owned(),
            Extrapolation::Single { .. } => "single".to_owned(),
        },
        Err(error) => error.exception().to_owned(),
    }
}

#[test]
fn faulty_transforms_are_dropped_with_the_word_of_tf2() {
    let mut buffer = Buffer::new(None);
    let mut word = |sent: IncomingTransform<'_>| buffer.insert(&sent).map_or_else(Rejection::word, |()| "ok");
    let good = at("a", "b", 1, 0.0);
    assert_eq!(word(at("/a", "a", 1, 0.0)), "TF_SELF_TRANSFORM");
    assert_eq!(word(at("a", "/", 1, 0.0)), "TF_NO_CHILD_FRAME_ID");
    assert_eq!(word(at("", "b", 1, 0.0)), "TF_NO_FRAME_ID");
    assert_eq!(word(at("a", "b", 1, f64::NAN)), "TF_NAN_INPUT");
    let turned = |rotation_xyzw| IncomingTransform { rotation_xyzw, ..good };
    assert_eq!(word(turned([0.0; 4])), "TF_DENORMALIZED_QUATERNION");
    // | |q|² - 1 | of just under and over 0.01.
    assert_eq!(word(turned([0.0, 0.0, 0.0, 1.0051])), "TF_DENORMALIZED_QUATERNION");
    assert_eq!(word(turned([0.0, 0.0, 0.0, 1.0049])), "ok");
    // Nothing that was dropped made a frame known.
    let names: Vec<&str> = buffer.frames().map(FrameId::as_str).collect();
    assert_eq!(names, ["b", "a"]);
}

#[test]
fn an_equal_transform_is_a_repetition_and_another_value_of_its_stamp_is_not() {
    let mut buffer = filled(None, [at("a", "b", 1, 1.0), at("a", "b", 2, 2.0)]);
    assert_eq!(buffer.insert(&at("a", "b", 2, 2.0)), Err(Rejection::Repeated));
    assert_eq!(buffer.insert(&at("a", "b", 2, 5.0)), Ok(()));
    // The later one answers.
    assert_eq!(x(buffer.lookup("a", "b", 2 * S)), 5.0);
    assert_eq!(
        x(buffer.lookup("a", "b", 3 * S / 2)),
        1.5,
        "up to the stamp the earlier one is the neighbour"
    );
}

#[test]
fn the_cache_drops_what_is_older_than_its_length() {
    let mut buffer = filled(Some(DEFAULT_CACHE_NS), (0..=30).map(|s| at("a", "b", 100 + s, 0.0)));
    // What arrives prunes by the stamps that came before it.
    assert_eq!(buffer.span_ns(&FrameId::new("b")), Some((119 * S, 130 * S)));
    assert_eq!(buffer.insert(&at("a", "b", 119, 1.0)), Err(Rejection::Old));
    assert_eq!(buffer.insert(&at("a", "b", 120, 1.0)), Ok(()));
    assert_eq!(kind(buffer.lookup("a", "b", 119 * S)), "past");
    let unlimited = filled(None, (0..=30).map(|s| at("a", "b", 100 + s, 0.0)));
    assert_eq!(kind(unlimited.lookup("a", "b", 101 * S)), "0");
}

#[test]
fn there_is_no_extrapolation() {
    let mut buffer = filled(None, [at("a", "b", 10, 1.0)]);
    assert_eq!(kind(buffer.lookup("a", "b", 10 * S)), "1");
    assert_eq!(kind(buffer.lookup("a", "b", 11 * S)), "single");
    buffer.insert(&at("a", "b", 20, 2.0)).unwrap();
    assert_eq!(kind(buffer.lookup("a", "b", 10 * S)), "1");
    assert_eq!(kind(buffer.lookup("a", "b", 20 * S)), "2");
    assert_eq!(kind(buffer.lookup("a", "b", 15 * S)), "1.5");
    assert_eq!(kind(buffer.lookup("a", "b", 20 * S + 1)), "future");
    let early = buffer.lookup("a", "b", 10 * S - 1).unwrap_err();
    assert_eq!(
        early.to_string(),
        "Lookup would require extrapolation into the past.  Requested time 9.999999999 but the earliest data is at time \
         10.000000000, when looking up transform from frame [b] to frame [a]"
    );
    // Static transforms hold at all times.
    let mounted = filled(None, [mount("a", "b", 3.0)]);
    assert_eq!(kind(mounted.lookup("a", "b", 1)), "3");
}

/// The key is the child alone.
#[test]
fn a_second_parent_takes_the_child_over_and_nothing_is_interpolated_across() {
    let buffer = filled(
        None,
        [at("a", "c", 10, 1.0), at("b", "c", 20, 2.0), at("b", "c", 30, 4.0)],
    );
    let found = buffer.lookup("a", "c", 19 * S).unwrap();
    assert_eq!(found.target_from_source.translation.x, 1.0, "the older sample stands");
    assert_eq!(found.factors[0].made_from, SampleOrigin::Sample(10 * S));
    assert_eq!(kind(buffer.lookup("b", "c", 19 * S)), "ConnectivityException");
    assert_eq!(kind(buffer.lookup("b", "c", 25 * S)), "3");
    assert_eq!(kind(buffer.lookup("a", "c", 25 * S)), "ConnectivityException");
    let parents: Vec<&FrameId> = buffer.parents_ever(&FrameId::new("c"));
    assert_eq!(parents, [&FrameId::new("a"), &FrameId::new("b")]);
}

#[test]
fn a_change_of_kind_erases_the_history() {
    let mut buffer = filled(
        None,
        [at("a", "b", 10, 1.0), at("a", "b", 20, 2.0), mount("a", "b", 9.0)],
    );
    assert_eq!(kind(buffer.lookup("a", "b", 12 * S)), "9");
    buffer.insert(&at("a", "b", 30, 3.0)).unwrap();
    assert_eq!(kind(buffer.lookup("a", "b", 12 * S)), "single");
}

#[test]
fn zero_asks_for_the_latest_common_stamp() {
    let buffer = filled(
        None,
        [
            at("map", "odom", 10, 1.0),
            at("map", "odom", 14, 5.0),
            at("odom", "base", 10, 0.0),
            at("odom", "base", 20, 10.0),
            mount("base", "lidar", 0.5),
            at("map", "marker", 12, 100.0),
        ],
    );
    let found = buffer.lookup("map", "lidar", 0).unwrap();
    assert_eq!(found.stamp_ns, 14 * S);
    assert_eq!(found.target_from_source.translation.x, 5.0 + 4.0 + 0.5);
    // Across the tree, the edges above the meeting point count no more.
    let found = buffer.lookup("base", "lidar", 0).unwrap();
    assert_eq!((found.stamp_ns, found.target_from_source.translation.x), (0, 0.5));
    let found = buffer.lookup("marker", "odom", 0).unwrap();
    assert_eq!(
        (found.stamp_ns, found.target_from_source.translation.x),
        (12 * S, 3.0 - 100.0)
    );
    assert_eq!(buffer.lookup("odom", "odom", 0).unwrap().stamp_ns, 14 * S);
}

#[test]
fn names_fail_as_in_tf2() {
    let buffer = filled(None, [mount("map", "odom", 1.0), mount("/x", "y", 1.0)]);
    let text = |target: &str, source: &str| {
        let error = buffer.lookup(target, source, S).unwrap_err();
        format!("{}: {error}", error.exception())
    };
    assert_eq!(
        text("Map", "odom"),
        "LookupException: \"Map\" passed to lookupTransform argument target_frame does not exist."
    );
    assert!(text("map", "/odom").starts_with("InvalidArgumentException: Invalid argument \"/odom\" passed to"));
    assert!(text("map", "").starts_with("InvalidArgumentException"));
    assert!(text("map", "y").starts_with("ConnectivityException: Could not find a connection between 'map' and 'y'"));
    // One frame is never looked at.
    assert_eq!(kind(buffer.lookup("nobody", "nobody", S)), "0");
    assert_eq!(kind(buffer.lookup("/odd", "/odd", S)), "0");
}

#[test]
fn loops_and_chains_of_more_than_a_thousand_end() {
    let ring = filled(None, [mount("a", "b", 1.0), mount("b", "a", 1.0), mount("t", "u", 1.0)]);
    assert_eq!(ring.lookup("t", "a", S), Err(LookupError::Loop));
    assert_eq!(ring.lookup("t", "a", 0), Err(LookupError::Loop));
    assert_eq!(ring.lookup("a", "u", S), Err(LookupError::Loop));
    let names: Vec<String> = (0..=1001).map(|n| format!("f{n}")).collect();
    let chain = filled(None, names.windows(2).map(|pair| mount(&pair[0], &pair[1], 1.0)));
    assert_eq!(kind(chain.lookup("f0", "f1000", S)), "1000");
    assert_eq!(chain.lookup("f0", "f1001", S), Err(LookupError::Loop));
}

#[test]
fn a_gap_above_both_frames_does_no_harm() {
    let buffer = filled(
        None,
        [
            at("map", "odom", 10, 1.0),
            at("map", "odom", 11, 1.0),
            mount("odom", "a", 1.0),
            mount("odom", "b", 3.0),
        ],
    );
    assert_eq!(kind(buffer.lookup("a", "b", 50 * S)), "2");
    assert_eq!(kind(buffer.lookup("odom", "b", 50 * S)), "3");
    assert_eq!(kind(buffer.lookup("map", "b", 50 * S)), "future");
    assert_eq!(kind(buffer.lookup("b", "map", 5 * S)), "past");
}

fn poses() -> impl Strategy<Value = Isometry3<f64>> {
    (
        prop::array::uniform3(-10.0..10.0f64),
        prop::array::uniform3(-1.0..1.0f64),
        -3.1..3.1f64,
    )
        .prop_filter_map("an axis", |(t, axis, angle)| {
            let axis = nalgebra::Unit::try_new(Vector3::from(axis), 1e-3)?;
            Some(Isometry3::from_parts(
                Translation3::from(t),
                UnitQuaternion::from_axis_angle(&axis, angle),
            ))
        })
}

fn sent<'a>(parent: &'a str, child: &'a str, second: i64, pose: &Isometry3<f64>) -> IncomingTransform<'a> {
    let pose = Pose::from_isometry(pose);
    IncomingTransform {
        translation_m: pose.translation_m,
        rotation_xyzw: pose.rotation_xyzw,
        ..at(parent, child, second, 0.0)
    }
}

fn distance(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    let angle = (a.rotation.inverse() * b.rotation).scaled_axis().norm();
    (a.translation.vector - b.translation.vector).norm() + angle
}

proptest! {
    /// SLERP is the geodesic: a share `s` of the way turns by `s` times the angle about the one axis.
    #[test]
    fn between_two_samples_the_way_is_straight_and_even(a in poses(), b in poses(), share in 1..1000i64) {
        let buffer = filled(None, [sent("p", "c", 100, &a), sent("p", "c", 101, &b)]);
        let found = buffer.lookup("p", "c", 100 * S + share * S / 1000).unwrap();
        let s = share as f64 / 1000.0;
        let turn = (a.rotation.inverse() * b.rotation).scaled_axis();
        let straight = a.translation.vector * (1.0 - s) + b.translation.vector * s;
        let expected = Isometry3::from_parts(straight.into(), a.rotation * UnitQuaternion::from_scaled_axis(turn * s));
        prop_assert!(distance(&found.target_from_source, &expected) < 1e-7, "{:?} {:?}", found.target_from_source, expected);
    }

    /// Any two frames of a tree: the product of the factors, the inverse, and the way over a third frame.
    #[test]
    fn lookups_compose(poses in prop::collection::vec(poses(), 8), parents in prop::collection::vec(0..100usize, 4)) {
        let names = ["f0", "f1", "f2", "f3", "f4"];
        let mut buffer = Buffer::new(None);
        for (child, pair) in (1..names.len()).zip(poses.chunks(2)) {
            let parent = names[parents[child - 1] % child];
            buffer.insert(&sent(parent, names[child], 100, &pair[0])).unwrap();
            buffer.insert(&sent(parent, names[child], 102, &pair[1])).unwrap();
        }
        let get = |a: &str, b: &str| buffer.lookup(a, b, 101 * S).unwrap().target_from_source;
        for a in names {
            for b in names {
                let found = buffer.lookup(a, b, 101 * S).unwrap();
                let product = found.factors.iter().fold(Isometry3::identity(), |product, factor| product * factor.value());
                prop_assert!(distance(&product, &found.target_from_source) < 1e-9);
                prop_assert!(distance(&get(b, a).inverse(), &found.target_from_source) < 1e-7);
                // The names cancel from end to end.
                let mut at = FrameId::new(a);
                for factor in &found.factors {
                    let (target, source) = factor.frames();
                    prop_assert_eq!(target, &at);
                    at = source.clone();
                }
                prop_assert_eq!(at, FrameId::new(b));
                for c in names {
                    prop_assert!(distance(&(get(a, c) * get(c, b)), &found.target_from_source) < 1e-6);
                }
            }
        }
    }
}
