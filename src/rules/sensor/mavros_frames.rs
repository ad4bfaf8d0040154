//! SENSOR07: the fixed frames of mavros: `map_ned`, `odom_ned`, `base_link_frd`.

use crate::advice::{literal::with_fix, places};
use crate::analysis::suffix::{off_deg, place_of};
use crate::math::constants::AxisTurn;
use crate::rules::prelude::*;
use crate::verdict::{RuleCode, Safety};
use crate::world::{FrameId, World};

pub(crate) struct MavrosFrames;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Deviation from the fixed rotation, degrees.
    pub max_deg: f64,
    /// Distance between the two origins, metres.
    pub max_m: f64,
    /// Deviation from which NAME04 and NAME05 report it instead, degrees.
    pub named_deg: f64,
}

/// A frame that mavros publishes: its name, its parent, and the rotation between the two, also as URDF text and in words.
struct MavrosFrame {
    name: &'static str,
    parent: &'static str,
    turn: AxisTurn,
    rpy: &'static str,
    words: &'static str,
    /// The rule of such names, which reports it better where it is a different frame altogether.
    judged_by: RuleCode,
}

const MAP_NED: MavrosFrame = MavrosFrame {
    name: "map_ned",
    parent: "map",
    turn: AxisTurn::NedEnu,
    rpy: "3.141592653589793 0 1.5707963267948966",
    words: "(pi, 0, pi/2)",
    judged_by: codes::NAME04,
};

const FIXED: &[MavrosFrame] = &[
    MAP_NED,
    MavrosFrame {
        name: "odom_ned",
        parent: "odom",
        ..MAP_NED
    },
    MavrosFrame {
        name: "base_link_frd",
        parent: "base_link",
        turn: AxisTurn::FluFrd,
        rpy: "3.141592653589793 0 0",
        words: "(pi, 0, 0)",
        judged_by: codes::NAME05,
    },
];

impl Rule for MavrosFrames {
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for frame in &world.graph().frames {
            let name = frame.as_str();
            let (namespace, last) = name.rfind('/').map_or(("", name), |slash| name.split_at(slash + 1));
            if let Some(fixed) = FIXED.iter().find(|fixed| fixed.name == last) {
                let parent = FrameId::new(format!("{namespace}{}", fixed.parent));
                judge_frame(world, frame, &parent, fixed, limits, out);
            }
        }
    }
}

fn judge_frame(world: &World, frame: &FrameId, parent: &FrameId, own: &MavrosFrame, limits: &Limits, out: &mut Judge) {
    let graph = world.graph();
    let subject = format!("frame `{frame}`");
    let (Some(place), true) = (place_of(world, frame), graph.frames.contains(parent)) else {
        return out.missing(subject, format!("`{parent}` is not in the tree"));
    };
    let Some((parent_from_frame, steps)) = graph.chain(parent, frame, |edge| edge.is_rigid) else {
        let Some(stranger) = graph.parents_of(frame).into_iter().find(|above| *above != parent) else {
            return out.too_little(subject, format!("no rigid transform between `{parent}` and `{frame}`"));
        };
        let message = format!("`{frame}` is a child of `{stranger}`, not of `{parent}`");
        let rigid = Measured::count(format!("rigid transforms between `{parent}` and `{frame}`"), 0);
        let finding = Finding::warning(subject, message, place).likely();
        let finding = finding.measured(rigid.expected(1.0)).detail(format!(
            "mavros converts between `{parent}` and `{frame}` with a fixed rotation; no rigid transform connects the two frames."
        ));
        return out.fail(finding.help(format!(
            "replace `{stranger}` -> `{frame}` by the static transform `{parent}` -> `{frame}` with rpy = {}",
            own.words
        )));
    };
    let deg = off_deg(Some(own.turn), &parent_from_frame.rotation);
    let m = parent_from_frame.translation.vector.norm();
    let turn = Measured::new(format!("deviation from rpy = {}", own.words), deg, "deg").turn();
    let shift = Measured::new("distance of the origins", m, "m").limit(limits.max_m);
    let measured = [turn.limit(limits.max_deg), shift];
    if deg <= limits.max_deg && m <= limits.max_m {
        return out.pass(subject, measured);
    }
    let message = if deg > limits.max_deg {
        format!("rotation `{parent}` -> `{frame}` is {deg:.2} deg off the fixed rotation of mavros")
    } else {
        format!("origins of `{parent}` and `{frame}` are {m:.3} m apart: mavros takes them as one")
    };
    let why = format!("mavros converts between `{parent}` and `{frame}` with the fixed rotation alone.");
    let help = format!("set `{parent}` -> `{frame}` to xyz = (0, 0, 0), rpy = {}", own.words);
    let mut finding = Finding::warning(subject, message, place).detail(why).measured(measured);
    if deg > limits.named_deg {
        finding = finding.unless_about(own.judged_by, format!("`{frame}`"));
    }
    let edge = steps.first().filter(|_| steps.len() == 1 && deg > limits.max_deg);
    let edits = edge.and_then(|step| Some(vec![places::rpy_edit(world, graph.edges.get(step.edge)?, own.rpy)?]));
    let title = "write the fixed rotation in full";
    out.fail(with_fix(finding.help(help), title, Safety::ChangesBehaviour, edits));
}
