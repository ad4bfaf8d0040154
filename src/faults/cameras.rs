//! Mistakes of cameras: their optical frames, their intrinsics, and the two of a stereo pair.

use nalgebra::Isometry3;

use crate::math::relation::Relation;
use crate::world::World;
use crate::world::bag::TopicEvidence;
use crate::world::camera::CameraModel;

use super::{Change, Fault, Subject, SubjectPlace, mountings, restate, tree};

/// A relation that changes the transform of an optical frame to its parent.
struct Optical(Relation);

impl Optical {
    fn held(&self, truth: &Isometry3<f64>) -> Option<Isometry3<f64>> {
        let mut held = self.0.apply(truth)?;
        // What is wrong is the rotation: the lens stays where it is.
        held.translation = truth.translation;
        Some(held)
    }
}

impl Change for Optical {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let edges = world.graph().edges.iter();
        let optical = edges.filter(|edge| edge.is_rigid && edge.pose.is_some() && edge.child.has_token("optical"));
        let mut subjects: Vec<Subject> = Vec::new();
        for edge in optical {
            let name = format!("`{}` from `{}`", edge.parent, edge.child);
            if subjects.iter().all(|known| known.name != name) {
                subjects.push(Subject {
                    name,
                    words: vec![format!("`{}`", edge.child)],
                    at: mountings::place_of(edge),
                });
            }
        }
        subjects
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        mountings::remount(world, &subject.at, |truth| self.held(truth))
    }

    fn same_as(&self, world: &World, subject: &Subject) -> Vec<&'static str> {
        let truth = mountings::pose_at(world, &subject.at);
        let both = truth.and_then(|truth| Some((truth, self.held(&truth)?)));
        both.map_or_else(Vec::new, |(truth, held)| restate::relations_between(&truth, &held))
    }
}

/// A mistake in the intrinsics of a camera, in a recording or a file. False where it changes nothing.
struct Intrinsics {
    change: fn(&mut CameraModel) -> bool,
    /// What the size of the images of a recording is divided by.
    shrinks: u32,
}

impl Change for Intrinsics {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let is_calibrated = |camera: &CameraModel| camera.k.iter().any(|value| *value != 0.0);
        let mut subjects = Vec::new();
        for (bag, evidence) in world.bags.iter().enumerate() {
            let calibrated = evidence.topics.values().filter(|topic| {
                let calibrations = topic.content.calibrations.iter().flat_map(|all| &all.calibrations);
                calibrations
                    .into_iter()
                    .any(|calibration| is_calibrated(&calibration.camera))
            });
            subjects.extend(calibrated.map(|topic| Subject::of_topic(bag, topic)));
        }
        let files = world
            .cameras
            .iter()
            .enumerate()
            .filter(|(_, file)| is_calibrated(&file.camera));
        subjects.extend(files.map(|(number, file)| Subject {
            name: format!("camera `{}`", file.name),
            words: vec![format!("`{}`", file.name)],
            at: SubjectPlace::Camera(number),
        }));
        subjects
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let camera = |camera: &mut CameraModel| (self.change)(camera);
        match &subject.at {
            SubjectPlace::Camera(number) => {
                let file = world.cameras.get_mut(*number);
                file.is_some_and(|file| camera(&mut file.camera))
            }
            SubjectPlace::Topic { bag, topic } => {
                let Some(bag) = world.bags.get_mut(*bag) else {
                    return false;
                };
                let mut has_changed = false;
                for (name, other) in &mut bag.topics {
                    if name == topic {
                        let calibrations = other
                            .content_mut()
                            .calibrations
                            .iter_mut()
                            .flat_map(|all| &mut all.calibrations);
                        for calibration in calibrations {
                            has_changed |= camera(&mut calibration.camera);
                        }
                    }
                    if self.shrinks > 1 && namespace(name) == namespace(topic) {
                        has_changed |= shrink(other, self.shrinks);
                    }
                }
                has_changed
            }
            _ => false,
        }
    }
}

/// All of a topic but its last part: a camera and its images share it.
fn namespace(topic: &str) -> &str {
    topic.rsplit_once('/').map_or("", |(namespace, _)| namespace)
}

fn shrink(topic: &mut TopicEvidence, by: u32) -> bool {
    let mut has_changed = false;
    for form in topic
        .content_mut()
        .images
        .iter_mut()
        .flat_map(|images| &mut images.forms)
    {
        form.size = form.size.map(|pixels| pixels / by.max(1));
        has_changed = true;
    }
    has_changed
}

/// Calibrates an image of half the size with the numbers of the whole.
fn halve(camera: &mut CameraModel) -> bool {
    camera.size = camera.size.map(|pixels| pixels / 2);
    camera.size.iter().all(|pixels| *pixels > 0)
}

/// Exchanges cx and cy of K and P, where they differ by more than a tenth.
fn exchange_centre(camera: &mut CameraModel) -> bool {
    let [_, _, cx, _, _, cy, ..] = camera.k;
    camera.k.swap(2, 5);
    camera.p.swap(2, 6);
    (cx - cy).abs() > 0.1 * cx.abs().max(cy.abs())
}

