//! Which chunks of a recording are read when not all of it is.
//!
//! Owns the choice. Must not know formats: a chunk is a stretch of time with some channels in it.

use std::collections::{BTreeMap, BTreeSet};

use super::{Channel, Sampling, Selection};

/// Fewest chunks that are read for a channel, as far as it has so many.
const CHUNKS_PER_CHANNEL: usize = 6;
/// Most chunks that are read for a channel that is wanted throughout.
const CHUNKS_THROUGHOUT: usize = 64;

/// A chunk, as the index of the file describes it. Chunks are numbered in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ChunkInfo {
    /// Earliest log time, nanoseconds.
    pub(super) start_ns: i64,
    /// Latest log time, nanoseconds.
    pub(super) end_ns: i64,
    /// Bytes when decompressed.
    pub(super) bytes: u64,
    /// Numbers of the channels that have messages in it, sorted; by the format's own count.
    pub(super) channels: Vec<u32>,
}

/// Channels that are read in a special way, numbered by the format's own count.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct MarkedChannels {
    /// Looked for in more chunks.
    pub(super) throughout: BTreeSet<u32>,
    /// Wanted message after message.
    pub(super) in_a_row: BTreeSet<u32>,
}

impl MarkedChannels {
    /// `channels` gives the numbers of the channels that match a predicate.
    pub(super) fn of(wanted: &Selection<'_>, channels: impl Fn(&dyn Fn(&Channel) -> bool) -> BTreeSet<u32>) -> Self {
        Self {
            throughout: channels(wanted.throughout),
            in_a_row: channels(wanted.in_a_row),
        }
    }
}

/// The numbers of the chunks to be read, in the order of the file; all of them where the recording is small.
///
/// Runs of neighbouring chunks are spread evenly over the time: the first at the beginning, the last at the end. Then
/// chunks are added for channels that the runs show too little of: the first chunk of each channel and some over its
/// length, more of them for the channels that are wanted throughout.
pub(super) fn choose(chunks: &[ChunkInfo], sampling: &Sampling, marked: &MarkedChannels) -> Vec<usize> {
    let all: u64 = chunks.iter().fold(0, |sum, chunk| sum.saturating_add(chunk.bytes));
    if all <= sampling.bytes {
        return (0..chunks.len()).collect();
    }
    let mut chosen = runs(chunks, sampling, &marked.in_a_row);
    let mut extra = sampling.bytes / 2;
    for (channel, holding) in holders(chunks) {
        let wanted = if marked.throughout.contains(&channel) {
            CHUNKS_THROUGHOUT
        } else {
            CHUNKS_PER_CHANNEL
        };
        let first = holding.first().copied();
        let met = holding.iter().filter(|number| chosen.contains(number)).count();
        // What the budget allows is spread too: the beginning must not use it up.
        let largest = holding
            .iter()
            .filter_map(|number| chunks.get(*number))
            .map(|chunk| chunk.bytes);
        let room = extra / largest.max().unwrap_or(0).max(1);
        let wanted = wanted.min(usize::try_from(room).unwrap_or(usize::MAX));
        let spread = if met >= wanted.min(holding.len()) {
            Vec::new()
        } else {
            spread(&holding, wanted)
        };
        // The first chunk of a channel is read at any cost.
        chosen.extend(first);
        for number in spread {
            let bytes = chunks.get(number).map_or(0, |chunk| chunk.bytes);
            if !chosen.contains(&number) && bytes <= extra {
                extra -= bytes;
                chosen.insert(number);
            }
        }
    }
    chosen.into_iter().collect()
}

