//! The radars of a world: their scans, with their motion by range rates and by other streams. Must not judge.

use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};

use crate::analysis::motion::{Course, Motion, Orientations, Stream, Track};
use crate::analysis::{Estimates, motion::mount::mount, scan_motion::moved::Moment};
use crate::math::circular::wrapped;
use crate::math::doppler::{Detection, MatchGate, agreeing, ego, found};
use crate::source::Place;
use crate::world::bag::{TopicContent, TopicEvidence};
use crate::world::radar::{RadarEvidence, RadarForm, RadarSweep, SpeedForm};
use crate::world::{BagEvidence, FrameId, World, motion::PoseRow};

/// Half the interval that a velocity is taken over, seconds.
const HALF_S: f64 = 0.25;
/// Longest step between two poses, seconds.
const MAX_STEP_S: f64 = 0.6;
/// Longest interval between two courses, seconds.
const COURSES_S: f64 = 0.6;

/// Words in topics and frames of radars.
const RADARS: [&str; 6] = ["radar", "umrr", "ars408", "ars430", "ars548", "mmwave"];
/// Fields that only the points of radars have.
const OF_A_RADAR: [&str; 11] = [
    "rcs",
    "snr",
    "snr_db",
    "noise",
    "noise_db",
    "power",
    "amplitude",
    "doppler_bin",
    "dyn_prop",
    "ambig_state",
    "vx_comp",
];

/// Whether a topic's clouds are a radar's: their points have a speed, and its name or their fields show it.
pub(crate) fn is_of_a_radar(topic: &TopicEvidence) -> bool {
    let is_cloud = |radar: &RadarEvidence| radar.form == RadarForm::Cloud;
    topic.content.radar.as_deref().is_some_and(is_cloud) && (has_word(topic) || has_field(topic))
}

fn has_word(topic: &TopicEvidence) -> bool {
    topic.words().iter().any(|word| {
        let stem = word.trim_end_matches(|c: char| c.is_ascii_digit());
        RADARS.contains(&stem) || RADARS.contains(&word.as_str())
    })
}

fn has_field(topic: &TopicEvidence) -> bool {
    let layouts = topic.content.clouds.iter().flat_map(|clouds| &clouds.layouts);
    let mut fields = layouts.flat_map(|layout| &layout.fields);
    fields.any(|field| OF_A_RADAR.contains(&field.name.to_ascii_lowercase().as_str()))
}

/// The detections of one topic, or of a member of its messages.
#[derive(Clone)]
pub(crate) struct Radar<'w> {
    /// Index of the recording in the world.
    pub(crate) index: usize,
    pub(crate) bag: &'w BagEvidence,
    pub(crate) said: TopicContent<'w>,
    pub(crate) evidence: &'w RadarEvidence,
}

impl<'w> Radar<'w> {
    /// Those of a world: points with a `velocity` or its components count if something else shows that they are a radar's.
    pub(crate) fn all(world: &'w World) -> impl Iterator<Item = Self> {
        world.bags.iter().enumerate().flat_map(|(index, bag)| {
            bag.topics
                .values()
                .flat_map(TopicEvidence::contents)
                .filter_map(move |said| {
                    let evidence = said.content.radar.as_deref()?;
                    let is_sure = evidence.form != RadarForm::Cloud || evidence.speeds == SpeedForm::Radial;
                    (is_sure || is_of_a_radar(said.topic)).then_some(Self {
                        index,
                        bag,
                        said,
                        evidence,
                    })
                })
        })
    }

    /// Its first message.
    pub(crate) fn place(&self) -> Place {
        Place::of(self.bag.source, Some(&self.evidence.first))
    }

    /// The frame of the first header that names one.
    pub(crate) fn frame(&self) -> Option<FrameId> {
        let frames = self.said.header_frames.keys().map(FrameId::canonical);
        frames.into_iter().find(|frame| !frame.as_str().is_empty())
    }

    /// Whether only names show that these are detections with range rates.
    pub(crate) fn is_guessed(&self) -> bool {
        self.said.guessed || self.evidence.speeds == SpeedForm::Components
    }
}

/// A source of the platform's motion, with the radar's mounting.
pub(crate) struct MotionSource {
    /// Its name in reports, and its place.
    pub(crate) subject: String,
    pub(crate) place: Place,
    /// The frame that moves, and the radar in it, by the transforms.
    pub(crate) body: FrameId,
    pub(crate) radar: FrameId,
    pub(crate) body_from_radar: Isometry3<f64>,
    stamp_offset_s: Option<f64>,
    by: MotionData,
}

