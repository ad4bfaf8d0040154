//! COV05: covariances in other units than m² and rad².

use crate::analysis::cov::declared::{StreamCovariance, each};
use crate::analysis::cov::fit::{Fit, Reading};
use crate::analysis::motion::Stream;
use crate::math::noise::DEG2_PER_RAD2;
use crate::rules::prelude::*;
use crate::world::{bag::TopicEvidence, content::CovarianceEvidence, motion::PoseRow};

pub(crate) struct CovUnits;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    unknown_rad2: f64,
    widest_deg2: f64,
    grows: f64,
    min_poses: f64,
    fits: f64,
    misses: f64,
    margin: f64,
}

impl Rule for CovUnits {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for topic in bag.topics.values() {
                for (field, first) in [("orientation_covariance", 0), ("pose.covariance", 3)] {
                    if let Some(evidence) = topic.content.covariances.get(field) {
                        judge_angles(bag.source, topic, field, first, evidence, limits, out);
                    }
                }
            }
        }
        each(world, "pose.covariance", |_, stream, declared| {
            judge_noise(stream, declared, limits, out);
        });
    }
}

/// An angle cannot have more variance than an unknown one.
fn judge_angles(
    source: crate::source::SourceId,
    topic: &TopicEvidence,
    field: &str,
    first: usize,
    evidence: &CovarianceEvidence,
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = format!("size of the angles' variances in `{field}` on topic `{}`", topic.topic);
    let size = first + 3;
    let mut largest: Option<f64> = None;
    for axis in first..size {
        let values: Vec<(f64, &crate::world::content::CovarianceAt)> = evidence
            .samples
            .iter()
            .filter(|sample| sample.values.len() == size * size && sample.values.first() != Some(&-1.0))
            .filter_map(|sample| Some((*sample.values.get(axis * (size + 1))?, sample)))
            .filter(|(value, _)| value.is_finite() && *value > 0.0)
            .collect();
        let most = values.iter().map(|value| value.0).fold(0.0, f64::max);
        let least = values.iter().map(|value| value.0).fold(f64::INFINITY, f64::min);
        // A number that never changes is hard-coded: a large one often means "unknown".
        if most - least <= 1e-9 * most || values.is_empty() {
            continue;
        }
        largest = Some(largest.map_or(most, |known: f64| known.max(most)));
        let middle = crate::math::stats::median(&values.iter().map(|value| value.0).collect::<Vec<_>>()).unwrap_or(0.0);
        if middle <= limits.unknown_rad2 || middle > limits.widest_deg2 {
            continue;
        }
        if most > limits.grows * least {
            let why = format!(
                "the variance of an angle grows from {least:.1} to {most:.1}: a filter that never observes this angle, in any unit"
            );
            return out.too_little(subject, why);
        }
        let name = ["x", "y", "z"].get(axis - first).copied().unwrap_or("an axis");
        let place = values.iter().find(|value| value.0 > limits.unknown_rad2);
        let place = place.map_or_else(
            || Place::whole(source),
            |value| Place::message(source, value.1.at.clone()),
        );
        let message = format!(
            "`{}`: `{field}` has a variance of {middle:.1} rad^2 about {name}, probably deg^2",
            topic.topic
        );
        let finding = Finding::warning(subject, message, place)
            .likely()
            .relation("degrees")
            .detail(format!(
                "Read as rad^2, the standard deviation is {:.0} deg, more than half a turn; read as deg^2, it is {:.1} deg.",
                middle.sqrt().to_degrees(),
                middle.sqrt()
            ))
            .help(format!(
                "divide the variances of the angles by {DEG2_PER_RAD2:.1} (deg^2 to rad^2) before they are published"
            ));
        return out.fail(
            finding.measured(
                Measured::new(format!("variance of the angle about {name} (median)"), middle, "rad2")
                    .limit(limits.unknown_rad2)
                    .samples(evidence.count),
            ),
        );
    }
    match largest {
        Some(most) if most <= limits.unknown_rad2 => out.pass(
            subject,
            [Measured::new("largest variance of an angle", most, "rad2")
                .limit(limits.unknown_rad2)
                .samples(evidence.count)],
        ),
        Some(most) => {
            let why =
                format!("a variance of {most:.1e} is too large for rad^2 and deg^2: it marks the angle as unknown");
            out.not_applicable(subject, why);
        }
        None => {
            let why = "no variance of an angle changes: none is stated, or the numbers are hard-coded";
            out.not_applicable(subject, why);
        }
    }
}

/// What decides on the units.
const PUBLISHED: &str = "largest factor between variance and noise, as published";

fn judge_noise(stream: &Stream<PoseRow>, declared: &StreamCovariance<'_>, limits: &Limits, out: &mut Judge) {
    let subject = format!("units of `pose.covariance` on {}", stream.subject);
    let fit = match Fit::of(stream, declared, limits.min_poses) {
        Ok(fit) => fit,
        Err(why) => return out.too_little(subject, why),
    };
    let published = fit.miss(Reading::AsPublished);
    let factor = |what: &str, value: f64| Measured::new(what, value, "1").limit(limits.fits).samples(fit.poses);
    if published <= limits.fits {
        return out.pass(subject, [factor(PUBLISHED, published)]);
    }
    let best = fit
        .best(limits.fits, limits.margin)
        .filter(|_| published >= limits.misses);
    let (word, what, help) = match best {
        Some(Reading::Degrees) => (
            "degrees",
            "rotations in deg^2 instead of rad^2",
            "divide the variances of rotations by 3282.8 (deg^2 per rad^2)",
        ),
        Some(Reading::Centimetres) => (
            "centimetres",
            "positions in cm^2 instead of m^2",
            "divide the variances of positions by 10000 (cm^2 per m^2)",
        ),
        Some(Reading::Millimetres) => (
            "millimetres",
            "positions in mm^2 instead of m^2",
            "divide the variances of positions by 1000000 (mm^2 per m^2)",
        ),
        Some(Reading::Deviations) => (
            "deviations",
            "standard deviations instead of variances",
            "square the values: a covariance holds variances",
        ),
        Some(Reading::RotationFirst) => (
            "rotation-first",
            "rotations before positions",
            "swap the 3x3 blocks: positions come before rotations",
        ),
        Some(Reading::AsPublished) | None => {
            let why = format!(
                "the variances differ from the noise of the poses by a factor of {published:.1e}, and no other unit explains that: they \
                 describe other errors than those from pose to pose"
            );
            return out.too_little(subject, why);
        }
    };
    let best = fit.readings.first().map_or(f64::NAN, |reading| reading.1);
    let message = format!(
        "`{}`: `pose.covariance` has {what} (off by a factor of {published:.0})",
        stream.topic
    );
    out.fail(
        Finding::warning(subject, message, stream.place())
            .likely()
            .unless(codes::COV02)
            .relation(word)
            .detail(
                "The variances as published (m^2 and rad^2, positions before rotations) contradict the noise from pose to pose. After the \
                 correction, every variance agrees with that noise.",
            )
            .help(help)
            .measured(factor(PUBLISHED, published))
            .measured(Measured::new("largest factor between variance and noise, corrected", best, "1").samples(fit.poses)),
    );
}
