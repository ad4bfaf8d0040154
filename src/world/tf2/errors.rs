//! How tf2 refuses transforms and look-ups, with its own messages.

use std::fmt;

use crate::world::frame::FrameId;

/// Why tf2 drops a transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rejection {
    /// Parent and child are one frame (`TF_SELF_TRANSFORM`).
    SelfTransform,
    /// The child has no name (`TF_NO_CHILD_FRAME_ID`).
    NoChild,
    /// The parent has no name (`TF_NO_FRAME_ID`).
    NoParent,
    /// A number is NaN (`TF_NAN_INPUT`) or infinite.
    NotFinite,
    /// The quaternion is too far from unit length (`TF_DENORMALIZED_QUATERNION`).
    Denormalized {
        /// `|q|²`.
        norm_squared: f64,
    },
    /// The same transform exists already. ROS 1 drops every further transform with the stamp of another one
    /// (`TF_REPEATED_DATA`); ROS 2 only one that is equal in all its numbers.
    Repeated,
    /// Older than the newest sample by more than the cache is long (`TF_OLD_DATA`).
    Old,
}

impl Rejection {
    /// The word that tf2 logs.
    pub fn word(self) -> &'static str {
        match self {
            Self::SelfTransform => "TF_SELF_TRANSFORM",
            Self::NoChild => "TF_NO_CHILD_FRAME_ID",
            Self::NoParent => "TF_NO_FRAME_ID",
            Self::NotFinite => "TF_NAN_INPUT",
            Self::Denormalized { .. } => "TF_DENORMALIZED_QUATERNION",
            Self::Repeated => "TF_REPEATED_DATA",
            Self::Old => "TF_OLD_DATA",
        }
    }
}

/// A stamp outside of what a frame's history covers. Nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extrapolation {
    /// Before the earliest sample.
    Past {
        /// The requested stamp.
        requested_ns: i64,
        /// Stamp of the earliest sample.
        earliest_ns: i64,
    },
    /// After the latest sample.
    Future {
        /// The requested stamp.
        requested_ns: i64,
        /// Stamp of the latest sample.
        latest_ns: i64,
    },
    /// There is one sample only, of another stamp.
    Single {
        /// The requested stamp.
        requested_ns: i64,
        /// Stamp of the sample.
        only_ns: i64,
    },
}

impl Extrapolation {
    /// Whether the requested stamp is before the samples.
    pub fn is_past(self) -> bool {
        match self {
            Self::Past { .. } => true,
            Self::Future { .. } => false,
            Self::Single { requested_ns, only_ns } => requested_ns < only_ns,
        }
    }
}

/// Why a look-up has no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LookupError {
    /// A name that cannot be requested: empty, or with a leading slash.
    InvalidArgument {
        /// The name.
        frame: String,
        /// Whether it was the target's.
        is_target: bool,
    },
    /// No transform names this frame.
    Unknown {
        /// The name.
        frame: String,
        /// Whether it was the target's.
        is_target: bool,
    },
    /// The parents form a cycle, or are more than a thousand.
    Loop,
    /// The two frames are in different trees.
    NotConnected {
        /// The requested target.
        target: FrameId,
        /// The requested source.
        source: FrameId,
    },
    /// An edge on the way has no value at the stamp.
    Extrapolation {
        /// Child of that edge.
        child: FrameId,
        /// What is missing.
        what: Extrapolation,
        /// The requested target.
        target: FrameId,
        /// The requested source.
        source: FrameId,
    },
}

impl LookupError {
    /// Name of the exception in tf2.
    pub fn exception(&self) -> &'static str {
        match self {
            Self::InvalidArgument { .. } => "InvalidArgumentException",
            Self::Unknown { .. } | Self::Loop => "LookupException",
            Self::NotConnected { .. } => "ConnectivityException",
            Self::Extrapolation { .. } => "ExtrapolationException",
        }
    }
}

/// Seconds with nine digits, as tf2 prints them, but exact.
fn seconds(ns: i64) -> String {
    let sign = if ns < 0 { "-" } else { "" };
    let ns = ns.unsigned_abs();
    format!("{sign}{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000)
}

fn argument(is_target: bool) -> &'static str {
    if is_target { "target_frame" } else { "source_frame" }
}

impl fmt::Display for Extrapolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Past {
                requested_ns,
                earliest_ns,
            } => write!(
                f,
                "Lookup would require extrapolation into the past.  Requested time {} but the earliest data is at time {}",
                seconds(requested_ns),
                seconds(earliest_ns)
            ),
            Self::Future {
                requested_ns,
                latest_ns,
            } => write!(
                f,
                "Lookup would require extrapolation into the future.  Requested time {} but the latest data is at time {}",
                seconds(requested_ns),
                seconds(latest_ns)
            ),
            Self::Single { requested_ns, only_ns } => write!(
                f,
                "Lookup would require extrapolation at time {}, but only time {} is in the buffer",
                seconds(requested_ns),
                seconds(only_ns)
            ),
        }
    }
}

/// The message of the exception.
impl fmt::Display for LookupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidArgument { frame, is_target } => {
                let why = if frame.is_empty() {
                    "in tf2 frame_ids cannot be empty"
                } else {
                    "in tf2 frame_ids cannot start with a '/'"
                };
                let argument = argument(*is_target);
                write!(
                    f,
                    "Invalid argument \"{frame}\" passed to lookupTransform argument {argument} - {why}"
                )
            }
            Self::Unknown { frame, is_target } => write!(
                f,
                "\"{frame}\" passed to lookupTransform argument {} does not exist.",
                argument(*is_target)
            ),
            Self::Loop => f.write_str("The tf tree is invalid because it contains a loop."),
            Self::NotConnected { target, source } => write!(
                f,
                "Could not find a connection between '{target}' and '{source}' because they are not part of the same \
                 tree. Tf has two or more unconnected trees."
            ),
            Self::Extrapolation {
                what, target, source, ..
            } => write!(
                f,
                "{what}, when looking up transform from frame [{source}] to frame [{target}]"
            ),
        }
    }
}

impl std::error::Error for LookupError {}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

impl std::error::Error for Rejection {}
