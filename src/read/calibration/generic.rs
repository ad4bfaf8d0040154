//! The generic reading: transforms under any key, recognised by the key or by the numbers.
//!
//! Owns which values become claims. Recognition is never by count alone: sixteen numbers are a transform if the key says
//! so, or if they are one within a wide margin.

use std::collections::BTreeSet;

use crate::source::{Confidence, Span};
use crate::world::transform_name::{self, NamePart};
use crate::world::{FrameId, FrameRole, Literal, Spelling};

use super::dialect::{self, Terms};
use super::document::{Kind, Node};
use super::frames::{self, NamedFrames};
use super::names::{self, PairHalf};
use super::numbers::{self, Numbers};
use super::shapes::{self, Draft, Rotation};
use super::walk::{Step, Walk};

/// Reads one document. Depth is bounded by the document model.
pub(super) fn read<'a>(root: &'a Node, walk: &mut Walk<'a>) {
    let step = Step {
        key: None,
        index: None,
        node: root,
    };
    walk.step(step, |walk| visit(root, walk));
}

fn visit<'a>(node: &'a Node, walk: &mut Walk<'a>) {
    if let Some(found) = numbers::numbers(node, walk.text) {
        value(node, &found, walk);
        return;
    }
    match &node.kind {
        Kind::Scalar { .. } => {}
        // A track, whose poses are of the platform in the world.
        Kind::Sequence(items) if is_over_time(items) => {}
        Kind::Sequence(items) => {
            for (index, item) in items.iter().enumerate() {
                let step = Step {
                    key: None,
                    index: Some(index),
                    node: item,
                };
                walk.step(step, |walk| visit(item, walk));
            }
        }
        Kind::Mapping(_) => mapping(node, walk),
    }
}

/// Whether a document has a list of poses over time.
pub(super) fn has_track(node: &Node) -> bool {
    match &node.kind {
        Kind::Scalar { .. } => false,
        Kind::Sequence(items) => is_over_time(items) || items.iter().any(has_track),
        Kind::Mapping(pairs) => pairs.iter().any(|(_, child)| has_track(child)),
    }
}

/// The names of sensors in a table of nuScenes (`sensor.json`), by their tokens.
pub(super) fn channels(root: &Node) -> Vec<(FrameId, FrameId)> {
    let named = |item: &Node| {
        let text = |key: &str| item.get(key)?.text().map(FrameId::new);
        item.get("modality")?;
        Some((text("token")?, text("channel")?))
    };
    root.items().unwrap_or_default().iter().filter_map(named).collect()
}

/// Whether a list holds poses, each with a time of its own or, as for radiance fields (`transforms.json`), with an image of its own; or records
/// of nuScenes that describe no sensor: its `ego_pose.json`, also with one pose, and its `sample_annotation.json`.
pub(super) fn is_over_time(items: &[Node]) -> bool {
    let time = |item: &Node| {
        let times = ["timestamp", "timestamp_ns", "utime", "stamp", "time", "file_path"];
        times.iter().find_map(|key| item.get(key)?.text().map(str::to_owned))
    };
    let has = |item: &Node, half: PairHalf| {
        let mut keys = item.pairs().iter().filter_map(|(key, _)| key.text());
        keys.any(|key| names::half(key).is_some_and(|(_, of)| of == half))
    };
    let is_pose = |item: &Node| {
        let is_of_image = item.get("transform_matrix").is_some() && item.get("file_path").is_some();
        is_of_image || has(item, PairHalf::Translation) && has(item, PairHalf::Rotation)
    };
    let times: Option<BTreeSet<String>> = items.iter().map(time).collect();
    let is_recorded = |item: &Node| {
        let has = |keys: &[&str]| keys.iter().any(|key| item.get(key).is_some());
        has(&["token"]) && has(&["timestamp", "sample_token"]) && !has(&["sensor_token"])
    };
    !items.is_empty()
        && items.iter().all(is_pose)
        && (items.iter().all(is_recorded) || times.is_some_and(|times| times.len() > 1))
}

