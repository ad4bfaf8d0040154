//! The same work on many items, on all cores; on the spot where there is only one item, so that a short run does not
//! pay for threads.

use rayon::prelude::*;

/// Maps items to results in order.
pub(super) fn map<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    if items.len() < 2 {
        items.into_iter().map(work).collect()
    } else {
        items.into_par_iter().map(work).collect()
    }
}
