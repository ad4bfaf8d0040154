//! GEO06: heights above mean sea level that are published as heights above the ellipsoid.

use crate::analysis::geo::heights::{Datum, HeightGap, Heights, Limits};
use crate::analysis::motion::Motion;
use crate::rules::prelude::*;

pub(crate) struct AltitudeDatum;

/// How two heights differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    /// They agree.
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
        let why =
            "the recording has no other height: record GGA sentences, another receiver, or poses with `earth` -> `map`";
        return out.missing(subject, why);
    }
    let Some(undulation_m) = heights.undulation_m() else {
        let why = "latitude and longitude are out of range";
        return out.not_evaluated(subject, NotEvaluated::InputBroken, why);
    };
    if undulation_m.abs() < limits.min_undulation_m {
        let why = format!(
            "the geoid undulation is {undulation_m:.1} m here; {} m are needed to distinguish mean sea level from the ellipsoid",
            limits.min_undulation_m
        );
        return out.too_little(subject, why);
    }
    let mut undecided = Vec::new();
    for other in others {
        let Some(apart) = heights.above(other).filter(|apart| apart.samples >= limits.min_samples) else {
            undecided.push(format!("{} has too few heights at the same times", other.subject));
            continue;
        };
        let needed_m = limits.needed_m(heights, other, apart);
        if undulation_m.abs() < needed_m {
            undecided.push(format!(
                "the geoid undulation is {undulation_m:.1} m here; {needed_m:.1} m are needed to distinguish mean sea level from the ellipsoid by {}",
                other.subject
            ));
            continue;
        }
        let measured = [
            Measured::new(
                format!("height on `{}` minus height on `{}`", heights.topic, other.topic),
                apart.median_m,
                "m",
            )
            .spread(apart.spread_m)
            .limit(limits.max_off_m)
            .samples(apart.samples as u64),
            Measured::new("geoid undulation (EGM96)", undulation_m, "m"),
        ];
        match (relation(apart, undulation_m, limits), other.datum) {
            (Relation::FirstAtSea, _) => {
                let finding = at_sea(&subject, heights, other, apart, undulation_m, limits);
                return out.fail(finding.measured(measured));
            }
            (Relation::Same, Datum::Known) | (Relation::SecondAtSea, Datum::Claimed | Datum::Unknown) => {
                return out.pass(subject, measured);
            }
            (Relation::SecondAtSea, Datum::Map) => {
                let of_map = format!("height of {}", other.subject);
                let finding = at_sea(&of_map, other, heights, negated(apart), undulation_m, limits);
                out.fail(finding.measured(measured.iter().cloned()));
                return out.pass(subject, measured);
            }
            (Relation::Same, _) => undecided.push(format!(
                "it agrees with {}, whose height reference is unknown",
                other.subject
            )),
            _ => undecided.push(format!(
                "it differs from {} by {:+.1} m (+-{:.1}), where the geoid undulation is {undulation_m:+.1} m",
                other.subject, apart.median_m, apart.spread_m
            )),
        }
    }
    out.too_little(subject, undecided.join("; "));
}

fn relation(apart: HeightGap, undulation_m: f64, limits: &Limits) -> Relation {
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

fn negated(apart: HeightGap) -> HeightGap {
    HeightGap {
        median_m: -apart.median_m,
        ..apart
    }
}

/// The heights of `low` lack the undulation that those of `sound` have.
fn at_sea(
    subject: &str,
    low: &Heights,
    sound: &Heights,
    apart: HeightGap,
    undulation_m: f64,
    limits: &Limits,
) -> Finding {
    let low_or_high = if apart.median_m < 0.0 { "low" } else { "high" };
    let above_or_below = if undulation_m < 0.0 { "below" } else { "above" };
    let known = format!(
        "Here mean sea level is {:.2} m {above_or_below} the WGS 84 ellipsoid (EGM96), so a height above mean sea level is {:.2} m too \
         {low_or_high}. The measured difference deviates from that by {:.2} m (limit {} m).",
        undulation_m.abs(),
        undulation_m.abs(),
        (apart.median_m + undulation_m).abs(),
        limits.max_off_m
    );
    let (what, is, help) = if low.datum == Datum::Map {
        (
            "the map's origin",
            "The origin is probably at a height above mean sea level, but `earth` (REP-105) requires heights above the ellipsoid.",
            format!(
                "add the geoid undulation ({undulation_m:.2} m) to the origin's height where `earth` -> `map` is published"
            ),
        )
    } else {
        (
            "altitude",
            "The altitude is probably above mean sea level, but `NavSatFix` requires the altitude above the ellipsoid.",
            format!(
                "publish `altitude = height above mean sea level + geoid separation`, with the geoid separation of the receiver (field 11 of GGA; \
                 by EGM96 {undulation_m:+.2} m here)"
            ),
        )
    };
    let message = format!(
        "`{}`: {what} is {:.2} m too {low_or_high} compared with `{}`: probably from mean sea level",
        low.topic,
        apart.median_m.abs(),
        sound.topic
    );
    Finding::warning(subject, message, low.place.clone())
        .likely()
        .relation("msl-as-ellipsoidal")
        .detail(known)
        .detail(is)
        .related(sound.place.clone(), "compared with this height")
        .help(help)
}
