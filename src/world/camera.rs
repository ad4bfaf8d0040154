//! Evidence of cameras: their calibrations, and the size of their images. Bounded, as published.

use serde::{Deserialize, Serialize};

use crate::source::{MessageRef, Place};

/// Different calibrations of one topic that are kept.
pub const MAX_CALIBRATIONS: usize = 8;
/// Different forms of images of one topic that are kept.
pub const MAX_FORMS: usize = 8;

/// The camera model, as in `sensor_msgs/msg/CameraInfo`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraModel {
    /// Width and height of the calibrated image, pixels.
    pub size: [u32; 2],
    /// `distortion_model`.
    pub model: String,
    /// Coefficients of the distortion.
    #[serde(with = "super::number::list")]
    pub d: Vec<f64>,
    /// Intrinsics of the raw image, row-major 3x3, pixels.
    #[serde(with = "super::number::array")]
    pub k: [f64; 9],
    /// Rectification `rectified_from_camera`, row-major 3x3.
    #[serde(with = "super::number::array")]
    pub r: [f64; 9],
    /// Projection of the rectified image, row-major 3x4, pixels; its fourth column pixels times metres.
    #[serde(with = "super::number::array")]
    pub p: [f64; 12],
    /// Pixels that are binned, horizontally and vertically; 0 is 1.
    pub binning: [u32; 2],
    /// The part that images show, pixels of the full image: left, top, width, height; all zeros is the whole image.
    pub roi: [u32; 4],
}

/// One calibration as published.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// The first message that has it.
    pub at: MessageRef,
    /// How many messages have it.
    pub count: u64,
    /// Its content.
    #[serde(flatten)]
    pub camera: CameraModel,
}

/// A camera that a file of camera_info_manager describes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraFile {
    /// `camera_name`.
    pub name: String,
    /// Its camera matrix.
    pub place: Place,
    /// Its content.
    pub camera: CameraModel,
}

/// The time offset between a camera and the IMU, as a file states it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StatedDelay {
    /// The key that states it.
    pub key: String,
    /// The number of the camera.
    pub camera: u32,
    /// `t_imu - t_cam` of one event, seconds.
    #[serde(with = "super::number")]
    pub offset_s: f64,
    /// The number.
    pub place: Place,
}

/// Calibrations of one topic.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CalibrationEvidence {
    /// Messages.
    pub count: u64,
    /// The first different ones.
    pub calibrations: Vec<Calibration>,
    /// Messages with others.
    pub others: u64,
}

/// Images of one form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImageForm {
    /// The first image of the form.
    pub at: MessageRef,
    /// How many messages have it.
    pub count: u64,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// `encoding`.
    pub encoding: String,
}

/// Images of one topic.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImageEvidence {
    /// Messages.
    pub count: u64,
    /// The first different forms.
    pub forms: Vec<ImageForm>,
    /// Messages of others.
    pub others: u64,
}
