//! The frame tree as a drawing of its own: one SVG file without fonts, scripts or links, for light and dark.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::run::Run;

use super::layout::{self, FramePosition, Tree};
use super::sketch::{Edge, Sketch, sketches};
use super::{label, pose_words};

const MARGIN: u32 = 24;
const ROW: u32 = 66;
const BOX: u32 = 50;
const COLUMN_GAP: u32 = 64;
/// Indent of a child from its parent, if each frame has its own row.
const STEP: u32 = 30;
const HEADING: u32 = 34;
/// Characters of a line in a box; the whole text is in its tooltip.
const LONGEST: usize = 46;

/// Light first, for programs without media queries; then the changes for dark.
const LOOK: &str = "\
text { font: 10px ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace; fill: #57606a }
.paper { fill: #ffffff }
.name { font-size: 13px; font-weight: bold; fill: #1f2328 }
.head { font: bold 14px ui-sans-serif, 'DejaVu Sans', Helvetica, Arial, sans-serif; fill: #1f2328 }
.box { fill: #f6f8fa; stroke: #8c959f }
.root { fill: #ddf4ff; stroke: #0969da }
.out { stroke-dasharray: 2 3 }
.edge { fill: none; stroke: #57606a; stroke-width: 1.5 }
.moving { stroke: #0969da; stroke-dasharray: 6 4 }
.disputed { stroke: #cf222e }
.other { stroke: #cf222e; stroke-dasharray: 2 3 }
.bad { fill: #cf222e }
@media (prefers-color-scheme: dark) {
text { fill: #9198a1 }
.paper { fill: #0d1117 }
.name, .head { fill: #f0f6fc }
.box { fill: #161b22; stroke: #656c76 }
.root { fill: #121d2f; stroke: #4493f8 }
.edge { stroke: #9198a1 }
.moving { stroke: #4493f8 }
.disputed, .other { stroke: #f85149 }
.bad { fill: #f85149 }
}
";

/// The drawing: roots at the left, one tree below the other, the largest first. Solid edges are constant, dashed ones move,
/// red ones are disputed, dotted red ones lead to a frame that is drawn under another parent.
pub fn render(run: &Run) -> String {
    let Drawing {
        width, height, body, ..
    } = drawing(run, None);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
         {height}\">\n<title>Frame tree</title>\n<style>\n{LOOK}</style>\n<rect class=\"paper\" width=\"{width}\" \
         height=\"{height}\"/>\n{body}</svg>\n"
    )
}

/// The drawing without its file header: for a page that defines the look of its classes.
pub(in crate::report) struct Drawing {
    pub(in crate::report) width: u32,
    pub(in crate::report) height: u32,
    pub(in crate::report) body: String,
    /// Frames that are drawn.
    pub(in crate::report) frames: usize,
    /// The upper edges of their boxes.
    tops: Vec<u32>,
}

impl Drawing {
    /// The range of the drawing on each sheet, of this height at most, so that no box is cut; a range without such a cut stays whole.
    pub(in crate::report) fn sheets(&self, most: u32) -> Vec<(u32, u32)> {
        let mut sheets = Vec::new();
        let mut from = 0;
        while self.height - from > most {
            let is_free = |at: &u32| !self.tops.iter().any(|top| (*top..top + BOX).contains(at));
            let beneath = self.tops.iter().map(|top| top + BOX + (ROW - BOX) / 2);
            let fitting = beneath
                .filter(|at| (from + 1..=from + most).contains(at))
                .filter(is_free);
            let Some(to) = fitting.max() else { break };
            sheets.push((from, to));
            from = to;
        }
        sheets.push((from, self.height));
        sheets
    }
}

/// Draws the worlds of a run. A tree wider than `widest` has a row for each frame, with children below their parents and indented.
pub(in crate::report) fn drawing(run: &Run, widest: Option<u32>) -> Drawing {
    let sketches = sketches(run);
    let mut page = Page {
        body: String::new(),
        width: 480,
        y: MARGIN,
        widest,
        tops: Vec::new(),
    };
    for sketch in &sketches {
        if sketches.len() > 1 {
            page.heading(&sketch.title);
        }
        world(sketch, &mut page);
    }
    if sketches.is_empty() {
        page.heading("No frames");
    }
    page.legend();
    Drawing {
        width: page.width + MARGIN,
        height: page.y + MARGIN,
        body: page.body,
        tops: page.tops,
        frames: sketches
            .iter()
            .map(|sketch| sketch.frames.len() + sketch.outside.len())
            .sum(),
    }
}

/// The drawing so far, and its extent.
struct Page {
    body: String,
    width: u32,
    y: u32,
    widest: Option<u32>,
    tops: Vec<u32>,
}

fn world(sketch: &Sketch, page: &mut Page) {
    let trees = layout::trees(sketch);
    for (index, tree) in trees.iter().enumerate() {
        if trees.len() > 1 {
            page.heading(&format!("Tree {} of {}", index + 1, trees.len()));
        }
        draw(sketch, tree, page);
    }
    if !sketch.outside.is_empty() {
        page.heading("Named, but not in a tree");
    }
    for (name, places) in &sketch.outside {
        let node = Node {
            class: "box out",
            lines: vec![name.clone(), places.join(", ")],
            whole: format!("{name}\n{}", places.join("\n")),
        };
        let y = page.y;
        page.node(MARGIN, y, &node);
        page.y += ROW;
    }
}

/// The content of a frame's box.
struct Node {
    class: &'static str,
    /// The name, and up to two lines of small print.
    lines: Vec<String>,
    /// The tooltip.
    whole: String,
}

impl Node {
    fn new(sketch: &Sketch, position: &FramePosition) -> Self {
        let name = sketch.frames.get(position.frame).cloned().unwrap_or_default();
        let Some(edge) = position.edge.and_then(|edge| sketch.edges.get(edge)) else {
            return Self {
                class: "box root",
                whole: name.clone(),
                lines: vec![name],
            };
        };
        let leading = edge.link.leading();
        let pose = leading.and_then(|statement| Some((statement, statement.parent_from_child.as_ref()?)));
        let pose = match pose {
            None => "no valid pose".to_owned(),
            Some((statement, pose)) if statement.constant => pose_words(pose),
            Some((statement, pose)) => format!("{} ({})", pose_words(pose), statement.moment),
        };
        let who = edge.link.statements.first().map_or("", |statement| &statement.who);
        let who = match edge.link.statements.len() {
            0 | 1 => who.to_owned(),
            n => format!("+{} {who}", n - 1),
        };
        Self {
            class: "box",
            whole: format!("{name}\n{pose}\n{}", label(&edge.link, "! ")),
            lines: vec![name, pose, who],
        }
    }

    fn width(&self) -> u32 {
        let columns = |line: &String| u32::try_from(columns(&shortened(line))).unwrap_or(0);
        let name = self.lines.first().map_or(0, |line| columns(line) * 8);
        let rest = self
            .lines
            .iter()
            .skip(1)
            .map(|line| columns(line) * 6)
            .max()
            .unwrap_or(0);
        name.max(rest) + 20
    }
}

fn draw(sketch: &Sketch, tree: &Tree, page: &mut Page) {
    let nodes: Vec<Node> = tree.frames.iter().map(|position| Node::new(sketch, position)).collect();
    let mut widths: Vec<u32> = Vec::new();
    for (position, node) in tree.frames.iter().zip(&nodes) {
        widths.resize(widths.len().max(position.depth + 1), 0);
        if let Some(width) = widths.get_mut(position.depth) {
            *width = node.width().max(*width);
        }
    }
    let mut x = MARGIN;
    let columns: Vec<u32> = widths
        .iter()
        .map(|width| {
            let left = x;
            x += width + COLUMN_GAP;
            left
        })
        .collect();
    let is_stepped = page.widest.is_some_and(|widest| x - COLUMN_GAP > widest);
    let top = page.y;
    let mut places: Vec<(u32, u32)> = Vec::new();
    for position in &tree.frames {
        places.push(if is_stepped {
            let depth = u32::try_from(position.depth).unwrap_or(0);
            let place = (MARGIN + depth * STEP, page.y);
            page.y += ROW;
            place
        } else {
            // Rows count in halves: a parent is between its children.
            let left = columns.get(position.depth).copied().unwrap_or(MARGIN);
            (left, top + position.half_row * ROW / 2)
        });
    }
    if !is_stepped {
        page.y = top + tree.half_rows * ROW / 2;
    }
    let place = |index: usize| Some((*places.get(index)?, nodes.get(index)?.width()));
    for (child, position) in tree.frames.iter().enumerate() {
        let ends = position.parent.and_then(|parent| place(parent).zip(place(child)));
        if let (Some((from, to)), Some(edge)) = (ends, position.edge.and_then(|edge| sketch.edges.get(edge))) {
            let class = class(edge);
            if is_stepped {
                // The part before the child is shared with its siblings.
                let ((x1, y1), (x2, y2)) = (from.0, to.0);
                let (x1, y2) = (x1 + STEP / 2, y2 + BOX / 2);
                page.edge("edge", &format!("M{x1} {}V{y2}", y1 + BOX));
                page.edge(class, &format!("M{x1} {y2}H{x2}"));
            } else {
                page.edge(class, &curve(from, to));
            }
        }
    }
    let numbers = tree.frames.iter().enumerate();
    let drawn: BTreeMap<usize, usize> = numbers.map(|(index, position)| (position.frame, index)).collect();
    for edge in tree.others.iter().filter_map(|other| sketch.edges.get(*other)) {
        let end = |frame: usize| drawn.get(&frame).and_then(|index| place(*index));
        if let Some((from, to)) = end(edge.parent).zip(end(edge.child)) {
            page.edge(
                "edge other",
                &if is_stepped { around(from, to) } else { curve(from, to) },
            );
        }
    }
    for ((x, y), node) in places.iter().zip(&nodes) {
        page.node(*x, *y, node);
    }
}

/// The upper left corner of a box, and its width.
type Place = ((u32, u32), u32);

/// From the right of a box to the left of another.
fn curve(((x1, y1), width): Place, ((x2, y2), _): Place) -> String {
    let (x1, y1, y2, bend) = (x1 + width, y1 + BOX / 2, y2 + BOX / 2, COLUMN_GAP / 2);
    let back = x2.saturating_sub(bend);
    format!("M{x1} {y1}C{} {y1} {back} {y2} {x2} {y2}", x1 + bend)
}

/// From the right of a box to the right of another.
fn around(((x1, y1), from): Place, ((x2, y2), to): Place) -> String {
    let (x1, y1, x2, y2) = (x1 + from, y1 + BOX / 2, x2 + to, y2 + BOX / 2);
    let far = x1.max(x2) + COLUMN_GAP / 2;
    format!("M{x1} {y1}C{far} {y1} {far} {y2} {x2} {y2}")
}

fn class(edge: &Edge) -> &'static str {
    match (edge.link.is_disputed(), edge.link.moves()) {
        (true, _) => "edge disputed",
        (false, true) => "edge moving",
        (false, false) => "edge",
    }
}

impl Page {
    fn heading(&mut self, text: &str) {
        self.y += HEADING;
        let baseline = self.y - HEADING / 2;
        let _ = writeln!(
            self.body,
            "<text class=\"head\" x=\"{MARGIN}\" y=\"{baseline}\">{}</text>",
            escaped(&shortened(text))
        );
    }

    fn edge(&mut self, class: &str, path: &str) {
        let _ = writeln!(self.body, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    fn node(&mut self, x: u32, y: u32, node: &Node) {
        let width = node.width();
        self.width = self.width.max(x + width);
        self.tops.push(y);
        let _ = write!(
            self.body,
            "<g><title>{}</title><rect class=\"{}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{BOX}\" rx=\"5\"/>",
            escaped(&node.whole),
            node.class
        );
        // A name alone is centred.
        let first = if node.lines.len() == 1 { y + 30 } else { y + 18 };
        for (line, baseline) in node.lines.iter().zip([first, y + 31, y + 43]) {
            let class = if baseline == first { " class=\"name\"" } else { "" };
            let text = escaped(&shortened(line));
            let _ = write!(
                self.body,
                "<text{class} x=\"{}\" y=\"{baseline}\">{text}</text>",
                x + 10
            );
        }
        self.body.push_str("</g>\n");
    }

    fn legend(&mut self) {
        self.y += HEADING;
        let mut x = MARGIN;
        let y = self.y - 4;
        for (class, words) in [
            ("edge", "constant"),
            ("edge moving", "moves"),
            ("edge disputed", "sources differ"),
            ("edge other", "another parent"),
        ] {
            let _ = writeln!(
                self.body,
                "<path class=\"{class}\" d=\"M{x} {y}h28\"/><text x=\"{}\" y=\"{}\">{words}</text>",
                x + 34,
                y + 3
            );
            x += 48 + 6 * u32::try_from(words.len()).unwrap_or(0);
        }
        self.width = self.width.max(x);
    }
}

/// Columns of a fixed-width font: letters of East Asian scripts and most symbols beyond them take two.
fn columns(text: &str) -> usize {
    text.chars().map(|c| if c < '\u{1100}' { 1 } else { 2 }).sum()
}

fn shortened(text: &str) -> String {
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    let mut short: String = text.chars().take(LONGEST - 1).collect();
    short.push('…');
    short
}

/// Text for XML: special characters are escaped, forbidden ones are replaced.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push('\n'),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}
