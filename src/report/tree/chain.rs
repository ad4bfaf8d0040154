//! The chain of transforms from one frame to another at a timestamp: every factor with its value, its source and its age, and
//! their product; or the exception of tf2.

use std::fmt::Write;

use crate::run::Run;
use crate::world::FrameId;
use crate::world::tf2::{Buffer, Lookup, LookupError};

use super::super::Style;
use super::super::place::Locator;
use super::super::style::Ink;
use super::super::text::{one_line, stamp};
use super::origin::{age, rivals, rooms, seconds, thinned, who};
use super::{Names, pose_words, shown, title};

/// Minimum similarity of a suggested name.
const NEAR: f64 = 0.5;
/// Maximum number of suggested names.
const SUGGESTED: usize = 5;

/// The chain `target_from_source` at a timestamp, or at the latest common one.
///
/// # Errors
///
/// The exception of tf2, with what is known of the frames; of several platforms or namespaces, that of the one that came
/// furthest.
pub fn render(run: &Run, target: &str, source: &str, at_ns: Option<i64>, style: Style) -> Result<String, String> {
    let locator = Locator::inside(&run.sources);
    let rooms = rooms(run);
    let mut out = String::new();
    let mut furthest: Option<(u8, String)> = None;
    for (world, namespace) in &rooms {
        let names = Names::new(world, &locator);
        let (buffer, origins) = world.tf2(namespace);
        match buffer.lookup(target, source, at_ns.unwrap_or(0)) {
            Ok(found) if known(&buffer, &found, target) => {
                if !out.is_empty() {
                    out.push('\n');
                }
                if rooms.len() > 1 {
                    let whose = format!("{}, TF of {namespace}", title(world, &names));
                    let _ = writeln!(out, "{}", style.paint(Ink::Strong, &one_line(&whose)));
                }
                let sources: Vec<String> = found
                    .factors
                    .iter()
                    .map(|factor| who(world, &origins, factor, &names))
                    .collect();
                product(&found, [target, source], &sources, style, &mut out);
                for factor in &found.factors {
                    if let Some((kept, of)) = thinned(world, &origins, factor) {
                        let (parent, child) = (shown(factor.parent.as_str()), shown(factor.child.as_str()));
                        let note = format!(
                            "of `{parent}` from `{child}`, {kept} transforms were kept of {of}, evenly spaced; values between \
                             them are interpolated"
                        );
                        let _ = writeln!(out, "{}", style.paint(Ink::Faint, &note));
                    }
                    let rivals = rivals(world, &origins, factor);
                    if rivals > 0 {
                        let note = format!(
                            "of `{}`, launch files publish {rivals} more with other values: the result depends on which files are started",
                            shown(factor.child.as_str())
                        );
                        let _ = writeln!(out, "{}", style.paint(Ink::Faint, &note));
                    }
                }
            }
            Ok(_) => {
                let unknown = LookupError::Unknown {
                    frame: target.to_owned(),
                    is_target: true,
                };
                furthest = furthest.max(Some((0, failure(&buffer, &unknown, at_ns))));
            }
            Err(error) => furthest = furthest.max(Some((rank(&error), failure(&buffer, &error, at_ns)))),
        }
    }
    match (out.is_empty(), furthest) {
        (false, _) => Ok(out),
        (true, Some((_, failure))) => Err(failure),
        (true, None) => Err("LookupException: the inputs contain no frames\n".to_owned()),
    }
}

/// tf2 returns identity for the same frame twice without checking that the frame exists; here it is checked.
fn known(buffer: &Buffer, found: &Lookup, target: &str) -> bool {
    !found.factors.is_empty() || buffer.knows(&FrameId::new(target))
}

/// The progress of a look-up before it failed.
fn rank(error: &LookupError) -> u8 {
    match error {
        LookupError::InvalidArgument { .. } => 1,
        LookupError::Unknown { is_target, .. } => u8::from(!*is_target) + 1,
        LookupError::Loop | LookupError::NotConnected { .. } => 3,
        LookupError::Extrapolation { .. } => 4,
    }
}

