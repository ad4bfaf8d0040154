//! Drives with exact truth and realistic noise, for tests and statistics: a vehicle moves, sensors see it, and convention
//! errors are put into what the sensors say.
//!
//! Nothing here uses the code under test: formulas are those of textbooks, rotations come from `nalgebra`.
//!
//! ```ignore
//! let drive = Drive::new(Description { seed: 7, vehicle: Vehicle::Robot, ..Description::default() });
//! let imu = drive.imu_rows(&Stream::new("/imu", drive.times(100.0)).errors(&[Error::NedFrd]));
//! ```
//!
//! Rows are quick: a drive of two minutes with 100 Hz of IMU takes some 70 ms in a release build. Scenarios that differ in
//! errors alone can share the rows, and put each error into a copy of them (`ImuRow::apply`).
//!
//! Time is in seconds after the start of the drive. A row's `t_s` is its stamp; a stream that is `late_s` late shows the
//! world as it was that much earlier.

pub mod covariance;
pub mod description;
pub mod earth;
pub mod errors;
pub mod gnss;
pub mod imu;
pub mod lidar;
pub mod nmea;
pub mod odometry;
pub mod planar;
pub mod pose;
pub mod radar;
pub mod random;
pub mod rows;
pub mod scene;
pub mod spline;
pub mod truth;
pub mod vehicle;

use std::sync::OnceLock;

use nalgebra::{Isometry3, Vector3};

pub use description::Description;
pub use earth::Place;
pub use errors::Error;
use random::Random;
pub use truth::State;
use truth::Truth;

/// A drive.
#[derive(Debug)]
pub struct Drive {
    /// What it was made from.
    pub description: Description,
    truth: Truth,
    odometry: OnceLock<odometry::Drift>,
}

/// How a sensor of a drive is read: when, from where, and what is wrong with it.
#[derive(Clone, Debug)]
pub struct Stream {
    /// Seeds the noise: two streams of other names have other noise. GNSS noise is a function of this and of time: all
    /// streams of one receiver have one name, whatever their rates.
    pub name: String,
    /// Times of the rows, ascending.
    pub times_s: Vec<f64>,
    /// How old what a row shows is.
    pub late_s: f64,
    /// How old the orientation alone is beyond that; the grade's where absent.
    pub orientation_lag_s: Option<f64>,
    /// Where the sensor sits.
    pub base_from_sensor: Isometry3<f64>,
    /// The origin of the ENU frame that poses are given in; the drive's place where absent.
    pub datum: Option<Place>,
    /// The frame that poses are given in, against ENU.
    pub world_from_enu: Isometry3<f64>,
    /// Multiplies every noise and every bias.
    pub noise: f64,
    /// Multiplies every covariance: below 1 a sensor believes itself better than it is.
    pub covariance_scale: f64,
    /// What is wrong, applied in this order.
    pub errors: Vec<Error>,
}

impl Stream {
    /// A stream without any fault, from the vehicle's base.
    pub fn new(name: &str, times_s: Vec<f64>) -> Self {
        Self {
            name: name.to_owned(),
            times_s,
            late_s: 0.0,
            orientation_lag_s: None,
            base_from_sensor: Isometry3::identity(),
            datum: None,
            world_from_enu: Isometry3::identity(),
            noise: 1.0,
            covariance_scale: 1.0,
            errors: Vec::new(),
        }
    }

    /// With errors.
    pub fn errors(mut self, errors: &[Error]) -> Self {
        self.errors = errors.to_vec();
        self
    }

    /// That shows the world as it was some seconds ago.
    pub fn late(mut self, late_s: f64) -> Self {
        self.late_s = late_s;
        self
    }

    /// Of a sensor that sits elsewhere.
    pub fn mounted(mut self, base_from_sensor: Isometry3<f64>) -> Self {
        self.base_from_sensor = base_from_sensor;
        self
    }

    fn has(&self, error: Error) -> bool {
        self.errors.contains(&error)
    }
}

impl Drive {
    /// The drive of a description.
    pub fn new(description: Description) -> Self {
        let end_s = description.duration_s + vehicle::MARGIN_S;
        Self {
            truth: Truth::new(vehicle::curves(&description), -vehicle::MARGIN_S, end_s),
            description,
            odometry: OnceLock::new(),
        }
    }

    /// The truth at a time.
    pub fn at(&self, t_s: f64) -> State {
        State {
            position: self.truth.position(t_s),
            ..self.moment(t_s)
        }
    }

    /// The truth at a time, the position left zero: four times as fast.
    fn moment(&self, t_s: f64) -> State {
        let [start_s, end_s] = self.known_s();
        assert!((start_s..=end_s).contains(&t_s), "the drive is not known at {t_s} s");
        self.truth.moment(t_s)
    }

    /// Times at a rate, from the start up to, not including, the end.
    pub fn times(&self, rate_hz: f64) -> Vec<f64> {
        (0..u32::MAX)
            .map(|tick| f64::from(tick) / rate_hz)
            .take_while(|t_s| *t_s < self.description.duration_s)
            .collect()
    }

    /// What an ideal accelerometer at a place of the body feels, in the base's axes, m/s².
    pub fn specific_force(&self, state: &State, arm: Vector3<f64>) -> Vector3<f64> {
        let up = Vector3::z() * self.description.place.gravity();
        let force = state.orientation.inverse() * (state.acceleration + up);
        if arm == Vector3::zeros() {
            return force;
        }
        let turning = self.truth.angular_acceleration(state.t_s).cross(&arm);
        force + turning + state.rate.cross(&state.rate.cross(&arm))
    }

    fn random(&self, stream: &str) -> Random {
        Random::new(self.description.seed, stream)
    }

    /// Three normal numbers of a stream at a moment.
    fn normals_at(&self, stream: &str, t_s: f64) -> Vector3<f64> {
        Random::at(self.description.seed, stream, t_s).normals()
    }

    /// From when to when the drive is known.
    fn known_s(&self) -> [f64; 2] {
        [-vehicle::MARGIN_S, self.description.duration_s + vehicle::MARGIN_S]
    }
}