/// Writes the focal lengths of K and P in millimetres: with pixels of 4 um.
fn in_millimetres(camera: &mut CameraModel) -> bool {
    let [fx, _, _, _, fy, ..] = &mut camera.k;
    let [px, _, _, _, _, py, ..] = &mut camera.p;
    for focal in [&mut *fx, fy, px, py] {
        *focal *= 0.004;
    }
    *fx != 0.0
}

/// Writes K column by column.
fn transpose(camera: &mut CameraModel) -> bool {
    let [a, b, c, d, e, f, g, h, i] = camera.k;
    camera.k = [a, d, g, b, e, h, c, f, i];
    [c, f].iter().any(|value| *value != 0.0)
}

/// Names the model that has another number of coefficients.
fn rename_model(camera: &mut CameraModel) -> bool {
    let other = match (camera.model.as_str(), camera.d.len()) {
        ("plumb_bob", 4 | 5) => "rational_polynomial",
        ("rational_polynomial", 8 | 12 | 14) | ("equidistant" | "fisheye", 4) => "plumb_bob",
        _ => return false,
    };
    other.clone_into(&mut camera.model);
    // Four coefficients are taken for a plumb bob without its last one.
    camera.d.len() != 4 || other != "plumb_bob"
}

/// A mistake in a stereo pair; the subject is the calibration of the right camera.
#[derive(Clone, Copy)]
enum Stereo {
    /// Each of the two has the other one's frame.
    Swapped,
    /// Tx is multiplied by this.
    Scaled(f64),
}

/// Parts of names that distinguish the two cameras of a pair.
const SIDES: [[&str; 2]; 3] = [["left", "right"], ["infra1", "infra2"], ["cam0", "cam1"]];

/// The topic of the left camera of a pair.
fn left_of(right: &str) -> Option<String> {
    let sides = SIDES.iter().find(|[_, word]| right.contains(word));
    sides.map(|[left, word]| right.replace(word, left))
}

/// Tx of the first calibration of a topic, pixels times metres.
fn tx_of(topic: &TopicEvidence) -> Option<f64> {
    let calibration = topic.content.calibrations.as_ref()?.calibrations.first()?;
    calibration.camera.p.get(3).copied()
}

impl Change for Stereo {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let mut subjects = Vec::new();
        for (bag, evidence) in world.bags.iter().enumerate() {
            for right in evidence
                .topics
                .values()
                .filter(|topic| tx_of(topic).is_some_and(|tx| tx != 0.0))
            {
                let left = left_of(&right.topic).and_then(|left| evidence.topics.get(&left));
                if let Some(left) = left.filter(|left| tx_of(left).is_some()) {
                    let words = [left, right].map(|topic| format!("`{}`", topic.topic)).to_vec();
                    subjects.push(Subject {
                        words,
                        ..Subject::of_topic(bag, right)
                    });
                }
            }
        }
        subjects
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Topic { bag, topic } = &subject.at else {
            return false;
        };
        match self {
            Self::Swapped => left_of(topic).is_some_and(|left| swap(world, *bag, [&left, topic])),
            Self::Scaled(factor) => {
                let topic = world.bags.get_mut(*bag).and_then(|bag| bag.topics.get_mut(topic));
                let calibrations = topic.and_then(|topic| topic.content_mut().calibrations.as_mut());
                let calibrations = calibrations.into_iter().flat_map(|all| &mut all.calibrations);
                let mut has_changed = false;
                for tx in calibrations.filter_map(|calibration| calibration.camera.p.get_mut(3)) {
                    *tx *= factor;
                    has_changed = true;
                }
                has_changed
            }
        }
    }
}

/// Gives all topics of two cameras the frame of the other.
fn swap(world: &mut World, bag: usize, pair: [&str; 2]) -> bool {
    let Some(evidence) = world.bags.get(bag) else {
        return false;
    };
    let frame = |topic: &str| evidence.topics.get(topic)?.header_frames.keys().next().cloned();
    let (Some(left), Some(right)) = (frame(pair[0]), frame(pair[1])) else {
        return false;
    };
    let of_pair = |topic: &&String| pair.iter().any(|name| namespace(name) == namespace(topic));
    let topics: Vec<String> = evidence.topics.keys().filter(of_pair).cloned().collect();
    for topic in topics {
        tree::rename_header(world, bag, &topic, |frame| {
            if *frame == left {
                Some(right.clone())
            } else {
                (*frame == right).then(|| left.clone())
            }
        });
    }
    left != right
}

/// A driver that names the link of the camera in place of the optical frame below it.
struct LinkNamed;

