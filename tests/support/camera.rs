//! Cameras of recipes: calibrations and images without their bytes.

use serde::Deserialize;

use super::encode::Field;

/// A grid, as published.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// Side of a cell, metres.
    pub resolution: f64,
    /// Cells along x and y.
    pub size: [u32; 2],
    /// x, y, z, metres.
    #[serde(default)]
    pub origin: [f64; 3],
    /// x, y, z, w.
    #[serde(default = "no_turn")]
    pub orientation: [f64; 4],
    /// Cells that follow, all unknown; as many as the size says by default.
    pub data: Option<usize>,
}

fn no_turn() -> [f64; 4] {
    [0.0, 0.0, 0.0, 1.0]
}

impl Grid {
    /// The fields of a `nav_msgs/msg/OccupancyGrid` behind its header.
    pub fn occupancy(&self) -> Vec<Field<'_>> {
        let [width, height] = self.size;
        let cells = usize::try_from(width * height).unwrap();
        vec![
            Field::U32(0),
            Field::U32(0),
            Field::F32(self.resolution as f32),
            Field::U32(width),
            Field::U32(height),
            Field::F64s(self.origin.into()),
            Field::F64s(self.orientation.into()),
            Field::Bytes(vec![255; self.data.unwrap_or(cells)]),
        ]
    }

    /// The fields of a `grid_map_msgs/msg/GridMap` behind its header.
    pub fn layers(&self) -> Vec<Field<'_>> {
        let lengths = self.size.map(|cells| f64::from(cells) * self.resolution);
        vec![
            Field::F64s(vec![self.resolution, lengths[0], lengths[1]]),
            Field::F64s(self.origin.into()),
            Field::F64s(self.orientation.into()),
            Field::Empty(3),
            Field::U16(0),
            Field::U16(0),
        ]
    }
}

/// What a camera says, as published.
#[derive(Clone, Debug, Deserialize)]
pub struct Camera {
    /// Width and height, pixels.
    pub size: [u32; 2],
    #[serde(default = "default_encoding")]
    pub encoding: String,
    #[serde(default = "default_model")]
    pub model: String,
    #[serde(default)]
    pub d: Vec<f64>,
    /// fx, fy, cx, cy; or all nine numbers.
    #[serde(default)]
    pub k: Vec<f64>,
    pub r: Option<[f64; 9]>,
    /// fx, fy, cx, cy, Tx; or all twelve numbers. That of K by default.
    #[serde(default)]
    pub p: Vec<f64>,
    #[serde(default)]
    pub binning: [u32; 2],
    /// Left, top, width, height.
    #[serde(default)]
    pub roi: [u32; 4],
}

fn default_encoding() -> String {
    "rgb8".to_owned()
}

fn default_model() -> String {
    "plumb_bob".to_owned()
}

impl Camera {
    /// The fields of a `sensor_msgs/msg/Image` behind its header; no bytes follow.
    pub fn image(&self) -> Vec<Field<'_>> {
        let [width, height] = self.size;
        vec![
            Field::U32(height),
            Field::U32(width),
            Field::Text(&self.encoding),
            Field::U8(0),
            Field::U32(0),
            Field::Empty(1),
        ]
    }

    /// The fields of a `sensor_msgs/msg/CameraInfo` behind its header.
    pub fn info(&self) -> Vec<Field<'_>> {
        let [width, height] = self.size;
        let k = match self.k[..] {
            [fx, fy, cx, cy] => vec![fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
            [] => vec![0.0; 9],
            ref whole => whole.to_vec(),
        };
        let p = match self.p[..] {
            [fx, fy, cx, cy, tx] => vec![fx, 0.0, cx, tx, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
            [] => {
                let mut p = vec![0.0; 12];
                for row in 0..3 {
                    p[4 * row..4 * row + 3].copy_from_slice(&k[3 * row..3 * row + 3]);
                }
                p
            }
            ref whole => whole.to_vec(),
        };
        assert_eq!((k.len(), p.len()), (9, 12), "K has 4 or 9 numbers, P 5 or 12");
        let [binning_x, binning_y] = self.binning;
        let [x, y, roi_width, roi_height] = self.roi;
        vec![
            Field::U32(height),
            Field::U32(width),
            Field::Text(&self.model),
            Field::Numbers(self.d.clone()),
            Field::F64s(k),
            Field::F64s(self.r.unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]).into()),
            Field::F64s(p),
            Field::U32(binning_x),
            Field::U32(binning_y),
            Field::U32(x),
            Field::U32(y),
            Field::U32(roi_height),
            Field::U32(roi_width),
            Field::U8(0),
        ]
    }
}
