//! Mistakes of what moves: inertial sensors, poses, fixes, and the stamps of their messages.

use super::Fault;

/// The mistakes of each kind.
pub(super) fn tables() -> impl Iterator<Item = &'static [Fault]> {
    std::iter::empty()
}