/// Numbers under a key.
fn value<'a>(node: &'a Node, found: &Numbers, walk: &mut Walk<'a>) {
    let key = walk.key();
    let terms = walk.terms("");
    if names::is_never(key) && !terms.are_known() {
        return;
    }
    let strong = terms.are_known() || walk.any_key(names::is_transform) || walk.named().is_some();
    let by = walk.own_key();
    let label = walk.label("");
    if let (true, Numbers::Flat(literals)) = (terms.packed, found) {
        packed(literals, &label, by, terms, walk);
        return;
    }
    let terms = if names::says_millimetres(key) {
        Terms { metres: 1e-3, ..terms }
    } else {
        terms
    };
    if let Some((rows, cols, literals)) = found.matrix() {
        let rigid = || numbers::looks_rigid(rows, cols, &numbers::values(literals));
        if strong || rigid() {
            let draft = shapes::matrix(rows, cols, literals, terms.metres, node.span);
            let named = walk.named();
            walk.emit(draft, label, named.as_ref(), by, terms);
        }
    } else if let Some(draft) = found
        .vector(7)
        .and_then(|seven| shapes::seven(key, seven, terms, node.span))
    {
        if strong {
            let named = walk.named();
            walk.emit(draft, label, named.as_ref(), by, terms);
        }
    } else if let (true, Numbers::Misfit(why)) = (strong, found) {
        walk.problems
            .push((node.span, format!("`{label}` is not a matrix: {why}")));
    } else {
        miscounted(node, found.literals().len(), &label, walk);
    }
}

/// A transform with a number too few or too many must be reported.
fn miscounted(node: &Node, count: usize, label: &str, walk: &mut Walk<'_>) {
    let named = walk.any_key(|key| transform_name::parse(key).is_some_and(|name| name.part == NamePart::Whole));
    let rotation = walk.any_key(|key| {
        names::half(key).is_some_and(|(stem, half)| half == PairHalf::Rotation && names::is_transform(stem))
    });
    // Halves of transforms have 3, 4 or 9.
    let known = walk.is_known_by_key() && !matches!(count, 0..=4 | 9 | 16);
    let wrong = (named && matches!(count, 11 | 13..=15 | 17)) || (rotation && matches!(count, 8 | 10)) || known;
    if wrong {
        let meant = if rotation {
            "a rotation has 9"
        } else if named || !known {
            "a transform has 7, 12 or 16"
        } else {
            "a rotation has 9, a transform 7, 12 or 16"
        };
        walk.problems
            .push((node.span, format!("`{label}` has {count} numbers; {meant}")));
    }
}

/// One 3x4 out of each block of sixteen.
fn packed(literals: &[Literal], label: &str, by: Option<&Node>, terms: Terms, walk: &mut Walk<'_>) {
    let blocks: Vec<&[Literal]> = literals.chunks(16).collect();
    for (index, block) in blocks.iter().enumerate() {
        let (Some(upper), Some(last)) = (block.get(..12), block.last()) else {
            continue;
        };
        let span = upper.first().map_or(last.span, |first| first.span.cover(last.span));
        let label = if blocks.len() > 1 {
            format!("{label}/{index}")
        } else {
            label.to_owned()
        };
        let by = by.filter(|_| blocks.len() == 1);
        walk.emit(shapes::matrix(3, 4, upper, terms.metres, span), label, None, by, terms);
    }
}

fn mapping<'a>(node: &'a Node, walk: &mut Walk<'a>) {
    let mut consumed = BTreeSet::new();
    flat(node, walk);
    prefixed(node, walk);
    nested(node, walk, &mut consumed);
    halves(node, walk, &mut consumed);
    for (index, (key, child)) in node.pairs().iter().enumerate() {
        if matches!(key.text(), Some("chain" | "chains")) {
            chains(key, child, walk);
        }
        if !consumed.contains(&index) {
            let step = Step {
                key: Some(key),
                index: None,
                node: child,
            };
            walk.step(step, |walk| visit(child, walk));
        }
    }
}

