//! Sentences of NMEA 0183 inside messages.
//!
//! Owns the fields of the sentences that are read. Written here, not taken from a crate: `nmea` 0.8 refuses GNS of more
//! than two satellite systems and GGA of quality 9, drops a VTG's speed in km/h and knows neither HDG nor HDM, and the
//! errors here name the byte. Sources: IEC 61162-1; E. S. Raymond, NMEA Revealed (gpsd.gitlab.io/gpsd/NMEA.html).

use super::content::{Body, Nmea, Sentence};
use super::{Cursor, DecodeError};

/// Bound on the fields of a sentence; those that are read have up to 15.
const MAX_FIELDS: usize = 24;
/// m/s in a knot: 1852 m in an hour.
const KNOT: f64 = 1852.0 / 3600.0;

/// Reads a text at the cursor. Other sentences, and other texts, are ignored.
pub(super) fn body<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let (at, text) = cursor.str_at()?;
    let nmea = sentence(text, at)?;
    Ok(nmea.map_or(Body::Nothing, |nmea| Body::Nmea(Box::new(nmea))))
}

/// Reads a text that begins at byte `at` of its message.
fn sentence(text: &str, at: usize) -> Result<Option<Nmea>, DecodeError> {
    let at = at + (text.len() - text.trim_start().len());
    let text = text.trim();
    let Some(rest) = text.strip_prefix('$') else {
        return Ok(None);
    };
    let Some(kind) = rest.split(',').next().and_then(kind_of) else {
        return Ok(None);
    };
    let Some((data, said)) = rest.split_once('*') else {
        return Err(DecodeError(format!("the NMEA sentence at byte {at} has no checksum")));
    };
    let sum = data.bytes().fold(0, |sum, byte| sum ^ byte);
    let is_hex = said.len() == 2 && said.bytes().all(|digit| digit.is_ascii_hexdigit());
    if !is_hex || u8::from_str_radix(said, 16) != Ok(sum) {
        let what = format!("the NMEA sentence at byte {at} has a wrong checksum; it should be {sum:02X}");
        return Err(DecodeError(what));
    }
    Fields::of(data, at + 1).read(kind).map(Some)
}

/// The sentence of an address: two letters for the sender, three for the sentence. Proprietary ones begin with P.
fn kind_of(address: &str) -> Option<Sentence> {
    if address.len() != 5 || !address.is_ascii() || address.starts_with('P') {
        return None;
    }
    Some(match address.get(2..)? {
        "GGA" => Sentence::Gga,
        "GNS" => Sentence::Gns,
        "RMC" => Sentence::Rmc,
        "VTG" => Sentence::Vtg,
        "HDT" => Sentence::Hdt,
        "HDG" => Sentence::Hdg,
        "HDM" => Sentence::Hdm,
        _ => return None,
    })
}

/// The fields of a sentence, each with the byte it begins at; the first one is the address.
struct Fields<'t>(Vec<(usize, &'t str)>);

impl<'t> Fields<'t> {
    fn of(data: &'t str, at: usize) -> Self {
        let mut next = at;
        let fields = data.split(',').take(MAX_FIELDS).map(|field| {
            let begin = next;
            next += field.len() + 1;
            (begin, field)
        });
        Self(fields.collect())
    }

    fn read(&self, kind: Sentence) -> Result<Nmea, DecodeError> {
        let mut nmea = Nmea {
            sentence: kind,
            time_s: None,
            position: None,
            altitude_m: None,
            geoid_separation_m: None,
            quality: None,
            speed_m_s: None,
            course_deg: None,
            true_heading_deg: None,
            magnetic_heading_deg: None,
            variation_deg: None,
        };
        match kind {
            Sentence::Gga => {
                nmea.time_s = self.time(1)?;
                nmea.position = self.position(2)?;
                nmea.quality = self.digit(6)?;
                nmea.altitude_m = self.number_in(9, "M")?;
                nmea.geoid_separation_m = self.number_in(11, "M")?;
            }
            Sentence::Gns => {
                nmea.time_s = self.time(1)?;
                nmea.position = self.position(2)?;
                nmea.quality = self.mode(6)?;
                nmea.altitude_m = self.number(9)?;
                nmea.geoid_separation_m = self.number(10)?;
            }
            Sentence::Rmc => {
                nmea.time_s = self.time(1)?;
                nmea.position = self.position(3)?;
                nmea.speed_m_s = self.number(7)?.map(|knots| knots * KNOT);
                nmea.course_deg = self.number(8)?;
                nmea.variation_deg = self.towards(10, "E", "W")?;
                // Since version 2.3 a letter states more than the status, which is A for valid and V for not.
                nmea.quality = match (self.text(2), self.mode(12)?) {
                    ("A", mode) => mode.or(Some(1)),
                    _ => Some(0),
                };
            }
            Sentence::Vtg => {
                nmea.course_deg = self.number_in(1, "T")?;
                let knots = self.number_in(5, "N")?.map(|knots| knots * KNOT);
                let km_h = self.number_in(7, "K")?.map(|km_h| km_h / 3.6);
                nmea.speed_m_s = knots.or(km_h);
                nmea.quality = self.mode(9)?;
            }
            Sentence::Hdt => nmea.true_heading_deg = self.number(1)?,
            Sentence::Hdg => {
                let deviation = self.towards(2, "E", "W")?.unwrap_or(0.0);
                nmea.magnetic_heading_deg = self.number(1)?.map(|read| (read + deviation).rem_euclid(360.0));
                nmea.variation_deg = self.towards(4, "E", "W")?;
            }
            Sentence::Hdm => nmea.magnetic_heading_deg = self.number(1)?,
        }
        Ok(nmea)
    }