enum MotionData {
    Poses(Orientations, std::sync::Arc<Track>),
    /// GNSS fixes, which cannot distinguish forward from backward.
    Courses(Vec<Vec<Course>>),
}

impl MotionSource {
    /// Every one that the radar is tied to: poses of a body first, then GNSS fixes with a base.
    pub(crate) fn all(world: &Estimates, radar: &Radar) -> Vec<Self> {
        let motion = Motion::of(world);
        let (Some(frame), Some(bag)) = (radar.frame(), motion.bags.get(radar.index)) else {
            return Vec::new();
        };
        let poses = bag.ways().filter_map(|poses: &Stream<PoseRow>| {
            let body = poses.child.clone()?;
            let (body_from_radar, _) = world.graph().chain(&body, &frame, |edge| edge.is_rigid)?;
            Some(Self {
                subject: poses.subject.clone(),
                place: poses.place(),
                body,
                radar: frame.clone(),
                body_from_radar,
                stamp_offset_s: poses.stamp_offset_s,
                by: MotionData::Poses(Orientations::of(poses), poses.track()),
            })
        });
        let fixes = bag.fixes.iter().filter_map(|fixes| {
            let mount = mount(world, &frame)?;
            Some(Self {
                subject: fixes.subject.clone(),
                place: fixes.place(),
                body: mount.base,
                radar: frame.clone(),
                body_from_radar: mount.base_from_sensor,
                stamp_offset_s: fixes.stamp_offset_s,
                by: MotionData::Courses(fixes.track().courses(1.0)),
            })
        });
        poses.chain(fixes).collect()
    }

    /// Whether it distinguishes forward from backward motion.
    pub(crate) fn knows_forward(&self) -> bool {
        matches!(self.by, MotionData::Poses(..))
    }

    /// Velocity and angular velocity of the body in its own axes, m/s and rad/s.
    fn at(&self, t_s: f64) -> Option<[Vector3<f64>; 2]> {
        match &self.by {
            MotionData::Poses(turned, track) => {
                let [before_s, after_s] = [t_s - HALF_S, t_s + HALF_S];
                let way = track.at(after_s)? - track.at(before_s)?;
                let [before, now, after] = [before_s, t_s, after_s].map(|t_s| turned.at(t_s, MAX_STEP_S));
                let rate = (before?.inverse() * after?).scaled_axis() / (2.0 * HALF_S);
                Some([now?.inverse() * way / (2.0 * HALF_S), rate])
            }
            MotionData::Courses(runs) => {
                let near = |pair: &[Course]| matches!(pair, [a, b] if a.t_s <= t_s && t_s <= b.t_s && b.t_s - a.t_s <= COURSES_S);
                let pair = runs.iter().flat_map(|run| run.windows(2)).find(|pair| near(pair))?;
                let [a, b] = pair else { return None };
                let seconds = b.t_s - a.t_s;
                let share = (t_s - a.t_s) / seconds;
                let speed = a.speed_m_s + (b.speed_m_s - a.speed_m_s) * share;
                let rate = wrapped(b.angle_rad - a.angle_rad) / seconds;
                Some([Vector3::x() * speed, Vector3::z() * rate])
            }
        }
    }
}

/// Requirements for a scan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScanCriteria {
    pub(crate) min_speed_m_s: f64,
    pub(crate) min_detections: usize,
    pub(crate) tolerance_m_s: f64,
    pub(crate) tolerance_share: f64,
}

/// One scan with its motion by range rates and by another stream, in the axes of the body by the transforms.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scan<'w> {
    /// Index of the run of neighbouring scans.
    pub(crate) run: usize,
    t_s: f64,
    sweep: &'w RadarSweep,
    /// Velocity and angular velocity of the body, m/s and rad/s.
    pub(crate) body: [Vector3<f64>; 2],
    /// Velocity of the radar: that of the body plus angular velocity times lever arm, m/s.
    pub(crate) expected: Vector2<f64>,
    /// Velocity of the radar that most of its detections agree on, m/s.
    pub(crate) fitted: Vector2<f64>,
    /// Share of the detections that agree with it.
    pub(crate) share: f64,
    /// Among detections that the body's motion affects, the share with the expected rates, of either sign.
    pub(crate) as_expected: f64,
    tolerance: f64,
}

impl Scan<'_> {
    fn sights(&self, way: &MotionSource) -> Vec<Detection> {
        sights(self.sweep, way)
    }
}

