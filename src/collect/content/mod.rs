//! The content of the messages of one topic beyond their header, while it is being collected.

mod camera;
pub(super) mod cloud;
mod covariance;
mod fixes;
mod grid;
mod imu;
mod laser;
pub(super) mod motion;
mod odometry;
mod path;
pub(super) mod poses;
mod radar;
mod runs;
mod slices;
pub(super) mod steps;
pub(super) mod times;

use std::collections::BTreeMap;

use crate::read::messages::content::{Body, Fix, Imu, Odometry, Pose, Twist};
use crate::read::messages::radar::Columns;
use crate::world::content::{ContentEvidence, CovarianceEvidence};

use super::CloudOptions;
use super::point::{Point, PointOwner};
use super::series::RowBudget;
use super::thin::SampleBudget;
use camera::{Calibrations, Images};
use cloud::{Clouds, PacketCounts};
use covariance::Covariances;
use fixes::Fixes;
use grid::Grids;
use imu::Inertial;
use laser::Lasers;
use motion::Motion;
use odometry::Odometries;
use radar::Radars;

/// Poses and twists have six degrees of freedom, positions and vectors three.
type SixDof = Covariances<6, 36>;
type ThreeDof = Covariances<3, 9>;

/// The content of one topic; nothing is allocated for the rest.
pub(super) struct Contents {
    share: SampleBudget,
    of_clouds: CloudOptions,
    fixes: Option<Box<Fixes>>,
    imu: Option<Box<Inertial>>,
    odometry: Option<Box<Odometries>>,
    six: BTreeMap<&'static str, Box<SixDof>>,
    three: BTreeMap<&'static str, Box<ThreeDof>>,
    calibrations: Option<Box<Calibrations>>,
    images: Option<Box<Images>>,
    clouds: Option<Box<Clouds>>,
    grids: Option<Box<Grids>>,
    lasers: Option<Box<Lasers>>,
    radar: Option<Box<Radars>>,
    motion: Motion,
}

