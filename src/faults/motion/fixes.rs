//! Satellite fixes, and mistakes in them.

use crate::faults::{Change, Family, Subject};
use crate::math::geodesy::Geodetic;
use crate::math::geoid::undulation_m;
use crate::world::World;
use crate::world::bag::MAX_EXAMPLES;
use crate::world::content::{ContentEvidence, FixAt, FixEvidence};
use crate::world::motion::{FixRow, Series};

use super::streams::Stream;

/// What a satellite receiver states (`sensor_msgs/NavSatFix`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::faults) struct FixMessage {
    /// Degrees.
    pub(super) latitude: f64,
    /// Degrees.
    pub(super) longitude: f64,
    /// Metres above the ellipsoid.
    pub(super) altitude: f64,
}

/// A mistake in fixes.
pub(in crate::faults) enum FixChange {
    /// In each message.
    Message(fn(&mut FixMessage)),
    /// Altitudes above mean sea level, where the message is defined to have them above the ellipsoid.
    SeaLevel,
    /// Altitudes are higher, metres.
    Raised(f64),
}

impl Change for FixChange {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let is_meant = |stream: &Stream| stream.family == Family::Fix && self.can_be_of(stream);
        Stream::all(world).filter(is_meant).map(Subject::from).collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let Some(stream) = Stream::of(subject).filter(|stream| self.can_be_of(stream)) else {
            return false;
        };
        let mut is_changed = false;
        match self {
            Self::Message(change) => stream.change_contents(world, |content| {
                is_changed |= change_fixes(content, change);
            }),
            Self::Raised(metres) => stream.change_contents(world, |content| {
                is_changed |= change_fixes(content, |fix| fix.altitude += metres);
            }),
            // The undulation is the same all over a recording's site, to a few centimetres.
            Self::SeaLevel => stream.change_contents(world, |content| {
                if let Some(undulation_m) = first_place(content).and_then(|place| undulation_m(&place)) {
                    is_changed |= change_fixes(content, |fix| fix.altitude -= undulation_m);
                }
            }),
        }
        is_changed
    }
}

impl FixChange {
    fn can_be_of(&self, stream: &Stream) -> bool {
        !matches!(self, Self::SeaLevel) || stream.is_standard_fix
    }
}

/// The place of a fix, at height 0 where the receiver gives none.
pub(super) fn geodetic(fix: &FixRow) -> Option<Geodetic> {
    let height_m = if fix.altitude_m.is_finite() {
        fix.altitude_m
    } else {
        0.0
    };
    Geodetic::from_degrees(fix.latitude_deg, fix.longitude_deg, height_m)
}

/// The place of the first fix.
fn first_place(content: &ContentEvidence) -> Option<Geodetic> {
    content.motion.fixes.iter().flat_map(Series::rows).find_map(geodetic)
}

/// Changes fixes, as far as evidence has them; false if none of them changes.
fn change_fixes(content: &mut ContentEvidence, change: impl Fn(&mut FixMessage)) -> bool {
    let mut is_changed = false;
    let mut altered = |latitude: &mut f64, longitude: &mut f64, altitude: &mut f64| {
        let before = FixMessage {
            latitude: *latitude,
            longitude: *longitude,
            altitude: *altitude,
        };
        let mut fix = before;
        change(&mut fix);
        (*latitude, *longitude, *altitude) = (fix.latitude, fix.longitude, fix.altitude);
        let is_same = |a: f64, b: f64| a.to_bits() == b.to_bits();
        is_changed |= !is_same(before.latitude, fix.latitude)
            || !is_same(before.longitude, fix.longitude)
            || !is_same(before.altitude, fix.altitude);
    };
    let series = content.motion.fixes.iter_mut();
    for row in series.flat_map(|series| series.stretches.iter_mut().flatten()) {
        altered(&mut row.latitude_deg, &mut row.longitude_deg, &mut row.altitude_m);
    }
    if let Some(fixes) = &mut content.fixes {
        let examples = fixes.out_of_range.1.iter_mut().chain(&mut fixes.null_island.1);
        for fix in fixes.samples.iter_mut().chain(examples) {
            altered(&mut fix.latitude_deg, &mut fix.longitude_deg, &mut fix.altitude_m);
        }
        count_out_of_range(fixes);
    }
    is_changed
}

/// Counts anew the fixes that are out of range, as far as the samples show their share.
fn count_out_of_range(fixes: &mut FixEvidence) {
    let with_fix = |fix: &&FixAt| fix.status >= 0;
    let is_out = |fix: &&FixAt| fix.latitude_deg.abs() > 90.0 || fix.longitude_deg.abs() > 180.0;
    let out: Vec<FixAt> = fixes.samples.iter().filter(with_fix).filter(is_out).cloned().collect();
    let all = fixes.samples.iter().filter(with_fix).count().max(1);
    let valid = fixes.count.saturating_sub(fixes.no_fix);
    let count = (out.len() as u64).saturating_mul(valid) / all as u64;
    fixes.out_of_range = (count, out.into_iter().take(MAX_EXAMPLES).collect());
}
