//! Lines of a source with the place of a finding marked, if the text is available.

use maud::{Markup, html};

use crate::source::{LineColumn, Place};

use super::super::place::Locator;
use super::words::plain;

/// Lines before and after the marked one.
const AROUND: usize = 1;
/// Maximum number of characters of a line; of a longer one (a whole JSON file on one line), those around the mark.
const LONGEST: usize = 200;
/// Characters before the mark in a longer line.
const BEFORE: usize = 40;
/// Maximum number of marked characters.
const LONGEST_MARK: usize = 120;

/// A line of a text, in three parts.
struct Line<'t> {
    number: usize,
    before: String,
    marked: &'t str,
    after: String,
}

/// The lines around a place; `None` if it is not in a text.
pub(super) fn render(place: &Place, locator: &Locator) -> Option<Markup> {
    let span = place.span()?;
    let text = locator.source(place.source)?.text.as_str();
    if text.trim().is_empty() {
        return None;
    }
    let lines = locator.lines(place.source)?;
    let LineColumn { line, .. } = lines.locate(text, span.start.min(text.len()));
    let index = line.checked_sub(1)?;
    let one = |index: usize| {
        let from = lines.line_start(index)?;
        let to = lines.line_start(index + 1).unwrap_or(text.len());
        Some((from, text.get(from..to)?.trim_end_matches(['\n', '\r'])))
    };
    let shown = index.saturating_sub(AROUND)..=index + AROUND;
    let shown: Vec<Line> = shown
        .filter_map(|at| {
            let (from, whole) = one(at)?;
            let (start, end) = if at == index {
                let start = floor(whole, span.start.saturating_sub(from));
                let end = floor(whole, span.end.saturating_sub(from).max(start));
                (start, end)
            } else {
                (0, 0)
            };
            Some(cut(at + 1, whole, start, end))
        })
        .filter(|line| line.number == index + 1 || !(line.before.is_empty() && line.after.is_empty()))
        .collect();
    Some(html! {
        pre class="snippet" tabindex="0" {
            @for line in &shown {
                span class={ "line" @if line.number == index + 1 { " here" } } {
                    span class="number" { (line.number) }
                    code {
                        (plain(&line.before))
                        @if !line.marked.is_empty() { mark { (plain(line.marked)) } }
                        (plain(&line.after))
                    }
                }
                "\n"
            }
        }
    })
}

/// A line with the bytes from `start` to `end` marked, cut if it is too long.
fn cut(number: usize, whole: &str, start: usize, end: usize) -> Line<'_> {
    let before = whole.get(..start).unwrap_or_default();
    let marked = whole.get(start..end).unwrap_or_default();
    let marked_end = marked
        .char_indices()
        .nth(LONGEST_MARK)
        .map_or(marked.len(), |(at, _)| at);
    let marked = marked.get(..marked_end).unwrap_or_default();
    let after = whole.get(start + marked_end..).unwrap_or_default();
    let kept = if whole.len() > LONGEST { BEFORE } else { LONGEST };
    let skipped = before.char_indices().rev().nth(kept).map(|(at, _)| at);
    let before = match skipped.and_then(|at| before.get(at..)) {
        Some(rest) => format!("… {rest}"),
        None => before.to_owned(),
    };
    let after = match after.char_indices().nth(LONGEST).and_then(|(at, _)| after.get(..at)) {
        Some(first) => format!("{first} …"),
        None => after.to_owned(),
    };
    Line {
        number,
        before,
        marked,
        after,
    }
}

/// The last character boundary up to an offset.
fn floor(text: &str, offset: usize) -> usize {
    let mut at = offset.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples::{ROBOT, Sample};
    use crate::source::SourceKind;

    #[test]
    fn the_place_is_marked_between_its_neighbours() {
        let mut s = Sample::default();
        let robot = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
        let place = s.at(robot, "0 0 1.57");
        let run = s.run();
        let drawn = render(&place, &Locator::new(&run.sources)).map(Markup::into_string);
        let drawn = drawn.unwrap_or_default();
        assert!(
            drawn.contains("&lt;origin rpy=&quot;<mark>0 0 1.57</mark>&quot;/&gt;"),
            "{drawn}"
        );
        assert_eq!(drawn.matches("class=\"number\"").count(), 3);
        assert!(drawn.contains("<span class=\"number\">4</span>"));
    }

    #[test]
    fn odd_places_and_endless_lines_are_no_fault() {
        let mut s = Sample::default();
        let text = format!("é{}", "x".repeat(300_000));
        let id = s.source("a.json", SourceKind::Json, &text);
        let run = s.run();
        let locator = Locator::new(&run.sources);
        for (start, end) in [
            (0, 0),
            (1, 2),
            (1, 300_001),
            (150_000, 150_004),
            (999_999, 1_999_999),
            (7, 3),
        ] {
            let drawn = render(&Place::text(id, start..end), &locator).map(Markup::into_string);
            assert!(drawn.is_some_and(|drawn| drawn.len() < 2000), "{start}..{end}");
        }
    }
}
