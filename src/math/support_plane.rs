//! The plane that everything in a cloud stands on.
//!
//! Owns the search for it in the points of one scan, and the evidence for it: the cells of the sensor's view on it, what
//! is below and above. Gives numbers and no verdict: a ceiling seen from below is such a plane in a cloud that is upside down.
//! Metres, in the sensor's axes; the origin is the sensor. On real recordings
//! beams near the horizon make false planes. The search is RANSAC (Fischler and Bolles 1981), its triples from a
//! fixed sequence, then least squares over the inliers.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::math::stats::quantile;

/// How a plane is sought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Points farther away are left out, metres.
    pub reach_m: f64,
    /// The normal may deviate from the requested direction by this, radians.
    pub max_tilt_rad: f64,
    /// Points within this of the plane lie on it, metres.
    pub tolerance_m: f64,
    /// Points so far beneath the plane contradict it, and so far above it stand on it, metres.
    pub clear_m: f64,
    /// The sensor is at least this far above the plane, metres.
    pub least_m: f64,
    /// How many triples are tried.
    pub trials: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            reach_m: 25.0,
            max_tilt_rad: 15_f64.to_radians(),
            tolerance_m: 0.08,
            clear_m: 0.3,
            least_m: 0.15,
            trials: 300,
        }
    }
}

/// A plane in a cloud.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupportPlane {
    /// Its unit normal, to the side of the sensor.
    pub normal: Vector3<f64>,
    /// From the plane to the sensor, metres, positive.
    pub height_m: f64,
    /// Points within reach.
    pub points: usize,
    /// Share of them that are on the plane.
    pub on: f64,
    /// Share of them that are clearly below it.
    pub below: f64,
    /// Share of them that are clearly above it.
    pub above: f64,
    /// Cells of the view, 10 degrees wide and an octave of range deep, of which a point lies on the plane.
    pub cells: usize,
    /// Sectors of the view, 10 degrees wide, of 36, in which a point lies on the plane.
    pub sectors: usize,
    /// The same, in which any point lies.
    pub seen: usize,
    /// Share of the points on the plane that are twice as far away as the plane is, or farther: seen at 30 degrees or less.
    pub far: f64,
    /// Share of the points on the plane that the sensor sees within 3 degrees of its own horizon.
    pub at_horizon: f64,
    /// Median distance of the points on the plane from it, metres.
    pub spread_m: f64,
}

/// Width of a cell, radians.
const CELL_RAD: f64 = PI / 18.0;
/// Elevations within this of the horizon, radians.
const HORIZON_RAD: f64 = 3.0 * PI / 180.0;
/// The quantile of the elevations that stands for the highest beam: single points above it are noise.
const HIGHEST: f64 = 0.995;

