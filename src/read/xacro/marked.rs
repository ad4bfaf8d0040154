//! Copies of a xacro file and of its includes, in which every element states where it is written; and the way back from an expansion
//! of them to these places.
//!
//! Owns the marks. An element that is not marked (of a file whose name is an expression, made by `xacro:element`) has the place of the
//! element around it.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use roxmltree::Node;

use super::super::allowed::AllowedFolders;
use super::super::urdf;
use crate::files::TempPath;
use crate::source::{ExpansionPart, Place, SourceId, Span};

/// The attribute that is the mark: `file:offset`.
const MARK: &str = "frames-lint-at";

/// Files that are copied; further included files have no places.
const MOST_FILES: usize = 500;

/// Larger files are not copied, bytes.
const LARGEST: u64 = 8 * 1024 * 1024;

/// A file that contains xacro.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template {
    /// Where it is.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

/// The marked copies of a file, the first, and of those that it includes. They are deleted with this value.
pub(super) struct Copies {
    folder: TempPath,
    templates: Vec<Template>,
    allowed: AllowedFolders,
}

impl Copies {
    /// `None` where the file cannot be copied, or is not XML.
    pub(super) fn new(path: &Path, packages: &BTreeMap<String, PathBuf>, allowed: &AllowedFolders) -> Option<Self> {
        let mut copies = Self {
            folder: TempPath::folder().ok()?,
            templates: Vec::new(),
            allowed: allowed.clone(),
        };
        copies.add(path)?;
        let mut next = 0;
        while let Some(template) = copies.templates.get(next).cloned() {
            let marked = copies.marked(next, &template, packages)?;
            if next == 0 {
                fs::write(copies.top(), included_by(&marked, &copies.path(0))?).ok()?;
            }
            fs::write(copies.path(next), marked).ok()?;
            next += 1;
        }
        Some(copies)
    }

    /// A file in place of the original. It includes the copy, for `xacro-rs` reads what is included at once, and the first file byte by byte.
    pub(super) fn top(&self) -> PathBuf {
        self.folder.path().join("top.xacro")
    }

    fn path(&self, index: usize) -> PathBuf {
        self.folder.path().join(format!("{index}.xacro"))
    }

    /// The number of a file among the copies; `None` where it is not copied.
    fn add(&mut self, path: &Path) -> Option<usize> {
        if let Some(known) = self.templates.iter().position(|template| template.path == path) {
            return Some(known);
        }
        // The first is the user's own.
        if !self.templates.is_empty() && !self.allowed.holds(path) {
            return None;
        }
        let meta = fs::metadata(path).ok()?;
        if !meta.is_file() || meta.len() > LARGEST || self.templates.len() >= MOST_FILES {
            return None;
        }
        let mut text = String::new();
        let file = fs::File::open(path).ok()?;
        file.take(LARGEST).read_to_string(&mut text).ok()?;
        // The texts of inputs do not have this mark; places would be shifted by it.
        if text.starts_with('\u{feff}') {
            return None;
        }
        urdf::parse_strict(&text)?;
        self.templates.push(Template {
            path: path.to_owned(),
            text,
        });
        Some(self.templates.len() - 1)
    }

    /// The text of a copy: marked, with the copies of what it includes, and with folders for the available packages.
    fn marked(&mut self, index: usize, template: &Template, packages: &BTreeMap<String, PathBuf>) -> Option<String> {
        let document = urdf::parse_strict(&template.text)?;
        let mut edits: BTreeMap<usize, (usize, String)> = BTreeMap::new();
        for (at, _) in template.text.match_indices("$(find ") {
            let rest = template.text.get(at..).unwrap_or_default();
            if let Some(end) = rest.find(')')
                && let Some(folder) = rest
                    .get("$(find ".len()..end)
                    .and_then(|name| packages.get(name.trim()))
                && let Some(folder) = spelled(folder)
            {
                edits.insert(at, (at + end + 1, folder));
            }
        }
        for node in document.descendants().filter(Node::is_element) {
            let start = node.range().start;
            if !is_xacro(&node, &template.text) {
                let end = name_end(&template.text, start);
                edits.insert(end, (end, format!(" {MARK}=\"{index}:{start}\"")));
            } else if node.tag_name().name() == "include"
                && let Some(filename) = node.attribute_node("filename")
                && let Some(included) = self.included(filename.value(), template, packages)
            {
                let range = filename.range_value();
                edits.retain(|at, _| !range.contains(at));
                edits.insert(range.start, (range.end, included));
            }
        }
        let mut out = String::with_capacity(template.text.len() * 2);
        let mut from = 0;
        for (start, (end, replacement)) in edits {
            out.push_str(template.text.get(from..start)?);
            out.push_str(&replacement);
            from = end;
        }
        out.push_str(template.text.get(from..)?);
        Some(out)
    }

    /// What a copy includes in place of `filename`: the copy of that file, or else its own path.
    fn included(
        &mut self,
        filename: &str,
        template: &Template,
        packages: &BTreeMap<String, PathBuf>,
    ) -> Option<String> {
        let folder = template.path.parent()?;
        let mut resolved = filename.to_owned();
        for (name, folder) in packages {
            resolved = resolved.replace(&format!("$(find {name})"), &folder.to_string_lossy());
        }
        if resolved.starts_with('$') {
            return None;
        }
        let path = folder.join(&resolved);
        if !resolved.contains(['$', '*', '?', '['])
            && let Some(index) = self.add(&path)
        {
            return spelled(&self.path(index));
        }
        spelled_open(&path)
    }

