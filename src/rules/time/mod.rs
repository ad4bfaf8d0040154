//! TIME: stamps, clocks and their offsets.

pub mod clock_domain;
pub mod epoch_offset;
mod gaps;
mod known_offsets;
mod laser;
mod lateness;
pub mod leap_table_expiry;
mod naming;
mod offsets;
pub mod point_time_missing;
pub mod point_time_reference;
pub mod point_time_sweep;
pub mod point_time_unit;
mod reference;
pub mod sensor_time_offset;
mod simulated;
pub mod stamp_monotonic;
pub mod stamp_vs_log;
mod streams;
pub mod tf_vs_sensor_time;
mod together;
mod told;
mod trend;
mod turning;
mod units;

pub(crate) use together::tell_once;
