//! QUAT02: quaternions of one file in two orders, or in another one than their key says.

use std::collections::BTreeMap;

use crate::rules::literal::cover;
use crate::rules::tally::Tally;
use crate::rules::{Judge, Need, Rule};
use crate::source::SourceId;
use crate::verdict::{Finding, Measured};
use crate::world::{Claim, ClaimKind, FrameId, Spelling, World};

/// QUAT02.
pub struct QuaternionOrderStatic;

/// Limits of QUAT02.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Size from which the first or the last number looks like the scalar of a small rotation.
    pub scalar: f64,
}

/// Where the scalar of a small rotation seems to stand.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Slot {
    First,
    Last,
    Elsewhere,
}

/// A bare list of four.
struct Listed<'a> {
    claim: &'a Claim,
    /// In the order of the file.
    written: [f64; 4],
    slot: Slot,
}

impl Rule for QuaternionOrderStatic {
    const PAGE: &'static str = include_str!("../../../rules/quat/quaternion-order-static.md");
    const NEEDS: &'static [Need] = &[Need::Calibration];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let mut right = Tally::new("quaternions");
        let mut bare: BTreeMap<SourceId, Vec<Listed>> = BTreeMap::new();
        for claim in &world.claims {
            let ClaimKind::File { .. } = claim.kind else { continue };
            let Spelling::Quaternion { xyzw, order_known, .. } = claim.spelling else {
                continue;
            };
            let written = written_order(claim, xyzw);
            let listed = Listed {
                claim,
                written,
                slot: slot(written, limits),
            };
            if !order_known {
                bare.entry(claim.place.source).or_default().push(listed);
            } else if let Some(said) = said_by_key(&claim.label)
                && contradicts(said, &listed)
            {
                out.fail(against_key(world, &listed, said));
            } else {
                right.count(claim.place.source);
            }
        }
        for (source, listed) in bare {
            judge_bare(world, source, &listed, &mut right, out);
        }
        right.report(world, out);
    }
}

fn written_order(claim: &Claim, xyzw: [f64; 4]) -> [f64; 4] {
    let mut written = xyzw;
    if claim.rotation_literals.len() == 4 {
        for (slot, literal) in written.iter_mut().zip(&claim.rotation_literals) {
            *slot = literal.value;
        }
    }
    written
}

fn slot([a, _, _, d]: [f64; 4], limits: &Limits) -> Slot {
    match (a.abs() >= limits.scalar, d.abs() >= limits.scalar) {
        (true, false) => Slot::First,
        (false, true) => Slot::Last,
        _ => Slot::Elsewhere,
    }
}

/// The order that a key names: `rotation_wxyz`, `q_xyzw`.
fn said_by_key(label: &str) -> Option<Slot> {
    let key = FrameId::new(label.rsplit('/').next().unwrap_or(label));
    match (key.has_token("wxyz"), key.has_token("xyzw")) {
        (true, false) => Some(Slot::First),
        (false, true) => Some(Slot::Last),
        _ => None,
    }
}

/// Only an exact identity in the other order says something: half a turn about x or z is rare, but real.
fn contradicts(said: Slot, listed: &Listed) -> bool {
    said == Slot::Last && listed.written == [1.0, 0.0, 0.0, 0.0]
}

fn judge_bare(world: &World, source: SourceId, listed: &[Listed], right: &mut Tally, out: &mut Judge) {
    let of = |slot: Slot| listed.iter().filter(move |one| one.slot == slot);
    let (first, last) = (of(Slot::First).count(), of(Slot::Last).count());
    match (of(Slot::First).next(), of(Slot::Last).next()) {
        (Some(one), Some(other)) => {
            // The rarer order is the slip; of equals, w first, which nothing in ROS reads.
            let (odd, usual) = if first <= last { (one, other) } else { (other, one) };
            out.fail(mixed(world, odd, usual, first, last));
        }
        (Some(one), None) => out.fail(scalar_first(world, one, first)),
        _ => listed.iter().for_each(|_| right.count(source)),
    }
}

fn text([a, b, c, d]: [f64; 4]) -> String {
    format!("[{a}, {b}, {c}, {d}]")
}

fn mixed(world: &World, odd: &Listed, usual: &Listed, first: usize, last: usize) -> Finding {
    let message = format!(
        "`{}` is {} and `{}` of the same file is {}: one has its scalar first, the other last",
        odd.claim.label,
        text(odd.written),
        usual.claim.label,
        text(usual.written)
    );
    let word = if odd.slot == Slot::First { "wxyz" } else { "xyzw" };
    finding(
        Finding::error(subject(world, odd), message, place(odd))
            .likely()
            .relation(word),
        first,
        last,
    )
    .related(place(usual), "the other order")
    .help("write all quaternions of the file in one order, and name it in the key (x, y, z, w)")
}

fn scalar_first(world: &World, one: &Listed, first: usize) -> Finding {
    let message = format!(
        "`{}` is {}: a small rotation with its scalar first, or half a turn about x with its scalar last; the file \
         does not say which",
        one.claim.label,
        text(one.written)
    );
    finding(Finding::note(subject(world, one), message, place(one)).hint(), first, 0)
        .help("name the four numbers in the file: ROS, tf2 and Eigen's memory read x y z w")
}

fn against_key(world: &World, one: &Listed, said: Slot) -> Finding {
    let word = if said == Slot::Last { "xyzw" } else { "wxyz" };
    let message = format!(
        "the key `{}` says {word}, and {} is the identity in the other order",
        one.claim.label,
        text(one.written)
    );
    finding(Finding::warning(subject(world, one), message, place(one)).hint(), 1, 0)
        .help("write 0 0 0 1 for no rotation in the order x y z w, or correct the key")
}

fn finding(finding: Finding, first: usize, last: usize) -> Finding {
    finding
        .label("order of the four numbers")
        .measured(Measured::count("lists with the scalar first", first))
        .measured(Measured::count("lists with the scalar last", last))
}

fn subject(world: &World, listed: &Listed) -> String {
    format!(
        "order of `{}` of {}",
        listed.claim.label,
        world.path(listed.claim.place.source)
    )
}

fn place(listed: &Listed) -> crate::source::Place {
    cover(&listed.claim.rotation_literals, &listed.claim.place)
}
