//! What a user accepts, and its effect: pure data.

use serde::{Deserialize, Serialize};

use crate::source::Place;

use super::Finding;

/// A date as it is written and compared: `2027-01-31`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Day(String);

impl Day {
    /// A date of the calendar, `YYYY-MM-DD`. `None` if there is no such date.
    pub fn parse(text: &str) -> Option<Self> {
        let at_midnight = humantime::parse_rfc3339(&format!("{text}T00:00:00Z")).ok()?;
        let day = Self::of(at_midnight);
        (day.0 == text).then_some(day)
    }

    /// The date of a time, in UTC.
    pub fn of(moment: std::time::SystemTime) -> Self {
        let text = humantime::format_rfc3339_seconds(moment).to_string();
        Self(text.split('T').next().unwrap_or_default().to_owned())
    }

    /// As it is written.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Days from `earlier` to this one; 0 if it is not later.
    pub fn days_since(&self, earlier: &Self) -> u64 {
        let moment = |day: &Self| humantime::parse_rfc3339(&format!("{}T00:00:00Z", day.0)).ok();
        let passed = moment(self).zip(moment(earlier));
        let passed = passed.and_then(|(later, earlier)| later.duration_since(earlier).ok());
        passed.map_or(0, |passed| passed.as_secs() / 86_400)
    }
}

/// The family of the rules about acceptances: they do not check a robot, and cannot be accepted themselves.
pub const FAMILY: &str = "GATE";

/// Where an acceptance is declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WaiverKind {
    /// Under `waivers:` of the configuration.
    Configuration,
    /// In a comment beside what it accepts.
    Comment,
    /// In a baseline.
    Baseline,
}

impl WaiverKind {
    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Configuration => "waiver",
            Self::Comment => "comment",
            Self::Baseline => "baseline entry",
        }
    }
}

/// An acceptance of findings, as the user declares it.
#[derive(Clone, Debug, PartialEq)]
pub struct Waiver {
    /// Its place.
    pub kind: WaiverKind,
    /// Code, name or family of the rules.
    pub rule: String,
    /// Its scope in words, after the rule; empty if it is for every finding of the rule.
    pub about: String,
    /// Why the findings are accepted.
    pub reason: String,
    /// Who accepts them.
    pub by: Option<String>,
    /// The last day on which it holds.
    pub until: Option<Day>,
    /// Its place, in words: `frames-lint.yaml:12`.
    pub origin: String,
    /// Its place.
    pub place: Place,
}

impl Waiver {
    /// The note in a finding that it accepts.
    pub fn waived(&self) -> Acceptance {
        Acceptance {
            reason: self.reason.clone(),
            by: self.by.clone(),
            until: self.until.clone(),
            origin: self.origin.clone(),
        }
    }
}

/// The effect of an acceptance in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct WaiverEffect {
    /// The acceptance.
    pub waiver: Waiver,
    /// Findings that it is for.
    pub matched: usize,
    /// Days since it ran out; `None` while it holds.
    pub expired_days: Option<u64>,
    /// Why it is unknown whether it is still needed: its subject was not evaluated.
    pub unjudged: Option<String>,
}

/// A comment to frames-lint that cannot be understood.
#[derive(Clone, Debug, PartialEq)]
pub struct CommentFault {
    /// The comment.
    pub text: String,
    /// What is wrong with it.
    pub fault: String,
    /// What to do.
    pub help: &'static str,
    /// Its place.
    pub place: Place,
}

/// The acceptance of a finding.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Acceptance {
    /// Why.
    pub reason: String,
    /// By whom.
    pub by: Option<String>,
    /// The last day on which it is.
    pub until: Option<Day>,
    /// The place of the acceptance, in words.
    pub origin: String,
}

impl Acceptance {
    /// In one line: `remounted, by J. Doe, until 2027-01-31 (frames-lint.yaml:12)`.
    pub fn words(&self) -> String {
        let by = self.by.as_ref().map_or_else(String::new, |by| format!(", by {by}"));
        let until = self
            .until
            .as_ref()
            .map_or_else(String::new, |day| format!(", until {}", day.as_str()));
        format!("{}{by}{until} ({})", self.reason, self.origin)
    }
}

/// Identifies a finding when lines move: the rule, the subject, the file and the relation.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Identity {
    /// Code of the rule.
    pub rule: String,
    /// What was judged, without the name of the platform.
    pub subject: String,
    /// The file of the primary place.
    pub path: String,
    /// The relation that explains the difference, or nothing.
    pub relation: String,
}

impl Identity {
    /// Of a finding; `platforms` are the names with which subjects begin if a run has several, and `paths` give for each place of it the
    /// path of its file in this run and the path that identifies it.
    pub fn of(finding: &Finding, platforms: &[String], paths: impl Fn(&Place) -> Option<(String, String)>) -> Self {
        let mut subject = without_bytes(plain_subject(&finding.subject, platforms));
        let mut primary = None;
        for label in &finding.places {
            let Some((shown, known)) = paths(&label.place) else {
                continue;
            };
            if !shown.is_empty() && shown != known {
                subject = subject.replace(&shown, &known);
            }
            primary.get_or_insert(known);
        }
        Self {
            rule: finding.rule.clone(),
            subject,
            path: primary.unwrap_or_default(),
            relation: finding.relation.clone().unwrap_or_default(),
        }
    }
}

/// A subject without its byte offset (` at byte 120`), which moves with the lines.
fn without_bytes(subject: &str) -> String {
    const MARK: &str = " at byte ";
    let Some((before, rest)) = subject.split_once(MARK) else {
        return subject.to_owned();
    };
    let rest = rest.trim_start_matches(|c: char| c.is_ascii_digit());
    format!("{before}{}", without_bytes(rest))
}

/// A subject without the name of the platform with which it begins if a run has several.
pub fn plain_subject<'a>(subject: &'a str, platforms: &[String]) -> &'a str {
    let behind = |platform: &String| subject.strip_prefix(platform.as_str())?.strip_prefix(": ");
    platforms.iter().find_map(behind).unwrap_or(subject)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_is_a_day_of_the_calendar() {
        assert!(Day::parse("2028-02-29").is_some());
        for text in [
            "2027-02-29",
            "2027-13-01",
            "27-01-01",
            "2027-1-1",
            "tomorrow",
            "2027-01-01T00:00:00Z",
            "",
        ] {
            assert_eq!(Day::parse(text), None, "{text}");
        }
    }

    #[test]
    fn days_are_counted_over_months_and_leap_years() {
        let day = |text| Day::parse(text).unwrap();
        assert_eq!(day("2028-03-01").days_since(&day("2028-02-28")), 2);
        assert_eq!(day("2027-03-01").days_since(&day("2027-02-28")), 1);
        assert_eq!(day("2027-01-01").days_since(&day("2027-01-02")), 0);
    }

    #[test]
    fn a_subject_is_known_without_the_bytes_at_which_it_stands() {
        assert_eq!(without_bytes("`rpy` at byte 120 of a.urdf"), "`rpy` of a.urdf");
        assert_eq!(without_bytes("`rpy` of a.urdf"), "`rpy` of a.urdf");
    }

    #[test]
    fn a_subject_is_known_without_its_platform() {
        let platforms = ["car.urdf".to_owned(), "truck.urdf".to_owned()];
        assert_eq!(plain_subject("truck.urdf: lidar", &platforms), "lidar");
        assert_eq!(plain_subject("lidar: 3", &platforms), "lidar: 3");
    }
}
