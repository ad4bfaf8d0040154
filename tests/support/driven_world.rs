//! Worlds of a drive, made in memory: the evidence that collecting a recording of the same streams would give.
//!
//! Owns the means that rows of fast streams are. `tests/rates` holds it to what is collected of a recipe.

use frames_lint::source::{MessageRef, SourceId};
use frames_lint::world::bag::{HeaderFrame, TfEdge, TfSample, TopicEvidence};
use frames_lint::world::content::{ContentEvidence, ImuEvidence};
use frames_lint::world::motion::{FixRow as Fix, InertialRow, MotionEvidence, PoseRow as Pose, ROW_NS, Series, Twist};
use frames_lint::world::{BagEvidence, FrameId, World};
use nalgebra::Isometry3;

use super::drive::rows::{FixRow, ImuRow, OdometryRow, PoseRow};

/// Log clock at the start, nanoseconds.
pub const START_NS: i64 = 1_700_000_000_000_000_000;

/// A recording that is being made.
#[derive(Debug)]
pub struct Recording(BagEvidence);

impl Default for Recording {
    fn default() -> Self {
        let mut bag = BagEvidence::new(SourceId(0));
        bag.start_ns = Some(START_NS);
        Self(bag)
    }
}

impl Recording {
    /// With inertial messages.
    #[must_use]
    pub fn imu(mut self, topic: &str, frame: &str, rows: &[ImuRow]) -> Self {
        let messages = rows.iter().map(|row| {
            let mut values = [0.0; 10];
            values[..4].copy_from_slice(&row.orientation);
            values[4..7].copy_from_slice(&row.gyro);
            values[7..].copy_from_slice(&row.acceleration);
            (row.t_s, values)
        });
        let series = series(messages, 0, 0.0, |stamp_ns, log_ns, values| InertialRow {
            stamp_ns,
            log_ns,
            orientation: part(&values, 0),
            angular_velocity: part(&values, 4),
            linear_acceleration: part(&values, 7),
        });
        let content = ContentEvidence {
            imu: Some(inertial(topic, rows)),
            motion: MotionEvidence {
                inertial: Some(series),
                ..MotionEvidence::default()
            },
            ..ContentEvidence::default()
        };
        self.add(topic, "sensor_msgs/msg/Imu", [frame, ""], rows.len(), content);
        self
    }

    /// With odometry of `base_link` in `odom`.
    #[must_use]
    pub fn odometry(self, topic: &str, rows: &[OdometryRow]) -> Self {
        self.odometry_of(topic, ["odom", "base_link"], rows)
    }

    /// With odometry of a frame in another.
    #[must_use]
    pub fn odometry_of(mut self, topic: &str, frames: [&str; 2], rows: &[OdometryRow]) -> Self {
        let messages = rows.iter().map(|row| {
            let mut values = [0.0; 13];
            values[..3].copy_from_slice(&row.pose.position);
            values[3..7].copy_from_slice(&row.pose.orientation);
            values[7..10].copy_from_slice(&row.linear);
            values[10..].copy_from_slice(&row.angular);
            (row.pose.t_s, values)
        });
        let series = series(messages, 3, 0.0, |stamp_ns, log_ns, values| Pose {
            stamp_ns,
            log_ns,
            position: part(&values, 0),
            orientation: part(&values, 3),
            twist: Some(Twist {
                linear: part(&values, 7),
                angular: part(&values, 10),
            }),
        });
        let content = of_motion(MotionEvidence {
            poses: Some(series),
            ..MotionEvidence::default()
        });
        self.add(topic, "nav_msgs/msg/Odometry", frames, rows.len(), content);
        self
    }

    /// With poses in a frame.
    #[must_use]
    pub fn poses(mut self, topic: &str, frame: &str, rows: &[PoseRow]) -> Self {
        let content = of_motion(MotionEvidence {
            poses: Some(poses(rows)),
            ..MotionEvidence::default()
        });
        self.add(topic, "geometry_msgs/msg/PoseStamped", [frame, ""], rows.len(), content);
        self
    }

    /// With point clouds, of which nothing but the frame is known.
    #[must_use]
    pub fn clouds(mut self, topic: &str, frame: &str, count: usize) -> Self {
        let content = ContentEvidence::default();
        self.add(topic, "sensor_msgs/msg/PointCloud2", [frame, ""], count, content);
        self
    }

