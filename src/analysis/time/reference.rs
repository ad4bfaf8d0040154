//! The signal that others are compared with: the first that any of them has a lag to.
//!
//! Owns how many pairs are tried. Must not judge.

use crate::analysis::Estimates;
use crate::analysis::time::offsets::{Limits, NoOffset, Offset, held};
use crate::analysis::time::turning::{Kind, Signal};

/// A signal, and the offsets of those behind it.
type SignalOffsets<'s> = (&'s Signal, Vec<(&'s Signal, Result<Offset, NoOffset>)>);

/// The correlation of two signals that determine no lag, and why they do not.
type NoLag = (f64, String);

/// The first signal that another one can be compared with, or why each signal cannot be compared.
pub(crate) fn reference<'s>(
    world: &Estimates,
    signals: &'s [Signal],
    limits: &Limits,
) -> Result<SignalOffsets<'s>, Vec<String>> {
    let mut silent: Vec<Vec<NoLag>> = Vec::new();
    for (index, first) in signals.iter().enumerate() {
        if silent.iter().map(Vec::len).sum::<usize>() >= limits.max_pairs {
            break;
        }
        let others = signals.iter().skip(index + 1);
        let others: Vec<_> = others
            .map(|second| (second, held(world, first, second, limits)))
            .collect();
        let of = |(_, found): &(&Signal, Result<Offset, NoOffset>)| match found {
            Err(NoOffset::Undetermined(rho, why)) => Some((*rho, why.clone())),
            _ => None,
        };
        match others.iter().map(of).collect() {
            Some(none) => silent.push(none),
            None => return Ok((first, others)),
        }
    }
    Err((0..signals.len())
        .map(|index| why_silent(signals, index, &silent))
        .collect())
}

/// Why a signal cannot be compared: `silent` has, for each that was tried, the signals behind it.
fn why_silent(signals: &[Signal], index: usize, silent: &[Vec<NoLag>]) -> String {
    let between = |other: usize| {
        let (first, second) = (index.min(other), index.max(other));
        silent.get(first)?.get((second - first).checked_sub(1)?)
    };
    let others = signals.iter().enumerate();
    let whys = others.filter_map(|(other, signal)| Some((between(other)?, signal)));
    let best = whys.max_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let why = best.map_or_else(
        || "nothing else in the recording shows its motion".to_owned(),
        |((_, why), other)| format!("compared with {}: {why}", words(other)),
    );
    if silent.len() < signals.len() {
        let (all, tried) = (signals.len(), silent.len());
        format!("{why}; only the first {tried} of {all} streams were compared with all others")
    } else {
        why
    }
}

/// The reference in words.
pub(crate) fn words(signal: &Signal) -> String {
    match signal.kind {
        Kind::Gyro => format!("the gyro of {}", signal.subject),
        _ => signal.subject.clone(),
    }
}
