//! Rows for robots, and which robots can be judged as a whole.

use crate::analysis::urdf::called::robot;
use crate::verdict::Judge;
use crate::world::{World, robot::Robot};

/// The robots that were read completely. A fragment gets its row here: what it lacks may be in another file.
pub(crate) fn whole_robots<'a>(world: &'a World, out: &mut Judge) -> Vec<&'a Robot> {
    let (fragments, whole): (Vec<&Robot>, Vec<&Robot>) =
        world.robots.iter().partition(|robot| robot.fragment.is_some());
    for fragment in fragments {
        let why = fragment.fragment.as_deref().unwrap_or_default();
        out.missing(
            robot(world, fragment),
            format!("only a part of the robot could be read: {why}"),
        );
    }
    whole
}

/// A row for a robot that has nothing for the rule to judge.
pub(crate) fn nothing(world: &World, of: &Robot, what: &str, out: &mut Judge) {
    out.not_applicable(robot(world, of), format!("it has no {what}"));
}