    /// With a topic that was collected elsewhere.
    #[must_use]
    pub fn topic(mut self, topic: TopicEvidence) -> Self {
        self.0.topics.insert(topic.topic.clone(), topic);
        self
    }

    /// With satellite fixes that are logged so many seconds after their stamps.
    #[must_use]
    pub fn fixes(mut self, topic: &str, frame: &str, rows: &[FixRow], latency_s: f64) -> Self {
        let messages = rows.iter().map(|row| {
            let [east, _, _, _, north, _, _, _, up] = row.covariance;
            let position = [row.latitude, row.longitude, row.altitude];
            let [a, b, c] = position;
            (row.t_s, [a, b, c, east, north, up, f64::from(row.status)])
        });
        let series = series(messages, 7, latency_s, |stamp_ns, log_ns, values| Fix {
            stamp_ns,
            log_ns,
            latitude_deg: values[0],
            longitude_deg: values[1],
            altitude_m: values[2],
            variance_m2: part(&values, 3),
            status: values[6] as i8,
        });
        let content = of_motion(MotionEvidence {
            fixes: Some(series),
            ..MotionEvidence::default()
        });
        self.add(topic, "sensor_msgs/msg/NavSatFix", [frame, ""], rows.len(), content);
        self
    }

    /// With a static transform.
    #[must_use]
    pub fn transform(mut self, parent: &str, child: &str, parent_from_child: &Isometry3<f64>) -> Self {
        let sample = TfSample {
            at: message("/tf_static", START_NS),
            pose: frames_lint::world::Pose::from_isometry(parent_from_child),
        };
        self.0.tf.push(edge([parent, child], 1, &[sample]));
        self
    }

    /// With a transform on `/tf`: all of its poses, and every twentieth of them as a sample; not how it steps.
    #[must_use]
    pub fn moving(mut self, parent: &str, child: &str, rows: &[PoseRow]) -> Self {
        let sample = |row: &PoseRow| TfSample {
            at: message("/tf", START_NS + (row.t_s * 1e9).round() as i64),
            pose: frames_lint::world::Pose::from_isometry(&row.isometry()),
        };
        let samples: Vec<TfSample> = rows.iter().step_by(20).chain(rows.last()).map(sample).collect();
        let first = rows[0].isometry();
        let apart = |row: &PoseRow| {
            let here = row.isometry();
            let shift = (here.translation.vector - first.translation.vector).norm();
            (first.rotation.angle_to(&here.rotation), shift)
        };
        // In the units of a tenth of a degree and a millimetre, as it is collected.
        let weight = |(angle, shift): (f64, f64)| (angle / 0.1_f64.to_radians()).max(shift / 1e-3);
        let farthest = rows
            .iter()
            .max_by(|a, b| weight(apart(a)).total_cmp(&weight(apart(b))))
            .unwrap();
        let (angle, shift) = apart(farthest);
        let extreme = (rows.iter().any(|row| row.isometry() != first)).then(|| (sample(farthest), angle, shift));
        self.0.tf.push(TfEdge {
            topic: "/tf".to_owned(),
            is_static: false,
            motion: (weight((angle, shift)) > 1.0).then(|| poses(rows)),
            extreme,
            ..edge([parent, child], rows.len(), &samples)
        });
        self
    }

    /// What was recorded.
    pub fn evidence(self) -> BagEvidence {
        self.0
    }

    /// The world that holds this recording alone.
    pub fn world(self) -> World {
        let mut world = World::default();
        world.bags = vec![self.0];
        world
    }

    fn add(
        &mut self,
        topic: &str,
        message_type: &str,
        [frame, child]: [&str; 2],
        count: usize,
        content: ContentEvidence,
    ) {
        let at = message(topic, START_NS);
        let header = || HeaderFrame {
            count: count as u64,
            first: at.clone(),
        };
        let mut evidence = TopicEvidence {
            topic: topic.to_owned(),
            message_type: message_type.to_owned(),
            count: count as u64,
            content: content.into(),
            ..TopicEvidence::default()
        };
        evidence.stamps.first = Some(at.clone());
        evidence.header_frames.insert(FrameId::new(frame), header());
        if !child.is_empty() {
            evidence.child_frames.insert(FrameId::new(child), header());
        }
        self.0.topics.insert(topic.to_owned(), evidence);
    }
}

fn of_motion(motion: MotionEvidence) -> ContentEvidence {
    ContentEvidence {
        motion,
        ..ContentEvidence::default()
    }
}

