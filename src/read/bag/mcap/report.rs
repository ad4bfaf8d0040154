//! The report on an MCAP that could not be read in full.

use crate::source::{Place, ReadStatus, Source};

use super::{Pass, Stop};

/// What to do about a damaged file.
const HELP: &str =
    "run `mcap recover` to write what is readable into a closed file; record again if the missing messages matter";

impl Pass<'_, '_> {
    /// Where no message was read there is nothing to judge.
    pub(super) fn status_of_damage(&self) -> ReadStatus {
        if self.channels.messages == 0 {
            ReadStatus::Unreadable
        } else {
            ReadStatus::Partial
        }
    }

    /// The message about damaged chunks.
    pub(super) fn damage(&self, which: &str) -> Option<String> {
        let Stop { at, why, .. } = self.faults.first()?;
        let of = match self.faults.len() {
            1 => format!("1 chunk{which} is damaged, at byte {at}"),
            count => format!("{count} chunks{which} are damaged, the first at byte {at}"),
        };
        Some(format!("{of}: {why}"))
    }

    /// Writes down how far reading went; returns whether messages may be missing.
    pub(super) fn report(&self, stopped: Option<Stop>, indexed: Option<u64>, source: &mut Source) -> bool {
        let read = self.channels.messages;
        let promised = self.promised.or(indexed);
        source.examined.bytes = stopped.as_ref().map_or(self.used, |stop| stop.at);
        source.examined.messages = Some(read);
        let whole = Place::whole(source.id);
        let lost = promised.map(|promised| promised.saturating_sub(read + self.channels.orphans));
        let mut missing = !self.faults.is_empty() && lost != Some(0);
        if let Some(message) = self.damage("") {
            let status = self.status_of_damage();
            let lost = match lost {
                Some(0) => "; no message is missing".to_owned(),
                Some(lost) => format!("; {lost} messages were not read"),
                None => String::new(),
            };
            source.problem_with_help(status, whole.clone(), message + &lost, Some(HELP.to_owned()));
        }
        if let Some(Stop {
            at,
            why,
            loses_messages,
        }) = stopped
        {
            missing |= loses_messages;
            let status = self.status_of_damage();
            let message = format!("read up to byte {at} of {}: {why}", self.total);
            source.problem_with_help(status, whole.clone(), message, Some(HELP.to_owned()));
        } else if let Some(promised) = promised.filter(|promised| !missing && *promised != read + self.channels.orphans)
        {
            missing = promised > read;
            let message = format!("{read} messages were read, but the file's statistics say {promised}");
            source.problem(ReadStatus::Partial, whole.clone(), message);
        }
        if self.channels.orphans > 0 {
            let orphans = self.channels.orphans;
            let message = format!("{orphans} messages belong to channels that the file does not define");
            source.problem(ReadStatus::Partial, whole.clone(), message);
            missing = true;
        }
        if self.channels.redefined > 0 {
            let message = format!(
                "{} channel ids are defined twice with different contents",
                self.channels.redefined
            );
            source.problem(ReadStatus::Read, whole, message);
        }
        if read == 0 && source.detail.is_none() {
            source.detail = Some("no messages".to_owned());
        }
        missing
    }
}
