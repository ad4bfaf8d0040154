//! Sentences of NMEA 0183 as fixes.
//!
//! Owns the conversion to a fix. Must not judge.

use crate::world::motion::{FixRow, NmeaRow, Series};

/// The positions in the sentences. The height is above the ellipsoid if the receiver states the geoid separation; NaN
/// otherwise. Several sentences with the position of one time count once.
pub(crate) fn positions(sentences: &Series<NmeaRow>) -> Series<FixRow> {
    let mut stretches = Vec::new();
    for rows in &sentences.stretches {
        let mut before_s = f64::NAN;
        let mut is_new = |row: &NmeaRow| {
            let known_s = std::mem::replace(&mut before_s, row.time_s);
            row.time_s.is_nan() || row.time_s.to_bits() != known_s.to_bits()
        };
        let placed = rows.iter().filter(|row| row.latitude_deg.is_finite());
        let fixes: Vec<FixRow> = placed.filter(|row| is_new(row)).map(fix).collect();
        if !fixes.is_empty() {
            stretches.push(fixes);
        }
    }
    Series {
        count: sentences.count,
        stretches,
    }
}

fn fix(row: &NmeaRow) -> FixRow {
    FixRow {
        stamp_ns: row.stamp_ns,
        log_ns: row.log_ns,
        latitude_deg: row.latitude_deg,
        longitude_deg: row.longitude_deg,
        altitude_m: row.altitude_m + row.geoid_separation_m,
        variance_m2: [0.0; 3],
        status: match row.quality {
            Some(2) => 1,
            Some(3..=5) => 2,
            _ => 0,
        },
    }
}
