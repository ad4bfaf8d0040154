//! The beams of an Ouster by its metadata: where they begin, and how many there are. Part of SENSOR02.

use crate::analysis::ouster::Part;
use crate::tables::OusterPart;
use crate::verdict::Judge;
use crate::verdict::{Finding, Measured};
use crate::world::{OusterMetadata, World};
use serde::Deserialize;

/// Judges the beams of all metadata.
pub(crate) fn judge(world: &World, parts: &[Part<'_>], limits: &Limits, out: &mut Judge) {
    for metadata in &world.ousters {
        judge_origin(world, metadata, parts, limits, out);
        judge_angles(world, metadata, out);
    }
}

/// `lidar_origin_to_beam_origin_mm` compared with `beam_to_lidar_transform`, else with sensors of the same model.
fn judge_origin(world: &World, metadata: &OusterMetadata, parts: &[Part<'_>], limits: &Limits, out: &mut Judge) {
    let subject = format!(
        "`lidar_origin_to_beam_origin_mm` in {}",
        world.path(metadata.place.source)
    );
    let Some(stated) = &metadata.beam_origin_mm else {
        let why = "the metadata do not have this key, as with firmware before 2.0";
        return out.missing(subject, why);
    };
    let is_beside =
        |part: &&Part<'_>| part.kind == OusterPart::Beam && part.statement.place.source == metadata.place.source;
    let beside = parts.iter().find(is_beside);
    let (known, relation): (Vec<(f64, String)>, _) = if let Some(part) = beside {
        let x_mm = part.pose.translation.vector.x * 1e3;
        (vec![(x_mm, "`beam_to_lidar_transform`".to_owned())], "beam-origin")
    } else {
        let rows = world.tables.ouster_places(OusterPart::Beam);
        let rows = rows.filter(|row| row.may_be_of(metadata.product.as_deref(), metadata.image.as_deref()));
        (rows.map(|row| (row.xyz_mm[0], row.models.clone())).collect(), "place")
    };
    let off = |known: &(f64, String)| (known.0 - stated.value).abs();
    let Some(nearest) = known.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else {
        let why =
            "the table has no metadata of this model, and the file has no `beam_to_lidar_transform` to compare with";
        return out.missing(subject, why);
    };
    let measured = Measured::new("difference of the two values", off(nearest), "mm").limit(limits.max_beam_mm);
    if off(nearest) <= limits.max_beam_mm {
        return out.pass(subject, [measured]);
    }
    let message = format!(
        "`lidar_origin_to_beam_origin_mm` is {:.3} mm, but {} has {:.3} mm",
        stated.value, nearest.1, nearest.0
    );
    let finding = if relation == "place" {
        Finding::warning(subject, message, stated.place.clone()).hint()
    } else {
        Finding::error(subject, message, stated.place.clone()).likely()
    };
    out.fail(
        finding
            .relation(relation)
            .detail("All points are computed with this value.")
            .help("read the metadata from the sensor again")
            .measured(measured),
    );
}

/// Each beam has an azimuth and an altitude.
fn judge_angles(world: &World, metadata: &OusterMetadata, out: &mut Judge) {
    let subject = format!("angles of the beams in {}", world.path(metadata.place.source));
    let (Some(azimuths), Some(altitudes)) = (&metadata.azimuths, &metadata.altitudes) else {
        return out.missing(subject, "`beam_azimuth_angles` or `beam_altitude_angles` is missing");
    };
    let rows = metadata.rows.unwrap_or(azimuths.count);
    let [a, b] = [azimuths.count, altitudes.count];
    let counts = [("`beam_azimuth_angles`", a), ("`beam_altitude_angles`", b)];
    let measured = [
        Measured::count("angles in `beam_azimuth_angles`", a as usize).expected(f64::from(rows)),
        Measured::count("angles in `beam_altitude_angles`", b as usize).expected(f64::from(rows)),
    ];
    let broken = azimuths.broken + altitudes.broken;
    // An altitude beyond 90 deg is not in degrees.
    let is_tilt = altitudes.range_deg.iter().all(|angle| angle.abs() <= 90.0);
    if a == rows && b == rows && broken == 0 && is_tilt {
        return out.pass(subject, measured);
    }
    let (what, place) = if broken > 0 {
        (format!("{broken} beam angles are not numbers"), azimuths)
    } else if let Some((key, count)) = counts.into_iter().find(|(_, count)| *count != rows) {
        let place = if a == rows { altitudes } else { azimuths };
        (
            format!("{key} has {count} angles, expected {rows}: one for each row"),
            place,
        )
    } else {
        let [low, high] = altitudes.range_deg;
        (
            format!("beam altitudes from {low} to {high} are not in degrees"),
            altitudes,
        )
    };
    let finding = Finding::error(subject, what, place.place.clone())
        .label("angles of the beams")
        .likely()
        .relation("beam-angles")
        .detail("All points are computed with these angles.")
        .help("read the metadata from the sensor again");
    out.fail(finding.measured(measured));
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) max_off_mm: f64,
    pub(crate) max_beam_mm: f64,
    pub(crate) max_turn_deg: f64,
    pub(crate) known_deg: f64,
}
