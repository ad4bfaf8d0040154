//! Hand-made runs for the tests of reports.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::run::Run;
use crate::source::{Confidence, Derivation, MessageRef, Place, Source, SourceId, SourceKind};
use crate::verdict::{Finding, Outcome, Row};
use crate::world::bag::{BagEvidence, TfEdge, TfSample};
use crate::world::{Claim, ClaimKind, FrameId, FrameRole, FrameUse, Pose, Spelling, World};

/// A URDF in which the lidar is mounted on line 3.
pub(super) const ROBOT: &str = "<robot name=\"cart\">\n  <link name=\"base_link\"/>\n  <joint name=\"lidar_joint\" \
                                type=\"fixed\">\n    <origin rpy=\"0 0 1.57\"/>\n  </joint>\n</robot>\n";

/// Builds a run.
#[derive(Default)]
pub(super) struct Sample {
    pub(super) run: Run,
    pub(super) world: World,
}

impl Sample {
    pub(super) fn source(&mut self, path: &str, kind: SourceKind, text: &str) -> SourceId {
        let id = SourceId(u32::try_from(self.run.sources.len()).unwrap());
        let mut source = Source::new(id, path, kind);
        source.text = text.to_owned();
        source.examined.bytes = text.len() as u64;
        source.examined.bytes_total = text.len() as u64;
        self.run.sources.push(source.into());
        self.world.members.push(id);
        id
    }

    pub(super) fn derived(&mut self, path: &str, kind: SourceKind, text: &str, derived: Derivation) -> SourceId {
        let id = self.source(path, kind, text);
        std::sync::Arc::make_mut(&mut self.run.sources[id.0 as usize]).derived = Some(derived);
        id
    }

    /// The first place of `needle` in the source's text.
    pub(super) fn at(&self, id: SourceId, needle: &str) -> Place {
        let start = self.run.sources[id.0 as usize].text.find(needle).unwrap();
        Place::text(id, start..start + needle.len())
    }

    pub(super) fn row(&mut self, rule: &str, subject: &str, outcome: Outcome, reason: Option<&str>) {
        self.run.verdict.rows.push(Row {
            rule: rule.to_owned().into(),
            name: "a-rule".into(),
            subject: subject.to_owned(),
            outcome,
            reason: reason.map(str::to_owned),
            measured: Vec::new(),
            plots: Vec::new(),
            planes: Vec::new(),
        });
    }

    pub(super) fn finding(&mut self, rule: &str, name: &str, mut finding: Finding) {
        finding.rule = rule.to_owned();
        finding.name = name.to_owned();
        self.row(rule, &finding.subject.clone(), Outcome::Fail, None);
        self.run.verdict.findings.push(finding);
    }

    pub(super) fn joint(&mut self, source: SourceId, name: &str, parent: &str, child: &str, pose: Pose) {
        let place = if self.run.sources[source.0 as usize].text.contains(name) {
            self.at(source, name)
        } else {
            Place::whole(source)
        };
        self.world.claims.push(Claim {
            frames: Some((FrameId::new(parent), FrameId::new(child))),
            label: name.to_owned(),
            pose: Some(pose),
            has_rotation: true,
            has_translation: true,
            spelling: Spelling::Translation { xyz: [0.0; 3] },
            translation_literals: Vec::new(),
            rotation_literals: Vec::new(),
            kind: ClaimKind::Joint {
                joint: name.to_owned(),
                fixed: !name.contains("wheel"),
                has_origin: true,
            },
            reading: Confidence::Certain,
            doubt: None,
            place,
            target_place: None,
            source_place: None,
        });
    }

    pub(super) fn named(&mut self, frame: &str, role: FrameRole, place: Place) {
        self.world.frames.push(FrameUse {
            frame: FrameId::new(frame),
            role,
            place,
            count: 1,
        });
    }

