//! URDF11: a misspelt attribute or element, which parsers ignore.

use crate::advice::literal::{replace, with_fix};
use crate::rules::prelude::*;
use crate::verdict::Safety;
use crate::world::World;
use crate::world::robot::{IgnoredItem, Robot};

pub(crate) struct IgnoredName;

impl Rule for IgnoredName {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        for robot in &world.robots {
            let mut misspelt = 0;
            for ignored in &robot.ignored {
                // A name that is similar to no known one is an extension of some tool, and not judged.
                if let Some(meant) = &ignored.meant {
                    misspelt += 1;
                    out.fail(finding(world, robot, ignored, meant));
                }
            }
            if misspelt == 0 {
                out.pass(
                    crate::analysis::urdf::called::robot(world, robot),
                    [
                        Measured::count("misspelt names", 0).limit(0.0),
                        Measured::count("names of other tools", robot.ignored.len()),
                    ],
                );
            }
        }
    }
}

fn finding(world: &World, robot: &Robot, ignored: &IgnoredItem, meant: &str) -> Finding {
    let (what, name, parent) = (&ignored.what, &ignored.name.value, &ignored.parent);
    let byte = ignored.name.place.span().unwrap_or_default().start;
    let subject = format!("{what} `{name}` at byte {byte} of {}", world.path(robot.source));
    let message = format!("{what} `{name}` of <{parent}> is ignored: probably a typo of `{meant}`");
    let finding = Finding::warning(subject, message, ignored.name.place.clone())
        .likely()
        .label("ignored")
        .help(format!("write `{meant}`: parsers ignore `{name}` and use the default"))
        .measured(Measured::count("misspelt names", 1).limit(0.0));
    // An element has a second name in its end tag, which an edit at this place would not reach.
    if ignored.what != "attribute" {
        return finding;
    }
    let edit = replace(world, ignored.name.place.clone(), name, meant);
    let title = format!("rename it to `{meant}`");
    with_fix(finding, &title, Safety::ChangesBehaviour, edit.map(|edit| vec![edit]))
}
