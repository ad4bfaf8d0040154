//! Comparison of an orientation with a gyro over windows: which reading of them fits.
//!
//! Owns the comparisons, by the limits of QUAT01's page. Must not judge.

use nalgebra::Matrix3;
use serde::Deserialize;

use crate::analysis::axes::causes::{Readings, Turn};
use crate::analysis::quat::by_gyro::GyroOrder;
use crate::math::turns::{Score, Turns};
use crate::math::{readings::Reading, rotation::singular_values};

/// It is unclear whether the orientation follows its gyro about an axis.
pub(crate) struct Ambiguity;

/// The windows with the scores of the readings.
pub(crate) struct WindowScores<'a> {
    pub(crate) turns: &'a Turns,
    pub(crate) as_published: Score,
    pub(crate) inverse: Score,
    reordered: Score,
    /// Every named reading except the published one, with its residual, the best first.
    others: Vec<(Turn, f64)>,
    /// The smallest residual of the other quaternion conventions.
    readings: f64,
    /// The smallest residual of the gyro with axes that have no name.
    unnamed: f64,
}

impl<'a> WindowScores<'a> {
    /// `None` if a score is missing.
    pub(crate) fn of(turns: &'a Turns) -> Option<Self> {
        let score = |reading: Reading| turns.score(reading).copied();
        let (as_published, inverse) = (score(Reading::Xyzw)?, score(Reading::Conjugate)?);
        let (reordered, reordered_inverse) = (score(Reading::Wxyz)?, score(Reading::WxyzConjugate)?);
        let mut others = vec![
            (Turn::Inverse, inverse.residual),
            (Turn::Reordered, reordered.residual),
            (Turn::ReorderedInverse, reordered_inverse.residual),
        ];
        let readings = others.iter().map(|way| way.1).fold(f64::INFINITY, f64::min);
        let (named, unnamed): (Vec<_>, Vec<_>) = maps(&as_published).into_iter().partition(|map| map.0.is_some());
        others.extend(named.into_iter().filter_map(|(turn, residual)| Some((turn?, residual))));
        let unnamed = unnamed.iter().map(|map| map.1).fold(f64::INFINITY, f64::min);
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        Some(Self {
            turns,
            as_published,
            inverse,
            reordered,
            others,
            readings,
            unnamed,
        })
    }

    /// Rotation in windows with a rate, degrees.
    pub(crate) fn rotation_deg(&self) -> f64 {
        self.turns.rotation_rad.to_degrees()
    }

    /// How well the orientation as published or its inverse follows the gyro, independent of the gyro's unit.
    pub(crate) fn follows(&self) -> f64 {
        let of = |score: &Score| score.gain_correlation.abs();
        of(&self.as_published).max(of(&self.inverse))
    }

    /// The residual of the best reading other than the published one.
    pub(crate) fn best(&self) -> f64 {
        self.others.first().map_or(f64::NAN, |way| way.1)
    }

    /// Whether these are few windows.
    pub(crate) fn covers_little(&self, limits: &Limits) -> bool {
        self.turns.covered_s < limits.slow_s
    }

    /// The residual of the class: as published, or of the best other reading.
    pub(crate) fn explains(&self, class: Turn) -> f64 {
        match class {
            Turn::Agree | Turn::Tilting => self.as_published.residual,
            _ => self.best(),
        }
    }

    /// The result of these windows.
    pub(crate) fn found(&self, class: Turn, axis: Option<usize>, limits: &Limits) -> GyroAgreement {
        let is_slow = self.by_ratio(limits).is_none() && !matches!(class, Turn::Unrelated | Turn::Ordered);
        GyroAgreement {
            class: if axis.is_some() { Turn::Partly } else { class },
            as_published: self.as_published,
            inverse: self.inverse,
            reordered: self.reordered,
            other_axes: self.unnamed,
            windows: self.turns.active,
            rotation_deg: self.rotation_deg(),
            limit: if is_slow {
                limits.slow_agrees.sqrt()
            } else {
                limits.agrees
            },
            axis,
            ordered: None,
            speaking: self.speaking(limits),
            axis_rms_rad_s: self.turns.axis_rms_rad_s,
        }
    }

