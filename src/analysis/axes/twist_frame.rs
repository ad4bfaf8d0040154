//! Whether velocities are expressed in the axes of the world.

use crate::analysis::motion::Stream;
use crate::world::motion::PoseRow;

/// A residual with y negated that is less than this part of that as defined is smaller by more than rounding: of a platform that
/// never goes aside the two are the same.
pub(crate) const SIDE_BETTER: f64 = 0.95;

pub(crate) fn has_twist(stream: &Stream<PoseRow>) -> bool {
    stream.rows().any(|timed| timed.row.twist.is_some())
}
