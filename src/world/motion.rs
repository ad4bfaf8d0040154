//! Evidence of motion: the data of moving sensors and estimators over time, as published, in sections without gaps.
//!
//! A row is one message, or the mean of the messages within [`ROW_NS`] of a stream that is faster than that. Means are
//! taken number by number (of quaternions with one sign), so that another order, sign or unit of the numbers can be
//! tried on the rows just as on the messages.

use serde::{Deserialize, Serialize};

/// Shortest time that one row covers, nanoseconds.
pub const ROW_NS: i64 = 50_000_000;

/// A row with a time.
pub trait Row: Clone {
    /// Header stamp, nanoseconds; zero where the messages have none.
    fn stamp_ns(&self) -> i64;
    /// Log time, nanoseconds.
    fn log_ns(&self) -> i64;
}

/// The rows of one stream, in recording order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series<T> {
    /// Messages that the rows were made from, including those beyond the bound.
    pub count: u64,
    /// Runs of rows. Between two of them messages were skipped, the stamps jumped back, or nothing was published for
    /// seconds.
    pub stretches: Vec<Vec<T>>,
}

impl<T> Series<T> {
    /// Every row of every section.
    pub fn rows(&self) -> impl Iterator<Item = &T> {
        self.stretches.iter().flatten()
    }
}

/// Inertial measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InertialRow {
    /// Header stamp, nanoseconds; zero where there is none.
    pub stamp_ns: i64,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// `x y z w` slots as published, not normalised.
    #[serde(with = "super::number::array")]
    pub orientation: [f64; 4],
    /// rad/s by the message's definition.
    #[serde(with = "super::number::array")]
    pub angular_velocity: [f64; 3],
    /// m/s² by the message's definition; specific force, if the sensor follows REP-145.
    #[serde(with = "super::number::array")]
    pub linear_acceleration: [f64; 3],
}

/// A pose, and the velocity that was published with it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseRow {
    /// Header stamp, nanoseconds; zero where there is none.
    pub stamp_ns: i64,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// Metres, in the parent frame.
    #[serde(with = "super::number::array")]
    pub position: [f64; 3],
    /// `x y z w` slots as published, not normalised.
    #[serde(with = "super::number::array")]
    pub orientation: [f64; 4],
    /// Velocity and angular velocity, m/s and rad/s, in the child frame by definition, where the message has them.
    pub twist: Option<Twist>,
}

/// A velocity with an angular velocity, as published.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// m/s.
    #[serde(with = "super::number::array")]
    pub linear: [f64; 3],
    /// rad/s.
    #[serde(with = "super::number::array")]
    pub angular: [f64; 3],
}

/// A velocity on a topic of its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TwistRow {
    /// Header stamp, nanoseconds; zero where there is none.
    pub stamp_ns: i64,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// The velocity.
    pub twist: Twist,
}

/// A satellite fix with a position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FixRow {
    /// Header stamp, nanoseconds; zero where there is none.
    pub stamp_ns: i64,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// Degrees.
    #[serde(with = "super::number")]
    pub latitude_deg: f64,
    /// Degrees.
    #[serde(with = "super::number")]
    pub longitude_deg: f64,
    /// Metres, above the ellipsoid by definition.
    #[serde(with = "super::number")]
    pub altitude_m: f64,
    /// Variances east, north, up, m²; zeros if the receiver gives none.
    #[serde(with = "super::number::array")]
    pub variance_m2: [f64; 3],
    /// The lowest `NavSatStatus.status` of the row: 0 fix, 1 SBAS, 2 GBAS.
    pub status: i8,
}

impl FixRow {
    /// The receiver's horizontal error in the direction where it is larger, one standard deviation, metres; `None` if it
    /// states none.
    #[must_use]
    pub fn horizontal_sd_m(&self) -> Option<f64> {
        let [east, north, _] = self.variance_m2;
        stated(east.max(north))
    }