    /// Number of axes that turn fast enough to be judged.
    fn speaking(&self, limits: &Limits) -> usize {
        let turns = |rms: &&f64| rms.to_degrees() >= limits.axis_deg_s;
        self.turns.axis_rms_rad_s.iter().filter(turns).count()
    }

    /// Whether another quaternion convention is the simpler explanation.
    pub(crate) fn is_simpler(&self, limits: &Limits) -> bool {
        self.readings < limits.agrees
    }

    /// Whether every named reading, the simpler faults, explains less than something else with this residual.
    pub(crate) fn are_worse(&self, residual: f64, limits: &Limits) -> bool {
        self.best() >= limits.ratio * residual.max(limits.noise)
    }

    /// Whether the orientation follows about one axis and perhaps not about another, noise aside.
    pub(crate) fn has_odd_axis(&self, limits: &Limits) -> bool {
        let correlation = self.as_published.axis_correlation;
        let fits = correlation.iter().flatten().any(|value| *value > limits.axis_right);
        let mut axes = correlation.iter().zip(self.turns.axis_rms_rad_s);
        fits && axes.any(|(correlation, rms)| {
            correlation.is_some_and(|value| value < limits.axis_wrong) && rms.to_degrees() >= limits.axis_deg_s
        })
    }

    /// The reading with a small residual, if those of the others are several times as large.
    pub(crate) fn by_ratio(&self, limits: &Limits) -> Option<Turn> {
        let own = self.as_published.residual;
        // On a straight drive to the west the inverse orientation pitches and rolls like the right one.
        if own < limits.agrees && self.readings >= limits.ratio * own.max(limits.noise) {
            return Some(self.agreement(limits));
        }
        let best = self.best();
        if best >= limits.agrees || own < limits.ratio * best.max(limits.noise) {
            return None;
        }
        let is_alike = |residual: f64| residual < limits.ratio * best.max(limits.noise);
        let found = self.one_of(is_alike, own > limits.opposes);
        let is_sound = own > limits.opposes && best <= limits.alike;
        found.or_else(|| Some(self.several(is_alike)?).filter(|_| is_sound))
    }

    /// The reading that explains the rotation apart from the orientation's noise: noise adds the same square to every residual, so the
    /// differences of the squares count.
    pub(crate) fn by_gap(&self, limits: &Limits) -> Option<Turn> {
        let (own, best) = (self.as_published.residual.powi(2), self.best().powi(2));
        if own <= limits.slow_agrees && self.readings.powi(2) - own >= limits.slow_gap && own - best < limits.slow_gap {
            // With rotation mostly about one axis, other axes of the gyro fit nearly as well, but not better.
            return (own - best < limits.slow_alike).then(|| self.agreement(limits));
        }
        if best > limits.slow_agrees || own - best < limits.slow_gap {
            return None;
        }
        self.one_of(|residual| residual.powi(2) - best < limits.slow_gap, true)
    }

    /// Whether the published orientation agrees in yaw as well, or the yaw is not measured.
    fn agreement(&self, limits: &Limits) -> Turn {
        let own = self.as_published.residual.powi(2);
        let mut yaw = self
            .others
            .iter()
            .filter(|way| way.0 == Turn::Yaw)
            .map(|way| way.1.powi(2));
        if yaw.any(|yaw| yaw - own < limits.slow_gap) {
            Turn::Tilting
        } else {
            Turn::Agree
        }
    }

