//! One pass over the messages of a database.
//!
//! Owns how rows become messages, and that none is delivered twice. Must not know which rows are wanted.

use std::collections::VecDeque;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, Params, Row};

use super::super::MAX_MESSAGE;
use super::super::{Message, Progress, Visit};
use super::tables::Tables;

/// Ranges of unreadable rows after which reading continues.
const MAX_LOSSES: usize = 1000;

/// Bytes of messages between two calls of the progress function.
const PROGRESS_STEP: u64 = 4 << 20;

/// What every query for messages selects. No byte is loaded of a message that is too large.
pub(super) fn select(rest: &str) -> String {
    format!(
        "SELECT rowid, topic_id, timestamp, octet_length(data), \
         CASE WHEN octet_length(data) <= {MAX_MESSAGE} THEN data END FROM messages {rest}"
    )
}

/// Whether a query continues after a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flow {
    /// The next row is wanted.
    Go,
    /// No further row is wanted.
    Enough,
}

/// The messages of a database on their way to the visitor.
pub(super) struct Pass<'c, 'v> {
    pub(super) connection: &'c Connection,
    pub(super) tables: Tables,
    pub(super) total: u64,
    pub(super) progress: Progress<'v>,
    visit: &'v mut dyn Visit,
    /// Time and row of the last message delivered.
    pub(super) last: Option<(i64, i64)>,
    /// The largest row delivered.
    largest_row: i64,
    pub(super) messages: u64,
    /// Bytes of messages delivered.
    pub(super) bytes: u64,
    last_progress: u64,
    pub(super) orphans: u64,
    pub(super) too_large: u64,
    pub(super) unfit: u64,
    /// The last page, where the file ends inside of it: SQLite reads zeros after that.
    pub(super) last_page: Option<LastPage>,
    /// Messages that continue past the end of the file.
    pub(super) cut_off: u64,
    /// Bytes of a page, where the file is damaged: a message is then used only when as many bytes after it could be read, for the rows of a page are
    /// damaged together.
    pub(super) damaged_page: Option<usize>,
    /// Topic, log time and bytes of the messages that are held back for that.
    held: VecDeque<(i64, i64, Vec<u8>)>,
    held_bytes: usize,
    /// Messages just before unreadable rows.
    pub(super) doubted: u64,
    /// Why something could not be read.
    pub(super) stopped: Option<String>,
    /// The first unreadable rows that have readable ones after them, and the number of such ranges.
    pub(super) lost: Option<((i64, i64), usize)>,
}

impl<'c, 'v> Pass<'c, 'v> {
    pub(super) fn new(
        connection: &'c Connection,
        tables: Tables,
        total: u64,
        progress: Progress<'v>,
        visit: &'v mut dyn Visit,
    ) -> Self {
        Self {
            connection,
            tables,
            total,
            progress,
            visit,
            last: None,
            largest_row: i64::MIN,
            messages: 0,
            bytes: 0,
            last_progress: 0,
            orphans: 0,
            too_large: 0,
            unfit: 0,
            last_page: None,
            cut_off: 0,
            damaged_page: None,
            held: VecDeque::new(),
            held_bytes: 0,
            doubted: 0,
            stopped: None,
            lost: None,
        }
    }

    pub(super) fn announce_channels(&mut self) {
        for channel in self.tables.channels.values() {
            self.visit.channel(channel);
        }
    }

    pub(super) fn seam(&mut self) {
        self.visit.seam();
    }

    /// Reads every message, in order of time; of a damaged file in order of rows.
    pub(super) fn whole(&mut self) {
        if self.damaged_page.is_none() {
            let result = if self.tables.indexed {
                let sql = select("ORDER BY timestamp, rowid");
                self.run(&sql, [], Self::in_order)
            } else {
                self.sorted()
            };
            let Err(why) = result else { return };
            self.stopped = Some(why);
        }
        // The damage may be in the index only, and the messages intact; so may those after a damaged page.
        for _ in 0..MAX_LOSSES {
            self.seam();
            let behind = self.largest_row.saturating_add(1);
            let Some(from) = self.readable_from(behind) else { return };
            self.miss(behind, from);
            let sql = select("WHERE rowid >= ?1 ORDER BY rowid");
            let result = self.run(&sql, [from], |pass, row| {
                let at = row_number(row)?;
                if at <= pass.largest_row {
                    return Err("its rows are out of order".to_owned());
                }
                let next = pass.largest_row.saturating_add(1);
                if at > next && at > from {
                    // SQLite skipped pages without an error.
                    pass.settle(false);
                    pass.seam();
                    pass.miss(next, at);
                    pass.stopped.get_or_insert("they are missing".to_owned());
                }
                pass.deliver(row)
            });
            self.settle(result.is_ok());
            let Err(why) = result else { return };
            self.stopped = Some(why);
            if self.largest_row < from {
                return;
            }
        }
    }

