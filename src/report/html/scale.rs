//! Scales of drawings: ranges of the data, round tick values, and their spelling.
//!
//! Independent of markup.

use super::super::text::trimmed;

/// Tick steps of angles: quarters and eighths of a turn.
const OF_ANGLES: &[f64] = &[1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0];

/// A range of numbers along a length of the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// The numbers at its ends.
    pub(super) from: f64,
    pub(super) to: f64,
    /// The positions of its ends.
    pub(super) start: f64,
    pub(super) end: f64,
}

impl Scale {
    /// The position of a number.
    pub(super) fn at(&self, value: f64) -> f64 {
        self.start + (value - self.from) / (self.to - self.from) * (self.end - self.start)
    }

    /// Tick values, about `most` at most and three at least, with their spelling.
    pub(super) fn ticks(&self, unit: &str, most: usize) -> Vec<(f64, String)> {
        let rough = (self.to - self.from) / most.max(1) as f64;
        let mut step = next_step(rough, unit);
        if (self.to / step).floor() - (self.from / step).ceil() < 2.0 {
            // The next smaller step: no step is more than 2.5 times as large.
            step = next_step(step * 0.39, unit);
        }
        if !(step > 0.0 && step.is_finite()) {
            return Vec::new();
        }
        let mut decimals = 0_usize;
        let mut left = step;
        while left < 0.999_999 && decimals < 12 {
            left *= 10.0;
            decimals += 1;
        }
        let first = (self.from / step).ceil();
        (0..=2 * most)
            .map(|index| (first + index as f64) * step)
            .take_while(|value| *value <= self.to + step * 1e-9)
            .map(|value| (value, trimmed(&format!("{:.decimals$}", value + 0.0))))
            .collect()
    }
}

/// The next round step.
fn next_step(rough: f64, unit: &str) -> f64 {
    if unit == "deg" && (1.0..=360.0).contains(&rough) {
        return OF_ANGLES.iter().copied().find(|step| *step >= rough).unwrap_or(rough);
    }
    let power = 10_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    steps
        .into_iter()
        .map(|step| step * power)
        .find(|step| *step >= rough)
        .unwrap_or(rough)
}

/// The range of values with a margin; around a single value, a range of suitable size.
pub(super) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let mut bounds: Option<(f64, f64)> = None;
    for value in values.filter(|value| value.is_finite()) {
        let (low, high) = bounds.get_or_insert((value, value));
        *low = low.min(value);
        *high = high.max(value);
    }
    let (low, high) = bounds?;
    // Beyond this, differences of numbers overflow.
    if low.abs().max(high.abs()) > 1e300 {
        return None;
    }
    let least = (low.abs().max(high.abs()) * 1e-9).max(1e-9);
    let room = if high - low > least {
        (high - low) * 0.05
    } else {
        least.max(high.abs() * 0.1)
    };
    Some((low - room, high + room))
}

/// A coordinate with one decimal.
pub(super) fn place(value: f64) -> String {
    trimmed(&format!("{value:.1}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(from: f64, to: f64) -> Scale {
        Scale {
            from,
            to,
            start: 0.0,
            end: 100.0,
        }
    }

    fn spelled(scale: &Scale, unit: &str, most: usize) -> Vec<String> {
        scale.ticks(unit, most).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ends_are_where_they_should_be_and_up_may_be_down() {
        let up = Scale {
            start: 300.0,
            end: 20.0,
            ..scale(-1.0, 3.0)
        };
        assert!((up.at(-1.0) - 300.0).abs() < 1e-9 && (up.at(3.0) - 20.0).abs() < 1e-9);
        assert!((up.at(1.0) - 160.0).abs() < 1e-9);
    }

    #[test]
    fn steps_are_those_that_people_count_in() {
        assert_eq!(spelled(&scale(0.0, 10.0), "s", 5), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(
            spelled(&scale(-0.021, 0.002), "s", 6),
            ["-0.02", "-0.015", "-0.01", "-0.005", "0"]
        );
        assert_eq!(
            spelled(&scale(-190.0, 190.0), "deg", 5),
            ["-180", "-90", "0", "90", "180"]
        );
        assert_eq!(
            spelled(&scale(-68.0, 44.0), "m", 3),
            ["-60", "-40", "-20", "0", "20", "40"]
        );
        assert_eq!(spelled(&scale(-44.0, 95.0), "deg", 2), ["0", "45", "90"]);
        assert_eq!(
            spelled(&scale(1e9, 1e9 + 40.0), "s", 4).first().map(String::as_str),
            Some("1000000000")
        );
    }

    #[test]
    fn a_range_has_room_and_is_never_empty() {
        assert_eq!(range([0.0, 10.0].into_iter()), Some((-0.5, 10.5)));
        let (low, high) = range([5.0].into_iter()).unwrap_or_default();
        assert!(low < 5.0 && high > 5.0);
        let (low, high) = range([0.0].into_iter()).unwrap_or_default();
        assert!(low < 0.0 && high > 0.0 && !scale(low, high).ticks("s", 5).is_empty());
        assert_eq!(range([f64::NAN].into_iter()), None);
        assert_eq!(range([f64::MAX, f64::MIN].into_iter()), None);
    }
}
