//! Comments at what they accept: `frames-lint: allow RULE reason`, in URDF, YAML, launch files and source code.
//!
//! On a line of its own a comment applies to the element or entry that follows, at the end of a line to the one that begins there;
//! `allow-file` applies to the whole file. The rules may be followed by `until YYYY-MM-DD`.

use crate::page::names_rule;
use crate::source::{Derivation, LineIndex, Place, Source, SourceKind, Span};
use crate::verdict::waiver::{CommentFault, Day, Waiver, WaiverKind};

use super::{Context, Exception, Scope};

/// How such a comment starts.
const MARK: &str = "frames-lint:";

/// What to write instead of a comment that cannot be read.
const FORM: &str = "write `frames-lint: allow RULE reason`, or `frames-lint: allow RULE until 2027-01-31 reason`";

/// What begins a comment, in the languages that are read.
const OPENERS: [&str; 6] = ["#", "//", "<!--", "/*", "--", ";"];

/// Every comment to frames-lint in the sources: what it accepts, or what is wrong with it.
pub(super) fn all(context: &Context) -> (Vec<Exception>, Vec<CommentFault>) {
    let mut exceptions = Vec::new();
    let mut misspelt = Vec::new();
    for source in context.sources {
        // What is in an expansion is read where it is written.
        let is_elsewhere = !source.written.is_empty();
        if is_elsewhere || source.kind == SourceKind::Configuration || !source.text.contains(MARK) {
            continue;
        }
        let lines = LineIndex::new(&source.text);
        let mut regions = Regions::of(&source.text);
        let mut from = 0;
        while let Some(at) = source.text.get(from..).and_then(|rest| rest.find(MARK)) {
            let at = from + at;
            from = at + MARK.len();
            let Some(comment) = Comment::around(&source.text, at) else {
                continue;
            };
            let place = Place::text(source.id, comment.span);
            let line = lines.locate(&source.text, at).line;
            match comment.read(&mut regions, context) {
                Ok(found) => exceptions.extend(found.into_iter().map(|(rule, allowed)| Exception {
                    waiver: Waiver {
                        kind: WaiverKind::Comment,
                        rule,
                        about: if allowed.is_file {
                            "in this file".to_owned()
                        } else {
                            "here".to_owned()
                        },
                        reason: allowed.reason.clone(),
                        by: None,
                        until: allowed.until.clone(),
                        origin: format!("{}:{line}", name(source)),
                        place: place.clone(),
                    },
                    scope: Scope::Region(source.id, allowed.region),
                })),
                Err((fault, help)) => misspelt.push(CommentFault {
                    text: comment.text.trim().to_owned(),
                    fault,
                    help,
                    place,
                }),
            }
        }
    }
    (exceptions, misspelt)
}

/// The path, and the message that a text came out of.
fn name(source: &Source) -> String {
    match &source.derived {
        Some(Derivation::Message(message)) => format!("{} {}[{}]", source.path, message.topic, message.index),
        _ => source.path.clone(),
    }
}

/// Longest comment in brackets, bytes.
const LONGEST: usize = 1 << 16;

/// A comment to frames-lint.
struct Comment<'t> {
    /// The text after the mark.
    text: &'t str,
    /// The mark and the text after it.
    span: Span,
    /// Where the comment starts.
    start: usize,
    /// Where the line continues after it.
    end: usize,
    /// Whether something else is before it on its line.
    is_trailing: bool,
}

/// What a comment accepts.
#[derive(Clone)]
struct CommentWaiver {
    reason: String,
    until: Option<Day>,
    region: Span,
    is_file: bool,
}

impl<'t> Comment<'t> {
    /// The comment that the mark at `at` starts; `None` if it is in no comment.
    fn around(text: &'t str, at: usize) -> Option<Self> {
        let line_start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
        let before = text.get(line_start..at)?;
        let bare = before.trim_end();
        let opener = OPENERS.iter().find(|opener| bare.ends_with(**opener))?;
        let start = line_start + bare.len() - opener.len();
        let line_end = text.get(at..)?.find('\n').map_or(text.len(), |end| at + end);
        let closer = match *opener {
            "<!--" => Some("-->"),
            "/*" => Some("*/"),
            _ => None,
        };
        let body_from = at + MARK.len();
        // A comment in brackets may continue over lines; the words to frames-lint end with their line.
        let closed = closer.and_then(|closer| {
            let near = text.as_bytes().get(body_from..)?;
            let near = near.get(..LONGEST).unwrap_or(near);
            let end = memchr::memmem::find(near, closer.as_bytes())?;
            Some((body_from + end, body_from + end + closer.len()))
        });
        let (body_to, end) = closed.unwrap_or((line_end, line_end));
        let body_to = body_to.min(line_end);
        let body = text.get(body_from..body_to)?;
        Some(Self {
            text: body,
            span: Span::new(at, body_from + body.trim_end().len()),
            start,
            end,
            is_trailing: !text.get(line_start..start)?.trim().is_empty(),
        })
    }