/// The plane beneath the sensor whose normal is about `up`, with the most cells on it and the fewest points beneath. `None` where no triple
/// makes one.
pub fn support_plane(points: &[Vector3<f64>], up: &Vector3<f64>, options: &Options) -> Option<SupportPlane> {
    let near: Vec<Vector3<f64>> = points
        .iter()
        .filter(|point| point.iter().all(|value| value.is_finite()) && point.norm() <= options.reach_m)
        .copied()
        .collect();
    let under: Vec<Vector3<f64>> = near
        .iter()
        .filter(|point| point.dot(up) < -options.least_m)
        .copied()
        .collect();
    if under.len() < 3 {
        return None;
    }
    let frame = Frame::of(up);
    let [mut cells_under, mut cells_near] = [&under, &near].map(|points| Cells::of(points, &frame));
    let mut sequence = Sequence(0x9e37_79b9_7f4a_7c15);
    let mut best: Option<(f64, Vector3<f64>, f64)> = None;
    for _ in 0..options.trials {
        let mut pick = || under.get(sequence.below(under.len())).copied();
        let (Some(a), Some(b), Some(c)) = (pick(), pick(), pick()) else {
            break;
        };
        let Some((normal, height_m)) = plane(&a, &b, &c, up, options) else {
            continue;
        };
        let (cells, below) = cells_under.on(&normal, height_m, options);
        let score = cells as f64 * (1.0 - below as f64 / under.len() as f64);
        if best.is_none_or(|(most, ..)| score > most) {
            best = Some((score, normal, height_m));
        }
    }
    let (_, mut normal, mut height_m) = best?;
    for _ in 0..2 {
        let on = near
            .iter()
            .filter(|point| (point.dot(&normal) + height_m).abs() <= options.tolerance_m);
        if let Some(fitted) = fitted(on, up, options) {
            (normal, height_m) = fitted;
        }
    }
    let of = |point: &Vector3<f64>| point.dot(&normal) + height_m;
    let share = |is: &dyn Fn(f64) -> bool| near.iter().filter(|point| is(of(point))).count() as f64 / near.len() as f64;
    let on: Vec<&Vector3<f64>> = near
        .iter()
        .filter(|point| of(point).abs() <= options.tolerance_m)
        .collect();
    let share_on = |is: &dyn Fn(&Vector3<f64>) -> bool| {
        on.iter().filter(|point| is(point)).count() as f64 / on.len().max(1) as f64
    };
    let mut off: Vec<f64> = on.iter().map(|point| of(point).abs()).collect();
    off.sort_by(f64::total_cmp);
    Some(SupportPlane {
        normal,
        height_m,
        points: near.len(),
        on: share(&|off| off.abs() <= options.tolerance_m),
        below: share(&|off| off < -options.clear_m),
        above: share(&|off| off > options.clear_m),
        cells: cells_near.on(&normal, height_m, options).0,
        sectors: frame.sectors(on.iter().copied()),
        seen: frame.sectors(&near),
        far: share_on(&|point| point.norm() >= 2.0 * height_m),
        at_horizon: share_on(&|point| frame.elevation(point).abs() < HORIZON_RAD),
        spread_m: off.get(off.len() / 2).copied().unwrap_or(f64::NAN),
    })
}

/// Share of the sectors, of those with any point, in which the highest beams meet nothing: those within `band_rad` of the highest.
/// Sectors that so few points would miss by chance do not count. `None` where the highest beam looks up by less
/// than `least_rad`.
pub fn open_above(points: &[Vector3<f64>], up: &Vector3<f64>, band_rad: f64, least_rad: f64) -> Option<f64> {
    let frame = Frame::of(up);
    let elevations: Vec<f64> = points.iter().map(|point| frame.elevation(point)).collect();
    let highest = quantile(&elevations, HIGHEST).filter(|highest| *highest >= least_rad)?;
    let top = points.iter().zip(&elevations);
    let top: Vec<&Vector3<f64>> = top
        .filter(|(_, elevation)| **elevation >= highest - band_rad)
        .map(|(point, _)| point)
        .collect();
    let ways = frame.sectors(points).max(1) as f64;
    let met_by_chance = ways * (1.0 - (1.0 - 1.0 / ways).powf(top.len() as f64));
    Some((1.0 - frame.sectors(top) as f64 / met_by_chance).max(0.0))
}

/// The plane through three points, its normal to the side of the sensor; `None` where it leans too far, or is too near.
fn plane(
    a: &Vector3<f64>,
    b: &Vector3<f64>,
    c: &Vector3<f64>,
    up: &Vector3<f64>,
    options: &Options,
) -> Option<(Vector3<f64>, f64)> {
    let normal = (b - a).cross(&(c - a)).try_normalize(1e-6)?;
    let normal = if normal.dot(up) < 0.0 { -normal } else { normal };
    let height_m = -normal.dot(a);
    let leans = normal.dot(up) < options.max_tilt_rad.cos();
    (!leans && height_m >= options.least_m).then_some((normal, height_m))
}

