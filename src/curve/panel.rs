//! One panel of the curve: closed positions as Chebyshev series over a plane's distance from the panel's base.
use crate::chebyshev::{NODES, Series, Transform, antiderivative, chopped, derivative, tail, value};
use crate::closure::Closure;
use crate::linkage::{Linkage, Positions, Rates};

/// A stretch of the curve that crosses every plane normal . (q - base) = u, 0 <= u <= width, once.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// sigma at its base.
    pub start: f64,
    /// Coordinates at its base.
    pub base: Vec<f64>,
    /// Normal of the planes.
    pub normal: Vec<f64>,
    /// Last u.
    pub width: f64,
    /// Each coordinate as a series in x = 2 u / width - 1.
    pub coordinates: Vec<Series>,
    /// sigma - start as a series in x.
    length: [f64; NODES + 1],
    /// d sigma / d x as a series in x.
    speed: Series,
    /// Coordinates at its end.
    pub tip: Vec<f64>,
    /// How much rounding in a gap is amplified where least.
    pub amplification: f64,
}

/// Why a panel of some width was not accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The series does not resolve it, or Newton's method went astray: a shorter one may do.
    TooWide,
    /// A node is too close to a position where branches cross: a slightly different one may do.
    NearCrossing,
    /// The kinetic energy vanishes at one of its positions.
    Massless,
}

/// Nodes may amplify rounding this many times as much as the panel's best one: 1 / 16 of a panel away from a crossing in
/// its middle. Amplification grows with the number of loops, so only its ratio tells of a crossing.
const NEAR: f64 = 60.0;
/// The tip, where the next panel starts, must keep farther away.
const TIP_NEAR: f64 = 8.0;
/// Where nodes amplify rounding more than this many times as much as the best one, the series ends in rounding.
const CROSSING: f64 = 5.0;
/// Below this amplification no position is too close to a crossing.
const HARMLESS: f64 = 30.0;
/// Rounding of coordinates, relative to their size and to 1 rad, before amplification.
const ROUNDING: f64 = 1e-15;

/// Twice the kinetic energy at these rates: sum of m v^2 + I omega^2.
pub fn twice_kinetic(linkage: &Linkage, p: &Positions, r: &Rates) -> f64 {
    let mut sum = 0.0;
    for (i, body) in linkage.bodies.iter().enumerate().skip(1) {
        if body.mass > 0.0 {
            let point = crate::linkage::Point { body: i, local: body.center };
            sum += body.mass * p.velocity(r, point).norm_squared();
        }
        sum += body.inertia * r.angle[i].powi(2);
    }
    sum
}

impl Panel {
    /// Last sigma.
    pub fn end(&self) -> f64 {
        self.start + self.length.iter().sum::<f64>()
    }

    /// Try to build the panel that starts at `base` with the unit tangent `tangent`.
    ///
    /// # Errors
    /// A [`Refusal`].
    pub fn build(
        closure: &Closure,
        transform: &Transform,
        start: f64,
        base: &[f64],
        tangent: &[f64],
        width: f64,
    ) -> Result<Self, Refusal> {
        let n = base.len();
        let linkage = &*closure.linkage;
        let w = &closure.weights;
        let normal: Vec<f64> = (0..n).map(|i| tangent[i] * w[i] * w[i]).collect();
        let mut nodes: Vec<Vec<f64>> = Vec::with_capacity(NODES);
        let mut speeds = [0.0; NODES];
        let mut amplification: f64 = 1.0;
        let mut least = f64::INFINITY;
        // Two known points with their slopes, from which the next is extrapolated.
        let mut before = (0.0, base.to_vec(), tangent.to_vec());
        let mut last = before.clone();
        for (j, x) in transform.nodes.iter().enumerate() {
            let u = 0.5 * width * (1.0 + x);
            let ahead = if j == 0 { linear(&last, u) } else { cubic(&before, &last, u) };
            let (q, bordered, correction) = closure.on_plane(&ahead, base, &normal, u).ok_or(Refusal::TooWide)?;
            if correction > 0.2 * (u - last.0) + 1e-12 {
                return Err(Refusal::TooWide);
            }
            amplification = amplification.max(bordered.amplification);
            least = least.min(bordered.amplification);
            let slope = bordered.solve(&vec![0.0; n - 1], 1.0).ok_or(Refusal::NearCrossing)?;
            let steep = (0..n).map(|i| (slope[i] * w[i]).powi(2)).sum::<f64>().sqrt();
            if steep > 1.5 {
                return Err(Refusal::TooWide);
            }
            let p = linkage.positions(&q);
            let rates = linkage.rates(&p, &q, &slope);
            speeds[j] = twice_kinetic(linkage, &p, &rates).sqrt();
            before = last;
            last = (u, q.clone(), slope);
            nodes.push(q);
        }
        if amplification > HARMLESS.max(NEAR * least) {
            return Err(Refusal::NearCrossing);
        }
        let mut coordinates: Vec<Series> =
            (0..n).map(|i| transform.fit(&std::array::from_fn(|j| nodes[j][i]))).collect();
        for (i, series) in coordinates.iter().enumerate() {
            let size = 1.0 + series[0].abs() * w[i];
            if tail(series) * w[i] > ROUNDING * size * amplification.max(2.0) {
                return Err(Refusal::TooWide);
            }
        }
        let mut speed = transform.fit(&speeds.map(|s| 0.5 * width * s));
        let fastest = speeds.iter().fold(0.0, |a: f64, s| a.max(*s));
        let slowest = speeds.iter().fold(f64::INFINITY, |a: f64, s| a.min(*s));
        if fastest == 0.0 || slowest < 1e-7 * fastest {
            return Err(Refusal::Massless);
        }
        // The slope of a series is its length times less accurate than the series.
        if tail(&speed) > 20.0 * ROUNDING * amplification.max(2.0) * 0.5 * width * fastest {
            return Err(Refusal::TooWide);
        }
        if amplification > HARMLESS.max(CROSSING * least) {
            coordinates.iter_mut().chain([&mut speed]).for_each(|s| *s = chopped(s));
        }
        let length = antiderivative(&speed);
        let end: Vec<f64> = coordinates.iter().map(|s| value(s, 1.0)).collect();
        let (tip, bordered, _) = closure.on_plane(&end, base, &normal, width).ok_or(Refusal::TooWide)?;
        if bordered.amplification > HARMLESS.max(TIP_NEAR * least) {
            return Err(Refusal::NearCrossing);
        }
        Ok(Self { start, base: base.to_vec(), normal, width, coordinates, length, speed, tip, amplification: least })
    }