    /// The rules that it allows and where, or what is wrong with it and what to do.
    fn read(
        &self,
        regions: &mut Regions,
        context: &Context,
    ) -> Result<Vec<(String, CommentWaiver)>, (String, &'static str)> {
        if !context.comments {
            let fault = "the configuration does not accept comments".to_owned();
            return Err((
                fault,
                "set `comments: accept` in the configuration, or delete the comment",
            ));
        }
        let mut words = self.text.split_whitespace();
        let is_file = match words.next() {
            Some("allow") => false,
            Some("allow-file") => true,
            Some(other) => return Err((format!("`{other}` is neither `allow` nor `allow-file`"), FORM)),
            None => return Err(("nothing follows the colon".to_owned(), FORM)),
        };
        let mut rules = Vec::new();
        let mut rest: Vec<&str> = words.collect();
        // `A, B reason` and `A,B reason`: a list continues as long as there are commas.
        while !rest.is_empty() {
            let word = rest.remove(0);
            rules.extend(word.split(',').filter(|rule| !rule.is_empty()).map(str::to_owned));
            if !word.ends_with(',') && rest.first().is_none_or(|next| !next.starts_with(',')) {
                break;
            }
        }
        if rules.is_empty() {
            return Err(("no rule is named".to_owned(), FORM));
        }
        for rule in &rules {
            if !context
                .rules
                .iter()
                .any(|known| names_rule(rule, known.code, known.name))
            {
                let help = "correct the code of the rule (`frames-lint rules` lists all rules), or delete the comment";
                return Err((format!("rule `{rule}` does not exist"), help));
            }
        }
        let until = match rest.as_slice() {
            ["until", day, ..] => {
                let day = day.trim_end_matches([',', ':', ';']);
                let parsed = Day::parse(day);
                rest.drain(..2);
                let help = "write a day of the calendar after `until`: `until 2027-01-31`";
                Some(parsed.ok_or_else(|| (format!("`{day}` is not a day such as `2027-01-31`"), help))?)
            }
            _ => None,
        };
        let reason = rest.join(" ");
        let reason = reason.trim_start_matches(['-', ':', '—', '–', ' ']).to_owned();
        if reason.is_empty() {
            let help = "write the reason after the rule: `frames-lint: allow RULE reason`";
            return Err(("the reason after the rule is missing".to_owned(), help));
        }
        let region = if is_file {
            Span::new(0, usize::MAX)
        } else {
            regions.of_comment(self)
        };
        let allowed = CommentWaiver {
            reason,
            until,
            region,
            is_file,
        };
        Ok(rules.into_iter().map(|rule| (rule, allowed.clone())).collect())
    }
}

/// The regions of a text's comments. Each text is parsed once, however many comments it has.
struct Regions<'t> {
    text: &'t str,
    /// The elements of an XML document, in their order.
    elements: Vec<Span>,
    /// The last group of consecutive comments on their own lines, and the block after them.
    block: Option<(Span, Span)>,
}

impl<'t> Regions<'t> {
    fn of(text: &'t str) -> Self {
        let is_xml = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
        let options = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..roxmltree::ParsingOptions::default()
        };
        let document = is_xml.then(|| roxmltree::Document::parse_with_options(text, options).ok());
        let elements = document.flatten().map_or_else(Vec::new, |document| {
            let elements = document.descendants().filter(roxmltree::Node::is_element);
            elements.map(|node| Span::from(node.range())).collect()
        });
        Self {
            text,
            elements,
            block: None,
        }
    }

    /// The element or entry that begins on the comment's line, or after it.
    fn of_comment(&mut self, comment: &Comment) -> Span {
        if let Some(element) = self.element(comment) {
            return element;
        }
        if let Some((comments, block)) = self.block
            && !comment.is_trailing
            && comments.start <= comment.start
            && comment.end < comments.end
        {
            return block;
        }
        let block = block(self.text, comment);
        if !comment.is_trailing {
            self.block = Some((Span::new(comment.start, block.start), block));
        }
        block
    }

    /// The first element that begins on the comment's line, or after a comment on its own line.
    fn element(&self, comment: &Comment) -> Option<Span> {
        let from = if comment.is_trailing {
            self.text.get(..comment.start)?.rfind('\n').map_or(0, |end| end + 1)
        } else {
            comment.end
        };
        let next = self.elements.partition_point(|element| element.start < from);
        let element = self.elements.get(next)?;
        (!comment.is_trailing || element.start < comment.start).then_some(*element)
    }
}

