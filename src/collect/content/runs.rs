//! Runs of neighbouring messages of one topic, evenly thinned: every n-th run, n doubled where there is no more room.

/// Takes in messages in recording order.
pub(super) struct Runs<T> {
    /// Runs that are kept, with their numbers.
    kept: Vec<(u64, Vec<T>)>,
    /// How many runs are kept at most.
    most: usize,
    /// Messages of a run.
    length: usize,
    /// Every `stride`-th run is kept.
    stride: u64,
    /// The number of the current run, and how many messages it has so far.
    number: u64,
    made: usize,
}

impl<T> Runs<T> {
    pub(super) fn new(most: usize, length: usize) -> Self {
        Self {
            kept: Vec::new(),
            most,
            length,
            stride: 1,
            number: 0,
            made: 0,
        }
    }

    /// Messages were left out here: the next one is no neighbour of the last.
    pub(super) fn seam(&mut self) {
        if self.made > 0 {
            self.next();
        }
    }

    fn next(&mut self) {
        self.made = 0;
        self.number += 1;
    }

    /// Takes in a message, which is only looked at where its run is kept.
    pub(super) fn push(&mut self, make: impl FnOnce() -> T) {
        if self.made == self.length {
            self.next();
        }
        self.made += 1;
        if !self.number.is_multiple_of(self.stride) || self.most == 0 {
            return;
        }
        if self.made == 1 {
            if self.kept.len() >= self.most {
                self.stride *= 2;
                let stride = self.stride;
                self.kept.retain(|(number, _)| number.is_multiple_of(stride));
                if !self.number.is_multiple_of(stride) {
                    return;
                }
            }
            self.kept.push((self.number, Vec::with_capacity(self.length)));
        }
        if let Some((_, run)) = self.kept.last_mut().filter(|(number, _)| *number == self.number) {
            run.push(make());
        }
    }

    /// The runs with at least so many messages.
    pub(super) fn finish(self, least: usize) -> Vec<Vec<T>> {
        let runs = self.kept.into_iter().map(|(_, run)| run);
        runs.filter(|run| run.len() >= least).collect()
    }
}
