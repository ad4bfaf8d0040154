//! Poses between frames that are rigid with each other, against the composition of the chain between them.

use std::fmt::Write;

use frames_lint::read::urdf::{MeshLookup, read};
use frames_lint::source::{Source, SourceId, SourceKind};
use frames_lint::world::World;
use proptest::prelude::*;

/// Links `l0`, `l1`, ...: each hangs on an earlier one by a fixed joint, or by a revolute one, or on nothing.
fn world_of(joints: &[(usize, u8, [f64; 6])]) -> World {
    let mut text = "<robot name=\"r\"><link name=\"l0\"/>".to_owned();
    for (number, (parent, kind, [x, y, z, roll, pitch, yaw])) in joints.iter().enumerate() {
        let child = number + 1;
        let _ = write!(text, "<link name=\"l{child}\"/>");
        let kind = match kind {
            0 => continue,
            1 => "revolute",
            _ => "fixed",
        };
        let _ = write!(
            text,
            "<joint name=\"j{child}\" type=\"{kind}\"><parent link=\"l{}\"/><child link=\"l{child}\"/>\
             <origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/></joint>",
            parent % child
        );
    }
    text.push_str("</robot>");
    let mut source = Source::new(SourceId(0), "robot.urdf", SourceKind::Urdf);
    source.text = text;
    let mut world = World::default();
    world.absorb(read(&mut source, &MeshLookup::default()));
    world
}

proptest! {
    #[test]
    fn poses_between_rigid_frames_are_those_of_the_chain(
        joints in prop::collection::vec((0_usize..100, 0_u8..6, prop::array::uniform6(-3.0..3.0)), 1..14),
    ) {
        let world = world_of(&joints);
        let graph = world.graph();
        let mut members = 0;
        for cluster in &graph.rigid().clusters {
            members += cluster.len();
            prop_assert!(cluster.is_sorted_by_key(|(frame, _)| frame));
        }
        prop_assert_eq!(members, graph.frames.len());
        for target in &graph.frames {
            for source in &graph.frames {
                let chain = graph.chain(target, source, |edge| edge.is_rigid);
                let between = graph.rigid().between(target, source);
                prop_assert_eq!(chain.is_some(), between.is_some());
                if let Some(((chain, _), between)) = chain.zip(between) {
                    let apart = chain.inv_mul(&between);
                    prop_assert!(apart.translation.vector.norm() < 1e-9 && apart.rotation.angle() < 1e-9);
                }
                let is_member = graph.rigid().cluster(target).iter().any(|(frame, _)| frame == source);
                prop_assert_eq!(is_member, between.is_some());
            }
        }
    }
}
