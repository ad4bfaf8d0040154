//! Which robot a file belongs to, where neither folder nor names show it: the one with the same transforms.

use std::cmp::Reverse;

use crate::math::relation::{Relation, Tolerance, classify};
use crate::world::{Claim, World};

/// Rounding of printed digits: metres, and radians.
const EXACT_M: f64 = 1e-3;
const EXACT_RAD: f64 = 1e-3;

/// How many transforms of a file a robot has. Of two, the greater one fits better.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Fit {
    /// To the digits that files are written with.
    exact: usize,
    /// Within the difference of a calibration and a drawing.
    same: usize,
    inverse: usize,
    /// Between two of its frames, and neither.
    others: Reverse<usize>,
}

impl Fit {
    /// Compares the claims of a file with the joints of a robot, both as `target_from_source`.
    pub(crate) fn new<'c>(robot: &World, claims: impl IntoIterator<Item = &'c Claim>) -> Self {
        let mut fit = Self::default();
        for claim in claims.into_iter().filter(|one| one.has_rotation && one.has_translation) {
            let (Some((target, source)), Some(pose)) = (&claim.frames, &claim.pose) else {
                continue;
            };
            let chain = robot
                .graph()
                .chain(&target.canonical(), &source.canonical(), |edge| edge.is_rigid);
            let Some((known, _)) = chain else { continue };
            let found = classify(&known, &pose.isometry(), &Tolerance::default());
            match found.best {
                Some(Relation::Equal) => {
                    fit.same += 1;
                    fit.exact += usize::from(found.distance_m <= EXACT_M && found.angle_rad <= EXACT_RAD);
                }
                Some(Relation::Inverse) => fit.inverse += 1,
                _ => fit.others.0 += 1,
            }
        }
        fit
    }

    /// Whether any transform is the robot's.
    pub(crate) fn is_any(self) -> bool {
        self.same + self.inverse > 0
    }
}
