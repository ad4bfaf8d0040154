//! CROSS07: what a calibration calls its sensors, and which frames of the platform these are by their transform.

use nalgebra::Isometry3;

use crate::analysis::names::{has_word, has_word_of};
use crate::analysis::{cross::exact, names};
use crate::math::relation::{Classification, Relation, Tolerance, classify};
use crate::rules::prelude::*;
use crate::source::{Confidence, SourceId};
use crate::world::{Claim, ClaimKind, FrameId, World, graph::FrameGraph};

pub(crate) struct FrameAliases;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    equal_deg: f64,
    equal_m: f64,
    plain_deg: f64,
    plain_m: f64,
    max_pairs: f64,
}

impl Rule for FrameAliases {
    const PAGE: &'static str = include_str!("../../../rules/cross/frame-aliases.md");
    const NEEDS: &'static [Need] = &[Need::Calibration];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let graph = world.graph();
        let aliases = &world.conventions.aliases;
        let exact = world.limits::<exact::Limits>();
        let mut suspected: Vec<Suspicion> = Vec::new();
        for claim in &world.claims {
            let confirmed = claim.frames.iter().flat_map(|(target, source)| [target, source]);
            let confirmed = confirmed
                .filter(|frame| aliases.iter().any(|alias| alias.frame == **frame))
                .count();
            if let (ClaimKind::File { roles: false, .. }, 1..) = (&claim.kind, confirmed) {
                let subject = format!("frames of `{}` of {}", claim.label, world.path(claim.place.source));
                out.pass(subject, [Measured::count("frames that an alias confirms", confirmed)]);
                continue;
            }
            let (ClaimKind::File { roles, dialect }, Some((target, source)), Some(pose)) =
                (&claim.kind, &claim.frames, &claim.pose)
            else {
                continue;
            };
            // A key whose reading is a guess may as well mean the other direction.
            let is_read = *roles || claim.reading > Confidence::Hint;
            let is_whole = claim.has_rotation && claim.has_translation && is_read;
            let is_known = |frame: &FrameId| graph.frames.contains(&frame.canonical());
            // Frames of one name are compared by CROSS01 and CROSS02.
            if !is_whole || is_known(target) && is_known(source) {
                continue;
            }
            let names = (target, source);
            let limits = (limits, &*exact);
            suspected.extend(judge_claim(world, claim, (dialect, *roles), names, &pose.isometry(), limits, out));
        }
        let kinds: Vec<_> = suspected.iter().map(Suspicion::kind).collect();
        for mut suspicion in suspected {
            let alike = kinds.iter().filter(|kind| **kind == suspicion.kind()).count();
            if !suspicion.is_exact && alike < exact.min_sensors {
                suspicion.finding.severity = Severity::Warning;
                suspicion.finding = suspicion.finding.hint();
            }
            out.fail(suspicion.finding);
        }
    }
}

/// A transform that may be another one with a convention error.
struct Suspicion {
    file: SourceId,
    relation: Relation,
    /// Whether the numbers alone tell.
    is_exact: bool,
    finding: Finding,
}

impl Suspicion {
    fn kind(&self) -> (SourceId, Relation) {
        (self.file, self.relation)
    }
}

/// A pair of the platform's frames that may be meant.
struct Candidate<'g> {
    target: &'g FrameId,
    source: &'g FrameId,
    pose: Isometry3<f64>,
}

