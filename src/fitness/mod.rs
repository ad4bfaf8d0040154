//! Whether a recording is fit for a calibration: the conditions of each kind, each with what was measured.
//!
//! Reads estimates, and what the rules say. A condition that could not be evaluated never makes a recording fit.

mod camera_lidar;
mod conditions;
mod excited;
mod hand_eye;
mod lidar_imu;
mod stamped;

use std::cmp::Reverse;

use crate::analysis::Estimates;
use crate::verdict::{Measured, Verdict};

/// A kind of calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Calibration {
    /// The mounting of a lidar and of an inertial sensor to each other, by their motion.
    LidarImu,
    /// The mounting of two sensors with poses to each other: `A X = X B`.
    HandEye,
    /// The mounting of a camera and of a lidar to each other, by a target that both see.
    CameraLidar,
}

impl Calibration {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::LidarImu, Self::HandEye, Self::CameraLidar];

    /// The word on the command line and in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::LidarImu => "lidar-imu",
            Self::HandEye => "hand-eye",
            Self::CameraLidar => "camera-lidar",
        }
    }
}

/// What became of a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ConditionState {
    /// Evaluated, and not met.
    NotMet,
    /// Not evaluated.
    NotEvaluated,
    /// Evaluated, and met.
    Met,
}

impl ConditionState {
    /// The word in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::NotMet => "not met",
            Self::NotEvaluated => "not evaluated",
            Self::Met => "met",
        }
    }
}

/// One condition of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Its name: `time together`.
    pub name: &'static str,
    /// What is asked.
    pub asks: String,
    /// What became of it.
    pub state: ConditionState,
    /// Why it is not met or was not evaluated; of a condition that is met, a remark.
    pub reason: Option<String>,
    /// What to record or to add; `None` if it is met.
    pub record: Option<String>,
    /// What was measured, with limits.
    pub measured: Vec<Measured>,
    /// Whether the calibration is impossible without it; else it is worth knowing only.
    pub is_needed: bool,
}

/// A recording as a whole, in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FitnessWord {
    /// A needed condition is not met.
    NotFit,
    /// A needed condition was not evaluated, and the others are met.
    Unknown,
    /// Every needed condition is met.
    Fit,
}

impl FitnessWord {
    /// The word in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::NotFit => "not fit",
            Self::Unknown => "cannot be told",
            Self::Fit => "fit",
        }
    }
}

/// Whether a recording is fit for the calibration of one sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitness {
    /// The kind of calibration.
    pub calibration: Calibration,
    /// The name of the recording or of its platform.
    pub platform: String,
    /// The streams that are to be calibrated: ``topic `/points` and topic `/imu` ``.
    pub subject: String,
    /// The conditions.
    pub conditions: Vec<Condition>,
}

impl Fitness {
    /// The recording in one word.
    pub fn verdict(&self) -> FitnessWord {
        verdict(&self.conditions)
    }

    /// The needed conditions that decide against it: those that are not met, else those that were not evaluated.
    pub fn lacking(&self) -> impl Iterator<Item = &Condition> {
        lacking(&self.conditions)
    }

    /// The fitness of what has no recording.
    pub fn without_recording(calibration: Calibration) -> Self {
        let condition = Condition::open("recording", "a recording", "no recording was read")
            .record("give a recording (ROS 1 bag, rosbag2 or MCAP)");
        Self {
            calibration,
            platform: String::new(),
            subject: "no recording".to_owned(),
            conditions: vec![condition],
        }
    }
}

fn verdict(conditions: &[Condition]) -> FitnessWord {
    let needed = conditions.iter().filter(|condition| condition.is_needed);
    match needed.map(|condition| condition.state).min() {
        Some(ConditionState::Met) => FitnessWord::Fit,
        Some(ConditionState::NotMet) => FitnessWord::NotFit,
        Some(ConditionState::NotEvaluated) | None => FitnessWord::Unknown,
    }
}

