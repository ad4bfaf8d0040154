//! CROSS07: which frames of the robot a calibration means by its own names for sensors, by their transform.

use std::collections::BTreeMap;
use std::ops::Bound;

use nalgebra::Isometry3;

use crate::analysis::cross::aliases::{Candidate, FileTransforms, Search, StatedTransform};
use crate::analysis::cross::exact;
use crate::math::{relation::Relation, rotation};
use crate::rules::prelude::*;
use crate::source::{Confidence, SourceId};
use crate::world::transform_name::{self, NameStyle};
use crate::world::{Claim, ClaimKind, FrameId, Spelling, World};

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
    const NEEDS: &'static [Need] = &[Need::Calibration];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let exact = world.limits::<exact::Limits>();
        let asked = own_transforms(world, out);
        let search = Search::new(world, &exact);
        let mut suspected: Vec<Suspicion> = Vec::new();
        let mut found: Vec<(&OwnTransform, Vec<Candidate>)> = Vec::new();
        let mut of_files: BTreeMap<SourceId, FileTransforms> = BTreeMap::new();
        let mut asked_of: BTreeMap<SourceId, usize> = BTreeMap::new();
        for one in &asked {
            *asked_of.entry(one.claim.place.source).or_default() += 1;
            of_files.entry(one.claim.place.source).or_default().add(one.stated);
        }
        for one in &asked {
            let Some(of_file) = of_files.get(&one.claim.place.source) else {
                continue;
            };
            let candidates = search.candidates(&one.stated, of_file);
            if search.is_spent() {
                let why = "the robot has too many frames to try all pairs: name the frames with `aliases:` in frames-lint.yaml";
                out.too_little(one.subject(world), why);
                continue;
            }
            found.push((one, candidates));
        }
        let exchanged = exchanged(world, &found, limits);
        for (index, (one, candidates)) in found.iter().enumerate() {
            let Some(Exchange { with, base }) = exchanged.get(&index) else {
                suspected.extend(judge_claim(world, one, candidates, (limits, &exact), out));
                continue;
            };
            // One finding for both.
            if let Some((with, _)) = found.get(*with).filter(|_| index < *with) {
                out.fail(exchange(world, one, with, base));
            }
        }
        let mut kinds: Vec<_> = suspected.iter().map(Suspicion::kind).collect();
        kinds.sort_unstable();
        for mut suspicion in suspected {
            let kind = suspicion.kind();
            let alike = kinds.partition_point(|one| *one <= kind) - kinds.partition_point(|one| *one < kind);
            if !suspicion.is_exact && alike < exact.min_sensors {
                suspicion.finding.severity = Severity::Warning;
                suspicion.finding = suspicion.finding.hint();
            }
            let are_all = asked_of.get(&suspicion.file) == Some(&alike);
            if suspicion.is_of_keys && suspicion.relation == Relation::Inverse && alike > 1 && are_all {
                let detail = "All keys of the file are inverted in this way, so perhaps they are meant in that direction, and nothing is wrong.";
                suspicion.finding = suspicion.finding.hint().detail(detail);
            }
            out.fail(suspicion.finding);
        }
    }
}

