//! Offsets between clocks that have a known cause: leap seconds, epochs, time zones, wraps.
//!
//! Sources: `rules/tables/leap-seconds.yaml` for the leap seconds; GPS epoch 1980-01-06 = Unix 315964800; NTP epoch 1900
//! = 2208988800 s before Unix; HFS epoch 1904 = 2082844800 s. Must not know streams.

use crate::tables::leap_seconds;

const GPS_EPOCH_S: f64 = 315_964_800.0;

/// 1024 weeks.
const ROLLOVER_S: f64 = 619_315_200.0;

/// How specific an explanation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Specificity {
    /// One of a dense family, or as small as a latency: a random offset matches now and then.
    Family,
    /// A single number.
    Single,
}

/// A named offset.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KnownOffset {
    /// `stamp - log` that it predicts, seconds.
    pub(crate) offset_s: f64,
    /// What it is, in words.
    pub(crate) what: String,
    /// How specific it is.
    pub(crate) specific: Specificity,
    /// Entries of one cause, of which the nearest counts.
    cause: &'static str,
    /// Whether latency is of its size: only the fine tolerance is allowed.
    fine: bool,
}

impl KnownOffset {
    /// Whether latency has this size.
    pub(crate) fn is_fine(&self) -> bool {
        self.fine
    }

    /// Whether plain latency has this size and sign.
    pub(crate) fn is_latency(&self) -> bool {
        self.fine && self.offset_s < 0.0
    }
}

/// How far an offset may be from that of its cause, seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tolerance {
    /// Of all entries.
    pub(crate) usual_s: f64,
    /// Of those that are as small as a latency.
    pub(crate) fine_s: f64,
}

/// How the dictionary explains an offset.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Explanation {
    /// Nothing.
    Unknown,
    /// One cause.
    One(KnownOffset),
    /// Several causes of one rank, nearest first: none of them is believed.
    Several(Vec<KnownOffset>),
}

fn entry(cause: &'static str, offset_s: f64, specific: Specificity, what: String) -> KnownOffset {
    let fine = false;
    KnownOffset {
        offset_s,
        what,
        specific,
        cause,
        fine,
    }
}

/// Leap seconds: `GPS - UTC`, `TAI - UTC` and `TAI - GPS`, either way.
fn leaps(gps: f64, tai: f64) -> Vec<KnownOffset> {
    let twice = "subtracted twice, or from the wrong clock";
    let words = [
        (
            "gps",
            gps,
            format!("GPS time used as UTC ({gps} leap seconds)"),
            format!("{gps} leap seconds {twice}"),
        ),
        (
            "tai",
            tai,
            format!("TAI (PTP) used as UTC ({tai} leap seconds)"),
            format!("{tai} leap seconds {twice}"),
        ),
        (
            "tai-gps",
            19.0,
            "TAI used as GPS time (19 s)".to_owned(),
            format!("TAI - GPS (19 s) {twice}"),
        ),
    ];
    let both = words.into_iter().flat_map(|(cause, offset, ahead, behind)| {
        [
            entry(cause, -offset, Specificity::Single, behind),
            entry(cause, offset, Specificity::Single, ahead),
        ]
    });
    both.collect()
}

/// Epochs, week rollovers and wrapped counters.
fn singles(gps: f64) -> Vec<KnownOffset> {
    let single = |cause, offset, what: &str| entry(cause, offset, Specificity::Single, what.to_owned());
    let mut table = vec![
        single("ntp", 2_208_988_800.0, "the NTP epoch (1900) used as the Unix epoch"),
        single("hfs", 2_082_844_800.0, "the 1904 epoch (HFS) used as the Unix epoch"),
    ];
    for leap in [0.0, gps, 19.0] {
        let words = if leap == 0.0 { "" } else { ", with leap seconds" };
        let what = format!("the GPS epoch (1980) used as the Unix epoch{words}");
        table.push(single("gps epoch", leap - GPS_EPOCH_S, &what));
    }
    for count in [1.0, 2.0] {
        let what = format!("GPS week rollover ({count} x 1024 weeks)");
        table.extend([-1.0, 1.0].map(|sign| single("rollover", sign * count * ROLLOVER_S, &what)));
    }
    let wrapped = "a 32-bit microsecond counter wrapped once";
    table.extend([-1.0, 1.0].map(|sign| single("us", sign * 4_294.967_296, wrapped)));
    table
}

/// Offsets as small as a latency.
fn fine() -> impl Iterator<Item = KnownOffset> {
    let wrapped = "a 32-bit nanosecond counter wrapped once";
    let table = [
        ("ns", 4.294_967_296, wrapped),
        ("ns", -4.294_967_296, wrapped),
        (
            "pps",
            1.0,
            "one pulse per second (PPS) too many, or a leap second missing in a table",
        ),
        ("pps", -1.0, "one pulse per second (PPS) was not counted"),
    ];
    table.into_iter().map(|(cause, offset, what)| KnownOffset {
        fine: true,
        ..entry(cause, offset, Specificity::Family, what.to_owned())
    })
}

