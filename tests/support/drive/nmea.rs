//! NMEA 0183 sentences of a drive's receiver. Their time is UTC of what they show, whatever the stamp says.

use super::description::Gnss;
use super::rows::FixRow;
use super::{Drive, Stream};

/// A kind of sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Kind {
    /// Position, and height above the geoid.
    Gga,
    /// Position, speed and course.
    Rmc,
    /// True heading.
    Hdt,
}

impl Drive {
    /// The sentences of each time, with checksum, without line end. `start_s` is the Unix time of the start.
    pub fn sentences(&self, stream: &Stream, kinds: &[Kind], start_s: f64) -> Vec<Vec<String>> {
        assert!(stream.errors.is_empty(), "NMEA sentences have no errors");
        let fixes = self.fix_rows(stream);
        let velocities = self.velocity_rows(stream);
        let headings = self.heading_rows(stream);
        let rows = fixes.iter().zip(&velocities).zip(&headings);
        rows.map(|((fix, velocity), heading)| {
            let clock = Clock::new(start_s + fix.t_s - stream.late_s);
            let [.., z, w] = heading.orientation;
            let sentence = |kind: &Kind| match kind {
                Kind::Gga => self.gga(&clock, fix),
                Kind::Rmc => rmc(&clock, fix, velocity.linear),
                Kind::Hdt => format!("GPHDT,{:.3},T", compass(2.0 * z.atan2(w))),
            };
            kinds.iter().map(|kind| sealed(&sentence(kind))).collect()
        })
        .collect()
    }

    fn gga(&self, clock: &Clock, fix: &FixRow) -> String {
        let quality = if self.description.gnss == Gnss::Single { 1 } else { 4 };
        let undulation = self.description.undulation_m;
        format!(
            "GPGGA,{},{},{quality},14,0.8,{:.3},M,{undulation:.3},M,,",
            clock.time,
            place(fix),
            fix.altitude - undulation
        )
    }
}

fn rmc(clock: &Clock, fix: &FixRow, [east, north, _]: [f64; 3]) -> String {
    let knots = east.hypot(north) / (1852.0 / 3600.0);
    let course = compass(north.atan2(east));
    format!(
        "GPRMC,{},A,{},{knots:.3},{course:.2},{},,,A",
        clock.time,
        place(fix),
        clock.date
    )
}

/// A direction from east towards north as degrees from north towards east.
pub fn compass(yaw: f64) -> f64 {
    (90.0 - yaw.to_degrees()).rem_euclid(360.0)
}

/// A sentence with its dollar sign and checksum.
fn sealed(text: &str) -> String {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${text}*{sum:02X}")
}

fn place(fix: &FixRow) -> String {
    let part = |degrees: f64, digits: usize, [plus, minus]: [char; 2]| {
        let whole = (degrees.abs() * 60.0 * 1e7).round() as i64;
        let (minutes, rest) = (whole / 10_000_000, whole % 10_000_000);
        let sign = if degrees < 0.0 { minus } else { plus };
        format!("{:0digits$}{:02}.{rest:07},{sign}", minutes / 60, minutes % 60)
    };
    let latitude = part(fix.latitude, 2, ['N', 'S']);
    format!("{latitude},{}", part(fix.longitude, 3, ['E', 'W']))
}

struct Clock {
    time: String,
    date: String,
}

impl Clock {
    fn new(unix_s: f64) -> Self {
        let hundredths = (unix_s * 100.0).round() as i64;
        let (days, of_day) = (hundredths.div_euclid(8_640_000), hundredths.rem_euclid(8_640_000));
        let (seconds, hundredths) = (of_day / 100, of_day % 100);
        // The civil date of a count of days (Howard Hinnant): years begin in March, eras have 400 years.
        let shifted = days + 719_468;
        let (era, of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
        let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
        let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
        let from_march = (5 * of_year + 2) / 153;
        let day = of_year - (153 * from_march + 2) / 5 + 1;
        let month = if from_march < 10 {
            from_march + 3
        } else {
            from_march - 9
        };
        let year = year_of_era + era * 400 + i64::from(month <= 2);
        Self {
            time: format!(
                "{:02}{:02}{:02}.{hundredths:02}",
                seconds / 3600,
                seconds / 60 % 60,
                seconds % 60
            ),
            date: format!("{day:02}{month:02}{:02}", year % 100),
        }
    }
}
