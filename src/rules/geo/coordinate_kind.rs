//! GEO03: positions in another kind of coordinates than their frame has.

mod kinds;

use crate::analysis::geo::columns::{Column, columns};
use crate::analysis::geo::kinds::{Kind, Limits};
use crate::analysis::{motion::Motion, names, names::Standard};
use crate::rules::geo::coordinate_kind::kinds::{angle, earth_centred, grid, mixed};
use crate::rules::prelude::*;
use crate::world::{FrameId, World};

pub(crate) struct CoordinateKind;

impl Rule for CoordinateKind {
    const NEEDS: &'static [Need] = &[Need::Frames];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
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
        out.missing(
            "positions",
            "no pose, transform or file has a non-zero position in a world frame (`map`, `odom`, `earth`, ...)",
        );
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
            "positions on {} are {:.0} km from the origin of `{frame}`: neither local, nor UTM, nor Earth-centred",
            far.subject,
            far.middle.norm() / 1e3
        );
        out.not_applicable(subject, why);
    } else if sound {
        out.pass(subject, columns.iter().map(|column| size(column, limits)));
    }
}

fn size(column: &Column, limits: &Limits) -> Measured {
    let (distance, samples) = (column.middle.norm(), column.count as u64);
    if column.kind.is_angle() {
        // Two angles and a height have no length: the kind was judged by each of them.
        let what = format!("distance from the origin if these were metres, {}", column.subject);
        return Measured::new(what, distance, "m").samples(samples);
    }
    Measured::new(format!("distance from the origin, {}", column.subject), distance, "m")
        .limit(limits.local_m)
        .samples(samples)
}
