//! The place of a value: the path of keys to it, the frames that the keys around it name, and the claims made so far.
//!
//! Owns labels and readings of claims. Knows nothing of the shapes of numbers.

use std::collections::BTreeMap;

use crate::source::{Confidence, Place, SourceId, Span};
use crate::tables::Dialect;
use crate::world::transform_name::{self, NameStyle, TransformName};
use crate::world::{Claim, ClaimKind, DeclaredChain, Doubt, Facts, FrameId, FrameRole, FrameUse};

use super::dialect::{self, TableEntry, Terms, TermsSource};
use super::document::Node;
use super::frames::{BASE_FRAMES, NamedFrames, SENSOR_FRAMES, below_parent, beside, frame_name, settled, stated};
use super::names;
use super::numbers;
use super::shapes::Draft;

/// One step of the path: a value and its key.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    /// The key; `None` for the root and for items of a list.
    pub(super) key: Option<&'a Node>,
    /// The index, for items of a list.
    pub(super) index: Option<usize>,
    /// The value.
    pub(super) node: &'a Node,
}

/// A claim with the key its frames were taken from, if they were.
struct KeyedClaim {
    claim: Claim,
    role: FrameRole,
    named_by: Option<String>,
}

/// The walk through one source.
pub(super) struct Walk<'a> {
    source: SourceId,
    /// The source's text.
    pub(super) text: &'a str,
    /// The dialect of the file, where it is known.
    dialect: Option<&'a Dialect>,
    /// What holds where the dialect says nothing.
    generic: Terms,
    path: Vec<Step<'a>>,
    found: Vec<KeyedClaim>,
    chains: Vec<DeclaredChain>,
    /// Faults that kept a transform from being read.
    pub(super) problems: Vec<(Span, String)>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(source: SourceId, text: &'a str, dialect: Option<&'a Dialect>) -> Self {
        Self {
            source,
            text,
            dialect,
            generic: Terms {
                degrees: names::comments_say_degrees(text),
                ..dialect::GENERIC
            },
            path: Vec::new(),
            found: Vec::new(),
            chains: Vec::new(),
            problems: Vec::new(),
        }
    }

    /// Runs `inside` one step deeper.
    pub(super) fn step(&mut self, step: Step<'a>, inside: impl FnOnce(&mut Self)) {
        self.path.push(step);
        inside(self);
        self.path.pop();
    }

    /// The key of the current value; items of a list share the key of the list.
    pub(super) fn key(&self) -> &'a str {
        self.key_node().and_then(Node::text).unwrap_or_default()
    }

    /// The node of [`Walk::key`].
    pub(super) fn key_node(&self) -> Option<&'a Node> {
        self.path.iter().rev().find(|step| step.index.is_none())?.key
    }

    /// The key just above the current value, if it is not an item of a list.
    pub(super) fn own_key(&self) -> Option<&'a Node> {
        self.path.last()?.key
    }

    /// The key of the mapping that contains the current value.
    pub(super) fn parent_key(&self) -> Option<&'a str> {
        let mut keys = self.path.iter().rev().filter(|step| step.index.is_none());
        keys.nth(1)?.key?.text()
    }

    /// Whether the current value's key, or the one above a key that names no frames, satisfies `test`.
    pub(super) fn any_key(&self, test: impl Fn(&str) -> bool) -> bool {
        for step in self.path.iter().rev() {
            let Some(key) = step.key.and_then(Node::text) else {
                continue;
            };
            if test(key) {
                return true;
            }
            if !names::is_neutral(key) {
                return false;
            }
        }
        false
    }

    /// The keys from the root to the current value, with more after them, joined by `/`.
    pub(super) fn label(&self, last: &str) -> String {
        let mut parts: Vec<String> = self
            .path
            .iter()
            .filter_map(|step| match step.index {
                Some(index) => Some(index.to_string()),
                None => step.key.map(|key| key.text().unwrap_or("?").to_owned()),
            })
            .collect();
        if !last.is_empty() {
            parts.push(last.to_owned());
        }
        parts.join("/")
    }

    /// What the dialect says about the current value, or about the one under a key in it.
    fn entry(&self, last: &str) -> Option<TableEntry<'a>> {
        dialect::entry(self.dialect?, &self.label(last))
    }

    /// Units and order of the current value, or of the one under a key in it.
    pub(super) fn terms(&self, last: &str) -> Terms {
        let said = self.entry(last).or_else(|| self.entry(""));
        said.map_or(self.generic, |said| said.terms())
    }

    /// Whether the dialect names the key of the current value, or the value is the half of something that it names.
    pub(super) fn is_known_by_key(&self) -> bool {
        let label = self.label("");
        let above = label.rsplit_once('/').map(|(above, _)| above);
        let half = self
            .dialect
            .zip(above)
            .and_then(|(row, above)| dialect::entry(row, above));
        let itself = self.entry("").is_some_and(|said| said.names(self.key()));
        itself || half.is_some() && names::half(self.key()).is_some()
    }

    /// What the dialect says about a key in the current value that it names itself.
    pub(super) fn named_key(&self, key: &str) -> Option<TableEntry<'a>> {
        self.entry(key).filter(|said| said.names(key))
    }

    /// Why the dialect's description of a statement is in doubt.
    fn doubt(&self, label: &str, by: Option<&Node>) -> Option<Doubt> {
        let said = dialect::entry(self.dialect?, label).or_else(|| self.entry(by?.text()?))?;
        let algebra = said.keyed.algebra_doubt.clone().map(Doubt::Algebra);
        algebra.or_else(|| said.keyed.doubt.clone().map(Doubt::Direction))
    }

    /// The frames that the dialect gives a statement.
    fn named_by_dialect(&self, label: &str, by: Option<&Node>, span: Span) -> Option<NamedFrames> {
        let row = self.dialect?;
        let said = dialect::entry(row, label).or_else(|| self.entry(by?.text()?))?;
        let sibling = |key: &str| {
            let mut mappings = self.path.iter().rev().map(|step| step.node);
            let under = |node: &'a Node| key.split('/').try_fold(node, |node, part| node.get(part))?.text();
            let text = mappings.find_map(under)?.trim();
            (!text.is_empty()).then(|| text.to_owned())
        };
        let place = by.map_or(span, |key| key.span);
        Some(NamedFrames {
            frames: said.frames(sibling)?,
            places: (place, place),
            reading: dialect::reading(row, said.keyed),
            role: if said.keyed.stated {
                FrameRole::Calibration
            } else {
                FrameRole::CalibrationLabel
            },
            is_role: !said.keyed.stated,
            is_contradicted: false,
        })
    }

    /// The frames that the surroundings of the current value name: keys that state them, else names of keys, from the
    /// inside out as long as the keys on the way name no frames themselves.
    pub(super) fn named(&self) -> Option<NamedFrames> {
        for (at, step) in self.path.iter().enumerate().rev() {
            if let Some(named) = stated(step.node).or_else(|| below_parent(step.node, step.key)) {
                return Some(named);
            }
            let Some(key) = step.key else { continue };
            let text = key.text()?;
            if let Some(named) = self.named_by(key) {
                let around = at.checked_sub(1).and_then(|at| self.path.get(at));
                return Some(beside(named, around.and_then(|step| stated(step.node))));
            }
            if !names::is_neutral(text) {
                break;
            }
        }
        None
    }

    /// The frames that a key in the current value names, replaced by the names that the keys next to it state.
    pub(super) fn named_inside(&self, key: &Node) -> Option<NamedFrames> {
        Some(beside(self.named_by(key)?, stated(self.path.last()?.node)))
    }

    /// The frames of a mounting (`extrinsics: {lidar: {xyz: ..., rpy: ...}}`): the sensor, in the base frame that the file states; where it
    /// states none, in the base.
    pub(super) fn mounted(&self) -> Option<NamedFrames> {
        let is_key = |step: &Step, is_it: &dyn Fn(&str) -> bool| step.key.and_then(Node::text).is_some_and(is_it);
        let at = self.path.iter().rposition(|step| is_key(step, &names::is_mountings))?;
        let mut inside = self.path.iter().skip(at + 1);
        let sensor = inside.next()?;
        let text = |node: &'a Node, keys: &[&str]| {
            let found = keys.iter().find_map(|key| node.get(key))?;
            Some((frame_name(found)?, found.span))
        };
        let own = text(sensor.node, SENSOR_FRAMES).or_else(|| {
            let name = sensor
                .key?
                .text()
                .filter(|name| !names::is_neutral(name) && names::half(name).is_none())?;
            Some((name.to_owned(), sensor.key?.span))
        })?;
        if !inside.all(|step| is_key(step, &names::is_neutral)) {
            return None;
        }
        let mut around = self.path.iter().take(at + 2).rev();
        let base = around.find_map(|step| text(step.node, BASE_FRAMES));
        let is_role = base.is_none();
        let base = base.unwrap_or_else(|| ("base".to_owned(), own.1));
        Some(NamedFrames {
            frames: (base.0, own.0),
            places: (base.1, own.1),
            reading: if is_role { Confidence::Hint } else { Confidence::Likely },
            role: FrameRole::CalibrationLabel,
            is_role,
            is_contradicted: false,
        })
    }

    /// The frames in a key's name.
    pub(super) fn named_by(&self, key: &Node) -> Option<NamedFrames> {
        let text = key.text()?;
        let name = transform_name::parse(text)?;
        let mut reading = match name.style {
            NameStyle::From => Confidence::Certain,
            NameStyle::Infix | NameStyle::Prefix if !name.ambiguous && !name.is_letters() => Confidence::Likely,
            _ => Confidence::Hint,
        };
        let TransformName { target, source, .. } = name;
        let mut named = NamedFrames {
            frames: (target, source),
            places: (key.span, key.span),
            reading,
            role: FrameRole::CalibrationLabel,
            is_role: false,
            is_contradicted: false,
        };
        // Kalibr: camera n from the camera before it.
        if named.frames.0 == "cn" && named.frames.1 == "cnm1" {
            let (camera, number, place) = self.numbered_ancestor("cam")?;
            named.frames = (
                format!("{camera}{number}"),
                format!("{camera}{}", number.checked_sub(1)?),
            );
            named.places.0 = place;
            reading = Confidence::Likely;
            named.reading = reading;
            return Some(named);
        }
        // `cam0: {T_cam_imu: ...}`: the camera is cam0.
        for (frame, place) in [
            (&mut named.frames.0, &mut named.places.0),
            (&mut named.frames.1, &mut named.places.1),
        ] {
            if let Some((stem, number, span)) = self.numbered_ancestor(frame) {
                *frame = format!("{stem}{number}");
                *place = span;
            }
        }
        Some(named)
    }

    /// The nearest key above that is `stem` followed by a number.
    fn numbered_ancestor(&self, stem: &str) -> Option<(String, u32, Span)> {
        self.path.iter().rev().find_map(|step| {
            let key = step.key?;
            let digits = key.text()?.strip_prefix(stem)?;
            Some((stem.to_owned(), digits.parse().ok()?, key.span))
        })
    }

    /// Makes a claim. Values that are not numbers become a problem instead.
    pub(super) fn emit(
        &mut self,
        draft: Draft,
        label: String,
        named: Option<&NamedFrames>,
        by: Option<&Node>,
        terms: Terms,
    ) {
        let literals = draft.translation.iter().chain(&draft.rotation);
        if let Some(bad) = literals.clone().find(|l| numbers::number(&l.text).is_none()) {
            let launch = ["$(", "${", "{{"].iter().any(|mark| bad.text.contains(mark));
            let why = if launch {
                "is filled in by another program"
            } else {
                "is not a number"
            };
            self.problems.push((
                bad.span,
                format!("`{}` {why}: the transform `{label}` cannot be read", bad.text),
            ));
            return;
        }
        let doubt = self.doubt(&label, by);
        let named = settled(named, self.named_by_dialect(&label, by, draft.span));
        let named = named.as_ref();
        let roles = named.is_some_and(|named| named.is_role);
        let mut reading = named.map_or(Confidence::Hint, |n| n.reading);
        if draft.order_guessed() {
            let ceiling = if draft.has_translation {
                Confidence::Likely
            } else {
                Confidence::Hint
            };
            reading = reading.min(ceiling);
        }
        // In a list of several, a name such as `T_cam_imu` does not say which camera.
        let is_label = !roles && named.is_some_and(|n| n.role == FrameRole::CalibrationLabel);
        let is_one_name = named.is_some_and(|n| n.places.0 == n.places.1);
        if is_label && is_one_name && self.in_list_of_several() {
            reading = Confidence::Hint;
        }
        let place = |span: Span| Place::text(self.source, span);
        let span = by.map_or(draft.span, |key| draft.span.cover(key.span));
        // A statement begins at the key that names its frames, also if the numbers have keys of their own.
        let naming = named.filter(|n| n.role == FrameRole::CalibrationLabel && n.places.0 == n.places.1);
        let span = naming.map_or(span, |n| span.cover(n.places.0));
        let role = named.map_or(FrameRole::CalibrationLabel, |n| n.role);
        let found = KeyedClaim {
            role,
            named_by: is_label.then(|| {
                let name = by.and_then(Node::text).unwrap_or_default();
                format!("{} {name}", self.key())
            }),
            claim: Claim {
                frames: named.map(|n| (FrameId::new(&n.frames.0), FrameId::new(&n.frames.1))),
                label,
                pose: draft.pose,
                has_rotation: draft.has_rotation,
                has_translation: draft.has_translation,
                spelling: draft.spelling,
                translation_literals: draft.translation,
                rotation_literals: draft.rotation,
                kind: ClaimKind::File {
                    dialect: match self.dialect {
                        _ if terms.by == TermsSource::Nesting => "autoware",
                        Some(row) if terms.are_known() => &row.name,
                        _ => "generic",
                    }
                    .to_owned(),
                    roles,
                },
                reading: if named.is_some() { reading } else { Confidence::Hint },
                doubt,
                place: place(span),
                target_place: named.map(|n| place(n.places.0)),
                source_place: named.map(|n| place(n.places.1)),
            },
        };
        // The file states both; the rules report that they contradict each other.
        if named.is_some_and(|named| named.is_contradicted) && found.claim.pose.is_some() {
            let mut stated = found.claim.clone();
            stated.label.push_str(" (as the frames stated beside it)");
            stated.frames = stated.frames.map(|(target, source)| (source, target));
            std::mem::swap(&mut stated.target_place, &mut stated.source_place);
            stated.reading = Confidence::Certain;
            self.found.push(KeyedClaim {
                role,
                named_by: None,
                claim: stated,
            });
        }
        self.found.push(found);
    }

    fn in_list_of_several(&self) -> bool {
        self.path.iter().any(|step| {
            step.node
                .items()
                .is_some_and(|items| items.len() > 1 && items.iter().all(Node::is_mapping))
        })
    }

    /// Records a declared chain; `key` may name its result.
    pub(super) fn chain(&mut self, key: &Node, node: &Node) {
        let Some(text) = node.text() else { return };
        let Some(parsed) = crate::world::chain::parse(text) else {
            return;
        };
        // Escapes and folded lines move the parts: then the whole text is their place.
        let inner = node.text_start(self.text);
        let span = |range: std::ops::Range<usize>| match inner {
            Some(start) => Span::new(start + range.start, start + range.end),
            None => node.span,
        };
        let named = || Some((transform_name::parse(key.text()?)?, key.span));
        self.chains.push(DeclaredChain {
            text: text.to_owned(),
            place: Place::text(self.source, node.span),
            factors: parsed
                .factors
                .into_iter()
                .map(|(name, range)| (name, span(range)))
                .collect(),
            result: parsed.result.map(|(name, range)| (name, span(range))).or_else(named),
            not_understood: parsed.not_understood,
            is_loose: false,
        });
    }

    /// All that was found. Where one key under several parents would name the same frames for different things
    /// (`T_SC` of each camera of a list), the names are symbols of a formula and are dropped.
    pub(super) fn finish(mut self) -> (Facts, Vec<(Span, String)>) {
        let mut same: BTreeMap<(String, FrameId, FrameId), usize> = BTreeMap::new();
        let name = |found: &KeyedClaim| {
            let (target, source) = found.claim.frames.clone()?;
            Some((found.named_by.clone()?, target, source))
        };
        for found in &self.found {
            if let Some(name) = name(found) {
                *same.entry(name).or_default() += 1;
            }
        }
        for found in &mut self.found {
            if name(found).is_some_and(|name| same.get(&name).is_some_and(|n| *n > 1)) {
                found.claim.frames = None;
                found.claim.target_place = None;
                found.claim.source_place = None;
                found.claim.reading = Confidence::Hint;
            }
        }
        let mut uses: BTreeMap<(FrameId, FrameRole), (Place, u64)> = BTreeMap::new();
        for KeyedClaim { claim, role, .. } in &self.found {
            let Some((target, source)) = &claim.frames else {
                continue;
            };
            // A program's word for a sensor is not the name of a frame.
            if matches!(claim.kind, ClaimKind::File { roles: true, .. }) {
                continue;
            }
            for (frame, place) in [(target, &claim.target_place), (source, &claim.source_place)] {
                let place = place.clone().unwrap_or_else(|| claim.place.clone());
                let entry = uses.entry((frame.clone(), *role)).or_insert((place.clone(), 0));
                entry.1 += 1;
                entry.0 = entry.0.clone().min(place);
            }
        }
        let frames = uses.into_iter().map(|((frame, role), (place, count))| FrameUse {
            frame,
            role,
            place,
            count,
        });
        let facts = Facts {
            frames: frames.collect(),
            claims: self.found.into_iter().map(|found| found.claim).collect(),
            chains: self.chains,
            ..Facts::default()
        };
        (facts, self.problems)
    }
}