/// A mapping whose own keys are the numbers.
fn flat<'a>(node: &'a Node, walk: &mut Walk<'a>) {
    let key = walk.key();
    if names::is_never(key) {
        return;
    }
    let terms = walk.terms("");
    let draft = shapes::flat_pose(key, node, walk.text, terms).or_else(|| {
        let speaks = walk.any_key(names::is_rotation) || parent_speaks_of_rotation(walk);
        shapes::flat_rotation(node, speaks, names::says_degrees(key))
    });
    let draft = draft.or_else(|| {
        // A known format may state a position alone, and so may a mapping that names both frames.
        let may_be_alone = terms.are_known() || frames::stated(node).is_some();
        let (xyz, metres) = shapes::translation(key, node, walk.text, terms).filter(|_| may_be_alone)?;
        shapes::combine(Some(&xyz), None, metres, node.span)
    });
    if let Some(draft) = draft {
        let is_rpy = matches!(draft.spelling, Spelling::Rpy { .. });
        let mounted = || walk.mounted().filter(|named| is_rpy || !named.is_role);
        let named = walk.named().or_else(mounted);
        let (label, by) = (walk.label(""), walk.own_key());
        walk.emit(draft, label, named.as_ref(), by, terms);
    }
}

/// Scalars side by side whose keys have the same beginning: `lidar_to_cam_tx`, ..., `lidar_to_cam_rz`; or the half of a transform, `qCM_x`, ..., `qCM_w`.
fn prefixed<'a>(node: &'a Node, walk: &mut Walk<'a>) {
    for (key, _) in node.pairs() {
        let Some(text) = key.text() else { continue };
        let whole = |stem| {
            let terms = (!names::is_never(stem)).then(|| walk.terms(stem))?;
            Some((stem, terms, shapes::prefixed_pose(stem, node, terms)?))
        };
        // Halves are recognised by the table alone: many keys end in `_x`, `_y` and `_z`.
        let half = |stem| {
            let terms = walk.named_key(stem)?.terms();
            Some((stem, terms, shapes::prefixed_half(stem, node, terms)?))
        };
        let stem = |end| text.strip_suffix(end).filter(|stem| !stem.is_empty());
        if let Some((stem, terms, draft)) = stem("_tx").and_then(whole).or_else(|| stem("_x").and_then(half)) {
            walk.emit(draft, walk.label(stem), None, Some(key), terms);
        }
    }
}

fn parent_speaks_of_rotation(walk: &Walk<'_>) -> bool {
    walk.parent_key().is_some_and(names::is_rotation)
}

/// Autoware's nesting: `parent: {child: {x, y, z, roll, pitch, yaw}}`; or with halves, `parent: {child: {translation: ..., rotation: ...}}`.
fn nested<'a>(node: &'a Node, walk: &mut Walk<'a>, consumed: &mut BTreeSet<usize>) {
    let Some(parent) = walk.own_key() else { return };
    let Some(carrier) = parent.text().filter(|text| names::is_carrier(text)) else {
        return;
    };
    let children: Vec<_> = node
        .pairs()
        .iter()
        .enumerate()
        .filter(|(_, (_, v))| v.is_mapping())
        .collect();
    let six = |child: &Node| {
        let plain = child.pairs().len() == 6 && ["roll", "pitch", "yaw"].iter().all(|key| child.get(key).is_some());
        plain.then(|| shapes::flat_pose("", child, walk.text, dialect::AUTOWARE))?
    };
    let own = walk.terms("");
    let read = |child: &Node| {
        let of_autoware = six(child).map(|draft| (draft, Confidence::Certain, dialect::AUTOWARE));
        of_autoware.or_else(|| Some((two_halves(child, walk.text, own)?, Confidence::Likely, own)))
    };
    let drafts: Vec<_> = children.iter().filter_map(|(_, (_, child))| read(child)).collect();
    if drafts.len() != children.len() {
        return;
    }
    for ((index, (key, _)), (draft, reading, terms)) in children.into_iter().zip(drafts) {
        let Some(child) = key.text() else { continue };
        let named = NamedFrames {
            frames: (carrier.to_owned(), child.to_owned()),
            places: (parent.span, key.span),
            reading,
            role: FrameRole::Calibration,
            is_role: false,
            is_contradicted: false,
        };
        consumed.insert(index);
        walk.emit(draft, walk.label(child), Some(&named), Some(key), terms);
    }
}

