//! GEO06: heights above mean sea level that are given as heights above the ellipsoid.

use crate::analysis::geo::heights::{Apart, Datum, Heights, Limits};
use crate::analysis::motion::Motion;
use crate::rules::prelude::*;

pub(crate) struct AltitudeDatum;

/// How two heights stand to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    /// They are one.
    Same,
    /// The first lacks the undulation.
    FirstAtSea,
    /// The second lacks it.
    SecondAtSea,
    /// Another difference, or none that is steady.
    Other,
}

impl Rule for AltitudeDatum {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &Motion::of(world).bags {
            let all = Heights::all(world, bag, limits);
            for (index, heights) in all.iter().enumerate() {
                if heights.datum == Datum::Claimed {
                    let others = all.iter().enumerate().filter(|(other, _)| *other != index);
                    let others: Vec<&Heights> = others.map(|(_, other)| other).collect();
                    judge_heights(heights, &others, limits, out);
                }
            }
        }
    }
}

fn judge_heights(heights: &Heights, others: &[&Heights], limits: &Limits, out: &mut Judge) {
    let subject = format!("altitude of {}", heights.subject);
    if others.is_empty() {
        return out.missing(subject, "nothing else in the recording tells a height");
    }
    let Some(undulation_m) = heights.undulation_m() else {
        let why = "the position is none on Earth";
        return out.not_evaluated(subject, NotEvaluated::InputBroken, why);
    };
    if undulation_m.abs() < limits.min_undulation_m {
        let why = format!(
            "mean sea level lies {undulation_m:.1} m above the ellipsoid here, {} m are needed to tell them apart",
            limits.min_undulation_m
        );
        return out.too_little(subject, why);
    }
    let mut undecided = Vec::new();
    for other in others {
        let Some(apart) = heights.above(other).filter(|apart| apart.samples >= limits.min_samples) else {
            undecided.push(format!("{} tells too few heights at the same times", other.subject));
            continue;
        };
        let needed_m = limits.needed_m(heights, other, apart);
        if undulation_m.abs() < needed_m {
            undecided.push(format!(
                "mean sea level lies {undulation_m:.1} m above the ellipsoid here, {needed_m:.1} m are needed to tell them apart by {}",
                other.subject
            ));
            continue;
        }
        let measured = [
            Measured::new("height above the other", apart.median_m, "m")
                .spread(apart.spread_m)
                .limit(limits.max_off_m)
                .samples(apart.samples as u64),
            Measured::new("geoid above the ellipsoid (EGM96)", undulation_m, "m"),
        ];
        match (relation(apart, undulation_m, limits), other.datum) {
            (Relation::FirstAtSea, _) => {
                let finding = at_sea(&subject, heights, other, apart, undulation_m);
                return out.fail(finding.measured(measured));
            }
            (Relation::Same, Datum::Known) | (Relation::SecondAtSea, Datum::Claimed | Datum::Unknown) => {
                return out.pass(subject, measured);
            }
            (Relation::SecondAtSea, Datum::Map) => {
                let of_map = format!("height of {}", other.subject);
                let finding = at_sea(&of_map, other, heights, negated(apart), undulation_m);
                out.fail(finding.measured(measured.iter().cloned()));
                return out.pass(subject, measured);
            }
            (Relation::Same, _) => undecided.push(format!(
                "it agrees with {}, of which nothing says what it is counted from",
                other.subject
            )),
            _ => undecided.push(format!(
                "it is {:+.1} m (+-{:.1}) from {}, and mean sea level {undulation_m:+.1} m from the ellipsoid",
                apart.median_m, apart.spread_m, other.subject
            )),
        }
    }
    out.too_little(subject, undecided.join("; "));
}

fn relation(apart: Apart, undulation_m: f64, limits: &Limits) -> Relation {
    let is =
        |height_m: f64| apart.spread_m <= limits.max_spread_m && (apart.median_m - height_m).abs() <= limits.max_off_m;
    if is(0.0) {
        Relation::Same
    } else if is(-undulation_m) {
        Relation::FirstAtSea
    } else if is(undulation_m) {
        Relation::SecondAtSea
    } else {
        Relation::Other
    }
}

fn negated(apart: Apart) -> Apart {
    Apart {
        median_m: -apart.median_m,
        ..apart
    }
}

/// The heights of `low` lack the undulation that those of `sound` have.
fn at_sea(subject: &str, low: &Heights, sound: &Heights, apart: Apart, undulation_m: f64) -> Finding {
    let below = if apart.median_m < 0.0 { "below" } else { "above" };
    let (what, help) = if low.datum == Datum::Map {
        (
            "the origin of the map was set with a height above mean sea level, where `earth` is about the ellipsoid",
            format!("add the geoid's {undulation_m:.2} m to the height of the origin that `earth` -> `map` is made of"),
        )
    } else {
        (
            "a height above mean sea level is given as one above the ellipsoid",
            format!("publish `altitude = height above mean sea level + geoid separation` ({undulation_m:+.2} m here)"),
        )
    };
    let message = format!(
        "the height of `{}` is {:.2} m {below} that of `{}`; the geoid is {undulation_m:.2} m from the ellipsoid here: {what}",
        low.topic,
        apart.median_m.abs(),
        sound.topic
    );
    Finding::warning(subject, message, low.place.clone())
        .likely()
        .relation("msl-as-ellipsoidal")
        .related(sound.place.clone(), "the other height")
        .help(help)
}
