//! Times as messages spell them.

use super::value::{Object, Value};

/// Nanoseconds in a second.
const SECOND: i64 = 1_000_000_000;

/// Nanoseconds since 1970, or why it is not a time: `{sec, nsec}` and similar, or an RFC 3339 text.
pub(super) fn nanoseconds(value: &Value<'_>) -> Result<i64, String> {
    let (seconds, rest) = match value {
        Value::Object(object) => {
            let seconds = first(object, &["seconds", "sec", "secs"]).and_then(integer);
            let seconds = seconds.ok_or("has no whole number of seconds")?;
            let rest = match first(object, &["nanos", "nsec", "nsecs", "nanosec"]) {
                Some(value) => integer(value).ok_or("has no whole number of nanoseconds")?,
                None => 0,
            };
            (seconds, rest)
        }
        Value::Text(text) => rfc3339(text.as_bytes()).ok_or("is not an RFC 3339 time")?,
        other => return Err(format!("is {}, not seconds and nanoseconds", other.noun())),
    };
    let whole = seconds.checked_mul(SECOND).and_then(|whole| whole.checked_add(rest));
    whole.ok_or_else(|| "is out of range".to_owned())
}

fn first<'o, 'm>(object: &'o Object<'m>, names: &[&str]) -> Option<&'o Value<'m>> {
    names.iter().find_map(|name| object.get(name))
}

/// A whole number; JSON of Protocol Buffers writes long ones as text, and some writers add `.0`.
fn integer(value: &Value<'_>) -> Option<i64> {
    match value {
        Value::Integer(number) => Some(*number),
        Value::Text(text) => text.parse().ok(),
        // 2^53: beyond, not every whole number can be written.
        Value::Number(number) if number.fract() == 0.0 && number.abs() < 9_007_199_254_740_992.0 =>
        {
            #[expect(clippy::cast_possible_truncation, reason = "whole, and within 2^53")]
            Some(*number as i64)
        }
        _ => None,
    }
}

/// Seconds since 1970 and nanoseconds of `2024-02-29T12:30:00.5Z` or `2024-02-29T13:30:00.5+01:00`.
fn rfc3339(text: &[u8]) -> Option<(i64, i64)> {
    let (year, text) = number(text, 4, 0..=9999)?;
    let (month, text) = number(mark(text, b"-")?, 2, 1..=12)?;
    let (day, text) = number(mark(text, b"-")?, 2, 1..=31)?;
    let (hour, text) = number(mark(text, b"Tt ")?, 2, 0..=23)?;
    let (minute, text) = number(mark(text, b":")?, 2, 0..=59)?;
    // 60 is a leap second.
    let (second, mut text) = number(mark(text, b":")?, 2, 0..=60)?;
    let mut nanos = 0;
    if let Some(digits) = mark(text, b".") {
        let count = digits.iter().take_while(|byte| byte.is_ascii_digit()).count();
        if count == 0 {
            return None;
        }
        let (fraction, rest) = digits.split_at_checked(count)?;
        let padded = fraction.iter().copied().chain(std::iter::repeat(b'0'));
        nanos = padded.take(9).fold(0, |sum, digit| sum * 10 + i64::from(digit - b'0'));
        text = rest;
    }
    let offset = match text {
        b"Z" | b"z" => 0,
        [sign @ (b'+' | b'-'), rest @ ..] => {
            let (hours, rest) = number(rest, 2, 0..=23)?;
            let (minutes, rest) = number(mark(rest, b":")?, 2, 0..=59)?;
            if !rest.is_empty() {
                return None;
            }
            let east = if *sign == b'+' { 1 } else { -1 };
            east * (hours * 3600 + minutes * 60)
        }
        _ => return None,
    };
    let seconds = days_from_civil(year, month, day) * 86_400 + hour * 3600 + minute * 60 + second - offset;
    Some((seconds, nanos))
}

/// A number of `count` digits within bounds, and what follows.
fn number(text: &[u8], count: usize, bounds: std::ops::RangeInclusive<i64>) -> Option<(i64, &[u8])> {
    let (digits, rest) = text.split_at_checked(count)?;
    if !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let value = digits.iter().fold(0, |sum, digit| sum * 10 + i64::from(digit - b'0'));
    bounds.contains(&value).then_some((value, rest))
}

/// What follows one of the marks.
fn mark<'t>(text: &'t [u8], marks: &[u8]) -> Option<&'t [u8]> {
    let (first, rest) = text.split_first()?;
    marks.contains(first).then_some(rest)
}

/// Days from 1970-01-01 in the Gregorian calendar: years begin in March, so the leap day ends one.
/// Source: H. Hinnant, "chrono-compatible low-level date algorithms".
fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Result<i64, String> {
        nanoseconds(&Value::Text(text.into()))
    }

    #[test]
    fn times_as_text_equal_the_calendar() {
        // By GNU date: `date -u -d 2024-02-29T12:30:00Z +%s`, and so on.
        for (written, seconds) in [
            ("1970-01-01T00:00:00Z", 0),
            ("2024-02-29T12:30:00Z", 1_709_209_800),
            ("2024-03-01T00:00:00Z", 1_709_251_200),
            ("2000-12-31t23:59:59z", 978_307_199),
            ("1969-12-31T23:59:59Z", -1),
            ("2024-02-29T13:30:00+01:00", 1_709_209_800),
            ("2024-02-29T05:00:00-07:30", 1_709_209_800),
        ] {
            assert_eq!(text(written), Ok(seconds * SECOND), "{written}");
        }
        assert_eq!(text("1970-01-01T00:00:01.25Z"), Ok(1_250_000_000));
        assert_eq!(text("1970-01-01T00:00:00.1234567899Z"), Ok(123_456_789));
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for written in [
            "",
            "now",
            "2024-13-01T00:00:00Z",
            "2024-01-01T24:00:00Z",
            "2024-01-01T00:00:00",
            "2024-01-01T00:00:00.Z",
            "2024-01-01T00:00:00Zx",
            "2024-01-01T00:00:00+01:00x",
            "2024-01-01T00:00:00+1",
            "+024-01-01T00:00:00Z",
        ] {
            assert!(text(written).is_err(), "{written}");
        }
        assert!(text("9999-12-31T23:59:59Z").unwrap_err().contains("range"));
    }

    #[test]
    fn seconds_may_be_spelled_in_every_known_way() {
        for (seconds, rest) in [
            ("sec", "nsec"),
            ("seconds", "nanos"),
            ("secs", "nsecs"),
            ("sec", "nanosec"),
        ] {
            let object = Object(vec![(seconds, Value::Integer(-2)), (rest, Value::Integer(5))]);
            assert_eq!(nanoseconds(&Value::Object(object)), Ok(5 - 2 * SECOND));
        }
        let long = Object(vec![("seconds", Value::Text("17".into()))]);
        assert_eq!(nanoseconds(&Value::Object(long)), Ok(17 * SECOND));
        let broken = Object(vec![("sec", Value::Number(1.5))]);
        assert!(nanoseconds(&Value::Object(broken)).unwrap_err().contains("whole"));
        let far = Object(vec![("sec", Value::Integer(i64::MAX))]);
        assert!(nanoseconds(&Value::Object(far)).unwrap_err().contains("range"));
        assert!(nanoseconds(&Value::Number(1.5)).unwrap_err().contains("a number"));
    }
}
