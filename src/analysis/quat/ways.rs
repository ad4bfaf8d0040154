//! What the windows of an orientation and a gyro say: which way of reading them fits.
//!
//! Owns the comparisons, by the limits of QUAT01's page. Must not judge.

use nalgebra::Matrix3;
use serde::Deserialize;

use crate::analysis::axes::causes::{Readings, Turn};
use crate::analysis::quat::by_gyro::Ordered;
use crate::math::turns::{Score, Turns};
use crate::math::{readings::Reading, rotation::singular_values};

/// An axis of which it cannot be told whether the orientation follows its gyro about it.
pub(crate) struct Unclear;

/// The windows with the scores of the readings.
pub(crate) struct Ways<'a> {
    pub(crate) turns: &'a Turns,
    pub(crate) as_published: Score,
    pub(crate) inverse: Score,
    reordered: Score,
    /// Every way with a name but the published one, with its residual, the best first.
    others: Vec<(Turn, f64)>,
    /// The smallest residual of the other readings of the four numbers.
    readings: f64,
    /// The smallest residual of the gyro's other axes that have no name.
    unnamed: f64,
}

impl<'a> Ways<'a> {
    /// `None` where a score is missing.
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

    /// How well the orientation as published or its inverse follows the gyro, whatever its unit.
    pub(crate) fn follows(&self) -> f64 {
        let of = |score: &Score| score.gain_correlation.abs();
        of(&self.as_published).max(of(&self.inverse))
    }

    /// The residual of the best way that is not the published one.
    pub(crate) fn best(&self) -> f64 {
        self.others.first().map_or(f64::NAN, |way| way.1)
    }

    /// Whether these are few windows.
    pub(crate) fn covers_little(&self, limits: &Limits) -> bool {
        self.turns.covered_s < limits.slow_s
    }

    /// The residual of what was found: as published, or of the best other way.
    pub(crate) fn explains(&self, class: Turn) -> f64 {
        match class {
            Turn::Agree | Turn::Tilting => self.as_published.residual,
            _ => self.best(),
        }
    }