fn sights(sweep: &RadarSweep, way: &MotionSource) -> Vec<Detection> {
    let sight = |[x, y, z, rate]: &[f64; 4]| {
        let direction = Vector3::new(*x, *y, *z).try_normalize(1e-6)?;
        Some(Detection {
            direction: way.body_from_radar.rotation * direction,
            rate: *rate,
        })
    };
    sweep.echoes.iter().filter_map(sight).collect()
}

/// The scans of a radar with enough detections while the platform is fast enough, and how many have enough at any speed.
pub(crate) fn scans<'w>(radar: &Radar<'w>, way: &MotionSource, wanted: &ScanCriteria) -> (Vec<Scan<'w>>, usize) {
    let start_ns = radar.bag.start_ns.unwrap_or_default();
    let (mut all, mut enough) = (Vec::new(), 0);
    for (run, sweeps) in radar.evidence.runs.iter().enumerate() {
        for sweep in sweeps {
            if sweep.echoes.len() < wanted.min_detections {
                continue;
            }
            enough += 1;
            let t_s = Moment::new(sweep.stamp_ns, sweep.log_ns, start_ns).on(way.stamp_offset_s);
            let Some([velocity, rate]) = way.at(t_s) else { continue };
            let at_radar = velocity + rate.cross(&way.body_from_radar.translation.vector);
            let speed = velocity.xy().norm();
            // Also false for NaN.
            let is_fast = speed >= wanted.min_speed_m_s && at_radar.xy().norm() > 0.5 * wanted.min_speed_m_s;
            if !is_fast {
                continue;
            }
            let tolerance = wanted.tolerance_m_s + wanted.tolerance_share * speed;
            let sights = sights(sweep, way);
            let Some(ego) = ego(&sights, tolerance) else { continue };
            let expected = at_radar.xy();
            let shows = |sight: &&Detection| sight.direction.xy().dot(&expected).abs() > 3.0 * tolerance;
            let showing: Vec<Detection> = sights.iter().filter(shows).copied().collect();
            let most = [expected, -expected].map(|velocity| agreeing(&showing, &velocity, tolerance));
            let [on, of] = ego.share.map(|count| count as f64);
            all.push(Scan {
                run,
                t_s,
                sweep,
                body: [velocity, rate],
                expected,
                fitted: ego.velocity,
                share: on / of.max(1.0),
                as_expected: most.into_iter().max().unwrap_or(0) as f64 / showing.len().max(1) as f64,
                tolerance,
            });
        }
    }
    (all, enough)
}

/// Number of detections found again in a later scan with their rates as published, and with the opposite sign: only those that agree
/// with the velocity of their scan, and that moved at least this far.
pub(crate) fn found_again(scans: &[Scan], way: &MotionSource, least_m: f64, near: MatchGate) -> [usize; 2] {
    let mut counts = [0; 2];
    let radar_from_body = way.body_from_radar.rotation.inverse();
    for (at, scan) in scans.iter().enumerate() {
        let speed = scan.fitted.norm();
        let rest = scans.get(at + 1..).unwrap_or_default();
        let later = rest
            .iter()
            .take_while(|later| later.run == scan.run)
            .find(|later| (later.t_s - scan.t_s) * speed >= 1.5 * least_m);
        let Some(later) = later else { continue };
        let seconds = later.t_s - scan.t_s;
        let sights = scan.sights(way);
        let from: Vec<Vector3<f64>> = scan
            .sweep
            .echoes
            .iter()
            .zip(&sights)
            .filter(|(_, sight)| {
                let still = agreeing(&[**sight], &scan.fitted, scan.tolerance) == 1;
                still && sight.rate.abs() * seconds >= least_m
            })
            .map(|([x, y, z, _], _)| Vector3::new(*x, *y, *z))
            .collect();
        let to: Vec<Vector3<f64>> = later
            .sweep
            .echoes
            .iter()
            .map(|[x, y, z, _]| Vector3::new(*x, *y, *z))
            .collect();
        let way_m = radar_from_body * Vector3::new(scan.fitted.x, scan.fitted.y, 0.0) * seconds;
        let turn = UnitQuaternion::from_scaled_axis(radar_from_body * scan.body[1] * -seconds);
        for (count, sign) in counts.iter_mut().zip([1.0, -1.0]) {
            // Positions are in the axes of their own scan; static objects move and rotate opposite to the radar.
            let motion = Isometry3::from_parts((turn * (-sign * way_m)).into(), turn);
            *count += found(&from, &to, &motion, near);
        }
    }
    counts
}