/// The transforms of files between names that are not all frames of the robot. What aliases confirm passes.
fn own_transforms<'w>(world: &'w Estimates, out: &mut Judge) -> Vec<OwnTransform<'w>> {
    let graph = world.graph();
    let aliases = &world.conventions.aliases;
    let mut asked: Vec<OwnTransform> = Vec::new();
    for claim in &world.claims {
        let file = world.path(claim.place.source);
        let confirmed = claim.frames.iter().flat_map(|(target, source)| [target, source]);
        let confirmed = confirmed
            .filter(|frame| aliases.iter().any(|alias| alias.frame == **frame && alias.holds(file)))
            .count();
        if let (ClaimKind::File { roles: false, .. }, 1..) = (&claim.kind, confirmed) {
            let subject = format!("frames of `{}` of {file}", claim.label);
            out.pass(subject, [Measured::count("frames that an alias confirms", confirmed)]);
            continue;
        }
        let (ClaimKind::File { roles, dialect }, Some((target, source)), Some(pose)) =
            (&claim.kind, &claim.frames, &claim.pose)
        else {
            continue;
        };
        let is_known = |frame: &FrameId| graph.frames.contains(&frame.canonical());
        // A key whose reading is a guess may also mean the other direction. Which words are a frame is no guess where the robot has it.
        let is_prefix = || transform_name::parse(&claim.label).is_some_and(|name| name.style == NameStyle::Prefix);
        let is_split = || (is_known(target) || is_known(source)) && is_prefix();
        let is_read = *roles || claim.reading > Confidence::Hint || is_split();
        let is_whole = claim.has_rotation && claim.has_translation && is_read;
        // Frames of one name are compared by CROSS01 and CROSS02.
        if !is_whole || is_known(target) && is_known(source) {
            continue;
        }
        let stated = StatedTransform {
            target,
            source,
            pose: pose.isometry(),
            is_quaternion: matches!(claim.spelling, Spelling::Quaternion { .. }),
        };
        asked.push(OwnTransform {
            claim,
            dialect,
            roles: *roles,
            stated,
        });
    }
    asked
}

/// A transform that a file states between names of its own.
struct OwnTransform<'w> {
    claim: &'w Claim,
    dialect: &'w str,
    /// Whether the names are a program's names for its sensors.
    roles: bool,
    stated: StatedTransform<'w>,
}

/// A transform that may be another one with a convention error.
struct Suspicion {
    file: SourceId,
    relation: Relation,
    /// Whether the numbers alone show it.
    is_exact: bool,
    /// Whether only the keys state the direction.
    is_of_keys: bool,
    finding: Finding,
}

impl Suspicion {
    fn kind(&self) -> (SourceId, Relation) {
        (self.file, self.relation)
    }
}

impl OwnTransform<'_> {
    fn subject(&self, world: &World) -> String {
        let StatedTransform { target, source, .. } = self.stated;
        let path = world.path(self.claim.place.source);
        format!("`{target}` and `{source}` of `{}` of {path}", self.claim.label)
    }
}

/// The pairs of frames that have the transform as stated.
fn equal<'c, 'g>(candidates: &'c [Candidate<'g>], limits: &Limits) -> Vec<&'c Candidate<'g>> {
    let is_equal = |candidate: &&Candidate| candidate.is_within(limits.equal_deg, limits.equal_m);
    candidates.iter().filter(is_equal).collect()
}

/// Transforms of a file, and what was found for each.
type Found<'f, 'w> = (&'f OwnTransform<'w>, Vec<Candidate<'w>>);

/// A transform that has the numbers of another one of its file, and the other one its numbers.
struct Exchange<'g> {
    /// The index of the other one.
    with: usize,
    /// The robot's frame that both are relative to.
    base: &'g FrameId,
}

/// The transforms of two frames of the robot that a file states relative to one frame, each with the numbers of the other: by index, both ways.
fn exchanged<'w>(world: &'w World, found: &[Found<'_, 'w>], limits: &Limits) -> BTreeMap<usize, Exchange<'w>> {
    let rigid = world.graph().rigid();
    let mut named: BTreeMap<(SourceId, &FrameId), BTreeMap<&FrameId, usize>> = BTreeMap::new();
    for (index, (one, _)) in found.iter().enumerate() {
        if let Some(own) = world.graph().frames.get(&one.stated.source.canonical()) {
            let of_frame = named.entry((one.claim.place.source, one.stated.target)).or_default();
            of_frame.entry(own).or_insert(index);
        }
    }
    let is_near = |a: &Isometry3<f64>, b: &Isometry3<f64>| {
        rotation::is_near(a, b, [limits.equal_deg.to_radians(), limits.equal_m])
    };
    let mut exchanged = BTreeMap::new();
    for frames in named.values() {
        for (a, at_a) in frames {
            for (b, at_b) in frames.range::<&FrameId, _>((Bound::Excluded(a), Bound::Unbounded)) {
                let (Some((one, candidates)), Some((other, _))) = (found.get(*at_a), found.get(*at_b)) else {
                    continue;
                };
                let is_crossed = |base: &&FrameId| {
                    let both = rigid.between(base, a).zip(rigid.between(base, b));
                    both.is_some_and(|(of_a, of_b)| {
                        let is_crossed = is_near(&of_b, &one.stated.pose) && is_near(&of_a, &other.stated.pose);
                        is_crossed && !is_near(&of_a, &of_b)
                    })
                };
                if let Some(base) = candidates.iter().map(|candidate| candidate.target).find(is_crossed) {
                    exchanged.insert(*at_a, Exchange { with: *at_b, base });
                    exchanged.insert(*at_b, Exchange { with: *at_a, base });
                }
            }
        }
    }
    exchanged
}

