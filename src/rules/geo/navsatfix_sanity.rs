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
            "publish degrees (WGS 84): the latitude is within +-90, the longitude within +-180",
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
        let perhaps = meant.map_or_else(String::new, |Reading { words, .. }| format!("; probably {words}"));
        let message = format!("{subject}: {count} of {with_fix} positions {what}{perhaps}");
        let place = Place::message(bag.source, first.at.clone());
        let finding = Finding::new(severity, subject, message, place).measured(
            Measured::new(format!("positions that {what}"), *count as f64, "count")
                .limit(limits.max_wrong)
                .samples(with_fix),
        );
        let published = format!(
            "The first of them is published as latitude {:.5}, longitude {:.5}, with a valid fix (status >= 0).",
            first.latitude_deg, first.longitude_deg
        );
        out.fail(match meant {
            Some(way) => finding.relation(way.relation).help(way.help).detail(format!(
                "{published} Corrected: latitude {:.5}, longitude {:.5}.",
                way.meant.0, way.meant.1
            )),
            None => finding.help(help).detail(published),
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
    let probably = if other.is_some() { "" } else { "probably " };
    let message = format!(
        "{subject}: {probably}{} (latitude {:.5}, longitude {:.5})",
        way.words, position.0, position.1
    );
    let finding = Finding::error(subject, message, place)
        .relation(way.relation)
        .help(way.help)
        .measured(Measured::new("latitude", position.0, "deg").samples(fixes.count));
    match other {
        Some(other) => finding.likely().detail(format!(
            "Corrected, the position agrees with `{other}`. If the published position is right, `{other}` is wrong."
        )),
        None => finding
            .hint()
            .detail("As published, the position is in the Gulf of Guinea. A second receiver would confirm the unit."),
    }
}
