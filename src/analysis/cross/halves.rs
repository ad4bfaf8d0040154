//! Rotations and translations that a source states separately.

use crate::analysis::cross::pair::Statement;
use crate::math::rotation;

/// Joins a rotation and a translation that a source states separately for one pair of frames; one of them may be in the other direction.
pub(crate) fn join_halves(statements: &mut Vec<Statement>) {
    let mut index = 0;
    while let Some(turn) = statements.get(index) {
        if !turn.has_rotation || turn.has_translation {
            index += 1;
            continue;
        }
        let is_other_half = |other: &Statement| {
            let same = other.target == turn.target && other.source_frame == turn.source_frame;
            let turned = other.target == turn.source_frame && other.source_frame == turn.target;
            let is_shift = other.has_translation && !other.has_rotation;
            is_shift && (same || turned) && other.place.source == turn.place.source
        };
        let Some(at) = statements.iter().position(is_other_half) else {
            index += 1;
            continue;
        };
        let shift = statements.remove(at);
        if at < index {
            index -= 1;
        }
        let Some(turn) = statements.get_mut(index) else { return };
        let is_inverse = shift.target != turn.target;
        turn.pose = rotation::pose_of_halves(turn.pose.rotation, shift.pose.translation, is_inverse);
        turn.has_translation = true;
        turn.reading = turn.reading.min(shift.reading);
        turn.who = format!("{} with {}", turn.who, shift.who);
        index += 1;
    }
}
