//! The world: all that is known about one platform, as pure data.
//!
//! Owns claims, robots, frame uses and bag evidence, and the graph that connects them. Serialisable, so that it can be
//! saved, altered and judged again. Must not know how files are read, nor any rule.

pub mod bag;
pub mod beams;
pub mod camera;
pub mod chain;
pub mod claim;
pub mod cloud;
pub mod content;
pub mod contract;
pub mod conventions;
pub mod frame;
pub(crate) mod frame_words;
pub mod graph;
mod index;
pub mod laser;
pub mod launch;
pub mod motion;
pub mod number;
pub mod origin;
pub mod ouster;
pub mod point_file;
pub mod projection;
pub mod qos;
pub mod radar;
pub mod reference;
pub mod rigid;
pub mod robot;
pub mod tf2;
pub mod transform_name;
mod unstated;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

use crate::source::{Confidence, Place, Source, SourceId, SourcePart, SourceValue};
use crate::tables::{Dataset, Tables};

use index::Index;
use launch::{LocalizationSettings, ReadObstacle, StaticPublisher};

pub use bag::BagEvidence;
pub use beams::BeamCalibration;
pub use camera::{CameraFile, StatedDelay};
pub use chain::DeclaredChain;
pub use claim::{Claim, ClaimKind, Doubt, Literal, Pose, Spelling};
pub use conventions::{AppliedConvention, Conventions};
pub use frame::{FrameId, FrameRole, FrameUse};
pub use graph::FrameGraph;
pub use origin::{EarthOrigin, LocalOrigin, OriginSource};
pub use ouster::OusterMetadata;
pub use point_file::PointFile;
pub use projection::Projection;
pub use reference::{FileReference, ReferenceState};
pub use robot::Robot;

/// Everything known about one platform.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct World {
    /// The name of the platform in reports: the path it was found at.
    pub label: String,
    /// Every source of the run, by id; a platform's facts point only at its own. Saved with the worlds that share it.
    #[serde(skip)]
    pub sources: Arc<Vec<Arc<Source>>>,
    /// The sources that belong to this platform.
    pub members: Vec<SourceId>,
    /// Statements of transforms, from files and from robots' joints; TF of bags is in `bags`.
    pub claims: Vec<Claim>,
    /// Robots described by URDF.
    pub robots: Vec<Robot>,
    /// Where frames are named, once for each name, role and source.
    pub frames: Vec<FrameUse>,
    /// Evidence of recordings.
    pub bags: Vec<BagEvidence>,
    /// Products of transforms that files declare.
    pub chains: Vec<DeclaredChain>,
    /// Calibration files that other files name.
    pub references: Vec<FileReference>,
    /// The user's declarations on topics, frames and files.
    #[serde(skip)]
    pub conventions: Arc<Conventions>,
    /// Origins of local frames on the Earth, as files state them.
    #[serde(default)]
    pub origins: Vec<EarthOrigin>,
    /// Origins from the messages of recordings of which no messages are kept.
    #[serde(skip)]
    pub bag_origins: Vec<LocalOrigin>,
    /// The metadata of Ouster sensors.
    #[serde(default)]
    pub ousters: Vec<OusterMetadata>,
    /// Calibrations of the beams of lidars.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub beams: Vec<BeamCalibration>,
    /// Tables of devices, drivers and datasets, with the user's own rows.
    #[serde(skip)]
    pub tables: Arc<Tables>,
    /// The dataset, as declared by the user.
    #[serde(skip)]
    pub dataset: Option<NamedDataset>,
    /// Cameras that files of camera_info_manager describe.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cameras: Vec<CameraFile>,
    /// Projections that files declare.
    #[serde(default)]
    pub projections: Vec<Projection>,
    /// Static transforms that launch files and scripts publish.
    #[serde(default)]
    pub publishers: Vec<StaticPublisher>,
    /// Settings of `robot_localization`.
    #[serde(default)]
    pub localizations: Vec<LocalizationSettings>,
    /// Settings of controllers of ros_control that publish odometry.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<LocalizationSettings>,
    /// Time offsets between cameras and IMUs that files state.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub delays: Vec<StatedDelay>,
    /// Files of point clouds.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub point_files: Vec<PointFile>,
    /// Files whose quaternions are, or may be, of JPL's algebra, with the evidence for it.
    #[serde(default)]
    pub jpl: Vec<SourceValue<String>>,
    #[serde(skip)]
    made: Cache,
}

