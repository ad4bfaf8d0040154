//! Where the antenna of a receiver is on the body whose poses are recorded, by how the fixes move while the body turns.
//!
//! With complex numbers for the horizontal plane, poses `p` with yaw `y` and an antenna at `l` in the axes of the body, a fix is
//! `c + u (p + e^(iy) l)`. Displacements over some seconds cancel `c` and the slow errors of receiver and odometry. In each window `u` (rotation and
//! scale between both planes) is free; `l`, and the time by which the fixes are late, are the same in all. Must not judge.

use std::cell::OnceCell;
use std::rc::Rc;
use std::sync::Arc;

use nalgebra::{Complex, Matrix2, Matrix3, Matrix3x2, Vector2, Vector3};
use serde::Deserialize;

use crate::analysis::Estimates;
use crate::analysis::geo::overlay::geodetic;
use crate::analysis::motion::{BagMotion, Motion, Stream, Track, Yaws};
use crate::math::stats::{mad, median};
use crate::world::motion::{FixRow, PoseRow};

type Plane = Complex<f64>;

/// Half of the time over which a speed is taken, seconds.
const SPEED_OVER_S: f64 = 0.25;
/// Passes: each rotates by what the last one found, and drops steps with outlying errors.
const PASSES: usize = 4;
/// The antenna in the axes of the body, x and y, metres; and how late the fixes are, seconds.
type Unknowns = Vector3<f64>;

/// The position of an antenna.
#[derive(Clone, Debug)]
pub(crate) struct AntennaEstimate {
    /// The antenna in the axes of the body, x and y, metres.
    pub(crate) place_m: Vector2<f64>,
    /// Its standard errors, metres.
    pub(crate) error_m: Vector2<f64>,
    /// How late the fixes are, and the standard error, seconds.
    pub(crate) late_s: (f64, f64),
    /// Steps that were used.
    pub(crate) steps: usize,
    /// Robust standard deviation of the residuals over the median of the displacements: 0 fits, 1 means nothing.
    pub(crate) residual: f64,
}

/// What both see between two fixes.
#[derive(Clone, Copy, Debug)]
struct Step {
    t_s: f64,
    /// Displacement of the antenna, east and north.
    fixes: Plane,
    /// Displacement of the body, in the plane of its poses.
    poses: Plane,
    /// Change of the direction of its x axis.
    ahead: Plane,
    /// Change of its velocity.
    speed: Plane,
}

/// The antennas of all receivers, by every stream of poses of the platform; each receiver's are made once, on first use.
pub(crate) struct Antennas {
    limits: Arc<Limits>,
    /// By recording and receiver; then by stream of poses.
    bags: Vec<Vec<OnceCell<Vec<Option<AntennaEstimate>>>>>,
}

impl Antennas {
    pub(crate) fn of(world: &Estimates) -> Rc<Self> {
        world.once(|world| {
            let motion = Motion::of(world);
            let cells = motion
                .bags
                .iter()
                .map(|bag| bag.fixes.iter().map(|_| OnceCell::new()).collect());
            Self {
                limits: world.limits(),
                bags: cells.collect(),
            }
        })
    }

    /// Of one receiver, by those of the poses that determine it best, and follow its fixes.
    pub(crate) fn best<'m>(
        &self,
        (index, bag): (usize, &'m BagMotion),
        receiver: usize,
        is_used: impl Fn(&Stream<PoseRow>) -> bool,
    ) -> Option<(&'m Stream<PoseRow>, &AntennaEstimate)> {
        let (fixes, cell) = (bag.fixes.get(receiver)?, self.bags.get(index)?.get(receiver)?);
        let by_poses = cell.get_or_init(|| {
            let all = bag.ways().map(|poses| AntennaEstimate::of(poses, fixes, &self.limits));
            all.collect()
        });
        let follows = |found: &AntennaEstimate| {
            found.residual <= self.limits.max_residual && found.late_s.0.abs() <= self.limits.max_late_s
        };
        let both = bag.ways().zip(by_poses);
        both.filter_map(|(poses, found)| Some((poses, found.as_ref()?)))
            .filter(|(poses, found)| is_used(poses) && follows(found))
            .min_by(|(_, a), (_, b)| a.error_m.max().total_cmp(&b.error_m.max()))
    }
}

impl AntennaEstimate {
    /// `None` where there are too few windows in which the body turns, or the fixes do not follow the poses.
    fn of(poses: &Stream<PoseRow>, fixes: &Stream<FixRow>, limits: &Limits) -> Option<Self> {
        Self::fitted(windows(&steps(poses, fixes, limits), limits), limits)
    }