fn judge_claim(
    world: &World,
    claim: &Claim,
    (dialect, roles): (&str, bool),
    (target, source): (&FrameId, &FrameId),
    pose: &Isometry3<f64>,
    (limits, exact): (&Limits, &exact::Limits),
    out: &mut Judge,
) -> Option<Suspicion> {
    let path = world.path(claim.place.source);
    let subject = format!("`{target}` and `{source}` of `{}` of {path}", claim.label);
    let mut candidates = candidates(world.graph(), target, source);
    if !candidates.iter().any(|candidate| is_met(candidate, pose, exact)) {
        let by_numbers = by_numbers(world.graph(), target, source, pose, exact);
        if !by_numbers.is_empty() {
            candidates = by_numbers;
        }
    }
    if candidates.is_empty() {
        out.missing(subject, "no frames of the platform have names of these kinds and a rigid transform between them");
        return None;
    }
    if candidates.len() as f64 > limits.max_pairs {
        let why = format!(
            "{} pairs of frames may be meant: `aliases:` in frames-lint.yaml says which",
            candidates.len()
        );
        out.too_little(subject, why);
        return None;
    }
    let off = |candidate: &Candidate| {
        let difference = candidate.pose.inv_mul(pose);
        (
            difference.rotation.angle().to_degrees(),
            difference.translation.vector.norm(),
        )
    };
    let is_plain = |pose: &Isometry3<f64>| {
        pose.rotation.angle().to_degrees() <= limits.plain_deg && pose.translation.vector.norm() <= limits.plain_m
    };
    let equal: Vec<&Candidate> = candidates
        .iter()
        .filter(|candidate| {
            let (deg, m) = off(candidate);
            deg <= limits.equal_deg && m <= limits.equal_m
        })
        .collect();
    let measured = |(deg, m): (f64, f64)| {
        [
            Measured::new("rotation difference", deg, "deg").limit(limits.equal_deg),
            Measured::new("translation difference", m, "m").limit(limits.equal_m),
        ]
    };
    match (equal.as_slice(), candidates.as_slice()) {
        ([one], _) if !roles && !is_plain(&one.pose) => out.pass(subject, measured(off(one))),
        ([one], _) if !is_plain(&one.pose) => {
            let names = (target, source);
            let [turn, shift] = measured(off(one));
            let finding = proposal(world, claim, subject, dialect, names, one);
            out.fail(finding.measured(turn).measured(shift));
        }
        ([], _) => {
            let related = candidates.iter().filter(|candidate| !is_plain(&candidate.pose));
            let related = related.map(|candidate| (candidate, classify(&candidate.pose, pose, &Tolerance::default())));
            let related: Vec<_> = related.filter(|(_, found)| found.error().is_some()).collect();
            let fits = |(candidate, found): &&(&Candidate<'_>, Classification)| exact.fits(&candidate.pose, found);
            let exact: Vec<_> = related.iter().filter(fits).collect();
            let (is_exact, (candidate, found)) = match (exact.as_slice(), related.as_slice(), candidates.as_slice()) {
                ([one], ..) => (true, *one),
                (_, [one], [_]) if roles => (false, one),
                _ => {
                    out.too_little(subject, match candidates.as_slice() {
                        [only] => {
                            let (deg, m) = off(only);
                            format!(
                                "`{}` from `{}` differs by {deg:.2} deg and {m:.3} m, and no convention error explains that: other frames \
                                 may be meant",
                                only.target, only.source
                            )
                        }
                        several => format!(
                            "{} pairs of frames may be meant, and none has this transform: `aliases:` in frames-lint.yaml says which",
                            several.len()
                        ),
                    });
                    return None;
                }
            };
            let relation = found.error()?;
            let [turn, shift] = measured(off(candidate));
            let finding = suspicion(world, claim, subject, relation, (target, source), candidate);
            return Some(Suspicion {
                file: claim.place.source,
                relation,
                is_exact,
                finding: finding.measured(turn).measured(shift),
            });
        }
        _ => {
            out.too_little(subject, "several frames of the platform fit alike");
        }
    }
    None
}

/// The lines that confirm what two names stand for.
fn aliases((target, source): (&FrameId, &FrameId), candidate: &Candidate<'_>) -> String {
    let of = |frame: &FrameId, name: &FrameId| (frame != name).then(|| format!("{frame}: [{name}]"));
    let parts = [of(candidate.target, target), of(candidate.source, source)];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn proposal(
    world: &World,
    claim: &Claim,
    subject: String,
    dialect: &str,
    names: (&FrameId, &FrameId),
    candidate: &Candidate<'_>,
) -> Finding {
    let message = format!(
        "what {} ({dialect}) calls `{}` and `{}` are `{}` and `{}` by their transform",
        world.path(claim.place.source),
        names.0,
        names.1,
        candidate.target,
        candidate.source
    );
    Finding::note(subject, message, claim.place.clone()).hint().help(format!(
        "confirm it in frames-lint.yaml, and the file is held against the others with full confidence: aliases: {{{}}}",
        aliases(names, candidate)
    ))
}

fn suspicion(
    world: &World,
    claim: &Claim,
    subject: String,
    relation: Relation,
    names: (&FrameId, &FrameId),
    candidate: &Candidate<'_>,
) -> Finding {
    let message = format!(
        "`{}` and `{}` of {} taken for `{}` and `{}`: the file holds their transform with a convention error: {}",
        names.0,
        names.1,
        world.path(claim.place.source),
        candidate.target,
        candidate.source,
        relation.word()
    );
    Finding::error(subject, message, claim.place.clone())
        .likely()
        .relation(relation.word())
        .help(format!(
            "{} If these are the frames, say so in frames-lint.yaml (aliases: {{{}}}), and their transforms are compared",
            relation.describe(),
            aliases(names, candidate)
        ))
}

/// Every pair of the platform's frames of these kinds with a rigid transform between them.
fn candidates<'g>(graph: &'g FrameGraph, target: &FrameId, source: &FrameId) -> Vec<Candidate<'g>> {
    let mut found = Vec::new();
    for a in meant(graph, target) {
        for b in meant(graph, source) {
            if a == b {
                continue;
            }
            if let Some((pose, _)) = graph.chain(a, b, |edge| edge.is_rigid) {
                found.push(Candidate {
                    target: a,
                    source: b,
                    pose,
                });
            }
        }
    }
    found
}

