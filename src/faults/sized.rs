//! Mistakes that have a size: by how much a mounting, a clock, a scale or a height is off.

use nalgebra::Vector3;

use crate::world::World;

use super::motion::{FixChange, HiddenDirection, Rotations, ScaleChange, StampChange};
use super::mountings::{Axis, Mounting};
use super::{Change, Seers, Subject};

/// The word that selects all of them.
pub const SIZES: &str = "size";

/// A mistake that has a size.
pub struct SizedFault {
    /// Its name: a word, unique among all mistakes.
    pub name: &'static str,
    /// One plain sentence: what is wrong.
    pub sentence: &'static str,
    /// The unit of its size: `deg`, `m`, `s` or `%`.
    pub unit: &'static str,
    /// The smallest and the largest size that is tried.
    pub range: [f64; 2],
    /// The change of a size.
    change: fn(f64) -> Box<dyn Change>,
    /// The rules that should see it.
    pub seen_by: Seers,
    /// What to record or to add where it is not found.
    pub record: &'static str,
}

impl std::fmt::Debug for SizedFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl SizedFault {
    /// What in this world can have it.
    pub fn subjects(&self, world: &World) -> Vec<Subject> {
        let [smallest, _] = self.range;
        (self.change)(smallest).subjects(world)
    }

    /// Puts it into a subject of this world, with a size in its unit, of either sign. False if that changes nothing.
    pub fn apply(&self, world: &mut World, subject: &Subject, size: f64) -> bool {
        (self.change)(size).apply(world, subject)
    }

    /// Where rotations of the platform hide it: of the position of a sensor along an axis of the base.
    pub fn hidden_by(&self, rotations: &Rotations) -> Option<HiddenDirection> {
        let along = match self.name {
            "x" => Vector3::x(),
            "y" => Vector3::y(),
            "z" => Vector3::z(),
            _ => return None,
        };
        rotations.hide(&along)
    }

    /// Whether a word is its name, or means all mistakes that have a size.
    pub fn is_called(&self, word: &str) -> bool {
        [self.name, SIZES].iter().any(|name| name.eq_ignore_ascii_case(word))
    }

    /// What a size of it means for a point at 50 m, metres; `pace`: speed, m/s, and turn rate, rad/s, of the platform.
    pub fn at_50_m(&self, size: f64, pace: Option<[f64; 2]>) -> Option<f64> {
        const FAR_M: f64 = 50.0;
        let chord = |angle_rad: f64| 2.0 * FAR_M * (angle_rad.min(std::f64::consts::PI) / 2.0).sin();
        match self.unit {
            "deg" => Some(chord(size.to_radians())),
            "%" => Some(FAR_M * size / 100.0),
            "s" => pace.map(|[speed_m_s, turn_rad_s]| size * speed_m_s + chord(size * turn_rad_s)),
            _ => Some(size),
        }
    }
}

/// The rules that see a tilt.
const TILTED: Seers = Seers(&[
    "AXES10", "AXES01", "AXES09", "CROSS05", "CAMERA05", "QUAT04", "CROSS01", "CROSS02", "ROT10",
]);
/// The rules that see a yaw.
const YAWED: Seers = Seers(&[
    "AXES12",
    "AXES06",
    "AXES15",
    "AXES04",
    "QUAT04",
    "CROSS05 yaw",
    "CAMERA05",
    "CROSS01",
    "CROSS02",
    "ROT10",
]);
/// The rules that see where a sensor is.
const PLACED: Seers = Seers(&["CROSS05 place", "GEO08", "CROSS01", "CROSS02"]);
/// The rules that see at which height a sensor is.
const RAISED: Seers = Seers(&["AXES09 ground", "CROSS05 place", "CROSS01", "CROSS02"]);

const LEVEL: &str = "flat ground in view of the lidar, or a calibration file that states the transform independently of the robot's description";
const AHEAD: &str = "30 s of straight driving and turns with this sensor and odometry, or a calibration file that states the transform independently";
const PLACE: &str = "a calibration file that states the transform independently of the robot's description";
const HEIGHT: &str = "flat ground in view of the lidar and base_footprint on the ground, or a calibration file that states the transform independently";

