//! The findings of GEO03 on coordinates in the wrong frame. The rule sets their subjects.

use crate::verdict::Finding;
use crate::world::FrameId;

use crate::analysis::geo::columns::Column;
use crate::analysis::geo::kinds::{Kind, single_precision_step_m};

/// `(x, y, z)`, with the digits that matter.
fn coordinates(column: &Column) -> String {
    let (p, digits) = (column.middle, if column.kind.is_angle() { 5 } else { 1 });
    format!("({:.digits$}, {:.digits$}, {:.digits$})", p.x, p.y, p.z)
}

/// Where the positions of a column are, and what shows their kind.
fn evidence(column: &Column) -> String {
    let by = if column.is_confirmed {
        "the GNSS fixes of the recording confirm that"
    } else {
        "as far as the size of the numbers shows,"
    };
    format!(
        "Median position: {}; {by} these are {}.",
        coordinates(column),
        column.kind.words()
    )
}

/// What the positions of a column are.
fn positions(frame: &FrameId, column: &Column) -> String {
    format!("{}: positions in `{frame}` are {}", column.subject, column.kind.words())
}

/// Degrees where metres belong.
pub(crate) fn angle(frame: &FrameId, column: &Column) -> Finding {
    let message = format!("{}, not metres", positions(frame, column));
    Finding::error("", message, column.place.clone())
        .likely()
        .relation("degrees")
        .detail(evidence(column))
        .help("convert latitude and longitude to metres (tangent plane or UTM) before filling a pose, or publish a NavSatFix or GeoPoint")
}

/// Global coordinates beside local ones.
pub(crate) fn mixed(frame: &FrameId, column: &Column, local: &Column) -> Finding {
    let message = format!(
        "`{frame}` mixes {} ({}) with {} ({})",
        column.kind.words(),
        column.subject,
        local.kind.words(),
        local.subject
    );
    let distance_km = (column.middle - local.middle).norm() / 1e3;
    let own = if column.kind == Kind::Utm { "utm" } else { "earth" };
    Finding::error("", message, column.place.clone())
        .likely()
        .relation("mixed-coordinates")
        .detail(format!(
            "{} The median of the local positions is {}: {distance_km:.0} km away from the other median.",
            evidence(column),
            coordinates(local)
        ))
        .related(local.place.clone(), local.kind.words())
        .help(format!(
            "publish the {} in the frame `{own}`, and the transform `{own}` -> `{frame}`",
            column.kind.words()
        ))
}

/// Earth-centred positions in a local frame.
pub(crate) fn earth_centred(frame: &FrameId, column: &Column) -> Finding {
    Finding::error("", positions(frame, column), column.place.clone())
        .likely()
        .relation("ecef")
        .detail(format!(
            "{} In Earth-centred coordinates z does not point up, and x and y span no level plane.",
            evidence(column)
        ))
        .help(format!(
            "name the frame of these positions `earth`, and publish `earth` -> `{frame}` with a local origin of `{frame}`"
        ))
}

/// Eastings and northings in a local frame.
pub(crate) fn grid(frame: &FrameId, column: &Column) -> Finding {
    let step_m = single_precision_step_m(column.middle.amax());
    let message = format!(
        "{}: positions are UTM coordinates, {:.0} km from the origin of `{frame}`",
        column.subject,
        column.middle.norm() / 1e3
    );
    let finding = Finding::note("", message, column.place.clone())
        .relation("utm")
        .detail(format!(
            "{} This is allowed, but clouds, meshes and viewers use float32, which has steps of {step_m} m there.",
            evidence(column)
        ))
        .help(format!(
            "subtract a nearby origin from the positions, and publish that origin as `utm` -> `{frame}`"
        ));
    if column.is_confirmed {
        finding.likely()
    } else {
        finding.hint()
    }
}