    /// The receiver's vertical error, one standard deviation, metres; `None` if it states none.
    #[must_use]
    pub fn vertical_sd_m(&self) -> Option<f64> {
        stated(self.variance_m2[2])
    }
}

fn stated(variance_m2: f64) -> Option<f64> {
    (variance_m2 > 0.0 && variance_m2.is_finite()).then(|| variance_m2.sqrt())
}

/// An orientation on a topic of its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrientationRow {
    /// Header stamp, nanoseconds; zero where there is none.
    pub stamp_ns: i64,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// `x y z w` slots as published, not normalised.
    #[serde(with = "super::number::array")]
    pub orientation: [f64; 4],
}

/// A vector on a topic of its own: the message does not state what it measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VectorRow {
    /// Header stamp, nanoseconds; zero where there is none.
    pub stamp_ns: i64,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// As published.
    #[serde(with = "super::number::array")]
    pub vector: [f64; 3],
}

/// The numbers of NMEA 0183 sentences that came together; NaN for those that none of them has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NmeaRow {
    /// Header stamp, nanoseconds; zero where there is none.
    pub stamp_ns: i64,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// UTC, seconds of the day.
    #[serde(with = "super::number")]
    pub time_s: f64,
    /// Degrees; also NaN if the sentence states that it has no fix.
    #[serde(with = "super::number")]
    pub latitude_deg: f64,
    /// Degrees.
    #[serde(with = "super::number")]
    pub longitude_deg: f64,
    /// Metres above mean sea level.
    #[serde(with = "super::number")]
    pub altitude_m: f64,
    /// Mean sea level above the ellipsoid, metres, by the receiver.
    #[serde(with = "super::number")]
    pub geoid_separation_m: f64,
    /// Speed over ground, m/s.
    #[serde(with = "super::number")]
    pub speed_m_s: f64,
    /// Course over ground, degrees clockwise from true north.
    #[serde(with = "super::number")]
    pub course_deg: f64,
    /// Degrees clockwise from true north.
    #[serde(with = "super::number")]
    pub true_heading_deg: f64,
    /// Degrees clockwise from magnetic north.
    #[serde(with = "super::number")]
    pub magnetic_heading_deg: f64,
    /// Direction of magnetic north from true north, degrees, east positive.
    #[serde(with = "super::number")]
    pub variation_deg: f64,
    /// As GGA counts: 0 no fix, 1 GNSS, 2 differential, 3 precise, 4 RTK, 5 RTK float, 6 dead reckoning, 7 typed in, 8
    /// simulated.
    pub quality: Option<u8>,
}

macro_rules! rows {
    ($($row:ty),*) => {$(
        impl Row for $row {
            fn stamp_ns(&self) -> i64 {
                self.stamp_ns
            }

            fn log_ns(&self) -> i64 {
                self.log_ns
            }
        }
    )*};
}

rows!(
    InertialRow,
    PoseRow,
    TwistRow,
    FixRow,
    OrientationRow,
    VectorRow,
    NmeaRow
);

/// The motion on one topic, or in a member of its messages.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionEvidence {
    /// Inertial measurements.
    pub inertial: Option<Series<InertialRow>>,
    /// Poses: odometry, poses, paths.
    pub poses: Option<Series<PoseRow>>,
    /// Velocities. Together with fixes they are the receiver's: east, north, up, without an angular velocity (NaN).
    pub twists: Option<Series<TwistRow>>,
    /// Satellite fixes.
    pub fixes: Option<Series<FixRow>>,
    /// Orientations.
    #[serde(default)]
    pub orientations: Option<Series<OrientationRow>>,
    /// Vectors.
    #[serde(default)]
    pub vectors: Option<Series<VectorRow>>,
    /// Sentences of NMEA 0183. A row combines those within [`ROW_NS`], the first of each kind; no means.
    #[serde(default)]
    pub nmea: Option<Series<NmeaRow>>,
}
