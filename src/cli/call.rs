//! How a run was called, for its report: the command line and the date.

use std::ffi::OsString;

use crate::report;
use crate::verdict::waiver::Day;

use super::Failure;

/// The command line, so that the run can be repeated, and the date.
pub(super) fn of(arguments: &[OsString], today: &Day) -> report::Call {
    let given = arguments
        .iter()
        .skip(1)
        .map(|argument| argument.to_string_lossy().into_owned());
    report::Call {
        command: std::iter::once(env!("CARGO_PKG_NAME").to_owned())
            .chain(given)
            .collect(),
        day: Some(today.as_str().to_owned()),
        ..report::Call::default()
    }
}

/// The date of the run (UTC): that of `SOURCE_DATE_EPOCH` if it is set, so that reports are reproducible.
pub(super) fn today() -> Result<Day, Failure> {
    let Some(text) = std::env::var_os("SOURCE_DATE_EPOCH").filter(|text| !text.is_empty()) else {
        return Ok(Day::of(std::time::SystemTime::now()));
    };
    let moment = text
        .to_str()
        .and_then(|text| text.parse::<u64>().ok())
        .and_then(|seconds| std::time::SystemTime::UNIX_EPOCH.checked_add(std::time::Duration::from_secs(seconds)));
    let moment = moment.ok_or_else(|| Failure::Usage("SOURCE_DATE_EPOCH is not a number of seconds".to_owned()))?;
    Ok(Day::of(moment))
}