/// The plane of least squares through points.
fn fitted<'p>(
    points: impl Iterator<Item = &'p Vector3<f64>>,
    up: &Vector3<f64>,
    options: &Options,
) -> Option<(Vector3<f64>, f64)> {
    let (mut count, mut sum, mut squares) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for point in points {
        count += 1.0;
        sum += point;
        squares += point * point.transpose();
    }
    if count < 3.0 {
        return None;
    }
    let mean = sum / count;
    let spread = SymmetricEigen::try_new(squares / count - mean * mean.transpose(), 1e-12, 100)?;
    let normal: Vector3<f64> = spread.eigenvectors.column(spread.eigenvalues.imin()).into();
    let normal = if normal.dot(up) < 0.0 { -normal } else { normal };
    let height_m = -normal.dot(&mean);
    let leans = normal.dot(up) < options.max_tilt_rad.cos();
    (!leans && height_m >= options.least_m).then_some((normal, height_m))
}

/// The axes in which the view is cut into cells.
struct Frame {
    up: Vector3<f64>,
    x: Vector3<f64>,
    y: Vector3<f64>,
}

impl Frame {
    fn of(up: &Vector3<f64>) -> Self {
        let aside = if up.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let x = (aside - up * up.dot(&aside)).normalize();
        Self {
            up: *up,
            x,
            y: up.cross(&x),
        }
    }

    /// Which of the sectors a point is in.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // from 0 to their number
    fn sector(&self, point: &Vector3<f64>) -> usize {
        let azimuth = point.dot(&self.y).atan2(point.dot(&self.x)) + PI;
        ((azimuth / CELL_RAD) as usize).min(ACROSS - 1)
    }

    /// In how many of the ways around there is a point.
    fn sectors<'p>(&self, points: impl IntoIterator<Item = &'p Vector3<f64>>) -> usize {
        let sectors = points.into_iter().map(|point| self.sector(point));
        sectors.collect::<BTreeSet<_>>().len()
    }

    fn elevation(&self, point: &Vector3<f64>) -> f64 {
        let along = point.dot(&self.up);
        along.atan2((point - self.up * along).norm())
    }

    /// The cell of a point: its direction, and the octave of its range.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // from 0 to the number of cells
    fn cell(&self, point: &Vector3<f64>) -> usize {
        let octave = point.norm().max(1e-3).log2().floor().clamp(FIRST_OCTAVE, LAST_OCTAVE) - FIRST_OCTAVE;
        self.sector(point) + ACROSS * octave as usize
    }
}

/// Cells around.
const ACROSS: usize = 36;
/// Octaves of range, as powers of two of a metre.
const FIRST_OCTAVE: f64 = -10.0;
/// The last one.
const LAST_OCTAVE: f64 = 10.0;

/// Points with their cells, which are worked out once: planes are tried by the hundred.
struct Cells {
    points: Vec<([f64; 3], usize)>,
    /// The last plane that had a point in each cell, by its number.
    seen: Vec<u32>,
    planes: u32,
}

impl Cells {
    fn of(points: &[Vector3<f64>], frame: &Frame) -> Self {
        let points: Vec<_> = points
            .iter()
            .map(|point| ((*point).into(), frame.cell(point)))
            .collect();
        let most = points.iter().map(|(_, cell)| *cell).max().unwrap_or_default();
        Self {
            points,
            seen: vec![0; most + 1],
            planes: 0,
        }
    }

    /// In how many cells a point is on a plane, and how many points are clearly below it.
    fn on(&mut self, normal: &Vector3<f64>, height_m: f64, options: &Options) -> (usize, usize) {
        self.planes += 1;
        let [a, b, c]: [f64; 3] = (*normal).into();
        let (mut count, mut below) = (0, 0);
        for ([x, y, z], cell) in &self.points {
            let off_m = a * x + b * y + c * z + height_m;
            below += usize::from(off_m < -options.clear_m);
            if off_m.abs() > options.tolerance_m {
                continue;
            }
            if let Some(seen) = self.seen.get_mut(*cell).filter(|seen| **seen != self.planes) {
                *seen = self.planes;
                count += 1;
            }
        }
        (count, below)
    }
}

/// Numbers that are the same in every run (Marsaglia's xorshift).
struct Sequence(u64);

