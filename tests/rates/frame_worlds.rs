//! Worlds in which frames are right or wrong: other streams than the one IMU, odometry and receiver of every drive, and what
//! names what is wrong with them.

use std::f64::consts::FRAC_PI_2;

use frames_lint::world::World;
use nalgebra::{Isometry3, Matrix3, Rotation2, Rotation3, Vector2, Vector3};

use crate::drives::{FIX_LATENCY_S, Messages, ODOMETRY_HZ};
use crate::faults::{CONSTANT, Fault, MIRRORED, Names};
use crate::support::drive::description::Wheels;
use crate::support::drive::errors::{Error, OrientedRow, frd_from_flu, rotation, turn};
use crate::support::drive::rows::{ImuRow, OdometryRow, PoseRow};
use crate::support::drive::{Description, Drive, Stream};
use crate::support::driven_world::Recording;

/// A world, by its name.
pub struct FrameWorld {
    pub name: &'static str,
    /// What names its fault; `None` where nothing is wrong.
    pub names: Option<Names>,
    recording: fn(&Messages) -> Recording,
    /// Whether nothing is wrong with it on this drive, though there is on others.
    is_right: fn(&Messages) -> bool,
}

/// The world of a name.
pub fn made(name: &str) -> &'static FrameWorld {
    let known = MADE.iter().find(|made| made.name == name);
    known.unwrap_or_else(|| panic!("no world is called `{name}`"))
}

/// What the fault is on this drive: nothing, where the drive does not show it.
pub fn truth(messages: &Messages, fault: Fault) -> Fault {
    match fault {
        Fault::FrameWorld(name) if (made(name).is_right)(messages) => Fault::Healthy,
        _ => fault,
    }
}

impl FrameWorld {
    const fn healthy(name: &'static str, recording: fn(&Messages) -> Recording) -> Self {
        Self {
            name,
            names: None,
            recording,
            is_right: |_| true,
        }
    }

    const fn wrong(name: &'static str, names: Names, recording: fn(&Messages) -> Recording) -> Self {
        Self {
            name,
            names: Some(names),
            recording,
            is_right: |_| false,
        }
    }

    /// The world of a drive.
    pub fn world(&self, messages: &Messages) -> World {
        (self.recording)(messages).world()
    }
}

/// What QUAT04 says of two orientations expressed in a frame of one name.
const WORLDS: &str = "is constant in the axes of the world";

/// What AXES14 says of poses that may not be of the body that TF knows, or in another order.
const OTHER_AXES: &str = "the orientation may be expressed in other body axes, or with w first";

/// What AXES08 says of poses whose orientation may be wrong.
const ORIENTATION: &str = "the orientation of the pose is wrong";

/// What AXES13 says of poses that may stand in another order.
const W_FIRST: &str = "the quaternion may be in the order w, x, y, z";

/// A world whose z points down: the track in it is a mirror image, and its base may be what is upside down.
const DOWN: Names = (
    &["z-down", "mirrored"],
    &[MIRRORED, "the frame that the pose is expressed in may have z down"],
);