/// The finding of two transforms of a file, each with the numbers of the other.
fn exchange(world: &World, one: &OwnTransform, with: &OwnTransform, base: &FrameId) -> Finding {
    let (a, b) = (one.stated.source, with.stated.source);
    let path = world.path(one.claim.place.source);
    let message = format!("the transforms of `{a}` and `{b}` are exchanged");
    Finding::error(one.subject(world), message, one.claim.place.clone())
        .likely()
        .relation("exchanged")
        .label(format!("`{a}`, with the transform of the robot's `{b}`"))
        .related(with.claim.place.clone(), format!("`{b}`, with the transform of the robot's `{a}`"))
        .detail(format!(
            "In {path}, `{a}` has the transform of the robot's `{b}`, and `{b}` has the transform of the robot's `{a}`, relative to `{base}`."
        ))
        .help("exchange the numbers of the two in the file; if the names in the URDF are exchanged, correct these instead")
        .measured(Measured::count("transforms with the numbers of the other", 2).limit(0.0))
}

fn judge_claim(
    world: &World,
    one: &OwnTransform,
    candidates: &[Candidate],
    (limits, exact): (&Limits, &exact::Limits),
    out: &mut Judge,
) -> Option<Suspicion> {
    let &OwnTransform {
        claim,
        dialect,
        roles,
        stated,
    } = one;
    let subject = one.subject(world);
    let (target, source) = (stated.target, stated.source);
    if candidates.is_empty() {
        out.missing(subject, "no two frames of the robot have such names and a rigid transform between them: name them with `aliases:` in frames-lint.yaml");
        return None;
    }
    if candidates.len() as f64 > limits.max_pairs {
        let why = format!(
            "{} pairs of frames may be meant: name the frames with `aliases:` in frames-lint.yaml",
            candidates.len()
        );
        out.too_little(subject, why);
        return None;
    }
    let is_plain = |pose: &Isometry3<f64>| {
        pose.rotation.angle().to_degrees() <= limits.plain_deg && pose.translation.vector.norm() <= limits.plain_m
    };
    let equal = equal(candidates, limits);
    let measured = |candidate: &Candidate| {
        [
            Measured::new("rotation difference, as written", candidate.off_deg, "deg").limit(limits.equal_deg),
            Measured::new("translation difference, as written", candidate.off_m, "m").limit(limits.equal_m),
        ]
    };
    match (equal.as_slice(), candidates) {
        ([one], _) if !roles && !is_plain(&one.pose) => out.pass(subject, measured(one)),
        ([one], _) if !is_plain(&one.pose) => {
            let names = (target, source);
            let finding = proposal(world, claim, subject, dialect, names, one);
            out.fail(finding.measured(measured(one)));
        }
        ([], _) => {
            let related = candidates.iter().filter(|candidate| !is_plain(&candidate.pose));
            let related: Vec<_> = related.filter(|candidate| candidate.found.error().is_some()).collect();
            let fits = |candidate: &&&Candidate| exact.fits(&candidate.pose, &candidate.found);
            let to_digits: Vec<_> = related.iter().filter(fits).collect();
            let (is_exact, candidate) = match (to_digits.as_slice(), related.as_slice(), candidates) {
                ([one], ..) => (true, *one),
                (_, [one], [_]) if roles => (false, one),
                _ if let [only] = candidates
                    && exact.halves(&only.pose, only.off_deg, only.off_m) =>
                {
                    out.fail(half_equal(world, claim, subject, (target, source), only).measured(measured(only)));
                    return None;
                }
                _ => {
                    out.too_little(subject, match candidates {
                        [only] => {
                            format!(
                                "`{}` from `{}` differs by {:.2} deg and {:.3} m, and no known convention error explains that: name the \
                                 frames with `aliases:` in frames-lint.yaml if others are meant",
                                only.target, only.source, only.off_deg, only.off_m
                            )
                        }
                        several => format!(
                            "{} pairs of frames may be meant, and none has this transform: name the frames with `aliases:` in frames-lint.yaml",
                            several.len()
                        ),
                    });
                    return None;
                }
            };
            let relation = candidate.found.error()?;
            let finding = suspicion(world, claim, subject, relation, (target, source), candidate);
            return Some(Suspicion {
                file: claim.place.source,
                relation,
                is_exact,
                is_of_keys: claim.is_of_a_key(),
                finding: finding.measured(measured(candidate)),
            });
        }
        ([_], _) => {
            out.too_little(
                subject,
                "it is nearly an identity, as in any file that was not calibrated",
            );
        }
        _ => {
            out.too_little(
                subject,
                "several pairs of frames have this transform: name the frames with `aliases:` in frames-lint.yaml",
            );
        }
    }
    None
}

