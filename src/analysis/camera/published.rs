//! Calibrations of cameras, of recordings and files.

use nalgebra::Vector3;

use crate::analysis::names;
use crate::source::{MessageRef, Place};
use crate::world::{BagEvidence, FrameId, World, camera::CameraModel};

/// Words of cameras that look up or down on purpose.
pub(crate) const VERTICAL: &[&str] = &[
    "up",
    "upward",
    "upwards",
    "ceiling",
    "sky",
    "zenith",
    "allsky",
    "dome",
    "hemispheric",
    "hemispherical",
    "periscope",
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
pub(crate) const AHEAD: &[&str] = &["front", "forward"];
pub(crate) const BACK: &[&str] = &["rear", "back", "backward", "backwards"];

/// What a camera's name says about its direction of view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameAgreement {
    /// It agrees.
    Fit,
    /// It contradicts.
    Against,
    /// It says nothing decisive.
    Unnamed,
}

/// Compares a camera's name with its direction of view in the base, a unit vector: within 45 degrees of the opposite of its name it
/// contradicts, within 60 degrees of its name it agrees. `left` and `right` may mean the position in a pair, and never contradict.
pub(crate) fn looks_against_its_name(frame: &FrameId, looks: &Vector3<f64>) -> NameAgreement {
    let named = match (names::has_word(frame, AHEAD), names::has_word(frame, BACK)) {
        (true, false) => looks.x,
        (false, true) => -looks.x,
        _ => match (names::has_word(frame, &["left"]), names::has_word(frame, &["right"])) {
            (true, false) => looks.y.max(0.0),
            (false, true) => (-looks.y).max(0.0),
            _ => return NameAgreement::Unnamed,
        },
    };
    let half_right = std::f64::consts::FRAC_1_SQRT_2;
    match named {
        cosine if cosine < -half_right => NameAgreement::Against,
        cosine if cosine > 0.5 => NameAgreement::Fit,
        _ => NameAgreement::Unnamed,
    }
}

/// A calibration of a camera.
#[derive(Clone, Debug)]
pub(crate) struct Intrinsics<'w> {
    pub(crate) calibration: &'w CameraModel,
    pub(crate) place: Place,
    pub(crate) subject: String,
    /// Whose it is, behind a letter: on a topic, or of a file's camera.
    pub(crate) whose: String,
}

impl<'w> Intrinsics<'w> {
    /// Those of recordings by topic, then those of files.
    pub(crate) fn all(world: &'w World) -> impl Iterator<Item = Self> {
        let published = RecordedCamera::all(world).map(|published| published.intrinsics());
        published.chain(Self::of_files(world))
    }

    /// Those of files.
    pub(crate) fn of_files(world: &'w World) -> impl Iterator<Item = Self> {
        world.cameras.iter().map(|file| Self {
            calibration: &file.camera,
            place: file.place.clone(),
            subject: format!("calibration of `{}` in {}", file.name, world.path(file.place.source)),
            whose: format!("of `{}`", file.name),
        })
    }

    /// Focal lengths and principal point, pixels: fx, fy, cx, cy.
    pub(crate) fn pinhole(&self) -> [f64; 4] {
        let [fx, _, cx, _, fy, cy, ..] = self.calibration.k;
        [fx, fy, cx, cy]
    }

    /// Whether it says that the camera is not calibrated: K is all zeros.
    pub(crate) fn is_uncalibrated(&self) -> bool {
        is_uncalibrated(self.calibration)
    }

    /// Whether a recording has it.
    pub(crate) fn is_published(&self) -> bool {
        self.place.topic().is_some()
    }
}

/// Whether K is all zeros.
fn is_uncalibrated(camera: &CameraModel) -> bool {
    camera.k.iter().all(|value| *value == 0.0)
}

/// A calibration of a recording's camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RecordedCamera<'w> {
    pub(crate) bag: &'w BagEvidence,
    /// The number of the recording in the world.
    pub(crate) index: usize,
    pub(crate) topic: &'w str,
    pub(crate) calibration: &'w CameraModel,
    /// The first message that has it.
    at: &'w MessageRef,
    /// Its number on the topic, from 1, where there are several.
    number: Option<usize>,
}

impl<'w> RecordedCamera<'w> {
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
                    calibration: &calibration.camera,
                    at: &calibration.at,
                    number: several.then_some(place + 1),
                })
            })
        })
    }

    /// Its name in reports.
    pub(crate) fn subject(&self) -> String {
        match self.number {
            Some(number) => format!("calibration {number} on topic `{}`", self.topic),
            None => format!("calibration on topic `{}`", self.topic),
        }
    }

    pub(crate) fn place(&self) -> Place {
        Place::message(self.bag.source, self.at.clone())
    }

    /// The frame of its messages.
    pub(crate) fn frame(&self) -> Option<FrameId> {
        let topic = self.bag.topics.get(self.topic)?;
        let mut frames = topic.header_frames.keys().map(FrameId::canonical);
        frames.find(|frame| !frame.as_str().is_empty())
    }

    /// The calibration as a rule judges it.
    pub(crate) fn intrinsics(&self) -> Intrinsics<'w> {
        Intrinsics {
            calibration: self.calibration,
            place: self.place(),
            subject: self.subject(),
            whose: format!("on `{}`", self.topic),
        }
    }

    /// Whether it says that the camera is not calibrated: K is all zeros.
    pub(crate) fn is_uncalibrated(&self) -> bool {
        is_uncalibrated(self.calibration)
    }

    /// The common namespace of the camera's topics: `/front` of `/front/camera_info`.
    pub(crate) fn namespace(&self) -> &'w str {
        namespace(self.topic)
    }
}

/// All of a topic but its last part.
pub(crate) fn namespace(topic: &str) -> &str {
    topic.rsplit_once('/').map_or("", |(namespace, _)| namespace)
}
