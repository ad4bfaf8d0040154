//! The true motion of a drive: where the vehicle is at any time, in the tangent plane of the place, exact in all its
//! derivatives.
//!
//! The yaw, and the velocity in the frame turned by yaw alone, are smooth curves. A ground vehicle moves along its own x
//! axis, so its pitch climbs; a drone's attitude follows from its acceleration. ENU is one tangent plane: up is the same
//! everywhere, and the Earth does not turn.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::spline::{Integral, Spline};

/// A smooth curve and sinusoids on it.
#[derive(Clone, Debug)]
pub struct Signal {
    /// The curve.
    pub curve: Spline,
    /// Amplitude, angular frequency and phase of each sinusoid.
    pub waves: Vec<[f64; 3]>,
}

impl Signal {
    /// A curve alone.
    pub fn of(curve: Spline) -> Self {
        Self {
            curve,
            waves: Vec::new(),
        }
    }

    /// With a sinusoid on it.
    pub fn with(mut self, amplitude: f64, hz: f64, phase: f64) -> Self {
        self.waves.push([amplitude, std::f64::consts::TAU * hz, phase]);
        self
    }

    /// The value and its first two derivatives.
    fn jet(&self, t_s: f64) -> [f64; 3] {
        let mut jet = self.curve.jet(t_s);
        for [amplitude, omega, phase] in &self.waves {
            let (sin, cos) = (omega * t_s + phase).sin_cos();
            jet[0] += amplitude * sin;
            jet[1] += amplitude * omega * cos;
            jet[2] -= amplitude * omega * omega * sin;
        }
        jet
    }
}

/// What roll and pitch are.
#[derive(Clone, Copy, Debug)]
pub enum Lean {
    /// The ground's; the vehicle moves along its x axis, whatever `left` and `up` say.
    Ground,
    /// Their own.
    Free,
    /// So that the thrust carries the vehicle: gravity, and air drag a unit of mass and speed (1/s).
    Thrust(f64, f64),
}

/// The curves of a motion.
#[derive(Clone, Debug)]
pub struct Curves {
    /// Velocity ahead, to the left and up, in the frame turned by yaw alone, m/s.
    pub velocity: [Signal; 3],
    /// Roll and pitch, rad.
    pub tilt: [Signal; 2],
    /// Yaw from east towards north, rad.
    pub yaw: Signal,
    /// What roll and pitch are.
    pub lean: Lean,
}

/// The truth at a time.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Seconds after the start.
    pub t_s: f64,
    /// ENU, metres from where the drive begins.
    pub position: Vector3<f64>,
    /// ENU, m/s.
    pub velocity: Vector3<f64>,
    /// ENU, m/s².
    pub acceleration: Vector3<f64>,
    /// `enu_from_base`, the base being FLU.
    pub orientation: UnitQuaternion<f64>,
    /// Angular velocity in the base's axes, rad/s.
    pub rate: Vector3<f64>,
    /// Yaw without wrapping, rad.
    pub yaw: f64,
    /// Its derivative, rad/s.
    pub yaw_rate: f64,
}

/// A motion with its path.
#[derive(Clone, Debug)]
pub struct Truth {
    curves: Curves,
    path: Integral,
}

impl Truth {
    /// The motion along the curves, known between two times; it passes the origin at time zero.
    pub fn new(curves: Curves, start_s: f64, end_s: f64) -> Self {
        let path = Integral::new(start_s, end_s, |t_s| curves.velocity(t_s));
        Self { curves, path }
    }

    /// The position at a time.
    pub fn position(&self, t_s: f64) -> Vector3<f64> {
        self.path.at(t_s, |t_s| self.velocity(t_s))
    }

    /// The truth at a time but for the position.
    pub fn moment(&self, t_s: f64) -> State {
        self.curves.moment(t_s)
    }

    /// The velocity alone.
    pub fn velocity(&self, t_s: f64) -> Vector3<f64> {
        self.curves.velocity(t_s)
    }

