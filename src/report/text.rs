//! Words and numbers for people: wrapping, plurals, significant digits, UTC. Independent of rules and findings.

pub(super) use crate::visible::{clean, clean_in_place};

/// The text on one line, cleaned.
pub(super) fn one_line(text: &str) -> String {
    let cleaned = clean(text);
    if cleaned.contains(['\n', '\t']) {
        cleaned.split_whitespace().collect::<Vec<_>>().join(" ")
    } else {
        cleaned.into_owned()
    }
}

/// Breaks a text into lines of at most `width` columns; the first starts with `first`, the others with `rest`.
/// Newlines in the text stay. Without a width only the indents are added.
pub(super) fn wrap(text: &str, width: Option<usize>, first: &str, rest: &str) -> String {
    let width = width.map_or(usize::MAX, |width| width.max(40));
    let options = textwrap::Options::new(width)
        .initial_indent(first)
        .subsequent_indent(rest)
        .break_words(false)
        .word_separator(textwrap::WordSeparator::AsciiSpace)
        .word_splitter(textwrap::WordSplitter::NoHyphenation)
        .wrap_algorithm(textwrap::WrapAlgorithm::FirstFit);
    textwrap::fill(text, options)
}

/// `1 error`, `2 errors`.
pub fn plural(count: usize, noun: &str) -> String {
    if count == 1 {
        format!("1 {noun}")
    } else {
        format!("{count} {noun}s")
    }
}

/// `a`, `a and b`, `a, b and c`.
pub(super) fn list(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [only] => only.clone(),
        [init @ .., last] => format!("{} and {last}", init.join(", ")),
    }
}

/// A number with at most `digits` significant digits, without trailing zeros; integers keep all their digits.
pub(super) fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    // Adding zero turns -0 into 0.
    let value = value + 0.0;
    let size = value.abs();
    if value.fract() == 0.0 && size < 1e15 {
        return format!("{value:.0}");
    }
    if !(1e-4..1e9).contains(&size) {
        return trimmed_exponent(&format!("{value:.*e}", digits.saturating_sub(1)));
    }
    let mut before_point = 1_usize;
    let mut power = 10.0;
    while power <= size {
        before_point += 1;
        power *= 10.0;
    }
    let mut decimals = digits.saturating_sub(before_point);
    let mut small = 1.0;
    while size < small && small > 1e-5 {
        decimals += 1;
        small /= 10.0;
    }
    trimmed(&format!("{value:.decimals$}"))
}

/// Without zeros at the end of the fraction, and without a minus in front of zero.
pub(super) fn trimmed(spelled: &str) -> String {
    let short = if spelled.contains('.') {
        spelled.trim_end_matches('0').trim_end_matches('.')
    } else {
        spelled
    };
    if short == "-0" {
        "0".to_owned()
    } else {
        short.to_owned()
    }
}

fn trimmed_exponent(spelled: &str) -> String {
    match spelled.split_once('e') {
        Some((mantissa, exponent)) => format!("{}e{exponent}", trimmed(mantissa)),
        None => spelled.to_owned(),
    }
}

/// Bytes in a suitable unit.
pub(super) fn bytes(count: u64) -> String {
    let mut value = count as f64;
    for unit in ["B", "kB", "MB", "GB"] {
        if value < 1000.0 {
            return format!("{} {unit}", number(value, 3));
        }
        value /= 1000.0;
    }
    format!("{} TB", number(value, 3))
}

/// Nanoseconds as seconds, with all significant digits: `1700000000.25`.
pub(super) fn seconds(ns: i64) -> String {
    let sign = if ns < 0 { "-" } else { "" };
    let size = ns.unsigned_abs();
    trimmed(&format!("{sign}{}.{:09}", size / 1_000_000_000, size % 1_000_000_000))
}

/// A stamp for people: UTC and seconds, or seconds alone for a clock that is plainly not UTC (before 2000).
pub(super) fn stamp(ns: i64) -> String {
    const YEAR_2000_NS: i64 = 946_684_800_000_000_000;
    if ns < YEAR_2000_NS {
        return format!("{} s", seconds(ns));
    }
    format!("{} ({} s)", utc(ns), seconds(ns))
}

/// `2023-11-14 22:13:20.000 UTC`. The calendar is Howard Hinnant's `civil_from_days`
/// (<https://howardhinnant.github.io/date_algorithms.html>).
fn utc(ns: i64) -> String {
    let ms = ns.div_euclid(1_000_000);
    let days = ms.div_euclid(86_400_000);
    let in_day = ms.rem_euclid(86_400_000);
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 {
        from_march + 3
    } else {
        from_march - 9
    };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    let (hour, minute) = (in_day / 3_600_000, in_day / 60_000 % 60);
    let (second, milli) = (in_day / 1000 % 60, in_day % 1000);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}.{milli:03} UTC")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_the_digits_that_matter() {
        for (value, digits, expected) in [
            (90.0, 4, "90"),
            (-0.0, 4, "0"),
            (0.123_456, 3, "0.123"),
            (0.001_234_5, 3, "0.00123"),
            (12.345, 3, "12.3"),
            (1234.567, 3, "1235"),
            (0.000_012_34, 3, "1.23e-5"),
            (2.5e12, 3, "2500000000000"),
            (f64::NAN, 3, "NaN"),
            (1.000_04, 3, "1"),
            (1.000_04, 6, "1.00004"),
        ] {
            assert_eq!(number(value, digits), expected, "{value} with {digits} digits");
        }
    }

    #[test]
    fn stamps_are_utc_where_the_clock_is() {
        assert_eq!(
            stamp(1_700_000_000_250_000_000),
            "2023-11-14 22:13:20.250 UTC (1700000000.25 s)"
        );
        // A leap day.
        assert_eq!(
            stamp(1_709_164_800_000_000_000),
            "2024-02-29 00:00:00.000 UTC (1709164800 s)"
        );
        assert_eq!(stamp(12_500_000_000), "12.5 s");
        assert_eq!(stamp(-1), "-0.000000001 s");
        assert!(stamp(i64::MIN).starts_with("-9223372036.854775808"));
    }

    #[test]
    fn a_line_has_no_newlines() {
        assert_eq!(one_line("a\n  b"), "a b");
    }
}
