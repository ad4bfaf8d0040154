//! Choices made from bytes, so that a fuzzer finds valid files by itself, and damage that is made the same way.

/// Bytes that determine choices. After the last byte, zero is chosen.
pub struct Choices<'a>(&'a [u8]);

impl<'a> Choices<'a> {
    /// Chooses by these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// A number below `count`, which is not 0; of more than 256, two bytes choose.
    pub fn below(&mut self, count: usize) -> usize {
        let high = if count > 256 { self.byte() } else { 0 };
        (usize::from(high) * 256 + usize::from(self.byte())) % count
    }

    fn byte(&mut self) -> u8 {
        let (first, rest) = self.0.split_first().unwrap_or((&0, &[]));
        self.0 = rest;
        *first
    }

    /// One of these; there must be at least one.
    pub fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// A number of ordinary size, in thousandths.
    pub fn number(&mut self) -> f64 {
        (self.below(8001) as f64 - 4000.0) / 1000.0
    }

    /// Three of them.
    pub fn vector(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.number())
    }

    /// A rotation, `x y z w`.
    pub fn quaternion(&mut self) -> [f64; 4] {
        let parts: [f64; 4] = std::array::from_fn(|_| self.number());
        let norm = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        if norm < 1e-3 {
            [0.0, 0.0, 0.0, 1.0]
        } else {
            parts.map(|part| part / norm)
        }
    }

    /// Damages bytes in up to four ways: flipped, overwritten, doubled, removed, exchanged, truncated.
    pub fn bend(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(4) {
            let at = self.below(65536) % bytes.len().max(1);
            let end = (at + self.below(300)).min(bytes.len());
            let value = self.byte();
            match self.below(6) {
                0 => bytes[at.min(end)..end].iter_mut().for_each(|byte| *byte ^= value),
                1 => bytes[at.min(end)..end].fill(value),
                2 => {
                    let twin = bytes[at.min(end)..end].to_vec();
                    bytes.splice(end..end, twin);
                }
                3 => drop(bytes.drain(at.min(end)..end)),
                4 => {
                    let other = self.below(65536) % bytes.len().max(1);
                    if at < bytes.len() {
                        bytes.swap(at, other);
                    }
                }
                _ => bytes.truncate(at),
            }
        }
    }
}
