//! Offsets between clocks that have a name: leap seconds, epochs, time zones, wraps.
//!
//! Sources: IERS Leap_Second.dat and Bulletin C 72 for the leap seconds; GPS epoch 1980-01-06 = Unix 315964800;
//! NTP epoch 1900 = 2208988800 s before Unix; HFS epoch 1904 = 2082844800 s.

/// GPS epoch in Unix seconds.
const GPS_EPOCH_S: f64 = 315_964_800.0;

/// Unix time from which `TAI - UTC` has this value, newest first.
const TAI_MINUS_UTC: &[(f64, f64)] = &[
    (1_483_228_800.0, 37.0), // 2017-01-01
    (1_435_708_800.0, 36.0), // 2015-07-01
    (1_341_100_800.0, 35.0), // 2012-07-01
    (1_230_768_000.0, 34.0), // 2009-01-01
    (1_136_073_600.0, 33.0), // 2006-01-01
    (915_148_800.0, 32.0),   // 1999-01-01
];

/// How specific an explanation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Specific {
    /// One of a dense family: a random offset matches one time in some hundreds.
    Family,
    /// A single number.
    Single,
}

/// A named offset.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Named {
    /// `stamp - log` that it predicts, seconds.
    pub(super) offset_s: f64,
    /// What it is, in words.
    pub(super) what: String,
    /// How specific it is.
    pub(super) specific: Specific,
}

fn named(offset_s: f64, what: impl Into<String>, specific: Specific) -> Named {
    Named {
        offset_s,
        what: what.into(),
        specific,
    }
}

/// `TAI - UTC` at a Unix time, seconds.
pub(super) fn tai_minus_utc_s(unix_s: f64) -> f64 {
    TAI_MINUS_UTC
        .iter()
        .find(|(since, _)| unix_s >= *since)
        .map_or(31.0, |(_, seconds)| *seconds)
}

/// `GPS - UTC` at a Unix time, seconds: TAI runs 19 s ahead of GPS time always.
pub(super) fn gps_minus_utc_s(unix_s: f64) -> f64 {
    tai_minus_utc_s(unix_s) - 19.0
}

fn dictionary(log_s: f64) -> Vec<Named> {
    let (gps, tai) = (gps_minus_utc_s(log_s), tai_minus_utc_s(log_s));
    let single = |offset, what: String| named(offset, what, Specific::Single);
    let mut table = Vec::new();
    for (sign, turned) in [(1.0, false), (-1.0, true)] {
        let subtracted = if turned {
            ", subtracted twice or from the wrong clock"
        } else {
            ""
        };
        table.push(single(
            sign * gps,
            format!("GPS time taken for UTC: {gps} leap seconds{subtracted}"),
        ));
        table.push(single(
            sign * tai,
            format!("TAI (PTP) taken for UTC: {tai} leap seconds{subtracted}"),
        ));
        table.push(single(sign * 19.0, format!("TAI taken for GPS time: 19 s{subtracted}")));
    }
    for (leap, words) in [
        (0.0, ""),
        (gps, " and leap seconds"),
        (gps + 1.0, " and leap seconds"),
        (tai - gps, ""),
    ] {
        let what = format!("the GPS epoch (1980) taken for the Unix epoch (1970){words}");
        table.push(single(-GPS_EPOCH_S + leap, what));
    }
    for rollovers in [1.0, 2.0] {
        table.push(single(
            -rollovers * 619_315_200.0,
            format!("GPS week rollover (1024 weeks), {rollovers} time(s)"),
        ));
    }
    table.push(single(
        2_208_988_800.0,
        "the NTP epoch (1900) taken for the Unix epoch".to_owned(),
    ));
    table.push(single(
        2_082_844_800.0,
        "the 1904 epoch taken for the Unix epoch".to_owned(),
    ));
    for sign in [1.0, -1.0] {
        table.push(single(
            sign * 4.294_967_296,
            "a 32-bit nanosecond counter that wrapped once".to_owned(),
        ));
        table.push(single(
            sign * 4_294.967_296,
            "a 32-bit microsecond counter that wrapped once".to_owned(),
        ));
    }
    table
}

