//! Where a body of a recipe is at a time: a drive along an arc, and what goes wrong with it.

use std::hash::{DefaultHasher, Hash, Hasher};

use serde::Deserialize;

/// A pose `parent_from_child` as published: metres, and `x y z w`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedPose {
    /// Metres.
    pub position: [f64; 3],
    /// `x y z w`.
    pub orientation: [f64; 4],
}

/// From `at_s` on, the whole rest of the drive is shifted and turned about the place it had reached.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Jump {
    /// First second behind the jump.
    pub at_s: f64,
    /// Shift in the parent's axes, metres.
    #[serde(default)]
    pub by: [f64; 3],
    /// Turn, degrees.
    #[serde(default)]
    pub yaw_deg: f64,
}

/// What a second writer says: every second message is displaced.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecondWriter {
    /// Shift in the parent's axes, metres.
    #[serde(default)]
    pub by: [f64; 3],
    /// Turn, degrees.
    #[serde(default)]
    pub yaw_deg: f64,
}

/// A motion: the knobs that topics and transforms of a recipe share.
#[derive(Clone, Debug, Deserialize)]
pub struct Motion {
    /// Position of the child in the parent at the start, metres.
    #[serde(default)]
    pub xyz: [f64; 3],
    /// Roll, pitch, yaw about fixed axes at the start, degrees.
    #[serde(default)]
    pub rpy_deg: [f64; 3],
    /// `x y z w` as published, in place of `rpy_deg`; only jumps turn it.
    pub quaternion: Option<[f64; 4]>,
    /// Velocity of the child in its own axes turned by yaw alone (a vehicle's), metres a second.
    #[serde(default)]
    pub velocity: [f64; 3],
    /// Yaw rate, degrees a second.
    #[serde(default)]
    pub yaw_rate_deg_s: f64,
    /// Jumps, in the order of time.
    #[serde(default)]
    pub jumps: Vec<Jump>,
    /// Amplitude of a sinusoid along the parent's x, metres.
    #[serde(default)]
    pub wobble_m: f64,
    /// Its frequency.
    #[serde(default = "one_hz")]
    pub wobble_hz: f64,
    /// What every second message is displaced by.
    pub alternate: Option<SecondWriter>,
    /// Standard deviation of each coordinate, metres.
    #[serde(default)]
    pub noise_m: f64,
}

fn one_hz() -> f64 {
    1.0
}

impl Motion {
    /// The pose that the `tick`-th message, at `at_s` seconds, publishes; `seed` is the noise's.
    pub fn at(&self, at_s: f64, tick: u64, seed: &str) -> PublishedPose {
        let (mut position, mut turn) = self.smooth(at_s, self.jumps.len());
        if let Some(alternate) = self.alternate.filter(|_| tick % 2 == 1) {
            position = add(position, alternate.by);
            turn += alternate.yaw_deg.to_radians();
        }
        if self.wobble_m != 0.0 {
            position[0] += self.wobble_m * (std::f64::consts::TAU * self.wobble_hz * at_s).sin();
        }
        if self.noise_m != 0.0 {
            for (axis, coordinate) in (0..).zip(&mut position) {
                *coordinate += self.noise_m * normal(seed, 3 * tick + axis);
            }
        }
        let [roll, pitch, yaw] = self.rpy_deg.map(f64::to_radians);
        let orientation = match self.quaternion {
            None => quaternion(roll, pitch, yaw + self.yaw_rate_deg_s.to_radians() * at_s + turn),
            Some(published) if turn == 0.0 => published,
            Some(published) => product(quaternion(0.0, 0.0, turn), published),
        };
        PublishedPose { position, orientation }
    }

    /// Position, and the turn that the first `jumps` jumps add, after `at_s` seconds at constant speed and yaw rate.
    fn smooth(&self, at_s: f64, jumps: usize) -> ([f64; 3], f64) {
        let Some(last) = jumps.checked_sub(1) else {
            return (self.arc(at_s), 0.0);
        };
        let (position, turn) = self.smooth(at_s, last);
        let jump = self.jumps[last];
        if at_s < jump.at_s {
            return (position, turn);
        }
        let (reached, _) = self.smooth(jump.at_s, last);
        let (sin, cos) = jump.yaw_deg.to_radians().sin_cos();
        let [dx, dy, dz] = [0, 1, 2].map(|axis| position[axis] - reached[axis]);
        let turned = if jump.yaw_deg == 0.0 {
            position
        } else {
            add(reached, [cos * dx - sin * dy, sin * dx + cos * dy, dz])
        };
        (add(turned, jump.by), turn + jump.yaw_deg.to_radians())
    }

    fn arc(&self, at_s: f64) -> [f64; 3] {
        let yaw0 = self.rpy_deg[2].to_radians();
        let rate = self.yaw_rate_deg_s.to_radians();
        let yaw = yaw0 + rate * at_s;
        // The integral of the rotated velocity: straight ahead, or along a circle.
        let (ahead, aside) = if rate.abs() < 1e-12 {
            (yaw0.cos() * at_s, yaw0.sin() * at_s)
        } else {
            ((yaw.sin() - yaw0.sin()) / rate, (yaw0.cos() - yaw.cos()) / rate)
        };
        let [x, y, z] = self.xyz;
        let [vx, vy, vz] = self.velocity;
        [x + vx * ahead - vy * aside, y + vx * aside + vy * ahead, z + vz * at_s]
    }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `x y z w` of `Rz(yaw) Ry(pitch) Rx(roll)`.
fn quaternion(roll: f64, pitch: f64, yaw: f64) -> [f64; 4] {
    let ((sr, cr), (sp, cp), (sy, cy)) = ((roll / 2.0).sin_cos(), (pitch / 2.0).sin_cos(), (yaw / 2.0).sin_cos());
    [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
}

/// The product of two quaternions `x y z w`: first `b`, then `a`.
fn product([ax, ay, az, aw]: [f64; 4], [bx, by, bz, bw]: [f64; 4]) -> [f64; 4] {
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

/// The `n`-th number of a seed's series, even in [0, 1): the same in every run.
pub fn even(seed: &str, n: u64) -> f64 {
    let mut hasher = DefaultHasher::new();
    (seed, n).hash(&mut hasher);
    fastrand::Rng::with_seed(hasher.finish()).f64()
}

/// The `n`-th number of a seed's series, normal with deviation 1 (Box and Muller).
fn normal(seed: &str, n: u64) -> f64 {
    let (u, v) = (1.0 - even(seed, 2 * n), even(seed, 2 * n + 1));
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}
