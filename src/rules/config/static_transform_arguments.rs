//! CONFIG01: arguments that `static_transform_publisher` rejects, or reads differently from what was meant.

use std::cell::LazyCell;
use std::collections::BTreeMap;

use crate::analysis::names;
use crate::rules::prelude::*;
use crate::source::Span;
use crate::world::launch::{ArgumentForm, PROGRAM, ReadObstacle, StaticPublisher};
use crate::world::{Claim, Spelling, World};

pub(crate) struct StaticTransformArguments;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    quarter_deg: f64,
    zero_deg: f64,
    unit: f64,
}

/// Words of frames that are defined by a rotation of 180 deg about x.
const TURNED_OVER: [&str; 4] = ["ned", "frd", "nwu", "flu"];

impl Rule for StaticTransformArguments {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let claims = LazyCell::new(|| -> ClaimsAt {
            let claims = world.claims.iter().rev();
            claims
                .map(|claim| ((&claim.place, claim.label.as_str()), claim))
                .collect()
        });
        for publisher in &world.publishers {
            let subject = format!(
                "arguments of `{}` of {}",
                publisher.label,
                world.path(publisher.place.source)
            );
            match refused(publisher) {
                Some((message, detail, help)) => {
                    let count = Measured::count("arguments", publisher.arguments as usize);
                    let count = match needed(publisher) {
                        Some(needed) => count.expected(needed),
                        None => count,
                    };
                    let finding = match joined(world, publisher) {
                        Some((strings, place)) => Finding::error(subject, message, place)
                            .label("no comma between the two strings")
                            .detail(format!("Python joins `{strings}` to one argument."))
                            .help("put a comma between the two strings"),
                        None => Finding::error(subject, message, publisher.place.clone())
                            .detail(detail)
                            .help(help),
                    };
                    out.fail(finding.measured(count));
                }
                None => judge_read(&claims, publisher, subject, limits, out),
            }
        }
    }
}

/// Why the program exits, or misreads its arguments: headline, detail and help.
fn refused(publisher: &StaticPublisher) -> Option<(String, String, &'static str)> {
    const ADD: &str = "add the period in milliseconds (100), or use the package tf2_ros";
    const REMOVE: &str = "remove the last number: a static transform has no period";
    let name = &publisher.label;
    if let Some(ReadObstacle::Misread(why)) = &publisher.unread {
        let of = if name.starts_with(PROGRAM) {
            String::new()
        } else {
            format!(" `{name}`")
        };
        return Some((
            format!("{PROGRAM}{of} cannot read its arguments: {why}"),
            String::new(),
            if publisher.package.as_deref() == Some("tf") {
                "write x y z yaw pitch roll parent child period, or x y z qx qy qz qw parent child period (the period in milliseconds)"
            } else if publisher.is_ros2 == Some(true) {
                "write --x --y --z --yaw --pitch --roll --frame-id PARENT --child-frame-id CHILD, each flag with its value; or, as before Humble, x y z yaw \
                 pitch roll parent child"
            } else {
                "write x y z yaw pitch roll parent child, or x y z qx qy qz qw parent child"
            },
        ));
    }
    publisher.form.filter(|form| *form != ArgumentForm::Flags)?;
    let is_of_ros1 = publisher.is_ros2 == Some(false);
    match (publisher.package.as_deref(), publisher.has_period, publisher.arguments) {
        // Nine words are the other form: the programs of ROS 1 only count them.
        (Some("tf"), false, 9) => Some((
            format!("`{name}` has no period, which static_transform_publisher of `tf` requires"),
            "It reads the quaternion as three angles, its last number as the parent, and the child as the period."
                .to_owned(),
            ADD,
        )),
        (Some("tf"), false, _) => Some((
            format!("`{name}` has no period, which static_transform_publisher of `tf` requires"),
            "The program exits at once. The period comes after the frames.".to_owned(),
            ADD,
        )),
        (Some("tf2_ros"), true, 9) if is_of_ros1 => Some((
            format!("`{name}` has a period, which static_transform_publisher of `tf2_ros` does not take"),
            "It reads the angles and the parent as a quaternion, the child as the parent, and the period as the child."
                .to_owned(),
            REMOVE,
        )),
        (Some("tf2_ros"), true, _) => Some((
            format!("`{name}` has a period, which static_transform_publisher of `tf2_ros` does not take"),
            "The program exits at once.".to_owned(),
            REMOVE,
        )),
        _ => None,
    }
}

