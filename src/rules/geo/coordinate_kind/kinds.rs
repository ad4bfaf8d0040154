//! What GEO03 says of a kind of coordinates in the wrong frame. Subjects are put in by the rule.

use crate::verdict::Finding;
use crate::world::FrameId;

use crate::analysis::geo::columns::Column;
use crate::analysis::geo::kinds::single_precision_step_m;

/// `x, y, z`, with the digits that matter.
fn told(column: &Column) -> String {
    let (p, digits) = (column.middle, if column.kind.is_angle() { 5 } else { 1 });
    format!("({:.digits$}, {:.digits$}, {:.digits$})", p.x, p.y, p.z)
}

fn confirmed(column: &Column) -> &'static str {
    if column.is_confirmed {
        ", as the fixes beside it say"
    } else {
        ", by their size"
    }
}

/// What the positions of a column are.
fn positions(frame: &FrameId, column: &Column) -> String {
    format!(
        "positions in `{frame}` on {}, {} in the middle, are {}{}",
        column.subject,
        told(column),
        column.kind.words(),
        confirmed(column)
    )
}

/// Degrees where metres belong.
pub(crate) fn angle(frame: &FrameId, column: &Column) -> Finding {
    let message = format!("{}: a position is in metres", positions(frame, column));
    Finding::error("", message, column.place.clone()).likely().relation("degrees").help(
        "make metres of them, in a tangent plane or on a grid, before they become a pose; degrees belong into a NavSatFix or a GeoPoint",
    )
}

/// Global coordinates beside local ones.
pub(crate) fn mixed(frame: &FrameId, column: &Column, local: &Column) -> Finding {
    let message = format!(
        "two kinds of coordinates in `{frame}`: on {} positions are {}{} {}, on {} {} {}",
        column.subject,
        column.kind.words(),
        confirmed(column),
        told(column),
        local.subject,
        local.kind.words(),
        told(local)
    );
    let distance_km = (column.middle - local.middle).norm() / 1e3;
    Finding::error("", message, column.place.clone())
        .likely()
        .relation("mixed-coordinates")
        .related(local.place.clone(), local.kind.words())
        .help(format!(
            "whoever takes both puts them {distance_km:.0} km apart: give the first a frame of its own (`utm`, `earth`) and state where \
             `{frame}` lies in it"
        ))
}

/// Earth-centred positions in a local frame.
pub(crate) fn earth_centred(frame: &FrameId, column: &Column) -> Finding {
    let message = positions(frame, column);
    Finding::error("", message, column.place.clone()).likely().relation("ecef").help(format!(
        "z does not point up there, and plans in x and y are of no use: name the frame `earth`, and publish `earth` -> `{frame}` with a \
         local `{frame}`"
    ))
}

/// Eastings and northings in a local frame.
pub(crate) fn grid(frame: &FrameId, column: &Column) -> Finding {
    let step_m = single_precision_step_m(column.middle.amax());
    let message = format!(
        "{}: numbers in single precision step by {step_m} m there",
        positions(frame, column)
    );
    let finding = Finding::note("", message, column.place.clone()).relation("utm").help(format!(
        "it is allowed; clouds, meshes and viewers hold single precision, though: take an origin nearby off in `{frame}`, or call the \
         frame `utm` and publish `utm` -> `{frame}`"
    ));
    if column.is_confirmed {
        finding.likely()
    } else {
        finding.hint()
    }
}
