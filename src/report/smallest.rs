//! The smallest errors that would have been found: as rows of JSON, and in lines and tables for people.

use std::fmt::Write;

use serde::Serialize;

use crate::assure::{FoundSize, Miss, SmallestError};

use super::style::{Ink, Style};
use super::text::{list, number, one_line, wrap};

/// Significant digits of a size.
const DIGITS: usize = 2;

/// Sizes of both signs that differ by less than this factor are the same.
const OTHER: f64 = 1.2;

/// The title of their section.
pub(super) const TITLE: &str = "The smallest errors that would have been found, with a probability of 80 %";

/// The errors of one subject: those that would have been found, and those that would not, by the reason.
pub(super) struct OfSubject<'a> {
    pub(super) subject: String,
    pub(super) found: Vec<(&'a SmallestError, &'a FoundSize)>,
    pub(super) unseen: Vec<Unseen<'a>>,
}

/// Errors that would not have been found at any size, for one reason.
pub(super) struct Unseen<'a> {
    pub(super) names: Vec<String>,
    /// The largest size that was tried, and its unit.
    pub(super) largest: f64,
    pub(super) unit: &'static str,
    pub(super) miss: &'a Miss,
}

impl<'a> OfSubject<'a> {
    /// In the order of the first error of each subject.
    pub(super) fn of(smallest: &'a [SmallestError]) -> Vec<Self> {
        let first = smallest.first().map(|error| &error.platform);
        let are_several = smallest.iter().any(|error| Some(&error.platform) != first);
        let mut all: Vec<Self> = Vec::new();
        for error in smallest {
            let subject = if are_several {
                format!("{}: {}", error.platform, error.subject)
            } else {
                error.subject.clone()
            };
            if all.iter().all(|known| known.subject != subject) {
                all.push(Self {
                    subject: subject.clone(),
                    found: Vec::new(),
                    unseen: Vec::new(),
                });
            }
            if let Some(of_subject) = all.iter_mut().find(|known| known.subject == subject) {
                of_subject.add(error);
            }
        }
        all
    }

    fn add(&mut self, error: &'a SmallestError) {
        let miss = match &error.found {
            Ok(found) => return self.found.push((error, found)),
            Err(miss) => miss,
        };
        let name = error.fault.name.to_owned();
        let [_, largest] = error.fault.range;
        let mut known = self.unseen.iter_mut();
        match known.find(|unseen| unseen.miss == miss && unseen.unit == error.fault.unit) {
            Some(unseen) => unseen.names.push(name),
            None => self.unseen.push(Unseen {
                names: vec![name],
                largest,
                unit: error.fault.unit,
                miss,
            }),
        }
    }
}

/// The size with its unit.
pub(super) fn size(error: &SmallestError, found: &FoundSize) -> String {
    format!("{} {}", number(found.size, DIGITS), error.fault.unit)
}

/// The size of the other sign, where it differs.
pub(super) fn other_sign(error: &SmallestError, found: &FoundSize) -> String {
    let [positive, negative] = found.by_sign;
    if positive.min(negative) * OTHER > positive.max(negative) {
        return String::new();
    }
    let [by_positive, by_negative] = &found.rules_by_sign;
    let (sign, size, rule) = if positive < negative {
        ('+', positive, by_positive)
    } else {
        ('-', negative, by_negative)
    };
    let by = if *rule == found.rule {
        String::new()
    } else {
        format!(", by {rule}")
    };
    format!("{sign}{} {} is enough{by}", number(size, DIGITS), error.fault.unit)
}

/// Where a size lies, with a probability of 90 %.
pub(super) fn range(found: &FoundSize) -> String {
    match found.range {
        Some([low, high]) if number(low, DIGITS) == number(high, DIGITS) => String::new(),
        Some([low, high]) => format!("{} to {}", number(low, DIGITS), number(high, DIGITS)),
        None => "how much it varies is unknown: without a sixth of these data the rule judges nothing".to_owned(),
    }
}

/// What a size means for a point at 50 m.
pub(super) fn at_50_m(found: &FoundSize) -> String {
    let metres = found.at_50_m.map(|metres| format!("{} m", number(metres, DIGITS)));
    metres.unwrap_or_default()
}

/// A section of a text.
pub(super) fn section(smallest: &[SmallestError], style: Style, out: &mut String) {
    if smallest.is_empty() {
        return;
    }
    let _ = writeln!(out, "{}", style.paint(Ink::Strong, TITLE));
    for of_subject in OfSubject::of(smallest) {
        let subject = one_line(&of_subject.subject);
        let _ = writeln!(out, "{}", wrap(&subject, style.width, "  ", "    "));
        let mut line = |text: &str| {
            let _ = writeln!(out, "{}", wrap(&one_line(text), style.width, "    ", "      "));
        };
        for (error, found) in &of_subject.found {
            let mut text = format!("{} {} by {}", error.fault.name, size(error, found), found.rule);
            let range = range(found);
            if !range.is_empty() {
                let _ = write!(text, " ({range})");
            }
            let other = other_sign(error, found);
            if !other.is_empty() {
                let _ = write!(text, " ({other})");
            }
            let at_50_m = at_50_m(found);
            if !at_50_m.is_empty() && error.fault.unit != "m" {
                let _ = write!(text, ": {at_50_m} for a point at 50 m");
            }
            line(&text);
        }
        for unseen in &of_subject.unseen {
            line(&format!(
                "{}: no size up to {} {} is sure to be found",
                list(&unseen.names),
                unseen.largest,
                unseen.unit
            ));
            line(&format!("  why: {}", unseen.miss.reason));
            line(&format!("  record or add: {}", unseen.miss.record));
        }
    }
    out.push('\n');
}

/// A row of JSON.
#[derive(Serialize)]
pub(super) struct SmallestRow<'a> {
    quantity: &'a str,
    unit: &'a str,
    platform: &'a str,
    subject: &'a str,
    rule: Option<&'a str>,
    smallest: Option<f64>,
    smallest_positive: Option<f64>,
    smallest_negative: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    by_limit: Option<f64>,
    at_50_m: Option<f64>,
    hidden_direction: Option<[f64; 3]>,
    reason: Option<&'a str>,
    record: Option<&'a str>,
}

impl<'a> SmallestRow<'a> {
    pub(super) fn of(error: &'a SmallestError) -> Self {
        let found = error.found.as_ref().ok();
        let range = found.and_then(|found| found.range);
        Self {
            quantity: error.fault.name,
            unit: error.fault.unit,
            platform: &error.platform,
            subject: &error.subject,
            rule: found.map(|found| found.rule.as_str()),
            smallest: found.map(|found| found.size),
            smallest_positive: found.map(|found| found.by_sign[0]),
            smallest_negative: found.map(|found| found.by_sign[1]),
            low: range.map(|[low, _]| low),
            high: range.map(|[_, high]| high),
            by_limit: found.and_then(|found| found.by_limit),
            at_50_m: found.and_then(|found| found.at_50_m),
            hidden_direction: error.hidden,
            reason: error.found.as_ref().err().map(|miss| miss.reason.as_str()),
            record: error.found.as_ref().err().map(|miss| miss.record.as_str()),
        }
    }
}