/// Results that are computed from a world at first use.
#[derive(Clone, Debug, Default)]
struct Cache {
    graph: OnceLock<FrameGraph>,
    launched: OnceLock<Vec<FrameGraph>>,
    whole: OnceLock<FrameGraph>,
    index: OnceLock<Index>,
    words: OnceLock<BTreeMap<Vec<String>, BTreeSet<FrameId>>>,
}

/// What one reader found in one source: merged into a [`World`] by the engine.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// Statements of transforms.
    pub claims: Vec<Claim>,
    /// Robots.
    pub robots: Vec<Robot>,
    /// Frame names.
    pub frames: Vec<FrameUse>,
    /// Evidence of recordings.
    pub bags: Vec<BagEvidence>,
    /// Products of transforms that a file declares.
    pub chains: Vec<DeclaredChain>,
    /// Calibration files that other files name.
    pub references: Vec<FileReference>,
    /// Origins of local frames on the Earth, as a file states them.
    pub origins: Vec<EarthOrigin>,
    /// Origins from the messages of a recording of which no messages are kept.
    pub bag_origins: Vec<LocalOrigin>,
    /// The metadata of Ouster sensors.
    pub ousters: Vec<OusterMetadata>,
    /// Calibrations of the beams of a lidar.
    pub beams: Vec<BeamCalibration>,
    /// Cameras that a file of camera_info_manager describes.
    pub cameras: Vec<CameraFile>,
    /// Names of sensors in a dataset's table, by the token that its other tables use.
    pub channels: Vec<(FrameId, FrameId)>,
    /// Projections that a file declares.
    pub projections: Vec<Projection>,
    /// Static transforms that a launch file or a script publishes.
    pub publishers: Vec<StaticPublisher>,
    /// Settings of `robot_localization`.
    pub localizations: Vec<LocalizationSettings>,
    /// Settings of controllers of ros_control that publish odometry.
    pub drives: Vec<LocalizationSettings>,
    /// Time offsets between cameras and IMUs that a file states.
    pub delays: Vec<StatedDelay>,
    /// The file, if it is one of points.
    pub point_files: Vec<PointFile>,
    /// The file, where its quaternions are, or may be, of JPL's algebra, with the evidence for it.
    pub jpl: Vec<SourceValue<String>>,
}

impl Facts {
    /// The content in words: `3 transforms, 1 origin on the Earth`; `None` if there is nothing.
    pub fn words(&self) -> Option<String> {
        let files = self
            .claims
            .iter()
            .filter(|claim| matches!(claim.kind, ClaimKind::File { .. }));
        let topics: usize = self.bags.iter().map(|bag| bag.topics.len()).sum();
        let edges: usize = self.bags.iter().map(|bag| bag.tf.len()).sum();
        let links: usize = self.robots.iter().map(|robot| robot.links.len()).sum();
        let joints: usize = self.robots.iter().map(|robot| robot.joints.len()).sum();
        let points: u64 = self.point_files.iter().map(|file| file.stated).sum();
        let is_wrong = |why: &ReadObstacle| matches!(why, ReadObstacle::Misread(_));
        let unread = self.publishers.iter().filter_map(|publisher| publisher.unread.as_ref());
        let (wrong, open): (Vec<_>, Vec<_>) = unread.partition(|why| is_wrong(why));
        let counts = [
            (topics, "topic"),
            (edges, "transform of TF"),
            (links, "link"),
            (joints, "joint"),
            (files.count(), "transform"),
            (
                open.len(),
                "call of a publisher whose arguments are known only when the file is run",
            ),
            (wrong.len(), "call of a publisher with wrong arguments"),
            (self.chains.len(), "product of transforms"),
            (self.origins.len(), "origin on the Earth"),
            (self.ousters.len(), "description of an Ouster"),
            (self.beams.len(), "calibration of a lidar's beams"),
            (self.cameras.len(), "camera"),
            (self.channels.len(), "name of a sensor"),
            (self.projections.len(), "projection"),
            (self.localizations.len(), "node of robot_localization"),
            (self.drives.len(), "controller that publishes odometry"),
            (self.delays.len(), "offset of camera stamps"),
            (self.references.len(), "reference to a calibration file"),
            (usize::try_from(points).unwrap_or(usize::MAX), "point"),
        ];
        let words = counts.into_iter().filter(|(count, _)| *count > 0).map(|(count, word)| {
            match (count, word.split_once(' ')) {
                (1, _) => format!("1 {word}"),
                (_, Some((first, rest))) => format!("{count} {first}s {rest}"),
                (_, None) => format!("{count} {word}s"),
            }
        });
        let words: Vec<String> = words.collect();
        (!words.is_empty()).then(|| words.join(", "))
    }