    /// The reading that alone is as good as the best; if there are several, that all of them rotate the opposite way.
    fn one_of(&self, is_alike: impl Fn(f64) -> bool, opposes: bool) -> Option<Turn> {
        let alike = self.others.iter().filter(|way| is_alike(way.1)).map(|way| way.0);
        let alike: Vec<Turn> = alike.collect();
        match alike.as_slice() {
            [only] if is_map(*only) && is_alike(self.unnamed) => None,
            [only] => Some(*only),
            several if opposes && !several.iter().any(|turn| is_reordered(*turn)) => Some(Turn::Reversed),
            _ => None,
        }
    }

    /// Why the reading is unclear.
    pub(crate) fn unclear(&self, limits: &Limits) -> String {
        let percent = |residual: f64| format!("{:.0} %", 100.0 * residual);
        let own = percent(self.as_published.residual);
        let best = self.best().min(self.unnamed);
        if best >= limits.agrees || self.as_published.residual < limits.ratio * best.max(limits.noise) {
            return format!(
                "orientation and gyro do not match clearly in any convention: residual {own} as published, {} in the best other one",
                percent(self.best())
            );
        }
        let alike = |residual: f64| residual < limits.ratio * best.max(limits.noise);
        let named = self.others.iter().filter(|way| alike(way.1));
        let mut ways: Vec<String> = named
            .map(|(turn, residual)| format!("{} ({})", words(*turn), percent(*residual)))
            .collect();
        if alike(self.unnamed) {
            ways.push(format!("a gyro with other axes ({})", percent(self.unnamed)));
        }
        format!(
            "residual {own} as published, and several conventions explain it equally well: {}; record rotation about more axes",
            ways.join(", ")
        )
    }

    /// The readings that are as good as the best, if quaternion conventions are among them.
    fn several(&self, is_alike: impl Fn(f64) -> bool) -> Option<Turn> {
        let alike: Vec<Turn> = self
            .others
            .iter()
            .filter(|way| is_alike(way.1))
            .map(|way| way.0)
            .collect();
        let has_reading = alike.iter().any(|turn| !is_map(*turn));
        (alike.len() > 1 && has_reading).then(|| Turn::OneOf(Readings::of(&alike)))
    }

    /// Whether the orientation rotates, but unlike the gyro in any reading.
    pub(crate) fn is_unrelated(&self, slow: Option<&Self>, limits: &Limits) -> bool {
        let follows = self.turns.scores.iter().map(explained);
        let own = self.as_published;
        let turned_deg = self.of_window(own.turn_power).sqrt().to_degrees();
        // The bias of a gyro in degrees is as large as a turn; the noise of an orientation looks like a turn, but is as large in a long
        // window as in a short one, and has a limit.
        let grows = |of: fn(&Self) -> f64| slow.is_some_and(|slow| of(slow) >= limits.grows * of(self));
        let moves = own.turn_power >= limits.standing * own.gyro_power
            || turned_deg >= limits.moving_deg && grows(|ways| ways.of_window(ways.as_published.turn_power));
        let turns = turned_deg >= limits.turning_deg || moves && grows(Self::remains_of_window);
        own.residual > limits.unrelated
            && self.best() > limits.unrelated
            && self.rotation_deg() >= limits.unrelated_deg
            && follows.fold(0.0, f64::max) <= limits.unrelated_correlation
            && turns
    }

    /// Share of one window in a sum of squares.
    fn of_window(&self, power: f64) -> f64 {
        power / self.turns.active.max(1) as f64
    }

    /// The squared residual of the orientation as published in one window.
    fn remains_of_window(&self) -> f64 {
        self.of_window(self.as_published.residual.powi(2) * self.as_published.gyro_power)
    }

    /// Whether the orientation, including its noise, hardly rotates while the gyro does.
    pub(crate) fn is_still(&self, limits: &Limits) -> bool {
        let own = self.as_published;
        own.turn_power < limits.standing * own.gyro_power && self.rotation_deg() >= limits.unrelated_deg
    }