/// Runs of neighbours in time.
fn runs(chunks: &[ChunkInfo], sampling: &Sampling, in_a_row: &BTreeSet<u32>) -> BTreeSet<usize> {
    let mut by_time: Vec<usize> = (0..chunks.len()).collect();
    by_time.sort_by_key(|number| chunks.get(*number).map(|chunk| (chunk.start_ns, *number)));
    let info = |place: usize| {
        by_time
            .get(place)
            .and_then(|number| Some((*number, chunks.get(*number)?)))
    };
    let start = chunks.iter().map(|chunk| chunk.start_ns).min().unwrap_or(0);
    let end = chunks.iter().map(|chunk| chunk.end_ns).max().unwrap_or(0);
    let windows = sampling.windows.max(1);
    let length_ns = sampling.seconds * 1e9;
    let mut chosen = BTreeSet::new();
    for window in 0..windows {
        let part = if windows > 1 {
            f64::from(window) / f64::from(windows - 1)
        } else {
            0.0
        };
        // Runs lie wholly inside of the recording: the last one ends at its end.
        let span = (end as f64 - start as f64 - length_ns).max(0.0);
        let from = start as f64 + part * span;
        let first =
            by_time.partition_point(|number| chunks.get(*number).is_some_and(|chunk| (chunk.end_ns as f64) < from));
        let first = first.min(by_time.len().saturating_sub(1));
        let lasting = (first..)
            .map_while(info)
            .enumerate()
            .take_while(|(index, (_, chunk))| *index == 0 || chunk.start_ns as f64 <= from + length_ns);
        let lasting: Vec<_> = lasting.map(|(_, known)| known).collect();
        let is_in_a_row =
            |(_, chunk): &(usize, &ChunkInfo)| chunk.channels.iter().any(|channel| in_a_row.contains(channel));
        let (share, carried) = sampling.bounds(window);
        let bound = if lasting.iter().any(is_in_a_row) {
            carried
        } else {
            share
        };
        let mut bytes = 0_u64;
        for (index, (number, chunk)) in lasting.into_iter().enumerate() {
            bytes = bytes.saturating_add(chunk.bytes);
            if index > 0 && bytes > bound {
                break;
            }
            chosen.insert(number);
        }
    }
    chosen
}

/// For every channel, the chunks that hold it; the rarest channels first, so that they get the budget.
fn holders(chunks: &[ChunkInfo]) -> Vec<(u32, Vec<usize>)> {
    let mut holders: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (number, chunk) in chunks.iter().enumerate() {
        for channel in &chunk.channels {
            holders.entry(*channel).or_default().push(number);
        }
    }
    let mut holders: Vec<(u32, Vec<usize>)> = holders.into_iter().collect();
    holders.sort_by_key(|(channel, holding)| (holding.len(), *channel));
    holders
}