/// A time zone or an hour ambiguity: a multiple of a quarter of an hour up to 14 h; or whole days, or weeks.
fn families(offset_s: f64) -> Vec<KnownOffset> {
    let mut found = Vec::new();
    let quarters = (offset_s / 900.0).round();
    if quarters != 0.0 && quarters.abs() <= 56.0 {
        let what = format!("local time used as UTC, or an ambiguous hour ({} h)", quarters / 4.0);
        found.push(entry("zone", quarters * 900.0, Specificity::Family, what));
    }
    for (unit, word) in [(604_800.0, "weeks"), (86_400.0, "days")] {
        let count = (offset_s / unit).round();
        if count != 0.0 && count.abs() <= 60.0 {
            let what = format!("{count} whole {word}");
            found.push(entry("days", count * unit, Specificity::Family, what));
        }
    }
    found
}

/// How the dictionary explains an offset `stamp - log`. `log_s` is the Unix time of the recording: the leap seconds of
/// that day are used.
pub(crate) fn explain(offset_s: f64, tolerance: Tolerance, log_s: f64) -> Explanation {
    let leap = leap_seconds();
    let (gps, tai) = (leap.gps_minus_utc_s(log_s), leap.tai_minus_utc_s(log_s));
    let away = |named: &KnownOffset| (named.offset_s - offset_s).abs();
    let mut hits: Vec<KnownOffset> = leaps(gps, tai)
        .into_iter()
        .chain(singles(gps))
        .chain(fine())
        .chain(families(offset_s))
        .filter(|named| {
            away(named)
                <= if named.fine {
                    tolerance.fine_s
                } else {
                    tolerance.usual_s
                }
        })
        .collect();
    hits.sort_by(|a, b| b.specific.cmp(&a.specific).then(away(a).total_cmp(&away(b))));
    let best = hits.first().map(|named| named.specific);
    let mut causes = Vec::new();
    hits.retain(|named| {
        let counts = Some(named.specific) == best && !causes.contains(&named.cause);
        causes.push(named.cause);
        counts
    });
    match hits.len() {
        0 => Explanation::Unknown,
        1 => hits.pop().map_or(Explanation::Unknown, Explanation::One),
        _ => Explanation::Several(hits),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(offset_s: f64, log_s: f64) -> Option<String> {
        let tolerance = Tolerance {
            usual_s: 0.5,
            fine_s: 0.1,
        };
        match explain(offset_s, tolerance, log_s) {
            Explanation::One(named) => Some(named.what),
            _ => None,
        }
    }

    #[test]
    fn an_offset_is_named_or_not() {
        let first = |offset: f64| words(offset, 1.7e9);
        assert!(first(18.02).unwrap().starts_with("GPS time used as UTC"));
        assert!(first(37.0).unwrap().starts_with("TAI (PTP)"));
        assert!(first(-37.0).unwrap().starts_with("37 leap seconds subtracted"));
        assert!(first(-19.2).unwrap().contains("subtracted"));
        assert!(first(-315_964_782.0).unwrap().contains("GPS epoch"));
        assert!(first(3600.2).unwrap().contains("1 h"));
        assert!(first(-604_800.0 * 2.0).unwrap().contains("-2 whole weeks"));
        assert!(first(-619_315_200.0).unwrap().contains("rollover"));
        assert!(first(2_208_988_800.0).unwrap().contains("NTP"));
        assert!(first(4294.9).unwrap().contains("microsecond counter"));
        assert!(first(4.3).unwrap().contains("nanosecond counter"));
        assert!(first(1.05).unwrap().contains("pulse per second"));
        for unnamed in [11.0, 0.1, 1234.0, -0.7, 4.6, 5_701_000.0] {
            assert_eq!(first(unnamed), None, "{unnamed}");
        }
    }

    #[test]
    fn leap_seconds_are_those_of_the_day() {
        for (unix, gps, tai) in [(1.18e9, 14.0, 33.0), (1.38e9, 16.0, 35.0), (1.46e9, 17.0, 36.0)] {
            assert!(words(gps, unix).unwrap().contains(&format!("{gps} leap")), "{unix}");
            assert!(words(-tai, unix).unwrap().contains(&format!("{tai} leap")), "{unix}");
        }
        assert_eq!(words(17.0, 1.7e9), None);
        assert_eq!(words(36.0, 1.7e9), None);
    }

    #[test]
    fn between_two_names_none_is_believed() {
        assert!(matches!(
            explain(
                18.4,
                Tolerance {
                    usual_s: 1.0,
                    fine_s: 0.1
                },
                1.7e9
            ),
            Explanation::Several(both) if both.len() == 2
        ));
    }
}
