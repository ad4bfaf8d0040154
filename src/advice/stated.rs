//! The sources of the two sides of a finding about a pair of statements, and the configuration that would confirm a guess.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::cross::pair::{Direction, Pair, Statement, TURNED};
use crate::source::Confidence;
use crate::verdict::Finding;
use crate::world::{Claim, FrameId, World};

/// How many of the sources that agree with one side are shown.
const MOST_SHOWN: usize = 16;

impl Statement {
    /// The claim behind it, where it is one.
    pub(crate) fn claim<'w>(&self, world: &'w World) -> Option<&'w Claim> {
        let claims = world.claims_called(self.place.source, &self.label);
        let mut claims = claims.filter(|claim| claim.place == self.place);
        claims.next().filter(|_| claims.next().is_none())
    }

    /// Whether it is composed of several transforms; its place is that of the last one.
    pub(crate) fn is_chain(&self) -> bool {
        self.who.starts_with("the chain of ")
    }
}

impl Pair {
    /// Adds to a finding at the other statement its source and how sure the reading is, and points at the reference
    /// and at the sources that agree with either side.
    pub(crate) fn point_at_all(&self, finding: Finding) -> Finding {
        self.point_at_all_with(finding, Confidence::Hint)
    }

    /// The same, where the names of a program's sensors are as sure as this.
    pub(crate) fn point_at_all_with(&self, finding: Finding, roles: Confidence) -> Finding {
        let stated = |by: &Statement| {
            let what = if by.is_chain() {
                "last transform of"
            } else {
                "stated by"
            };
            format!("{what} {}", by.who.replace(TURNED, ""))
        };
        let mut finding = finding
            .confidence(self.reading_with(roles))
            .label(stated(&self.other))
            .related(self.reference.place.clone(), stated(&self.reference));
        for (with_other, side) in [(false, &self.reference), (true, &self.other)] {
            let seconding = self.seconded_by.iter().filter(|(other, ..)| *other == with_other);
            let not_shown = seconding.clone().count().saturating_sub(MOST_SHOWN);
            for (index, (_, place, who)) in seconding.take(MOST_SHOWN).enumerate() {
                let and_others = if index + 1 == MOST_SHOWN && not_shown > 0 {
                    format!(", as do {not_shown} other sources")
                } else {
                    String::new()
                };
                finding = finding.related(place.clone(), format!("{who} agrees with {}{and_others}", side.who));
            }
        }
        let sides = [&self.reference, &self.other];
        // The platform's own names, where one of the two uses them.
        let own = sides.iter().find(|one| !one.is_guess()).map(|one| &one.called);
        settled_by_user(finding, sides.map(|one| (one, own)))
    }
}

/// The target frame and the source frame.
type Names = (FrameId, FrameId);

/// Adds to a hint the configuration that would make it certain: which frames the names of a program's sensors mean, where there is
/// a better name for them, and the direction of a guessed statement.
pub(crate) fn settled_by_user<'s>(
    finding: Finding,
    statements: impl IntoIterator<Item = (&'s Statement, Option<&'s Names>)>,
) -> Finding {
    if finding.confidence > Confidence::Hint {
        return finding;
    }
    let mut aliases: BTreeMap<&FrameId, BTreeSet<&FrameId>> = BTreeMap::new();
    let mut transforms: BTreeSet<String> = BTreeSet::new();
    for (one, own) in statements {
        if one.is_guess() {
            let (target, source) = own.map_or((&one.target, &one.source_frame), |own| (&own.0, &own.1));
            aliases.entry(target).or_default().insert(&one.called.0);
            aliases.entry(source).or_default().insert(&one.called.1);
        }
        if one.reading == Confidence::Hint {
            let (target, source) = match one.direction {
                Direction::AsStated => (&one.called.0, &one.called.1),
                Direction::TurnedRound => (&one.called.1, &one.called.0),
            };
            transforms.insert(format!("{{key: '{}', is: {target} from {source}}}", one.label));
        }
    }
    let aliases: Vec<String> = aliases
        .into_iter()
        .map(|(frame, names)| {
            let names: Vec<&str> = names.into_iter().map(FrameId::as_str).collect();
            format!("{frame}: [{}]", names.join(", "))
        })
        .collect();
    let transforms: Vec<String> = transforms.into_iter().collect();
    let keys = [
        (!aliases.is_empty()).then(|| format!("`aliases: {{{}}}`", aliases.join(", "))),
        (!transforms.is_empty()).then(|| format!("`transforms: [{}]`", transforms.join(", "))),
    ];
    let keys: Vec<String> = keys.into_iter().flatten().collect();
    if keys.is_empty() {
        return finding;
    }
    finding.confirm_with(&keys.join(" and "))
}
