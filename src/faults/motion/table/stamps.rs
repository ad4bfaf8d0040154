//! Mistakes of stamps.

use super::super::stamps::StampChange;
use crate::faults::Fault;

/// To record for an offset that the recorder's clock shows.
const ANY: &str = "the topic with its stamps, on a computer whose clock is set";
/// To record for an offset that only motion shows.
const MOTION: &str =
    "a second sensor of the same motion (an IMU, odometry, a receiver, a lidar), on a drive of some minutes with turns";

/// Every mistake.
pub(super) static FAULTS: &[Fault] = &[
    fault!(
        Time,
        "stamps-gps-time",
        "Stamps are in GPS time where UTC is meant: 18 s ahead since 2017.",
        StampChange::GpsTime,
        [],
        ["GPS time used as UTC"],
        ["TIME01", "TIME02"],
        ANY
    ),
    fault!(
        Time,
        "stamps-tai-as-gps",
        "Stamps are 19 s ahead: TAI taken for GPS time.",
        StampChange::Ahead(19.0),
        [],
        ["TAI used as GPS time"],
        ["TIME01", "TIME02"],
        ANY
    ),
    fault!(
        Time,
        "stamps-tai",
        "Stamps are in TAI, the time of PTP, where UTC is meant: 37 s ahead since 2017.",
        StampChange::Tai,
        [],
        ["TAI (PTP) used as UTC"],
        ["TIME01", "TIME02"],
        ANY
    ),
    fault!(
        Time,
        "stamps-gps-epoch",
        "Stamps count from 1980, the epoch of GPS, where 1970 is meant.",
        StampChange::GpsEpoch,
        [],
        ["the GPS epoch (1980) used as the Unix epoch"],
        ["TIME01", "TIME02"],
        ANY
    ),
    fault!(
        Time,
        "stamps-time-zone",
        "Stamps are in local time where UTC is meant: an hour ahead.",
        StampChange::Ahead(3600.0),
        [],
        ["local time used as UTC"],
        ["TIME01", "TIME02"],
        ANY
    ),
    fault!(
        Time,
        "stamps-zero",
        "Stamps are zero: the header is not filled in.",
        StampChange::Zero,
        [],
        ["of the header stamps are zero"],
        ["TIME04"],
        ANY
    ),
    fault!(
        Time,
        "stamps-late",
        "Messages are stamped on arrival, 0.1 s after the measurement.",
        StampChange::OnArrival(0.1),
        [],
        ["is stamped 0."],
        ["TIME09", "TIME10"],
        MOTION
    ),
    fault!(
        Time,
        "stamps-later",
        "Messages are stamped on arrival, 0.3 s after the measurement.",
        StampChange::OnArrival(0.3),
        [],
        ["is stamped 0."],
        ["TIME09", "TIME10"],
        MOTION
    ),
    fault!(
        Time,
        "stamps-ahead",
        "Stamps are 0.3 s ahead of the measurement.",
        StampChange::Ahead(0.3),
        [],
        ["ahead of the recorder's clock", "ahead of", "is stamped 0."],
        ["TIME02", "TIME09"],
        MOTION
    ),
    fault!(
        Time,
        "stamps-behind",
        "Stamps are 0.3 s behind the measurement.",
        StampChange::Ahead(-0.3),
        [],
        ["behind the recorder's clock", "is stamped 0."],
        ["TIME09"],
        MOTION
    ),
];