    /// Angular acceleration in the base's axes, rad/s², by a difference over two milliseconds.
    pub fn angular_acceleration(&self, t_s: f64) -> Vector3<f64> {
        let h = 1e-3;
        (self.moment(t_s + h).rate - self.moment(t_s - h).rate) / (2.0 * h)
    }
}

impl Curves {
    fn moment(&self, t_s: f64) -> State {
        let [psi, psi_d, psi_dd] = self.yaw.jet(t_s);
        let [mut u, mut u_d, u_dd] = self.ahead(t_s);
        let (tilt, tilt_d);
        match self.lean {
            Lean::Ground | Lean::Free => {
                let [roll, pitch] = [0, 1].map(|axis: usize| self.tilt[axis].jet(t_s));
                (tilt, tilt_d) = ([roll[0], pitch[0]], [roll[1], pitch[1]]);
                if matches!(self.lean, Lean::Ground) {
                    let (sin, cos) = tilt[1].sin_cos();
                    let (along, turned) = (Vector3::new(cos, 0.0, -sin), Vector3::new(-sin, 0.0, -cos));
                    u_d = along * u_d.x + turned * (u.x * tilt_d[1]);
                    u = along * u.x;
                }
            }
            Lean::Thrust(gravity, drag) => {
                let thrust = u_d + across(u) * psi_d + u * drag + Vector3::z() * gravity;
                let thrust_d = u_dd + across(u) * psi_dd + across(u_d) * psi_d + u_d * drag;
                (tilt, tilt_d) = leaning(thrust, thrust_d);
            }
        }
        let [[roll, pitch], [roll_d, pitch_d]] = [tilt, tilt_d];
        let world_from_yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), psi);
        let ((sin_r, cos_r), (sin_p, cos_p)) = (roll.sin_cos(), pitch.sin_cos());
        State {
            t_s,
            position: Vector3::zeros(),
            velocity: world_from_yaw * u,
            acceleration: world_from_yaw * (u_d + across(u) * psi_d),
            orientation: UnitQuaternion::from_euler_angles(roll, pitch, psi),
            rate: Vector3::new(
                roll_d - psi_d * sin_p,
                pitch_d * cos_r + psi_d * cos_p * sin_r,
                -pitch_d * sin_r + psi_d * cos_p * cos_r,
            ),
            yaw: psi,
            yaw_rate: psi_d,
        }
    }

    fn velocity(&self, t_s: f64) -> Vector3<f64> {
        let [x, y, z] = [0, 1, 2].map(|axis: usize| self.velocity[axis].jet(t_s)[0]);
        let ((sin, cos), (sin_p, cos_p)) = (self.yaw.jet(t_s)[0].sin_cos(), self.tilt[1].jet(t_s)[0].sin_cos());
        let [x, y, z] = if matches!(self.lean, Lean::Ground) {
            [x * cos_p, 0.0, -x * sin_p]
        } else {
            [x, y, z]
        };
        Vector3::new(cos * x - sin * y, sin * x + cos * y, z)
    }

    /// The velocity in the frame turned by yaw alone, and the first two derivatives of its components.
    fn ahead(&self, t_s: f64) -> [Vector3<f64>; 3] {
        let jets = [0, 1, 2].map(|axis: usize| self.velocity[axis].jet(t_s));
        [0, 1, 2].map(|order: usize| Vector3::new(jets[0][order], jets[1][order], jets[2][order]))
    }
}

/// The vertical axis times a vector.
fn across(u: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-u.y, u.x, 0.0)
}

/// Roll and pitch that put the body's z axis along a thrust in the frame turned by yaw alone, and their rates.
fn leaning(f: Vector3<f64>, f_d: Vector3<f64>) -> ([f64; 2], [f64; 2]) {
    let size = f.norm();
    let roll = (-f.y / size).asin();
    let roll_d = (-f_d.y / size + f.y * f.dot(&f_d) / size.powi(3)) / roll.cos();
    let pitch_d = (f.z * f_d.x - f.x * f_d.z) / (f.x * f.x + f.z * f.z);
    ([roll, f.x.atan2(f.z)], [roll_d, pitch_d])
}
