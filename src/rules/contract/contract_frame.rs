//! CONTRACT03: messages with other frames than those of the contract.

use std::collections::BTreeMap;

use crate::advice::contract::{MEANT, Term, terms};
use crate::analysis::contract::Recorded;
use crate::rules::prelude::*;
use crate::world::FrameId;
use crate::world::bag::HeaderFrame;

pub(crate) struct ContractFrame;

impl Rule for ContractFrame {
    const NEEDS: &'static [Need] = &[];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _: &NoLimits, out: &mut Judge) {
        for term in terms(world, "frame of ", |terms| !terms.frames.is_empty(), out) {
            judge_all(&term, ("frame_id", &term.terms.frames), out, |topic| {
                &topic.1.header_frames
            });
        }
        for term in terms(world, "child frame of ", |terms| !terms.child_frames.is_empty(), out) {
            judge_all(&term, ("child_frame_id", &term.terms.child_frames), out, |topic| {
                &topic.1.child_frames
            });
        }
    }
}

fn judge_all<'w>(
    term: &Term<'w>,
    (key, wanted): (&str, &[FrameId]),
    out: &mut Judge,
    of: impl Fn(&Recorded<'w>) -> &'w BTreeMap<FrameId, HeaderFrame>,
) {
    if term.is_absent(out) {
        return;
    }
    for recorded in &term.seen {
        let (bag, topic) = recorded;
        let frames = of(recorded);
        let read: u64 = frames.values().map(|frame| frame.count).sum();
        let other = frames.iter().find(|(frame, _)| !wanted.contains(&frame.canonical()));
        let Some((frame, first)) = other else {
            if frames.is_empty() {
                let why = topic.unread.as_deref().unwrap_or("no message with one was read");
                out.too_little(term.subject.as_str(), format!("its `{key}` is not known: {why}"));
            } else {
                let measured = Measured::count("messages with a frame that is not in the contract", 0).limit(0.0);
                out.pass(term.subject.as_str(), [measured.samples(read)]);
            }
            continue;
        };
        let name = term.name;
        let allowed: Vec<String> = wanted.iter().map(|frame| format!("`{frame}`")).collect();
        let allowed = allowed.join(" or ");
        let count = frames.iter().filter(|(frame, _)| !wanted.contains(&frame.canonical()));
        let count: u64 = count.map(|(_, frame)| frame.count).sum();
        let some = if count < read {
            format!(" in {count} of {read} messages")
        } else {
            String::new()
        };
        let message = format!("`{name}` has {key} `{frame}` instead of {allowed}{some}");
        let help = if key == "child_frame_id" {
            format!("publish the pose of {allowed} on `{name}`: convert the pose, do not only rename the frame")
        } else {
            format!(
                "publish `{name}` with {key} {allowed}, and convert the data if they are expressed in another frame"
            )
        };
        let finding = Finding::error(&term.subject, message, term.terms.place.clone())
            .label("frame in the contract")
            .help(format!("{help}; {MEANT}"))
            .measured(
                Measured::new(
                    "messages with a frame that is not in the contract",
                    count as f64,
                    "count",
                )
                .limit(0.0)
                .samples(read),
            )
            .related(
                Place::message(bag.source, first.first.clone()),
                format!("first message with `{frame}`"),
            );
        out.fail(finding);
    }
}
