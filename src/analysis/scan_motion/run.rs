//! The clouds of one run matched to each other.
//!
//! Owns the pose of each cloud in the axes of the first: the points are brought to one time by the motion of the last step, and
//! matched to a key cloud as long as enough of it is visible. Must not decide which clouds, nor which way is up.

use nalgebra::{Isometry2, Vector2, Vector3};

use crate::analysis::scan_motion::moved::{Moment, ScanStep};
use crate::math::scan_match::{Scan, ScanMatch, matched};
use crate::world::cloud::CloudSlice;

/// Initial guesses for the first step, metres in x and y.
const GUESSES: [[f64; 2]; 5] = [[0.0, 0.0], [0.8, 0.0], [-0.8, 0.0], [0.0, 0.8], [0.0, -0.8]];
/// Share of a cloud that must match lines of the key cloud; else the last one becomes the key.
const KEY_OVERLAP: f64 = 0.7;

/// A cloud of a run, with the pose of its sensor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CloudPose {
    /// Number of the cloud among those that are kept.
    pub(crate) number: usize,
    moment: Moment,
    /// `first_from_this`: in the axes of the run's first cloud.
    pose: Isometry2<f64>,
    /// Variances of its match to its key cloud: of the angle and of the place, square radians and metres.
    variance: Vector2<f64>,
    /// Variances of its key cloud's pose.
    drift: Vector2<f64>,
}

impl CloudPose {
    /// The same pose at another time.
    pub(crate) fn at(self, moment: Moment) -> Self {
        Self { moment, ..self }
    }

    pub(crate) fn moved_to(&self, later: &Self) -> ScanStep {
        let motion = self.pose.inv_mul(&later.pose);
        let variance = self.variance + later.variance + (later.drift - self.drift).sup(&Vector2::zeros());
        let way_m = motion.translation.vector.norm();
        ScanStep {
            from: self.moment,
            to: later.moment,
            motion,
            sigma: [variance.x.sqrt(), (variance.y + self.variance.x * way_m * way_m).sqrt()],
        }
    }
}

/// A cloud as measured by a moving sensor.
pub(crate) struct RawCloud {
    number: usize,
    moment: Moment,
    /// Points, and their times, seconds after the middle of the cloud.
    points: Vec<(Vector2<f64>, f64)>,
}

impl RawCloud {
    pub(crate) fn of(
        (number, moment): (usize, Moment),
        slice: &CloudSlice,
        second: Option<f64>,
        flat: impl Fn(&Vector3<f64>) -> Option<Vector2<f64>>,
    ) -> Self {
        let last = slice.after.iter().copied().fold(0.0, f64::max);
        let after_s = |index: usize| match (second, slice.after.get(index)) {
            (Some(second), Some(after)) => (after - 0.5 * last) * second,
            _ => 0.0,
        };
        let points = slice.points.iter().enumerate();
        Self {
            number,
            moment,
            points: points
                .filter_map(|(index, point)| Some((flat(&Vector3::from(*point))?, after_s(index))))
                .collect(),
        }
    }

    /// The points at one time, for a sensor that moves at this rate.
    fn scan(&self, rate: &Rate) -> Scan {
        Scan::new(self.points.iter().map(|(point, after_s)| {
            let moved = Isometry2::new(rate.m_s * *after_s, rate.rad_s * after_s);
            (moved * nalgebra::Point2::from(*point)).coords
        }))
    }
}

/// Velocity of a sensor in its plane.
#[derive(Clone, Copy, Debug)]
struct Rate {
    m_s: Vector2<f64>,
    rad_s: f64,
}

impl Rate {
    const NONE: Self = Self {
        m_s: Vector2::new(0.0, 0.0),
        rad_s: 0.0,
    };

    fn of(step: &Isometry2<f64>, lasted_s: f64) -> Self {
        if lasted_s <= 0.0 {
            return Self::NONE;
        }
        Self {
            m_s: step.translation.vector / lasted_s,
            rad_s: step.rotation.angle() / lasted_s,
        }
    }
}