    /// A field; a missing one is empty.
    fn text(&self, number: usize) -> &'t str {
        self.0.get(number).map_or("", |(_, text)| text)
    }

    fn fault(&self, number: usize, wanted: &str) -> DecodeError {
        let at = self.0.get(number).map_or(0, |(at, _)| *at);
        DecodeError(format!(
            "field {number} of an NMEA sentence, at byte {at}, is not {wanted}"
        ))
    }

    fn number(&self, number: usize) -> Result<Option<f64>, DecodeError> {
        let text = self.text(number);
        if text.is_empty() {
            return Ok(None);
        }
        // `parse` takes `inf`, `nan` and `1e9`, too.
        let is_plain = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.".contains(&byte));
        let value = text.parse::<f64>().ok().filter(|_| is_plain);
        value.map(Some).ok_or_else(|| self.fault(number, "a number"))
    }

    /// A number followed by its unit, or nothing.
    fn number_in(&self, number: usize, unit: &str) -> Result<Option<f64>, DecodeError> {
        let value = self.number(number)?;
        if value.is_some() && !["", unit].contains(&self.text(number + 1)) {
            return Err(self.fault(number + 1, &format!("the unit `{unit}`")));
        }
        Ok(value)
    }

    /// A number followed by a letter for its direction.
    fn towards(&self, number: usize, plus: &str, minus: &str) -> Result<Option<f64>, DecodeError> {
        let Some(value) = self.number(number)? else {
            return Ok(None);
        };
        match self.text(number + 1) {
            letter if letter == plus => Ok(Some(value)),
            letter if letter == minus => Ok(Some(-value)),
            _ => Err(self.fault(number + 1, &format!("`{plus}` or `{minus}`"))),
        }
    }

    /// Latitude and longitude with their letters, in four fields.
    fn position(&self, number: usize) -> Result<Option<[f64; 2]>, DecodeError> {
        let latitude = self.towards(number, "N", "S")?;
        let longitude = self.towards(number + 2, "E", "W")?;
        let (Some(latitude), Some(longitude)) = (latitude, longitude) else {
            return Ok(None);
        };
        let latitude = degrees(latitude, 90.0).ok_or_else(|| self.fault(number, "a latitude"))?;
        let longitude = degrees(longitude, 180.0).ok_or_else(|| self.fault(number + 2, "a longitude"))?;
        Ok(Some([latitude, longitude]))
    }

    /// A time of the day, `hhmmss.ss`.
    fn time(&self, number: usize) -> Result<Option<f64>, DecodeError> {
        let Some(value) = self.number(number)? else {
            return Ok(None);
        };
        let (hours, rest) = ((value / 1e4).trunc(), value % 1e4);
        let (minutes, seconds) = ((rest / 1e2).trunc(), rest % 1e2);
        let is_time = (0.0..24.0).contains(&hours) && minutes < 60.0 && (0.0..61.0).contains(&seconds);
        let time = is_time.then_some(hours * 3600.0 + minutes * 60.0 + seconds);
        time.map(Some).ok_or_else(|| self.fault(number, "a time"))
    }

    fn digit(&self, number: usize) -> Result<Option<u8>, DecodeError> {
        match *self.text(number).as_bytes() {
            [] => Ok(None),
            [digit] if digit.is_ascii_digit() => Ok(Some(digit - b'0')),
            _ => Err(self.fault(number, "a digit")),
        }
    }

    /// A quality in letters, one for each satellite system: that of the first system with a fix.
    fn mode(&self, number: usize) -> Result<Option<u8>, DecodeError> {
        let mut mode = None;
        for letter in self.text(number).bytes() {
            let quality = match letter {
                b'A' => 1,
                b'D' => 2,
                b'P' => 3,
                b'R' => 4,
                b'F' => 5,
                b'E' => 6,
                b'M' => 7,
                b'S' => 8,
                // C and U (caution, unsafe) must not be used, like N.
                b'N' | b'C' | b'U' => 0,
                _ => return Err(self.fault(number, "a mode")),
            };
            mode = mode.filter(|known| *known > 0).or(Some(quality));
        }
        Ok(mode)
    }
}

/// Degrees of a number written `dddmm.mmm`.
fn degrees(written: f64, most: f64) -> Option<f64> {
    let (whole, minutes) = ((written / 100.0).trunc(), written % 100.0);
    let degrees = whole + minutes / 60.0;
    (minutes.abs() < 60.0 && degrees.abs() <= most).then_some(degrees)
}
