//! The catalogue of known mistakes: what each is called, what can have it, how it changes a world, and what names it in a finding.
//!
//! A mistake is put into a world in memory, and changes it as the same mistake in the files or messages would change what is read of
//! them. Mistakes are data with pure functions; nothing is judged here, and nothing is read.

/// A mistake: its family, name, sentence and change; the relations and texts that name it; the rules that should see it; what to record.
macro_rules! fault {
    ($family:ident, $name:literal, $sentence:expr, $change:expr, $relations:expr, $texts:expr, $seen_by:expr, $record:expr $(,)?) => {
        $crate::faults::Fault {
            family: $crate::faults::Family::$family,
            name: $name,
            sentence: $sentence,
            change: &$change,
            relations: &$relations,
            texts: &$texts,
            seen_by: $crate::faults::Seers(&$seen_by),
            record: $record,
        }
    };
}

mod cameras;
mod clouds;
mod delays;
mod literals;
pub mod motion;
mod mountings;
mod restate;
mod sides;
mod sized;
mod statements;
mod subject;
mod tree;

use crate::source::Confidence;
use crate::verdict::{Finding, Row};
use crate::world::World;

pub use sized::{SIZED_FAULTS, SIZES, SizedFault};
pub use subject::{Subject, SubjectPlace};

/// What kind of thing a mistake is made in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// A transform that a file, a joint or a static transform states.
    Statement,
    /// How a sensor is mounted, by its static transform.
    Mounting,
    /// A point cloud.
    Cloud,
    /// An inertial sensor.
    Imu,
    /// Poses and velocities: odometry, localization, TF.
    Pose,
    /// A satellite receiver.
    Fix,
    /// Stamps of messages.
    Time,
    /// A camera or its optical frame.
    Camera,
    /// Names of frames and the tree that they form.
    Tree,
}

impl Family {
    /// The word used in reports and for `--select`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Statement => "statement",
            Self::Mounting => "mounting",
            Self::Cloud => "cloud",
            Self::Imu => "imu",
            Self::Pose => "pose",
            Self::Fix => "fix",
            Self::Time => "time",
            Self::Camera => "camera",
            Self::Tree => "tree",
        }
    }
}

/// A known mistake.
pub struct Fault {
    /// What it is made in.
    pub family: Family,
    /// Its name: words with hyphens, unique.
    pub name: &'static str,
    /// One plain sentence: what is wrong.
    pub sentence: &'static str,
    /// What can have it, and how it changes that.
    pub change: &'static dyn Change,
    /// Relations of findings that name it.
    pub relations: &'static [&'static str],
    /// Texts of findings that name it, where they have no relation.
    pub texts: &'static [&'static str],
    /// The rules that should see it.
    pub seen_by: Seers,
    /// What to record or to add where it is missed.
    pub record: &'static str,
}

impl std::fmt::Debug for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// The rules that should see a mistake: each by its code, or by its code and the start of a row's subject (`AXES08 velocity`).
#[derive(Clone, Copy, Debug)]
pub struct Seers(pub &'static [&'static str]);

impl Seers {
    /// The codes.
    pub fn codes(self) -> impl Iterator<Item = &'static str> {
        let codes = self.0.iter();
        codes.map(|seen| seen.split_once(' ').map_or(*seen, |(code, _)| code))
    }

    /// Whether a rule is one of them.
    pub fn has(self, code: &str) -> bool {
        self.codes().any(|seer| seer == code)
    }

    /// Whether a row is of one of them.
    pub fn wrote(self, row: &Row) -> bool {
        self.0.iter().any(|seen| {
            let (code, subject) = seen.split_once(' ').unwrap_or((seen, ""));
            row.rule == code && (row.subject == "platform" || row.subject.starts_with(subject))
        })
    }
}

/// How a mistake changes a world.
pub trait Change: Sync {
    /// What in this world can have the mistake.
    fn subjects(&self, world: &World) -> Vec<Subject>;

    /// Puts the mistake into a subject of this world. False if that changes nothing that counts: the subject looks the same with it.
    fn apply(&self, world: &mut World, subject: &Subject) -> bool;