    /// Notes that rows from `behind` on, up to `from`, were not read, where some were read before.
    fn miss(&mut self, behind: i64, from: i64) {
        if from > behind && self.largest_row > i64::MIN {
            let (first, count) = self.lost.unwrap_or(((behind, from - 1), 0));
            self.lost = Some((first, count + 1));
        }
    }

    /// The first row from `from` on that can be read; `None` where there is none.
    fn readable_from(&self, from: i64) -> Option<i64> {
        let sql = select("WHERE rowid >= ?1 ORDER BY rowid LIMIT 1");
        // The next row: an error where it cannot be read, `None` where there is none.
        let found = |row: i128| -> Result<Option<i64>, ()> {
            let row = i64::try_from(row).map_err(|_| ())?;
            let mut statement = self.connection.prepare(&sql).map_err(|_| ())?;
            let mut rows = statement.query([row]).map_err(|_| ())?;
            let first = rows.next().map_err(|_| ())?;
            first.map(|row| row_number(row).map_err(|_| ())).transpose()
        };
        let from = i128::from(from);
        if let Ok(row) = found(from) {
            return row;
        }
        // Pages hold consecutive rows: the readable ones begin at some distance.
        let readable = |distance: &i128| found(from + distance).is_ok();
        let mut far = (0..64).map(|power| 1_i128 << power).find(readable)?;
        let mut near = far / 2;
        while far - near > 1 {
            let middle = i128::midpoint(near, far);
            if readable(&middle) {
                far = middle;
            } else {
                near = middle;
            }
        }
        found(from + far).ok().flatten()
    }

    /// Reads every message of a database without an index: sorts the row numbers, then fetches row by row. Sorting the
    /// messages themselves would write them all to a temporary file.
    fn sorted(&mut self) -> Result<(), String> {
        let words = |error: rusqlite::Error| error.to_string();
        let connection = self.connection;
        let mut fetch = connection.prepare(&select("WHERE rowid = ?1")).map_err(words)?;
        let mut order = connection
            .prepare("SELECT rowid FROM messages ORDER BY timestamp, rowid")
            .map_err(words)?;
        let mut rows = order.query([]).map_err(words)?;
        while let Some(row) = rows.next().map_err(words)? {
            let mut found = fetch.query([row_number(row)?]).map_err(words)?;
            if let Some(row) = found.next().map_err(words)? {
                self.in_order(row)?;
            }
        }
        Ok(())
    }

