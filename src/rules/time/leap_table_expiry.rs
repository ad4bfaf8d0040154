//! TIME11: a recording is newer than the table of leap seconds that it is judged by.

use std::time::{Duration, UNIX_EPOCH};

use crate::analysis::time::streams::{Clock, log_clock};
use crate::rules::prelude::*;
use crate::tables::leap_seconds;
use crate::verdict::waiver::Day;

pub(crate) struct LeapTableExpiry;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    beyond_days: f64,
    absurd_days: f64,
}

impl Rule for LeapTableExpiry {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let table = leap_seconds();
        for bag in &world.bags {
            let subject = format!("recorder's clock of {}", world.path(bag.source));
            let (Some(end_ns), Clock::Calendar) = (bag.end_ns, log_clock(bag)) else {
                out.not_applicable(subject, "the recorder's clock is not calendar time");
                continue;
            };
            let days = (end_ns as f64 / 1e9 - table.expires.unix_s as f64) / 86_400.0;
            let measured =
                Measured::new("end of the recording after the end of the table", days, "d").limit(limits.beyond_days);
            if days > limits.absurd_days {
                let why = format!(
                    "the recorder's clock is {days:.0} days past the end of the leap second table: it was probably not set"
                );
                out.not_evaluated(subject, NotEvaluated::InputBroken, why);
                continue;
            }
            if days <= limits.beyond_days {
                out.pass(subject, [measured]);
                continue;
            }
            let (gps, tai) = (table.gps_minus_utc_s(f64::MAX), table.tai_minus_utc_s(f64::MAX));
            let (end, expires) = (day(end_ns / 1_000_000_000), day(table.expires.unix_s));
            let message = format!("recording ends on {end}, the table of leap seconds in frames-lint on {expires}");
            out.fail(
                Finding::note(subject, message, Place::whole(bag.source))
                    .detail(format!(
                        "GPS - UTC = {gps} s and TAI - UTC = {tai} s may have changed since {expires}: findings on leap seconds may be wrong \
                         by one second."
                    ))
                    .help(format!(
                        "install a newer release of frames-lint; if the recording was not made on {end}, correct the clock of the recorder"
                    ))
                    .measured(measured),
            );
        }
    }
}

/// The date of a time of the calendar, seconds.
fn day(unix_s: i64) -> String {
    let since = Duration::from_secs(unix_s.unsigned_abs());
    let moment = if unix_s < 0 {
        UNIX_EPOCH.checked_sub(since)
    } else {
        UNIX_EPOCH.checked_add(since)
    };
    moment.map_or_else(|| "?".to_owned(), |moment| Day::of(moment).as_str().to_owned())
}