    /// What was seen, by these windows.
    pub(crate) fn found(&self, class: Turn, axis: Option<usize>, limits: &Limits) -> Turned {
        let is_slow = self.by_ratio(limits).is_none() && !matches!(class, Turn::Unrelated | Turn::Ordered);
        Turned {
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

    /// How many axes turn fast enough to speak.
    fn speaking(&self, limits: &Limits) -> usize {
        let speaks = |rms: &&f64| rms.to_degrees() >= limits.axis_deg_s;
        self.turns.axis_rms_rad_s.iter().filter(speaks).count()
    }

    /// Whether another reading of the four numbers is the simpler explanation.
    pub(crate) fn is_simpler(&self, limits: &Limits) -> bool {
        self.readings < limits.agrees
    }

    /// Whether every way with a name, the simpler faults, explains less than something else that leaves this residual.
    pub(crate) fn are_worse(&self, residual: f64, limits: &Limits) -> bool {
        self.best() >= limits.ratio * residual.max(limits.noise)
    }

    /// Whether the orientation may not follow about an axis, though it does about another, noise or not.
    pub(crate) fn has_odd_axis(&self, limits: &Limits) -> bool {
        let correlation = self.as_published.axis_correlation;
        let fits = correlation.iter().flatten().any(|value| *value > limits.axis_right);
        let mut axes = correlation.iter().zip(self.turns.axis_rms_rad_s);
        fits && axes.any(|(correlation, rms)| {
            correlation.is_some_and(|value| value < limits.axis_wrong) && rms.to_degrees() >= limits.axis_deg_s
        })
    }

    /// The way whose residual is small, the others' being some times as large.
    pub(crate) fn by_ratio(&self, limits: &Limits) -> Option<Turn> {
        let own = self.as_published.residual;
        // Of a straight drive to the west the inverse orientation pitches and rolls as the right one.
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

    /// The way that explains the turning, the noise of the orientation aside: noise adds the same square to every residual, so
    /// what counts is how far their squares are apart.
    pub(crate) fn by_gap(&self, limits: &Limits) -> Option<Turn> {
        let (own, best) = (self.as_published.residual.powi(2), self.best().powi(2));
        if own <= limits.slow_agrees && self.readings.powi(2) - own >= limits.slow_gap && own - best < limits.slow_gap {
            // Where the turning is mostly about one axis, other axes of the gyro serve nearly as well: not better, though.
            return (own - best < limits.slow_alike).then(|| self.agreement(limits));
        }
        if best > limits.slow_agrees || own - best < limits.slow_gap {
            return None;
        }
        self.one_of(|residual| residual.powi(2) - best < limits.slow_gap, true)
    }

    /// How the published orientation agrees: with the yaw, or not so that it would tell.
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

    /// The way that alone is as good as the best; where several are, that they turn the other way, if they all do.
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

    /// Why it cannot be told how the orientation turns.
    pub(crate) fn unclear(&self, limits: &Limits) -> String {
        let percent = |residual: f64| format!("{:.0} %", 100.0 * residual);
        let own = percent(self.as_published.residual);
        let best = self.best().min(self.unnamed);
        if best >= limits.agrees || self.as_published.residual < limits.ratio * best.max(limits.noise) {
            return format!(
                "neither follows the other clearly: {own} of the turning is left unexplained as published, {} by the best other reading",
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
            "{own} of the turning is left unexplained as published, and these explain it alike: {}; it turns about too few axes to tell",
            ways.join(", ")
        )
    }

    /// The ways that are as good as the best, where readings of the four numbers are among them.
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

    /// Whether the orientation turns, and not as the gyro does under any reading.
    pub(crate) fn is_unrelated(&self, slow: Option<&Self>, limits: &Limits) -> bool {
        let follows = self.turns.scores.iter().map(explained);
        let own = self.as_published;
        let turned_deg = self.of_window(own.turn_power).sqrt().to_degrees();
        // A gyro in degrees has a bias as large as a turn, and nothing turns; the noise of an orientation is no turn either, and is as large
        // in a long window as in a short one. But no noise turns so far.
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

    /// The part of a sum of squares that falls to one window.
    fn of_window(&self, power: f64) -> f64 {
        power / self.turns.active.max(1) as f64
    }

    /// The square of what the orientation as published leaves of the gyro's turn in one window.
    fn remains_of_window(&self) -> f64 {
        self.of_window(self.as_published.residual.powi(2) * self.as_published.gyro_power)
    }

    /// Whether the orientation, noise and all, hardly turns where the gyro does.
    pub(crate) fn is_still(&self, limits: &Limits) -> bool {
        let own = self.as_published;
        own.turn_power < limits.standing * own.gyro_power && self.rotation_deg() >= limits.unrelated_deg
    }

    /// Whether no reading, no other axes and no turn of them explains these windows and longer ones, though noise does not hide it: the noise
    /// of an orientation is as large in a long window as in a short one, and a turn that is not the gyro's grows.
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

    /// For an orientation that follows its gyro on the whole, the axis about which it does not, if there is one; an error where
    /// that cannot be told of an axis that turns.
    pub(crate) fn axis(&self, class: Turn, limits: &Limits) -> Result<Option<usize>, Unclear> {
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
        // Turning about one axis leaks into the others: scale, misalignment and the ends of windows.
        let largest = self.turns.axis_rms_rad_s.into_iter().fold(0.0, f64::max);
        let axes = score.axis_correlation.iter().zip(self.turns.axis_rms_rad_s).enumerate();
        let turning = axes.filter(|(_, (_, rms))| {
            rms.to_degrees() >= limits.axis_deg_s
                && rms * window_s >= limits.axis_noise * noise_rad
                && *rms >= limits.axis_share * largest
        });
        let mut unclear = false;
        // What so many windows may leave of a correlation by chance.
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
        if unclear { Err(Unclear) } else { Ok(None) }
    }
}

/// What a way of reading is, in a list of them.
fn words(turn: Turn) -> &'static str {
    match turn {
        Turn::Inverse => "the inverse orientation",
        Turn::Reordered => "its numbers read as w, x, y, z",
        Turn::ReorderedInverse => "its numbers read as w, x, y, z, of the inverse",
        Turn::Frd => "a gyro or a body in FRD",
        Turn::Negated => "a negated gyro",
        Turn::Yaw => "a yaw that turns the other way",
        _ => "another reading",
    }
}

fn is_map(turn: Turn) -> bool {
    matches!(turn, Turn::Frd | Turn::Negated | Turn::Yaw)
}

fn is_reordered(turn: Turn) -> bool {
    matches!(turn, Turn::Reordered | Turn::ReorderedInverse)
}

/// The correlation of the orientation's turns with the gyro's under the rotation or mirror that serves it best (Kabsch 1976):
/// 0 to 1.
fn explained(score: &Score) -> f64 {
    let sum = singular_values(&score.cross).map_or(0.0, |values| values.iter().sum::<f64>());
    let power = (score.gyro_power * score.turn_power).sqrt();
    if power > 0.0 { sum / power } else { 0.0 }
}

/// Residuals of the gyro with other axes: FRD, negated and with z alone negated have a name. Its own axes are left out.
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

/// What was seen.
pub(crate) struct Turned {
    pub(crate) class: Turn,
    pub(crate) as_published: Score,
    pub(crate) inverse: Score,
    pub(crate) reordered: Score,
    /// The smallest residual of the gyro with axes that have no name.
    pub(crate) other_axes: f64,
    pub(crate) windows: usize,
    pub(crate) rotation_deg: f64,
    /// The largest residual that agrees, in the windows that told.
    pub(crate) limit: f64,
    /// The axis about which it does not follow, of those that turn.
    pub(crate) axis: Option<usize>,
    /// The order of angles behind it, where the gyro shows another than that of ROS.
    pub(crate) ordered: Option<Ordered>,
    /// How many axes turn fast enough to speak.
    pub(crate) speaking: usize,
    /// Root mean square of the rate about each axis, rad/s.
    pub(crate) axis_rms_rad_s: [f64; 3],
}

impl Turned {
    /// Whether another order of angles would have shown: it turns about several axes.
    pub(crate) fn shows_order(&self) -> bool {
        self.speaking > 1
    }

    /// Root mean square of the rate about each axis, degrees a second.
    pub(crate) fn rates_deg_s(&self) -> [f64; 3] {
        self.axis_rms_rad_s.map(f64::to_degrees)
    }

    /// Of orientation and gyro about each axis.
    pub(crate) fn correlations(&self) -> [Option<f64>; 3] {
        self.as_published.axis_correlation
    }
}
