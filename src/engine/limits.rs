//! Limits set by the user: checked against the pages, and converted to their units.

use std::collections::BTreeMap;

use crate::config::LimitOverride;
use crate::page::Number;
use crate::verdict::unit_factor;

use super::UsageError;
use super::enabled::EnabledRule;

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
    let factor = unit_factor(&limit.unit, known.unit).ok_or_else(|| {
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
