//! GEO07: sources that put the origin of a local frame at different places on the Earth.

mod own;

use nalgebra::Vector3;

use crate::analysis::geo::apart::{between, direction, position_text};
use crate::analysis::geo::origins::{Limits, origins};
use crate::math::{geodesy::Geodetic, geoid::undulation_m};
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::world::{EarthOrigin, LocalOrigin, OriginSource, World};

pub(crate) struct OriginConsistency;

impl Rule for OriginConsistency {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for stated in &world.origins {
            judge_place(stated, out);
        }
        let (all, left_out) = origins(world, limits);
        for why in left_out {
            out.too_little("origin", why);
        }
        own::judge(world, &all, limits, out);
        let Some((reference, others)) = all.split_first() else {
            return;
        };
        if others.is_empty() {
            if let Some(finding) = own::missing(reference, limits) {
                return out.fail(finding);
            }
            let why = format!("only {} states the origin: two are needed to compare", reference.who);
            return out.missing("origin", why);
        }
        for other in nearest_of_alternatives(reference, others) {
            // What a drive itself states is compared with that drive's own origin.
            let of_drive = all
                .iter()
                .find(|origin| origin.bag.is_some() && origin.bag == other.bag && origin.by < other.by);
            judge_pair(world, of_drive.unwrap_or(reference), other, limits, out);
        }
    }
}

/// A file's origin with a latitude out of range; the others are compared.
fn judge_place(stated: &EarthOrigin, out: &mut Judge) {
    let Some([latitude, longitude]) = stated.latitude_longitude_deg else {
        return;
    };
    if latitude.abs() <= 90.0 {
        return;
    }
    let subject = format!("origin `{}`", stated.label);
    if latitude.abs() > 180.0 || longitude.is_nan() || longitude.abs() > 90.0 {
        let why = format!("{latitude}, {longitude} is not a latitude and longitude in degrees");
        return out.not_evaluated(subject, NotEvaluated::InputBroken, why);
    }
    let message = format!(
        "`{}`: latitude {latitude} deg is beyond 90: latitude and longitude are swapped",
        stated.label
    );
    let finding = Finding::error(subject, message, stated.place.clone()).likely();
    let finding = finding
        .relation("lat-lon-swapped")
        .help(format!("write latitude {longitude} and longitude {latitude}"));
    out.fail(finding.measured(Measured::new("latitude", latitude, "deg").limit(90.0)));
}

/// Files of one format are for different maps: of these the one that is nearest to the reference, none where the reference is
/// itself one of them.
fn nearest_of_alternatives<'o>(reference: &LocalOrigin, others: &'o [LocalOrigin]) -> Vec<&'o LocalOrigin> {
    let distance = |origin: &LocalOrigin| between(reference, origin).norm();
    let mut kept: Vec<&LocalOrigin> = Vec::new();
    for other in others {
        let is_file = matches!(other.by, OriginSource::File(_));
        if is_file && other.by == reference.by {
            continue;
        }
        match kept.iter_mut().find(|kept| is_file && kept.by == other.by) {
            Some(nearest) if distance(other) < distance(nearest) => *nearest = other,
            Some(_) => {}
            None => kept.push(other),
        }
    }
    kept
}