    fn fitted(windows: Vec<Vec<Step>>, limits: &Limits) -> Option<Self> {
        if windows.len() < limits.min_windows {
            return None;
        }
        let mut windows: Vec<Window> = windows.into_iter().map(Window::of).collect();
        let (mut found, mut residual_m) = (Unknowns::zeros(), f64::NAN);
        for pass in 0..PASSES {
            let parts: Vec<Part> = windows.iter().map(Window::part).collect();
            found = solved(&parts)?;
            for (window, part) in windows.iter_mut().zip(&parts) {
                window.rotation *= part.own(&found);
            }
            let left = windows.iter().flat_map(|window| window.residuals(&found));
            let left: Vec<f64> = left.flat_map(|left| [left.re, left.im]).collect();
            residual_m = mad(&left)?;
            // In the first pass the rotations are rough.
            for window in windows.iter_mut().filter(|_| pass > 0) {
                window.keep(&found, limits.outlier * residual_m.max(1e-6));
            }
        }
        let parts: Vec<Part> = windows.iter().map(Window::part).collect();
        let error = scatter(&parts)?;
        let lengths: Vec<f64> = windows
            .iter()
            .flat_map(|window| &window.kept)
            .map(|step| step.fixes.norm())
            .collect();
        Some(Self {
            place_m: found.xy(),
            error_m: error.xy(),
            late_s: (found.z, error.z),
            steps: lengths.len(),
            residual: residual_m / median(&lengths)?,
        })
    }
}

/// Steps with one rotation and scale between the plane of the poses and east and north.
struct Window {
    steps: Vec<Step>,
    /// Those without outlying errors.
    kept: Vec<Step>,
    rotation: Plane,
}

impl Window {
    fn of(steps: Vec<Step>) -> Self {
        let sum: Plane = steps.iter().map(|step| step.fixes * step.poses.conj()).sum();
        let rotation = if sum.norm() > 0.0 {
            sum / sum.norm()
        } else {
            Plane::new(1.0, 0.0)
        };
        Self {
            kept: steps.clone(),
            steps,
            rotation,
        }
    }

    fn part(&self) -> Part {
        Part::of(&self.kept, self.rotation)
    }

    fn residuals(&self, found: &Unknowns) -> Vec<Plane> {
        self.steps
            .iter()
            .map(|step| step.residual(self.rotation, found))
            .collect()
    }

    fn keep(&mut self, found: &Unknowns, most_m: f64) {
        let left = self.residuals(found);
        let steps = self.steps.iter().zip(left);
        self.kept = steps
            .filter(|(_, left)| left.norm() <= most_m)
            .map(|(step, _)| *step)
            .collect();
    }
}

impl Step {
    /// What the unknowns leave of the displacement of the fixes, metres in the plane of the poses.
    fn residual(&self, rotation: Plane, unknowns: &Unknowns) -> Plane {
        let arm = Plane::new(unknowns.x, unknowns.y);
        self.fixes / rotation - self.poses - self.ahead * arm + self.speed * unknowns.z
    }
}

/// The steps between fixes that are at least so far apart in time.
fn steps(poses: &Stream<PoseRow>, fixes: &Stream<FixRow>, limits: &Limits) -> Vec<Vec<Step>> {
    let (track, yaws) = (poses.track(), Yaws::of(poses, &nalgebra::UnitQuaternion::identity()));
    let at = |t_s: f64| body(&track, &yaws, t_s);
    let Some(origin) = fixes.rows().find_map(|timed| geodetic(&timed.row)) else {
        return Vec::new();
    };
    let mut all = Vec::new();
    for stretch in &fixes.stretches {
        let mut run: Vec<Step> = Vec::new();
        let mut last: Option<(f64, Plane, [Plane; 3])> = None;
        for timed in stretch {
            let is_due = |before_s: f64| timed.t_s - before_s >= limits.step_s;
            if last.as_ref().is_some_and(|(before_s, ..)| !is_due(*before_s)) {
                continue;
            }
            let Some((fix, body)) = geodetic(&timed.row).zip(at(timed.t_s)) else {
                continue;
            };
            let enu = origin.enu_of(&fix);
            let fix = Plane::new(enu.x, enu.y);
            if let Some((before_s, before, [place, ahead, speed])) = last {
                if timed.t_s - before_s <= 2.0 * limits.step_s {
                    let [now_at, now_ahead, now_speed] = body;
                    run.push(Step {
                        t_s: timed.t_s,
                        fixes: fix - before,
                        poses: now_at - place,
                        ahead: now_ahead - ahead,
                        speed: now_speed - speed,
                    });
                } else if !run.is_empty() {
                    all.push(std::mem::take(&mut run));
                }
            }
            last = Some((timed.t_s, fix, body));
        }
        all.push(run);
    }
    all
}

