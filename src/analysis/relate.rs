//! The difference of two transforms: numbers, words, and the convention error that explains it.
//!
//! Must not know where the transforms come from.

use nalgebra::Isometry3;

use crate::math::relation::{Tolerance, classify_either_way};
use crate::verdict::Measured;

/// Limits within which two transforms are equal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseTolerance {
    /// Rotation, degrees.
    pub(crate) deg: f64,
    /// Translation, metres.
    pub(crate) m: f64,
}

/// A difference of two transforms.
#[derive(Clone, Debug)]
pub(crate) struct Difference {
    /// The word of the relation, where one explains the difference.
    pub(crate) relation: Option<&'static str>,
    /// The difference for the end of a sentence, beginning with a comma.
    pub(crate) words: String,
    /// Rotation and translation.
    pub(crate) measured: Vec<Measured>,
}

impl Difference {
    /// Compares two `parent_from_child` of one pair of frames; either may be wrong.
    pub(crate) fn between(a: &Isometry3<f64>, b: &Isometry3<f64>, same: PoseTolerance) -> Self {
        let difference = classify_either_way(a, b, &Tolerance::default()).classification;
        let (deg, m) = (difference.angle_rad.to_degrees(), difference.distance_m);
        let is_same = deg <= same.deg && m <= same.m;
        let relation = difference.error().filter(|_| !is_same);
        let rotation = Measured::new("difference in rotation", deg, "deg").limit(same.deg);
        let measured = vec![
            // Another convention is no error by an angle.
            if relation.is_some() { rotation } else { rotation.turn() },
            Measured::new("difference in translation", m, "m").limit(same.m),
        ];
        // Relations that these numbers can't distinguish are named too, as in CROSS02.
        let also: Vec<&str> = difference.class.iter().skip(1).map(|other| other.word()).collect();
        let words = match relation {
            _ if is_same => ", with the same numbers".to_owned(),
            Some(relation) if also.is_empty() => {
                format!(", {deg:.2} deg and {m:.3} m apart ({})", relation.word())
            }
            Some(relation) => format!(
                ", {deg:.2} deg and {m:.3} m apart ({}; indistinguishable here: {})",
                relation.word(),
                also.join(", ")
            ),
            None => format!(", {deg:.2} deg and {m:.3} m apart"),
        };
        Self {
            relation: relation.map(crate::math::relation::Relation::word),
            words,
            measured,
        }
    }
}