/// A time zone or an hour ambiguity: a multiple of a quarter of an hour up to 14 h; or whole days, or weeks.
fn families(offset_s: f64) -> Vec<Named> {
    let mut found = Vec::new();
    let quarters = (offset_s / 900.0).round();
    if quarters != 0.0 && quarters.abs() <= 56.0 {
        let hours = quarters / 4.0;
        found.push(named(
            quarters * 900.0,
            format!("local time taken for UTC, or an hour ambiguity: {hours} h"),
            Specific::Family,
        ));
    }
    for (unit, word) in [(604_800.0, "weeks"), (86_400.0, "days")] {
        let count = (offset_s / unit).round();
        if count != 0.0 && count.abs() <= 60.0 {
            found.push(named(count * unit, format!("{count} whole {word}"), Specific::Family));
        }
    }
    found
}

/// The named offsets within `tolerance_s` of an offset, the most specific and nearest first.
///
/// `log_s` is the Unix time of the recording: the leap seconds of that day are used.
pub(super) fn explain(offset_s: f64, tolerance_s: f64, log_s: f64) -> Vec<Named> {
    let mut hits: Vec<Named> = dictionary(log_s)
        .into_iter()
        .chain(families(offset_s))
        .filter(|candidate| (candidate.offset_s - offset_s).abs() <= tolerance_s)
        .collect();
    hits.sort_by(|a, b| {
        b.specific
            .cmp(&a.specific)
            .then((a.offset_s - offset_s).abs().total_cmp(&(b.offset_s - offset_s).abs()))
    });
    hits
}

/// The power of ten by which the stamps are in another unit than the log, with its words; for calendar stamps only.
pub(super) fn unit_error(stamp_s: f64, log_s: f64) -> Option<(f64, &'static str)> {
    if log_s <= 1e9 || stamp_s <= 0.0 {
        return None;
    }
    let ratio = stamp_s / log_s;
    [
        (1e-9, "nanoseconds were divided by 1e9 once too often"),
        (1e-6, "microseconds were divided by 1e6 once too often"),
        (1e-3, "milliseconds were divided by 1e3 once too often"),
        (1e3, "milliseconds were taken for seconds"),
        (1e6, "microseconds were taken for seconds"),
        (1e9, "nanoseconds were taken for seconds"),
    ]
    .into_iter()
    .find(|(factor, _)| (ratio / factor - 1.0).abs() < 0.01)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leap_seconds_follow_the_published_table() {
        // IERS: GPS-UTC was 14 s in 2007, 15 s in 2010, 16 s in 2013, 17 s in 2016 and is 18 s since 2017.
        for (unix, gps) in [
            (1_180_000_000.0, 14.0),
            (1_280_000_000.0, 15.0),
            (1_380_000_000.0, 16.0),
            (1_460_000_000.0, 17.0),
            (1_700_000_000.0, 18.0),
        ] {
            assert!((gps_minus_utc_s(unix) - gps).abs() < f64::EPSILON, "{unix}");
        }
    }

    #[test]
    fn an_offset_is_named_or_not() {
        let first = |offset: f64| explain(offset, 0.5, 1.7e9).into_iter().next().map(|named| named.what);
        assert!(first(18.02).unwrap().starts_with("GPS time taken for UTC"));
        assert!(first(-37.0).unwrap().starts_with("TAI (PTP)"));
        assert!(first(-315_964_782.0).unwrap().contains("GPS epoch"));
        assert!(first(3600.2).unwrap().contains("1 h"));
        assert!(first(-619_315_200.0).unwrap().contains("rollover"));
        assert_eq!(first(11.0), None);
        assert_eq!(first(0.1), None);
        assert_eq!(first(1234.0), None);
    }

    #[test]
    fn units_are_told_by_powers_of_ten() {
        assert!(
            unit_error(1.7e12, 1.7e9)
                .unwrap()
                .1
                .contains("milliseconds were taken for seconds")
        );
        assert!(unit_error(1.7, 1.7e9).unwrap().1.contains("nanoseconds were divided"));
        assert_eq!(unit_error(1.7e9, 1.7e9), None);
        assert_eq!(unit_error(5302.0, 1.7e9), None);
    }
}