/// The aliases that confirm the meaning of two names.
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
        "`{}` and `{}` ({dialect}) are probably `{}` and `{}`",
        names.0, names.1, candidate.target, candidate.source
    );
    Finding::note(subject, message, claim.place.clone())
        .hint()
        .detail(format!("Their transform in {} is that of the robot.", world.path(claim.place.source)))
        .help(format!(
            "confirm it in frames-lint.yaml, so that the file is compared with the others at full confidence:\naliases: {{{}}}",
            aliases(names, candidate)
        ))
}

/// Rotation or translation is equal to the last digits, the other part is not: hardly a coincidence between other frames.
fn half_equal(
    world: &World,
    claim: &Claim,
    subject: String,
    names: (&FrameId, &FrameId),
    candidate: &Candidate<'_>,
) -> Finding {
    let Candidate { target, source, .. } = candidate;
    let message = format!(
        "`{}` differs from the robot's transform from `{source}` to `{target}` by {:.2} deg and {:.3} m",
        claim.label, candidate.off_deg, candidate.off_m
    );
    Finding::warning(subject, message, claim.place.clone())
        .hint()
        .detail(format!(
            "Assumes that `{}` and `{}` of {} are `{target}` and `{source}`.",
            names.0,
            names.1,
            world.path(claim.place.source)
        ))
        .help(format!(
            "correct the part that differs. If the assumed frames are right, confirm them in frames-lint.yaml:\ntransforms: [{{key: '{}', is: {target} from {source}}}]",
            claim.label
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
    let right = format!(
        "the robot's transform from `{}` to `{}`",
        candidate.source, candidate.target
    );
    let message = format!("`{}` {}", claim.label, relation.relates_to(&right));
    Finding::error(subject, message, claim.place.clone())
        .likely()
        .relation(relation.word())
        .detail(format!(
            "Assumes that `{}` and `{}` of {} are `{}` and `{}`. {}",
            names.0,
            names.1,
            world.path(claim.place.source),
            candidate.target,
            candidate.source,
            relation.describe_beside(&candidate.pose.rotation)
        ))
        .help(format!(
            "{} the transform in the file. If the assumed names are right, confirm them in frames-lint.yaml:\naliases: {{{}}}",
            if relation == Relation::Inverse { "invert" } else { "correct" },
            aliases(names, candidate)
        ))
}
