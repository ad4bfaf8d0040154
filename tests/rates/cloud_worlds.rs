//! Worlds that a lidar sees: what is around, which sensor looks, what its driver and its transforms make of it, and what names what
//! is wrong with them.
//!
//! Rays are cast once for all faults of a drive; what is made of them is written as a recording and collected as one.

use std::cell::RefCell;
use std::f64::consts::PI;
use std::rc::Rc;

use frames_lint::source::Confidence;
use frames_lint::verdict::Finding;
use frames_lint::world::World;
use frames_lint::world::bag::TopicEvidence;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::cloud_scenes::SEEN;
use crate::drives::{FIX_LATENCY_S, Messages};
use crate::faults::Names;
use crate::support::clouds::{Driver, Lidar};
use crate::support::drive::description::Vehicle;
use crate::support::drive::lidar::{Beams, Ray};
use crate::support::drive::scene::Surroundings;
use crate::support::driven_world::{Recording, START_NS};
use crate::support::scans::{self, SCANS_HZ};

/// From one scan to the next.
const PERIOD_NS: i64 = 100_000_000;

/// What is around.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scenery {
    /// Streets, slopes and aprons in turn.
    Outdoors,
    Street,
    Warehouse,
    Garage,
}

/// Which sensor looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Five makers in turn.
    Any,
    Ouster,
    /// Those whose times are of a clock, in turn.
    Clocked,
    SolidState,
}

/// A world.
#[derive(Clone, Copy)]
#[allow(clippy::struct_excessive_bools)] // of a table
pub struct CloudWorld {
    pub name: &'static str,
    pub is_healthy: bool,
    pub around: Scenery,
    pub sensor: Sensor,
    /// Yaw of the mounting, degrees, by seed.
    pub yaw_deg: fn(u64) -> f64,
    /// What the driver makes of it.
    pub cloud: fn(&mut Lidar, u64),
    /// The cloud's axes from the driver's, the true mounting `base_from_sensor` given.
    pub axes: fn(&Isometry3<f64>) -> Isometry3<f64>,
    /// `base_from_sensor` as the transforms tell it, from the true one.
    pub stated: fn(Isometry3<f64>) -> Isometry3<f64>,
    /// The frame that the cloud names, and the frame that is mounted; those of the sensor where there is none.
    pub frames: Option<[&'static str; 2]>,
    /// What else is told.
    pub more: fn(Recording) -> Recording,
    /// Whether an inertial sensor is there.
    pub has_imu: bool,
    /// Whether nothing above a hint may be said of what is up.
    pub hints_alone: bool,
    /// What names the fault.
    pub names: Names,
    /// Whether it takes motion to see it.
    pub is_long: bool,
    /// The rules that are asked, with their subjects.
    pub asked: &'static [(&'static str, &'static str)],
}

/// The world of a name.
pub fn world_named(name: &str) -> &'static CloudWorld {
    let found = SEEN.iter().find(|world_named| world_named.name == name);
    found.unwrap_or_else(|| panic!("no world is called `{name}`"))
}

/// The rays of each scan.
type Scans = Rc<Vec<Vec<Ray>>>;

/// What the worlds of one drive share: the rays and the clouds of the last one.
#[derive(Default)]
pub struct DriveCache {
    rays: RefCell<Option<(String, Scans)>>,
    clouds: RefCell<Option<(String, TopicEvidence)>>,
}

impl CloudWorld {
    /// Whether a finding names the fault.
    pub fn is_named_by(&self, finding: &Finding) -> bool {
        let (relations, texts) = self.names;
        let is_told = finding
            .relation
            .as_deref()
            .is_some_and(|word| relations.contains(&word))
            || texts.iter().any(|text| finding.says(text));
        is_told && (!self.hints_alone || finding.rule != "AXES10" || finding.confidence == Confidence::Hint)
    }

