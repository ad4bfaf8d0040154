//! Direction of the acceleration, rotated into the world by the orientation.

use serde::Deserialize;

use crate::analysis::{axes::causes::World, look::Estimate, motion::Imu};
use crate::math::{gravity::WorldForce, readings::Reading};
use crate::verdict::NotEvaluated;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_s: f64,
    pub(crate) min_rows: usize,
    pub(crate) min_concentration: f64,
    pub(crate) max_tilt_deg: f64,
    pub(crate) steady_concentration: f64,
    pub(crate) tilted: f64,
    pub(crate) leaning_deg: f64,
    pub(crate) far_deg: f64,
    pub(crate) far_concentration: f64,
    pub(crate) gravity: f64,
    pub(crate) gravity_share: f64,
}

/// The direction of gravity in the axes of the world.
pub(crate) struct WorldUp {
    pub(crate) class: World,
    pub(crate) force: WorldForce,
    /// The same in the other quaternion conventions.
    pub(crate) others: Vec<WorldForce>,
    pub(crate) seconds: f64,
    pub(crate) rows: usize,
}

impl WorldUp {
    /// The one other quaternion convention in which the acceleration points up. For a level body, a rotation and its inverse are
    /// equally good.
    pub(crate) fn read_otherwise(&self, limits: &Limits) -> Option<Reading> {
        let is_up = |mean: &&WorldForce| {
            mean.concentration >= limits.min_concentration && mean.from_up_rad.to_degrees() <= limits.max_tilt_deg
        };
        let up: Vec<Reading> = self.others.iter().filter(is_up).map(|mean| mean.reading).collect();
        match up.as_slice() {
            [one] | [one @ Reading::Wxyz, Reading::WxyzConjugate] => Some(*one),
            _ => None,
        }
    }

    /// Angle between the acceleration and the world's up, radians; or why there is none.
    pub(crate) fn off_up_rad(&self) -> Estimate<f64> {
        match self.class {
            World::Far => {
                let why = "the acceleration has no steady direction in the world".to_owned();
                Err((NotEvaluated::TooLittleEvidence, why))
            }
            _ => Ok(self.force.from_up_rad),
        }
    }

    /// The class that a diagnosis uses.
    pub(crate) fn sign(&self) -> Option<World> {
        match self.class {
            World::Far => None,
            World::Leaning => Some(World::Up),
            class => Some(class),
        }
    }
}

/// Direction of the acceleration in the world.
pub(crate) fn look(imu: &Imu, limits: &Limits) -> Estimate<WorldUp> {
    if let Some(why) = imu.no_orientation {
        return Err((NotEvaluated::NotApplicable, why.to_owned()));
    }
    let little = |reason: String| Err((NotEvaluated::TooLittleEvidence, reason));
    let Some(gravity) = &imu.inertial.gravity else {
        return Err((
            NotEvaluated::NotApplicable,
            "its messages hold no acceleration (all zero)".to_owned(),
        ));
    };
    let Some(force) = gravity.mean(Reading::Xyzw).copied() else {
        return little("no orientation is a valid quaternion".to_owned());
    };
    if gravity.covered_s < limits.min_s || gravity.rows < limits.min_rows {
        return little(format!(
            "only {:.1} s and {} samples of orientation with acceleration, {} s and {} are needed",
            gravity.covered_s, gravity.rows, limits.min_s, limits.min_rows
        ));
    }
    let near = |unit: f64| (gravity.norm_m_s2 / unit - 1.0).abs() <= limits.gravity_share;
    if !near(limits.gravity) && !near(1.0) {
        return little(format!(
            "the magnitude of the acceleration is {:.2} as published, which is not gravity",
            gravity.norm_m_s2
        ));
    }
    let degrees = force.from_up_rad.to_degrees();
    let class = if force.concentration >= limits.min_concentration && degrees <= limits.max_tilt_deg {
        World::Up
    } else if force.concentration >= limits.min_concentration && degrees >= 180.0 - limits.max_tilt_deg {
        World::Down
    } else if force.concentration >= limits.steady_concentration && degrees > limits.tilted * limits.max_tilt_deg {
        if degrees <= limits.leaning_deg {
            World::Leaning
        } else {
            World::Elsewhere
        }
    } else if force.concentration >= limits.far_concentration && degrees >= limits.far_deg {
        World::Far
    } else if force.concentration >= limits.min_concentration {
        return little(format!(
            "the mean acceleration is {degrees:.2} deg from up (agreement {:.3}): more than {} deg, but not clearly a fault",
            force.concentration, limits.max_tilt_deg
        ));
    } else {
        return little(format!(
            "the acceleration has no steady direction in the world: {degrees:.0} deg from up on average, agreement {:.3}",
            force.concentration
        ));
    };
    Ok(WorldUp {
        class,
        force,
        others: gravity
            .means
            .iter()
            .filter(|mean| mean.reading != Reading::Xyzw)
            .copied()
            .collect(),
        seconds: gravity.covered_s,
        rows: gravity.rows,
    })
}