    /// A text that names copies, with the names of the original files.
    pub(super) fn with_files(&self, text: &str) -> String {
        let mut text = text.replace(&*self.top().to_string_lossy(), &self.path(0).to_string_lossy());
        for (index, template) in self.templates.iter().enumerate().rev() {
            text = text.replace(&*self.path(index).to_string_lossy(), &template.path.to_string_lossy());
        }
        text
    }

    /// The expansion without its marks, and where it is written: ids of sources are numbers of templates.
    pub(super) fn unmarked(self, marked: &str) -> (String, Vec<ExpansionPart>, Vec<Template>) {
        let marked = self.with_files(marked);
        let open = format!(" {MARK}=\"");
        let mut text = String::with_capacity(marked.len());
        let mut marks = Vec::new();
        let mut pieces = marked.split(open.as_str());
        text.push_str(pieces.next().unwrap_or_default());
        for piece in pieces {
            let (mark, rest) = piece.split_once('"').unwrap_or(("", piece));
            let mark = mark.split_once(':');
            let mark = mark.and_then(|(file, start)| Some((file.parse().ok()?, start.parse().ok()?)));
            marks.extend(mark.map(|mark: (usize, usize)| (text.len(), mark)));
            text.push_str(rest);
        }
        let written = written(&text, &marks, &self.templates).unwrap_or_default();
        (text, written, self.templates)
    }
}

/// `text` up to the start tag of its root, and the content of the root by including the file of the text; the whole text if nothing can be
/// included.
fn included_by(text: &str, path: &Path) -> Option<String> {
    let document = urdf::parse_strict(text)?;
    let root = document.root_element();
    let Span { start, end } = tag(&root, text);
    let opening = text.get(..end)?;
    if opening.ends_with("/>") {
        return Some(text.to_owned());
    }
    let name = text.get(start + 1..name_end(text, start))?;
    let path = spelled(path)?;
    let space = match root.lookup_namespace_uri(Some("xacro")) {
        Some(_) => "",
        None => " xmlns:xacro=\"http://www.ros.org/wiki/xacro\"",
    };
    let opening = opening.strip_suffix('>')?;
    Some(format!(
        "{opening}{space}><xacro:include filename=\"{path}\"/></{name}>\n"
    ))
}

/// A path for an attribute; `None` if it would need to be quoted.
fn spelled(path: &Path) -> Option<String> {
    let path = path.to_str()?;
    (!path.contains('$')).then(|| spelled_open(Path::new(path)))?
}

/// The same for a path with expressions in it.
fn spelled_open(path: &Path) -> Option<String> {
    let path = path.to_str()?;
    (!path.contains(['<', '>', '&', '"', '\''])).then(|| path.to_owned())
}

fn is_xacro(node: &Node<'_, '_>, text: &str) -> bool {
    let is_named = text
        .get(node.range().start + 1..)
        .is_some_and(|rest| rest.starts_with("xacro:"));
    is_named || node.tag_name().namespace().is_some_and(|space| space.contains("xacro"))
}

/// The end of the name of the element that begins at `start`.
fn name_end(text: &str, start: usize) -> usize {
    let rest = text.get(start..).unwrap_or_default();
    let length = rest.find(|c: char| c.is_whitespace() || matches!(c, '/' | '>'));
    start + length.unwrap_or(rest.len())
}

/// The start tag.
fn tag(node: &Node<'_, '_>, text: &str) -> Span {
    let start = node.range().start;
    let behind = node.attributes().map(|attribute| attribute.range().end).max();
    let behind = behind.unwrap_or(0).max(name_end(text, start));
    let close = text.get(behind..).and_then(|rest| rest.find('>'));
    Span::new(start, close.map_or(behind, |close| behind + close + 1))
}

/// Where the elements of an expansion are written, their start tags, and their attributes.
fn written(text: &str, marks: &[(usize, (usize, usize))], templates: &[Template]) -> Option<Vec<ExpansionPart>> {
    let document = urdf::parse_strict(text)?;
    let parsed: Vec<_> = templates
        .iter()
        .filter_map(|template| urdf::parse_strict(&template.text))
        .collect();
    let elements: Vec<BTreeMap<usize, Node<'_, '_>>> = parsed
        .iter()
        .map(|document| {
            let elements = document.descendants().filter(Node::is_element);
            elements.map(|node| (node.range().start, node)).collect()
        })
        .collect();
    let mut all = Vec::new();
    let mut marks = marks.iter().peekable();
    for node in document.descendants().filter(Node::is_element) {
        let here = tag(&node, text);
        while marks.next_if(|(at, _)| *at <= here.start).is_some() {}
        let Some((_, (file, start))) = marks.next_if(|(at, _)| *at <= here.end) else {
            continue;
        };
        let Some((origin, template)) = elements
            .get(*file)
            .and_then(|of| of.get(start))
            .zip(templates.get(*file))
        else {
            continue;
        };
        let source = SourceId(u32::try_from(*file).unwrap_or(u32::MAX));
        let mut add = |span: Span, at: Span| {
            all.push(ExpansionPart {
                span,
                place: Place::text(source, at),
            });
        };
        let tag = tag(origin, &template.text);
        add(node.range().into(), tag);
        add(here, tag);
        for attribute in node.attributes() {
            let name = attribute.name();
            if let Some(own) = origin.attributes().find(|own| own.name() == name) {
                add(attribute.range_value().into(), own.range_value().into());
            }
        }
    }
    Some(all)
}