/// The line, and the lines after it that are indented deeper or continue its list.
fn block(text: &str, comment: &Comment) -> Span {
    let line_start = text
        .get(..comment.start)
        .map_or(0, |before| before.rfind('\n').map_or(0, |end| end + 1));
    let mut from = if comment.is_trailing { line_start } else { comment.end };
    let rest = text.get(from..).unwrap_or_default();
    // Skip empty lines and other comments.
    for line in rest.split_inclusive('\n') {
        let bare = line.trim();
        let is_comment = OPENERS.iter().any(|opener| bare.starts_with(opener)) && !bare.starts_with("- ");
        if !comment.is_trailing && (bare.is_empty() || is_comment) {
            from += line.len();
        } else {
            break;
        }
    }
    let indent = |line: &str| line.len() - line.trim_start().len();
    let mut lines = text.get(from..).unwrap_or_default().split_inclusive('\n');
    let Some(first) = lines.next() else {
        return Span::new(from, from);
    };
    let (depth, is_item, mut end) = (indent(first), first.trim_start().starts_with("- "), from + first.len());
    for line in lines {
        let bare = line.trim();
        let goes_on = bare.is_empty()
            || indent(line) > depth
            || (indent(line) == depth && !is_item && bare.starts_with("- "))
            || (indent(line) == depth && matches!(bare.chars().next(), Some(']' | '}' | ')')));
        if !goes_on {
            break;
        }
        end += line.len();
    }
    Span::new(from, end)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text that the only comment of a file is for.
    fn region(text: &str) -> &str {
        let at = text.find(MARK).unwrap();
        let comment = Comment::around(text, at).unwrap();
        let span = Regions::of(text).of_comment(&comment);
        text[span.start..span.end].trim()
    }

    #[test]
    fn a_comment_alone_is_for_the_element_after_it() {
        assert_eq!(
            region(
                "<robot>\n  <!-- frames-lint: allow X y -->\n  <joint a=\"1\">\n    <origin/>\n  </joint>\n  <link/>\n</robot>"
            ),
            "<joint a=\"1\">\n    <origin/>\n  </joint>"
        );
    }

    #[test]
    fn a_comment_after_an_element_is_for_the_one_that_begins_on_its_line() {
        assert_eq!(
            region("<robot>\n  <joint><origin/> <!-- frames-lint: allow X y -->\n  </joint>\n  <link/>\n</robot>"),
            "<joint><origin/> <!-- frames-lint: allow X y -->\n  </joint>"
        );
    }

    #[test]
    fn in_broken_xml_lines_decide() {
        assert_eq!(
            region("<robot>\n  <!-- frames-lint: allow X y -->\n  <joint>\n    <origin/>\n  <joint>\n</robot>"),
            "<joint>\n    <origin/>"
        );
    }

    #[test]
    fn in_yaml_the_entry_with_all_that_is_deeper() {
        assert_eq!(
            region("a: 1\n# frames-lint: allow X y\n\n# more\nlidar:\n  x: 1\n\n  y: 2\nb: 3\n"),
            "lidar:\n  x: 1\n\n  y: 2"
        );
        assert_eq!(
            region("a: 1\nT: # frames-lint: allow X y\n- [1, 0]\n- [0, 1]\nb: 3\n"),
            "T: # frames-lint: allow X y\n- [1, 0]\n- [0, 1]"
        );
        assert_eq!(
            region("- a: 1 # frames-lint: allow X y\n- b: 2\n"),
            "- a: 1 # frames-lint: allow X y"
        );
    }

    #[test]
    fn the_mark_in_plain_text_is_no_comment() {
        let text = "name: 'frames-lint: allow X'\n";
        assert!(Comment::around(text, text.find(MARK).unwrap()).is_none());
    }
}
