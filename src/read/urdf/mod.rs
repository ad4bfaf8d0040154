//! URDF: robots with every number, name and place as it was written.
//!
//! Owns the way from a text to a `Robot`, its claims and its frame names. Reads what urdfdom would read, keeps what
//! it would ignore. Rules judge.

mod consumer;
mod joint;
mod known;
mod link;
mod mesh;
mod numbers;
mod plain;
mod reader;
mod repair;
#[cfg(test)]
mod tests;
mod xml;

use crate::source::{Place, Problem, ReadStatus, Source, SourceId};
use crate::world::Facts;
use crate::world::robot::ConsumerOpinion;

use self::reader::Reader;
use self::repair::RepairedText;
use self::xml::{Element, Text, Top};

pub use self::mesh::MeshLookup;
pub(super) use self::xml::parse_strict;

/// Reads the URDF in `source.text`. Fills status and problems of the source.
pub fn read(source: &mut Source, meshes: &MeshLookup) -> Facts {
    read_as(source, meshes, false)
}

/// Reads the elements of a xacro file that need no expansion: links and joints with literal names, outside of
/// macros and inside, and claims of joints whose numbers are literal.
pub(crate) fn read_unexpanded(source: &mut Source, meshes: &MeshLookup) -> Facts {
    read_as(source, meshes, true)
}

fn read_as(source: &mut Source, meshes: &MeshLookup, xacro: bool) -> Facts {
    let mut problems = Vec::new();
    let facts = read_text(source.id, &source.text, meshes, xacro, &mut problems);
    for (status, Problem { place, message, help }) in problems {
        source.problem_with_help(status, place, message, help);
    }
    let links = facts.robots.iter().flat_map(|robot| &robot.links);
    let found = links
        .flat_map(|link| &link.meshes)
        .filter(|mesh| mesh.found == Some(true));
    for mesh in found.filter(|mesh| mesh.usage == "visual") {
        let name = &mesh.filename.value;
        source.meshes.extend(meshes.file(name).map(|file| (name.clone(), file)));
    }
    facts
}

type Problems = Vec<(ReadStatus, Problem)>;

fn read_text(id: SourceId, text: &str, meshes: &MeshLookup, xacro: bool, problems: &mut Problems) -> Facts {
    let mut add = |status, place, message: String, help: Option<String>| {
        problems.push((status, Problem { place, message, help }));
    };
    let strict = Text {
        source: id,
        original: text,
        shift: 0,
    };
    if let Some(document) = xml::parse_strict(text)
        && Element::root(&document, strict).name() == "robot"
    {
        let fragment = xacro.then(|| "xacro, not expanded".to_owned());
        return read_root(&Element::root(&document, strict), meshes, fragment, &mut add);
    }
    let repaired = repair::repair(text);
    if let Some(span) = repaired.entity {
        let message = "declares an XML entity, which URDF parsers do not expand".to_owned();
        let help = Some("write the value where it is used, or use a xacro property".to_owned());
        add(ReadStatus::Unreadable, Place::text(id, span), message, help);
        return Facts::default();
    }
    if let Some((span, message)) = repaired.excess {
        add(ReadStatus::Unreadable, Place::text(id, span), message, None);
        return Facts::default();
    }
    let mut fragment = xacro.then(|| "xacro, not expanded".to_owned());
    let shift = match xml::top(&repaired, xacro) {
        Top::Robot(second) => {
            if let Some(span) = second {
                let message = "a second element follows `</robot>`: URDF parsers read only the first".to_owned();
                add(ReadStatus::Partial, Place::text(id, span), message, None);
            }
            0
        }
        Top::Fragment => {
            let message =
                "there is no `<robot>` around these elements: probably a part that another file includes".to_owned();
            fragment = fragment.or_else(|| Some("a part without `<robot>`".to_owned()));
            if !xacro {
                let place = repaired
                    .tops
                    .first()
                    .map_or(Place::whole(id), |(_, span)| Place::text(id, *span));
                let help = "check the file that includes it; only elements written out here were read".to_owned();
                add(ReadStatus::Partial, place, message, Some(help));
            }
            WRAP.len()
        }
        Top::Other(message, span, help) => {
            let place = span.map_or(Place::whole(id), |span| Place::text(id, span));
            add(ReadStatus::Unreadable, place, message, help);
            return Facts::default();
        }
    };
    let text = Text {
        source: id,
        original: text,
        shift,
    };
    let wrapped = wrap(&repaired, shift > 0);
    let document = match xml::parse(&wrapped, text) {
        Ok(document) => document,
        Err(fault) => {
            let message = format!("not well-formed XML: {}", fault.message);
            add(ReadStatus::Unreadable, Place::text(id, fault.span), message, None);
            return Facts::default();
        }
    };
    read_root(&Element::root(&document, text), meshes, fragment, &mut add)
}

/// Reads a description from its root element on. `fragment` states why it is not a whole robot, if it is not.
fn read_root(
    root: &Element<'_>,
    meshes: &MeshLookup,
    mut fragment: Option<String>,
    add: &mut impl FnMut(ReadStatus, Place, String, Option<String>),
) -> Facts {
    if fragment.is_none()
        && let Some((reason, place)) = reader::xacro_sign(root)
    {
        let help = "expand it with `xacro`, or rename it to `.xacro`; only elements that need no expansion were read"
            .to_owned();
        add(ReadStatus::Partial, place, reason.clone(), Some(help));
        fragment = Some(reason);
    }
    let opinion = match &fragment {
        Some(reason) => ConsumerOpinion::NotAsked(reason.clone()),
        None => consumer::ask(root),
    };
    Reader::new(root, root.place().source, meshes, fragment, opinion).read(root)
}

/// What is put around a part without a root element.
const WRAP: &str = "<robot>";

fn wrap(repaired: &RepairedText, needed: bool) -> std::borrow::Cow<'_, str> {
    if needed {
        format!("{WRAP}{}</robot>", repaired.text).into()
    } else {
        repaired.text.as_str().into()
    }
}