    /// Relations that change this subject in just the same way: a finding that names one of them is right as well.
    fn same_as(&self, _world: &World, _subject: &Subject) -> Vec<&'static str> {
        Vec::new()
    }
}

impl Fault {
    /// Whether a finding names the mistake; `same` are other relations that change the subject in the same way. A hint names nothing.
    pub fn is_named_by(&self, finding: &Finding, same: &[&str]) -> bool {
        let relation = finding.relation.as_deref();
        let by_relation = relation.is_some_and(|word| self.relations.contains(&word) || same.contains(&word));
        let by_text = || self.texts.iter().any(|text| finding.says(text));
        finding.confidence > Confidence::Hint && (by_relation || by_text())
    }

    /// Whether a word is its name or its family.
    pub fn is_called(&self, word: &str) -> bool {
        let names = [self.name, self.family.word()];
        names.iter().any(|name| name.eq_ignore_ascii_case(word))
    }
}

/// Mistakes that are to be tried.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Those without a size, in the order of the catalogue.
    pub faults: Vec<&'static Fault>,
    /// Those with a size, in their order.
    pub sizes: Vec<&'static SizedFault>,
    /// Whether a mistake must be found without some part of the drive as well.
    pub is_steady: bool,
}

impl Selection {
    /// All.
    pub fn all() -> Self {
        Self {
            faults: catalogue().collect(),
            sizes: SIZED_FAULTS.iter().collect(),
            is_steady: false,
        }
    }

    /// Those with these names or of these families.
    pub fn of(words: &[&str]) -> Self {
        let Self {
            mut faults,
            mut sizes,
            is_steady,
        } = Self::all();
        faults.retain(|fault| words.iter().any(|word| fault.is_called(word)));
        sizes.retain(|fault| words.iter().any(|word| fault.is_called(word)));
        Self {
            faults,
            sizes,
            is_steady,
        }
    }

    /// Every name and family, in a fixed order.
    pub fn words() -> Vec<&'static str> {
        let Self { faults, sizes, .. } = Self::all();
        let of_faults = faults.iter().flat_map(|fault| [fault.name, fault.family.word()]);
        let of_sizes = sizes.iter().flat_map(|fault| [fault.name, SIZES]);
        of_faults.chain(of_sizes).collect()
    }

    /// Adds what another has and this one has not.
    pub fn join(&mut self, other: &Self) {
        for fault in &other.faults {
            if self.faults.iter().all(|known| known.name != fault.name) {
                self.faults.push(fault);
            }
        }
        for fault in &other.sizes {
            if self.sizes.iter().all(|known| known.name != fault.name) {
                self.sizes.push(fault);
            }
        }
    }
}

/// Every mistake without a size, in a fixed order.
pub fn catalogue() -> impl Iterator<Item = &'static Fault> {
    let tables = [
        statements::FAULTS,
        literals::FAULTS,
        mountings::FAULTS,
        sides::FAULTS,
        clouds::FAULTS,
        cameras::FAULTS,
        delays::FAULTS,
        tree::FAULTS,
    ];
    tables.into_iter().chain(motion::tables()).flatten()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_are_unique_and_every_mistake_is_described() {
        let names: BTreeSet<&str> = catalogue().map(|fault| fault.name).collect();
        let sized = SIZED_FAULTS.iter().map(|fault| fault.name);
        let all: BTreeSet<&str> = names.iter().copied().chain(sized).collect();
        assert_eq!(names.len(), catalogue().count());
        assert_eq!(all.len(), names.len() + SIZED_FAULTS.len());
        for fault in catalogue() {
            let is_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(fault.name.chars().all(is_word), "{}", fault.name);
            assert!(fault.sentence.ends_with('.'), "{}", fault.name);
            assert!(
                !fault.record.is_empty() && !fault.seen_by.0.is_empty(),
                "{}",
                fault.name
            );
            assert!(!fault.relations.is_empty() || !fault.texts.is_empty(), "{}", fault.name);
        }
    }
}