fn judge_pair(world: &World, reference: &LocalOrigin, other: &LocalOrigin, limits: &Limits, out: &mut Judge) {
    let named = |origin: &LocalOrigin| format!("{} in {}", origin.who, world.path(origin.place.source));
    let subject = format!("origin: {} and {}", named(reference), named(other));
    let apart = between(reference, other);
    let distance_m = apart.norm();
    let by_track = reference.by == OriginSource::Track || other.by == OriginSource::Track;
    let excused_m = reference.within_m + other.within_m + if by_track { limits.track_m } else { 0.0 };
    let (warning_m, error_m) = (limits.warning_m.max(excused_m), limits.error_m.max(excused_m));
    let measured = Measured::new("distance of the two origins", distance_m, "m").limit(warning_m);
    if distance_m > limits.site_m && is_exchanged(reference, other, limits) {
        return out.fail(exchanged(reference, other, subject).measured(measured));
    }
    let two_drives = reference.bag.is_some() && other.bag.is_some() && reference.bag != other.bag;
    if two_drives && distance_m > limits.site_m {
        let why = format!(
            "the two recordings have origins {:.1} km apart: they are from two sites",
            distance_m / 1e3
        );
        return out.not_applicable(subject, why);
    }
    if distance_m <= warning_m {
        return out.pass(subject, [measured]);
    }
    let geoid_m = geoid(reference, other, &apart, limits);
    let severity = if distance_m > error_m && geoid_m.is_none() {
        Severity::Error
    } else {
        Severity::Warning
    };
    let [one, two] = if reference.who == other.who {
        [reference, other].map(|origin| format!("`{}`", world.path(origin.place.source)))
    } else {
        [reference, other].map(|origin| origin.who.clone())
    };
    // The one above mean sea level is below the other where the undulation is positive.
    let low = geoid_m.map(|n| {
        if apart.z * n < 0.0 {
            (&two, &one, reference)
        } else {
            (&one, &two, other)
        }
    });
    let message = match low {
        Some((low, ..)) => format!(
            "{low}: origin height is above mean sea level, {:.2} m off the ellipsoidal one",
            apart.z.abs()
        ),
        None => format!("{one} and {two} put the origin {distance_m:.2} m apart"),
    };
    let detail = format!(
        "The first origin, {}, is {}. The second, {}, is {}.{}{}",
        named(reference),
        position_text(reference),
        named(other),
        position_text(other),
        direction(&apart, "the second"),
        geoid_m.map_or(String::new(), |n| format!(
            " Height above the ellipsoid = height above mean sea level + geoid undulation ({n:.1} m here)."
        ))
    );
    let help = match low {
        Some((low, by, right)) => format!(
            "give {low} the height above the ellipsoid, {:.2} m, as {by} has it",
            right.at.height_m
        ),
        None if two_drives => {
            "save the origin once and load it on every drive: a map made on one drive is shifted on the other"
                .to_owned()
        }
        None if other.by == OriginSource::Track => format!(
            "make the stated origin and the poses agree:\n(1) if the poses are right, state the origin that they have over the fixes, \
             {}\n(2) if the stated origin is right, express the poses in its map",
            position_text(other)
        ),
        None => "write the origin that the map was made with at both places, or let both read one file".to_owned(),
    };
    // Files of one folder may be for two sites, and nothing shows which of them is used.
    let files_alone = matches!(
        (&reference.by, &other.by),
        (OriginSource::File(_), OriginSource::File(_))
    );
    let ceiling = if files_alone && distance_m > limits.site_m {
        Confidence::Hint
    } else {
        Confidence::Likely
    };
    let mut finding = Finding::new(severity, subject, message, other.place.clone())
        .confidence(other.reading.min(reference.reading).min(ceiling))
        .related(reference.place.clone(), "the first origin")
        .label("the second origin")
        .detail(detail)
        .help(help);
    if geoid_m.is_some() {
        finding = finding.relation("geoid");
    } else if two_drives {
        finding = finding.relation("origin-changed");
    }
    out.fail(finding.measured(measured));
}

/// Whether the two are one place if latitude and longitude of one of them are exchanged.
fn is_exchanged(reference: &LocalOrigin, other: &LocalOrigin, limits: &Limits) -> bool {
    let (latitude, longitude) = (other.at.latitude_rad, other.at.longitude_rad);
    let read = Geodetic::from_degrees(longitude.to_degrees(), latitude.to_degrees(), other.at.height_m);
    read.is_some_and(|at| between(reference, &LocalOrigin { at, ..other.clone() }).norm() <= limits.site_m)
}

fn exchanged(reference: &LocalOrigin, other: &LocalOrigin, subject: String) -> Finding {
    let message = format!(
        "{} and {} are one place with latitude and longitude exchanged in one of them",
        reference.who, other.who
    );
    let [one, two] = [reference, other].map(position_text);
    Finding::error(subject, message, other.place.clone())
        .confidence(other.reading.min(reference.reading).min(Confidence::Likely))
        .relation("lat-lon-swapped")
        .related(reference.place.clone(), "the first origin")
        .label("the second origin")
        .detail(format!(
            "As latitude and longitude, the first is {one}, the second {two}."
        ))
        .help("decide by a map which of the two is on the site, and exchange the two numbers in the other")
}

/// The undulation of the geoid, where it explains the whole difference.
fn geoid(a: &LocalOrigin, b: &LocalOrigin, apart: &Vector3<f64>, limits: &Limits) -> Option<f64> {
    let level = apart.xy().norm() <= limits.error_m && a.has_height && b.has_height;
    let undulation = undulation_m(&a.at).filter(|_| level)?;
    let explains = (apart.z.abs() - undulation.abs()).abs() <= limits.geoid_m && undulation.abs() >= limits.min_geoid_m;
    explains.then_some(undulation)
}