/// What is counted of inertial messages.
fn inertial(topic: &str, rows: &[ImuRow]) -> ImuEvidence {
    #[allow(clippy::float_cmp)] // exactly is what is asked
    let is = |xyzw: [f64; 4]| rows.iter().filter(|row| row.orientation == xyzw).count() as u64;
    let speed = |row: &ImuRow| row.gyro.iter().map(|rate| rate * rate).sum::<f64>().sqrt();
    let squares: f64 = rows.iter().map(|row| speed(row).powi(2)).sum();
    let steps = rows.windows(2);
    ImuEvidence {
        count: rows.len() as u64,
        identity: is([0.0, 0.0, 0.0, 1.0]),
        zero: is([0.0; 4]),
        same_as_first: rows.first().map_or(0, |row| is(row.orientation)),
        first: Some(message(topic, START_NS)),
        angular_velocity_rms: (squares / rows.len() as f64).sqrt(),
        turned_rad: steps
            .map(|pair| 0.5 * (speed(&pair[0]) + speed(&pair[1])) * (pair[1].t_s - pair[0].t_s))
            .sum(),
    }
}

/// Poses without a velocity.
fn poses(rows: &[PoseRow]) -> Series<Pose> {
    let messages = rows.iter().map(|row| {
        let mut values = [0.0; 7];
        values[..3].copy_from_slice(&row.position);
        values[3..].copy_from_slice(&row.orientation);
        (row.t_s, values)
    });
    series(messages, 3, 0.0, |stamp_ns, log_ns, values| Pose {
        stamp_ns,
        log_ns,
        position: part(&values, 0),
        orientation: part(&values, 3),
        twist: None,
    })
}

/// An edge with these samples.
fn edge([parent, child]: [&str; 2], count: usize, samples: &[TfSample]) -> TfEdge {
    TfEdge {
        count: count as u64,
        last_at: samples[samples.len() - 1].at.clone(),
        samples: samples.to_vec(),
        ..TfEdge::once(FrameId::new(parent), FrameId::new(child), samples[0].clone())
    }
}

fn message(topic: &str, stamp_ns: i64) -> MessageRef {
    MessageRef {
        topic: topic.to_owned(),
        index: 0,
        stamp_ns: Some(stamp_ns),
        log_ns: stamp_ns,
        field: None,
    }
}

fn part<const N: usize, const M: usize>(values: &[f64; N], from: usize) -> [f64; M] {
    values[from..from + M].try_into().unwrap()
}

/// The messages of a stream, time and numbers, as rows: means where they come faster than rows do. `quaternion` is where
/// a quaternion begins among the numbers.
fn series<const N: usize, T>(
    messages: impl Iterator<Item = (f64, [f64; N])>,
    quaternion: usize,
    latency_s: f64,
    row: impl Fn(i64, i64, [f64; N]) -> T,
) -> Series<T> {
    let (mut count, mut rows) = (0, Vec::new());
    let mut open: Vec<(i64, [f64; N])> = Vec::new();
    let close = |open: &mut Vec<(i64, [f64; N])>, rows: &mut Vec<T>| {
        let (Some((_, first)), n) = (open.first().copied(), open.len()) else {
            return;
        };
        let mut mean = [0.0; N];
        let mut stamps = 0_i128;
        for (stamp_ns, values) in open.drain(..) {
            let slots = quaternion.min(N)..(quaternion + 4).min(N);
            let dot: f64 = slots.clone().map(|slot| first[slot] * values[slot]).sum();
            for (slot, value) in values.into_iter().enumerate() {
                let sign = if slots.contains(&slot) && dot < 0.0 { -1.0 } else { 1.0 };
                mean[slot] += sign * value;
            }
            stamps += i128::from(stamp_ns);
        }
        let stamp_ns = i64::try_from(stamps / n as i128).unwrap();
        let log_ns = stamp_ns + (latency_s * 1e9).round() as i64;
        rows.push(row(stamp_ns, log_ns, mean.map(|sum| sum / n as f64)));
    };
    for (t_s, values) in messages {
        count += 1;
        let stamp_ns = START_NS + (t_s * 1e9).round() as i64;
        if open.first().is_some_and(|(first, _)| stamp_ns - first >= ROW_NS) {
            close(&mut open, &mut rows);
        }
        open.push((stamp_ns, values));
    }
    close(&mut open, &mut rows);
    Series {
        count,
        stretches: vec![rows],
    }
}
