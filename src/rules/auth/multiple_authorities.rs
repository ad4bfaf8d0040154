//! AUTH01: two programs publish one transform.

use std::collections::BTreeSet;

use crate::analysis::places::{self, published_reading};
use crate::math::stats::median;
use crate::rules::prelude::*;
use crate::world::graph::{Edge, FrameGraph};
use crate::world::{BagEvidence, World, bag::TfEdge, content::Step};

pub(crate) struct MultipleAuthorities;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_steps: u64,
    undone_count: u64,
    undone_share: f64,
    rare_share: f64,
    stands_out: f64,
    moves_deg: f64,
    moves_m: f64,
}

impl Rule for MultipleAuthorities {
    const NEEDS: &'static [Need] = &[Need::RobotTfOrLaunch];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for edge in &bag.tf {
                judge_edge(bag, edge, limits, out);
            }
        }
        for launched in world.launched() {
            judge_launched(world, launched, limits, out);
        }
    }
}

/// Transforms that a launch file publishes, and that a joint or another call states as well.
fn judge_launched(world: &World, launched: &FrameGraph, limits: &Limits, out: &mut Judge) {
    for edge in launched.edges.iter().filter(|edge| edge.is_published()) {
        let subject = format!("published `{}` from `{}`", edge.parent, edge.child);
        let twins = launched
            .edges_to(&edge.child)
            .filter(|other| other.parent == edge.parent);
        let others: Vec<&Edge> = twins.filter(|other| other.origin != edge.origin).collect();
        let count = Measured::count("publishers", 1 + others.len()).limit(1.0);
        let (Some(other), Some(place)) = (others.first(), places::of_edge(world, edge)) else {
            out.pass(subject, [count]);
            continue;
        };
        let is_second = others.iter().all(|other| other.origin < edge.origin);
        if !is_second {
            // Reported at the last one.
            continue;
        }
        let (who, by, help) = if other.is_published() {
            (
                "two static_transform_publishers",
                "the other call",
                "remove one of the two calls, and keep the right value",
            )
        } else {
            (
                "a static_transform_publisher and robot_state_publisher",
                "the joint",
                "remove the static_transform_publisher, and write the right value into the joint",
            )
        };
        let apart = edge.pose.zip(other.pose).map(|(a, b)| {
            let distance_m = (a.translation.vector - b.translation.vector).norm();
            (a.rotation.angle_to(&b.rotation).to_degrees(), distance_m)
        });
        let differ = apart.filter(|(deg, m)| *deg > limits.moves_deg || *m > limits.moves_m);
        let (severity, values, effect) = match differ {
            Some((deg, m)) => (
                Severity::Error,
                format!("{deg:.2} deg and {m:.3} m apart"),
                "listeners use the value that was published last",
            ),
            None => (
                Severity::Note,
                "with equal values".to_owned(),
                "a later change of one of the values makes them differ",
            ),
        };
        let message = format!("`{}` -> `{}` is published twice, {values}", edge.parent, edge.child);
        let mut finding = Finding::new(severity, subject, message, place)
            .likely()
            .confidence(published_reading(world, edge))
            .detail(format!("The publishers are {who}; {effect}."))
            .help(help)
            .measured(count);
        if !other.is_published() {
            finding = finding.unless(codes::CROSS02).unless(codes::CROSS01);
        }
        if let Some(place) = places::of_edge(world, other) {
            finding = finding.related(place, by);
        }
        out.fail(finding);
    }
}

