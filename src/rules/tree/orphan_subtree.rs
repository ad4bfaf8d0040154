//! TREE01: frames that no chain of transforms connects to the rest.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::{names, places, places::of_edge, spelling::loose, tf, tree::loops::loops};
use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::world::graph::{Component, FrameGraph};
use crate::world::{Claim, FrameId, FrameRole, World};

pub(crate) struct OrphanSubtree;

impl Rule for OrphanSubtree {
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        judge_recorded(world, out);
        judge_launched(world, out);
        let wholes = named_by_wholes(world);
        let (parts, components): (Vec<Component>, Vec<Component>) = world
            .graph()
            .components()
            .into_iter()
            // A frame without a name is TREE04's, TREE07's or TREE12's.
            .filter(|component| component.members.iter().any(|frame| !frame.as_str().is_empty()))
            .partition(|component| {
                wholes
                    .as_ref()
                    .is_some_and(|named| component.members.is_disjoint(named))
            });
        if let Some(part) = parts.first() {
            let names: Vec<FrameId> = part.members.iter().take(1).cloned().collect();
            let why = format!(
                "{} frames (the first is {}) are in partial descriptions (macros), which other files may connect: check the expanded URDF",
                parts.iter().map(|part| part.members.len()).sum::<usize>(),
                tf::listed(&names)
            );
            out.too_little("frames of parts", why);
        }
        if components.is_empty() && !parts.is_empty() {
            return;
        }
        if components.len() <= 1 {
            return out.pass(
                "frame tree",
                [Measured::count("separate trees", components.len()).limit(1.0)],
            );
        }
        let main = main_component(world, &components);
        let looping: BTreeSet<FrameId> = loops(world).into_iter().flat_map(|(frames, _)| frames).collect();
        let connected = components
            .get(main)
            .into_iter()
            .flat_map(|component| &component.members);
        let names: BTreeMap<String, &FrameId> = connected.map(|frame| (loose(frame.as_str()), frame)).collect();
        let surroundings = Surroundings {
            trees: components.len(),
            looping,
            names,
        };
        let cut_off: BTreeSet<SourceId> = world
            .bags
            .iter()
            .filter(|bag| bag.truncated)
            .map(|bag| bag.source)
            .collect();
        let in_cut_off = world.frames.iter().filter(|used| cut_off.contains(&used.place.source));
        let in_cut_off: BTreeSet<FrameId> = in_cut_off.map(|used| used.frame.canonical()).collect();
        let by_launch = components.get(main).map(|main| connected_by_launch(world, main));
        let by_launch = by_launch.unwrap_or_default();
        for (index, orphan) in components.iter().enumerate() {
            let Some(connected) = components.get(main).filter(|_| index != main) else {
                continue;
            };
            if !orphan.members.is_disjoint(&by_launch) && !is_recorded(world, orphan) {
                let trees = Measured::count("separate trees with those of launch files", 1).limit(1.0);
                let root = orphan.roots.first().or(orphan.members.first());
                out.pass(format!("subtree `{}`", root.map_or("?", FrameId::as_str)), [trees]);
            } else if orphan.members.is_disjoint(&in_cut_off) {
                judge_orphan(world, orphan, connected, &surroundings, out);
            } else if let Some(root) = orphan.roots.first().or(orphan.members.first()) {
                let why = "a part of the recording could not be read, and may contain the connecting transform";
                out.too_little(format!("subtree `{root}`"), why);
            }
        }
    }
}

/// The frames that the main tree reaches with what launch files and scripts publish; none if they publish nothing.
fn connected_by_launch(world: &World, main: &Component) -> BTreeSet<FrameId> {
    if !world.claims.iter().any(Claim::is_published) {
        return BTreeSet::new();
    }
    let all = world.whole().components().into_iter();
    let with_main = all.filter(|all| !all.members.is_disjoint(&main.members));
    with_main.flat_map(|all| all.members).collect()
}

/// Whether a tree is recorded: it has the transforms of its time.
fn is_recorded(world: &World, tree: &Component) -> bool {
    let mut edges = tree.members.iter().flat_map(|frame| world.graph().edges_to(frame));
    edges.any(|edge| edge.claim(world).is_none())
}