/// A mapping of a translation and a rotation, and nothing else.
fn two_halves(node: &Node, text: &str, terms: Terms) -> Option<Draft> {
    let [first, second] = node.pairs() else { return None };
    let of = |half: fn(PairHalf) -> bool| {
        let is_it = |(key, _): &&(Node, Node)| {
            let named = key.text().and_then(names::half);
            named.is_some_and(|(stem, of)| stem.is_empty() && half(of))
        };
        [first, second].into_iter().find(is_it)
    };
    let (key, value) = of(|half| half == PairHalf::Translation)?;
    let (xyz, metres) = shapes::translation(key.text()?, value, text, terms)?;
    let (key, value) = of(|half| half != PairHalf::Translation)?;
    let (_, half) = names::half(key.text()?)?;
    let rotation = shapes::rotation(key.text()?, half, value, text, terms)?;
    shapes::combine(Some(&xyz), Some(&rotation), metres, node.span)
}

/// Halves of one transform in a mapping: keys of one stem.
struct Pair<'a> {
    stem: String,
    translation: Option<(&'a Node, Vec<Literal>, f64, Span)>,
    rotations: Vec<(&'a Node, Rotation, Span)>,
}

/// Translations and rotations side by side: `extrinsic_T` and `extrinsic_R`, `translation` and `rotation`.
fn halves<'a>(node: &'a Node, walk: &mut Walk<'a>, consumed: &mut BTreeSet<usize>) {
    let mut pairs: Vec<Pair<'a>> = Vec::new();
    for (index, (key, child)) in node.pairs().iter().enumerate() {
        let Some(text) = key.text().filter(|text| !names::is_never(text)) else {
            continue;
        };
        let Some((stem, half)) = stem_of(text).or_else(|| stem_by_dialect(text, child, walk)) else {
            continue;
        };
        let terms = walk.terms(text);
        let translation = shapes::translation(text, child, walk.text, terms).filter(|_| half == PairHalf::Translation);
        let rotation = (half != PairHalf::Translation)
            .then(|| shapes::rotation(text, half, child, walk.text, terms))
            .flatten();
        if translation.is_none() && rotation.is_none() {
            continue;
        }
        let at = pairs.iter().position(|pair| pair.stem == stem).unwrap_or(pairs.len());
        if at == pairs.len() {
            pairs.push(Pair {
                stem,
                translation: None,
                rotations: Vec::new(),
            });
        }
        let Some(pair) = pairs.get_mut(at) else { continue };
        if let Some((literals, metres)) = translation {
            if pair.translation.is_none() {
                consumed.insert(index);
                pair.translation = Some((key, literals, metres, child.span));
            }
        } else if let Some(rotation) = rotation {
            consumed.insert(index);
            pair.rotations.push((key, rotation, child.span));
        }
    }
    // `xyz: [...]` beside `roll`, `pitch` and `yaw`.
    if let Some(pair) = pairs
        .iter_mut()
        .find(|pair| pair.stem.is_empty() && pair.rotations.is_empty())
        && let Some((key, ..)) = pair.translation
        && let Some((rotation, span)) = shapes::angles(node, walk.terms(key.text().unwrap_or_default()).degrees)
    {
        pair.rotations.push((key, rotation, span));
    }
    let filter = node.get("Q").is_some();
    for pair in pairs {
        emit_pair(pair, filter, walk);
    }
}

/// What halves of one transform share, and which half a key names.
fn stem_of(key: &str) -> Option<(String, PairHalf)> {
    if let Some(name) = transform_name::parse(key) {
        let half = match name.part {
            NamePart::Translation => PairHalf::Translation,
            NamePart::Rotation if names::is_angles(key) => PairHalf::Angles,
            NamePart::Rotation => PairHalf::Rotation,
            NamePart::Whole => return None,
        };
        return Some((format!("{} from {}", name.target, name.source), half));
    }
    names::half(key).map(|(stem, half)| (stem.to_owned(), half))
}