/// Every world.
pub const MADE: &[FrameWorld] = &[
    // Bases. While a drive is too short for a front, a base turned under a sensor looks like a sensor turned on it.
    FrameWorld::healthy("TF alone", |drive| {
        Recording::default().moving("odom", "base_link", &drive.edge(&[]))
    }),
    FrameWorld::wrong("TF alone, base FRD", (&["frd"], &["-z points up"]), |drive| {
        Recording::default().moving("odom", "base_link", &drive.edge(&[Error::Inverted]))
    }),
    FrameWorld::wrong(
        "pose of base FRD",
        (&["frd", "flu-frd"], &[CONSTANT, OTHER_AXES, "-z points up"]),
        |drive| drive.with(Isometry3::identity(), &drive.odom(&[Error::Inverted])),
    ),
    FrameWorld::wrong("pose of base RFU", (&["rfu", "z-90"], &[CONSTANT]), |drive| {
        drive.with(Isometry3::identity(), &drive.odom(&[Error::YForward]))
    }),
    FrameWorld::wrong("base FRD", (&["frd"], &["-z points up"]), |drive| {
        drive.on(Error::Inverted)
    }),
    FrameWorld::wrong(
        "base RFU",
        (&["rfu"], &["a body whose y axis points forward"]),
        |drive| drive.on(Error::YForward),
    ),
    FrameWorld::wrong("base LBU", (&["lbu"], &["a sensor rotated to the left"]), |drive| {
        drive.on(Error::Yaw90)
    }),
    FrameWorld::wrong(
        "base backward",
        (&[], &["moves backwards", "a sensor mounted backwards"]),
        |drive| drive.on(Error::Backward),
    ),
    // Frames of the world.
    FrameWorld::wrong("odom NED", DOWN, |drive| {
        drive.with(Isometry3::identity(), &drive.odom(&[Error::NedWorld]))
    }),
    FrameWorld::wrong("odom z negated", (&["z-down"], &[]), |drive| {
        drive.with(Isometry3::identity(), &drive.odom(&[Error::ZNegated]))
    }),
    FrameWorld::healthy("map", |drive| drive.in_map(&Rotation3::identity())),
    FrameWorld::wrong("map optical", (&["optical"], &[]), |drive| {
        drive.in_map(&flu_from_rdf().inverse())
    }),
    FrameWorld::wrong("map y up", (&["y-up"], &[]), |drive| drive.in_map(&about_x(-90.0))),
    FrameWorld::wrong("map z down", DOWN, |drive| drive.in_map(&about_x(180.0))),
    FrameWorld::wrong("map tilted 20 deg", (&["tilted"], &[]), |drive| {
        drive.in_map(&about_x(20.0))
    }),
    FrameWorld::wrong("map tilted 50 deg", (&["tilted"], &[]), |drive| {
        drive.in_map(&about_x(50.0))
    }),
    // Orders of four numbers.
    FrameWorld::wrong("odom wxyz", (&["wxyz"], &[OTHER_AXES, W_FIRST, ORIENTATION]), |drive| {
        drive.with(Isometry3::identity(), &drive.odom(&[Error::Wxyz]))
    }),
    FrameWorld::wrong("TF wxyz", (&["wxyz"], &[W_FIRST]), |drive| {
        Recording::default().moving("odom", "base_link", &drive.edge(&[Error::Wxyz]))
    }),
    FrameWorld::healthy("poses", |drive| {
        Recording::default().poses("/pose", "map", &drive.localised("/pose"))
    }),
    FrameWorld::wrong("poses wxyz", (&["wxyz"], &[]), |drive| {
        let mut rows = drive.localised("/pose");
        for row in &mut rows {
            crate::support::drive::errors::apply(row, Error::Wxyz);
        }
        Recording::default().poses("/pose", "map", &rows)
    }),
    // Two orientations of one platform.
    FrameWorld::healthy("wheels, VIO", |drive| drive.with_vio(&Rotation3::identity())),
    FrameWorld::wrong("VIO of FRD", (&["flu-frd", "frd"], &[CONSTANT]), |drive| {
        drive.with_vio(&frd_from_flu())
    }),
    FrameWorld::wrong(
        "VIO of RDF",
        (&["optical", "optical-inverse", "rdf"], &[CONSTANT]),
        |drive| drive.with_vio(&flu_from_rdf()),
    ),
    FrameWorld::healthy("two maps", |drive| drive.two_maps(&Rotation3::identity())),
    FrameWorld::wrong("two maps, x 90 deg", (&["x90"], &[WORLDS]), |drive| {
        drive.two_maps(&about_x(90.0))
    }),
    FrameWorld::wrong("two maps, z down", (&["flu-frd"], &[WORLDS]), |drive| {
        drive.two_maps(&about_x(180.0))
    }),
    // A correction of the map.
    FrameWorld::healthy("correction moves", |drive| {
        let correction = drive
            .drive
            .map_odom_rows(&Stream::new("/tf", drive.drive.times(ODOMETRY_HZ)));
        drive.corrected(&correction, &drive.edge(&[]))
    }),
    FrameWorld::healthy("stand-in, no drift", |drive| {
        drive.corrected(&drive.stand_in(), &poses_of(&drive.without_drift()))
    }),
    FrameWorld::healthy("no drift, AMCL", |drive| {
        drive.localized(&poses_of(&drive.without_drift()))
    }),
    FrameWorld {
        is_right: |drive| !drive.drifts(),
        ..FrameWorld::wrong("stand-in", (&[], &[DRIFTS]), |drive| {
            drive.corrected(&drive.stand_in(), &drive.edge(&[]))
        })
    },
    FrameWorld {
        is_right: |drive| !drive.drifts(),
        ..FrameWorld::wrong("stand-in, AMCL", (&[], &[DRIFTS]), |drive| {
            drive.localized(&drive.edge(&[]))
        })
    },
    // Lidars.
    FrameWorld::healthy("lidar", |drive| {
        let imu = Recording::default().imu("/livox/imu", "livox_imu", &drive.imu);
        imu.clouds("/livox/lidar", "livox_frame", 50)
    }),
    FrameWorld::wrong("lidar's frame", (&[], &["the frame of the cloud"]), |drive| {
        let imu = Recording::default().imu("/livox/imu", "livox_frame", &drive.imu);
        imu.clouds("/livox/lidar", "livox_frame", 50)
    }),
    // Drivers.
    FrameWorld::healthy("NovAtel", |drive| drive.of_driver("/novatel/oem7/imu", None)),
    FrameWorld::wrong("NovAtel zero north", DRIVER, |drive| {
        drive.of_driver("/novatel/oem7/imu", Some(Error::ZeroNorth))
    }),
    FrameWorld::wrong("NovAtel RFU", TURNED, |drive| {
        drive.of_driver("/novatel/oem7/imu", Some(Error::YForward))
    }),
    FrameWorld::healthy("Xsens", |drive| drive.of_driver("/xsens/imu", None)),
    FrameWorld::wrong("Xsens NWU", DRIVER, |drive| {
        drive.of_driver("/xsens/imu", Some(Error::ZeroNorth))
    }),
    FrameWorld::healthy("VectorNav", |drive| drive.of_driver("/vectornav/imu", None)),
    FrameWorld::wrong("VectorNav NED/FRD", NED, |drive| {
        drive.of_driver("/vectornav/imu", Some(Error::NedFrd))
    }),
    FrameWorld::wrong("VectorNav NED quat.", NED, |drive| {
        drive.of_driver("/vectornav/imu", Some(Error::NedOrientation))
    }),
    FrameWorld::wrong("VectorNav RFU", TURNED, |drive| {
        drive.of_driver("/vectornav/imu", Some(Error::YForward))
    }),
    FrameWorld::healthy("MAVROS", |drive| drive.of_driver("/mavros/imu/data", None)),
    // Simulators.
    FrameWorld::healthy("CARLA", |drive| {
        drive.simulated("/carla/ego_vehicle/odometry", &[], true)
    }),
    FrameWorld::wrong("CARLA left-handed", LEFT, |drive| {
        drive.simulated("/carla/ego_vehicle/odometry", &[Error::LeftHanded], true)
    }),
    FrameWorld::healthy("Unity, no fixes", |drive| drive.simulated("/unity/odom", &[], false)),
    FrameWorld::wrong("Unity left-handed", LEFT, |drive| {
        drive.simulated("/unity/odom", &[Error::LeftHanded], false)
    }),
];