/// Place, direction of the x axis and velocity of the body.
fn body(track: &Track, yaws: &Yaws, t_s: f64) -> Option<[Plane; 3]> {
    let plane = |place: Vector3<f64>| Plane::new(place.x, place.y);
    let [before, now, after] = [-SPEED_OVER_S, 0.0, SPEED_OVER_S].map(|by_s| track.at(t_s + by_s).map(plane));
    let speed = (after? - before?) / (2.0 * SPEED_OVER_S);
    Some([now?, Plane::from_polar(1.0, yaws.at(t_s)?), speed])
}

/// Consecutive steps, as long as needed for enough of turning.
fn windows(runs: &[Vec<Step>], limits: &Limits) -> Vec<Vec<Step>> {
    let mut all = Vec::new();
    for run in runs {
        let mut window: Vec<Step> = Vec::new();
        for step in run {
            window.push(*step);
            let lasts = window.first().map_or(0.0, |first| step.t_s - first.t_s);
            let turns: f64 = window.iter().map(|step| step.ahead.norm_sqr()).sum();
            if lasts >= limits.window_s && turns >= limits.min_turning {
                all.push(std::mem::take(&mut window));
            } else if lasts >= limits.longest_window_s {
                window.clear();
            }
        }
    }
    all
}

/// The normal equations of one window: of its own two unknowns (corrections of scale and rotation), of the shared three, and mixed.
struct Part {
    own: Matrix2<f64>,
    mixed: Matrix3x2<f64>,
    shared: Matrix3<f64>,
    right_own: Vector2<f64>,
    right: Vector3<f64>,
}

impl Part {
    fn of(steps: &[Step], rotation: Plane) -> Self {
        let mut part = Self {
            own: Matrix2::zeros(),
            mixed: Matrix3x2::zeros(),
            shared: Matrix3::zeros(),
            right_own: Vector2::zeros(),
            right: Vector3::zeros(),
        };
        for step in steps {
            let left = step.fixes / rotation - step.poses;
            // The real and the imaginary part of each equation.
            let rows = [
                (
                    [step.poses.re, -step.poses.im],
                    [step.ahead.re, -step.ahead.im, -step.speed.re],
                    left.re,
                ),
                (
                    [step.poses.im, step.poses.re],
                    [step.ahead.im, step.ahead.re, -step.speed.im],
                    left.im,
                ),
            ];
            for (own, shared, value) in rows {
                let (own, shared) = (Vector2::from(own), Vector3::from(shared));
                part.own += own * own.transpose();
                part.mixed += shared * own.transpose();
                part.shared += shared * shared.transpose();
                part.right_own += own * value;
                part.right += shared * value;
            }
        }
        part
    }

    /// What the window says of the shared unknowns once its own are eliminated: nothing, where too few steps are kept.
    fn reduced(&self) -> (Matrix3<f64>, Vector3<f64>) {
        let Some(inverse) = self.own.try_inverse() else {
            return (Matrix3::zeros(), Vector3::zeros());
        };
        let own = self.mixed * inverse;
        (
            self.shared - own * self.mixed.transpose(),
            self.right - own * self.right_own,
        )
    }

    /// The corrections of scale and rotation, where these are the shared unknowns.
    fn own(&self, shared: &Unknowns) -> Plane {
        let own = self
            .own
            .try_inverse()
            .map(|inverse| inverse * (self.right_own - self.mixed.transpose() * shared));
        own.map_or(Plane::new(1.0, 0.0), |own| Plane::new(1.0 + own.x, own.y))
    }
}

fn solved<'p>(parts: impl IntoIterator<Item = &'p Part>) -> Option<Unknowns> {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for part in parts {
        let (of, value) = part.reduced();
        matrix += of;
        right += value;
    }
    Some(matrix.try_inverse()? * right)
}

