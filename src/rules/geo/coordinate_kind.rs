//! GEO03: positions that are not the kind of coordinates that their frame has.

use serde::Deserialize;

use crate::rules::motion::Motion;
use crate::rules::names::{self, Standard};
use crate::rules::{Evidence, Need};
use crate::rules::{Judge, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::{FrameId, World};

use super::columns::{Column, columns};
use super::kinds::{Kind, single_precision_step_m};

/// GEO03.
pub struct CoordinateKind;

/// Limits of GEO03.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    pub(super) local_m: f64,
    pub(super) earth_least_m: f64,
    pub(super) earth_most_m: f64,
    pub(super) utm_least_m: f64,
    pub(super) utm_easting_m: f64,
    pub(super) utm_northing_m: f64,
    pub(super) height_m: f64,
    pub(super) near_m: f64,
    pub(super) agree_deg: f64,
    pub(super) least_deg: f64,
}

impl Rule for CoordinateKind {
    const PAGE: &'static str = include_str!("../../../rules/geo/coordinate-kind.md");
    const NEEDS: &'static [Need] = &[Need::Frames];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let motion = Motion::of(world);
        let bags = world.bags.iter().zip(&motion.bags);
        for of in bags {
            judge_all(world, columns(world, Some(of), limits), limits, out);
        }
        if world.bags.is_empty() {
            judge_all(world, columns(world, None, limits), limits, out);
        }
    }
}

type Columns = std::collections::BTreeMap<FrameId, Vec<Column>>;

fn judge_all(world: &World, all: Columns, limits: &Limits, out: &mut Judge) {
    if all.is_empty() && !world.bags.is_empty() {
        let why = "no pose, transform or file tells a position in a frame of the world, but for zeros";
        out.not_evaluated("positions", NotEvaluated::MissingInput, why);
    }
    for (frame, columns) in all {
        judge_frame(&frame, &columns, limits, out);
    }
}

fn judge_frame(frame: &FrameId, columns: &[Column], limits: &Limits, out: &mut Judge) {
    let subject = format!("frame `{frame}`");
    let is_local = matches!(names::standard(frame), Some((_, Standard::Map | Standard::Odom)));
    let local = columns.iter().find(|column| column.kind == Kind::Local);
    let mut sound = true;
    for column in columns {
        let made = match column.kind {
            kind if kind.is_angle() => Some(angle(frame, column)),
            Kind::EarthCentred | Kind::Utm if local.is_some() => local.map(|local| mixed(frame, column, local)),
            Kind::EarthCentred if is_local => Some(earth_centred(frame, column)),
            Kind::Utm if is_local => Some(grid(frame, column)),
            _ => None,
        };
        if let Some(finding) = made {
            sound = false;
            let finding = Finding {
                subject: subject.clone(),
                ..finding
            };
            out.fail(finding.confidence(column.reading).measured(size(column, limits)));
        }
    }
    if let Some(far) = columns.iter().find(|column| column.kind == Kind::Far).filter(|_| sound) {
        let why = format!(
            "positions on {} lie {:.0} km from the origin of `{frame}`: neither local, nor on the UTM grid, nor on the Earth",
            far.subject,
            far.middle.norm() / 1e3
        );
        out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    } else if sound {
        out.pass(subject, columns.iter().map(|column| size(column, limits)));
    }
}

fn size(column: &Column, limits: &Limits) -> Measured {
    Measured::new(
        format!("distance from the origin, {}", column.subject),
        column.middle.norm(),
        "m",
    )
    .limit(limits.local_m)
    .samples(column.count as u64)
}

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

fn angle(frame: &FrameId, column: &Column) -> Finding {
    let message = format!(
        "positions in `{frame}` on {}, {} in the middle, are {}{}: a position is in metres",
        column.subject,
        told(column),
        column.kind.words(),
        confirmed(column)
    );
    Finding::error("", message, column.place.clone()).likely().relation("degrees").help(
        "make metres of them, in a tangent plane or on a grid, before they become a pose; degrees belong into a NavSatFix or a GeoPoint",
    )
}

fn mixed(frame: &FrameId, column: &Column, local: &Column) -> Finding {
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

fn earth_centred(frame: &FrameId, column: &Column) -> Finding {
    let message = format!(
        "positions in `{frame}` on {}, {} in the middle, are {}{}",
        column.subject,
        told(column),
        column.kind.words(),
        confirmed(column)
    );
    Finding::error("", message, column.place.clone()).likely().relation("ecef").help(format!(
        "z does not point up there, and plans in x and y are of no use: name the frame `earth`, and publish `earth` -> `{frame}` with a \
         local `{frame}`"
    ))
}

fn grid(frame: &FrameId, column: &Column) -> Finding {
    let step_m = single_precision_step_m(column.middle.amax());
    let message = format!(
        "positions in `{frame}` on {}, {} in the middle, are {}{}: numbers in single precision step by {step_m} m there",
        column.subject,
        told(column),
        column.kind.words(),
        confirmed(column)
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
