//! Timestamps on the command line: seconds with a fraction, or a date and time.

/// Nanoseconds of the timestamp's own clock: `1700000000.25` to the last digit, or RFC 3339 (`2023-11-14T22:13:20.25Z`, also
/// with a space for the `T`, without the zone for UTC, or with an offset such as `+02:00`).
pub(super) fn parse(text: &str) -> Result<i64, String> {
    let text = text.trim();
    let ns = if text.contains(':') { date(text) } else { seconds(text) };
    match ns {
        Some(0) => Err("a timestamp of 0 means the latest one in tf2: leave --at out for that".to_owned()),
        Some(ns) if ns > 0 => Ok(ns),
        Some(_) => Err("a timestamp cannot be negative".to_owned()),
        None => Err("expected seconds (1700000000.25) or a date and time (2023-11-14T22:13:20.25Z)".to_owned()),
    }
}

/// In integers: floating point would round to a quarter of a microsecond.
fn seconds(text: &str) -> Option<i64> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let (is_negative, whole) = match whole.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, whole),
    };
    if !digits(whole) || !digits(fraction) || fraction.len() > 9 {
        return None;
    }
    let ns: i64 = whole.parse::<i64>().ok()?.checked_mul(1_000_000_000)?;
    let ns = ns.checked_add(format!("{fraction:0<9}").parse::<i64>().ok()?)?;
    Some(if is_negative { -ns } else { ns })
}

fn date(text: &str) -> Option<i64> {
    let (date, time) = text.split_once(['T', 't', ' '])?;
    let (time, offset_s) = match time.rfind(['+', '-']) {
        Some(at) => {
            let (time, offset) = time.split_at_checked(at)?;
            let (hours, minutes) = offset.get(1..)?.split_once(':')?;
            let (hours, minutes) = (hours.parse::<u8>().ok()?, minutes.parse::<u8>().ok()?);
            if hours > 23 || minutes > 59 {
                return None;
            }
            let size = i64::from(hours) * 3600 + i64::from(minutes) * 60;
            (time, if offset.starts_with('-') { -size } else { size })
        }
        None => (time, 0),
    };
    let utc = humantime::parse_rfc3339_weak(&format!("{date}T{}Z", time.trim_end_matches(['Z', 'z']))).ok()?;
    let since = utc.duration_since(std::time::UNIX_EPOCH).ok()?;
    i64::try_from(since.as_nanos())
        .ok()?
        .checked_sub(offset_s * 1_000_000_000)
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn stamps_are_read_to_the_nanosecond() {
        for (text, ns) in [
            ("1700000000", 1_700_000_000_000_000_000),
            ("1700000000.000000001", 1_700_000_000_000_000_001),
            ("12.5", 12_500_000_000),
            (" 0.1 ", 100_000_000),
            ("2023-11-14T22:13:20Z", 1_700_000_000_000_000_000),
            ("2023-11-14 22:13:20.25", 1_700_000_000_250_000_000),
            ("2023-11-15T00:13:20+02:00", 1_700_000_000_000_000_000),
            ("2023-11-14T16:43:20.000000007-05:30", 1_700_000_000_000_000_007),
        ] {
            assert_eq!(parse(text), Ok(ns), "{text}");
        }
    }

    #[test]
    fn other_texts_are_refused() {
        for text in [
            "",
            "now",
            "-5",
            "0",
            "0.0",
            "1e9",
            "1.",
            ".5",
            "1.0000000001",
            "99999999999",
            "2023-11-14",
            "22:13:20",
            "2023-13-14T22:13:20Z",
            "2023-11-14T22:13:20+25:00",
            "2023-11-14T22:13:20+ab:cd",
            "1969-12-31T23:59:59Z",
            "1700000000.-5",
            "+5",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
