//! What several sources state of the same pair of frames.

pub(crate) mod aliases;
pub(crate) mod angles;
pub(crate) mod blame;
pub(crate) mod common_motion;
pub(crate) mod direction;
pub(crate) mod exact;
pub(crate) mod exchange;
pub(crate) mod fit;
pub(crate) mod fold;
pub(crate) mod halves;
pub(crate) mod hand_eye;
pub(crate) mod notation;
pub(crate) mod pair;
pub(crate) mod roles;
pub(crate) mod statements;
