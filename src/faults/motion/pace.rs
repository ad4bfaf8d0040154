//! How fast a platform moves, by its poses.

use crate::world::World;
use crate::world::motion::PoseRow;

use super::streams::{MovingFrame, Stream};
use super::turns::{distance, rotation};

/// Poses are compared over at least this long: noise of each would look like speed, nanoseconds.
const STEP_NS: i64 = 1_000_000_000;

/// Speed, m/s, and turn rate, rad/s, that a platform exceeds for a twentieth of the time; the largest of its streams. `None`: no poses.
pub fn pace(world: &World) -> Option<[f64; 2]> {
    let streams = Stream::all(world).filter(|stream| stream.moving != MovingFrame::World);
    let paces = streams.filter_map(|stream| of_sections(stream.pose_sections(world)));
    paces.reduce(|[speed, turn], [other_speed, other_turn]| [speed.max(other_speed), turn.max(other_turn)])
}

fn of_sections<'w>(sections: impl Iterator<Item = &'w [PoseRow]>) -> Option<[f64; 2]> {
    let (mut speeds, mut turns) = (Vec::new(), Vec::new());
    for rows in sections {
        let mut before: Option<&PoseRow> = None;
        for row in rows {
            let Some(from) = before else {
                before = Some(row);
                continue;
            };
            let step_ns = row.log_ns - from.log_ns;
            if step_ns < STEP_NS {
                continue;
            }
            let step_s = step_ns as f64 / 1e9;
            speeds.push(distance(from.position, row.position) / step_s);
            turns.push(rotation(from.orientation).angle_to(&rotation(row.orientation)) / step_s);
            before = Some(row);
        }
    }
    Some([large(speeds)?, large(turns)?])
}

/// The value that a twentieth exceeds.
fn large(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    values.get(values.len() * 19 / 20).copied()
}