/// A run that is being matched. Clouds are matched to one key cloud as long as they show enough of it, since errors of steps add up.
pub(crate) struct Matching {
    key: Scan,
    /// Pose of the key cloud, and its variances.
    key_pose: Isometry2<f64>,
    key_drift: Vector2<f64>,
    last: Scan,
    /// `last_but_one_from_last`, and the rate that it makes.
    step: Option<(Isometry2<f64>, Rate)>,
    /// The first cloud, until a step shows the sensor's velocity.
    first: Option<RawCloud>,
    pub(crate) seen: Vec<CloudPose>,
}

impl Matching {
    pub(crate) fn of(first: RawCloud) -> Self {
        let scan = first.scan(&Rate::NONE);
        Self {
            key: scan.clone(),
            key_pose: Isometry2::identity(),
            key_drift: Vector2::zeros(),
            last: scan,
            step: None,
            seen: vec![CloudPose {
                number: first.number,
                moment: first.moment,
                pose: Isometry2::identity(),
                variance: Vector2::zeros(),
                drift: Vector2::zeros(),
            }],
            first: Some(first),
        }
    }

    /// Adds the next cloud; returns the clouds matched so far if this one cannot be matched.
    pub(crate) fn take_in(&mut self, raw: RawCloud) -> Option<Vec<CloudPose>> {
        let found = match self.first.take() {
            Some(first) => self.second(&first, &raw),
            None => self.next(&raw),
        };
        let (Some((found, scan)), Some(last)) = (found, self.seen.last()) else {
            return Some(std::mem::replace(self, Self::of(raw)).seen);
        };
        let pose = self.key_pose * found.motion;
        let step = last.pose.inv_mul(&pose);
        self.step = Some((step, Rate::of(&step, raw.moment.since(&last.moment))));
        self.seen.push(CloudPose {
            number: raw.number,
            moment: raw.moment,
            pose,
            variance: Vector2::new(found.sigma_rad.powi(2), found.sigma_m.powi(2)),
            drift: self.key_drift,
        });
        self.last = scan;
        None
    }

    /// Matches the second cloud to the first: from the best of several guesses, and again with the velocity that results.
    fn second(&mut self, first: &RawCloud, raw: &RawCloud) -> Option<(ScanMatch, Scan)> {
        let still = raw.scan(&Rate::NONE);
        let tried = GUESSES.map(|[x, y]| matched(&self.key, &still, &Isometry2::new(Vector2::new(x, y), 0.0)));
        let of = |found: &ScanMatch| found.overlap / (found.residual_m + 0.01);
        let rough = tried.into_iter().flatten().max_by(|a, b| of(a).total_cmp(&of(b)))?;
        let rate = Rate::of(&rough.motion, raw.moment.since(&first.moment));
        self.key = first.scan(&rate);
        let scan = raw.scan(&rate);
        Some((matched(&self.key, &scan, &rough.motion)?, scan))
    }

    /// Matches a later cloud, starting from the last step.
    fn next(&mut self, raw: &RawCloud) -> Option<(ScanMatch, Scan)> {
        let (step, rate) = self.step?;
        let scan = raw.scan(&rate);
        let pose = self.seen.last()?.pose * step;
        let by_key = matched(&self.key, &scan, &self.key_pose.inv_mul(&pose));
        let found = by_key.filter(|found| found.overlap >= KEY_OVERLAP).or_else(|| {
            self.last_as_key();
            matched(&self.key, &scan, &step)
        })?;
        Some((found, scan))
    }

    fn last_as_key(&mut self) {
        if let Some(last) = self.seen.last_mut() {
            self.key_drift += last.variance;
            (last.variance, last.drift) = (Vector2::zeros(), self.key_drift);
            self.key_pose = last.pose;
            self.key = self.last.clone();
        }
    }
}