fn product(found: &Lookup, [target, source]: [&str; 2], sources: &[String], style: Style, out: &mut String) {
    let (target, source) = (shown(target), shown(source));
    let when = match found.stamp_ns {
        0 => "at any time".to_owned(),
        ns => format!("at {}", stamp(ns)),
    };
    let whole = format!("{target}_from_{source}");
    let factors: Vec<String> = found
        .factors
        .iter()
        .map(|factor| {
            let (a, b) = factor.frames();
            format!("{}_from_{}", shown(a.as_str()), shown(b.as_str()))
        })
        .collect();
    let spelled = if factors.is_empty() {
        "identity".to_owned()
    } else {
        factors.join(" * ")
    };
    let _ = writeln!(
        out,
        "{} {when}",
        style.paint(Ink::Strong, &format!("{whole} = {spelled}"))
    );
    let width = factors
        .iter()
        .chain([&whole])
        .map(|name| name.chars().count())
        .max()
        .unwrap_or(0);
    let values: Vec<String> = found.factors.iter().map(|factor| pose_words(&factor.value())).collect();
    let value_width = values.iter().map(String::len).max().unwrap_or(0);
    for (((factor, name), value), source) in found.factors.iter().zip(&factors).zip(&values).zip(sources) {
        let inverted = if factor.is_forward { "" } else { ", inverted" };
        let said = format!("{source}, {}{inverted}", age(factor.made_from, found.stamp_ns));
        let _ = writeln!(
            out,
            "  {name:width$}  {value:value_width$}  {}",
            style.paint(Ink::Faint, &said)
        );
    }
    let value = pose_words(&found.target_from_source);
    let _ = writeln!(
        out,
        "  {}  {value}",
        style.paint(Ink::Strong, &format!("{whole:width$}"))
    );
}

/// The exception, its message, and what is known.
fn failure(buffer: &Buffer, error: &LookupError, at_ns: Option<i64>) -> String {
    let mut text = format!("{}: {}\n", error.exception(), one_line(&error.to_string()));
    match error {
        LookupError::InvalidArgument { frame, .. } | LookupError::Unknown { frame, .. } => {
            let near = near(buffer, frame);
            if near.is_empty() {
                let count = buffer.frames().count();
                let _ = writeln!(text, "{count} frames are known; none has a similar name");
            } else {
                let _ = writeln!(text, "known frames with similar names: {}", near.join(", "));
            }
        }
        LookupError::NotConnected { target, source } => {
            for frame in [target, source] {
                let top = top(buffer, frame, at_ns.unwrap_or(0));
                let _ = writeln!(
                    text,
                    "`{}` is in the tree of `{}`",
                    shown(frame.as_str()),
                    shown(top.as_str())
                );
            }
        }
        LookupError::Extrapolation { child, .. } => {
            if let Some((first, last)) = buffer.span_ns(child) {
                let parents: Vec<String> = buffer
                    .parents_ever(child)
                    .iter()
                    .map(|parent| format!("`{}`", shown(parent.as_str())))
                    .collect();
                let _ = writeln!(
                    text,
                    "{} from `{}` is known from {} for {} s",
                    parents.join(" or "),
                    shown(child.as_str()),
                    stamp(first),
                    seconds(last.saturating_sub(first))
                );
            }
        }
        LookupError::Loop => {}
    }
    text
}

/// Known frames with similar names, the most similar first.
fn near(buffer: &Buffer, frame: &str) -> Vec<String> {
    let wanted = frame.trim_matches('/').to_lowercase();
    let mut near: Vec<(f64, &FrameId)> = buffer
        .frames()
        .map(|known| {
            (
                strsim::normalized_damerau_levenshtein(&wanted, &known.as_str().to_lowercase()),
                known,
            )
        })
        .filter(|(likeness, _)| *likeness >= NEAR)
        .collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(b.1)));
    near.iter()
        .take(SUGGESTED)
        .map(|(_, known)| format!("`{}`", shown(known.as_str())))
        .collect()
}

/// The root of the tree of a frame at a timestamp.
fn top(buffer: &Buffer, frame: &FrameId, stamp_ns: i64) -> FrameId {
    let parents: std::collections::BTreeMap<&FrameId, FrameId> = buffer
        .edges_at(stamp_ns)
        .into_iter()
        .filter_map(|(child, edge)| Some((child, edge.ok()?.parent)))
        .collect();
    let mut at = frame;
    // A cycle has no root: after as many steps as there are edges, any frame of it is returned.
    for _ in 0..parents.len() {
        match parents.get(at) {
            Some(parent) => at = parent,
            None => break,
        }
    }
    at.clone()
}
