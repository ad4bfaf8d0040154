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
    /// What the limit asks of the value, for reports.
    #[serde(skip)]
    pub bound: Bound,
    /// Spread of the value, in the same unit.
    pub spread: Option<f64>,
    /// Number of samples behind it.
    pub n: Option<u64>,
    /// Whether it is the angle between an orientation and what it should be; see [`Measured::turn`].
    #[serde(skip)]
    pub is_turn: bool,
}

/// What a limit asks of a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bound {
    /// To be within it.
    #[default]
    Within,
    /// To reach it.
    AtLeast,
    /// To equal it.
    Expected,
}

impl Bound {
    /// The word before the limit.
    pub fn word(self) -> &'static str {
        match self {
            Self::Within => "limit",
            Self::AtLeast => "must be at least",
            Self::Expected => "expected",
        }
    }
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
            bound: Bound::Within,
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

    /// With the limit that it should reach.
    #[must_use]
    pub fn at_least(self, limit: f64) -> Self {
        Self {
            bound: Bound::AtLeast,
            ..self.limit(limit)
        }
    }

    /// With the value that it should have.
    #[must_use]
    pub fn expected(self, value: f64) -> Self {
        Self {
            bound: Bound::Expected,
            ..self.limit(value)
        }
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
