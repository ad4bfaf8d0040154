//! Published datasets: the axes that their frames are expressed in.

use serde::Deserialize;

use super::captured;
use super::rows::Row;

/// A dataset.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dataset {
    /// Its name in reports.
    pub name: String,
    /// Lower-case words by which the configuration names it.
    words: Vec<String>,
    /// Its frames; the first match of a name counts.
    pub frames: Vec<DatasetFrame>,
    /// The order of its quaternions: `wxyz` or `xyzw`.
    #[serde(default)]
    pub quaternion: Option<QuaternionWord>,
    /// Whether the source was checked.
    #[serde(default)]
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

/// Frames of a dataset that are expressed in the same axes.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DatasetFrame {
    /// Their names, in lower case; `*` is any text.
    names: Vec<String>,
    /// Where x, y and z point on the vehicle.
    pub axes: Axes,
    /// Whether only the vertical axis is fixed: a camera that looks to the side.
    #[serde(default)]
    pub any_yaw: bool,
}

/// The order of quaternions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum QuaternionWord {
    /// The scalar first.
    Wxyz,
    /// The scalar last.
    Xyzw,
}

/// The directions of x, y and z of a frame: `FLU` is forward, left, up. Right-handed.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Axes {
    /// As it is written.
    pub word: String,
    /// Each axis in forward, left, up.
    pub vectors: [[f64; 3]; 3],
}

impl TryFrom<String> for Axes {
    type Error = String;

    fn try_from(word: String) -> Result<Self, String> {
        let vectors: Option<Vec<[f64; 3]>> = word.chars().map(vector).collect();
        let vectors: Option<[[f64; 3]; 3]> = vectors.and_then(|vectors| vectors.try_into().ok());
        let vectors = vectors.filter(|[x, y, z]| {
            let cross = [
                x[1] * y[2] - x[2] * y[1],
                x[2] * y[0] - x[0] * y[2],
                x[0] * y[1] - x[1] * y[0],
            ];
            cross.iter().zip(z).all(|(a, b)| (a - b).abs() < 0.5)
        });
        let vectors = vectors.ok_or_else(|| {
            format!("`{word}` is not a right-handed choice of three of F, B, L, R, U, D, such as FLU or RDF")
        })?;
        Ok(Self { word, vectors })
    }
}

fn vector(letter: char) -> Option<[f64; 3]> {
    Some(match letter {
        'F' => [1.0, 0.0, 0.0],
        'B' => [-1.0, 0.0, 0.0],
        'L' => [0.0, 1.0, 0.0],
        'R' => [0.0, -1.0, 0.0],
        'U' => [0.0, 0.0, 1.0],
        'D' => [0.0, 0.0, -1.0],
        _ => return None,
    })
}

impl Dataset {
    /// Whether the configuration names it by this word.
    pub fn is_called(&self, word: &str) -> bool {
        let word = word.to_lowercase();
        word == self.name.to_lowercase() || self.words.contains(&word)
    }

    /// What is known about a frame.
    pub fn frame(&self, name: &str) -> Option<&DatasetFrame> {
        let name = name.trim_start_matches('/').to_lowercase();
        let fits = |frame: &&DatasetFrame| frame.names.iter().any(|pattern| captured(pattern, &name).is_some());
        self.frames.iter().find(fits)
    }
}

impl Row for Dataset {
    fn source_mut(&mut self) -> &mut String {
        &mut self.source
    }

    fn fault(&self) -> Option<(&'static str, &'static str)> {
        if self.words.is_empty() || self.words.iter().any(|word| *word != word.to_lowercase()) {
            return Some(("words", "at least one word in lower case is required"));
        }
        let is_well = |frame: &DatasetFrame| {
            !frame.names.is_empty() && frame.names.iter().all(|name| *name == name.to_lowercase())
        };
        let are_well = !self.frames.is_empty() && self.frames.iter().all(is_well);
        (!are_well).then_some(("frames", "at least one frame with names in lower case is required"))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::tables::Tables;

    #[test]
    fn axes_are_right_handed() {
        for word in ["FLU", "RDF", "RFU", "FRD", "URF", "LUF"] {
            assert!(Axes::try_from(word.to_owned()).is_ok(), "{word}");
        }
        for word in ["FRU", "FL", "FLX", "FFU", "flu", ""] {
            assert!(Axes::try_from(word.to_owned()).is_err(), "{word}");
        }
        let [.., z] = Axes::try_from("RDF".to_owned()).unwrap().vectors;
        assert!(z.iter().zip([1.0, 0.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn frames_are_known_by_their_names() {
        let tables = Tables::default();
        let of = |dataset: &str, frame: &str| {
            let row = tables.dataset(dataset).unwrap();
            row.frame(frame).map(|frame| (frame.axes.word.clone(), frame.any_yaw))
        };
        assert_eq!(of("kitti", "velo"), Some(("FLU".to_owned(), false)));
        assert_eq!(of("KITTI", "camera_color_left"), Some(("RDF".to_owned(), false)));
        assert_eq!(of("nuScenes", "/CAM_FRONT"), Some(("RDF".to_owned(), false)));
        assert_eq!(of("nuscenes", "CAM_BACK_LEFT"), Some(("RDF".to_owned(), true)));
        assert_eq!(of("nuscenes", "LIDAR_TOP"), Some(("RFU".to_owned(), false)));
        assert_eq!(of("euroc", "B"), Some(("URF".to_owned(), false)));
        assert_eq!(of("kitti", "base_link"), None);
        assert!(tables.dataset("town").is_none());
    }
}
