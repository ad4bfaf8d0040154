//! Rules of cameras.

use nalgebra::Vector3;

use crate::rules::names;
use crate::source::Place;
use crate::verdict::NotEvaluated;
use crate::world::camera::Calibration;
use crate::world::{BagEvidence, FrameId, World};

use super::Judge;

pub mod bev_panorama_metadata;
pub mod camera_extrinsic_direction;
pub mod camera_info_distortion;
pub mod camera_info_k_size;
pub mod camera_info_r_p;
mod declared;
mod fault;
mod grids;
pub mod lidar_in_view;
mod looks;
pub mod optical_rotation;
pub mod range_image_config;
mod range_images;
pub mod stereo_baseline;
mod views;

/// Words of cameras that look up or down on purpose.
const VERTICAL: &[&str] = &[
    "up",
    "upward",
    "upwards",
    "ceiling",
    "sky",
    "zenith",
    "down",
    "downward",
    "downwards",
    "floor",
    "ground",
    "nadir",
    "bottom",
    "belly",
    "wrist",
    "gripper",
    "hand",
    "tool",
    "arm",
    "mast",
    "head",
];

/// Words of cameras that look ahead, or back.
const AHEAD: &[&str] = &["front", "forward"];
const BACK: &[&str] = &["rear", "back", "backward", "backwards"];

/// What a camera's name says of the way it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ways {
    /// That it looks so.
    Fit,
    /// That it looks the other way.
    Against,
    /// Nothing that decides.
    Unnamed,
}

/// What a camera's name says of a direction of view in the base, a unit vector: within 45 degrees of the opposite of its name it is
/// against it, within 60 of its name it fits. Of a pair, `left` and `right` say where a camera is, and are never against it.
fn looks_against_its_name(frame: &FrameId, looks: &Vector3<f64>) -> Ways {
    let named = match (names::has_word(frame, AHEAD), names::has_word(frame, BACK)) {
        (true, false) => looks.x,
        (false, true) => -looks.x,
        _ => match (names::has_word(frame, &["left"]), names::has_word(frame, &["right"])) {
            (true, false) => looks.y.max(0.0),
            (false, true) => (-looks.y).max(0.0),
            _ => return Ways::Unnamed,
        },
    };
    let half_right = std::f64::consts::FRAC_1_SQRT_2;
    match named {
        cosine if cosine < -half_right => Ways::Against,
        cosine if cosine > 0.5 => Ways::Fit,
        _ => Ways::Unnamed,
    }
}

/// A calibration of a recording's camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Published<'w> {
    pub(crate) bag: &'w BagEvidence,
    /// The number of the recording in the world.
    pub(crate) index: usize,
    pub(crate) topic: &'w str,
    pub(crate) calibration: &'w Calibration,
    /// Its number on the topic, from 1, where there are several.
    number: Option<usize>,
}

impl<'w> Published<'w> {
    /// All of them, by topic.
    pub(crate) fn all(world: &'w World) -> impl Iterator<Item = Self> {
        world.bags.iter().enumerate().flat_map(|(index, bag)| {
            bag.topics.values().flat_map(move |topic| {
                let calibrations = topic.content.calibrations.iter().flat_map(|all| &all.calibrations);
                let several = topic
                    .content
                    .calibrations
                    .as_ref()
                    .is_some_and(|all| all.calibrations.len() > 1);
                calibrations.enumerate().map(move |(place, calibration)| Self {
                    bag,
                    index,
                    topic: &topic.topic,
                    calibration,
                    number: several.then_some(place + 1),
                })
            })
        })
    }

    /// What reports call it.
    pub(crate) fn subject(&self) -> String {
        match self.number {
            Some(number) => format!("calibration {number} on topic `{}`", self.topic),
            None => format!("calibration on topic `{}`", self.topic),
        }
    }

    pub(crate) fn place(&self) -> Place {
        Place::message(self.bag.source, self.calibration.at.clone())
    }

    /// The frame that its messages name.
    pub(crate) fn frame(&self) -> Option<FrameId> {
        let topic = self.bag.topics.get(self.topic)?;
        let mut frames = topic.header_frames.keys().map(FrameId::canonical);
        frames.find(|frame| !frame.as_str().is_empty())
    }

    /// Focal lengths and principal point, pixels: fx, fy, cx, cy.
    pub(crate) fn intrinsics(&self) -> [f64; 4] {
        let [fx, _, cx, _, fy, cy, ..] = self.calibration.k;
        [fx, fy, cx, cy]
    }

    /// Whether it says that the camera is not calibrated: K is all zeros.
    pub(crate) fn is_uncalibrated(&self) -> bool {
        self.calibration.k.iter().all(|value| *value == 0.0)
    }

    /// Whether K can be used: finite, with positive focal lengths. Else the outcome is written, with what was not looked at.
    pub(crate) fn is_usable(&self, subject: &str, out: &mut Judge) -> bool {
        let [fx, fy, cx, cy] = self.intrinsics();
        if self.is_uncalibrated() {
            let why = "K is all zeros: the camera is not calibrated";
            out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
            return false;
        }
        if ![fx, fy, cx, cy].iter().all(|value| value.is_finite()) || fx <= 0.0 || fy <= 0.0 {
            let why = "K has no positive focal lengths: CAMERA02 reports it";
            out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
            return false;
        }
        true
    }

    /// The namespace that the camera's topics share: `/front` of `/front/camera_info`.
    pub(crate) fn namespace(&self) -> &'w str {
        namespace(self.topic)
    }
}

/// All of a topic but its last part.
fn namespace(topic: &str) -> &str {
    topic.rsplit_once('/').map_or("", |(namespace, _)| namespace)
}