/// What TREE16 says.
const DRIFTS: &str = "but the odometry drifts";

/// A setting of a driver.
const DRIVER: Names = (&["driver-setting"], &["a yaw that is zero in the north"]);

/// A body that is right, forward, up, which a driver's setting or a mounting gives.
const TURNED: Names = (
    &["driver-setting", "turned-mount", "z-90"],
    &["its y axis points forward", "whose y axis points forward", CONSTANT],
);

/// All of it, or the orientation alone, in NED and FRD.
const NED: Names = (
    &["ned-frd", "ned-orientation"],
    &[
        "all of its data are expressed in NED/FRD",
        "the orientation alone is expressed in NED/FRD",
    ],
);

/// What left-handed poses are called.
const LEFT: Names = (&["left-handed"], &[MIRRORED]);

/// A body forward, left, up from one right, down, forward (a camera's optical frame).
fn flu_from_rdf() -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0))
}

fn about_x(degrees: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::x_axis(), degrees.to_radians())
}

fn poses_of(rows: &[OdometryRow]) -> Vec<PoseRow> {
    rows.iter().map(|row| row.pose.clone()).collect()
}

/// The least that TREE16 takes for a drift: metres, and share of the way.
const DRIFT: [f64; 2] = [1.0, 0.01];

impl Messages {
    /// Odometry with errors.
    fn odom(&self, errors: &[Error]) -> Vec<OdometryRow> {
        let mut rows = self.odometry.clone();
        for row in &mut rows {
            for error in errors {
                row.apply(*error);
            }
        }
        rows
    }