fn judge_edge(bag: &BagEvidence, edge: &TfEdge, limits: &Limits, out: &mut Judge) {
    let subject = format!("TF `{}` from `{}` on `{}`", edge.parent, edge.child, edge.topic);
    // Names of anonymous nodes end in numbers.
    let programs: BTreeSet<&str> = edge.writers.keys().map(|name| stem(name)).collect();
    let share = edge.steps.undone as f64 / (edge.steps.count as f64).max(1.0);
    let known = Measured::count("publishers that the recording names", edge.writers.len());
    let undone = Measured::new("share of the steps that the next step undoes", share, "1").samples(edge.steps.count);
    let takes_turns = takes_turns(edge, share, limits);
    if !takes_turns && programs.len() < 2 {
        if edge.writers.is_empty() && edge.steps.count < limits.min_steps {
            out.too_little(
                subject,
                "the recording does not name the publishers, and has too few transforms to detect two",
            );
        } else {
            out.pass(subject, [known.limit(1.0), undone.limit(limits.undone_share)]);
        }
        return;
    }
    let (who, names) = match edge.writers.len() {
        0 | 1 => ("two publishers".to_owned(), String::new()),
        n => {
            let names: Vec<String> = edge.writers.keys().map(|name| format!("`{name}`")).collect();
            (
                format!("{n} publishers"),
                format!("The publishers are {}. ", names.join(" and ")),
            )
        }
    };
    let what = format!("`{}` -> `{}` on `{}`", edge.parent, edge.child, edge.topic);
    let keep_filter =
        "let only one node publish the transform, usually the filter: set `publish_tf: false` in the others";
    let (severity, message, how, help) = if takes_turns {
        let (undone, count) = (edge.steps.undone, edge.steps.count);
        let message = format!("{who} alternate on {what}: {undone} of {count} steps are reversed");
        let how = "The next step undoes each of these steps: listeners get two different series in turn.";
        (Severity::Error, message, how, keep_filter)
    } else if moves(edge, limits) {
        let message = format!("{what} has {who}");
        let how = "tf2 interpolates between all of their values, as if one node had published them.";
        (Severity::Warning, message, how, keep_filter)
    } else {
        let message = format!("the constant transform {what} has {who}");
        let how = "Their values are equal, until one publisher is changed.";
        let help = "let only one node publish the transform, usually robot_state_publisher: remove the transform from the others";
        (Severity::Note, message, how, help)
    };
    let measured = if takes_turns {
        let is_usual = share >= limits.undone_share;
        let least = if is_usual {
            limits.undone_share
        } else {
            limits.rare_share
        };
        [undone.limit(least), known]
    } else {
        [known.limit(1.0), undone]
    };
    let at = edge.steps.first_undone.as_ref().filter(|_| takes_turns);
    let place = at.map_or(&edge.first_at, |step| &step.after.at);
    let finding = Finding::new(severity, subject, message, Place::message(bag.source, place.clone()))
        .likely()
        .detail(format!("{names}{how}"))
        .help(help)
        .measured(measured);
    out.fail(finding);
}

/// The name of a publisher without the numbers that an anonymous node appends.
fn stem(name: &str) -> &str {
    name.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_')
}

/// Two series that alternate have steps back and forth: nearly all of the steps if both have one rate; if one is slow, few, but
/// much larger than the others.
fn takes_turns(edge: &TfEdge, share: f64, limits: &Limits) -> bool {
    let steps = &edge.steps;
    if edge.is_static || steps.count < limits.min_steps || steps.undone < limits.undone_count {
        return false;
    }
    let stands_out = || {
        let first = steps.first_undone.as_ref().map(|at| at.step);
        let usual = |of: fn(&Step) -> f64| median(&steps.sample.iter().map(of).collect::<Vec<f64>>()).unwrap_or(0.0);
        first.is_some_and(|step| {
            step.distance_m > (limits.stands_out * usual(|step| step.distance_m)).max(limits.moves_m)
                || step.angle_rad
                    > (limits.stands_out * usual(|step| step.angle_rad)).max(limits.moves_deg.to_radians())
        })
    };
    share >= limits.undone_share || (share >= limits.rare_share && stands_out())
}

fn moves(edge: &TfEdge, limits: &Limits) -> bool {
    edge.extreme.as_ref().is_some_and(|(_, angle_rad, distance_m)| {
        angle_rad.to_degrees() > limits.moves_deg || *distance_m > limits.moves_m
    })
}
