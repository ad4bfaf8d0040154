//! Sines and cosines of a full turn.

use std::sync::OnceLock;

/// Hundredths of a degree in a turn.
pub(super) const TURN: u16 = 36_000;

/// Sine and cosine of an angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Direction {
    pub(super) sin: f32,
    pub(super) cos: f32,
}

impl Direction {
    /// Of an angle in degrees.
    #[expect(clippy::cast_possible_truncation, reason = "computed in f64, kept in f32")]
    pub(super) fn of(degrees: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self {
            sin: sin as f32,
            cos: cos as f32,
        }
    }

    /// Of the sum of two angles.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            sin: self.sin * other.cos + self.cos * other.sin,
            cos: self.cos * other.cos - self.sin * other.sin,
        }
    }
}

/// The direction of every hundredth of a degree from 0 to below 360°.
pub(super) fn turn() -> &'static [Direction] {
    static TABLE: OnceLock<Vec<Direction>> = OnceLock::new();
    TABLE.get_or_init(|| (0..TURN).map(|i| Direction::of(f64::from(i) / 100.0)).collect())
}