    /// The poses of odometry with errors.
    fn edge(&self, errors: &[Error]) -> Vec<PoseRow> {
        poses_of(&self.odom(errors))
    }

    /// Poses by a localizer, at the rate of odometry.
    fn localised(&self, name: &str) -> Vec<PoseRow> {
        let times = self.drive.times(ODOMETRY_HZ);
        self.drive.pose_rows(&Stream::new(name, times))
    }

    /// IMU and receiver beside this odometry, on a base that is turned from FLU.
    fn with(&self, base_from_flu: Isometry3<f64>, odometry: &[OdometryRow]) -> Recording {
        Recording::default()
            .transform("base_link", "imu_link", &(base_from_flu * self.base_from_imu))
            .imu("/imu", "imu_link", &self.imu)
            .odometry("/odom", odometry)
            .fixes("/fix", "gps", &self.fixes, FIX_LATENCY_S)
    }

    /// All of it on a base that is turned, TF among it.
    fn on(&self, error: Error) -> Recording {
        let flu_from_base = match error {
            Error::Inverted => frd_from_flu(),
            Error::YForward => turn(-FRAC_PI_2),
            Error::Yaw90 => turn(FRAC_PI_2),
            Error::Backward => turn(2.0 * FRAC_PI_2),
            _ => panic!("{error:?} turns no base"),
        };
        let base_from_flu = Isometry3::from_parts(Vector3::zeros().into(), flu_from_base.inverse().into());
        self.with(base_from_flu, &self.odom(&[error]))
    }

    /// An IMU on a base that TF moves in a map.
    fn in_map(&self, map_from_enu: &Rotation3<f64>) -> Recording {
        let mut rows = self.localised("map");
        for row in &mut rows {
            row.change_world(map_from_enu);
        }
        Recording::default()
            .transform("base_link", "imu_link", &self.base_from_imu)
            .imu("/imu", "imu_link", &self.imu)
            .moving("map", "base_link", &rows)
            .fixes("/fix", "gps", &self.fixes, FIX_LATENCY_S)
    }

    /// Two estimates of the base: wheels, and one that knows roll and pitch, of a body that is turned.
    fn with_vio(&self, base_from_body: &Rotation3<f64>) -> Recording {
        let row = |pose: PoseRow| {
            let state = self.drive.at(pose.t_s);
            let linear = rotation(pose.orientation).inverse() * state.velocity;
            let mut row = OdometryRow {
                pose,
                linear: linear.into(),
                angular: state.rate.into(),
                twist_covariance: [0.0; 36],
            };
            row.change_body(base_from_body);
            row
        };
        let rows: Vec<OdometryRow> = self.localised("/vio").into_iter().map(row).collect();
        Recording::default().odometry("/odom", &self.odometry).odometry_of(
            "/vio/odom",
            ["vio_odom", "base_link"],
            &rows,
        )
    }

    /// Two localizers in frames of one name.
    fn two_maps(&self, other_from_map: &Rotation3<f64>) -> Recording {
        let mut rows = self.localised("/slam/pose");
        for row in &mut rows {
            row.change_world(other_from_map);
        }
        Recording::default()
            .poses("/mocap/pose", "map", &self.localised("/mocap/pose"))
            .poses("/slam/pose", "map", &rows)
    }