fn lacking(conditions: &[Condition]) -> impl Iterator<Item = &Condition> {
    let decisive = match verdict(conditions) {
        FitnessWord::Fit => None,
        FitnessWord::NotFit => Some(ConditionState::NotMet),
        FitnessWord::Unknown => Some(ConditionState::NotEvaluated),
    };
    let needed = conditions.iter().filter(|condition| condition.is_needed);
    needed.filter(move |condition| Some(condition.state) == decisive)
}

/// The fitness of a world's recordings for a kind of calibration: one for each lidar or camera, with the partner that it suits best, and
/// one for hand-eye. `verdict` is that of the rules on this world.
pub fn fitness(world: &Estimates, verdict: &Verdict, calibration: Calibration) -> Vec<Fitness> {
    let found = match calibration {
        Calibration::LidarImu => lidar_imu::all(world, verdict),
        Calibration::HandEye => hand_eye::all(world, verdict),
        Calibration::CameraLidar => camera_lidar::all(world, verdict),
    };
    let found = found.into_iter().map(|(subject, conditions)| Fitness {
        calibration,
        platform: world.label.clone(),
        subject,
        conditions,
    });
    found.collect()
}

/// The pair of streams that is nearest to fit; of equals the first.
fn best(pairs: impl Iterator<Item = Pair>) -> Option<Pair> {
    let rank = |(_, conditions): &Pair| (verdict(conditions), Reverse(lacking(conditions).count()));
    pairs.reduce(|best, other| if rank(&other) > rank(&best) { other } else { best })
}

/// The subject and the conditions of a pair of streams.
type Pair = (String, Vec<Condition>);

#[cfg(test)]
mod tests {
    use super::*;

    fn of(states: &[(ConditionState, bool)]) -> Fitness {
        let condition = |(state, is_needed): &(ConditionState, bool)| Condition {
            state: *state,
            is_needed: *is_needed,
            ..Condition::open("x", "x", "x")
        };
        Fitness {
            conditions: states.iter().map(condition).collect(),
            ..Fitness::without_recording(Calibration::HandEye)
        }
    }

    #[test]
    fn only_what_is_needed_decides_and_what_is_unknown_is_not_fit() {
        use ConditionState::{Met, NotEvaluated, NotMet};
        for (states, verdict, lacking) in [
            (&[][..], FitnessWord::Unknown, 0),
            (&[(Met, true), (Met, true)], FitnessWord::Fit, 0),
            (
                &[(Met, true), (NotMet, false), (NotEvaluated, false)],
                FitnessWord::Fit,
                0,
            ),
            (&[(Met, true), (NotEvaluated, true)], FitnessWord::Unknown, 1),
            (
                &[(NotMet, true), (NotEvaluated, true), (Met, true)],
                FitnessWord::NotFit,
                1,
            ),
            (&[(Met, false)], FitnessWord::Unknown, 0),
        ] {
            let fitness = of(states);
            assert_eq!(
                (fitness.verdict(), fitness.lacking().count()),
                (verdict, lacking),
                "{states:?}"
            );
        }
        assert_eq!(
            Fitness::without_recording(Calibration::HandEye).verdict(),
            FitnessWord::Unknown
        );
    }

    #[test]
    fn the_pair_that_is_nearest_to_fit_counts() {
        use ConditionState::{Met, NotEvaluated, NotMet};
        let pair = |name: &str, states: &[ConditionState]| {
            let states: Vec<_> = states.iter().map(|state| (*state, true)).collect();
            (name.to_owned(), of(&states).conditions)
        };
        let pairs = [
            pair("a", &[NotMet, NotMet, Met]),
            pair("b", &[NotMet, Met, Met]),
            pair("c", &[NotEvaluated, Met, Met]),
            pair("d", &[NotEvaluated, Met, Met]),
        ];
        assert_eq!(best(pairs.iter().take(2).cloned()).unwrap().0, "b");
        assert_eq!(best(pairs.into_iter()).unwrap().0, "c");
        assert!(best(std::iter::empty()).is_none());
    }
}
