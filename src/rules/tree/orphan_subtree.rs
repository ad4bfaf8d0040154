//! TREE01: frames that no chain connects to the rest.

use std::collections::BTreeMap;

use crate::rules::places::Firsts;
use crate::rules::{Judge, Need, NoLimits, Rule};
use crate::verdict::{Finding, Measured};
use crate::world::graph::Component;
use crate::world::{FrameId, FrameRole, World};

/// TREE01.
pub struct OrphanSubtree;

impl Rule for OrphanSubtree {
    const PAGE: &'static str = include_str!("../../../rules/tree/orphan-subtree.md");
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = NoLimits;

    fn judge(world: &World, _limits: &NoLimits, out: &mut Judge) {
        let components = world.graph().components();
        if components.len() <= 1 {
            out.pass(
                "frame tree",
                [Measured::count("separate trees", components.len()).limit(1.0)],
            );
            return;
        }
        let main = main_component(world, &components);
        let firsts = Firsts::new(world);
        for (index, orphan) in components.iter().enumerate() {
            if index != main
                && let Some(connected) = components.get(main)
            {
                judge_orphan(&firsts, orphan, connected, components.len(), out);
            }
        }
    }
}

fn judge_orphan(firsts: &Firsts<'_>, orphan: &Component, main: &Component, trees: usize, out: &mut Judge) {
    let Some(root) = orphan.roots.first().or_else(|| orphan.members.first()) else {
        return;
    };
    let Some(place) = firsts
        .get(root)
        .or_else(|| orphan.members.iter().find_map(|frame| firsts.get(frame)))
    else {
        return;
    };
    let others = orphan.members.len() - 1;
    let main_root = main.roots.first().or_else(|| main.members.first());
    let subject = format!("subtree `{root}`");
    let message = format!(
        "`{root}`{} not connected to the tree of `{}`: no transform between them can be looked up",
        match others {
            0 => " is".to_owned(),
            1 => " and 1 frame under it are".to_owned(),
            n => format!(" and {n} frames under it are"),
        },
        main_root.map_or("?", FrameId::as_str),
    );
    let finding = Finding::error(subject, message, place)
        .label("root of the separate tree")
        .help(format!(
            "publish or describe the transform that mounts `{root}`, or remove the frames if nothing uses them"
        ))
        .measured(Measured::count("separate trees", trees).limit(1.0))
        .measured(Measured::count("frames in this tree", orphan.members.len()));
    let finding = match main_root.and_then(|frame| firsts.get(frame)) {
        Some(place) => finding.related(place, "root of the main tree"),
        None => finding,
    };
    out.fail(finding);
}

/// The component with most sensor frames in message headers, then most frames.
fn main_component(world: &World, components: &[Component]) -> usize {
    let home: BTreeMap<&FrameId, usize> = components
        .iter()
        .enumerate()
        .flat_map(|(index, component)| component.members.iter().map(move |frame| (frame, index)))
        .collect();
    let mut sensors: BTreeMap<usize, usize> = BTreeMap::new();
    for used in world.frames.iter().filter(|used| used.role == FrameRole::Header) {
        if let Some(index) = home.get(&used.frame.canonical()) {
            *sensors.entry(*index).or_default() += 1;
        }
    }
    let sensors = |index: &usize| sensors.get(index).copied().unwrap_or(0);
    components
        .iter()
        .enumerate()
        .max_by_key(|(index, component)| (sensors(index), component.members.len(), std::cmp::Reverse(*index)))
        .map_or(0, |(index, _)| index)
}