/// Two strings of a Python file with only whitespace and comments between them, in arguments that cannot be read, and their place.
fn joined(world: &World, publisher: &StaticPublisher) -> Option<(String, Place)> {
    let source = publisher.place.source;
    let is_misread = matches!(publisher.unread, Some(ReadObstacle::Misread(_)));
    let is_python = std::path::Path::new(world.path(source))
        .extension()
        .is_some_and(|ending| ending == "py");
    let span = publisher.place.span().filter(|_| is_misread && is_python)?;
    // With the quotes of the first and the last one.
    let start = span.start.checked_sub(1)?;
    let text = world.source(source)?.text.get(start..span.end + 1)?;
    let mut before: Option<usize> = None;
    let mut at = 0;
    while let Some(next) = text.get(at..)?.chars().next() {
        let rest = text.get(at + next.len_utf8()..)?;
        let length = match next {
            '\'' | '"' => rest.find(next)? + 1,
            '#' => rest.find('\n').unwrap_or(rest.len()),
            _ => 0,
        };
        let end = at + next.len_utf8() + length;
        match (next, before) {
            ('\'' | '"', Some(first)) => {
                let place = Place::text(source, Span::new(start + first, start + end));
                return Some((text.get(first..end)?.to_owned(), place));
            }
            ('\'' | '"', None) => before = Some(at),
            ('#', _) => {}
            (space, _) if space.is_whitespace() => {}
            _ => before = None,
        }
        at = end;
    }
    None
}

/// How many arguments the program takes in the form in which they are written.
fn needed(publisher: &StaticPublisher) -> Option<f64> {
    let numbers = match publisher.form? {
        ArgumentForm::Angles => 6,
        ArgumentForm::Quaternion => 7,
        ArgumentForm::Flags => return None,
    };
    let period = u32::from(publisher.package.as_deref() == Some("tf"));
    Some(f64::from(numbers + 2 + period))
}

/// Claims by place and label; the first of several.
type ClaimsAt<'w> = BTreeMap<(&'w Place, &'w str), &'w Claim>;

fn judge_read(claims: &ClaimsAt, publisher: &StaticPublisher, subject: String, limits: &Limits, out: &mut Judge) {
    match &publisher.unread {
        Some(ReadObstacle::Open(what)) => {
            return out.missing(subject, format!("`{what}` is known only when the file is run"));
        }
        Some(ReadObstacle::Parameter(name)) => {
            return out.missing(
                subject,
                format!("the transform is in the parameter `{name}`, which is not read"),
            );
        }
        Some(ReadObstacle::Misread(_)) | None => {}
    }
    let Some(claim) = claims.get(&(&publisher.place, publisher.label.as_str())) else {
        return;
    };
    let place = claim
        .rotation_literals
        .iter()
        .map(|literal| literal.span)
        .reduce(Span::cover)
        .map_or_else(
            || publisher.place.clone(),
            |span| Place::text(publisher.place.source, span),
        );
    let suspect = match (publisher.form, &claim.spelling) {
        (Some(ArgumentForm::Angles), Spelling::Rpy { rpy, .. }) => rolled(claim, *rpy, limits),
        (Some(ArgumentForm::Quaternion), Spelling::Quaternion { xyzw, .. }) => scalar_first(claim, *xyzw, limits),
        _ => None,
    };
    let count = Measured::count("arguments", publisher.arguments as usize);
    match suspect {
        None => out.pass(subject, [count]),
        Some((message, detail, help, measured, relation)) => {
            let finding = Finding::warning(subject, message, place).hint().relation(relation);
            out.fail(finding.detail(detail).help(help).measured(measured));
        }
    }
}

/// Headline, detail, help, what was measured, and the relation.
type Suspect = (String, &'static str, &'static str, Measured, &'static str);

/// A sensor with a roll of 90 deg and no other rotation: the last angle is roll, and yaw is the first.
fn rolled(claim: &Claim, [roll, pitch, yaw]: [f64; 3], limits: &Limits) -> Option<Suspect> {
    let (parent, child) = claim.frames.as_ref()?;
    let is_zero = |angle: f64| angle.to_degrees().abs() <= limits.zero_deg;
    let quarter = (roll.to_degrees().abs() - 90.0).abs() <= limits.quarter_deg;
    let is_mount = names::is_base(parent) && names::optical_stem(child).is_none();
    (is_mount && quarter && is_zero(pitch) && is_zero(yaw)).then(|| {
        (
            format!(
                "`{child}` has a roll of {:.1} deg and no other rotation: probably a yaw",
                roll.to_degrees()
            ),
            "The order of the arguments is yaw pitch roll, and only the last is set.",
            "put the angle first if it is a yaw; leave it if the sensor is mounted on its side",
            Measured::new("roll", roll.to_degrees(), "deg"),
            "rpy-order",
        )
    })
}

/// An identity with its scalar first is a rotation by 180 deg about x.
fn scalar_first(claim: &Claim, [x, y, z, w]: [f64; 4], limits: &Limits) -> Option<Suspect> {
    let (parent, child) = claim.frames.as_ref()?;
    let is_zero = |value: f64| value.abs() <= limits.unit;
    let is_first = (x - 1.0).abs() <= limits.unit && is_zero(y) && is_zero(z) && is_zero(w);
    let is_meant = TURNED_OVER
        .iter()
        .any(|word| parent.has_token(word) || child.has_token(word));
    (is_first && !is_meant).then(|| {
        (
            format!("`{child}` is rotated by 180 deg about x: the quaternion 1 0 0 0 is read as x y z w"),
            "It is the identity only in the order w x y z.",
            "write 0 0 0 1 for no rotation",
            Measured::new("rotation", 180.0, "deg"),
            "quaternion-order",
        )
    })
}