    /// Whether no reading, no other axes and no rotation of them explains these windows and longer ones, apart from noise: the noise of an
    /// orientation is as large in a long window as in a short one, while a rotation that is not the gyro's grows.
    pub(crate) fn is_unexplained(&self, slow: &Self, limits: &Limits) -> bool {
        let turns = |ways: &Self| {
            let own = ways.as_published;
            ways.rotation_deg() >= limits.unrelated_deg && own.turn_power >= limits.standing * own.gyro_power
        };
        let remains = |ways: &Self| {
            let least = ways.as_published.residual.min(ways.best()).min(ways.unnamed);
            let follows = ways.turns.scores.iter().map(explained).fold(0.0, f64::max);
            least > limits.unrelated && follows <= limits.unexplained_correlation
        };
        let both = [self, slow];
        both.into_iter().all(turns)
            && both.into_iter().all(remains)
            && slow.remains_of_window() >= limits.grows * self.remains_of_window()
    }

    /// For an orientation that follows its gyro overall, the axis about which it does not; an error if that is unclear for an axis that
    /// turns.
    pub(crate) fn axis(&self, class: Turn, limits: &Limits) -> Result<Option<usize>, Ambiguity> {
        if !matches!(class, Turn::Agree | Turn::Tilting) || self.turns.step_s > limits.axis_step_s {
            return Ok(None);
        }
        let score = &self.as_published;
        let axes = score.axis_correlation.iter().zip(score.axis_residual_rad);
        let right = axes.filter(|(correlation, _)| correlation.is_some_and(|value| value > limits.axis_right));
        // The noise of the orientation shows about the axis that fits best.
        let Some(noise_rad) = right.map(|(_, residual)| residual).reduce(f64::min) else {
            return Ok(None);
        };
        let window_s = self.turns.covered_s / self.turns.windows.max(1) as f64;
        // Rotation about one axis leaks into the others: scale, misalignment and the ends of windows.
        let largest = self.turns.axis_rms_rad_s.into_iter().fold(0.0, f64::max);
        let axes = score.axis_correlation.iter().zip(self.turns.axis_rms_rad_s).enumerate();
        let turning = axes.filter(|(_, (_, rms))| {
            rms.to_degrees() >= limits.axis_deg_s
                && rms * window_s >= limits.axis_noise * noise_rad
                && *rms >= limits.axis_share * largest
        });
        let mut unclear = false;
        // Correlations that so many windows may give by chance.
        let sure = |value: f64| {
            let degrees = (self.turns.active as f64 - 3.0).max(0.1);
            (value.clamp(-0.999, 0.999).atanh() + limits.axis_sigmas / degrees.sqrt()).tanh() < limits.axis_agrees
        };
        for (axis, (correlation, _)) in turning {
            match correlation {
                Some(value) if *value < limits.axis_wrong && sure(*value) => return Ok(Some(axis)),
                Some(value) if *value < limits.axis_agrees => unclear = true,
                _ => {}
            }
        }
        if unclear { Err(Ambiguity) } else { Ok(None) }
    }
}

/// A reading, for a list of them.
fn words(turn: Turn) -> &'static str {
    match turn {
        Turn::Inverse => "the inverse orientation",
        Turn::Reordered => "order w, x, y, z",
        Turn::ReorderedInverse => "order w, x, y, z, inverted",
        Turn::Frd => "a gyro or a body in FRD",
        Turn::Negated => "a negated gyro",
        Turn::Yaw => "a reversed yaw",
        _ => "another reading",
    }
}

fn is_map(turn: Turn) -> bool {
    matches!(turn, Turn::Frd | Turn::Negated | Turn::Yaw)
}

fn is_reordered(turn: Turn) -> bool {
    matches!(turn, Turn::Reordered | Turn::ReorderedInverse)
}

/// The correlation of the orientation's rotations with the gyro's under the best rotation or reflection (Kabsch 1976): 0 to 1.
fn explained(score: &Score) -> f64 {
    let sum = singular_values(&score.cross).map_or(0.0, |values| values.iter().sum::<f64>());
    let power = (score.gyro_power * score.turn_power).sqrt();
    if power > 0.0 { sum / power } else { 0.0 }
}