/// Whether a transform is that of a candidate, as it is or with a convention error, to the last digits.
fn is_met(candidate: &Candidate<'_>, pose: &Isometry3<f64>, exact: &exact::Limits) -> bool {
    let difference = candidate.pose.inv_mul(pose);
    let is_equal = difference.rotation.angle().to_degrees() <= exact.exact_deg
        && difference.translation.vector.norm() <= exact.exact_m;
    let found = || classify(&candidate.pose, pose, &Tolerance::default());
    is_equal || Some(found()).is_some_and(|found| found.error().is_some() && exact.fits(&candidate.pose, &found))
}

/// Pairs of which one frame is of the right kind, and the other is called anything, whose transform is met to the last digits and not by
/// chance. One frame has to be of its kind: of two strangers nothing tells the direction.
fn by_numbers<'g>(
    graph: &'g FrameGraph,
    target: &FrameId,
    source: &FrameId,
    pose: &Isometry3<f64>,
    exact: &exact::Limits,
) -> Vec<Candidate<'g>> {
    let length_m = pose.translation.vector.norm();
    let mut found: Vec<Candidate<'g>> = Vec::new();
    let mut look = |target: &'g FrameId, source: &'g FrameId| {
        let Some((pose_of, _)) = graph.chain(target, source, |edge| edge.is_rigid) else { return };
        let candidate = Candidate { target, source, pose: pose_of };
        // What every convention error leaves as it is, comes first: it is cheap.
        let is_near = (candidate.pose.translation.vector.norm() - length_m).abs() <= exact.exact_m;
        // Frames in one place are one candidate.
        let is_new = |one: &Candidate| {
            let apart = one.pose.inv_mul(&candidate.pose);
            apart.rotation.angle().to_degrees() > exact.exact_deg || apart.translation.vector.norm() > exact.exact_m
        };
        if target != source && is_near && exact.tells_alone(&candidate.pose) && found.iter().all(is_new) && is_met(&candidate, pose, exact) {
            found.push(candidate);
        }
    };
    for target in meant(graph, target) {
        graph.frames.iter().for_each(|source| look(target, source));
    }
    for source in meant(graph, source) {
        graph.frames.iter().for_each(|target| look(target, source));
    }
    found
}

/// The platform's frames that a program's word for a sensor may mean.
fn meant<'g>(graph: &'g FrameGraph, role: &FrameId) -> Vec<&'g FrameId> {
    if let Some(own) = graph.frames.get(&role.canonical()) {
        return vec![own];
    }
    let of = |test: &dyn Fn(&FrameId) -> bool| graph.frames.iter().filter(|frame| test(frame)).collect::<Vec<_>>();
    let lidars: &[&[&str]] = &[names::LIDARS, names::LIDAR_MAKERS, &["velo", "os", "pandar"]];
    if has_word(role, names::CAMERAS) {
        let all = of(&|frame| has_word(frame, names::CAMERAS) || names::optical_stem(frame).is_some());
        // Programs that look through cameras mean the axes of images.
        let optical: Vec<&FrameId> = all
            .iter()
            .copied()
            .filter(|frame| names::optical_stem(frame).is_some())
            .collect();
        let cameras = if optical.is_empty() { all } else { optical };
        let numbered: Vec<&FrameId> = cameras
            .iter()
            .copied()
            .filter(|frame| number(frame) == number(role))
            .collect();
        return if numbered.is_empty() { cameras } else { numbered };
    }
    if has_word_of(role, lidars) {
        return of(&|frame| has_word_of(frame, lidars));
    }
    if has_word(role, &["imu", "body"]) {
        return of(&|frame| has_word(frame, names::IMUS));
    }
    if has_word(role, &["base", "ego", "egovehicle", "vehicle", "robot"]) {
        return of(&names::is_base);
    }
    Vec::new()
}

/// The number in a name, `0` and none alike.
fn number(frame: &FrameId) -> u32 {
    let digits = frame.tokens().into_iter().find_map(|token| {
        let start = token.find(|letter: char| letter.is_ascii_digit())?;
        token.get(start..)?.parse().ok()
    });
    digits.unwrap_or(0)
}
