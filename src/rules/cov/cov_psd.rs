//! COV01: invalid covariances: not finite, not symmetric, with a negative variance, or never filled.

use crate::rules::prelude::*;
use crate::world::content::{CovarianceAt, CovarianceEvidence};
use crate::world::{BagEvidence, bag::TopicEvidence};

pub(crate) struct CovPsd;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    asymmetry: f64,
    negative: f64,
    gross: f64,
    denormal: f64,
    max_non_finite: f64,
}

impl Rule for CovPsd {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for said in bag.topics.values().flat_map(TopicEvidence::contents) {
                // Messages guessed from plain fields have only the covariances that are among these fields.
                let is_there = |evidence: &CovarianceEvidence| !said.guessed || evidence.all_zero < evidence.count;
                for (field, evidence) in said.content.covariances.iter().filter(|(_, all)| is_there(all)) {
                    let subject = format!("`{field}` on {}", said.subject());
                    judge_field(bag, subject, evidence, limits, out);
                }
            }
        }
    }
}

fn judge_field(bag: &BagEvidence, subject: String, evidence: &CovarianceEvidence, limits: &Limits, out: &mut Judge) {
    let faults = [
        non_finite(evidence, limits),
        denormal(evidence, limits),
        asymmetric(evidence, limits),
        negative(evidence, limits),
    ];
    // A matrix that is not symmetric, or holds no numbers, has no meaningful eigenvalues.
    if let Some(fault) = faults.into_iter().flatten().next() {
        let message = format!("{subject}: {}", fault.words);
        let place = Place::message(bag.source, fault.at.at.clone());
        let finding = Finding::new(fault.severity, subject, message, place)
            .detail(fault.detail)
            .help(fault.help);
        return out.fail(finding.measured(fault.measured.samples(evidence.count)));
    }
    let (Some((asymmetry, _)), Some((least, _))) = (&evidence.most_asymmetric, &evidence.least_positive) else {
        return out.not_applicable(
            subject,
            "every matrix is all zeros or begins with -1: the covariance is marked as unknown",
        );
    };
    out.pass(
        subject,
        [
            Measured::new("asymmetry / largest element", *asymmetry, "1").limit(limits.asymmetry),
            Measured::new("smallest eigenvalue / largest element", *least, "1")
                .at_least(limits.negative)
                .samples(evidence.count),
        ],
    );
}

struct Fault<'e> {
    severity: Severity,
    words: String,
    detail: String,
    help: &'static str,
    measured: Measured,
    at: &'e CovarianceAt,
}

fn non_finite<'e>(evidence: &'e CovarianceEvidence, limits: &Limits) -> Option<Fault<'e>> {
    let (count, first) = &evidence.non_finite;
    let at = first.as_ref().filter(|_| *count as f64 > limits.max_non_finite)?;
    Some(Fault {
        severity: Severity::Error,
        words: format!("{count} of {} matrices contain NaN or infinity", evidence.count),
        detail: String::new(),
        help: "publish all zeros where the covariance is unknown, and -1 as the first element where the field itself is not measured",
        measured: Measured::new("matrices that are not finite", *count as f64, "count").limit(limits.max_non_finite),
        at,
    })
}

/// Numbers that no computation gives: uninitialised memory.
fn denormal<'e>(evidence: &'e CovarianceEvidence, limits: &Limits) -> Option<Fault<'e>> {
    let is_denormal = |value: &f64| *value != 0.0 && value.abs() < limits.denormal;
    let mut found = evidence.samples.iter().enumerate().filter_map(|(number, at)| {
        let value = at.values.iter().copied().find(is_denormal)?;
        Some((number, at, value))
    });
    let (number, at, value) = found.next()?;
    // A driver does so from its first message on or again and again; one matrix among others is one damaged message.
    if number > 0 && found.next().is_none() {
        return None;
    }
    Some(Fault {
        severity: Severity::Warning,
        words: format!("a matrix contains {value:e}: probably uninitialised memory"),
        detail: String::new(),
        help: "set every element of the matrix before publishing, to zero where nothing is known",
        measured: Measured::new("smallest number that is not zero", value, "1").limit(limits.denormal),
        at,
    })
}