    /// Whether a transform between two frames is stated.
    pub fn state_transforms(&self) -> bool {
        !self.claims.is_empty() || !self.publishers.is_empty()
    }
}

/// A dataset that the configuration names.
#[derive(Clone, Debug)]
pub struct NamedDataset {
    /// What is known about it.
    pub row: Arc<Dataset>,
    /// Where it is named.
    pub place: Option<Place>,
}

impl World {
    /// Projections that files and the configuration declare.
    pub fn projections(&self) -> impl Iterator<Item = &Projection> {
        self.projections.iter().chain(&self.conventions.projections)
    }

    /// The source with this id.
    pub fn source(&self, id: SourceId) -> Option<&Source> {
        self.sources.get(id.0 as usize).map(AsRef::as_ref)
    }

    /// Whether a recording holds more than was read about a subject in words: not where it names a topic that was read completely.
    pub fn holds_more_about(&self, subject: &str) -> bool {
        let mut sampled = self.bags.iter().filter(|bag| !bag.share.whole).peekable();
        let is_sampled = sampled.peek().is_some();
        let mut topics = sampled.flat_map(|bag| bag.topics.values());
        is_sampled && !topics.any(|topic| topic.is_read_up() && subject.split('`').any(|word| word == topic.topic))
    }

    /// The path of a source, for messages.
    pub fn path(&self, id: SourceId) -> &str {
        self.source(id).map_or("?", |source| source.path.as_str())
    }

