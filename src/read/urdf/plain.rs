//! Visuals, inertias and limits in standard form: every consumer reads them, so no second opinion is needed.
//!
//! Owns the grammar of the plain form. Any deviation is not plain; nothing here
//! is a judgement.

use super::xml::Element;

/// The required attributes of a shape, with how many numbers each holds; 0 for words.
const SHAPES: &[(&str, &[(&str, usize)])] = &[
    ("box", &[("size", 3)]),
    ("cylinder", &[("radius", 1), ("length", 1)]),
    ("sphere", &[("radius", 1)]),
    ("mesh", &[("filename", 0)]),
];

const MOMENTS: &[(&str, usize)] = &[("ixx", 1), ("ixy", 1), ("ixz", 1), ("iyy", 1), ("iyz", 1), ("izz", 1)];

/// Whether a link has a name and only plain things inside.
pub(super) fn is_plain_link(link: &Element<'_>) -> bool {
    holds(link, &[("name", 0)], &[]) && link.children().all(|child| is_plain(&child))
}

/// Whether a child of a joint has no frames and the plain form. Tree and origin always get a second opinion.
pub(super) fn is_plain_in_joint(element: &Element<'_>) -> bool {
    let (required, optional): (&[_], &[_]) = match element.repaired_name() {
        "axis" => (&[("xyz", 3)], &[]),
        "limit" => (&[("effort", 1), ("velocity", 1)], &[("lower", 1), ("upper", 1)]),
        "dynamics" => (&[], &[("damping", 1), ("friction", 1)]),
        _ => return false,
    };
    element.children().next().is_none() && holds(element, required, optional)
}

/// Whether a child of a link has the plain form.
pub(super) fn is_plain(element: &Element<'_>) -> bool {
    match element.repaired_name() {
        "inertial" => has_exactly(element, &["mass", "inertia"], &["origin"], |child| {
            match child.repaired_name() {
                "mass" => holds(child, &[("value", 1)], &[]),
                "inertia" => holds(child, MOMENTS, &[]),
                _ => is_plain_origin(child),
            }
        }),
        "visual" | "collision" => has_exactly(element, &["geometry"], &["origin", "material"], |child| {
            match child.repaired_name() {
                "geometry" => is_plain_geometry(child),
                "origin" => is_plain_origin(child),
                // Colours and textures are not part of the second opinion.
                _ => true,
            }
        }),
        _ => false,
    }
}

/// Each of `required` once, each of `optional` at most once, nothing else, and all of them plain.
fn has_exactly(
    element: &Element<'_>,
    required: &[&str],
    optional: &[&str],
    plain: impl Fn(&Element<'_>) -> bool,
) -> bool {
    let count = |name: &str| element.children().filter(|child| child.repaired_name() == name).count();
    element.children().all(|child| {
        required
            .iter()
            .chain(optional)
            .any(|known| *known == child.repaired_name())
            && plain(&child)
    }) && required.iter().all(|name| count(name) == 1)
        && optional.iter().all(|name| count(name) <= 1)
}

fn is_plain_origin(origin: &Element<'_>) -> bool {
    origin.children().next().is_none() && holds(origin, &[], &[("xyz", 3), ("rpy", 3)])
}

fn is_plain_geometry(geometry: &Element<'_>) -> bool {
    let mut shapes = geometry.children();
    let (Some(shape), None) = (shapes.next(), shapes.next()) else {
        return false;
    };
    SHAPES
        .iter()
        .find(|(name, _)| *name == shape.repaired_name())
        .is_some_and(|(_, required)| holds(&shape, required, &[("scale", 3)]))
}

/// Whether the element has the required attributes, no others than the optional ones, and finite numbers in them.
fn holds(element: &Element<'_>, required: &[(&str, usize)], optional: &[(&str, usize)]) -> bool {
    let mut met = 0;
    for (name, value) in element.plain_attributes() {
        if let Some((_, numbers)) = required.iter().find(|(known, _)| *known == name) {
            met += 1;
            if !is_numbers(value, *numbers) {
                return false;
            }
        } else if !optional
            .iter()
            .any(|(known, numbers)| *known == name && is_numbers(value, *numbers))
        {
            return false;
        }
    }
    met == required.len()
}

/// Whether a value is `count` finite numbers with single spaces between them; any text if `count` is 0.
fn is_numbers(value: &str, count: usize) -> bool {
    count == 0 || (value.split(' ').count() == count && value.split(' ').all(is_finite))
}

fn is_finite(word: &str) -> bool {
    word.parse::<f64>().is_ok_and(f64::is_finite)
}
