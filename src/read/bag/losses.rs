//! Which parts of a recording could not be read, and where.
//!
//! Owns the bounded list of lost parts, and the messages about them.

/// Bound on the losses that are reported one by one.
const MAX_LISTED: usize = 20;

/// A part of the file that was skipped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Loss {
    /// Everything before this byte was used.
    pub(super) from: u64,
    /// Where reading continued; `None` where it did not.
    pub(super) to: Option<u64>,
    pub(super) why: String,
}

#[derive(Debug, Default)]
pub(super) struct Losses {
    listed: Vec<Loss>,
    /// Losses beyond those that are reported.
    more: u64,
}

impl Losses {
    pub(super) fn add(&mut self, loss: Loss) {
        // Where reading ended is always reported.
        if self.listed.len() < MAX_LISTED || loss.to.is_none() {
            self.listed.push(loss);
        } else {
            self.more += 1;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.listed.is_empty()
    }

    /// How many of `total` bytes were read.
    pub(super) fn read_of(&self, total: u64) -> u64 {
        let mut read = total;
        for Loss { from, to, .. } in &self.listed {
            read = read.saturating_sub(to.unwrap_or(total).saturating_sub(*from));
        }
        read
    }

    /// One line for each loss. The one that ended the reading comes first: it says how far reading went.
    pub(super) fn lines(&self, total: u64) -> Vec<String> {
        let percent = |at: u64| 100.0 * at as f64 / total.max(1) as f64;
        let mut lines = Vec::new();
        for Loss { from, to, why } in &self.listed {
            match to {
                None => lines.insert(0, format!("read up to byte {from} of {total}: {why}")),
                Some(to) => lines.push(format!(
                    "bytes {from} to {to} (at {:.1} % of the file) were skipped: {why}",
                    percent(*from)
                )),
            }
        }
        if self.more > 0 {
            lines.push(format!("{} more parts were skipped", self.more));
        }
        lines
    }
}
