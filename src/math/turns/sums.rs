//! Sums over windows: turns by the orientation compared with turns by the gyro.

use nalgebra::{Matrix3, Vector3};

use super::Score;
use super::windows::{Window, WindowTurn};
use crate::math::readings::Reading;
use crate::math::rotation::singular_values;

/// How one reading agrees with the gyro at one lag.
#[derive(Clone, Copy)]
pub(super) struct Agreement {
    /// As in [`Score::r2`].
    r2: f64,
    /// The sum of the singular values of sum s d^T, over sqrt(sum d . d sum s . s): the correlation under the rotation
    /// or mirror that fits it best (Kabsch 1976), over all windows.
    explained: f64,
}

/// The lags, in steps, of the largest R2 and of the largest share explained so far.
#[derive(Clone, Copy, Default)]
pub(super) struct BestLags {
    r2: Option<(i32, f64)>,
    explained: Option<(i32, f64)>,
}

impl BestLags {
    pub(super) fn offer(&mut self, lag: i32, at_lag: Agreement) {
        for (held, value) in [(&mut self.r2, at_lag.r2), (&mut self.explained, at_lag.explained)] {
            // Of equal lags the one nearer to 0. Nothing that is not finite is held.
            let better = held.is_none_or(|(at, best)| value > best || (value >= best && lag.abs() < i32::abs(at)));
            if value.is_finite() && better {
                *held = Some((lag, value));
            }
        }
    }

    /// The largest R2.
    pub(super) fn r2(&self) -> f64 {
        self.r2.map_or(f64::NEG_INFINITY, |(_, r2)| r2)
    }

    /// The lag of the largest R2; 0 without one.
    pub(super) fn lag(&self) -> i32 {
        self.r2.map_or(0, |(lag, _)| lag)
    }

    /// The largest share explained.
    pub(super) fn explained(&self) -> f64 {
        self.explained.map_or(0.0, |(_, explained)| explained)
    }

    /// The lag of the largest share explained; 0 without one.
    pub(super) fn match_lag(&self) -> i32 {
        self.explained.map_or(0, |(lag, _)| lag)
    }
}

/// The agreement of each reading over windows with the gyro's turns over them.
pub(super) fn agreement<'a>(windows: impl Iterator<Item = &'a Window>, turned: &[WindowTurn]) -> [Agreement; 4] {
    let n = turned.len() as f64;
    let (mut g_sum, mut gg, mut ss) = (Vector3::zeros(), 0.0, 0.0);
    let mut sums = [(Vector3::zeros(), 0.0, Matrix3::zeros(), 0.0); 4];
    for (window, gyro) in windows.zip(turned) {
        g_sum += gyro.turn;
        gg += gyro.turn.norm_squared();
        ss += gyro.plain.norm_squared();
        for ((e_sum, ee, cross, dd), d) in sums.iter_mut().zip(&window.turns) {
            let e = d - gyro.turn;
            *e_sum += e;
            *ee += e.norm_squared();
            *cross += gyro.plain * d.transpose();
            *dd += d.norm_squared();
        }
    }
    let about_mean = |sum: Vector3<f64>, squares: f64| squares - sum.norm_squared() / n;
    sums.map(|(e_sum, ee, cross, dd)| Agreement {
        r2: 1.0 - about_mean(e_sum, ee) / about_mean(g_sum, gg),
        explained: singular_values(&cross).map_or(f64::NAN, |s| s.iter().sum::<f64>() / f64::sqrt(dd * ss)),
    })
}

/// Sums over windows of the turns of one reading and of the gyro.
#[derive(Default)]
struct Sums {
    n: f64,
    gg: f64,
    dd: f64,
    ee: f64,
    ss: f64,
    ds: f64,
    cross: Matrix3<f64>,
    d: Vector3<f64>,
    s: Vector3<f64>,
    d2: Vector3<f64>,
    s2: Vector3<f64>,
    ds_axis: Vector3<f64>,
}

impl Sums {
    fn add(&mut self, d: &Vector3<f64>, gyro: &WindowTurn) {
        let (g, s) = (gyro.turn, gyro.plain);
        self.n += 1.0;
        self.gg += g.norm_squared();
        self.dd += d.norm_squared();
        self.ee += (d - g).norm_squared();
        self.ss += s.norm_squared();
        self.ds += d.dot(&s);
        self.cross += g * d.transpose();
        self.d += d;
        self.s += s;
        self.d2 += d.component_mul(d);
        self.s2 += s.component_mul(&s);
        self.ds_axis += d.component_mul(&s);
    }

