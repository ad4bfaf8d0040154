//! The direction in which the motion of a platform hides the position of a sensor.

use nalgebra::{UnitQuaternion, Vector3};

use crate::math::excitation::{Excitation, LEAST, LEAST_OFF, LEAST_RAD, OFF_RAD, rotations};
use crate::world::World;
use crate::world::motion::PoseRow;

use super::streams::{MovingFrame, Stream};
use super::turns::rotation;

/// Longest duration of a rotation, seconds.
const LONGEST_S: f64 = 30.0;

/// A direction along which nothing in the data depends on the position of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct HiddenDirection {
    /// A unit vector in the axes of the platform.
    pub axis: [f64; 3],
    /// Why, as a clause.
    pub why: String,
}

/// The rotations of a platform, by its poses. `None` where there are no poses.
pub struct Rotations(Option<Excitation>);

impl Rotations {
    /// Of the stream of poses with the most rotations; that of the base comes first.
    pub fn of(world: &World) -> Option<Self> {
        let streams =
            Stream::all(world).filter(|stream| matches!(stream.moving, MovingFrame::Base | MovingFrame::Other));
        let each = streams.filter_map(|stream| {
            let orientations = |rows: &[PoseRow]| -> Vec<(f64, UnitQuaternion<f64>)> {
                let rows = rows
                    .iter()
                    .map(|row| (row.log_ns as f64 / 1e9, rotation(row.orientation)));
                rows.collect()
            };
            let mut sections = stream.pose_sections(world).peekable();
            sections.peek()?;
            let vectors = sections.flat_map(|rows| rotations(&orientations(rows), LEAST_RAD, LONGEST_S));
            let vectors: Vec<Vector3<f64>> = vectors.map(|rotation| rotation.vector).collect();
            Some(((stream.moving == MovingFrame::Base, vectors.len()), vectors))
        });
        let (_, vectors) = each.max_by_key(|(order, _)| *order)?;
        Some(Self(Excitation::of(vectors)))
    }

    /// Where these rotations hide a position along an axis of the platform.
    pub fn hide(&self, along: &Vector3<f64>) -> Option<HiddenDirection> {
        let Some(found) = self.0.as_ref().filter(|found| found.count() >= LEAST) else {
            return Some(HiddenDirection {
                axis: (*along).into(),
                why: "this motion cannot show it: the platform hardly rotates, and without rotation every position of a sensor moves alike"
                    .to_owned(),
            });
        };
        let (main, off) = (found.main_axis(), found.off_axis(OFF_RAD));
        let is_along = main.dot(along).abs() >= OFF_RAD.cos();
        let name = along
            .iter()
            .zip(["x", "y", "z"])
            .find(|(value, _)| **value > 0.5)
            .map_or("z", |(_, name)| name);
        let how_many = if off == 0 {
            format!("all {}", found.count())
        } else {
            format!("{} of {}", found.count() - off, found.count())
        };
        (is_along && off < LEAST_OFF).then(|| HiddenDirection {
            axis: (main * main.dot(along).signum()).into(),
            why: format!(
                "this motion cannot show it: {how_many} rotations of the platform are about its {name} axis, and a position along that axis \
                 changes nothing that is measured"
            ),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_about_one_axis_hide_what_is_along_it() {
        let of = |vectors: Vec<Vector3<f64>>| Rotations(Excitation::of(vectors));
        let yaw = of((0..20).map(|_| Vector3::z() * 0.2).collect());
        let found = yaw.hide(&Vector3::z()).map(|hidden| hidden.axis);
        assert!(
            found.is_some_and(|[x, y, z]| x.abs() < 1e-9 && y.abs() < 1e-9 && (z - 1.0).abs() < 1e-9),
            "{found:?}"
        );
        assert_eq!((yaw.hide(&Vector3::x()), yaw.hide(&Vector3::y())), (None, None));
        let both = of((0..20)
            .map(|k| if k % 2 == 0 { Vector3::z() } else { Vector3::y() } * 0.2)
            .collect());
        assert_eq!(both.hide(&Vector3::z()), None);
        let still = of(Vec::new());
        assert!(
            [Vector3::x(), Vector3::y(), Vector3::z()]
                .iter()
                .all(|axis| still.hide(axis).is_some())
        );
    }
}
