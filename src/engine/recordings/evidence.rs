//! Evidence documents together with recordings: each recording in them has its own verdict too.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::source::SourceId;
use crate::verdict::Verdict;
use crate::world::World;

use super::super::evidence::SavedEvidence;
use super::super::gather::source_id;
use super::super::{IdShift, furnished, sessions};
use super::whole::RunBuilder;
use super::{JudgeContext, name};

/// An evidence document: recordings that were read elsewhere.
pub(super) fn judge(context: &JudgeContext, saved: SavedEvidence, whole: &mut RunBuilder) {
    let SavedEvidence {
        worlds,
        sources,
        skipped,
        governed,
    } = furnished(context.setup, saved);
    let before = whole.run.sources.len();
    let renumber = IdShift::behind(0, before);
    let sessions = sessions::of_worlds(&worlds, &sources);
    let mut own = sources.to_vec();
    for (number, source) in own.iter_mut().enumerate() {
        let path = |other: usize| Some(sources.get(other)?.path.clone());
        Arc::make_mut(source).notes.extend(sessions.note(number, path));
    }
    renumber.all(&mut own, &mut Verdict::default());
    whole.run.sources.extend(own);
    let (rows, findings) = (whole.run.verdict.rows.len(), whole.run.verdict.findings.len());
    whole.notify((before..whole.run.sources.len()).collect(), rows, findings, None);
    whole.run.skip(skipped);
    let judged = |worlds: &[World]| -> Vec<_> {
        let judged = worlds.iter().map(|world| context.setup.judge_as(governed, world, true));
        judged.collect()
    };
    let drives = &sessions.drives;
    for recordings in drives {
        let is_of = |id: SourceId| recordings.contains(&(id.0 as usize));
        // A source extracted from a recording has the recording's path.
        let others = worlds
            .iter()
            .flat_map(|world| &world.bags)
            .filter(|bag| !is_of(bag.source));
        let others: BTreeSet<&str> = others
            .filter_map(|bag| sources.get(bag.source.0 as usize))
            .map(|source| source.path.as_str())
            .collect();
        let stays = |id: SourceId| {
            let source = sources.get(id.0 as usize);
            is_of(id) || source.is_none_or(|source| !others.contains(source.path.as_str()))
        };
        let of_drive = worlds.iter().filter(|world| world.members.iter().any(|id| is_of(*id)));
        let mut parts: Vec<World> = of_drive.map(|world| world.only(stays)).collect();
        let label = name(recordings, &mut parts, &sources);
        let verdicts = judged(&parts);
        let mut drive = context.drive(label, recordings, (parts, &[]), verdicts);
        for id in &mut drive.recording.sources {
            *id = source_id(id.0 as usize + before);
        }
        whole.add(drive, renumber);
    }
    let rest: Vec<World> = worlds.iter().filter(|world| world.bags.is_empty()).cloned().collect();
    let rest_labels: Vec<String> = rest.iter().map(|world| world.label.clone()).collect();
    whole.run.seen.extend(context.setup.seen(&rest));
    let compared = context.compare(&worlds, drives, whole, |_| governed);
    for (mut verdicts, labels) in [(judged(&rest), rest_labels), compared] {
        for (_, verdict) in &mut verdicts {
            renumber.all(&mut [], verdict);
        }
        whole.apply_policy(verdicts, &labels, context.policy);
    }
}
