//! Which way is up: the mean of the specific force in the world, under each reading of the orientation.
//!
//! Owns the rotated means and how well they agree. Gives numbers and no verdict: a force that points down may be a world whose
//! z points down or an accelerometer with the opposite sign. Blind to yaw. Must not know which message held the rows.
//! Seconds, rad/s, m/s^2. Source: `rules/axes/orientation-vs-gravity.md`.

use nalgebra::Vector3;

use super::readings::Reading;
use super::stats::median;

/// One message: an orientation and a specific force of the same body at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The time in seconds from any origin.
    pub t_s: f64,
    /// The four numbers in the slots x, y, z, w, as published; any norm but 0.
    pub slots: [f64; 4],
    /// What an accelerometer with the body's axes reads: +9.8 on the axis that points up, at rest, by convention.
    pub force_m_s2: [f64; 3],
}

/// The force in the world under each reading.
#[derive(Debug, Clone, PartialEq)]
pub struct Gravity {
    /// How many rows counted.
    pub rows: usize,
    /// How many windows they fill.
    pub windows: usize,
    /// The time between the first and the last row of each stretch, summed, seconds.
    pub covered_s: f64,
    /// The mean of the norm of the force, m/s^2. It needs no orientation: near 9.8, or the unit or the content is another.
    pub norm_m_s2: f64,
    /// The time in windows whose body, by the orientation as published, is tilted by at least the limit: this
    /// distinguishes a reading from its conjugate. Seconds.
    pub tilted_s: f64,
    /// The result of each reading, in the order of [`Reading::ALL`].
    pub means: [WorldForce; 4],
}

/// The force, rotated into the world by one reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldForce {
    /// The reading.
    pub reading: Reading,
    /// The mean over all rows, m/s^2: (0, 0, +9.8) in a world whose z points up.
    pub mean_m_s2: Vector3<f64>,
    /// The length of the mean of the unit vectors: 1 when all rows agree, near 0 when they point anywhere.
    pub concentration: f64,
    /// The angle of the mean to +z, 0..=pi. Near pi: the mean points along -z.
    pub from_up_rad: f64,
    /// The median over windows of the angle between the window's mean and +z, radians.
    pub median_from_up_rad: f64,
    /// The median over windows of the angle between the window's mean and -z, radians.
    pub median_from_down_rad: f64,
}

impl Gravity {
    /// The result of one reading.
    pub fn mean(&self, reading: Reading) -> Option<&WorldForce> {
        self.means.iter().find(|m| m.reading == reading)
    }
}

#[derive(Clone, Copy, Default)]
struct Sum {
    force: Vector3<f64>,
    unit: Vector3<f64>,
}

/// One window: the sums of each reading, and of the cosine of the tilt.
#[derive(Default)]
struct Window {
    rows: f64,
    forces: [Vector3<f64>; 4],
    upright: f64,
    start_s: f64,
    end_s: f64,
}

/// The means of the turned force over all rows of all stretches, and over windows of `window_s` within a stretch.
///
/// Rows with a zero or not finite orientation, a force that is zero or not finite, or a time that is not finite are left
/// out. `tilt_rad` is the limit of [`Gravity::tilted_s`]. `None` when no row counts.
pub fn gravity<S: AsRef<[Row]>>(stretches: &[S], window_s: f64, tilt_rad: f64) -> Option<Gravity> {
    let mut totals = [Sum::default(); 4];
    let mut windows: Vec<Window> = Vec::new();
    let (mut rows, mut norms, mut covered_s) = (0_usize, 0.0, 0.0);
    for stretch in stretches {
        let mut open: Option<Window> = None;
        let mut span: Option<(f64, f64)> = None;
        for row in stretch.as_ref() {
            let force = Vector3::from(row.force_m_s2);
            let norm = force.norm();
            let Some(published) = Reading::Xyzw.world_from_body(row.slots) else {
                continue;
            };
            if !(row.t_s.is_finite() && norm.is_finite() && norm > 0.0) {
                continue;
            }
            // A step back in time ends a window as well.
            let fits = |w: &Window| row.t_s >= w.end_s && row.t_s - w.start_s < window_s;
            if !open.as_ref().is_some_and(fits) {
                windows.extend(open.take());
            }
            let window = open.get_or_insert_with(|| Window {
                start_s: row.t_s,
                ..Window::default()
            });
            window.rows += 1.0;
            window.end_s = row.t_s;
            window.upright += (published * Vector3::z()).z;
            let slots = totals.iter_mut().zip(&mut window.forces).zip(Reading::ALL);
            for ((total, of_window), reading) in slots {
                let world = reading.world_from_body(row.slots).unwrap_or(published) * force;
                total.force += world;
                total.unit += world / norm;
                *of_window += world;
            }
            rows += 1;
            norms += norm;
            let (first, last) = span.unwrap_or((row.t_s, row.t_s));
            span = Some((first.min(row.t_s), last.max(row.t_s)));
        }
        windows.extend(open.take());
        covered_s += span.map_or(0.0, |(first, last)| last - first);
    }
    let n = rows as f64;
    // A body upside down (its z down in a world with z up) is level too: the tilt is that of an axis.
    let is_tilted = |w: &&Window| (w.upright / w.rows).abs() <= tilt_rad.cos();
    (rows > 0).then(|| Gravity {
        rows,
        windows: windows.len(),
        covered_s,
        norm_m_s2: norms / n,
        tilted_s: windows.iter().filter(is_tilted).map(|w| w.end_s - w.start_s).sum(),
        means: std::array::from_fn(|i| {
            let total = totals.get(i).copied().unwrap_or_default();
            let angles: Vec<f64> = windows.iter().filter_map(|w| w.forces.get(i)).map(from_up).collect();
            let median_from_up_rad = median(&angles).unwrap_or(f64::NAN);
            WorldForce {
                reading: Reading::ALL.get(i).copied().unwrap_or(Reading::Xyzw),
                mean_m_s2: total.force / n,
                concentration: total.unit.norm() / n,
                from_up_rad: from_up(&total.force),
                median_from_up_rad,
                median_from_down_rad: std::f64::consts::PI - median_from_up_rad,
            }
        }),
    })
}

/// The angle to +z, 0..=pi; exact at both ends, where an arccosine is not.
fn from_up(v: &Vector3<f64>) -> f64 {
    v.x.hypot(v.y).atan2(v.z)
}
