//! ROT09: a multiple of pi written with so few digits that distant points are displaced.

use std::collections::BTreeMap;

use crate::advice::literal::{rewrite, with_fix};
use crate::advice::tally::Tally;
use crate::analysis::rot::angles::stated;
use crate::analysis::rot::short_pi::{expression, meant};
use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::verdict::Safety;
use crate::world::{Literal, World};

pub(crate) struct TruncatedLiteral;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Distance at which the lateral error is judged, metres.
    pub range_m: f64,
    /// Lateral error there that is worth a note, millimetres.
    pub lateral_mm: f64,
    /// Largest distance to a multiple of pi that is still a truncation of it, radians.
    pub nearest_rad: f64,
    /// How many places are shown beside the worst one.
    pub shown: usize,
}

/// A multiple of pi with too few digits.
#[derive(Debug)]
struct TruncatedPi<'a> {
    name: String,
    literal: &'a Literal,
    exact: f64,
}

impl TruncatedPi<'_> {
    fn error_rad(&self) -> f64 {
        (self.literal.value - self.exact).abs()
    }
}

impl Rule for TruncatedLiteral {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let all = stated(world);
        let mut right = Tally::new("angles");
        let mut found: BTreeMap<SourceId, Vec<TruncatedPi>> = BTreeMap::new();
        for angles in &all {
            let source = angles.place.source;
            for literal in angles.radian_literals() {
                let short = meant(literal.value, limits.nearest_rad).map(|exact| TruncatedPi {
                    name: angles.name.clone(),
                    literal,
                    exact,
                });
                match short {
                    Some(short) => found.entry(source).or_default().push(short),
                    None => right.pass(source, Measured::new("error of a multiple of pi", 0.0, "rad")),
                }
            }
        }
        for (source, mut short) in found {
            let by_error = |a: &TruncatedPi, b: &TruncatedPi| b.error_rad().total_cmp(&a.error_rad());
            short.sort_by(|a, b| by_error(a, b).then(a.literal.span.cmp(&b.literal.span)));
            if let Some(finding) = finding(world, source, &short, limits) {
                out.fail(finding);
            }
        }
        right.report(world, out);
    }
}

fn finding(world: &World, source: SourceId, short: &[TruncatedPi], limits: &Limits) -> Option<Finding> {
    let worst = short.first()?;
    let place = |short: &TruncatedPi| Place::text(source, short.literal.span);
    let range_m = limits.range_m;
    let error_mm = range_m * worst.error_rad().sin() * 1000.0;
    let others = match short.len() - 1 {
        0 => String::new(),
        1 => " (and one more angle)".to_owned(),
        count => format!(" (and {count} more angles)"),
    };
    let message = format!(
        "`{}` of {} has too few digits of pi: it is {:.4} deg off{others}",
        worst.literal.text,
        worst.name,
        worst.error_rad().to_degrees(),
    );
    let edits = short
        .iter()
        .map(|short| rewrite(world, source, short.literal, short.exact.to_string()))
        .collect();
    let subject = format!("truncated angles of {}", world.path(source));
    let or = expression(worst.exact, world.path(source)).map_or_else(String::new, |text| format!(", or as `{text}`"));
    let finding = Finding::note(subject, message, place(worst))
        .label(format!("{} is meant", worst.exact))
        .detail(format!(
            "A point at a distance of {range_m} m is off by {error_mm:.1} mm."
        ))
        .help(format!("write the angle with all digits{or}"))
        .measured(Measured::new("largest error", worst.error_rad(), "rad").samples(short.len() as u64))
        .measured(Measured::new(format!("error of a point at {range_m} m"), error_mm, "mm").limit(limits.lateral_mm));
    // Five digits are enough for most uses: only a hint.
    let is_large = error_mm > limits.lateral_mm;
    let finding = if is_large { finding } else { finding.hint() };
    let mut finding = with_fix(finding, "write all digits", Safety::Safe, edits);
    for other in short.iter().skip(1).take(limits.shown) {
        finding = finding.related(place(other), format!("{} of {}", other.literal.text, other.name));
    }
    Some(finding)
}
