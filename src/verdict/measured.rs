//! A number that a rule measured.

use serde::{Deserialize, Serialize};

/// A measured number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// What was measured ("rotation difference").
    pub what: String,
    /// The value, in `unit`.
    pub value: f64,
    /// Unit: `deg`, `m`, `s`, `1` for ratios, `count`.
    pub unit: String,
    /// The limit it was compared with, in the same unit.
    pub limit: Option<f64>,
    /// Spread of the value, in the same unit.
    pub spread: Option<f64>,
    /// Number of samples behind it.
    pub n: Option<u64>,
    /// Whether it is the angle between an orientation and what it should be; see [`Measured::turn`].
    #[serde(skip)]
    pub is_turn: bool,
}

/// A single one, where several may be given.
impl IntoIterator for Measured {
    type Item = Self;
    type IntoIter = std::iter::Once<Self>;

    fn into_iter(self) -> Self::IntoIter {
        std::iter::once(self)
    }
}

impl Measured {
    /// A number with its unit.
    pub fn new(what: impl Into<String>, value: f64, unit: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            value,
            unit: unit.into(),
            limit: None,
            spread: None,
            n: None,
            is_turn: false,
        }
    }

    /// A count of things.
    pub fn count(what: impl Into<String>, value: usize) -> Self {
        Self::new(what, value as f64, "count")
    }

    /// With the limit it was compared with.
    #[must_use]
    pub fn limit(mut self, limit: f64) -> Self {
        self.limit = Some(limit);
        self
    }

    /// An angle between a frame or an orientation and what it should be: reports add by how much it moves distant points.
    #[must_use]
    pub fn turn(mut self) -> Self {
        self.is_turn = true;
        self
    }

    /// With its spread.
    #[must_use]
    pub fn spread(mut self, spread: f64) -> Self {
        self.spread = Some(spread);
        self
    }

    /// With the number of samples.
    #[must_use]
    pub fn samples(mut self, n: u64) -> Self {
        self.n = Some(n);
        self
    }
}
