//! QUAT02: quaternions of one file in two orders, or in another order than their key states; and of a recording in another order
//! than ROS's.

mod level;

use std::collections::BTreeMap;

use nalgebra::{Quaternion, UnitQuaternion};

use crate::advice::tally::Tally;
use crate::analysis::quat::level::Limits;
use crate::analysis::quat::listed::{QuaternionList, Slot, said_by_key};
use crate::math::rotation::rotation_angle_between;
use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::world::{ClaimKind, Spelling, World};

pub(crate) struct QuaternionOrderStatic;

impl Rule for QuaternionOrderStatic {
    const NEEDS: &'static [Need] = &[Need::CalibrationOrBag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut right = Tally::new("quaternions");
        let mut bare: BTreeMap<SourceId, Vec<QuaternionList>> = BTreeMap::new();
        for claim in &world.claims {
            let ClaimKind::File { .. } = claim.kind else { continue };
            let Spelling::Quaternion { xyzw, order_known, .. } = claim.spelling else {
                continue;
            };
            let listed = QuaternionList::of(claim, xyzw, limits.scalar);
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
        level::judge(world, limits, out);
    }
}

/// Only an exact identity in the other order contradicts: a rotation by 180 degrees about x or z is rare, but real.
fn contradicts(said: Slot, listed: &QuaternionList) -> bool {
    let is_zero = |value: &f64| *value == 0.0;
    let [first, rest @ ..] = listed.written;
    said == Slot::Last && is_zero(&(first - 1.0)) && rest.iter().all(is_zero)
}

fn judge_bare(world: &World, source: SourceId, listed: &[QuaternionList], right: &mut Tally, out: &mut Judge) {
    let of = |slot: Slot| listed.iter().filter(move |one| one.slot == slot);
    let (first, last) = (of(Slot::First).count(), of(Slot::Last).count());
    match (of(Slot::First).next(), of(Slot::Last).next()) {
        (Some(one), Some(other)) => {
            // The rarer order is the error; if they are equally frequent, w first, which nothing in ROS reads.
            let (odd, usual) = if first <= last { (one, other) } else { (other, one) };
            out.fail(mixed(world, odd, usual, first, last));
        }
        (Some(one), None) => out.fail(scalar_first(world, one, first)),
        _ => listed.iter().for_each(|_| right.count(source)),
    }
}

fn mixed(world: &World, odd: &QuaternionList, usual: &QuaternionList, first: usize, last: usize) -> Finding {
    let (odd_name, usual_name) = (&odd.claim.label, &usual.claim.label);
    let (word, odd_slot, usual_slot, key) = if odd.slot == Slot::First {
        ("wxyz", "first", "last", "rotation_xyzw")
    } else {
        ("xyzw", "last", "first", "rotation_wxyz")
    };
    let message = format!("`{odd_name}` has the scalar w {odd_slot}, but `{usual_name}` has it {usual_slot}");
    let [a, b, c, d] = odd.written;
    let [w_last, w_first] =
        [Quaternion::new(d, a, b, c), Quaternion::new(a, b, c, d)].map(UnitQuaternion::from_quaternion);
    let apart = rotation_angle_between(&w_last, &w_first).to_degrees();
    let error = Finding::error(odd.subject(world), message, odd.place()).likely();
    finding(error.relation(word), first, last)
        .label(format!("w {odd_slot}"))
        .related(usual.place(), format!("w {usual_slot}"))
        .detail(format!(
            "{} of `{odd_name}` is a small rotation with w {odd_slot}; {} of `{usual_name}` is one with w {usual_slot}.",
            odd.text(),
            usual.text()
        ))
        .measured(Measured::new("rotation difference between the two orders", apart, "deg"))
        .help(format!(
            "check how the sensor of `{odd_name}` is mounted:\n\
             (1) if it is mounted nearly without rotation, write its quaternion with w {usual_slot}, as the others\n\
             (2) if it really is rotated by {apart:.0} deg, keep the numbers, and name their order in the key: `{key}`"
        ))
}

fn scalar_first(world: &World, one: &QuaternionList, first: usize) -> Finding {
    let message = format!(
        "`{}` may be in the order w, x, y, z: the file does not state the order",
        one.claim.label
    );
    finding(Finding::note(one.subject(world), message, one.place()).hint(), first, 0)
        .detail(format!(
            "{} is a small rotation with w first, or a rotation by 180 deg about x with w last.",
            one.text()
        ))
        .help("name the order of the four numbers in the file: ROS, tf2 and Eigen's memory use x, y, z, w")
}

fn against_key(world: &World, one: &QuaternionList, said: Slot) -> Finding {
    let word = if said == Slot::Last { "xyzw" } else { "wxyz" };
    let message = format!(
        "`{}` names the order {word}, but {} is the identity in the other order",
        one.claim.label,
        one.text()
    );
    finding(Finding::warning(one.subject(world), message, one.place()).hint(), 1, 0)
        .help("write 0 0 0 1 for no rotation in the order x, y, z, w, or correct the key")
}

fn finding(finding: Finding, first: usize, last: usize) -> Finding {
    finding
        .label("order of the four numbers")
        .measured(Measured::count("lists with the scalar first", first))
        .measured(Measured::count("lists with the scalar last", last))
}
