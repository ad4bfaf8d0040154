//! The ground as a robot's wheels show it.
//!
//! Must not judge.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Point3, Vector3};

use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::robot::{Joint, Link, NumberList, Shape};
use crate::world::{FrameId, World};

/// Parts of names of wheels.
const WHEELS: &[&str] = &["wheel", "caster", "castor", "tire", "tyre"];
/// Sine of the largest angle between the axis of a wheel and the ground.
const LEVEL: f64 = 0.05;

/// A wheel in a frame, with its joints at zero.
pub(crate) struct Wheel<'w> {
    /// Its link.
    pub(crate) link: &'w Link,
    /// Its centre, metres.
    centre: Point3<f64>,
    /// The direction of its axis; `None` for a ball.
    axis: Option<Vector3<f64>>,
    /// Metres.
    radius_m: f64,
}

impl Wheel<'_> {
    /// The height of its lowest point, metres.
    pub(crate) fn lowest_m(&self) -> f64 {
        self.centre.z - self.radius_m
    }

    /// Whether the other wheel is on the other side of the robot: left and right, not one behind the other.
    fn is_beside(&self, other: &Self) -> bool {
        let apart = other.centre - self.centre;
        let axes = self.axis.zip(other.axis);
        axes.is_some_and(|(one, two)| one.dot(&two).abs() > 0.9 && apart.dot(&one).abs() > self.radius_m / 2.0)
    }
}

/// The wheels on which a robot stands, the lowest first: at least two beside each other whose lowest points are within `same_m` of the lowest one of all
/// wheels. Empty where there are none, or where they contradict each other. Wheels with meshes only are not known.
pub(crate) fn standing<'w>(world: &'w World, footprint: &FrameId, same_m: f64) -> Vec<Wheel<'w>> {
    let mut wheels = wheels(world, footprint);
    wheels.sort_by(|a, b| a.lowest_m().total_cmp(&b.lowest_m()));
    let lowest_m = wheels.first().map_or(0.0, Wheel::lowest_m);
    wheels.retain(|wheel| wheel.lowest_m() - lowest_m <= same_m);
    let has_two = wheels.iter().any(|one| wheels.iter().any(|other| one.is_beside(other)));
    if has_two { wheels } else { Vec::new() }
}

fn wheels<'w>(world: &'w World, footprint: &FrameId) -> Vec<Wheel<'w>> {
    let is_usable = |edge: &Edge| edge.is_rigid || matches!(edge.origin, EdgeOrigin::Joint(_));
    let poses: BTreeMap<&FrameId, Isometry3<f64>> = world.graph().reach(footprint, is_usable).into_iter().collect();
    let mut wheels = Vec::new();
    for robot in &world.robots {
        // Of several joints to one link, the first counts.
        let joints = robot.joints.iter().rev();
        let joints: BTreeMap<&str, &Joint> = joints
            .filter_map(|joint| Some((joint.child.as_ref()?.value.as_str(), joint)))
            .collect();
        for link in &robot.links {
            let name = FrameId::new(link.name.value.as_str()).canonical();
            let joint = joints.get(link.name.value.as_str());
            if let (Some(pose), Some(joint)) = (poses.get(&name), joint) {
                wheels.extend(wheel(link, joint, pose));
            }
        }
    }
    wheels
}

/// A link as a wheel: its largest body with a horizontal axis, or a ball; of its collisions, else of its visuals.
fn wheel<'w>(link: &'w Link, joint: &Joint, footprint_from_link: &Isometry3<f64>) -> Option<Wheel<'w>> {
    let is_named = [&link.name.value, &joint.name.value].into_iter().any(|name| {
        let name = name.to_lowercase();
        WHEELS.iter().any(|word| name.contains(word))
    });
    let turns_about = joint
        .axis
        .as_ref()
        .and_then(NumberList::array::<3>)
        .map_or_else(Vector3::x, Vector3::from);
    let spin = (joint.kind.value == "continuous")
        .then(|| (footprint_from_link.rotation * turns_about).try_normalize(1e-6))
        .flatten();
    let bodies = if link.collisions.is_empty() {
        &link.visuals
    } else {
        &link.collisions
    };
    let round = bodies.iter().filter_map(|body| {
        let footprint_from_body = footprint_from_link * body.pose.isometry();
        let centre = footprint_from_body * Point3::origin();
        match body.shape {
            Shape::Cylinder([radius_m, length_m]) => {
                let axis = footprint_from_body.rotation * Vector3::z();
                let spins = spin.is_some_and(|spin| spin.dot(&axis).abs() > 0.9) && length_m < 2.0 * radius_m;
                (axis.z.abs() < LEVEL && (is_named || spins)).then_some((centre, Some(axis), radius_m))
            }
            Shape::Sphere(radius_m) => is_named.then_some((centre, None, radius_m)),
            Shape::Box(_) | Shape::Mesh { .. } => None,
        }
    });
    let (centre, axis, radius_m) = round.max_by(|a, b| a.2.total_cmp(&b.2))?;
    Some(Wheel {
        link,
        centre,
        axis,
        radius_m,
    })
}