/// Standard errors by leaving out each window in turn (jackknife).
fn scatter(parts: &[Part]) -> Option<Unknowns> {
    let without = (0..parts.len()).map(|out| {
        let others = parts.iter().enumerate().filter(|(index, _)| *index != out);
        solved(others.map(|(_, part)| part))
    });
    let without: Vec<Unknowns> = without.collect::<Option<_>>()?;
    let n = without.len() as f64;
    let mean = without.iter().sum::<Unknowns>() / n;
    let squares: Unknowns = without.iter().map(|one| (one - mean).map(|off| off * off)).sum();
    Some(squares.map(|square| (square * (n - 1.0) / n).sqrt()))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) step_s: f64,
    pub(crate) window_s: f64,
    pub(crate) longest_window_s: f64,
    pub(crate) min_turning: f64,
    pub(crate) min_windows: usize,
    pub(crate) outlier: f64,
    pub(crate) max_residual: f64,
    pub(crate) max_off_m: f64,
    pub(crate) sigmas: f64,
    pub(crate) max_late_s: f64,
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn limits() -> Limits {
        Limits {
            step_s: 2.0,
            window_s: 20.0,
            longest_window_s: 80.0,
            min_turning: 0.6,
            min_windows: 4,
            outlier: 4.0,
            max_residual: 0.2,
            max_off_m: 0.3,
            sigmas: 5.0,
            max_late_s: 1.0,
        }
    }

    /// A body that looks where it goes, on a path with turns of several radii at changing speed: place, direction and velocity.
    fn body(t_s: f64) -> [Plane; 3] {
        let place = Plane::new(40.0 * (0.11 * t_s).sin() + 3.0 * t_s, 25.0 * (0.23 * t_s).cos());
        let velocity = Plane::new(4.4 * (0.11 * t_s).cos() + 3.0, -5.75 * (0.23 * t_s).sin());
        [place, velocity / velocity.norm(), velocity]
    }

    /// Steps of two seconds with an antenna at `arm`, fixes that are late to first order, and a rotated and scaled plane.
    fn drive(body: impl Fn(f64) -> [Plane; 3], arm: Plane, late_s: f64) -> Vec<Vec<Step>> {
        let plane = Plane::from_polar(1.03, 0.7);
        let steps = (0..100).map(|k| 2.0 * f64::from(k)).map(|t_s| {
            let ([a, ahead_a, speed_a], [b, ahead_b, speed_b]) = (body(t_s), body(t_s + 2.0));
            let (poses, ahead, speed) = (b - a, ahead_b - ahead_a, speed_b - speed_a);
            Step {
                t_s,
                fixes: plane * (poses + ahead * arm - speed * late_s),
                poses,
                ahead,
                speed,
            }
        });
        windows(&[steps.collect()], &limits())
    }

    #[test]
    fn the_place_of_an_antenna_and_the_delay_are_those_of_the_drive() {
        let found = AntennaEstimate::fitted(drive(body, Plane::new(-1.2, 0.4), 0.15), &limits()).unwrap();
        assert!((found.place_m - Vector2::new(-1.2, 0.4)).norm() < 1e-6, "{found:?}");
        assert!((found.late_s.0 - 0.15).abs() < 1e-6, "{found:?}");
        assert!(found.residual < 1e-6, "{found:?}");
    }

    #[test]
    fn a_jump_of_the_receiver_is_left_out() {
        let mut windows = drive(body, Plane::new(0.0, 0.9), 0.0);
        for step in windows.iter_mut().step_by(2).filter_map(|steps| steps.get_mut(3)) {
            step.fixes += Plane::new(8.0, -3.0);
        }
        let found = AntennaEstimate::fitted(windows, &limits()).unwrap();
        assert!((found.place_m - Vector2::new(0.0, 0.9)).norm() < 0.01, "{found:?}");
    }

    #[test]
    fn at_constant_speed_a_delay_and_a_place_ahead_look_the_same() {
        // The direction changes as that of a slalom; the speed does not.
        let slalom = |t_s: f64| {
            let ahead = Plane::from_polar(1.0, 0.8 * (0.3 * t_s).sin());
            [Plane::new(0.0, 0.0), ahead, ahead * 5.0]
        };
        let path = |t_s: f64| {
            // The place by small steps of the midpoint rule.
            let n = 200;
            let h = t_s / f64::from(n);
            let place: Plane = (0..n).map(|k| slalom(h * (f64::from(k) + 0.5))[2] * h).sum();
            let [_, ahead, speed] = slalom(t_s);
            [place, ahead, speed]
        };
        // Neither is determined; across the direction of motion the place is.
        assert!(
            AntennaEstimate::fitted(drive(path, Plane::new(-1.0, 0.3), 0.1), &limits())
                .is_none_or(|found| found.error_m.x > 0.05)
        );
    }
}
