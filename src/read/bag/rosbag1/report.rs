//! The report on a bag after it was read.
//!
//! Owns the messages and the status. Must not read.

use crate::read::bag::Extent;
use crate::source::{Place, ReadStatus, Source};

use super::Pass;
use super::index::{Index, words};
use super::record::Fault;

const HELP: &str = "run `rosbag reindex` to index what is readable; record again if the missing messages matter";

impl Pass<'_, '_> {
    /// Reports how far reading went; `failure` is a fault of the system that ended it.
    pub(super) fn report(&self, failure: Option<Fault>, source: &mut Source) -> Extent {
        let read = self.sink.connections.messages;
        let failed = failure.is_some();
        source.examined.messages = Some(read);
        source.examined.bytes = if failed {
            self.tape.at
        } else {
            self.sink.losses.read_of(self.tape.total)
        };
        let whole = Place::whole(source.id);
        // Where no message was read there is nothing to judge.
        let worst = if read == 0 {
            ReadStatus::Unreadable
        } else {
            ReadStatus::Partial
        };
        let mut report = |status, message: String, help: Option<&str>| {
            source.problem_with_help(status, whole.clone(), message, help.map(str::to_owned));
        };
        if let Some(fault) = failure {
            report(worst, words(fault), None);
        }
        for line in self.sink.losses.lines(self.tape.total) {
            report(worst, line, Some(HELP));
        }
        if let Some(why) = &self.unindexed {
            report(worst, format!("{why}; the bag was scanned from its start"), Some(HELP));
        }
        let (missing, surplus) = self
            .sink
            .index
            .as_ref()
            .map_or((0, 0), |index| self.sink.connections.against(index));
        let promised = self.sink.index.as_deref().map(Index::messages);
        if let Some(promised) = promised.filter(|_| missing + surplus > 0) {
            report(
                worst,
                format!("{read} messages were read, but the file's index says {promised}"),
                Some(HELP),
            );
        }
        let mut lost = failed || missing > 0;
        if self.sink.index.is_none() {
            lost |= !self.data_ended;
        }
        if self.sink.connections.orphans > 0 {
            let orphans = self.sink.connections.orphans;
            let message = format!("{orphans} messages belong to connections that the file does not define");
            report(worst, message, None);
            lost = true;
        }
        let chunks = self.sink.index.as_ref().map_or(0, |index| index.chunks.len());
        self.report_oddities(chunks, source);
        if read == 0 && source.detail.is_none() {
            source.detail = Some("no messages".to_owned());
        }
        Extent {
            truncated: lost,
            whole: true,
            indexed: self.sink.index.is_some(),
            messages_total: promised,
            span_ns: self.sink.index.as_deref().and_then(Index::span_ns),
        }
    }

    /// Reports inconsistencies that need not mean a loss; `chunks` of the index were looked for.
    pub(super) fn report_oddities(&self, chunks: usize, source: &mut Source) {
        let whole = Place::whole(source.id);
        let unmet = chunks.saturating_sub(self.sink.met_chunks) as u64;
        let connections = &self.sink.connections;
        let found = [
            (
                connections.redefined,
                "connections are defined twice with different contents",
            ),
            (
                connections.outside,
                "messages have a log time outside of the range that the index gives for their chunk",
            ),
            (self.sink.unlisted_chunks, "chunks are not in the index"),
            (unmet, "chunks are not where the index says"),
            (self.lying_sizes, "chunks differ in size from what their header says"),
        ];
        for (count, what) in found.into_iter().filter(|(count, _)| *count > 0) {
            let message = format!("{count} {what}");
            source.problem_with_help(ReadStatus::Partial, whole.clone(), message, Some(HELP.to_owned()));
        }
        if self.odd_index_data > 0 {
            let count = self.odd_index_data;
            let message =
                format!("{count} index records differ in length from what they say, as recorders of 2010 wrote them");
            source.problem(ReadStatus::Read, whole, message);
        }
    }
}
