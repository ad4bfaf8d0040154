//! An inertial sensor: its rows, its mounting, and whether it has an orientation at all.

use std::sync::Arc;

use nalgebra::UnitQuaternion;

use crate::analysis::motion::mount::{Mount, carrier, mount};
use crate::analysis::{Estimates, motion::inertial::Inertial, motion::stream::Stream};
use crate::math::{readings::Reading, rotation::rpy_in_words};
use crate::tables::InsDriver;
use crate::world::{
    BagEvidence, FrameId, bag::TopicContent, content::ContentEvidence, content::CovarianceEvidence, motion::InertialRow,
};

/// An inertial sensor.
#[derive(Clone, Debug)]
pub(crate) struct Imu {
    /// Its measurements.
    pub(crate) stream: Stream<InertialRow>,
    /// Its mounting, by URDF and static TF; `None` if no rigid transforms tie its frame to a base.
    pub(crate) mount: Option<Mount>,
    /// Without a mounting: the frame on which a moving transform carries it.
    pub(crate) carrier: Option<FrameId>,
    /// Why it has no orientation.
    pub(crate) no_orientation: Option<&'static str>,
    /// Its measurements.
    pub(crate) inertial: Arc<Inertial>,
    /// The driver that publishes it, by the names around it.
    pub(crate) driver: Option<Arc<InsDriver>>,
}

impl Imu {
    /// The sensor of a topic, or of a member of its messages; `None` if it has no inertial data.
    pub(crate) fn of(world: &Estimates, bag: &BagEvidence, said: &TopicContent<'_>) -> Option<Self> {
        // In whose axes it measures is not known.
        if said.topic.is_frameless() {
            return None;
        }
        let stream = Stream::of(bag, said, said.content.motion.inertial.as_ref())?;
        let no_orientation = no_orientation(said.content);
        let mount = stream.frame.as_ref().and_then(|frame| mount(world, frame));
        let unmounted = stream.frame.as_ref().filter(|_| mount.is_none());
        let carrier = unmounted.and_then(|frame| carrier(world, frame));
        let stream = in_ros(world, stream, mount.as_ref());
        Some(Self {
            mount,
            carrier,
            inertial: Inertial::of(world, &stream, no_orientation.is_none()),
            no_orientation,
            driver: world.tables.ins_driver(&said.topic.words()),
            stream,
        })
    }

    /// `base_from_imu`, the identity if the mounting is unknown.
    pub(crate) fn base_from_imu(&self) -> UnitQuaternion<f64> {
        self.mount
            .as_ref()
            .map_or_else(UnitQuaternion::identity, |mount| mount.base_from_sensor.rotation)
    }

    /// The sensor's mounting on its base, as a clause for reports.
    pub(crate) fn mounting(&self) -> String {
        match (&self.mount, &self.stream.frame) {
            (Some(mount), _) if mount.is_base => format!(
                "the messages are expressed in `{}`, the base, so no mounting transform is applied",
                mount.base
            ),
            (Some(mount), Some(frame)) => {
                let rotation = &mount.base_from_sensor.rotation;
                format!("`{}` -> `{frame}` has {}", mount.base, rpy_in_words(rotation))
            }
            (_, Some(frame)) if self.carrier.is_some() => {
                format!("`{frame}` moves on the platform, so no transform is applied")
            }
            (_, Some(frame)) => format!("no transform connects `{frame}` with a base, so none is applied"),
            _ => "the messages name no frame, so no transform is applied".to_owned(),
        }
    }
}

/// The stream in the convention of ROS.
fn in_ros(world: &Estimates, stream: Stream<InertialRow>, mount: Option<&Mount>) -> Stream<InertialRow> {
    let said = stream.convention(world);
    let is_of_body_alone = said.is_of_body_alone();
    let expressed_in = said.without_turn_of(mount);
    if !is_of_body_alone {
        return stream.converted(expressed_in);
    }
    // The world of a body in FRD is not declared: gravity decides.
    let enu = stream.clone().converted(expressed_in.clone());
    let is_down = Inertial::of(world, &enu, true)
        .gravity
        .as_ref()
        .and_then(|gravity| Some(gravity.mean(Reading::Xyzw)?.mean_m_s2.z < 0.0));
    if is_down == Some(true) {
        stream.converted(expressed_in.with_ned())
    } else {
        enu
    }
}

/// Why a sensor has no orientation: it declares so, or never fills it in.
fn no_orientation(content: &ContentEvidence) -> Option<&'static str> {
    let imu = content.imu.as_ref()?;
    let covariance = content.covariances.get("orientation_covariance");
    if covariance.is_some_and(CovarianceEvidence::is_declared_absent) {
        Some("it declares that it has no orientation (orientation_covariance[0] is -1)")
    } else if imu.zero == imu.count {
        Some("it has no orientation (all zero)")
    } else if imu.same_as_first == imu.count {
        Some("it has no orientation (the same in every message)")
    } else {
        None
    }
}
