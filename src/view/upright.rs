//! How a tree of frames is rotated so that it is shown upright, for any axes of its root.

use nalgebra::UnitQuaternion;

use crate::math::constants::AxisTurn;
use crate::verdict::Finding;
use crate::world::conventions::{BodyAxes, Subject, WorldAxes};
use crate::world::{FrameId, World};

/// A rotation with the reason for it.
pub(super) struct UprightTurn {
    /// `seen_from_root`; the frame `seen` has z up.
    pub(super) turn: UnitQuaternion<f64>,
    /// The reason, for the root's label; `None` without a rotation.
    pub(super) why: Option<String>,
}

/// By the declaration for the root, else by its name, else by findings.
pub(super) fn upright(world: &World, root: &FrameId, findings: &[&Finding]) -> UprightTurn {
    let turned = |turn: AxisTurn, why: &str| UprightTurn {
        turn: turn.quaternion(),
        why: Some(why.to_owned()),
    };
    let declared = world.conventions.of(&Subject {
        file: "",
        topic: None,
        frames: &[root],
    });
    let convention = declared.map(|declared| declared.convention).unwrap_or_default();
    match (convention.world, convention.body) {
        (Some(WorldAxes::Ned), _) => return turned(AxisTurn::NedEnu, "declared as NED"),
        (Some(WorldAxes::Nwu), _) => return turned(AxisTurn::Z90, "declared as NWU"),
        (_, Some(BodyAxes::Frd)) => return turned(AxisTurn::FluFrd, "declared as FRD"),
        (Some(WorldAxes::Enu), _) | (_, Some(BodyAxes::Flu)) => return none(),
        (None, None) => {}
    }
    for (word, turn) in [
        ("ned", AxisTurn::NedEnu),
        ("frd", AxisTurn::FluFrd),
        ("optical", AxisTurn::Optical),
    ] {
        if root.has_token(word) {
            return turned(turn, &format!("{} by its name", word.to_uppercase()));
        }
    }
    let subject = format!("z of `{root}`");
    let measured = findings.iter().filter(|finding| finding.subject.contains(&subject));
    let mut measured = measured.filter_map(|finding| match finding.relation.as_deref()? {
        "z-down" => Some((AxisTurn::FluFrd, format!("z points down, measured by {}", finding.rule))),
        "optical" => Some((AxisTurn::Optical, format!("optical axes, measured by {}", finding.rule))),
        _ => None,
    });
    measured.next().map_or_else(none, |(turn, why)| turned(turn, &why))
}

fn none() -> UprightTurn {
    UprightTurn {
        turn: UnitQuaternion::identity(),
        why: None,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn up_of(root: &str, up_in_root: [f64; 3]) -> f64 {
        let upright = upright(&World::default(), &FrameId::new(root), &[]);
        (upright.turn * Vector3::from(up_in_root)).z
    }

    #[test]
    fn up_is_up_for_every_axes_that_a_name_promises() {
        for (root, up_in_root) in [
            ("map", [0.0, 0.0, 1.0]),
            ("map_ned", [0.0, 0.0, -1.0]),
            ("base_link_frd", [0.0, 0.0, -1.0]),
            ("camera_optical_frame", [0.0, -1.0, 0.0]),
        ] {
            assert!((up_of(root, up_in_root) - 1.0).abs() < 1e-12, "{root}");
        }
    }

    #[test]
    fn north_and_east_are_where_they_belong() {
        let seen =
            |axis: [f64; 3]| upright(&World::default(), &FrameId::new("odom_ned"), &[]).turn * Vector3::from(axis);
        assert!(
            (seen([1.0, 0.0, 0.0]) - Vector3::y()).norm() < 1e-12,
            "north is seen along y"
        );
        assert!(
            (seen([0.0, 1.0, 0.0]) - Vector3::x()).norm() < 1e-12,
            "east is seen along x"
        );
    }
}
