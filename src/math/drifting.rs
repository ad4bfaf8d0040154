//! Fitting a plane track whose heading drifts evenly onto another one.
//!
//! Owns the additional parameter of such a fit, a turn rate. Must not know which list is odometry, nor how much it may drift.
//! Metres, radians, seconds. Source: Gauss-Newton on the rate; for each rate the rest is [`fit_similarities`].

use nalgebra::{Rotation2, Vector2};

use super::similarity2::{Similarities, Similarity2, fit_similarities};

/// Steps of Gauss-Newton: the first is right to the square of the angle drifted.
const STEPS: usize = 3;

/// As [`fit_similarities`], of a source whose heading may have drifted by up to `most_rad_s`, evenly since the first point: each of
/// the two fits is that of the source after removing the drift that minimises its residual.
///
/// `None` as there, and for as many times as there are no points.
pub fn fit_drifting(
    times_s: &[f64],
    source_m: &[Vector2<f64>],
    target_m: &[Vector2<f64>],
    most_rad_s: f64,
) -> Option<Similarities> {
    if times_s.len() != source_m.len() {
        return None;
    }
    let [(proper, _), (improper, _)] = fits(times_s, source_m, target_m, most_rad_s)?;
    Some(Similarities {
        proper,
        improper,
        count: source_m.len(),
    })
}

/// The source laid over the target by the two fits of [`fit_drifting`], turned and mirrored, with the drift taken off: metres of the target.
pub fn aligned_drifting(
    times_s: &[f64],
    source_m: &[Vector2<f64>],
    target_m: &[Vector2<f64>],
    most_rad_s: f64,
) -> Option<[Vec<Vector2<f64>>; 2]> {
    if times_s.len() != source_m.len() {
        return None;
    }
    let drift = |(fit, rate): (Similarity2, f64)| {
        let track = turning(times_s, source_m, rate);
        track.iter().map(|place| fit.apply(place)).collect()
    };
    Some(fits(times_s, source_m, target_m, most_rad_s)?.map(drift))
}

/// The best fit of each sense with the rate of turn that is taken off before it, rad/s.
fn fits(
    times_s: &[f64],
    source_m: &[Vector2<f64>],
    target_m: &[Vector2<f64>],
    most_rad_s: f64,
) -> Option<[(Similarity2, f64); 2]> {
    let straight = fit_similarities(source_m, target_m)?;
    let best = |of: fn(&Similarities) -> Similarity2| {
        let (mut fits, mut rate) = (straight, 0.0);
        let (mut track, mut best) = (source_m.to_vec(), (of(&straight), 0.0));
        for _ in 0..STEPS {
            let Some(step) = step(times_s, &track, target_m, &of(&fits), of) else {
                break;
            };
            rate = (rate + step).clamp(-most_rad_s, most_rad_s);
            track = turning(times_s, source_m, rate);
            let Some(next) = fit_similarities(&track, target_m) else {
                break;
            };
            fits = next;
            if of(&fits).sse_m2 < best.0.sse_m2 {
                best = (of(&fits), rate);
            }
        }
        best
    };
    Some([best(|fits| fits.proper), best(|fits| fits.improper)])
}

/// By how much more the track should turn, rad/s, to first order; `None` where turning it is what a fit does anyway.
fn step(
    times_s: &[f64],
    track_m: &[Vector2<f64>],
    target_m: &[Vector2<f64>],
    fit: &Similarity2,
    of: fn(&Similarities) -> Similarity2,
) -> Option<f64> {
    let moved: Vec<Vector2<f64>> = bends(times_s, track_m)
        .map(|bend| fit.linear() * bend * fit.scale)
        .collect();
    let free = of(&fit_similarities(track_m, &moved)?);
    let (mut along, mut whole) = (0.0, 0.0);
    for ((place, target), moved) in track_m.iter().zip(target_m).zip(&moved) {
        let left = moved - free.apply(place);
        along += left.dot(&(target - fit.apply(place)));
        whole += left.norm_squared();
    }
    Some(along / whole).filter(|step| step.is_finite())
}

/// How the points move for a rate of turn, metres for each rad/s: each step of the way turns by the time since the first.
fn bends<'t>(times_s: &'t [f64], track_m: &'t [Vector2<f64>]) -> impl Iterator<Item = Vector2<f64>> + 't {
    accumulated(times_s, track_m, Vector2::zeros(), |step, t_s| {
        Vector2::new(-step.y, step.x) * t_s
    })
}

/// The track, turning at a rate more than it does.
fn turning(times_s: &[f64], track_m: &[Vector2<f64>], rate_rad_s: f64) -> Vec<Vector2<f64>> {
    let first = track_m.first().copied().unwrap_or_default();
    accumulated(times_s, track_m, first, |step, t_s| {
        Rotation2::new(rate_rad_s * t_s) * step
    })
    .collect()
}

/// The sum of the steps of the way, each changed by the time in its middle since the first point.
fn accumulated<'t>(
    times_s: &'t [f64],
    track_m: &'t [Vector2<f64>],
    first: Vector2<f64>,
    changed: impl Fn(Vector2<f64>, f64) -> Vector2<f64> + 't,
) -> impl Iterator<Item = Vector2<f64>> + 't {
    let begin_s = times_s.first().copied().unwrap_or_default();
    let times = times_s.iter().zip(times_s.iter().skip(1));
    let steps = track_m.iter().zip(track_m.iter().skip(1)).zip(times);
    let places = steps.scan(first, move |place, ((from, to), (from_s, to_s))| {
        *place += changed(to - from, f64::midpoint(*from_s, *to_s) - begin_s);
        Some(*place)
    });
    std::iter::once(first).take(track_m.len().min(1)).chain(places)
}