    /// The same stretch followed the other way, with its base, the present tip, at `start`: x becomes -x.
    pub fn mirrored(&self, start: f64) -> Self {
        // T_k(-x) = (-1)^k T_k(x).
        let odd = |series: &mut [f64]| series.iter_mut().skip(1).step_by(2).for_each(|c| *c = -*c);
        let mut mirrored = self.clone();
        std::mem::swap(&mut mirrored.base, &mut mirrored.tip);
        mirrored.start = start;
        mirrored.normal.iter_mut().for_each(|n| *n = -*n);
        mirrored.coordinates.iter_mut().for_each(|series| odd(series));
        odd(&mut mirrored.speed);
        mirrored.length = antiderivative(&mirrored.speed);
        mirrored
    }

    /// Coordinates at x in [-1, 1], by the series.
    pub fn series_at(&self, x: f64) -> Vec<f64> {
        self.coordinates.iter().map(|s| value(s, x)).collect()
    }

    /// Derivatives of the coordinates with respect to x.
    pub fn slopes_at(&self, x: f64) -> Vec<f64> {
        self.coordinates.iter().map(|s| value(&derivative(s), x)).collect()
    }

    /// Second derivatives of the coordinates with respect to x.
    pub fn curvatures_at(&self, x: f64) -> Vec<f64> {
        self.coordinates.iter().map(|s| value(&derivative(&derivative(s)), x)).collect()
    }

    /// sigma at x.
    pub fn sigma_at(&self, x: f64) -> f64 {
        self.start + value(&self.length, x)
    }

    /// x at sigma: Newton's method on a monotonic series.
    pub fn x_at(&self, sigma: f64) -> f64 {
        let (start, end) = (self.start, self.end());
        let mut x = (2.0 * (sigma - start) / (end - start) - 1.0).clamp(-1.0, 1.0);
        for _ in 0..20 {
            let step = (sigma - self.sigma_at(x)) / value(&self.speed, x);
            x = (x + step).clamp(-1.0, 1.0);
            if step.abs() < 1e-15 {
                break;
            }
        }
        x
    }

    /// u at x.
    pub fn u_at(&self, x: f64) -> f64 {
        0.5 * self.width * (1.0 + x)
    }
}

type Known = (f64, Vec<f64>, Vec<f64>);

fn linear(a: &Known, u: f64) -> Vec<f64> {
    a.1.iter().zip(&a.2).map(|(q, s)| q + (u - a.0) * s).collect()
}

/// Cubic through two points with their slopes.
fn cubic(a: &Known, b: &Known, u: f64) -> Vec<f64> {
    let h = b.0 - a.0;
    let s = (u - a.0) / h;
    let (s2, s3) = (s * s, s * s * s);
    (0..a.1.len())
        .map(|i| {
            (2.0 * s3 - 3.0 * s2 + 1.0) * a.1[i]
                + (s3 - 2.0 * s2 + s) * h * a.2[i]
                + (3.0 * s2 - 2.0 * s3) * b.1[i]
                + (s3 - s2) * h * b.2[i]
        })
        .collect()
}
