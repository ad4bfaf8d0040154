//! Seeded randomness of drives: the same seed and the same name give the same numbers in every run.

use nalgebra::Vector3;

/// A series of random numbers.
#[derive(Clone, Debug)]
pub struct Random(fastrand::Rng);

impl Random {
    /// The series of a seed and a name: series of other names know nothing of it.
    pub fn new(seed: u64, name: &str) -> Self {
        Self(fastrand::Rng::with_seed(hash(seed, name)))
    }

    /// A series for a moment: noise that is a function of time, however often one asks.
    pub fn at(seed: u64, name: &str, t_s: f64) -> Self {
        let micros = (t_s * 1e6).round() as i64;
        Self::new(hash(seed, name) ^ micros.cast_unsigned(), "moment")
    }

    /// Even between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    /// Normal with deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.0.f64(), self.0.f64());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    /// Three of them.
    pub fn normals(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.normal())
    }
}

/// Noise that forgets itself with a time constant (Gauss and Markov, Ornstein and Uhlenbeck), each axis with a deviation
/// of its own. Exact at any spacing of times.
#[derive(Clone, Debug)]
pub struct Correlated {
    deviation: Vector3<f64>,
    tau_s: f64,
    last: Option<(f64, Vector3<f64>)>,
}

impl Correlated {
    /// Noise of a deviation and a time constant in seconds.
    pub fn new(deviation: Vector3<f64>, tau_s: f64) -> Self {
        Self {
            deviation,
            tau_s,
            last: None,
        }
    }

    /// Its value at a time, not earlier than the last one asked for.
    pub fn at(&mut self, t_s: f64, random: &mut Random) -> Vector3<f64> {
        let fresh = random.normals().component_mul(&self.deviation);
        let value = match self.last {
            None => fresh,
            Some((last_s, value)) => {
                let kept = (-(t_s - last_s) / self.tau_s).exp();
                value * kept + fresh * (1.0 - kept * kept).sqrt()
            }
        };
        self.last = Some((t_s, value));
        value
    }
}

/// Correlated noise that is a function of time, however often one asks.
#[derive(Clone, Debug)]
pub struct Wander {
    start_s: f64,
    step_s: f64,
    values: Vec<Vector3<f64>>,
}

impl Wander {
    /// Noise of a deviation and a time constant, known between two times.
    pub fn new(random: &mut Random, deviation: Vector3<f64>, tau_s: f64, [start_s, end_s]: [f64; 2]) -> Self {
        let step_s = tau_s / 50.0;
        let n = ((end_s - start_s) / step_s) as usize + 2;
        let mut noise = Correlated::new(deviation, tau_s);
        Self {
            start_s,
            step_s,
            values: (0..n).map(|k| noise.at(k as f64 * step_s, random)).collect(),
        }
    }

    /// Its value at a time.
    pub fn at(&self, t_s: f64) -> Vector3<f64> {
        let place = ((t_s - self.start_s) / self.step_s).max(0.0);
        let k = (place as usize).min(self.values.len() - 2);
        self.values[k].lerp(&self.values[k + 1], place - k as f64)
    }
}

/// FNV-1a; `DefaultHasher` may change with a release of Rust.
fn hash(seed: u64, name: &str) -> u64 {
    let bytes = seed.to_le_bytes();
    bytes
        .iter()
        .chain(name.as_bytes())
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
        })
}

/// A series of `n` values of one-dimensional correlated noise with deviation 1, `step_s` apart.
pub fn series(random: &mut Random, n: usize, step_s: f64, tau_s: f64) -> Vec<f64> {
    let mut noise = Correlated::new(Vector3::x(), tau_s);
    (0..n).map(|k| noise.at(k as f64 * step_s, random).x).collect()
}
