//! How a run was asked for, as its report tells it: the command line, and the day.

use std::ffi::OsString;

use crate::report;
use crate::verdict::waiver::Day;

use super::Failure;

/// The command line, for those who want to give it again.
pub(super) fn of(arguments: &[OsString]) -> report::Call {
    let given = arguments
        .iter()
        .skip(1)
        .map(|argument| argument.to_string_lossy().into_owned());
    report::Call {
        command: std::iter::once(env!("CARGO_PKG_NAME").to_owned())
            .chain(given)
            .collect(),
        ..report::Call::default()
    }
}

/// The day that `SOURCE_DATE_EPOCH` names, where it is set: reports can be made again as they were.
pub(super) fn today() -> Result<Option<Day>, Failure> {
    let Some(text) = std::env::var_os("SOURCE_DATE_EPOCH").filter(|text| !text.is_empty()) else {
        return Ok(None);
    };
    let moment = text
        .to_str()
        .and_then(|text| text.parse::<u64>().ok())
        .and_then(|seconds| std::time::SystemTime::UNIX_EPOCH.checked_add(std::time::Duration::from_secs(seconds)));
    let moment = moment.ok_or_else(|| Failure::Usage("SOURCE_DATE_EPOCH is no number of seconds".to_owned()))?;
    Ok(Some(Day::of(moment)))
}
