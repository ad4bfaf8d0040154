//! GEO01: GNSS fixes with impossible positions.

use crate::analysis::geo::fixes::{Limits, Position, Reading, meant, middle, misread, others};
use crate::rules::prelude::*;
use crate::world::{BagEvidence, World, bag::TopicEvidence, content::FixEvidence};

pub(crate) struct NavsatfixSanity;

impl Rule for NavsatfixSanity {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for said in bag.topics.values().flat_map(TopicEvidence::contents) {
                if let Some(fixes) = said.content.fixes.as_ref() {
                    judge_fixes(world, bag, &said.subject(), fixes, limits, out);
                }
            }
        }
    }
}

fn judge_fixes(world: &World, bag: &BagEvidence, subject: &str, fixes: &FixEvidence, limits: &Limits, out: &mut Judge) {
    let with_fix = fixes.count.saturating_sub(fixes.no_fix);
    if with_fix == 0 {
        return out.too_little(subject, "no message has a fix (status >= 0)");
    }
    let listed = [
        (
            &fixes.non_finite,
            "are NaN or infinite",
            "publish status -1 while there is no fix",
        ),
        (
            &fixes.out_of_range,
            "are out of range",
            "publish degrees, latitude first",
        ),
        (
            &fixes.null_island,
            "are exactly latitude 0, longitude 0",
            "publish status -1 until the receiver has a fix",
        ),
    ];
    let mut sound = true;
    for ((count, examples), what, help) in listed {
        let Some(first) = examples.first().filter(|_| *count as f64 > limits.max_wrong) else {
            continue;
        };
        sound = false;
        let is_error = *count as f64 > limits.error_share * with_fix as f64;
        let severity = if is_error { Severity::Error } else { Severity::Warning };
        let meant = meant(first, limits);
        let perhaps = meant.map_or_else(String::new, |Reading { words, .. }| format!(": probably {words}"));
        let message = format!("{subject}: {count} of {with_fix} positions {what}{perhaps}");
        let place = Place::message(bag.source, first.at.clone());
        let finding = Finding::new(severity, subject, message, place).help(help).measured(
            Measured::new("positions", *count as f64, "count")
                .limit(limits.max_wrong)
                .samples(with_fix),
        );
        let valid = "Their status states a valid fix (>= 0).";
        out.fail(match meant {
            Some(Reading { relation, meant, .. }) => finding.relation(relation).detail(format!(
                "{valid} Corrected, the first position is {:.5}, {:.5}.",
                meant.0, meant.1
            )),
            None => finding.detail(valid),
        });
    }
    let Some(position) = middle(fixes).filter(|_| sound) else {
        return;
    };
    if let Some((way, other)) = misread(position, &others(world, fixes), limits) {
        return out.fail(misreading(bag, subject, fixes, (position, way, other)));
    }
    let degrees = |name, value, limit| Measured::new(name, value, "deg").limit(limit).samples(with_fix);
    let measured = [
        degrees("latitude", position.0, 90.0),
        degrees("longitude", position.1, 180.0),
    ];
    out.pass(subject, measured);
}

fn misreading(
    bag: &BagEvidence,
    subject: &str,
    fixes: &FixEvidence,
    (position, way, other): (Position, Reading, Option<&str>),
) -> Finding {
    let place = match fixes.samples.first() {
        Some(first) => Place::message(bag.source, first.at.clone()),
        None => Place::whole(bag.source),
    };
    let (probably, detail) = match other {
        Some(other) => (
            "",
            format!("Corrected, it agrees with `{other}`; otherwise `{other}` itself is wrong."),
        ),
        None => (
            "probably ",
            "As published, the position is in the Gulf of Guinea. A second receiver would confirm the unit.".to_owned(),
        ),
    };
    let message = format!(
        "{subject}: {probably}{} (latitude {:.5}, longitude {:.5})",
        way.words, position.0, position.1
    );
    let finding = Finding::error(subject, message, place)
        .relation(way.relation)
        .detail(detail)
        .help("publish latitude and longitude in degrees (WGS 84), each in its own field")
        .measured(Measured::new("latitude", position.0, "deg").samples(fixes.count));
    if other.is_some() {
        finding.likely()
    } else {
        finding.hint()
    }
}
