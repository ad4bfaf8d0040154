//! The same work on many items, on all cores; a single item is processed without threads, to save their cost in short runs.

use rayon::prelude::*;

/// Maps items to results in order.
pub(super) fn map<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    if items.len() < 2 {
        items.into_iter().map(work).collect()
    } else {
        items.into_par_iter().map(work).collect()
    }
}
