//! GEO10: a map of points and the stated origin of the map, which do not belong together.

use crate::analysis::point_files::{NamedPoints, position, utm_distance_m};
use crate::math::utm;
use crate::rules::prelude::*;
use crate::world::EarthOrigin;
use crate::world::point_file::{PointFormat, PointsSeen, StatedCrs};

pub(crate) struct PointFileOrigin;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    far_m: f64,
    local_m: f64,
}

/// Projections of Autoware that give local coordinates: within a square of the grid, or around the origin.
const LOCAL: [&str; 4] = ["MGRS", "LocalCartesian", "LocalCartesianUTM", "TransverseMercator"];

impl Rule for PointFileOrigin {
    const NEEDS: &'static [Need] = &[Need::Points];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for points in NamedPoints::all(world) {
            let subject = points.subject("origin");
            let Some(seen) = &points.file.seen else {
                out.too_little(subject, "no point was read");
                continue;
            };
            let zone = points.file.crs.as_ref().and_then(StatedCrs::utm);
            let local = world.origins.iter().find(|origin| is_local(origin));
            match (zone, local) {
                (Some(zone), _) => judge_grid(subject, (&points, seen), zone, &world.origins, limits, out),
                (None, Some(origin)) if points.file.format == PointFormat::Pcd => {
                    judge_local(subject, (&points, seen), origin, limits, out);
                }
                _ => out.not_applicable(
                    subject,
                    "no origin is stated that it can be compared with: the file needs a UTM system, or a map_projector_info.yaml beside a PCD",
                ),
            }
        }
    }
}

fn is_local(origin: &EarthOrigin) -> bool {
    origin.projection.as_deref().is_some_and(|name| LOCAL.contains(&name))
}

/// Coordinates in a UTM zone against the nearest origin.
fn judge_grid(
    subject: String,
    (points, seen): (&NamedPoints, &PointsSeen),
    zone: (u8, bool),
    origins: &[EarthOrigin],
    limits: &Limits,
    out: &mut Judge,
) {
    let nearest = origins.iter().filter_map(|origin| {
        let at = position(origin)?;
        Some((origin, at, utm_distance_m(seen, &at, zone)?))
    });
    let Some((origin, at, distance_m)) = nearest.min_by(|a, b| a.2.total_cmp(&b.2)) else {
        return out.missing(subject, "no file states the latitude and longitude of an origin");
    };
    let measured = Measured::new("distance of the points from the origin", distance_m, "m")
        .limit(limits.far_m)
        .samples(points.file.read);
    if distance_m <= limits.far_m {
        return out.pass(subject, measured);
    }
    // What a wrong number of the zone would explain.
    let own = utm::zone(&at).map(|own| (own, at.latitude_rad >= 0.0));
    let is_near = |zone| utm_distance_m(seen, &at, zone).is_some_and(|distance_m| distance_m <= limits.far_m);
    let right = own.into_iter().chain([(zone.0, !zone.1)]).find(|other| is_near(*other));
    let name = points.name();
    let word = |(zone, is_north): (u8, bool)| format!("{zone}{}", if is_north { " N" } else { " S" });
    let finding = match right {
        Some(right) => Finding::error(
            subject,
            format!(
                "`{name}`: states UTM zone {}, but its points are in zone {}",
                word(zone),
                word(right)
            ),
            points.file.place.clone(),
        )
        .relation("utm-zone")
        .help(format!(
            "write zone {} into the header: with it, the points are at the origin",
            word(right)
        )),
        None => Finding::warning(
            subject,
            format!(
                "`{name}`: the points are {:.0} km from the origin of the map",
                distance_m / 1e3
            ),
            points.file.place.clone(),
        )
        .likely()
        .relation("far")
        .help("check whether the file and the origin are of one site; if they are, one of them states the wrong place"),
    };
    out.fail(finding.related(origin.place.clone(), "the origin").measured(measured));
}

/// A PCD of a platform whose projection gives local coordinates.
fn judge_local(
    subject: String,
    (points, seen): (&NamedPoints, &PointsSeen),
    origin: &EarthOrigin,
    limits: &Limits,
    out: &mut Judge,
) {
    let [x, y, _] = seen.middle();
    let distance_m = x.abs().max(y.abs());
    let measured = Measured::new("largest coordinate of the middle of the points", distance_m, "m")
        .limit(limits.local_m)
        .samples(points.file.read);
    if distance_m <= limits.local_m {
        return out.pass(subject, measured);
    }
    let projection = origin.projection.as_deref().unwrap_or_default();
    let message = format!(
        "`{}`: the points are at ({:.0}, {:.0}) km, where {projection} gives local coordinates",
        points.name(),
        x / 1e3,
        y / 1e3
    );
    let place = points
        .file
        .coordinates_at
        .as_ref()
        .unwrap_or(&points.file.place)
        .clone();
    let finding = Finding::error(subject, message, place)
        .likely()
        .relation("not-local")
        .related(origin.place.clone(), "the projection")
        .help("subtract the origin of the projection from the points, in double precision, or state the projection that they are in");
    out.fail(finding.measured(measured));
}
