//! What launch files and scripts pass to programs: static transforms, and the settings of localisation nodes.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::source::{Place, SourceValue};

/// The program with which launch files and scripts publish static transforms; the dialect of its claims.
pub const PROGRAM: &str = "static_transform_publisher";

/// How the arguments of a static transform publisher are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ArgumentForm {
    /// x y z yaw pitch roll parent child.
    Angles,
    /// x y z qx qy qz qw parent child.
    Quaternion,
    /// `--x 1 --yaw 1.57 --frame-id parent --child-frame-id child`.
    Flags,
}

/// Why the transform of a call is not known.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReadObstacle {
    /// An argument that is known only at run time.
    Open(String),
    /// The transform is on the parameter server, under this name.
    Parameter(String),
    /// The program itself would refuse it, or read something else; the reason.
    Misread(String),
}

/// A call of `static_transform_publisher`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StaticPublisher {
    /// The name of the call in its file; the label of its claim.
    pub label: String,
    /// The package of the program (`tf`, `tf2_ros`), if it is stated.
    pub package: Option<String>,
    /// Whether the file is of ROS 1 or of ROS 2, if that is known.
    pub is_ros2: Option<bool>,
    /// How the arguments are written; `None` if they match no form.
    pub form: Option<ArgumentForm>,
    /// How many arguments there are, without those of ROS itself.
    pub arguments: u32,
    /// Whether a number follows the frames: the period of `tf`, in milliseconds.
    pub has_period: bool,
    /// The arguments.
    pub place: Place,
    /// Why the transform is not known, if it is not.
    pub unread: Option<ReadObstacle>,
}

/// The settings of one node of `robot_localization`, or of one controller of ros_control.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LocalizationSettings {
    /// The name of the node in its file.
    pub node: String,
    /// Its settings as written; the items of a list separated by spaces.
    pub values: BTreeMap<String, SourceValue<String>>,
}

impl LocalizationSettings {
    /// A setting that is one number.
    pub fn number(&self, key: &str) -> Option<(f64, &Place)> {
        let value = self.values.get(key)?;
        Some((value.value.parse().ok()?, &value.place))
    }

    /// A setting that is a switch.
    pub fn switch(&self, key: &str) -> Option<bool> {
        self.values.get(key)?.value.to_lowercase().parse().ok()
    }

    /// A setting that is a text.
    pub fn text(&self, key: &str) -> Option<&SourceValue<String>> {
        self.values.get(key).filter(|value| !value.value.is_empty())
    }
}
