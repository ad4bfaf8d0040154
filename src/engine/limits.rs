//! Limits set by the user: checked against the pages, and converted to their units.

use std::collections::BTreeMap;

use crate::config::LimitOverride;
use crate::page::Number;

use super::UsageError;
use super::enabled::EnabledRule;

/// Units that can be converted into one another, each with its size.
const KINDS: [&[(&str, f64)]; 6] = [
    &[("m", 1.0), ("km", 1000.0), ("cm", 0.01), ("mm", 0.001), ("um", 1e-6)],
    &[
        ("deg", 1.0),
        ("rad", 180.0 / std::f64::consts::PI),
        ("mrad", 0.18 / std::f64::consts::PI),
    ],
    &[("s", 1.0), ("min", 60.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)],
    &[("m/s", 1.0), ("km/h", 1.0 / 3.6), ("mm/s", 1e-3)],
    &[("deg/s", 1.0), ("rad/s", 180.0 / std::f64::consts::PI)],
    &[("1", 1.0), ("", 1.0), ("%", 0.01), ("ppm", 1e-6)],
];

/// Sets a limit of a rule.
pub(super) fn set(rules: &mut [EnabledRule], limit: &LimitOverride) -> Result<(), UsageError> {
    let failed = |what: String| UsageError(format!("{}: {what}", limit.origin));
    let rule = rules.iter_mut().find(|rule| {
        [rule.entry.page.code, rule.entry.page.name]
            .iter()
            .any(|known| known.eq_ignore_ascii_case(&limit.rule))
    });
    let rule = rule.ok_or_else(|| failed(format!("`{}` is a family; set limits for a single rule", limit.rule)))?;
    let page = rule.entry.page;
    let Some(known) = page.limit(&limit.name) else {
        let names: Vec<&str> = page.limits.iter().map(|limit| limit.name).collect();
        let names = if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        };
        return Err(failed(format!(
            "{} has no limit `{}`; its limits: {names}",
            page.code, limit.name
        )));
    };
    let factor = factor(&limit.unit, known.unit).ok_or_else(|| {
        let example = known.value.as_f64();
        let unit = if known.unit == "1" {
            String::new()
        } else {
            format!(" {}", known.unit)
        };
        failed(format!(
            "`{}` has the unit {}: write it as in `{example}{unit}`",
            limit.name, known.unit
        ))
    })?;
    let value = limit.value * factor;
    let counts = matches!(known.value, Number::Whole(_));
    #[allow(clippy::cast_possible_truncation)] // whole, and small enough
    let value = if counts && value.fract() == 0.0 && value.abs() < 1e15 {
        Number::Whole(value as i64)
    } else {
        Number::Real(value)
    };
    let own = BTreeMap::from([(limit.name.clone(), value)]);
    (rule.entry.check_limits)(page, &own).map_err(failed)?;
    rule.overrides.extend(own);
    Ok(())
}

/// The factor from the written unit to the unit of the page; `None` if they cannot be converted.
fn factor(written: &str, page: &str) -> Option<f64> {
    if written == page {
        return Some(1.0);
    }
    let of = |unit: &str| {
        KINDS.iter().enumerate().find_map(|(kind, units)| {
            units
                .iter()
                .find(|(name, _)| *name == unit)
                .map(|(_, size)| (kind, *size))
        })
    };
    if written.is_empty() && matches!(page, "count" | "1") {
        return Some(1.0);
    }
    let ((kind, size), (other, unit)) = (of(written)?, of(page)?);
    (kind == other).then_some(size / unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_brought_to_those_of_the_page() {
        let close = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-12 * b);
        assert!(close(factor("cm", "m"), 0.01));
        assert!(close(factor("rad", "deg"), 57.295_779_513_082_32));
        assert!(close(factor("ms", "s"), 0.001));
        assert!(close(factor("%", "1"), 0.01));
        assert!(close(factor("", "count"), 1.0));
        assert_eq!(factor("deg", "m"), None);
        assert_eq!(factor("", "m"), None);
        assert!(close(factor("furlong", "furlong"), 1.0));
    }
}
