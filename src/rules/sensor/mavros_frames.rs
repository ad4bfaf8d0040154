//! SENSOR07: the fixed frames of mavros: `map_ned`, `odom_ned`, `base_link_frd`.

use crate::advice::places;
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

/// A frame that mavros publishes: its name, its parent, and the rotation between the two, also as URDF text.
struct MavrosFrame {
    name: &'static str,
    parent: &'static str,
    turn: AxisTurn,
    rpy: &'static str,
    /// The rule of such names, which reports it better where it is a different frame altogether.
    judged_by: RuleCode,
}

const MAP_NED: MavrosFrame = MavrosFrame {
    name: "map_ned",
    parent: "map",
    turn: AxisTurn::NedEnu,
    rpy: "3.141592653589793 0 1.5707963267948966",
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
    let chain = graph.chain(parent, frame, |edge| edge.is_rigid);
    let above = graph.parents_of(frame);
    let stranger = above.iter().find(|above| **above != parent);
    let (Some(place), true) = (place_of(world, frame), graph.frames.contains(parent)) else {
        return out.missing(subject, format!("`{parent}` is not in the tree"));
    };
    if let Some(stranger) = stranger.filter(|_| chain.is_none()) {
        let message = format!("`{frame}` is a child of `{stranger}`, and not rigidly connected to `{parent}`");
        let help = format!("publish `{parent}` -> `{frame}` with rpy = ({}) instead", own.rpy);
        let finding = Finding::warning(subject, message, place).likely().help(help);
        return out.fail(finding.measured(Measured::count("rigid transforms between the two", 0).expected(1.0)));
    }
    let Some((parent_from_frame, steps)) = chain else {
        return out.too_little(subject, format!("no rigid transform between `{parent}` and `{frame}`"));
    };
    let deg = off_deg(Some(own.turn), &parent_from_frame.rotation);
    let m = parent_from_frame.translation.vector.norm();
    let turn = Measured::new(format!("rotation off {}", own.turn.word()), deg, "deg").turn();
    let turn = turn.limit(limits.max_deg);
    let shift = Measured::new("distance of the origins", m, "m").limit(limits.max_m);
    if deg <= limits.max_deg && m <= limits.max_m {
        out.pass(subject, [turn, shift]);
    } else {
        let message = if deg > limits.max_deg {
            format!("`{frame}` is rotated {deg:.2} deg off its fixed rotation from `{parent}`")
        } else {
            format!("the origin of `{frame}` is {m:.3} m from that of `{parent}`")
        };
        let mut finding = Finding::warning(subject, message, place)
            .detail("mavros converts its data with the fixed rotation alone.")
            .measured(turn)
            .measured(shift);
        if deg > limits.named_deg {
            finding = finding.unless_about(own.judged_by, format!("`{frame}`"));
        }
        let help = format!("set `{parent}` -> `{frame}` to xyz = (0, 0, 0), rpy = ({})", own.rpy);
        finding = finding.help(help);
        let edge = steps.first().filter(|_| steps.len() == 1 && deg > limits.max_deg);
        let edit = edge.and_then(|step| places::rpy_edit(world, graph.edges.get(step.edge)?, own.rpy));
        out.fail(match edit {
            Some(edit) => finding.fix("write the fixed rotation in full", Safety::ChangesBehaviour, vec![edit]),
            None => finding,
        });
    }
}
