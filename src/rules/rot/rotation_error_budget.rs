//! ROT10: how far the angles that other rules found displace distant points.

use crate::rules::{Review, prelude::*};
use crate::verdict::{Outcome, PlaceRole, Row};

pub(crate) struct RotationErrorBudget;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    near_m: f64,
    middle_m: f64,
    far_m: f64,
    max_deg: f64,
}

impl Limits {
    /// How far a rotation moves points, metres: each distance with the chord `2 r sin(angle / 2)`.
    fn moved_m(&self, turn_deg: f64) -> [(f64, f64); 3] {
        let chord = 2.0 * (turn_deg.to_radians() / 2.0).sin().abs();
        [self.near_m, self.middle_m, self.far_m].map(|range_m| (range_m, range_m * chord))
    }

    fn measured(&self, turn_deg: f64) -> [Measured; 3] {
        self.moved_m(turn_deg)
            .map(|(range_m, m)| Measured::new(format!("error of a point at {range_m} m"), m, "m"))
    }
}

/// A smaller angle is 0.00 in words: 1 mm at 100 m.
const LEAST_DEG: f64 = 0.005;

/// The largest of the measured rotations, degrees, without its sign.
fn turn_deg(measured: &[Measured]) -> Option<f64> {
    let turns = measured.iter().filter(|one| one.is_turn && one.unit == "deg");
    let angles = turns.map(|one| one.value.abs());
    angles.filter(|angle| angle.is_finite()).max_by(f64::total_cmp)
}

impl Review for RotationErrorBudget {
    type Limits = Limits;

    fn review(found: &mut [Finding], rows: &[Row], limits: &Limits, out: &mut Judge) {
        let subject = "angles of the findings";
        let mut worst: Option<(f64, &Finding)> = None;
        let (mut others, mut beyond) = (0, 0);
        for finding in found {
            let Some(turn_deg) = turn_deg(&finding.measured).filter(|angle| *angle >= LEAST_DEG) else {
                continue;
            };
            if turn_deg > limits.max_deg {
                beyond += 1;
                continue;
            }
            finding.measured.extend(limits.measured(turn_deg));
            others += 1;
            if worst.is_none_or(|(angle, _)| turn_deg > angle) {
                worst = Some((turn_deg, finding));
            }
        }
        let Some((turn_deg, finding)) = worst else {
            let passed = rows.iter().filter(|row| row.outcome == Outcome::Pass);
            let angles: Vec<f64> = passed.filter_map(|row| turn_deg(&row.measured)).collect();
            let largest = angles.iter().copied().max_by(f64::total_cmp);
            if let Some(turn_deg) = largest.filter(|_| beyond == 0) {
                let angle = Measured::new("largest angle that passed", turn_deg, "deg")
                    .limit(limits.max_deg)
                    .samples(angles.len() as u64);
                return out.pass(subject, std::iter::once(angle).chain(limits.measured(turn_deg)));
            }
            if beyond == 0 {
                return out.not_applicable(subject, "no rule measured a rotation error");
            }
            let max_deg = limits.max_deg;
            let why = format!("all rotation errors are beyond {max_deg} deg: axes are wrong, not a mounting angle");
            return out.not_applicable(subject, why);
        };
        let Some(primary) = finding.places.iter().find(|label| label.role == PlaceRole::Primary) else {
            return;
        };
        let distances = limits.moved_m(turn_deg);
        let moved: Vec<String> = distances
            .iter()
            .map(|(range_m, m)| format!("{m:.2} m at {range_m} m"))
            .collect();
        let more = match others - 1 {
            0 => String::new(),
            1 => "One more finding has such rows for its own angle.".to_owned(),
            count => format!("{count} more findings have such rows for their own angles."),
        };
        let (rule, moved) = (&finding.rule, moved.join(", "));
        let message = format!("the rotation error that {rule} found moves points by {moved}");
        let note = Finding::note(subject, message, primary.place.clone())
            .detail(format!("The finding of {rule}: {}.", finding.message))
            .detail(more)
            .help(format!(
                "correct what {rule} found; until then, compare these errors with the accuracy that you need"
            ))
            .measured(Measured::new("angle", turn_deg, "deg"));
        out.fail(note.measured(limits.measured(turn_deg)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_degree_at_fifty_metres_is_44_centimetres() {
        let limits = Limits {
            near_m: 10.0,
            middle_m: 50.0,
            far_m: 100.0,
            max_deg: 45.0,
        };
        let [near, middle, far] = limits.moved_m(0.5).map(|(_, m)| m);
        assert!((middle - 0.436_331).abs() < 1e-6);
        assert!((near - middle / 5.0).abs() < 1e-12 && (far - 2.0 * middle).abs() < 1e-12);
    }
}