/// The same by the dialect, which may name the keys of both halves.
fn stem_by_dialect(key: &str, value: &Node, walk: &Walk<'_>) -> Option<(String, PairHalf)> {
    let stem = walk.named_key(key)?.stem()?;
    let found = numbers::numbers(value, walk.text)?;
    let half = if found.vector(3).is_some() {
        PairHalf::Translation
    } else {
        PairHalf::Rotation
    };
    Some((stem, half))
}

fn emit_pair<'a>(mut pair: Pair<'a>, filter: bool, walk: &mut Walk<'a>) {
    // Names of the frames: the halves' own, else those of the surroundings.
    let named_of = |key: &Node, rotation: Option<&Rotation>, walk: &Walk<'a>| {
        let named = walk.named_inside(key).or_else(|| walk.named());
        named.or_else(|| match rotation {
            // The direction of a matrix is unknown.
            Some(Rotation::Matrix(_)) => None,
            Some(Rotation::Rpy { .. }) => walk.mounted(),
            _ => walk.mounted().filter(|named| !named.is_role),
        })
    };
    let terms_of = |key: &Node, walk: &Walk<'a>| walk.terms(key.text().unwrap_or_default());
    let best = pair
        .rotations
        .iter()
        .position(|(_, rotation, _)| !matches!(rotation, Rotation::Rpy { .. }));
    let first = (!pair.rotations.is_empty()).then(|| pair.rotations.remove(best.unwrap_or(0)));
    match (pair.translation, first) {
        (Some((t_key, xyz, metres, t_span)), Some((r_key, rotation, r_span))) => {
            let span = t_span.cover(r_span).cover(t_key.span).cover(r_key.span);
            let named = named_of(r_key, Some(&rotation), walk);
            let last = if pair.stem.contains(' ') {
                r_key.text().unwrap_or_default()
            } else {
                &pair.stem
            };
            let mut label = walk.label(last);
            if label.is_empty() {
                r_key.text().unwrap_or_default().clone_into(&mut label);
            }
            if let Some(draft) = shapes::combine(Some(&xyz), Some(&rotation), metres, span) {
                walk.emit(draft, label, named.as_ref(), Some(r_key), terms_of(r_key, walk));
            }
        }
        (Some((key, xyz, metres, span)), None) => {
            let named = named_of(key, None, walk);
            if (named.is_some() || names::is_transform(&pair.stem))
                && let Some(draft) = shapes::combine(Some(&xyz), None, metres, span)
            {
                let label = walk.label(key.text().unwrap_or_default());
                walk.emit(draft, label, named.as_ref(), Some(key), terms_of(key, walk));
            }
        }
        (None, Some(lone)) => pair.rotations.push(lone),
        (None, None) => {}
    }
    for (key, rotation, span) in pair.rotations {
        let text = key.text().unwrap_or_default();
        let named = named_of(key, Some(&rotation), walk);
        let says = names::is_transform(text);
        let convincing = match &rotation {
            Rotation::Matrix(literals) => {
                let near =
                    numbers::upper_left(3, &numbers::values(literals)).is_some_and(|m| numbers::near_rotation(&m));
                says || (near && !filter)
            }
            Rotation::Quaternion { literals, .. } => named.is_some() || numbers::near_unit(literals),
            // Three angles alone may be degrees, or no rotation at all.
            Rotation::Rpy { .. } => named.is_some(),
        };
        if convincing && let Some(draft) = shapes::combine(None, Some(&rotation), 1.0, span) {
            walk.emit(draft, walk.label(text), named.as_ref(), Some(key), terms_of(key, walk));
        }
    }
}

/// Declared chains: a text, a list of texts, or texts under the names of their results.
fn chains<'a>(key: &'a Node, node: &'a Node, walk: &mut Walk<'a>) {
    match &node.kind {
        Kind::Scalar { .. } => walk.chain(key, node),
        Kind::Sequence(items) => {
            for item in items {
                walk.chain(key, item);
            }
        }
        Kind::Mapping(pairs) => {
            for (name, text) in pairs {
                walk.chain(name, text);
            }
        }
    }
}
