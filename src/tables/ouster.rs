//! Where the parts of an Ouster are in its Sensor frame, and the distance of its beams' origin from its axis.

use serde::Deserialize;

use super::rows::Row;

/// A part of the sensor with a frame of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OusterPart {
    /// The beams: rotated by 180 degrees about z.
    Lidar,
    /// The inertial sensor: not rotated.
    Imu,
    /// The origin of a beam, in the Lidar frame: on x, not rotated.
    Beam,
}

/// A part as the firmware of some models states it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OusterPlace {
    /// The part.
    pub part: OusterPart,
    /// The models, in words.
    pub models: String,
    /// Its product lines, the beginning of the name in metadata: `OS-1`.
    #[serde(default)]
    lines: Vec<String>,
    /// Its boards: the word of the firmware's image (`aries`, `bootes`); any if there is none.
    #[serde(default)]
    boards: Vec<String>,
    /// Its position in the Sensor frame, of a beam in the Lidar frame, millimetres.
    pub xyz_mm: [f64; 3],
    /// Whether it was read in metadata that a sensor wrote.
    #[serde(default)]
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

impl OusterPlace {
    /// Whether a sensor of this product line with this image of the firmware may have it; unknown values exclude nothing.
    pub fn may_be_of(&self, line: Option<&str>, image: Option<&str>) -> bool {
        let is_line =
            line.is_none_or(|line| self.lines.is_empty() || self.lines.iter().any(|known| is_of_line(line, known)));
        let has = |image: &str, board: &String| image.split('-').any(|word| word == board);
        let is_board = image.is_none_or(|image| {
            let is_known = ["aries", "bootes"].iter().any(|board| has(image, &(*board).to_owned()));
            !is_known || self.boards.is_empty() || self.boards.iter().any(|board| has(image, board))
        });
        is_line && is_board
    }
}

/// Whether `OS-1-64-A02` is of the line `OS-1`.
fn is_of_line(line: &str, known: &str) -> bool {
    let plain = |text: &str| text.to_ascii_uppercase().replace(['-', '_', ' '], "");
    let (line, known) = (plain(line), plain(known));
    line.strip_prefix(known.as_str()).is_some()
}

impl Row for OusterPlace {
    fn source_mut(&mut self) -> &mut String {
        &mut self.source
    }

    fn fault(&self) -> Option<(&'static str, &'static str)> {
        if self.models.is_empty() {
            return Some(("models", "the models are required, in words"));
        }
        let is_finite = self.xyz_mm.iter().all(|value| value.is_finite());
        (!is_finite).then_some(("xyz_mm", "three finite numbers are required"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::Tables;

    #[test]
    fn a_sensor_has_the_places_of_its_line_and_board() {
        let tables = Tables::default();
        let of = |part, line: Option<&str>, image: Option<&str>| -> Vec<[f64; 3]> {
            tables
                .ouster_places(part)
                .filter(|row| row.may_be_of(line, image))
                .map(|row| row.xyz_mm)
                .collect()
        };
        let aries = Some("ousteros-image-prod-aries-v2.5.2+20230714195410");
        let bootes = Some("ousteros-image-prod-bootes-v3.0.1+20230209044733");
        assert_eq!(of(OusterPart::Lidar, Some("OS-1-64-AH"), aries), [[0.0, 0.0, 36.18]]);
        assert_eq!(of(OusterPart::Lidar, Some("OS-0-128"), bootes), [[0.0, 0.0, 38.195]]);
        assert_eq!(of(OusterPart::Lidar, Some("OS-2-128"), aries).len(), 2);
        assert_eq!(of(OusterPart::Imu, Some("OS-0-128"), bootes), [[-2.441, -9.725, 7.533]]);
        assert_eq!(of(OusterPart::Beam, Some("OS-1-128"), bootes), [[16.721, 0.0, 0.0]]);
        assert_eq!(of(OusterPart::Lidar, Some("OS-1-128"), None).len(), 2);
        assert_eq!(of(OusterPart::Lidar, None, None).len(), 4);
        assert!(of(OusterPart::Lidar, Some("OS-DOME-128"), bootes).is_empty());
    }
}