    /// The world of a drive.
    pub fn world(&self, drive: &Messages, shared: &DriveCache) -> World {
        let seed = drive.drive.description.seed;
        let (mut lidar, name) = self.sensor.of(seed);
        lidar.surroundings = self.around.of(seed);
        let height_m = match drive.drive.description.vehicle {
            Vehicle::Robot => 0.6,
            _ => 1.8,
        };
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), (self.yaw_deg)(seed).to_radians());
        let mount = Isometry3::from_parts(Translation3::new(0.6, 0.1, height_m), turn);
        // The axes that the driver has by itself: that of a Hesai leaves azimuth 0 on y.
        let driver = match lidar.driver {
            Driver::Hesai => Isometry3::rotation(Vector3::z() * -PI / 2.0),
            _ => Isometry3::identity(),
        };
        (self.cloud)(&mut lidar, seed);
        let rays = shared.rays(&lidar, &mount, drive);
        lidar.stated = (self.axes)(&(mount * driver));
        let [frame, mounted] = self.frames.unwrap_or([name, name]);
        let topic = shared.clouds(&lidar, frame, &rays);
        let recording = Recording::default()
            .transform("base_footprint", "base_link", &Isometry3::identity())
            .transform("base_link", mounted, &(self.stated)(mount * driver))
            .odometry("/odom", &drive.odometry)
            .topic(topic);
        // Under a roof no satellite is seen.
        let recording = if self.hints_alone {
            recording
        } else {
            recording.fixes("/fix", "gps", &drive.fixes, FIX_LATENCY_S)
        };
        let recording = if self.has_imu {
            let imu = recording.transform("base_link", "imu_link", &drive.base_from_imu);
            imu.imu("/imu", "imu_link", &drive.imu)
        } else {
            recording
        };
        (self.more)(recording).world()
    }
}

impl Scenery {
    fn of(self, seed: u64) -> Surroundings {
        match self {
            Self::Outdoors => match seed % 4 {
                0 => Surroundings::Apron,
                1 => Surroundings::Slope,
                _ => Surroundings::Street,
            },
            Self::Street => Surroundings::Street,
            Self::Warehouse => Surroundings::Warehouse,
            Self::Garage => Surroundings::Garage,
        }
    }
}

impl Sensor {
    /// The lidar of a seed, and its frame.
    fn of(self, seed: u64) -> (Lidar, &'static str) {
        let spinning = |driver, table, beams, columns| Lidar {
            driver,
            beams,
            columns,
            table,
            ..Lidar::default()
        };
        let makers = [
            (spinning(Driver::Ouster, Beams::Os1, 16, 256), "os_sensor"),
            (spinning(Driver::Velodyne, Beams::Vlp16, 16, 256), "velodyne"),
            (spinning(Driver::Nebula, Beams::Even, 16, 256), "lidar_top"),
            (spinning(Driver::Hesai, Beams::Pandar40, 40, 240), "hesai_lidar"),
            (spinning(Driver::Robosense, Beams::Even, 16, 256), "rslidar"),
        ];
        // By fives beside the fours of what is around.
        let number = match self {
            Self::Any => (seed / 4 % 5) as usize,
            Self::Ouster => 0,
            Self::Clocked => 3 + (seed / 4 % 2) as usize,
            Self::SolidState => {
                let livox = Lidar {
                    solid_state: true,
                    ..spinning(
                        [Driver::Livox, Driver::LivoxPoints][(seed % 2) as usize],
                        Beams::Even,
                        6,
                        600,
                    )
                };
                return (livox, "livox_frame");
            }
        };
        makers[number].clone()
    }
}

impl DriveCache {
    /// The rays of a sensor, cast where the last ones were of another.
    fn rays(&self, lidar: &Lidar, mount: &Isometry3<f64>, drive: &Messages) -> Rc<Vec<Vec<Ray>>> {
        let before_s = lidar.before_stamp_s();
        let key = format!("{:?} {:?} {before_s} {mount:?}", lidar.scanner(), lidar.surroundings);
        if let Some((of, rays)) = &*self.rays.borrow()
            && *of == key
        {
            return Rc::clone(rays);
        }
        let (scanner, scene) = (lidar.scanner(), drive.drive.scene(lidar.surroundings));
        let scans = drive.drive.times(SCANS_HZ);
        let scans = scans
            .iter()
            .map(|t_s| drive.drive.scan(&scene, &scanner, mount, t_s - before_s));
        let rays = Rc::new(scans.collect::<Vec<_>>());
        *self.rays.borrow_mut() = Some((key, Rc::clone(&rays)));
        rays
    }

    /// What is collected of the clouds that a driver makes of rays.
    fn clouds(&self, lidar: &Lidar, frame: &str, rays: &Rc<Vec<Vec<Ray>>>) -> TopicEvidence {
        let key = format!("{lidar:?} {frame} {:?}", Rc::as_ptr(rays));
        if let Some((of, topic)) = &*self.clouds.borrow()
            && *of == key
        {
            return topic.clone();
        }
        let topic = scans::collected(lidar, frame, rays, |number| {
            [START_NS + i64::try_from(number).unwrap() * PERIOD_NS; 2]
        });
        *self.clouds.borrow_mut() = Some((key, topic.clone()));
        topic
    }
}