/// `count` of the numbers, evenly spread, the first and the last among them.
fn spread(numbers: &[usize], count: usize) -> Vec<usize> {
    if numbers.len() <= count || count < 2 {
        return numbers.iter().take(count.max(1)).copied().collect::<Vec<_>>();
    }
    let last = numbers.len() - 1;
    (0..count)
        .filter_map(|step| numbers.get(step * last / (count - 1)).copied())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::RunExtension;
    use super::*;

    /// A chunk of 1 MB for every second, with channel 1 in each, 2 in one of a hundred, 3 in the last only.
    fn drive(seconds: i64) -> Vec<ChunkInfo> {
        (0..seconds)
            .map(|second| ChunkInfo {
                start_ns: second * 1_000_000_000,
                end_ns: second * 1_000_000_000 + 999_999_999,
                bytes: 1 << 20,
                channels: [
                    Some(1),
                    (second % 100 == 50).then_some(2),
                    (second == seconds - 1).then_some(3),
                ]
                .into_iter()
                .flatten()
                .collect(),
            })
            .collect()
    }

    const SAMPLING: Sampling = Sampling {
        windows: 5,
        seconds: 2.0,
        bytes: 20 << 20,
        carried: None,
    };

    fn throughout(channels: &[u32]) -> MarkedChannels {
        MarkedChannels {
            throughout: channels.iter().copied().collect(),
            ..MarkedChannels::default()
        }
    }

    #[test]
    fn a_small_recording_is_read_wholly() {
        let chosen = choose(&drive(20), &SAMPLING, &MarkedChannels::default());
        assert_eq!(chosen, (0..20).collect::<Vec<_>>());
    }

    #[test]
    fn runs_begin_at_the_beginning_and_end_at_the_end() {
        let chosen = choose(&drive(1000), &SAMPLING, &MarkedChannels::default());
        for wanted in [0, 1, 2, 249, 250, 251, 998, 999] {
            assert!(chosen.contains(&wanted), "{wanted} is not in {chosen:?}");
        }
        assert!(chosen.is_sorted() && chosen.len() <= 30, "{chosen:?}");
    }

    #[test]
    fn rare_channels_are_met_and_those_wanted_throughout_more_often() {
        let chunks = drive(2000);
        let rare = |chosen: &[usize]| chosen.iter().filter(|number| **number % 100 == 50).count();
        let some = choose(&chunks, &SAMPLING, &MarkedChannels::default());
        assert!((6..10).contains(&rare(&some)), "{some:?}");
        assert!(some.contains(&50), "the first message of a channel");
        let more = choose(&chunks, &SAMPLING, &throughout(&[2]));
        assert!(rare(&more) > rare(&some) && rare(&more) >= 10, "{more:?}");
    }

    /// Ten chunks of 12 MB a second, each with the one channel.
    fn large(seconds: i64) -> Vec<ChunkInfo> {
        (0..10 * seconds)
            .map(|tenth| ChunkInfo {
                start_ns: tenth * 100_000_000,
                end_ns: tenth * 100_000_000 + 99_999_999,
                bytes: 12 << 20,
                channels: vec![7],
            })
            .collect()
    }

    #[test]
    fn large_messages_that_are_wanted_in_a_row_have_neighbours() {
        let in_a_row = MarkedChannels {
            in_a_row: BTreeSet::from([7]),
            ..MarkedChannels::default()
        };
        let carried = |runs: u32, megabytes: u64| Sampling {
            carried: Some(RunExtension {
                runs,
                bytes: megabytes << 20,
            }),
            ..SAMPLING
        };
        let longest = |chosen: &[usize]| {
            let parts = chosen.chunk_by(|a, b| a + 1 == *b);
            parts.map(<[usize]>::len).collect::<Vec<_>>()
        };
        let chunks = large(600);
        let alone = choose(&chunks, &carried(5, 300), &MarkedChannels::default());
        assert!(longest(&alone).iter().all(|length| *length <= 2), "{alone:?}");
        // The runs are 2 seconds long, or as long as their bytes allow.
        let all = choose(&chunks, &carried(5, 300), &in_a_row);
        assert_eq!(
            longest(&all).iter().filter(|length| **length >= 20).count(),
            5,
            "{all:?}"
        );
        let some = choose(&chunks, &carried(2, 300), &in_a_row);
        assert_eq!(
            longest(&some).iter().filter(|length| **length >= 20).count(),
            2,
            "{some:?}"
        );
        let bounded = choose(&chunks, &carried(5, 100), &in_a_row);
        assert_eq!(
            longest(&bounded).iter().filter(|length| **length == 8).count(),
            5,
            "{bounded:?}"
        );
    }

    #[test]
    fn the_cost_does_not_grow_with_the_recording() {
        for seconds in [100, 1000, 10_000] {
            let chosen = choose(&drive(seconds), &SAMPLING, &throughout(&[1, 2]));
            assert!(chosen.len() <= 32, "{} of {seconds}", chosen.len());
        }
    }

    #[test]
    fn times_that_lie_do_no_harm() {
        let mut chunks = drive(100);
        chunks[3].start_ns = i64::MAX;
        chunks[4].end_ns = i64::MIN;
        chunks[5].bytes = u64::MAX;
        assert!(!choose(&chunks, &SAMPLING, &MarkedChannels::default()).is_empty());
    }
}
