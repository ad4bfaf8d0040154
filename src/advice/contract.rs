//! The topics of a contract, each with the recordings that have it; and the rows of those that cannot be judged.

use crate::analysis::contract::{Recorded, recorded, topics_unknown};
use crate::rules::Need;
use crate::verdict::Judge;
use crate::world::World;
use crate::world::contract::TopicTerms;

/// Row of a contract if there is no recording.
pub(crate) const SUBJECT: &str = "contract";

/// What to do about a difference that is meant.
pub(crate) const MEANT: &str = "if the change is intended, correct the contract";

/// A topic of the contract that a rule asks about.
pub(crate) struct Term<'w> {
    /// `rate of topic `/imu``.
    pub(crate) subject: String,
    /// Its name.
    pub(crate) name: &'w str,
    /// What the contract says.
    pub(crate) terms: &'w TopicTerms,
    /// Where it is recorded; empty if it is observed to be absent.
    pub(crate) seen: Vec<Recorded<'w>>,
}

/// The topics of the contract that a rule asks about. Writes rows for those that cannot be judged: without a recording, if the absence is
/// not observed, or if they are optional.
pub(crate) fn terms<'w>(
    world: &'w World,
    prefix: &str,
    is_asked: impl Fn(&TopicTerms) -> bool,
    out: &mut Judge,
) -> Vec<Term<'w>> {
    let topics = &world.conventions.contract.topics;
    let asked: Vec<_> = topics.iter().filter(|(_, terms)| is_asked(terms)).collect();
    if world.bags.is_empty() && !asked.is_empty() {
        out.missing(SUBJECT, Need::Bag.missing());
        return Vec::new();
    }
    let unknown = topics_unknown(world);
    let mut all = Vec::new();
    for (name, terms) in asked {
        let subject = format!("{prefix}topic `{name}`");
        let seen: Vec<Recorded> = recorded(world).filter(|(_, topic)| topic.topic == *name).collect();
        match unknown {
            _ if !seen.is_empty() => {}
            Some(why) => {
                out.too_little(subject, why);
                continue;
            }
            None if terms.is_optional => {
                out.not_applicable(subject, "the topic is optional, and not recorded");
                continue;
            }
            None => {}
        }
        all.push(Term {
            subject,
            name,
            terms,
            seen,
        });
    }
    all
}

impl Term<'_> {
    /// Writes a row where the topic is absent; false if it is there.
    pub(crate) fn is_absent(&self, out: &mut Judge) -> bool {
        if self.seen.is_empty() {
            out.missing(self.subject.as_str(), "the topic is not recorded");
        }
        self.seen.is_empty()
    }
}