    /// Runs a query and passes on its rows one by one.
    pub(super) fn run(
        &mut self,
        sql: &str,
        parameters: impl Params,
        mut take: impl FnMut(&mut Self, &Row<'_>) -> Result<Flow, String>,
    ) -> Result<(), String> {
        let words = |error: rusqlite::Error| error.to_string();
        let connection = self.connection;
        let mut statement = connection.prepare(sql).map_err(words)?;
        let mut rows = statement.query(parameters).map_err(words)?;
        while let Some(row) = rows.next().map_err(words)? {
            if take(self, row)? == Flow::Enough {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Delivers a row that must come after the last one. A damaged index may contain a cycle.
    pub(super) fn in_order(&mut self, row: &Row<'_>) -> Result<Flow, String> {
        let key = (time(row).unwrap_or(i64::MIN), row_number(row)?);
        if time(row).is_some() && self.last.is_some_and(|last| key <= last) {
            return Err("its messages are out of order".to_owned());
        }
        self.deliver(row)
    }

    /// Delivers a row as [`select`] gives it.
    pub(super) fn deliver(&mut self, row: &Row<'_>) -> Result<Flow, String> {
        let at = row_number(row)?;
        self.largest_row = self.largest_row.max(at);
        let size = match row.get_ref(3) {
            Ok(ValueRef::Integer(size)) => u64::try_from(size).unwrap_or(0),
            _ => 0,
        };
        let Some(log_ns) = time(row) else {
            self.unfit += 1;
            return Ok(Flow::Go);
        };
        self.last = Some((log_ns, at));
        if size > MAX_MESSAGE {
            self.too_large += 1;
            return Ok(Flow::Go);
        }
        let data = match row.get_ref(4) {
            Ok(ValueRef::Blob(data) | ValueRef::Text(data)) => data,
            Ok(_) => {
                self.unfit += 1;
                return Ok(Flow::Go);
            }
            Err(error) => return Err(error.to_string()),
        };
        if self.last_page.as_ref().is_some_and(|page| page.is_cut_off(data)) {
            self.cut_off += 1;
            return Ok(Flow::Go);
        }
        let topic = match row.get_ref(1) {
            Ok(ValueRef::Integer(topic)) if self.tables.channels.contains_key(&topic) => topic,
            _ => {
                self.orphans += 1;
                return Ok(Flow::Go);
            }
        };
        let Some(page) = self.damaged_page else {
            self.hand_on(topic, log_ns, data);
            return Ok(Flow::Go);
        };
        self.held_bytes += data.len();
        self.held.push_back((topic, log_ns, data.to_vec()));
        while let Some((_, _, first)) = self.held.front()
            && self.held_bytes - first.len() >= page
        {
            self.use_held();
        }
        Ok(Flow::Go)
    }

    /// Uses the held messages, if what follows them could be read.
    fn settle(&mut self, is_whole: bool) {
        if !is_whole {
            self.doubted += self.held.len() as u64;
            self.held.clear();
            self.held_bytes = 0;
        }
        while !self.held.is_empty() {
            self.use_held();
        }
    }

    fn use_held(&mut self) {
        if let Some((topic, log_ns, data)) = self.held.pop_front() {
            self.held_bytes -= data.len();
            self.hand_on(topic, log_ns, &data);
        }
    }

    fn hand_on(&mut self, topic: i64, log_ns: i64, data: &[u8]) {
        let Some(channel) = self.tables.channels.get(&topic) else {
            return;
        };
        self.messages += 1;
        self.bytes += data.len() as u64;
        self.visit.message(channel, &Message { log_ns, data });
        if self.bytes >= self.last_progress + PROGRESS_STEP {
            self.last_progress = self.bytes;
            (self.progress)(self.bytes.min(self.total), self.total);
        }
    }
}

/// The remaining bytes of the last page of a file that was cut off, up to its last byte that is not zero.
#[derive(Debug)]
pub(super) struct LastPage {
    bytes: Vec<u8>,
    /// Bytes of a page.
    size: usize,
}

/// Bytes before the cut by which a long message is known to reach into the last page.
const MOST_KNOWN: usize = 64;
/// Bytes of a page of a long message that are not its own: the number of the next page.
const NEXT_PAGE: usize = 4;

impl LastPage {
    pub(super) fn new(mut bytes: Vec<u8>, size: usize) -> Self {
        let end = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
        bytes.truncate(end);
        Self { bytes, size }
    }

    /// Whether a message has zeros where the file ends: it begins in the last page, or the last page is one of its pages.
    fn is_cut_off(&self, data: &[u8]) -> bool {
        let end = data.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
        let (message_end, zeros) = data.split_at(end);
        if !zeros.is_empty() && self.bytes.ends_with(message_end) {
            return true;
        }
        let from = NEXT_PAGE.max(self.bytes.len().saturating_sub(MOST_KNOWN));
        let Some(known) = self.bytes.get(from..).filter(|known| !known.is_empty()) else {
            return false;
        };
        let of_page = self.size.saturating_sub(self.bytes.len());
        memchr::memmem::find_iter(data, known).any(|at| {
            let behind = data.get(at + known.len()..).unwrap_or_default();
            let behind = behind.get(..of_page).unwrap_or(behind);
            !behind.is_empty() && behind.iter().all(|byte| *byte == 0)
        })
    }
}

pub(super) fn row_number(row: &Row<'_>) -> Result<i64, String> {
    match row.get_ref(0) {
        Ok(ValueRef::Integer(number)) => Ok(number),
        _ => Err("a row without a number".to_owned()),
    }
}

/// The time of a row, nanoseconds.
pub(super) fn time(row: &Row<'_>) -> Option<i64> {
    match row.get_ref(2) {
        Ok(ValueRef::Integer(time)) => Some(time),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_that_goes_on_behind_the_end_is_known_by_the_zeros() {
        let page = LastPage::new([&[0, 0, 0, 9], &[7; 20][..], &[5, 6, 0, 0]].concat(), 64);
        // A short message that begins in the page.
        assert!(page.is_cut_off(&[7, 7, 5, 6, 0, 0, 0]));
        assert!(page.is_cut_off(&[0; 12]));
        assert!(!page.is_cut_off(&[7, 7, 5, 6]));
        assert!(!page.is_cut_off(&[7, 7, 5, 6, 0, 1]));
        // A long one, one of whose pages it is.
        let long = [&[1; 100][..], &[7; 20], &[5, 6], &[0; 38], &[3; 10]].concat();
        assert!(page.is_cut_off(&long));
        assert!(!page.is_cut_off(&long[..122]));
        assert!(!page.is_cut_off(&[&long[..130], &[1; 50]].concat()));
    }
}