    /// The topic and the fields of it that a place points at, if only their names suggest what they are, and the
    /// configuration does not confirm it.
    pub fn guessed_fields<'p>(&self, place: &'p Place) -> Option<(&'p str, &'p str)> {
        let SourcePart::Message(message) = &place.at else {
            return None;
        };
        let fields = message.field.as_deref()?;
        let bag = self.bags.iter().find(|bag| bag.source == place.source)?;
        let member = bag.topics.get(&message.topic)?.members.get(fields)?;
        let frames: Vec<&FrameId> = member.header_frames.keys().collect();
        let declared = self.declared(place.source, &message.topic, &frames);
        let is_confirmed = declared.is_some_and(|declared| declared.convention.fields.is_some());
        (member.guessed && !is_confirmed).then_some((message.topic.as_str(), fields))
    }

    /// The user's declarations on a topic of a recording, and on the frames that it names.
    pub fn declared(&self, source: SourceId, topic: &str, frames: &[&FrameId]) -> Option<AppliedConvention> {
        self.conventions.of(&conventions::Subject {
            file: self.path(source),
            topic: Some(topic),
            frames,
        })
    }

    /// The same platform with the facts of these sources only.
    #[must_use]
    pub fn only(&self, has: impl Fn(SourceId) -> bool) -> Self {
        fn kept<T: Clone>(facts: &[T], has: impl Fn(&T) -> bool) -> Vec<T> {
            facts.iter().filter(|fact| has(fact)).cloned().collect()
        }
        let at = |place: &Place| has(place.source);
        let of_node = |one: &LocalizationSettings| one.values.values().next().is_none_or(|value| at(&value.place));
        Self {
            label: self.label.clone(),
            sources: Arc::clone(&self.sources),
            members: kept(&self.members, |id| has(*id)),
            claims: kept(&self.claims, |one| at(&one.place)),
            robots: kept(&self.robots, |one| has(one.source)),
            frames: kept(&self.frames, |one| at(&one.place)),
            bags: kept(&self.bags, |one| has(one.source)),
            chains: kept(&self.chains, |one| at(&one.place)),
            references: kept(&self.references, |one| at(&one.path.place)),
            conventions: Arc::clone(&self.conventions),
            origins: kept(&self.origins, |one| at(&one.place)),
            bag_origins: kept(&self.bag_origins, |one| at(&one.place)),
            ousters: kept(&self.ousters, |one| at(&one.place)),
            beams: kept(&self.beams, |one| at(&one.place)),
            tables: Arc::clone(&self.tables),
            dataset: self.dataset.clone(),
            cameras: kept(&self.cameras, |one| at(&one.place)),
            projections: kept(&self.projections, |one| at(&one.place)),
            publishers: kept(&self.publishers, |one| at(&one.place)),
            localizations: kept(&self.localizations, of_node),
            drives: kept(&self.drives, of_node),
            delays: kept(&self.delays, |one| at(&one.place)),
            point_files: kept(&self.point_files, |one| at(&one.place)),
            jpl: kept(&self.jpl, |one| at(&one.place)),
            made: Cache::default(),
        }
    }

    /// Adds what a reader found.
    pub fn absorb(&mut self, facts: Facts) {
        self.claims.extend(facts.claims);
        self.robots.extend(facts.robots);
        self.frames.extend(facts.frames);
        self.bags.extend(facts.bags);
        self.chains.extend(facts.chains);
        self.references.extend(facts.references);
        self.origins.extend(facts.origins);
        self.bag_origins.extend(facts.bag_origins);
        self.ousters.extend(facts.ousters);
        self.beams.extend(facts.beams);
        self.cameras.extend(facts.cameras);
        self.projections.extend(facts.projections);
        self.publishers.extend(facts.publishers);
        self.localizations.extend(facts.localizations);
        self.drives.extend(facts.drives);
        self.delays.extend(facts.delays);
        self.point_files.extend(facts.point_files);
        self.jpl.extend(facts.jpl);
        self.made = Cache::default();
    }

    /// Replaces the tokens of a dataset's sensors by their names in its table of sensors.
    pub fn name_sensors(&mut self, channels: &BTreeMap<FrameId, FrameId>) {
        for claim in self.claims.iter_mut().filter(|claim| claim.is_row()) {
            claim.rename(|token| channels.get(token).cloned());
        }
    }

    /// Applies the user's declarations: they override names and guesses, and fix the order of bare quaternions.
    pub fn declare(&mut self, conventions: Arc<Conventions>) {
        let platform = if conventions.aliases.is_empty() {
            BTreeSet::new()
        } else {
            self.graph().frames.clone()
        };
        let (claims, sources) = (&mut self.claims, &self.sources);
        for claim in claims {
            let path = sources.get(claim.place.source.0 as usize);
            if matches!(claim.kind, ClaimKind::File { .. }) {
                let file = path.map_or("", |source| source.path.as_str());
                if let Some((target, source)) = conventions.transform_of(file, &claim.label) {
                    claim.declare_frames(target, source);
                }
                // A name of the platform's own needs no alias.
                let own = |name: &FrameId| platform.get(&name.canonical()).cloned();
                if !conventions.aliases.is_empty() {
                    let alias = |name: &FrameId| conventions.frame_of(file, name).filter(|_| own(name).is_none());
                    let has_alias = claim.frames.iter().any(|(a, b)| alias(a).or(alias(b)).is_some());
                    let is_known = claim.rename(|name| own(name).or_else(|| alias(name).cloned()));
                    // A user who declares what the names mean has read the file.
                    if has_alias && is_known {
                        claim.reading = claim.reading.max(Confidence::Likely);
                    }
                }
            }
            let frames: Vec<FrameId> = claim.frames.iter().flat_map(|(a, b)| [a.clone(), b.clone()]).collect();
            let frames: Vec<&FrameId> = frames.iter().collect();
            let subject = conventions::Subject {
                file: path.map_or("", |source| source.path.as_str()),
                topic: None,
                frames: &frames,
            };
            if let Some(declared) = conventions.of(&subject) {
                claim.declare(declared.convention);
            }
        }
        self.conventions = conventions;
        self.made = Cache::default();
    }

    /// Drops everything but its name and its sources.
    pub fn empty(&mut self) {
        *self = Self {
            label: std::mem::take(&mut self.label),
            members: std::mem::take(&mut self.members),
            sources: std::mem::take(&mut self.sources),
            ..Self::default()
        };
    }

    /// Drops computed results: they are computed again when needed.
    pub fn forget(&mut self) {
        self.made = Cache::default();
    }

    /// The frame graph of URDF and TF together, built once. Calibration claims are compared with it, not part of it.
    pub fn graph(&self) -> &FrameGraph {
        self.made.graph.get_or_init(|| FrameGraph::new(self))
    }

    /// The frame graphs that launch files and scripts start, one for each; built once. See [`FrameGraph::launched`].
    pub fn launched(&self) -> &[FrameGraph] {
        self.made.launched.get_or_init(|| FrameGraph::launched(self))
    }

    /// Joints, recorded TF and all that launch files publish, together; built once.
    pub fn whole(&self) -> &FrameGraph {
        self.made.whole.get_or_init(|| FrameGraph::whole(self))
    }

    /// [`World::graph`], and those of [`World::launched`].
    pub fn graphs(&self) -> impl Iterator<Item = &FrameGraph> {
        std::iter::once(self.graph()).chain(self.launched())
    }
}