    /// A correction that is the identity.
    fn stand_in(&self) -> Vec<PoseRow> {
        let row = |row: &OdometryRow| PoseRow::new(row.pose.t_s, Isometry3::identity(), &[0.0; 36]);
        self.odometry.iter().map(row).collect()
    }

    /// TF with a correction, and fixes.
    fn corrected(&self, correction: &[PoseRow], odometry: &[PoseRow]) -> Recording {
        Recording::default()
            .moving("map", "odom", correction)
            .moving("odom", "base_link", odometry)
            .fixes("/fix", "gps", &self.fixes, FIX_LATENCY_S)
    }

    /// TF with a stand-in, and a localizer's poses.
    fn localized(&self, odometry: &[PoseRow]) -> Recording {
        Recording::default()
            .moving("map", "odom", &self.stand_in())
            .moving("odom", "base_link", odometry)
            .poses("/amcl_pose", "map", &self.localised("/amcl_pose"))
    }

    /// Odometry of this drive that does not drift.
    fn without_drift(&self) -> Vec<OdometryRow> {
        let drive = Drive::new(Description {
            odometry: Wheels::Perfect,
            ..self.drive.description
        });
        drive.odometry_rows(&Stream::new("/odom", drive.times(ODOMETRY_HZ)))
    }

    /// Whether odometry, laid over the truth by its first third, puts the middle of the last third farther off than
    /// [`DRIFT`].
    pub fn drifts(&self) -> bool {
        let points = self.odometry.iter().step_by(4).map(|row| {
            let true_place = self.drive.at(row.pose.t_s).position.xy();
            (Vector3::from(row.pose.position).xy(), true_place)
        });
        let points: Vec<(Vector2<f64>, Vector2<f64>)> = points.collect();
        let middle = |part: &[(Vector2<f64>, Vector2<f64>)]| {
            let sum = part.iter().fold((Vector2::zeros(), Vector2::zeros()), |sum, one| {
                (sum.0 + one.0, sum.1 + one.1)
            });
            (sum.0 / part.len() as f64, sum.1 / part.len() as f64)
        };
        let (first, last) = (&points[..points.len() / 3], &points[points.len() - points.len() / 3..]);
        let (from, to) = middle(first);
        let (sin, cos) = first.iter().fold((0.0, 0.0), |(sin, cos), (a, b)| {
            let (a, b) = (a - from, b - to);
            (sin + a.perp(&b), cos + a.dot(&b))
        });
        let (place, true_place) = middle(last);
        let by_m = (to + Rotation2::new(f64::atan2(sin, cos)) * (place - from) - true_place).norm();
        let way_m: f64 = points.windows(2).map(|pair| (pair[1].0 - pair[0].0).norm()).sum();
        by_m > DRIFT[0].max(DRIFT[1] * way_m)
    }

    /// An IMU of a driver, beside a receiver.
    fn of_driver(&self, topic: &str, error: Option<Error>) -> Recording {
        let gravity = self.drive.description.place.gravity();
        let mut rows: Vec<ImuRow> = self.imu.clone();
        for row in &mut rows {
            if let Some(error) = error {
                row.apply(error, gravity);
            }
        }
        Recording::default()
            .transform("base_link", "imu_link", &self.base_from_imu)
            .imu(topic, "imu_link", &rows)
            .fixes("/fix", "gps", &self.fixes, FIX_LATENCY_S)
    }

    /// Poses of a simulator, beside its gyro, and satellites or none.
    fn simulated(&self, topic: &str, errors: &[Error], has_fixes: bool) -> Recording {
        let made = Recording::default()
            .transform("base_link", "imu_link", &self.base_from_imu)
            .imu("/imu", "imu_link", &self.imu)
            .odometry(topic, &self.odom(errors));
        if has_fixes {
            made.fixes("/fix", "gps", &self.fixes, FIX_LATENCY_S)
        } else {
            made
        }
    }
}
