//! Dates in packets as seconds since 1970.

/// Seconds since 1970 of the date in six bytes: year, month, day, hour, minute, second. The year counts from 1900, on older
/// sensors (then below 100) from 2000; where it is zero the other bytes are the seconds since 1970, most significant first.
pub(super) fn seconds_of(date: [u8; 6]) -> Option<i64> {
    let [year, month, day, hour, minute, second] = date.map(i64::from);
    if year == 0 {
        return Some(
            [month, day, hour, minute, second]
                .iter()
                .fold(0, |sum, byte| sum << 8 | byte),
        );
    }
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || hour > 23 || minute > 59 || second > 60 {
        return None;
    }
    let year = if year < 100 { 2000 + year } else { 1900 + year };
    // Days since 1970 by years that begin in March; all these dates are after 1970.
    let (year, month) = if month > 2 {
        (year, month - 3)
    } else {
        (year - 1, month + 9)
    };
    let days = 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + day - 1 - 719_468;
    Some(((days * 24 + hour) * 60 + minute) * 60 + second)
}