    pub(super) fn tf(&mut self, source: SourceId, topic: &str, edge: (&str, &str), count: u64, pose: Pose) {
        let last = MessageRef {
            index: count - 1,
            log_ns: 20_000_000 * i64::try_from(count - 1).unwrap(),
            ..message(topic, 0)
        };
        let first = MessageRef {
            log_ns: 0,
            ..message(topic, 0)
        };
        let sample = TfSample { at: first, pose };
        let mut bag = BagEvidence::new(source);
        bag.tf.push(TfEdge {
            count,
            last_at: last,
            ..TfEdge::once(FrameId::new(edge.0), FrameId::new(edge.1), sample)
        });
        self.world.bags.push(bag);
    }

    /// The run with its world.
    pub(super) fn run(self) -> Run {
        let mut run = self.run;
        let mut world = self.world;
        #[allow(clippy::useless_conversion)] // the world may share the list
        {
            world.sources = run.sources.clone().into();
        }
        run.worlds.push(world);
        run
    }
}

/// A message of 2023-11-14 22:13:20 UTC.
pub(super) fn message(topic: &str, index: u64) -> MessageRef {
    MessageRef {
        topic: topic.to_owned(),
        index,
        stamp_ns: Some(1_700_000_000_000_000_000),
        log_ns: 1_700_000_000_100_000_000,
        field: None,
    }
}

/// `parent_from_child`: metres, and a yaw in degrees.
pub(super) fn pose(xyz: [f64; 3], yaw_deg: f64) -> Pose {
    Pose::from_isometry(&Isometry3::from_parts(
        Translation3::new(xyz[0], xyz[1], xyz[2]),
        UnitQuaternion::from_euler_angles(0.0, 0.0, yaw_deg.to_radians()),
    ))
}

/// A run with every outcome, every kind of place, numbers that are not finite, and a fix.
pub(super) fn everything() -> Run {
    use crate::source::ReadStatus;
    use crate::verdict::{Edit, Measured, Safety};
    let mut s = Sample::default();
    let robot = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    let bag = s.source("drive.mcap", SourceKind::Mcap, "");
    let description = s.derived(
        "drive.mcap",
        SourceKind::RobotDescription,
        ROBOT,
        Derivation::Message(message("/robot_description", 0)),
    );
    let expanded = s.derived("cart.xacro", SourceKind::Urdf, ROBOT, Derivation::Expansion);
    let broken = s.source("calib.yaml", SourceKind::Yaml, "a: 1\nb: [\n");
    let fault = s.at(broken, "[");
    std::sync::Arc::make_mut(&mut s.run.sources[broken.0 as usize]).problem_with_help(
        ReadStatus::Partial,
        fault,
        "the list is never closed",
        Some("close it with `]`".to_owned()),
    );
    let origin = s.at(robot, "0 0 1.57");
    s.finding(
        "CONV02",
        "quarter-turn",
        Finding::warning("joint `lidar_joint`", "1.57 rad is not a quarter turn", origin.clone())
            .likely()
            .label("written here")
            .related(
                Place::message(
                    bag,
                    MessageRef {
                        field: Some("transforms[0]".into()),
                        ..message("/tf_static", 3)
                    },
                ),
                "published here",
            )
            .related(s.at(description, "lidar_joint"), "described here")
            .related(s.at(expanded, "lidar_joint"), "expanded here")
            .related(Place::whole(broken), "")
            .help("write 1.5707963")
            .relation("inverse")
            .measured(
                Measured::new("rotation", f64::NAN, "deg")
                    .limit(f64::INFINITY)
                    .spread(-0.0)
                    .samples(3),
            )
            .fix(
                "write the digits",
                Safety::Safe,
                vec![Edit {
                    place: origin,
                    replacement: "0 0 1.5707963".into(),
                }],
            ),
    );
    s.finding(
        "TREE01",
        "orphan-subtree",
        Finding::error("x", "m", Place::whole(robot)).hint(),
    );
    s.row("A01", "x", Outcome::Pass, None);
    s.row("A02", "x", Outcome::NotEvaluated, Some("missing input: no URDF"));
    s.row("A03", "x", Outcome::Waived, None);
    s.row("A04", "x", Outcome::Crashed, Some("index out of range"));
    s.run()
}
