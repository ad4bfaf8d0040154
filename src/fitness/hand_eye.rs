//! Hand-eye: two streams of poses of bodies that are rigidly connected, `A X = X B`.

use nalgebra::UnitQuaternion;

use crate::analysis::Estimates;
use crate::analysis::motion::{Motion, Orientations, Stream, edge_subject};
use crate::analysis::names;
use crate::math::excitation::{BodyRotation, LEAST_RAD, rotations};
use crate::math::stats::median;
use crate::rules::codes;
use crate::verdict::{Measured, Verdict};
use crate::world::BagEvidence;
use crate::world::motion::PoseRow;

use super::conditions::{Absence, absent, clocks, initial_guess, rate, together};
use super::excited::{self, Body};
use super::stamped::Stamped;
use super::{Condition, Pair, best};

/// Time that both must be recorded, seconds.
const LEAST_S: f64 = 20.0;
const LEAST_HZ: f64 = 2.0;
/// Longest duration of a rotation, seconds.
const LONGEST_S: f64 = 30.0;
/// Longest step between two poses, seconds.
const MAX_STEP_S: f64 = 1.0;
/// Median difference between the angles of both bodies up to which they are one rigid body, radians (2 degrees), and the rotations that
/// decide it.
const MAX_APART_RAD: f64 = 0.034_906_585;
const LEAST_COMPARED: usize = 5;
/// Streams that are paired.
const MAX_STREAMS: usize = 16;

const MOVE: &str = "rotate the sensors by 20 deg and more about each of three axes (roll, pitch, yaw), as one rigid body; a vehicle on flat \
                    ground cannot: calibrate it on a ramp, by hand or on an arm";

pub(super) fn all(world: &Estimates, verdict: &Verdict) -> Vec<Pair> {
    let motion = Motion::of(world);
    let each = motion.bags.iter().zip(&world.bags).map(|(of, bag)| {
        let streams: Vec<&Stream<PoseRow>> = of
            .poses
            .iter()
            .filter(|poses| is_of_a_body(bag, poses))
            .take(MAX_STREAMS)
            .collect();
        let pairs = streams
            .iter()
            .enumerate()
            .flat_map(|(at, a)| streams.iter().skip(at + 1).map(move |b| [*a, *b]));
        let pairs: Vec<[&Stream<PoseRow>; 2]> = pairs.filter(|[a, b]| are_of_two(a, b)).collect();
        best(pairs.into_iter().map(|[a, b]| pair(world, verdict, bag, [a, b]))).ok_or(streams.len())
    });
    let found: Vec<Result<Pair, usize>> = each.collect();
    let most = found
        .iter()
        .filter_map(|found| found.as_ref().err())
        .max()
        .copied()
        .unwrap_or_default();
    let pairs: Vec<Pair> = found.into_iter().flatten().collect();
    if !pairs.is_empty() {
        return pairs;
    }
    let lacks = match most {
        0 => "no stream of poses with orientations in the recording".to_owned(),
        1 => "one stream of poses with orientations in the recording: those of a second body are missing".to_owned(),
        _ => format!("{most} streams of poses in the recording, all of the same body"),
    };
    let asks = "poses of two bodies, each in a frame that does not move with them: topics, or moving transforms from a world frame";
    let record =
        "record the poses of both sensors: odometry of each by itself, or a tracker and the sensor's own poses";
    vec![absent(world, asks, &Absence { lacks, is_sure: true }, record)]
}

/// Whether a stream may be the poses of a sensor: joints, plans and Earth-centred places are not.
fn is_of_a_body(bag: &BagEvidence, poses: &Stream<PoseRow>) -> bool {
    let is_edge = bag.tf.iter().any(|edge| edge_subject(edge) == poses.subject);
    let oriented = Orientations::of(poses).runs.iter().map(Vec::len).sum::<usize>();
    oriented > 1
        && !poses.is_earth_centred()
        && !names::is_wish(&poses.topic)
        && (!is_edge || poses.is_of_world())
        && !poses.child.as_ref().is_some_and(names::is_world)
}

/// Whether two streams may be of different bodies.
fn are_of_two(a: &Stream<PoseRow>, b: &Stream<PoseRow>) -> bool {
    match (&a.child, &b.child) {
        (Some(a), Some(b)) => a != b,
        _ => a.topic != b.topic,
    }
}

fn pair(world: &Estimates, verdict: &Verdict, bag: &BagEvidence, [a, b]: [&Stream<PoseRow>; 2]) -> Pair {
    let [first, second] = [a, b].map(|poses| Stamped::of_poses(bag, poses));
    let [turned, other] = [a, b].map(Orientations::of);
    let near = |a: &(f64, UnitQuaternion<f64>), b: &(f64, UnitQuaternion<f64>)| b.0 - a.0 <= MAX_STEP_S;
    let runs = turned.runs.iter().flat_map(|run| run.chunk_by(near));
    let turns: Vec<BodyRotation> = runs.flat_map(|run| rotations(run, LEAST_RAD, LONGEST_S)).collect();
    let frame = a
        .child
        .as_ref()
        .map_or_else(|| format!("the body of {}", a.subject), |child| format!("`{child}`"));
    let body = Body {
        frame,
        from_stream: UnitQuaternion::identity(),
    };
    let mut conditions = vec![
        together([&first, &second], LEAST_S),
        rate(&first, LEAST_HZ),
        rate(&second, LEAST_HZ),
        clocks(
            verdict,
            &[codes::TIME02, codes::TIME03, codes::TIME04, codes::TIME09],
            &[&first, &second],
        ),
        rigid(&turns, &other),
    ];
    conditions.extend(excited::conditions(bag, &turns, &body, MOVE));
    conditions.push(initial_guess(world, [a.child.as_ref(), b.child.as_ref()]));
    (format!("{} and {}", a.subject, b.subject), conditions)
}

/// Whether both rotate by the same angles at the same times, as one rigid body does.
fn rigid(turns: &[BodyRotation], other: &Orientations) -> Condition {
    let (name, asks) = (
        "rigid",
        format!(
            "both rotate by the same angles at the same time, to {:.0} deg (median)",
            MAX_APART_RAD.to_degrees()
        ),
    );
    let apart = turns.iter().filter_map(|turn| {
        let [from, to] = turn.span_s.map(|t_s| other.at(t_s, MAX_STEP_S));
        Some(((from?.inverse() * to?).angle() - turn.vector.norm()).abs())
    });
    let apart: Vec<f64> = apart.collect();
    let record = "mount both sensors on one rigid body, with synchronised clocks";
    let Some(middle) = median(&apart).filter(|_| apart.len() >= LEAST_COMPARED) else {
        let why = format!(
            "{} rotations with poses of both; {LEAST_COMPARED} are needed",
            apart.len()
        );
        return Condition::open(name, asks, why).record("rotate while the poses of both are recorded");
    };
    let degrees =
        Measured::new("difference of their angles", middle.to_degrees(), "deg").limit(MAX_APART_RAD.to_degrees());
    Condition::judged(name, asks, middle <= MAX_APART_RAD)
        .measured(degrees.samples(apart.len() as u64))
        .because(format!(
            "their angles differ by {:.1} deg: they move to each other, or their clocks differ",
            middle.to_degrees()
        ))
        .record(record)
}
