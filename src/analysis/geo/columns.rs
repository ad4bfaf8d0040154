//! Positions by the frame that they are expressed in: poses, TF and files.
//!
//! Must not judge.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::analysis::geo::kinds::{Kind, Limits, kind};
use crate::analysis::{geo::earth::is_earth, geo::overlay::geodetic, motion::BagMotion, names};
use crate::math::{geodesy::Geodetic, stats::median};
use crate::source::{Confidence, Place};
use crate::world::{BagEvidence, ClaimKind, FrameId, World};

/// Positions of one stream or statement.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// What reports call it.
    pub(crate) subject: String,
    /// Where it begins.
    pub(crate) place: Place,
    /// The median of each coordinate.
    pub(crate) middle: Vector3<f64>,
    /// How many positions.
    pub(crate) count: usize,
    /// Their kind.
    pub(crate) kind: Kind,
    /// Whether fixes confirm it.
    pub(crate) is_confirmed: bool,
    /// How sure the reading is.
    pub(crate) reading: Confidence,
}

/// The columns of a recording and of the files by their frame; frames that are no world frames and hold local positions alone are
/// left out.
pub(crate) fn columns(
    world: &World,
    of: Option<(&BagEvidence, &BagMotion)>,
    limits: &Limits,
) -> BTreeMap<FrameId, Vec<Column>> {
    let mut all: BTreeMap<FrameId, Vec<Column>> = BTreeMap::new();
    let fixes = of.map(|(_, motion)| middles(motion)).unwrap_or_default();
    let mut add = |frame: &FrameId, child: Option<&FrameId>, made: Option<Column>| {
        let Some(column) = made else { return };
        // The origin of one map in another may be anywhere, and does not show how positions are expressed in either.
        // The Earth's centre is 6370 km from every map: GEO02 judges the pose of a map on the Earth.
        if child.is_some_and(is_earth) {
            return;
        }
        let between = child.is_some_and(names::is_world);
        if !(between && column.kind != Kind::EarthCentred) {
            all.entry(frame.clone()).or_default().push(column);
        }
    };
    if let Some((bag, motion)) = of {
        for poses in &motion.poses {
            let positions: Vec<Vector3<f64>> = poses.rows().map(|timed| timed.row.position.into()).collect();
            // An origin on a topic holds degrees by design.
            let is_origin = FrameId::new(poses.topic.as_str()).has_token("origin");
            if let Some(frame) = poses.frame.as_ref().filter(|_| !is_origin) {
                let made = column(poses.subject.clone(), poses.place(), &positions, &fixes, limits);
                add(frame, poses.child.as_ref(), made);
            }
        }
        for edge in bag.tf.iter().filter(|edge| edge.is_static) {
            let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
            let positions: Vec<_> = edge.samples.iter().map(|at| at.pose.translation_m.into()).collect();
            let place = Place::message(bag.source, edge.first_at.clone());
            let subject = format!("TF `{parent}` -> `{child}` on {}", edge.topic);
            add(
                &parent,
                Some(&child),
                column(subject, place, &positions, &fixes, limits),
            );
        }
    }
    let of_files = world
        .claims
        .iter()
        .filter(|claim| matches!(claim.kind, ClaimKind::File { .. }));
    for claim in of_files.filter(|claim| claim.has_translation) {
        if let (Some((target, source)), Some(pose)) = (&claim.frames, &claim.pose) {
            let made = column(
                claim.name(),
                claim.place.clone(),
                &[pose.translation_m.into()],
                &fixes,
                limits,
            );
            let made = made.map(|column| Column {
                reading: claim.reading,
                ..column
            });
            add(&target.canonical(), Some(&source.canonical()), made);
        }
    }
    all.retain(|frame, columns| names::is_world(frame) || columns.iter().any(|column| column.kind != Kind::Local));
    all
}

/// A column; `None` where all positions are zero.
fn column(
    subject: String,
    place: Place,
    positions: &[Vector3<f64>],
    fixes: &[Geodetic],
    limits: &Limits,
) -> Option<Column> {
    let nonzero: Vec<&Vector3<f64>> = positions.iter().filter(|p| p.norm() > 0.0).collect();
    let of =
        |coordinate: fn(&Vector3<f64>) -> f64| median(&nonzero.iter().map(|p| coordinate(p)).collect::<Vec<f64>>());
    let middle = Vector3::new(of(|p| p.x)?, of(|p| p.y)?, of(|p| p.z)?);
    let mut kinds = fixes.iter().map(|fix| kind(&middle, Some(fix), limits));
    let (kind, is_confirmed) = kinds
        .find(|(_, is_confirmed)| *is_confirmed)
        .unwrap_or_else(|| kind(&middle, None, limits));
    Some(Column {
        subject,
        place,
        middle,
        count: nonzero.len(),
        kind,
        is_confirmed,
        reading: Confidence::Certain,
    })
}

/// The median place of each receiver.
fn middles(motion: &BagMotion) -> Vec<Geodetic> {
    let middle = |fixes: &crate::analysis::motion::Stream<crate::world::motion::FixRow>| {
        let places: Vec<Geodetic> = fixes.rows().filter_map(|timed| geodetic(&timed.row)).collect();
        let of = |coordinate: fn(&Geodetic) -> f64| median(&places.iter().map(coordinate).collect::<Vec<f64>>());
        Some(Geodetic {
            latitude_rad: of(|place| place.latitude_rad)?,
            longitude_rad: of(|place| place.longitude_rad)?,
            height_m: of(|place| place.height_m)?,
        })
    };
    motion.fixes.iter().filter_map(middle).collect()
}