/// Trees that only launch files and scripts publish, beside a robot whose tree they publish, too.
fn judge_launched(world: &World, out: &mut Judge) {
    let is_open = world.publishers.iter().any(|publisher| publisher.unread.is_some());
    let is_part = world.robots.iter().any(|robot| robot.fragment.is_some());
    let is_published = world.claims.iter().any(Claim::is_published);
    if world.robots.is_empty() || is_open || is_part || !is_published {
        return;
    }
    let (graph, whole) = (world.graph(), world.whole());
    let components = whole.components();
    let home = components.get(main_component(world, &components));
    let Some((home, top)) = home.and_then(|home| Some((home, home.roots.first()?))) else {
        return;
    };
    for orphan in &components {
        let ([root], true) = (orphan.roots.as_slice(), orphan.members.is_disjoint(&graph.frames)) else {
            continue;
        };
        let Some(edge) = whole.edges_from(root).next() else {
            continue;
        };
        let (source, place) = (edge.source(world), of_edge(world, edge));
        // A file that publishes nothing of this robot may be of another one.
        let is_beside = (whole.edges.iter())
            .any(|other| other.is_published() && other.source(world) == source && home.members.contains(&other.child));
        let (true, false, Some(place)) = (is_beside, is_attached_elsewhere(world, root, home), place) else {
            continue;
        };
        let below = orphan.members.len() - 1;
        let frames = if below == 1 { "frame" } else { "frames" };
        let message =
            format!("`{root}` and {below} {frames} below it are published, but not connected to the tree of `{top}`");
        let finding = Finding::warning(format!("subtree `{root}`"), message, place)
            .likely()
            .confidence(places::published_reading(world, edge))
            .label("root of the separate tree")
            .detail("Neither the URDF nor a launch file attaches it. Look-ups between the two trees fail in tf2 (ConnectivityException).")
            .help(format!(
                "publish the static transform from a frame of the robot to `{root}`, or add the joint that mounts it to the URDF"
            ))
            .measured(Measured::count("separate trees", components.len()).limit(1.0))
            .measured(Measured::count("frames in this tree", orphan.members.len()));
        out.fail(match places::first(world, top) {
            Some(place) => finding.related(place, "root of the main tree"),
            None => finding,
        });
    }
}

/// Whether something that no launch file states probably attaches a frame: localization, a driver that publishes the frames of its own
/// device, another robot's description, or a node that reads a calibration.
fn is_attached_elsewhere(world: &World, root: &FrameId, home: &Component) -> bool {
    const LOCATED: &[&str] = &[
        "init", "origin", "pose", "tag", "marker", "tracker", "target", "dock", "board", "object",
    ];
    const SIDES: &[&str] = &[
        "front", "rear", "back", "left", "right", "top", "side", "upper", "lower", "main",
    ];
    let device = |frame: &FrameId| {
        frame
            .tokens()
            .into_iter()
            .next()
            .filter(|word| !SIDES.contains(&word.as_str()))
    };
    let own = device(root);
    let is_of_device = || own.is_some() && home.members.iter().any(|frame| device(frame) == own);
    let is_calibrated =
        || (world.claims.iter()).any(|claim| claim.source_frame().is_some_and(|frame| frame.canonical() == *root));
    root.as_str().is_empty()
        || names::is_world(root)
        || names::is_base(root)
        || names::has_word(root, LOCATED)
        || names::optical_stem(root).is_some()
        || is_of_device()
        || is_calibrated()
}

/// Trees of recorded TF that only a description connects: tf2 knows TF, and no URDF.
fn judge_recorded(world: &World, out: &mut Judge) {
    if world.robots.is_empty() {
        return;
    }
    let components = FrameGraph::of_recordings(world).components();
    if components.len() < 2 {
        return;
    }
    if world.bags.iter().any(|bag| bag.truncated || !bag.share.whole) {
        let why = "TF as read consists of several trees, but the part that was not read may connect them";
        return out.too_little("recorded frame tree", why);
    }
    // Of recorded trees, the platform's own is the main one.
    let main = components
        .iter()
        .position(is_standard)
        .unwrap_or_else(|| main_component(world, &components));
    let Some(home) = components
        .get(main)
        .and_then(|main| main.roots.first().or(main.members.first()))
    else {
        return;
    };
    let whole = world.graph();
    for (_, orphan) in components.iter().enumerate().filter(|(index, _)| *index != main) {
        let Some(root) = orphan.roots.first().or(orphan.members.first()) else {
            continue;
        };
        let Some((_, steps)) = whole.chain(home, root, |_| true) else {
            continue;
        };
        let edges = steps.iter().filter_map(|step| whole.edges.get(step.edge));
        let mut joints = edges.filter_map(|edge| Some((edge.claim(world)?, of_edge(world, edge)?)));
        let Some((joint, place)) = joints.next() else {
            continue;
        };
        let is_used = world
            .frames
            .iter()
            .any(|used| used.role == FrameRole::Header && orphan.members.contains(&used.frame.canonical()));
        let message = format!(
            "TF does not connect `{root}` to `{home}`; only joint `{}` of the URDF does",
            joint.label
        );
        let subject = format!("recorded subtree `{root}`");
        let severity = if is_used { Severity::Error } else { Severity::Warning };
        let finding = Finding::new(severity, subject, message, place)
            .likely()
            .label("not in TF")
            .detail("tf2 knows published transforms only, no URDF: look-ups between the two trees fail.")
            .help("start robot_state_publisher with this URDF (and a joint state publisher for moving joints), and record its TF")
            .measured(Measured::count("separate trees in TF", components.len()).limit(1.0));
        out.fail(world.bags.iter().fold(finding, |finding, bag| {
            finding.unless_about(codes::TREE08, world.path(bag.source).to_owned())
        }));
    }
}

