//! The drives that the rules are tried on, and the worlds that come of them.

use std::f64::consts::{FRAC_PI_2, PI};

use frames_lint::world::World;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::faults::Fault;
use crate::frame_worlds;
use crate::support::drive::description::{Gnss, Grade, Motion, Vehicle};
use crate::support::drive::rows::{FixRow, ImuRow, OdometryRow};
use crate::support::drive::{Description, Drive, Stream};
use crate::support::driven_world::Recording;

/// A kind of drive: everything but the seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    pub vehicle: Vehicle,
    pub motion: Motion,
    pub seconds: u32,
    pub imu: Grade,
    pub gnss: Gnss,
}

/// How often sensors speak.
const IMU_HZ: f64 = 100.0;
pub const ODOMETRY_HZ: f64 = 20.0;
const FIX_HZ: f64 = 5.0;
/// From the time of a fix to its message, seconds.
pub const FIX_LATENCY_S: f64 = 0.1;
/// Where the antenna is on the base, metres.
const ANTENNA: [f64; 3] = [-0.1, 0.0, 0.8];

/// The messages of a drive, all of them right.
#[derive(Debug)]
pub struct Messages {
    pub drive: Drive,
    pub base_from_imu: Isometry3<f64>,
    pub imu: Vec<ImuRow>,
    pub odometry: Vec<OdometryRow>,
    pub fixes: Vec<FixRow>,
}

impl Kind {
    /// The messages of a seed.
    pub fn messages(self, seed: u64) -> Messages {
        let drive = Drive::new(Description {
            vehicle: self.vehicle,
            motion: self.motion,
            duration_s: f64::from(self.seconds),
            seed,
            imu: self.imu,
            gnss: self.gnss,
            ..Description::default()
        });
        let base_from_imu = base_from_imu(seed);
        let fixes = Stream::new("receiver gps", drive.times(FIX_HZ))
            .mounted(Isometry3::translation(ANTENNA[0], ANTENNA[1], ANTENNA[2]));
        Messages {
            base_from_imu,
            imu: drive.imu_rows(&Stream::new("/imu", drive.times(IMU_HZ)).mounted(base_from_imu)),
            odometry: drive.odometry_rows(&Stream::new("/odom", drive.times(ODOMETRY_HZ))),
            fixes: drive.fix_rows(&fixes),
            drive,
        }
    }
}

/// Where the IMU sits: half of the seeds have it straight, the others turned about z by quarters, which TF says.
pub fn base_from_imu(seed: u64) -> Isometry3<f64> {
    let yaw = match seed % 6 {
        1 => FRAC_PI_2,
        3 => -FRAC_PI_2,
        5 => PI,
        _ => 0.0,
    };
    Isometry3::from_parts(
        Translation3::new(0.1, 0.05, 0.3),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw),
    )
}

impl Messages {
    /// The world that a recording with a fault gives.
    pub fn world(&self, fault: Fault) -> World {
        if let Fault::FrameWorld(name) = fault {
            return frame_worlds::made(name).world(self);
        }
        let description = &self.drive.description;
        let imu = fault.imu(&self.imu, description.place.gravity());
        let odometry = fault.odometry(&self.odometry);
        let fixes = fault.fixes(&self.fixes, description.undulation_m);
        Recording::default()
            .transform("base_link", "imu_link", &self.base_from_imu)
            .imu("/imu", "imu_link", imu.as_ref().unwrap_or(&self.imu))
            .odometry("/odom", odometry.as_ref().unwrap_or(&self.odometry))
            .fixes("/fix", "gps", fixes.as_ref().unwrap_or(&self.fixes), FIX_LATENCY_S)
            .world()
    }
}
