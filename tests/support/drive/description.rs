//! What may be said of a drive: the vehicle, how it moves, where, and how good its sensors are.

use serde::Deserialize;

use super::earth::Place;

/// A drive in words.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Description {
    /// What moves.
    pub vehicle: Vehicle,
    /// How it moves.
    pub motion: Motion,
    /// Length in seconds. A recipe's drive has the recipe's length.
    #[serde(skip)]
    pub duration_s: f64,
    /// Draws the trajectory and all noise.
    pub seed: u64,
    /// Where the drive begins: the origin of its ENU frame.
    pub place: Place,
    /// Height of the geoid over the ellipsoid at that place, metres.
    pub undulation_m: f64,
    /// Yaw at the start, degrees from east towards north; drawn where absent.
    pub yaw_deg: Option<f64>,
    /// Standard deviation of the ground's roll and pitch, degrees; the vehicle's own where absent.
    pub tilt_deg: Option<f64>,
    /// How good the IMU is.
    pub imu: Grade,
    /// What the GNSS receiver is; `perfect` makes poses in the map perfect, too.
    pub gnss: Gnss,
    /// Where odometry comes from.
    pub odometry: Wheels,
}

impl Default for Description {
    /// A car that turns now and then, for a minute, north of Munich.
    fn default() -> Self {
        Self {
            vehicle: Vehicle::Car,
            motion: Motion::Turning,
            duration_s: 60.0,
            seed: 0,
            place: Place {
                latitude: 48.0,
                longitude: 11.0,
                altitude: 500.0,
            },
            undulation_m: 46.0,
            yaw_deg: None,
            tilt_deg: None,
            imu: Grade::Tactical,
            gnss: Gnss::Rtk,
            odometry: Wheels::Real,
        }
    }
}

/// What moves.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Vehicle {
    /// 0 to 8 m/s, along its x axis only, never tighter than a circle of 5 m.
    Car,
    /// A legged robot: up to 1.5 m/s, steps sideways, sways with its gait at 2 Hz.
    Walker,
    /// Up to 8 m/s, leans into its acceleration, drifts sideways and up and down.
    Drone,
    /// A ground robot on wheels: up to 1.2 m/s, turns on the spot.
    Robot,
}

/// How it moves.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Speed and yaw rate wander.
    Turning,
    /// Speed wanders; the yaw rate has a deviation of 0.01 rad/s.
    Straight,
    /// At rest, on ground that is not quite level.
    Still,
    /// One circle after another at nearly the same speed.
    Circles,
    /// Straight out, one turn of half a circle in the middle of the drive, straight back.
    OutAndBack,
}

/// How good an IMU is; `imu.rs` has the numbers.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Of an INS.
    Tactical,
    /// Of a small board.
    Mems,
    /// Without error.
    Perfect,
}

/// What a GNSS receiver is; `gnss.rs` has the numbers.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Gnss {
    /// Fixed ambiguities.
    Rtk,
    /// Without corrections.
    Single,
    /// Without error.
    Perfect,
}

/// Where odometry comes from; `odometry.rs` has the numbers.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Wheels {
    /// It drifts, and its scale is wrong by a few per cent.
    Real,
    /// Without error.
    Perfect,
}