/// What an orphan is compared with.
struct Surroundings<'w> {
    /// How many trees there are.
    trees: usize,
    /// Frames of loops.
    looping: BTreeSet<FrameId>,
    /// Frames of the main tree by their names without case and stray characters.
    names: BTreeMap<String, &'w FrameId>,
}

/// The frames that more than parts of descriptions (xacro files that were not expanded) name; `None` without parts.
fn named_by_wholes(world: &World) -> Option<BTreeSet<FrameId>> {
    let parts = world.robots.iter().filter(|robot| robot.fragment.is_some());
    let parts: BTreeSet<SourceId> = parts.map(|robot| robot.source).collect();
    let wholes = world.frames.iter().filter(|used| !parts.contains(&used.place.source));
    (!parts.is_empty()).then(|| wholes.map(|used| used.frame.canonical()).collect())
}

fn judge_orphan(world: &World, orphan: &Component, main: &Component, around: &Surroundings<'_>, out: &mut Judge) {
    let Surroundings { trees, looping, names } = around;
    let Some(root) = orphan.roots.first().or_else(|| orphan.members.first()) else {
        return;
    };
    let members = std::iter::once(root).chain(&orphan.members);
    let Some(place) = members.into_iter().find_map(|frame| places::first(world, frame)) else {
        return;
    };
    // A loop has no root that could be connected.
    let round = orphan.members.iter().find(|frame| looping.contains(*frame));
    let round = round.filter(|_| orphan.roots.is_empty());
    let others = orphan.members.len() - 1;
    let main_root = main.roots.first().or_else(|| main.members.first());
    let subject = format!("subtree `{root}`");
    let message = format!(
        "`{root}`{} not connected to the tree of `{}`",
        match others {
            0 => " is".to_owned(),
            1 => " and 1 frame below it are".to_owned(),
            n => format!(" and {n} frames below it are"),
        },
        main_root.map_or("?", FrameId::as_str),
    );
    let twin = orphan
        .members
        .iter()
        .find_map(|frame| Some((frame, names.get(&loose(frame.as_str()))?)));
    let help = match twin {
        Some((frame, twin)) => {
            format!("use one spelling for `{frame}` and `{twin}`, which differ only in case, whitespace or slashes")
        }
        None => {
            format!("add the transform or joint that mounts `{root}`, or remove the frames if nothing uses them")
        }
    };
    let finding = Finding::error(subject, message, place)
        .label("root of the separate tree")
        .detail("Look-ups between the two trees fail in tf2 (ConnectivityException).")
        .help(help)
        .measured(Measured::count("separate trees", *trees).limit(1.0))
        .measured(Measured::count("frames in this tree", orphan.members.len()));
    let finding = match main_root.and_then(|frame| places::first(world, frame)) {
        Some(place) => finding.related(place, "root of the main tree"),
        None => finding,
    };
    out.fail(match round {
        Some(frame) => finding.unless_about(codes::TREE03, format!("{frame}`")),
        None => finding,
    });
}

/// Whether a frame of the component has a name of REP-105.
fn is_standard(component: &Component) -> bool {
    component.members.iter().any(|frame| names::standard(frame).is_some())
}

/// The component with most sensor frames in message headers, then most frames, then names of REP-105.
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
        .max_by_key(|(index, component)| {
            let members = component.members.len();
            (
                sensors(index),
                members,
                is_standard(component),
                std::cmp::Reverse(*index),
            )
        })
        .map_or(0, |(index, _)| index)
}
