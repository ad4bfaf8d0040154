//! CONTRACT01: topics of the contract that are missing or of another type, and topics that it does not know.

use crate::advice::contract::{MEANT, Term, terms};
use crate::analysis::contract::{Recorded, is_incidental, recorded};
use crate::rules::prelude::*;

pub(crate) struct ContractTopic;

impl Rule for ContractTopic {
    const NEEDS: &'static [Need] = &[];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _: &NoLimits, out: &mut Judge) {
        let known = &world.conventions.contract.topics;
        if known.is_empty() {
            return;
        }
        let is_unknown = |(_, topic): &Recorded| !known.contains_key(&topic.topic) && !is_incidental(topic);
        let unknown: Vec<Recorded> = recorded(world).filter(is_unknown).collect();
        for term in terms(world, "", |_| true, out) {
            let wanted = term.terms.message_type.as_deref();
            let is_other = |(_, topic): &&Recorded| wanted.is_some_and(|wanted| !is_same(wanted, &topic.message_type));
            let other = term.seen.iter().find(is_other);
            if term.seen.is_empty() {
                out.fail(missing(world, &term, &unknown));
            } else if let (Some(found), Some(wanted)) = (other, wanted) {
                out.fail(retyped(&term, found, wanted));
            } else {
                let messages = term.seen.iter().map(|(_, topic)| topic.total.unwrap_or(topic.count));
                out.pass(
                    term.subject,
                    [Measured::count("recordings with the topic", term.seen.len()).samples(messages.sum())],
                );
            }
        }
        if let Some((bag, topic)) = unknown.first() {
            let names = names(&unknown);
            let message = match unknown.len() {
                1 => format!("{names} is recorded, but is not in the contract"),
                count => format!("{count} topics are recorded, but are not in the contract"),
            };
            let place = Place::of(bag.source, topic.stamps.first.as_ref());
            let finding = Finding::note("topics that the contract does not know", message, place)
                .detail(if unknown.len() > 1 { format!("These are {names}.") } else { String::new() })
                .help("add each topic that is intended to `contract: topics:` in frames-lint.yaml, with `optional: true` where a recording may lack the topic; rename or remove a topic that is not intended")
                .measured(Measured::count("topics that are not in the contract", unknown.len()).limit(0.0));
            out.fail(finding);
        }
    }
}

/// `sensor_msgs/msg/Imu` of ROS 2 is `sensor_msgs/Imu` of ROS 1.
fn is_same(a: &str, b: &str) -> bool {
    a.replace("/msg/", "/") == b.replace("/msg/", "/")
}

/// Maximum number of topics that are named.
const MAX_NAMED: usize = 12;

fn names(topics: &[Recorded]) -> String {
    let named: Vec<String> = topics
        .iter()
        .take(MAX_NAMED)
        .map(|(_, topic)| format!("`{}`", topic.topic))
        .collect();
    let more = topics.len().saturating_sub(MAX_NAMED);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    named.join(", ") + &more
}

fn missing(world: &Estimates, term: &Term, unknown: &[Recorded]) -> Finding {
    let name = term.name;
    let message = match world.bags.as_slice() {
        [_, _, ..] => format!("`{name}` of the contract is in none of {} recordings", world.bags.len()),
        _ => format!("`{name}` of the contract is not in the recording"),
    };
    let is_alike = |(_, topic): &&Recorded| {
        let wanted = term.terms.message_type.as_deref();
        wanted.is_some_and(|wanted| is_same(wanted, &topic.message_type))
    };
    let alike: Vec<Recorded> = unknown.iter().filter(is_alike).copied().collect();
    let finding = Finding::error(&term.subject, message, term.terms.place.clone())
        .label("not recorded")
        .help(format!("record `{name}`; {MEANT}, or set `optional: true`"))
        .measured(Measured::count("recordings with the topic", 0).at_least(1.0));
    let finding = match alike.as_slice() {
        [] => finding,
        alike => finding.detail(format!(
            "Recorded with the same type, and not in the contract: {}.",
            names(alike)
        )),
    };
    world.bags.iter().take(MAX_NAMED).fold(finding, |finding, bag| {
        finding.related(Place::whole(bag.source), "without the topic")
    })
}

fn retyped(term: &Term, (bag, topic): &Recorded, wanted: &str) -> Finding {
    let (name, found) = (term.name, &topic.message_type);
    Finding::error(
        &term.subject,
        format!("`{name}` has type `{found}` instead of `{wanted}`"),
        term.terms.place.clone(),
    )
    .label("type in the contract")
    .help(format!("publish `{name}` as `{wanted}`; {MEANT}"))
    .measured(Measured::count("recordings with another type than in the contract", 1).limit(0.0))
    .related(
        Place::of(bag.source, topic.stamps.first.as_ref()),
        format!("first message, of type `{found}`"),
    )
}