impl Contents {
    pub(super) fn new(share: SampleBudget, room: RowBudget, of_clouds: CloudOptions) -> Self {
        Self {
            share,
            of_clouds,
            fixes: None,
            imu: None,
            odometry: None,
            six: BTreeMap::new(),
            three: BTreeMap::new(),
            calibrations: None,
            images: None,
            clouds: None,
            grids: None,
            lasers: None,
            radar: None,
            motion: Motion::new(room),
        }
    }

    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        if let Some(imu) = &mut self.imu {
            imu.seam();
        }
        if let Some(odometry) = &mut self.odometry {
            odometry.seam();
        }
        if let Some(clouds) = &mut self.clouds {
            clouds.seam();
        }
        if let Some(lasers) = &mut self.lasers {
            lasers.seam();
        }
        if let Some(radar) = &mut self.radar {
            radar.seam();
        }
        self.motion.seam();
    }

    /// Takes in the content of a message, or of a member of it.
    pub(super) fn body(&mut self, point: Point, body: &Body<'_>) {
        match body {
            Body::Odometry(odometry) => self.odometry(point, odometry),
            Body::Imu(imu) => self.imu(point, imu),
            Body::Fix(fix) => self.fix(point, fix),
            Body::Nmea(nmea) => self.motion.nmea(point, nmea),
            Body::Pose(pose) => self.pose(point, pose),
            Body::Path(poses) => self.motion.path(point, poses),
            Body::Orientation(orientation) => self.motion.orientation(point, *orientation),
            Body::Vector(vector) => self.motion.vector(point, *vector),
            Body::Twist(twist) => self.twist(point, twist),
            Body::CameraInfo(info) => self
                .calibrations
                .get_or_insert_with(|| Box::new(Calibrations::new()))
                .push(point, info),
            Body::Image(image) => self
                .images
                .get_or_insert_with(|| Box::new(Images::new()))
                .push(point, image),
            Body::Cloud(cloud) => {
                let share = self.share;
                self.clouds
                    .get_or_insert_with(|| Box::new(Clouds::new(share, self.of_clouds.clone())))
                    .push(point, cloud);
                if let Some(columns) = Columns::of(cloud) {
                    self.radar(point).cloud(point, cloud, &columns);
                }
            }
            Body::Packets(scan) if scan.packets() == 0 => {}
            Body::Packets(scan) => {
                let share = self.share;
                self.clouds
                    .get_or_insert_with(|| Box::new(Clouds::new(share, self.of_clouds.clone())))
                    .push_packets(point, scan);
            }
            Body::Grid(grid) => self
                .grids
                .get_or_insert_with(|| Box::new(Grids::new()))
                .push(point, grid),
            Body::LaserScan(scan) => {
                let share = self.share;
                self.lasers
                    .get_or_insert_with(|| Box::new(Lasers::new(share, point)))
                    .push(point, scan);
            }
            Body::Radar(radar) => self.radar(point).push(point, radar),
            Body::Nothing
            | Body::ChildFrame(_)
            | Body::Transforms(_)
            | Body::Description(_)
            | Body::Metadata(_)
            | Body::Frames(_)
            | Body::Packet(_)
            | Body::Clock(_) => {}
        }
    }

    /// The packets that were to be decoded, if some of them were not.
    pub(super) fn refused_packets(&self) -> Option<&PacketCounts> {
        let packets = &self.clouds.as_ref()?.packets;
        (packets.refused > 0).then_some(packets)
    }

    fn radar(&mut self, point: Point) -> &mut Radars {
        let share = self.share;
        self.radar.get_or_insert_with(|| Box::new(Radars::new(share, point)))
    }

    fn odometry(&mut self, point: Point, odometry: &Odometry<'_>) {
        let share = self.share;
        self.odometry
            .get_or_insert_with(|| Box::new(Odometries::new(share)))
            .push(point, odometry);
        self.motion.odometry(point, odometry);
        self.six("pose.covariance", point, &odometry.pose_covariance);
        self.six("twist.covariance", point, &odometry.twist_covariance);
    }

    fn imu(&mut self, point: Point, imu: &Imu) {
        self.imu.get_or_insert_default().push(point, imu);
        self.motion.imu(point, imu);
        self.three("orientation_covariance", point, &imu.orientation_covariance);
        self.three("angular_velocity_covariance", point, &imu.angular_velocity_covariance);
        self.three(
            "linear_acceleration_covariance",
            point,
            &imu.linear_acceleration_covariance,
        );
    }

    fn fix(&mut self, point: Point, fix: &Fix) {
        let share = self.share;
        self.fixes
            .get_or_insert_with(|| Box::new(Fixes::new(share)))
            .push(point, fix);
        self.motion.fix(point, fix);
        self.three("position_covariance", point, &fix.covariance);
    }

    fn pose(&mut self, point: Point, pose: &Pose) {
        self.motion.pose(point, pose.position, pose.orientation);
        if let Some(covariance) = &pose.covariance {
            self.six("pose.covariance", point, covariance);
        }
    }

    fn twist(&mut self, point: Point, twist: &Twist) {
        self.motion.twist(point, twist);
        if let Some(covariance) = &twist.covariance {
            self.six("twist.covariance", point, covariance);
        }
    }

    fn six(&mut self, field: &'static str, point: Point, values: &[f64; 36]) {
        let share = self.share;
        self.six
            .entry(field)
            .or_insert_with(|| Box::new(Covariances::new(share, false)))
            .push(point, values);
    }

    fn three(&mut self, field: &'static str, point: Point, values: &[f64; 9]) {
        let share = self.share;
        self.three
            .entry(field)
            .or_insert_with(|| Box::new(Covariances::new(share, field != "position_covariance")))
            .push(point, values);
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> ContentEvidence {
        let six = self
            .six
            .into_iter()
            .map(|(field, matrices)| (field, matrices.finish(on)));
        let three = self
            .three
            .into_iter()
            .map(|(field, matrices)| (field, matrices.finish(on)));
        let covariances: BTreeMap<String, CovarianceEvidence> = six
            .chain(three)
            .map(|(field, evidence)| (field.to_owned(), evidence))
            .collect();
        ContentEvidence {
            fixes: self.fixes.map(|fixes| fixes.finish(on)),
            covariances,
            imu: self.imu.map(|imu| imu.finish(on)),
            odometry: self.odometry.map(|odometry| odometry.finish(on)),
            calibrations: self.calibrations.map(|calibrations| calibrations.finish(on)),
            images: self.images.map(|images| images.finish(on)),
            clouds: self.clouds.map(|clouds| clouds.finish(on)),
            grids: self.grids.map(|grids| grids.finish(on)),
            lasers: self.lasers.map(|lasers| Box::new(lasers.finish(on))),
            radar: self.radar.and_then(|radar| radar.finish(on).map(Box::new)),
            motion: self.motion.finish(),
        }
    }
}