fn asymmetric<'e>(evidence: &'e CovarianceEvidence, limits: &Limits) -> Option<Fault<'e>> {
    let (asymmetry, at) = evidence
        .most_asymmetric
        .as_ref()
        .filter(|(value, _)| *value > limits.asymmetry)?;
    Some(Fault {
        severity: graded(*asymmetry, limits),
        words: format!("not symmetric, by {} of the largest element", share(*asymmetry)),
        detail: most_different(&at.values),
        help: "fill both halves of the matrix: C[i][j] = C[j][i]. If you fill both already, check the order of its elements and the length of a row",
        measured: Measured::new("asymmetry / largest element", *asymmetry, "1").limit(limits.asymmetry),
        at,
    })
}

/// A share of the largest element, in words.
fn share(of_largest: f64) -> String {
    if of_largest.abs() >= 1e-3 {
        format!("{:.1} %", 100.0 * of_largest)
    } else {
        format!("{of_largest:.1e}")
    }
}

/// An element, in words.
fn brief(element: f64) -> String {
    if element == 0.0 || (1e-3..1e5).contains(&element.abs()) {
        format!("{element:.4}")
    } else {
        format!("{element:.4e}")
    }
}

/// The two mirrored entries of a square matrix that differ most, in words.
fn most_different(values: &[f64]) -> String {
    let size = values.len().isqrt();
    let at = |row: usize, col: usize| values.get(row * size + col).copied().unwrap_or(0.0);
    let pairs = (0..size).flat_map(|row| (0..row).map(move |col| (row, col)));
    let difference = |(row, col): &(usize, usize)| (at(*row, *col) - at(*col, *row)).abs();
    let most = pairs.max_by(|a, b| difference(a).total_cmp(&difference(b)));
    most.map_or_else(String::new, |(row, col)| {
        format!(
            "The largest difference: C[{col}][{row}] = {}, C[{row}][{col}] = {}; the largest element: {}.",
            brief(at(col, row)),
            brief(at(row, col)),
            brief(values.iter().fold(0.0, |most, value| value.abs().max(most)))
        )
    })
}

fn negative<'e>(evidence: &'e CovarianceEvidence, limits: &Limits) -> Option<Fault<'e>> {
    let (least, at) = evidence
        .least_positive
        .as_ref()
        .filter(|(value, _)| *value < limits.negative)?;
    let (detail, help) = impossible(&at.values);
    Some(Fault {
        severity: graded(-least, limits),
        words: format!("negative eigenvalue, {} of the largest element", share(*least)),
        detail,
        help,
        measured: Measured::new("smallest eigenvalue / largest element", *least, "1").at_least(limits.negative),
        at,
    })
}

/// The element that makes an eigenvalue of a symmetric matrix negative, in words, and what to do: a negative variance, or the covariance
/// that exceeds its variances most.
fn impossible(values: &[f64]) -> (String, &'static str) {
    let size = values.len().isqrt();
    let at = |row: usize, col: usize| values.get(row * size + col).copied().unwrap_or(0.0);
    if let Some(axis) = (0..size).find(|axis| at(*axis, *axis) < 0.0) {
        return (
            format!(
                "C[{axis}][{axis}] = {} is a variance, and must not be negative.",
                brief(at(axis, axis))
            ),
            "correct that variance (0 or more), or publish all zeros where the covariance is unknown",
        );
    }
    let allowed = |row: usize, col: usize| (at(row, row) * at(col, col)).sqrt();
    let excess = |(row, col): &(usize, usize)| at(*row, *col).abs() - allowed(*row, *col);
    let pairs = (0..size).flat_map(|row| (0..row).map(move |col| (row, col)));
    match pairs
        .filter(|pair| excess(pair) > 0.0)
        .max_by(|a, b| excess(a).total_cmp(&excess(b)))
    {
        Some((row, col)) => (
            format!(
                "C[{col}][{row}] = {}, but the variances C[{col}][{col}] = {} and C[{row}][{row}] = {} allow at most {} (root of their product).",
                brief(at(col, row)),
                brief(at(col, col)),
                brief(at(row, row)),
                brief(allowed(row, col))
            ),
            "correct that covariance or its variances, or set all elements off the diagonal to 0",
        ),
        None => (
            "No element alone is impossible: the covariances together exceed what the variances allow.".to_owned(),
            "set all elements off the diagonal to 0, or publish the covariance of the estimator without rounding",
        ),
    }
}

fn graded(size: f64, limits: &Limits) -> Severity {
    if size > limits.gross {
        Severity::Error
    } else {
        Severity::Warning
    }
}