/// Residuals of the gyro with other axes: FRD, negated, and z alone negated have a name. Its own axes are excluded.
fn maps(as_published: &Score) -> Vec<(Option<Turn>, f64)> {
    let Some(search) = as_published.axis_search() else {
        return Vec::new();
    };
    let class = |matrix: Matrix3<f64>| {
        let is = |signs: [f64; 3]| (matrix - Matrix3::from_diagonal(&signs.into())).norm() < 0.5;
        if is([1.0, -1.0, -1.0]) {
            Some(Turn::Frd)
        } else if is([-1.0, -1.0, -1.0]) {
            Some(Turn::Negated)
        } else if is([1.0, 1.0, -1.0]) {
            Some(Turn::Yaw)
        } else {
            None
        }
    };
    let ranked = search.ranked().iter();
    let others = ranked.filter(|scored| scored.map.matrix() != Matrix3::identity());
    others
        .map(|scored| (class(scored.map.matrix()), search.residual(scored)))
        .collect()
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_rotation_deg: f64,
    pub(crate) max_step_s: f64,
    pub(crate) agrees: f64,
    pub(crate) opposes: f64,
    pub(crate) unrelated: f64,
    pub(crate) unrelated_deg: f64,
    pub(crate) ratio: f64,
    pub(crate) alike: f64,
    pub(crate) slow_agrees: f64,
    pub(crate) slow_gap: f64,
    pub(crate) slow_s: f64,
    pub(crate) slow_alike: f64,
    pub(crate) slow_short: f64,
    pub(crate) unrelated_correlation: f64,
    pub(crate) unexplained_correlation: f64,
    pub(crate) grows: f64,
    pub(crate) standing: f64,
    pub(crate) turning_deg: f64,
    pub(crate) moving_deg: f64,
    pub(crate) noise: f64,
    pub(crate) axis_deg_s: f64,
    pub(crate) axis_step_s: f64,
    pub(crate) axis_wrong: f64,
    pub(crate) axis_agrees: f64,
    pub(crate) axis_right: f64,
    pub(crate) axis_noise: f64,
    pub(crate) axis_share: f64,
    pub(crate) axis_sigmas: f64,
}

/// Whether an orientation follows its gyro.
pub(crate) struct GyroAgreement {
    pub(crate) class: Turn,
    pub(crate) as_published: Score,
    pub(crate) inverse: Score,
    pub(crate) reordered: Score,
    /// The smallest residual of the gyro with axes that have no name.
    pub(crate) other_axes: f64,
    pub(crate) windows: usize,
    pub(crate) rotation_deg: f64,
    /// The largest residual that agrees, in the windows that decided.
    pub(crate) limit: f64,
    /// The axis about which it does not follow, among those that turn.
    pub(crate) axis: Option<usize>,
    /// The order of the angles behind it, if the gyro shows another one than that of ROS.
    pub(crate) ordered: Option<GyroOrder>,
    /// Number of axes that turn fast enough to be judged.
    pub(crate) speaking: usize,
    /// Root mean square of the rate about each axis, rad/s.
    pub(crate) axis_rms_rad_s: [f64; 3],
}

impl GyroAgreement {
    /// Whether it turns about several axes, so that another order of angles would show.
    pub(crate) fn shows_order(&self) -> bool {
        self.speaking > 1
    }

    /// Root mean square of the rate about each axis, degrees a second.
    pub(crate) fn rates_deg_s(&self) -> [f64; 3] {
        self.axis_rms_rad_s.map(f64::to_degrees)
    }

    /// Correlations of orientation and gyro about each axis.
    pub(crate) fn correlations(&self) -> [Option<f64>; 3] {
        self.as_published.axis_correlation
    }
}
