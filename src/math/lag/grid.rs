//! Samples at any times to values on one grid.
//!
//! Owns the averaging and the cutting. Must not compare signals.

use super::Options;

/// Values on the grid without a hole.
pub(super) struct Segment {
    /// The number of the first value's grid point; point k is at origin + k steps.
    start: i64,
    values: Vec<f64>,
    /// The sums of all values before each one and of their squares, so that those of any piece cost nothing.
    before: Vec<(f64, f64)>,
}

/// A piece of a segment.
#[derive(Clone, Copy)]
pub(super) struct Piece<'a> {
    pub(super) values: &'a [f64],
    pub(super) sum: f64,
    pub(super) squares: f64,
}

impl Segment {
    fn new(start: i64, values: Vec<f64>) -> Segment {
        let mut sums = (0.0, 0.0);
        let mut before = vec![sums];
        before.extend(values.iter().map(|v| {
            sums = (sums.0 + v, sums.1 + v * v);
            sums
        }));
        Segment { start, values, before }
    }

    /// The number of the first grid point behind the segment.
    fn end(&self) -> i64 {
        self.start + i64::try_from(self.values.len()).unwrap_or(0)
    }

    /// The values at the grid points from..to. `None` unless all are within.
    fn piece(&self, from: i64, to: i64) -> Option<Piece<'_>> {
        let (from, to) = (
            usize::try_from(from - self.start).ok()?,
            usize::try_from(to - self.start).ok()?,
        );
        let (low, high) = (self.before.get(from)?, self.before.get(to)?);
        Some(Piece {
            values: self.values.get(from..to)?,
            sum: high.0 - low.0,
            squares: high.1 - low.1,
        })
    }
}

/// The earliest time of a signal, which becomes grid point 0.
pub(super) fn origin<S: AsRef<[(f64, f64)]>>(stretches: &[S]) -> Option<f64> {
    let times = stretches.iter().flat_map(AsRef::as_ref).map(|(t, _)| *t);
    times.filter(|t| t.is_finite()).reduce(f64::min)
}

/// The signal on the grid, in the order of time, its mean over all points removed. Where stretches overlap, the one that
/// starts later gives way.
pub(super) fn segments<S: AsRef<[(f64, f64)]>>(stretches: &[S], options: &Options, origin_s: f64) -> Vec<Segment> {
    let mut runs: Vec<(i64, Vec<f64>)> = Vec::new();
    for stretch in stretches {
        let mut run: Vec<(f64, f64)> = Vec::new();
        for &(t, value) in stretch.as_ref() {
            let sound = t.is_finite() && value.is_finite();
            let step = run.last().map(|last| t - last.0);
            if sound && step == Some(0.0) {
                continue;
            }
            if !sound || step.is_some_and(|dt| dt < 0.0 || dt > options.hole_s) {
                runs.extend(averaged(&run, options, origin_s));
                run.clear();
            }
            if sound {
                run.push((t, value));
            }
        }
        runs.extend(averaged(&run, options, origin_s));
    }
    runs.sort_by_key(|(start, _)| *start);
    let mut end = i64::MIN;
    for (start, values) in &mut runs {
        let late = usize::try_from(end.saturating_sub(*start))
            .unwrap_or(0)
            .min(values.len());
        values.drain(..late);
        *start += i64::try_from(late).unwrap_or(0);
        end = end.max(*start + i64::try_from(values.len()).unwrap_or(0));
    }
    runs.retain(|(_, values)| !values.is_empty());
    let count = runs.iter().map(|(_, values)| values.len()).sum::<usize>() as f64;
    let mean = runs.iter().flat_map(|(_, values)| values).sum::<f64>() / count;
    // The rounding error of a constant is no signal.
    let rounding = 1e-12 * mean.abs();
    let centred = |v: f64| if (v - mean).abs() <= rounding { 0.0 } else { v - mean };
    let segments = runs.into_iter();
    segments
        .map(|(start, values)| Segment::new(start, values.into_iter().map(centred).collect()))
        .collect()
}

/// The averages of the line through the samples about each grid point whose whole average is within them.
fn averaged(run: &[(f64, f64)], options: &Options, origin_s: f64) -> Option<(i64, Vec<f64>)> {
    let (&(first, _), &(last, _)) = (run.first()?, run.last()?);
    let width = options.smooth_s.max(options.grid_s);
    let number = |t_s: f64| (t_s - origin_s) / options.grid_s;
    let (start, end) = (number(first + width / 2.0).ceil(), number(last - width / 2.0).floor());
    // Far beyond any recording, and not finite for a grid without a step.
    if !(start.abs() < 1e12 && end.abs() < 1e12) || end < start {
        return None;
    }
    #[allow(clippy::cast_possible_truncation)]
    let (start, end) = (start as i64, end as i64);
    let (mut low, mut high) = (Integral::new(run), Integral::new(run));
    let values = (start..=end).map(|k| {
        let t_s = origin_s + k as f64 * options.grid_s;
        (high.to(t_s + width / 2.0) - low.to(t_s - width / 2.0)) / width
    });
    Some((start, values.collect()))
}

/// The integral of the line through samples, from the first one to times that only grow.
struct Integral<'a> {
    run: &'a [(f64, f64)],
    at: usize,
    sum: f64,
}

impl<'a> Integral<'a> {
    fn new(run: &'a [(f64, f64)]) -> Self {
        Integral { run, at: 0, sum: 0.0 }
    }

    fn to(&mut self, t_s: f64) -> f64 {
        while let (Some(&(t0, v0)), Some(&(t1, v1))) = (self.run.get(self.at), self.run.get(self.at + 1)) {
            if t_s < t1 {
                let dt = (t_s - t0).max(0.0);
                return self.sum + dt * (v0 + 0.5 * dt * (v1 - v0) / (t1 - t0));
            }
            self.sum += 0.5 * (t1 - t0) * (v0 + v1);
            self.at += 1;
        }
        self.sum
    }
}

/// The segments cut into `count` parts with equally many points.
pub(super) fn parts(segments: &[Segment], count: usize) -> Vec<Vec<Segment>> {
    let total: usize = segments.iter().map(|s| s.values.len()).sum();
    let mut parts: Vec<Vec<Segment>> = Vec::new();
    // More than a hundred parts do not improve the estimate.
    let count = count.min(100);
    for part in 0..count {
        let (from, to) = (part * total / count, (part + 1) * total / count);
        let mut before = 0;
        let mut cut = Vec::new();
        for segment in segments {
            let n = segment.values.len();
            let (low, high) = (
                from.clamp(before, before + n) - before,
                to.clamp(before, before + n) - before,
            );
            if let Some(values) = segment.values.get(low..high).filter(|v| !v.is_empty()) {
                let start = segment.start + i64::try_from(low).unwrap_or(0);
                cut.push(Segment::new(start, values.to_vec()));
            }
            before += n;
        }
        parts.push(cut);
    }
    parts
}

/// The pieces of both signals that meet when the second is `lag` grid steps late.
pub(super) fn pairs<'a>(
    first: &'a [Segment],
    second: &'a [Segment],
    lag: i64,
) -> impl Iterator<Item = (Piece<'a>, Piece<'a>)> {
    first.iter().flat_map(move |a| {
        // Both signals are in the order of time and do not overlap themselves.
        let past = second.partition_point(|b| b.end() - lag <= a.start);
        let near = second.iter().skip(past).take_while(move |b| b.start - lag < a.end());
        near.filter_map(move |b| {
            let (from, to) = (a.start.max(b.start - lag), a.end().min(b.end() - lag));
            a.piece(from, to).zip(b.piece(from + lag, to + lag))
        })
    })
}