impl Change for LinkNamed {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let mut subjects = Vec::new();
        for (bag, evidence) in world.bags.iter().enumerate() {
            let calibrated = evidence
                .topics
                .values()
                .filter(|topic| topic.content.calibrations.is_some());
            let optical = calibrated.filter(|topic| topic.header_frames.keys().any(|frame| frame.has_token("optical")));
            subjects.extend(optical.map(|topic| Subject::of_topic(bag, topic)));
        }
        subjects
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Topic { bag, topic } = &subject.at else {
            return false;
        };
        let graph = world.graph().clone();
        let Some(evidence) = world.bags.get(*bag) else {
            return false;
        };
        let of_camera = |name: &&String| namespace(name) == namespace(topic);
        let topics: Vec<String> = evidence.topics.keys().filter(of_camera).cloned().collect();
        let mut has_changed = false;
        for topic in topics {
            has_changed |= tree::rename_header(world, *bag, &topic, |frame| {
                let rigid = graph.edges_to(&frame.canonical()).find(|edge| edge.is_rigid);
                rigid
                    .filter(|_| frame.has_token("optical"))
                    .map(|edge| edge.parent.clone())
            });
        }
        has_changed
    }
}

/// A mistake of a camera.
macro_rules! camera {
    ($name:literal, $change:expr, $sentence:literal, $($named:tt)*) => {
        fault!(Camera, $name, $sentence, $change, $($named)*)
    };
}

const LINK: &str =
    "the transforms of the camera's own link and of its optical frame, or a lidar that sees what the camera sees";
const IMAGES: &str = "camera_info beside the images, in one namespace";
const PAIR: &str = "both camera_info topics of the pair, and the transforms of both optical frames";

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[
    camera!(
        "optical-not-rotated",
        Optical(Relation::OpticalInverse),
        "An optical frame has the axes of its link: x forward, y left, z up.",
        ["optical", "optical-inverse", "looks-up"],
        [],
        ["NAME06", "CAMERA01", "CAMERA05", "CROSS02"],
        LINK
    ),
    camera!(
        "optical-reversed",
        Optical(Relation::Transposed),
        "The rotation of an optical frame is reversed: link to optical where optical to link is meant.",
        ["inverse", "transposed", "optical-inverse"],
        [],
        ["NAME06", "CAMERA01", "CAMERA05", "CROSS02"],
        LINK
    ),
    camera!(
        "optical-upside-down",
        Optical(Relation::Z180),
        "An optical frame is upside down: x points left and y up.",
        ["upside-down", "z180"],
        [],
        ["NAME06", "CAMERA01", "CAMERA05", "CROSS02"],
        LINK
    ),
    camera!(
        "camera-link-named",
        LinkNamed,
        "The images of a camera name its link, and not its optical frame.",
        ["optical"],
        [],
        ["NAME07"],
        "the transforms of the camera's own link and of its optical frame"
    ),
    camera!(
        "camera-k-not-rescaled",
        Intrinsics {
            change: halve,
            shrinks: 2
        },
        "K is that of an image twice as large.",
        ["not-rescaled", "centre"],
        [],
        ["CAMERA02"],
        IMAGES
    ),
    camera!(
        "camera-images-shrunk",
        Intrinsics {
            change: |_| false,
            shrinks: 2
        },
        "Images have half the size that is calibrated.",
        ["not-rescaled"],
        [],
        ["CAMERA02"],
        IMAGES
    ),
    camera!(
        "camera-centre-swapped",
        Intrinsics {
            change: exchange_centre,
            shrinks: 1
        },
        "cx and cy of K are exchanged.",
        ["centre"],
        ["is far from the centre of"],
        ["CAMERA02"],
        "width and height in camera_info"
    ),
    camera!(
        "camera-k-transposed",
        Intrinsics {
            change: transpose,
            shrinks: 1
        },
        "K is written column by column.",
        ["transposed"],
        [],
        ["CAMERA02"],
        "K in camera_info"
    ),
    camera!(
        "camera-focal-millimetres",
        Intrinsics {
            change: in_millimetres,
            shrinks: 1
        },
        "The focal length of K is in millimetres, and not in pixels.",
        ["view"],
        ["horizontal field of view of"],
        ["CAMERA02"],
        "width and height in camera_info"
    ),
    camera!(
        "camera-distortion-model",
        Intrinsics {
            change: rename_model,
            shrinks: 1
        },
        "The coefficients of the distortion are those of another model than the one that is named.",
        ["count", "folds"],
        [],
        ["CAMERA03"],
        "the distortion of the camera in camera_info"
    ),
    camera!(
        "stereo-swapped",
        Stereo::Swapped,
        "The two cameras of a stereo pair have each other's frame.",
        ["swapped"],
        [],
        ["CAMERA07"],
        PAIR
    ),
    camera!(
        "stereo-tx-sign",
        Stereo::Scaled(-1.0),
        "Tx of a stereo pair has the opposite sign.",
        ["baseline-sign", "swapped"],
        [],
        ["CAMERA04", "CAMERA07"],
        PAIR
    ),
    camera!(
        "stereo-baseline-millimetres",
        Stereo::Scaled(1000.0),
        "Tx of a stereo pair was made with a baseline in millimetres.",
        ["other-length"],
        [],
        ["CAMERA07"],
        PAIR
    ),
];
