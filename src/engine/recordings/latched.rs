//! Data kept to compare recordings: for each value of a latched transform, the two earliest recordings that have it. A thousand drives of
//! one robot have the same ones.

use std::collections::BTreeMap;
use std::path::Path;

use crate::read::discover::Inputs;
use crate::source::SourceId;
use crate::world::Facts;
use crate::world::bag::TfEdge;

/// A recording by its start, nanoseconds.
type Start = (Option<i64>, SourceId);

/// The values that are kept, each with the recordings for which it is kept.
pub(super) struct LatchedValues<'a> {
    inputs: &'a Inputs,
    kept: BTreeMap<Key<'a>, Vec<Start>>,
    /// The number of drives in each folder, if platforms are folders because no file says what belongs together.
    drives: Option<BTreeMap<Folder<'a>, usize>>,
}

/// The command-line argument and the folder.
type Folder<'a> = (usize, &'a Path);

/// The platform (the files that belong to it, or the folder if there are none), the edge, and the bits of its value.
type Key<'a> = (usize, Vec<SourceId>, Option<&'a Path>, [String; 3], Vec<u64>);

impl<'a> LatchedValues<'a> {
    /// For these drives, with nothing kept yet. `are_files`: whether files other than recordings were read.
    pub(super) fn of(inputs: &'a Inputs, drives: &[Vec<usize>], are_files: bool) -> Self {
        let mut latched = Self {
            inputs,
            kept: BTreeMap::new(),
            drives: None,
        };
        if !are_files {
            let mut counts = BTreeMap::new();
            for folder in drives.iter().filter_map(|drive| latched.folder(*drive.first()?)) {
                *counts.entry(folder).or_default() += 1;
            }
            latched.drives = Some(counts);
        }
        latched
    }

    fn folder(&self, recording: usize) -> Option<Folder<'a>> {
        let input = self.inputs.files.get(recording)?;
        Some((input.group, input.path.parent().unwrap_or(Path::new(""))))
    }

    /// Removes from these recordings, judged with these files, the latched transforms whose value is kept for two earlier ones; all of them
    /// if there are no other recordings to compare with.
    pub(super) fn new_of(&mut self, files: &[SourceId], mut left: Vec<(usize, Facts)>) -> Vec<(usize, Facts)> {
        for (recording, facts) in &mut left {
            let Some((group, folder)) = self.folder(*recording) else {
                continue;
            };
            let drives = self.drives.as_ref().and_then(|drives| drives.get(&(group, folder)));
            if drives == Some(&1) {
                *facts = Facts::default();
                continue;
            }
            let folder = Some(folder).filter(|_| files.is_empty());
            for bag in &mut facts.bags {
                let own = (bag.start_ns, bag.source);
                bag.tf.retain(|edge| {
                    let Some((names, value)) = value(edge).filter(|_| edge.is_static) else {
                        return true;
                    };
                    let key = (group, files.to_vec(), folder, names, value);
                    let earliest = self.kept.entry(key).or_default();
                    earliest.push(own);
                    earliest.sort_unstable();
                    earliest.truncate(2);
                    earliest.contains(&own)
                });
                bag.tf.shrink_to_fit();
            }
        }
        left
    }
}

/// The names of an edge, and the bits of its first value.
fn value(edge: &TfEdge) -> Option<([String; 3], Vec<u64>)> {
    let pose = edge.first()?.pose;
    let numbers = pose.translation_m.iter().chain(&pose.rotation_xyzw);
    let names = [&edge.topic, edge.parent.as_str(), edge.child.as_str()].map(str::to_owned);
    Some((names, numbers.map(|number| number.to_bits()).collect()))
}
