//! Whether velocities are expressed in the axes of the world.

use crate::analysis::motion::Stream;
use crate::world::motion::PoseRow;

/// A residual with y negated below this part of the one as defined is smaller by more than rounding; without sideways motion the two
/// are the same.
pub(crate) const SIDE_BETTER: f64 = 0.95;

pub(crate) fn has_twist(stream: &Stream<PoseRow>) -> bool {
    stream.rows().any(|timed| timed.row.twist.is_some())
}