impl Sequence {
    fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 >> 33).unwrap_or(0) % count.max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::tests_support::Rng;

    /// Ground at -1.8 m that leans by some degrees about x, and a wall.
    fn street(rng: &mut Rng, lean_deg: f64) -> Vec<Vector3<f64>> {
        let slope = lean_deg.to_radians().tan();
        let mut points = Vec::new();
        for _ in 0..1500 {
            let [x, y] = [(); 2].map(|()| rng.range(-15.0, 15.0));
            points.push(Vector3::new(x, y, -1.8 + slope * y + 0.02 * rng.normal()));
        }
        for _ in 0..1500 {
            points.push(Vector3::new(rng.range(-15.0, 15.0), 6.0, rng.range(-1.2, 4.0)));
        }
        points
    }

    #[test]
    fn the_ground_is_found_with_its_height_and_its_lean() {
        let mut rng = Rng::new(5);
        for lean_deg in [0.0, 4.0, -9.0] {
            let found = support_plane(&street(&mut rng, lean_deg), &Vector3::z(), &Options::default()).unwrap();
            let lean = lean_deg.to_radians();
            // A plane z = -h + s y lies h cos(lean) from the origin.
            assert!((found.height_m - 1.8 * lean.cos()).abs() < 0.02, "{found:?}");
            let normal = Vector3::new(0.0, -lean.sin(), lean.cos());
            assert!(found.normal.angle(&normal) < 0.01, "{found:?}");
            assert!(found.below < 0.01 && found.above > 0.2 && found.cells > 60, "{found:?}");
        }
    }

    #[test]
    fn the_plane_does_not_depend_on_the_axes_that_it_is_told_in() {
        let mut rng = Rng::new(7);
        let street = street(&mut rng, 3.0);
        let upright = support_plane(&street, &Vector3::z(), &Options::default()).unwrap();
        for axis_angle in [Vector3::new(1.2, 0.0, 0.0), Vector3::new(-0.4, 2.0, 0.9)] {
            let turn = nalgebra::Rotation3::new(axis_angle);
            let turned: Vec<Vector3<f64>> = street.iter().map(|point| turn * point).collect();
            let found = support_plane(&turned, &(turn * Vector3::z()), &Options::default()).unwrap();
            assert!(
                (turn.inverse() * found.normal).angle(&upright.normal) < 0.01,
                "{found:?} {upright:?}"
            );
            assert!(
                (found.height_m - upright.height_m).abs() < 0.02,
                "{found:?} {upright:?}"
            );
            assert!((found.on - upright.on).abs() < 0.03, "{found:?} {upright:?}");
        }
    }

    #[test]
    fn what_the_shares_count_is_what_was_put_there() {
        // Of 1000 points 600 on a floor at -2 m, 300 a metre above it, 100 a metre beneath; 500 more are out of reach.
        let mut rng = Rng::new(8);
        let mut points = Vec::new();
        for (count, z) in [(600, -2.0), (300, -1.0), (100, -3.0)] {
            points.extend((0..count).map(|_| Vector3::new(rng.range(-9.0, 9.0), rng.range(-9.0, 9.0), z)));
        }
        points.extend((0..500).map(|_| Vector3::new(40.0, rng.range(-9.0, 9.0), -2.0)));
        points.push(Vector3::new(f64::NAN, 0.0, -2.0));
        let found = support_plane(&points, &Vector3::z(), &Options::default()).unwrap();
        assert_eq!(found.points, 1000);
        for (share, expected) in [(found.on, 0.6), (found.above, 0.3), (found.below, 0.1)] {
            assert!((share - expected).abs() < 1e-12, "{found:?}");
        }
        assert!(
            (found.height_m - 2.0).abs() < 1e-9 && found.spread_m < 1e-9,
            "{found:?}"
        );
        // Of a square of 18 m all but the circle that is seen at more than 30 degrees, of 2 m times the tangent of 60, is far.
        let far = 1.0 - std::f64::consts::PI * 12.0 / 324.0;
        assert!(
            (found.far - far).abs() < 0.03 && (found.sectors, found.seen) == (36, 36),
            "{found:?}"
        );
        // Within 9 m of a floor 2 m beneath no point is near the horizon.
        assert!(found.at_horizon.abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_plane_through_the_sensor_or_leaning_too_far_is_none() {
        let mut rng = Rng::new(9);
        let mut plane = |slope: f64, z: f64| -> Vec<Vector3<f64>> {
            let mut point = || {
                let [x, y] = [(); 2].map(|()| rng.range(-6.0, 6.0));
                Vector3::new(x, y, z + slope * x)
            };
            (0..800).map(|_| point()).collect()
        };
        for points in [plane(0.0, -0.1), plane(0.0, 2.0), plane(1.0, -2.0)] {
            assert_eq!(support_plane(&points, &Vector3::z(), &Options::default()), None);
        }
        // Twenty degrees lean too far where fifteen are allowed, and do not where thirty are.
        let leaning = plane(20_f64.to_radians().tan(), -3.0);
        assert_eq!(support_plane(&leaning, &Vector3::z(), &Options::default()), None);
        let wide = Options {
            max_tilt_rad: 30_f64.to_radians(),
            ..Options::default()
        };
        let found = support_plane(&leaning, &Vector3::z(), &wide).unwrap();
        assert!(
            (found.normal.angle(&Vector3::z()).to_degrees() - 20.0).abs() < 1e-6,
            "{found:?}"
        );
    }

    #[test]
    fn the_highest_beams_meet_a_wall_all_around_or_in_half_of_the_ways() {
        let deg = f64::to_radians;
        // Beams from -20 to 20 deg: below the horizon they meet a floor all around, above it a wall in the ways up to an azimuth.
        let seen = |walled_deg: u32| -> Vec<Vector3<f64>> {
            let ways = (0..720).map(|half| 0.5 * f64::from(half) + 0.2);
            ways.flat_map(|azimuth| {
                let highest = if azimuth < f64::from(walled_deg) { 20 } else { -5 };
                (-20..=highest).map(move |elevation| {
                    let (sin, cos) = deg(azimuth).sin_cos();
                    let (up, out) = deg(f64::from(elevation)).sin_cos();
                    5.0 * Vector3::new(out * cos, out * sin, up)
                })
            })
            .collect()
        };
        for (walled_deg, open) in [(360, 0.0), (180, 0.5), (90, 0.75)] {
            let share = open_above(&seen(walled_deg), &Vector3::z(), deg(2.5), deg(10.0)).unwrap();
            assert!((share - open).abs() < 1e-6, "{walled_deg}: {share}");
        }
        // Forty points all around leave a third of the ways without one, by chance: no opening. A hundred in half of the ways are one.
        let mut rng = Rng::new(11);
        for (walled_deg, kept, is_open) in [(360, 0.02, false), (180, 0.1, true)] {
            for _ in 0..50 {
                let mut thinned = seen(walled_deg);
                thinned.retain(|_| rng.range(0.0, 1.0) < kept);
                let share = open_above(&thinned, &Vector3::z(), deg(2.5), deg(10.0)).unwrap();
                assert_eq!(share > 0.25, is_open, "{walled_deg}: {share}");
            }
        }
        // None of them looks up by 25 deg, and upside down only by 20.
        assert_eq!(open_above(&seen(360), &Vector3::z(), deg(2.5), deg(25.0)), None);
        let below = open_above(&seen(90), &-Vector3::z(), deg(2.5), deg(10.0)).unwrap();
        assert!(below.abs() < 1e-12, "{below}");
    }

    #[test]
    fn walls_and_clouds_of_noise_are_no_ground() {
        let mut rng = Rng::new(6);
        let street = street(&mut rng, 0.0);
        let [below, above] = [Vector3::x(), -Vector3::z()].map(|up| {
            support_plane(&street, &up, &Options::default())
                .map_or(0.0, |found| found.cells as f64 * (1.0 - found.below / 0.05).max(0.0))
        });
        assert!(below < 25.0 && above < 25.0, "{below} {above}");
        let noise: Vec<Vector3<f64>> = (0..2000).map(|_| 8.0 * rng.normal3()).collect();
        let found = support_plane(&noise, &Vector3::z(), &Options::default());
        assert!(
            found.is_none_or(|found| found.below > 0.03 || found.on < 0.15),
            "{found:?}"
        );
        assert!(support_plane(&[], &Vector3::z(), &Options::default()).is_none());
    }
}
