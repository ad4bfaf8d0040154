//! Smooth functions of time: uniform B-splines of degree five, with exact derivatives and integrals.
//!
//! A curve stays between its least and its greatest coefficient, and its fourth derivative is continuous: positions made
//! from it have velocities, accelerations and turn rates without a kink.

use nalgebra::Vector3;

const DEGREE: usize = 5;

/// A smooth function of time.
#[derive(Clone, Debug)]
pub struct Spline {
    start_s: f64,
    step_s: f64,
    /// For each interval, the coefficients of the powers of the place in it, from 0 to 1.
    pieces: Vec<[f64; DEGREE + 1]>,
}

impl Spline {
    /// A function that follows coefficients which stand `step_s` apart, the first at `start_s`.
    pub fn new(start_s: f64, step_s: f64, coefficients: &[f64]) -> Self {
        assert!(
            coefficients.len() > DEGREE,
            "a spline of {} coefficients",
            coefficients.len()
        );
        Self {
            // The basis function of a coefficient has its peak two intervals behind the first one it reaches.
            start_s: start_s + 2.0 * step_s,
            step_s,
            pieces: coefficients.windows(DEGREE + 1).map(piece).collect(),
        }
    }

    /// A function whose derivative follows the coefficients.
    pub fn integral(start_s: f64, step_s: f64, slopes: &[f64]) -> Self {
        let mut sum = 0.0;
        let mut coefficients = Vec::new();
        for slope in slopes {
            sum += slope * step_s;
            coefficients.push(sum);
        }
        Self::new(start_s, step_s, &coefficients)
    }

    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self::new(0.0, 1.0, &[value; DEGREE + 1])
    }

    /// The same curve, moved up or down so that it is `value` at a time.
    pub fn through(mut self, t_s: f64, value: f64) -> Self {
        let up = value - self.at(t_s);
        for piece in &mut self.pieces {
            piece[0] += up;
        }
        self
    }

    /// The value.
    pub fn at(&self, t_s: f64) -> f64 {
        let (piece, u) = self.piece(t_s);
        piece.iter().rfold(0.0, |value, power| value * u + power)
    }

    /// The value and its first two derivatives.
    pub fn jet(&self, t_s: f64) -> [f64; 3] {
        let (piece, u) = self.piece(t_s);
        let [mut value, mut slope, mut half_bend] = [0.0; 3];
        for power in piece.iter().rev() {
            half_bend = half_bend * u + slope;
            slope = slope * u + value;
            value = value * u + power;
        }
        let h = self.step_s;
        [value, slope / h, 2.0 * half_bend / (h * h)]
    }

    fn piece(&self, t_s: f64) -> (&[f64; DEGREE + 1], f64) {
        let place = (t_s - self.start_s) / self.step_s;
        let piece = (place.floor().max(0.0) as usize).min(self.pieces.len() - 1);
        (&self.pieces[piece], place - piece as f64)
    }
}

/// The powers of the interval that six coefficients in a row belong to: Taylor's, from the derivatives at its beginning.
fn piece(coefficients: &[f64]) -> [f64; DEGREE + 1] {
    let mut differences = coefficients.to_vec();
    let mut powers = [0.0; DEGREE + 1];
    let mut factorial = 1.0;
    for (order, power) in powers.iter_mut().enumerate() {
        let basis = basis(DEGREE - order, 0.0);
        let derivative: f64 = differences.iter().zip(basis).map(|(value, share)| value * share).sum();
        *power = derivative / factorial;
        factorial *= order as f64 + 1.0;
        differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    powers
}

/// The `degree + 1` basis functions that are not zero in an interval, at a place in it between 0 and 1 (de Boor and Cox
/// for evenly spaced knots).
fn basis(degree: usize, u: f64) -> [f64; DEGREE + 1] {
    let mut values = [0.0; DEGREE + 1];
    values[0] = 1.0;
    for d in 1..=degree {
        for j in (0..=d).rev() {
            let rising = if j > 0 {
                (u + (d - j) as f64) * values[j - 1]
            } else {
                0.0
            };
            values[j] = (rising + (1.0 - u + j as f64) * values[j]) / d as f64;
        }
    }
    values
}

/// The integral over time of a smooth function, which is handed in again at every question.
#[derive(Clone, Debug)]
pub struct Integral {
    start_s: f64,
    nodes: Vec<Vector3<f64>>,
}

/// Half a period of the fastest gait is longer than this.
const STEP_S: f64 = 0.1;

impl Integral {
    /// The integral from time zero, known between two times.
    pub fn new(start_s: f64, end_s: f64, rate: impl Fn(f64) -> Vector3<f64>) -> Self {
        let n = ((end_s - start_s) / STEP_S).ceil() as usize;
        let mut sum = Vector3::zeros();
        let mut nodes = vec![sum];
        for k in 0..n {
            sum += gauss(start_s + k as f64 * STEP_S, STEP_S, &rate);
            nodes.push(sum);
        }
        let mut integral = Self { start_s, nodes };
        let origin = integral.at(0.0, &rate);
        integral.nodes.iter_mut().for_each(|node| *node -= origin);
        integral
    }

    /// Its value at a time; `rate` must be the function that it was made from.
    pub fn at(&self, t_s: f64, rate: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
        let place = ((t_s - self.start_s) / STEP_S).floor().max(0.0) as usize;
        let node = place.min(self.nodes.len() - 1);
        let node_s = self.start_s + node as f64 * STEP_S;
        self.nodes[node] + gauss(node_s, t_s - node_s, rate)
    }
}

/// Three-point Gauss-Legendre quadrature: exact for polynomials up to degree five.
fn gauss(from_s: f64, length_s: f64, rate: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
    let aside = 0.5 * 0.6_f64.sqrt();
    let at = |share: f64| rate(from_s + length_s * share);
    (at(0.5 - aside) * 5.0 + at(0.5) * 8.0 + at(0.5 + aside) * 5.0) * (length_s / 18.0)
}
