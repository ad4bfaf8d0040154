//! URDF10: an attribute that a parser cannot read as numbers.

use std::collections::BTreeSet;

use crate::advice::literal::{is_macro, is_spelled_non_finite, replace, with_fix};
use crate::rules::prelude::*;
use crate::source::SourceId;
use crate::verdict::Safety;
use crate::world::robot::{NumberList, Robot};
use crate::world::{Literal, World};

pub(crate) struct MalformedNumber;

impl Rule for MalformedNumber {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        for robot in &world.robots {
            let lists = robot.malformed.iter().filter(|list| !only_non_finite(list));
            let (macros, broken): (Vec<&NumberList>, Vec<&NumberList>) =
                lists.partition(|list| is_macro(&list.text.value));
            let known: BTreeSet<&Place> = broken.iter().map(|list| &list.text.place).collect();
            let limits = broken_limits(robot);
            let limits = limits.into_iter().filter(|(_, place)| !known.contains(place));
            let limits: Vec<Finding> = limits
                .map(|(literal, place)| no_number(world, robot, literal, place))
                .collect();
            if broken.is_empty() && limits.is_empty() && macros.is_empty() {
                out.pass(
                    crate::analysis::urdf::called::robot(world, robot),
                    [
                        Measured::count("malformed attributes", 0).limit(0.0),
                        Measured::count("links and joints", robot.links.len() + robot.joints.len()),
                    ],
                );
            }
            if let Some(first) = macros.first() {
                out.missing(
                    crate::analysis::urdf::called::robot(world, robot),
                    format!(
                        "{} attributes contain macros, the first `{}`: expand the file with xacro",
                        macros.len(),
                        first.text.value
                    ),
                );
            }
            broken
                .into_iter()
                .map(|list| finding(world, robot, list))
                .chain(limits)
                .for_each(|found| out.fail(found));
        }
    }
}

/// As many numbers as required, some of them NaN or infinite: ROT05 reports that.
fn only_non_finite(list: &NumberList) -> bool {
    let is_number = |literal: &Literal| literal.value.is_finite() || is_spelled_non_finite(literal);
    list.literals.len() == list.expected
        && list.literals.iter().any(is_spelled_non_finite)
        && list.literals.iter().all(is_number)
}

fn broken_limits(robot: &Robot) -> Vec<(&Literal, Place)> {
    let limits = robot.joints.iter().filter_map(|joint| joint.limit.as_ref());
    let literals = limits.flat_map(|limit| [&limit.lower, &limit.upper]).flatten();
    literals
        .filter(|literal| !literal.value.is_finite() && !is_spelled_non_finite(literal) && !is_macro(&literal.text))
        .map(|literal| (literal, Place::text(robot.source, literal.span)))
        .collect()
}

fn no_number(world: &World, robot: &Robot, literal: &Literal, place: Place) -> Finding {
    let message = format!("the joint limit `{}` is not a number", literal.text);
    fail(world, robot.source, "limit", message, place)
}

fn finding(world: &World, robot: &Robot, list: &NumberList) -> Finding {
    let why = list.malformed.as_deref().unwrap_or("not a list of numbers");
    let message = format!("`{}=\"{}\"` cannot be read: {why}", list.attribute, list.text.value);
    let mut finding = fail(world, robot.source, &list.attribute, message, list.text.place.clone());
    if list.literals.len() != list.expected && list.literals.iter().all(|literal| literal.value.is_finite()) {
        let count = format!("{} numbers, {} needed", list.literals.len(), list.expected);
        finding = finding
            .label(count)
            .help(format!("write exactly {} numbers", list.expected));
    }
    let edits = respaced(list).and_then(|text| {
        let edit = replace(world, list.text.place.clone(), &list.text.value, text);
        edit.map(|edit| vec![edit])
    });
    with_fix(finding, "separate the numbers by spaces", Safety::Safe, edits)
}

fn fail(world: &World, source: SourceId, attribute: &str, message: String, place: Place) -> Finding {
    let span = place.span().unwrap_or_default();
    // The byte distinguishes two broken attributes of one name.
    let subject = format!("`{attribute}` at byte {} of {}", span.start, world.path(source));
    Finding::error(subject, message, place)
        .label("not a list of numbers")
        .help("write numbers such as `-1.57`, separated by spaces")
        .measured(Measured::count("malformed attributes", 1).limit(0.0))
}

/// `1, 2, 3`, `1,2,3` and numbers between tabs become `1 2 3`, where that gives exactly the numbers expected. With a comma
/// in some of the gaps only, it may be a decimal comma.
fn respaced(list: &NumberList) -> Option<String> {
    let text = list.text.value.replace([',', ';'], " ");
    let numbers: Vec<&str> = text.split_whitespace().collect();
    let is_read = numbers.len() == list.expected && numbers.iter().all(|number| number.parse::<f64>().is_ok());
    let marks = list.text.value.matches([',', ';']).count();
    (is_read && (marks == 0 || marks + 1 == list.expected)).then(|| numbers.join(" "))
}
