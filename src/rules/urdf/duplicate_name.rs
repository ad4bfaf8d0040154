//! URDF05: two links or two joints with the same name.

use std::collections::BTreeMap;

use crate::advice::subject;
use crate::rules::prelude::*;
use crate::source::SourceValue;

pub(crate) struct DuplicateName;

impl Rule for DuplicateName {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        for robot in subject::whole_robots(world, out) {
            let path = world.path(robot.source);
            let links = duplicates("link", path, robot.links.iter().map(|link| &link.name));
            let joints = duplicates("joint", path, robot.joints.iter().map(|joint| &joint.name));
            let found: Vec<Finding> = links.into_iter().chain(joints).collect();
            if found.is_empty() {
                out.pass(
                    crate::analysis::urdf::called::robot(world, robot),
                    [
                        Measured::count("duplicate names", 0).limit(0.0),
                        Measured::count("links and joints", robot.links.len() + robot.joints.len()),
                    ],
                );
            }
            for finding in found {
                out.fail(finding);
            }
        }
    }
}

fn duplicates<'a>(what: &str, path: &str, names: impl Iterator<Item = &'a SourceValue<String>>) -> Vec<Finding> {
    let mut by_name: BTreeMap<&str, Vec<&SourceValue<String>>> = BTreeMap::new();
    // An empty name is a missing one, not a duplicate.
    for name in names.filter(|name| !name.value.is_empty()) {
        by_name.entry(name.value.as_str()).or_default().push(name);
    }
    let repeated = by_name.into_iter().filter(|(_, places)| places.len() > 1);
    repeated
        .filter_map(|(name, places)| {
            let (first, second) = places.first().zip(places.get(1))?;
            let count = places.len();
            Some(
                Finding::error(
                    format!("{what} `{name}` of {path}"),
                    format!("{count} {what}s are called `{name}`: parsers reject the file or keep one of them"),
                    second.place.clone(),
                )
                .label("second")
                .related(first.place.clone(), "first")
                .help(format!("give each {what} its own name, or delete the copy"))
                .measured(Measured::count(format!("{what}s of this name"), count).limit(1.0)),
            )
        })
        .collect()
}
