//! The inputs that a rule may require.

use crate::world::{Claim, ClaimKind, World};

/// An input that a rule needs before it can judge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// A URDF, from a file or from a bag.
    Robot,
    /// A recording with TF.
    Tf,
    /// A URDF, or a recording with TF.
    RobotOrTf,
    /// A URDF, a recording with TF, or a launch file that publishes transforms.
    RobotTfOrLaunch,
    /// Any stated transform: URDF, file or TF.
    Transforms,
    /// Any stated transform, or a recording.
    TransformsOrBag,
    /// A calibration file with transforms, or a recording.
    CalibrationOrBag,
    /// A matrix in a file.
    Matrices,
    /// A calibration file with transforms.
    Calibration,
    /// A recording, or a file of camera_info_manager.
    CameraInfo,
    /// A calibration of the beams of a lidar.
    Beams,
    /// A recording.
    Bag,
    /// A file of points.
    Points,
    /// A recording, or a file of points.
    BagOrPoints,
    /// Any named frame.
    Frames,
}

impl Need {
    /// Whether the world has it.
    pub fn is_met(self, world: &World) -> bool {
        let has_file = |claim: &Claim| matches!(claim.kind, ClaimKind::File { .. });
        let tf = || world.bags.iter().any(|bag| !bag.tf.is_empty());
        match self {
            Self::Robot => !world.robots.is_empty(),
            Self::Tf => tf(),
            Self::RobotOrTf => !world.robots.is_empty() || tf(),
            Self::RobotTfOrLaunch => !world.robots.is_empty() || tf() || world.claims.iter().any(Claim::is_published),
            Self::Transforms => !world.claims.is_empty() || tf(),
            Self::Matrices => world.claims.iter().any(|claim| claim.matrix().is_some()),
            Self::TransformsOrBag => !world.claims.is_empty() || !world.bags.is_empty(),
            Self::CalibrationOrBag => !world.bags.is_empty() || world.claims.iter().any(has_file),
            Self::Calibration => world.claims.iter().any(has_file),
            Self::CameraInfo => !world.bags.is_empty() || !world.cameras.is_empty(),
            Self::Beams => !world.beams.is_empty(),
            Self::Bag => !world.bags.is_empty(),
            Self::Points => !world.point_files.is_empty(),
            Self::BagOrPoints => !world.bags.is_empty() || !world.point_files.is_empty(),
            Self::Frames => !world.frames.is_empty(),
        }
    }

    /// Whether recordings can meet it.
    pub fn is_of_bags(self) -> bool {
        matches!(
            self,
            Self::Tf
                | Self::RobotOrTf
                | Self::RobotTfOrLaunch
                | Self::Transforms
                | Self::TransformsOrBag
                | Self::CalibrationOrBag
                | Self::CameraInfo
                | Self::Bag
                | Self::BagOrPoints
        )
    }

    /// What is missing, in words. They begin with `no `: reports count the inputs that would help most by the words between it and
    /// the colon.
    pub fn missing(self) -> &'static str {
        match self {
            Self::Robot => "no URDF: needs a file or /robot_description",
            Self::Tf => "no recording with TF: needs /tf and /tf_static",
            Self::RobotOrTf => "no URDF and no recording with TF: needs one of them",
            Self::RobotTfOrLaunch => {
                "no URDF, no recording with TF, and no launch file that publishes transforms: needs one of them"
            }
            Self::Transforms => "no transforms: needs a URDF, a calibration file or TF",
            Self::TransformsOrBag => "no transforms and no recording: needs one of them",
            Self::CalibrationOrBag => "no calibration file with transforms and no recording: needs one of them",
            Self::Matrices => "no file with a matrix: needs a calibration file",
            Self::Calibration => "no calibration file with transforms: needs one",
            Self::CameraInfo => "no recording and no camera_info file: needs one of them",
            Self::Beams => "no calibration of a lidar's beams: needs a file of velodyne_pointcloud or of Hesai",
            Self::Bag => "no recording: needs an MCAP, rosbag2 or ROS 1 bag",
            Self::Points => "no point cloud file: needs a PCD, PLY, LAS or LAZ",
            Self::BagOrPoints => "no recording and no point cloud file: needs one of them",
            Self::Frames => "no frame names: needs a URDF, a calibration file or a recording",
        }
    }
}