/// A mounting that is turned or moved.
macro_rules! mounting {
    ($name:literal, $what:literal, $unit:literal, $range:expr, $change:expr, $seen_by:expr, $record:expr) => {
        SizedFault {
            name: $name,
            sentence: concat!(
                "A sensor is mounted with another ",
                $what,
                " than its transform states."
            ),
            unit: $unit,
            range: $range,
            change: $change,
            seen_by: $seen_by,
            record: $record,
        }
    };
}

/// Every one of them, in a fixed order.
pub static SIZED_FAULTS: &[SizedFault] = &[
    mounting!(
        "roll",
        "roll",
        "deg",
        ANGLES,
        |deg| Box::new(Mounting::Turned(Axis::X, deg)),
        TILTED,
        LEVEL
    ),
    mounting!(
        "pitch",
        "pitch",
        "deg",
        ANGLES,
        |deg| Box::new(Mounting::Turned(Axis::Y, deg)),
        TILTED,
        LEVEL
    ),
    mounting!(
        "yaw",
        "yaw",
        "deg",
        ANGLES,
        |deg| Box::new(Mounting::Turned(Axis::Z, deg)),
        YAWED,
        AHEAD
    ),
    mounting!(
        "x",
        "position along x",
        "m",
        LENGTHS,
        |m| Box::new(Mounting::Moved(Axis::X, m)),
        PLACED,
        PLACE
    ),
    mounting!(
        "y",
        "position along y",
        "m",
        LENGTHS,
        |m| Box::new(Mounting::Moved(Axis::Y, m)),
        PLACED,
        PLACE
    ),
    mounting!(
        "z",
        "position along z",
        "m",
        LENGTHS,
        |m| Box::new(Mounting::Moved(Axis::Z, m)),
        RAISED,
        HEIGHT
    ),
    SizedFault {
        name: "time-offset",
        sentence: "The stamps of a stream are later than its measurements, or earlier, and those of the others are right.",
        unit: "s",
        range: [0.001, 10.0],
        change: |s| Box::new(StampChange::Offset(s)),
        seen_by: Seers(&["TIME09", "TIME02", "TIME01", "TIME10"]),
        record: "a minute of driving with turns and changes of speed, with a second stream that measures the same motion",
    },
    SizedFault {
        name: "scale",
        sentence: "Ways and velocities are longer than they are, as with a wrong wheel radius.",
        unit: "%",
        range: [0.1, 400.0],
        change: |percent| Box::new(ScaleChange { percent }),
        seen_by: Seers(&["AXES07 scale", "AXES08", "GEO04", "CROSS05 scale"]),
        record: "a minute of driving with satellite fixes or a second odometry",
    },
    SizedFault {
        name: "height",
        sentence: "The altitudes of a satellite receiver are higher than it is.",
        unit: "m",
        range: [0.1, 1000.0],
        change: |m| Box::new(FixChange::Raised(m)),
        seen_by: Seers(&["GEO06", "GEO01", "GEO07"]),
        record: "a second source of altitudes: NMEA sentences (GGA), or a second receiver",
    },
];

/// Degrees.
const ANGLES: [f64; 2] = [0.05, 180.0];
/// Metres.
const LENGTHS: [f64; 2] = [0.002, 5.0];

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> &'static SizedFault {
        let mut all = SIZED_FAULTS.iter();
        all.find(|fault| fault.name == name).unwrap_or(&SIZED_FAULTS[0])
    }

    #[test]
    fn an_angle_is_a_chord_at_50_m_and_a_delay_is_a_way() {
        // By hand: a chord of 60 degrees is as long as the radius. A chord of x rad is x (1 - x^2 / 24) radii long.
        assert!((named("yaw").at_50_m(60.0, None).unwrap_or_default() - 50.0).abs() < 1e-9);
        let late = named("time-offset").at_50_m(0.1, Some([10.0, 0.2])).unwrap_or_default();
        assert!(
            (late - (2.0 - 0.02_f64.powi(2) * 50.0 * 0.02 / 24.0)).abs() < 1e-9,
            "{late}"
        );
        assert_eq!(named("time-offset").at_50_m(0.1, None), None);
    }
}
