//! Frame names and where they are used.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::source::Place;

/// A name of a coordinate system, exactly as it was spelled.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FrameId(String);

impl FrameId {
    /// A frame name as spelled in its source.
    pub fn new(spelled: impl Into<String>) -> Self {
        Self(spelled.into())
    }

    /// The name as spelled.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The name as tf2 stores it: one leading slash is stripped (`stripSlash` in tf2's buffer_core.cpp).
    #[must_use]
    pub fn canonical(&self) -> Self {
        Self(self.0.strip_prefix('/').unwrap_or(&self.0).to_owned())
    }

    /// Lower-case words of the name, split at `_`, `/`, `-`, `.`, whitespace and where a lower-case letter meets an
    /// upper-case one. Conventions are looked for in tokens, never in substrings: `odom_combined` has no token `ned`.
    pub fn tokens(&self) -> Vec<String> {
        self.words().map(|word| lower(word).collect()).collect()
    }

    /// Whether one of the tokens is `word` (lower case).
    pub fn has_token(&self, word: &str) -> bool {
        self.words().any(|own| lower(own).eq(word.chars()))
    }

    /// The tokens as spelled.
    fn words(&self) -> impl Iterator<Item = &str> {
        let parts = self.0.split(|c: char| !c.is_alphanumeric());
        parts.flat_map(|part| {
            let mut rest = part;
            std::iter::from_fn(move || {
                let mut before = false;
                let next = rest.char_indices().find(|(_, c)| {
                    let is_boundary = before && c.is_uppercase();
                    before = c.is_lowercase() || c.is_ascii_digit();
                    is_boundary
                });
                let word;
                (word, rest) = rest.split_at(next.map_or(rest.len(), |(at, _)| at));
                (!word.is_empty()).then_some(word)
            })
        })
    }
}

fn lower(word: &str) -> impl Iterator<Item = char> {
    word.chars().flat_map(char::to_lowercase)
}

impl fmt::Display for FrameId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<&str> for FrameId {
    fn from(spelled: &str) -> Self {
        Self::new(spelled)
    }
}

/// The role in which a frame is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FrameRole {
    /// A link is defined under this name.
    Link,
    /// A joint refers to this name as its parent.
    JointParent,
    /// A joint refers to this name as its child.
    JointChild,
    /// A simulator element (`<gazebo reference>`, `<sensor>` frame) refers to this name.
    Simulator,
    /// Parent (`header.frame_id`) of a TF edge.
    TfParent,
    /// Child (`child_frame_id`) of a TF edge.
    TfChild,
    /// `header.frame_id` of a message that is not TF.
    Header,
    /// `child_frame_id` of an odometry message.
    OdometryChild,
    /// Named by a calibration or configuration file through explicit parent and child keys, or by nesting.
    Calibration,
    /// Read out of the name of a key (`T_cam_imu`): a label, not necessarily a TF frame.
    CalibrationLabel,
}

impl FrameRole {
    /// The role, for messages ("link", "`child_frame_id` on TF", ...).
    pub fn words(self) -> &'static str {
        match self {
            Self::Link => "link",
            Self::JointParent => "joint parent",
            Self::JointChild => "joint child",
            Self::Simulator => "simulator reference",
            Self::TfParent => "TF parent",
            Self::TfChild => "TF child",
            Self::Header => "message header",
            Self::OdometryChild => "odometry child",
            Self::Calibration => "named in a file",
            Self::CalibrationLabel => "calibration key",
        }
    }

    /// Whether the role makes the frame part of the TF or URDF tree.
    pub fn in_tree(self) -> bool {
        matches!(
            self,
            Self::Link | Self::JointParent | Self::JointChild | Self::TfParent | Self::TfChild
        )
    }
}

/// One use of a frame name: recorded once for each name, role, source and topic, at its first place.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FrameUse {
    /// The name as spelled.
    pub frame: FrameId,
    /// The role.
    pub role: FrameRole,
    /// First place.
    pub place: Place,
    /// How often it occurs there (messages, or 1).
    pub count: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_split_into_tokens() {
        let tokens = |s: &str| FrameId::new(s).tokens().join(" ");
        assert_eq!(tokens("odom_combined"), "odom combined");
        assert_eq!(tokens("/base_link_NED"), "base link ned");
        assert_eq!(tokens("cameraOpticalFrame"), "camera optical frame");
        assert_eq!(tokens("cam0-optical.frame"), "cam0 optical frame");
        assert!(!FrameId::new("odom_combined").has_token("ned"));
        assert!(FrameId::new("imu_link_ned").has_token("ned"));
    }

    #[test]
    fn tf2_strips_one_leading_slash() {
        assert_eq!(FrameId::new("/map").canonical().as_str(), "map");
        assert_eq!(FrameId::new("//map").canonical().as_str(), "/map");
    }
}
