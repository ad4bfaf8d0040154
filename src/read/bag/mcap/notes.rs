//! What an MCAP contains besides messages: metadata records, and the names of attachments.

use std::collections::BTreeMap;

use ::mcap::records::{Record, op};

use super::fields::Fields;
use super::{FRAME_LEN, Pass, Stop};

/// Longer metadata records are skipped, bytes.
const MAX_METADATA: u64 = 1 << 20;
/// What is read of an attachment at most, bytes: its times, name and media type come first.
const ATTACHMENT_HEAD: u64 = 4096;
/// Bound on the records that the summary may point at.
const MAX_NOTES: usize = 10_000;
/// The name under which attachments are passed on.
const ATTACHMENTS: &str = "attachments";

/// What the summary says about them.
#[derive(Default)]
pub(super) struct SummaryNotes {
    /// Where metadata records start, and their length with the frame.
    metadata: Vec<(u64, u64)>,
    attachments: BTreeMap<String, String>,
}

impl SummaryNotes {
    /// Takes in a record of the summary; one that cannot be parsed affects no other.
    pub(super) fn record(&mut self, kind: u8, body: &[u8]) {
        if self.metadata.len() + self.attachments.len() >= MAX_NOTES {
            return;
        }
        match ::mcap::parse_record(kind, body) {
            Ok(Record::MetadataIndex(at)) => self.metadata.push((at.offset, at.length)),
            Ok(Record::AttachmentIndex(attachment)) => {
                self.attachments.insert(attachment.name, attachment.media_type);
            }
            _ => {}
        }
    }
}

impl Pass<'_, '_> {
    /// Passes on the records that the summary points at. Records that are not where it says are skipped.
    pub(super) fn noted(&mut self, notes: &SummaryNotes) {
        for (at, length) in &notes.metadata {
            let found = self.seek(*at).and_then(|()| self.frame());
            if let Ok((op::METADATA, len)) = found
                && len.saturating_add(FRAME_LEN) == *length
                && len <= self.total - self.at
            {
                // A read error here is reported again where it matters.
                let _ = self.note_here(op::METADATA, len);
            }
        }
        if !notes.attachments.is_empty() {
            self.channels.annotation(ATTACHMENTS, &notes.attachments);
        }
    }

    /// Reads the record of `len` bytes that starts here, passes it on and goes to its end.
    pub(super) fn note_here(&mut self, kind: u8, len: u64) -> Result<(), Stop> {
        if kind == op::METADATA && len <= MAX_METADATA {
            self.load(kind, len)?;
            if let Ok(Record::Metadata(record)) = ::mcap::parse_record(kind, &self.record) {
                self.channels.annotation(&record.name, &record.metadata);
            }
            return Ok(());
        }
        if kind == op::ATTACHMENT {
            let head = len.min(ATTACHMENT_HEAD);
            self.load(kind, head)?;
            if let Ok((name, media_type)) = attachment(&self.record) {
                self.channels
                    .annotation(ATTACHMENTS, &BTreeMap::from([(name, media_type)]));
            }
            return self.skip(len - head);
        }
        self.skip(len)
    }
}

/// Name and media type of an attachment; they follow its two times.
fn attachment(head: &[u8]) -> Result<(String, String), String> {
    let mut fields = Fields(head);
    fields.u64()?;
    fields.u64()?;
    let mut text = || {
        let length = fields.u32()?;
        fields
            .bytes(length)
            .map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    };
    Ok((text()?, text()?))
}