    fn residual(&self) -> f64 {
        (self.ee / self.gg).sqrt()
    }

    /// The standard deviation of d - s about each axis, radians.
    fn axis_residual(&self) -> [f64; 3] {
        let mean = (self.d - self.s) / self.n;
        let squares = (self.d2 + self.s2 - 2.0 * self.ds_axis) / self.n - mean.component_mul(&mean);
        squares.map(|square| square.max(0.0).sqrt()).into()
    }

    fn axis_correlation(&self) -> [Option<f64>; 3] {
        let about =
            |products: &Vector3<f64>, a: &Vector3<f64>, b: &Vector3<f64>| products - a.component_mul(b) / self.n;
        let (d2, s2) = (about(&self.d2, &self.d, &self.d), about(&self.s2, &self.s, &self.s));
        let correlation = about(&self.ds_axis, &self.d, &self.s).component_div(&d2.component_mul(&s2).map(f64::sqrt));
        correlation.map(|r| r.is_finite().then(|| r.clamp(-1.0, 1.0))).into()
    }
}

/// The gyro's turns at the three lags that matter to a reading.
pub(super) struct LagTurns<'a> {
    pub(super) still: &'a [WindowTurn],
    pub(super) best: (f64, &'a [WindowTurn]),
    pub(super) matched: (f64, &'a [WindowTurn]),
}

/// The part of the turning that a reading explains whose axes are the gyro's.
const MIN_R2: f64 = 0.9;
/// The share that is explained under the best axes, from which on a gyro that no reading explains has other axes.
const OTHER_AXES: f64 = 0.8;

/// The bias of the gyro, rad/s: how far on the whole the gyro turns beyond the orientation, by the reading that makes it the
/// smallest: a steady turn under a wrong reading looks like a larger one. Zero where it is larger than a bias may be about an
/// axis, and where the gyro is explained only under other axes: the residual then is no bias.
pub(super) fn bias(windows: &[Window], by_reading: &[(BestLags, &[WindowTurn]); 4], limit_rad_s: f64) -> Vector3<f64> {
    let (r2, explained) = by_reading.iter().fold((0.0, 0.0), |(r2, explained), (best, _)| {
        (f64::max(r2, best.r2()), f64::max(explained, best.explained()))
    });
    if r2 < MIN_R2 && explained >= OTHER_AXES {
        return Vector3::zeros();
    }
    let biases = by_reading.iter().enumerate().map(|(index, (_, turned))| {
        let (mut drift, mut time_s) = (Vector3::zeros(), 0.0);
        for (window, gyro) in windows.iter().zip(*turned) {
            drift += gyro.turn - window.turns.get(index).copied().unwrap_or_default();
            time_s += window.length_s();
        }
        drift / time_s
    });
    let least = biases.min_by(|a, b| a.norm().total_cmp(&b.norm()));
    least.filter(|bias| bias.amax() <= limit_rad_s).unwrap_or_default()
}

/// The result of the reading with this index among [`Reading::ALL`].
pub(super) fn score(windows: &[Window], active: &[bool], index: usize, lags: &LagTurns) -> Score {
    let sums = |turned: &[WindowTurn]| {
        let (mut sums, mut drift, mut time_s) = (Sums::default(), Vector3::zeros(), 0.0);
        for ((window, gyro), active) in windows.iter().zip(turned).zip(active) {
            let Some(d) = window.turns.get(index) else { continue };
            drift += gyro.turn - d;
            time_s += window.length_s();
            if *active {
                sums.add(d, gyro);
            }
        }
        (sums, drift / time_s)
    };
    let r2 = agreement(windows.iter(), lags.best.1)
        .get(index)
        .map_or(f64::NAN, |a| a.r2);
    let (at_best, bias_rad_s) = sums(lags.best.1);
    let (at_match, _) = sums(lags.matched.1);
    Score {
        reading: Reading::ALL.get(index).copied().unwrap_or(Reading::Xyzw),
        lag_s: lags.best.0,
        r2: if r2.is_finite() { r2 } else { f64::NAN },
        residual: at_best.residual(),
        residual_without_lag: sums(lags.still).0.residual(),
        bias_rad_s,
        match_lag_s: lags.matched.0,
        gain: at_match.ds / at_match.ss,
        gain_correlation: at_match.ds / (at_match.dd * at_match.ss).sqrt(),
        axis_correlation: at_match.axis_correlation(),
        axis_residual_rad: at_match.axis_residual(),
        cross: at_match.cross,
        gyro_power: at_match.gg,
        turn_power: at_match.dd,
    }
}
